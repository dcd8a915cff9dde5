/*
 * A bounded, deterministic run of a fuzz target as a test. Include after the target and io_support.h.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_FUZZ_IN_TEST_H
#define BRDFFIT_FUZZ_IN_TEST_H

struct fuzz_run {
    const struct fuzz_seed *seeds;
    size_t count;
    unsigned long mutations;
    brdffit_status (*read)(const struct fuzz_seed *seed); /* and release */
};

static void test_mutations(void **state)
{
    const struct fuzz_run *run = *state;

    assert_true(standalone_mutations(run->seeds, run->count, run->mutations, 1));
}

/* The seeds must be good input, otherwise the mutations explore nothing. */
static void test_seeds(void **state)
{
    const struct fuzz_run *run = *state;
    size_t i;

    for (i = 0; i < run->count; i++) {
        assert_int_equal(run->read(&run->seeds[i]), BRDFFIT_OK);
    }
}

/* With arguments, the fuzz program itself. */
static int run_fuzz_tests(int argc, char **argv, struct fuzz_run *run)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test_prestate(test_seeds, run),
                                       cmocka_unit_test_prestate(test_mutations, run)};

    if (argc > 1) {
        return standalone_main(argc, argv, run->seeds, run->count);
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
