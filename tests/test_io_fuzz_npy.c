/*
 * A bounded, deterministic run of the .npy fuzz target. SPDX-License-Identifier: MIT
 */
#define BRDFFIT_FUZZ_IN_TEST
#include "fuzz/fuzz_npy.c"

#include "io_support.h"

static void test_mutations(void **state)
{
    (void)state;
    assert_true(standalone_mutations(make_seeds(), SEED_COUNT, 30000, 1));
}

/* The seeds must be good input, otherwise the mutations explore nothing. */
static void test_seeds(void **state)
{
    const struct fuzz_seed *seeds = make_seeds();
    size_t i;

    (void)state;
    for (i = 0; i < SEED_COUNT; i++) {
        brdffit_array *array;
        brdffit_error error;

        assert_int_equal(brdffit_io_array_open_memory(seeds[i].data, seeds[i].size, NULL, &array, &error), BRDFFIT_OK);
        brdffit_io_array_close(array);
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_seeds), cmocka_unit_test(test_mutations)};

    if (argc > 1) { /* also usable as the fuzz program itself */
        return standalone_main(argc, argv, make_seeds(), SEED_COUNT);
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
