/*
 * main() of a fuzz target when no fuzzer provides one. SPDX-License-Identifier: MIT
 *
 *     fuzz_NAME FILE...         run the target on files (a fuzzer's findings)
 *     fuzz_NAME -n COUNT [SEED] run it on COUNT deterministic mutations of the built-in seeds
 *     fuzz_NAME -t SECONDS [-w DIR | -m DIR] [-f PREFIX] [FILE...]
 *                               search for that long from the seeds and the files on; what reaches new ground goes to DIR
 *                               (-m: also of the files), what breaks something to PREFIXdigits
 *
 * The search keeps what runs code that nothing before it ran, or ran less often, and mutates that in turn. It needs to be
 * told by the compiler: -fsanitize-coverage=trace-pc -DBRDFFIT_COVERAGE (GCC, Clang). `make fuzz` builds it so, or with
 * libFuzzer (-fsanitize=fuzzer -DBRDFFIT_LIBFUZZER) where there is one: then nothing of this is used.
 */
#ifndef BRDFFIT_FUZZ_STANDALONE_H
#define BRDFFIT_FUZZ_STANDALONE_H

#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fuzz/mutate.h"

#define STANDALONE_CAPACITY ((size_t)65536)

#define SEED(text) {(const unsigned char *)(text), sizeof(text) - 1}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#if !defined(BRDFFIT_LIBFUZZER)

/* A block of exactly its size, so that a sanitizer sees a read past its end; the odd address is deliberate. 0: no memory. */
static inline int standalone_run(const unsigned char *data, size_t size)
{
    unsigned char *exact = malloc(size + 1);

    if (!exact) {
        return 0;
    }
    if (size > 0) {
        memcpy(exact + 1, data, size);
    }
    (void)LLVMFuzzerTestOneInput(exact + 1, size);
    free(exact);
    return 1;
}

/* Every seed as it is, then `count` mutations. 0: no memory. */
static inline int standalone_mutations(const struct fuzz_seed *seeds, size_t seed_count, unsigned long count,
                                       uint64_t state)
{
    unsigned char *work = malloc(STANDALONE_CAPACITY);
    unsigned long i;

    state = state ? state : 1;
    for (i = 0; work && i < seed_count + count; i++) {
        const struct fuzz_seed *seed = &seeds[i < seed_count ? i : mutate_random(&state, seed_count)];
        size_t size = seed->size;

        memcpy(work, seed->data, size);
        if (i >= seed_count) {
            size = mutate(&state, work, size, STANDALONE_CAPACITY);
        }
        if (!standalone_run(work, size)) {
            break;
        }
    }
    free(work);
    return i == seed_count + count;
}

/* NULL: it cannot be read. */
static inline unsigned char *standalone_load(const char *path, size_t most, size_t *size)
{
    unsigned char *data = malloc(most);
    FILE *file = data ? fopen(path, "rb") : NULL;

    *size = 0;
    if (!file) {
        fprintf(stderr, "%s: cannot be read\n", path);
        free(data);
        return NULL;
    }
    *size = fread(data, 1, most, file);
    fclose(file);
    return data;
}

static inline int standalone_file(const char *path)
{
    size_t size;
    unsigned char *data = standalone_load(path, (size_t)64 << 20, &size);

    if (!data) {
        return 0;
    }
    (void)LLVMFuzzerTestOneInput(data, size);
    printf("%s: %zu bytes, no fault\n", path, size);
    free(data);
    return 1;
}

/* ---- The search ------------------------------------------------------------------------------------------------ */

#if defined(BRDFFIT_COVERAGE)

#define COVERAGE_PLACES ((size_t)65536)
#define CORPUS_MOST ((size_t)8192)
#define UNSEEN __attribute__((no_sanitize_coverage, no_sanitize("address", "undefined")))

/* How often pairs of places were run one after the other, by the input that runs. */
static unsigned char coverage_now[COVERAGE_PLACES];
/* What any input reached: a bit for each class of counts. */
static unsigned char coverage_ever[COVERAGE_PLACES];
static uintptr_t coverage_before;

void __sanitizer_cov_trace_pc(void);

UNSEEN void __sanitizer_cov_trace_pc(void)
{
    const uintptr_t here = (uintptr_t)__builtin_return_address(0) * (uintptr_t)0x9E3779B97F4A7C15u >> 32;
    unsigned char *const count = &coverage_now[(here ^ coverage_before) % COVERAGE_PLACES];

    *count = (unsigned char)(*count + (*count < 255));
    coverage_before = here >> 1;
}

