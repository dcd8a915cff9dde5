/*
 * Fuzz target: .npy and PFM. SPDX-License-Identifier: MIT
 */
#include "fuzz/array_claims.h"
#include "fuzz/standalone.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    claim_array(data, size, NULL);
    return 0;
}

#if !defined(BRDFFIT_LIBFUZZER)

#define SEED_COUNT 6

/* Static storage: filled by the first call. */
static const struct fuzz_seed *make_seeds(void)
{
    static unsigned char data[SEED_COUNT][1024];
    static struct fuzz_seed seeds[SEED_COUNT];
    static const char *const types[4] = {"<f4", ">f8", "|u1", "<f2"};
    static const size_t items[4] = {4, 8, 1, 2};
    size_t i, head;

    for (i = 0; i < 4; i++) {
        seeds[i].size = seed_npy(data[i], types[i], i % 2 ? "True" : "False", items[i]);
    }
    for (i = 4; i < 6; i++) {
        head = brdffit_io_pfm_header(3, 2, i == 4 ? 3 : 1, data[i]);
        memset(data[i] + head, 63, 24 * (i == 4 ? (size_t)3 : 1));
        seeds[i].size = head + 24 * (i == 4 ? (size_t)3 : 1);
    }
    for (i = 0; i < SEED_COUNT; i++) {
        seeds[i].data = data[i];
    }
    return seeds;
}

FUZZ_MAIN(make_seeds(), SEED_COUNT)
#endif
