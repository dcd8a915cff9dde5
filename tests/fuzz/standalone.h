/*
 * main() of a fuzz target when no fuzzer provides one. SPDX-License-Identifier: MIT
 *
 *     fuzz_NAME FILE...         run the target on files (a fuzzer's findings)
 *     fuzz_NAME -n COUNT [SEED] run it on COUNT deterministic mutations of the built-in seeds
 *
 * With libFuzzer: compile fuzz_NAME.c, the files of src/io and src/geometry.c with
 * clang -fsanitize=fuzzer,address,undefined -DBRDFFIT_LIBFUZZER -Iinclude -Itests, link with -lz -lm.
 */
#ifndef BRDFFIT_FUZZ_STANDALONE_H
#define BRDFFIT_FUZZ_STANDALONE_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz/mutate.h"

#define STANDALONE_CAPACITY ((size_t)65536)

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Every seed as it is, then `count` mutations. Each input has a block of exactly its size, so that a sanitizer
 * sees a read past its end. 0: no memory. */
static inline int standalone_mutations(const struct fuzz_seed *seeds, size_t seed_count, unsigned long count,
                                       uint64_t state)
{
    unsigned char *work = malloc(STANDALONE_CAPACITY);
    unsigned long i;

    state = state ? state : 1;
    for (i = 0; work && i < seed_count + count; i++) {
        const struct fuzz_seed *seed = &seeds[i < seed_count ? i : mutate_random(&state, seed_count)];
        size_t size = seed->size;
        unsigned char *exact;

        memcpy(work, seed->data, size);
        if (i >= seed_count) {
            size = mutate(&state, work, size, STANDALONE_CAPACITY);
        }
        exact = malloc(size + 1);
        if (!exact) {
            break;
        }
        memcpy(exact + 1, work, size); /* the odd address is deliberate */
        (void)LLVMFuzzerTestOneInput(exact + 1, size);
        free(exact);
    }
    free(work);
    return i == seed_count + count;
}

static inline int standalone_file(const char *path)
{
    unsigned char *data = malloc((size_t)64 << 20);
    FILE *file = fopen(path, "rb");
    size_t size = 0;
    int good = data && file;

    if (good) {
        size = fread(data, 1, (size_t)64 << 20, file);
        (void)LLVMFuzzerTestOneInput(data, size);
        printf("%s: %zu bytes, no fault\n", path, size);
    } else {
        fprintf(stderr, "%s: cannot be read\n", path);
    }
    if (file) {
        fclose(file);
    }
    free(data);
    return good;
}

static inline int standalone_main(int argc, char **argv, const struct fuzz_seed *seeds, size_t seed_count)
{
    int i, good = 1;

    if (argc >= 3 && strcmp(argv[1], "-n") == 0) {
        unsigned long count = strtoul(argv[2], NULL, 10);

        good = standalone_mutations(seeds, seed_count, count, argc > 3 ? strtoull(argv[3], NULL, 10) : 1);
        printf("%lu mutations of %zu seeds, no fault\n", count, seed_count);
        return good ? 0 : 1;
    }
    if (argc < 2) {
        fprintf(stderr, "usage: %s FILE...\n       %s -n COUNT [SEED]\n", argv[0], argv[0]);
        return 2;
    }
    for (i = 1; i < argc; i++) {
        good &= standalone_file(argv[i]);
    }
    return good ? 0 : 1;
}

#endif