/* 1, 2, 3, 4 to 7, 8 to 15, 16 to 31, 32 to 127, more. */
UNSEEN static unsigned char coverage_class(unsigned char count)
{
    static const unsigned char above[] = {1, 2, 3, 7, 15, 31, 127};
    unsigned bit = 0;

    while (bit < 7 && count > above[bit]) {
        bit++;
    }
    return count > 0 ? (unsigned char)(1u << bit) : 0;
}

/* Whether the input that ran reached something new, which then is not new any more. */
UNSEEN static int coverage_take(void)
{
    size_t word, i;
    int new = 0;

    for (word = 0; word < COVERAGE_PLACES; word += sizeof(uint64_t)) {
        uint64_t any;

        memcpy(&any, coverage_now + word, sizeof any); /* most are zero */
        for (i = any ? word : COVERAGE_PLACES; i < word + sizeof any; i++) {
            const unsigned char bit = coverage_class(coverage_now[i]);

            new |= (coverage_ever[i] & bit) != bit;
            coverage_ever[i] |= bit;
        }
    }
    return new;
}

/* The input that is being run, for when it ends the process. */
static struct {
    const unsigned char *data;
    size_t size;
    const char *prefix;
} standalone_now;

static inline void standalone_save(const char *prefix, const unsigned char *data, size_t size)
{
    uint64_t hash = 14695981039346656037u;
    char path[2048];
    FILE *file;
    size_t i;

    for (i = 0; i < size; i++) {
        hash = (hash ^ data[i]) * 1099511628211u;
    }
    (void)snprintf(path, sizeof path, "%s%016llx", prefix, (unsigned long long)hash);
    file = fopen(path, "wb");
    if (file) {
        (void)fwrite(data, 1, size, file);
        (void)fclose(file);
    }
}

static inline void standalone_death(void)
{
    if (standalone_now.prefix && standalone_now.data) {
        standalone_save(standalone_now.prefix, standalone_now.data, standalone_now.size);
        standalone_now.data = NULL;
    }
}

static inline void standalone_on_abort(int number)
{
    standalone_death();
    (void)signal(number, SIG_DFL);
    (void)raise(number);
}

/* Of the sanitizers; without them there is none. */
void __sanitizer_set_death_callback(void (*callback)(void)) __attribute__((weak));

struct corpus {
    unsigned char *data[CORPUS_MOST];
    size_t size[CORPUS_MOST], count;
};

static inline void corpus_add(struct corpus *corpus, const unsigned char *data, size_t size, uint64_t *state)
{
    size_t at = corpus->count < CORPUS_MOST ? corpus->count++ : mutate_random(state, CORPUS_MOST);
    unsigned char *const copy = malloc(size + 1);

    free(corpus->data[at]);
    corpus->data[at] = copy;
    corpus->size[at] = copy ? size : 0;
    if (copy && size > 0) {
        memcpy(copy, data, size);
    }
}

struct search {
    struct corpus corpus;
    unsigned char work[STANDALONE_CAPACITY];
    uint64_t state;
    unsigned long inputs;
    const char *keep; /* folder, or NULL */
    int files_too;
};

/* Run it; keep it when it reached something new. */
static inline void search_try(struct search *s, const unsigned char *data, size_t size, int is_old)
{
    char prefix[1024];

    memset(coverage_now, 0, sizeof coverage_now);
    coverage_before = 0;
    standalone_now.data = data;
    standalone_now.size = size;
    (void)standalone_run(data, size);
    standalone_now.data = NULL;
    s->inputs++;
    if (!coverage_take()) {
        return;
    }
    corpus_add(&s->corpus, data, size, &s->state);
    if (s->keep && !is_old) {
        (void)snprintf(prefix, sizeof prefix, "%s/", s->keep);
        standalone_save(prefix, data, size);
    }
}

/* Of one input, now and then with the end of another. */
static inline void search_mutate(struct search *s)
{
    const size_t one = mutate_random(&s->state, s->corpus.count), other = mutate_random(&s->state, s->corpus.count);
    size_t size = s->corpus.size[one];

    memcpy(s->work, s->corpus.data[one], size);
    if (mutate_random(&s->state, 8) == 0 && s->corpus.size[other] > 0) {
        const size_t from = mutate_random(&s->state, s->corpus.size[other]), cut = mutate_random(&s->state, size + 1);
        size_t length = s->corpus.size[other] - from;

        length = length < STANDALONE_CAPACITY - cut ? length : STANDALONE_CAPACITY - cut;
        memcpy(s->work + cut, s->corpus.data[other] + from, length);
        size = cut + length;
    }
    size = mutate(&s->state, s->work, size, STANDALONE_CAPACITY);
    search_try(s, s->work, size, 0);
}

static inline void search_start(struct search *s, const struct fuzz_seed *seeds, size_t seed_count, char **files)
{
    size_t i;

    for (i = 0; i < seed_count; i++) {
        search_try(s, seeds[i].data, seeds[i].size, 0);
    }
    for (; *files; files++) {
        size_t size;
        unsigned char *data = standalone_load(*files, STANDALONE_CAPACITY, &size);

        if (data) {
            search_try(s, data, size, !s->files_too);
        }
        free(data);
    }
}

static inline int standalone_search(int argc, char **argv, const struct fuzz_seed *seeds, size_t seed_count)
{
    struct search *const s = calloc(1, sizeof *s);
    const time_t end = time(NULL) + (argc > 2 ? (time_t)strtol(argv[2], NULL, 10) : 0);
    int at = 3;
    size_t i;

    if (!s) {
        return 1;
    }
    for (; at + 1 < argc && argv[at][0] == '-'; at += 2) {
        if (argv[at][1] == 'w' || argv[at][1] == 'm') {
            s->keep = argv[at + 1];
            s->files_too = argv[at][1] == 'm';
        } else {
            standalone_now.prefix = argv[at + 1];
        }
    }
    s->state = (uint64_t)time(NULL) * 2654435769u + 1;
    (void)signal(SIGABRT, standalone_on_abort);
    if (__sanitizer_set_death_callback) {
        __sanitizer_set_death_callback(standalone_death);
    }
    search_start(s, seeds, seed_count, argv + at);
    while (s->corpus.count > 0 && (s->inputs % 256 != 0 || time(NULL) < end)) {
        search_mutate(s);
    }
    printf("%lu inputs, of which %zu reached something new; no fault\n", s->inputs, s->corpus.count);
    for (i = 0; i < s->corpus.count; i++) {
        free(s->corpus.data[i]);
    }
    free(s);
    return 0;
}

#else

static inline int standalone_search(int argc, char **argv, const struct fuzz_seed *seeds, size_t seed_count)
{
    (void)argc;
    (void)seeds;
    (void)seed_count;
    fprintf(stderr, "%s: built without coverage: `make fuzz`\n", argv[0]);
    return 2;
}

#endif

/* What the parsers say of a million inputs is of no interest; sanitizers write to the descriptor itself. */
static inline void standalone_quiet(void)
{
#if defined(__GLIBC__)
    FILE *const nowhere = fopen("/dev/null", "w");

    stderr = nowhere ? nowhere : stderr;
#endif
}

static inline int standalone_main(int argc, char **argv, const struct fuzz_seed *seeds, size_t seed_count)
{
    int i, good = 1;

    if (argc >= 3 && strcmp(argv[1], "-n") == 0) {
        unsigned long count = strtoul(argv[2], NULL, 10);

        standalone_quiet();
        good = standalone_mutations(seeds, seed_count, count, argc > 3 ? strtoull(argv[3], NULL, 10) : 1);
        printf("%lu mutations of %zu seeds, no fault\n", count, seed_count);
        return good ? 0 : 1;
    }
    if (argc >= 3 && strcmp(argv[1], "-t") == 0) {
        standalone_quiet();
        return standalone_search(argc, argv, seeds, seed_count);
    }
    if (argc < 2) {
        fprintf(
            stderr,
            "usage: %s FILE...\n       %s -n COUNT [SEED]\n       %s -t SECONDS [-w DIR | -m DIR] [-f PREFIX] [FILE...]\n",
            argv[0], argv[0], argv[0]);
        return 2;
    }
    for (i = 1; i < argc; i++) {
        good &= standalone_file(argv[i]);
    }
    return good ? 0 : 1;
}

#endif

/* The program, where the target is not part of a test or of a fuzzer. */
#if defined(BRDFFIT_LIBFUZZER) || defined(BRDFFIT_FUZZ_IN_TEST)
#define FUZZ_MAIN(seeds, count)
#else
#define FUZZ_MAIN(seeds, count)                                                                                        \
    int main(int argc, char **argv)                                                                                    \
    {                                                                                                                  \
        return standalone_main(argc, argv, seeds, count);                                                              \
    }
#endif

#endif
