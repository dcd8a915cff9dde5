/*
 * A bounded, deterministic run of the text fuzz target. SPDX-License-Identifier: MIT
 */
#define BRDFFIT_FUZZ_IN_TEST
#include "fuzz/fuzz_csv.c"

#include "io_support.h"

static void test_mutations(void **state)
{
    (void)state;
    assert_true(standalone_mutations(seeds, seed_count, 60000, 1));
}

/* The seeds must be good input, otherwise the mutations explore nothing. */
static void test_seeds(void **state)
{
    size_t i;

    (void)state;
    for (i = 0; i < seed_count; i++) {
        brdffit_table *table;
        brdffit_error error;

        assert_int_equal(brdffit_io_read_memory(seeds[i].data, seeds[i].size, NULL, &table, &error), BRDFFIT_OK);
        brdffit_io_free(table);
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_seeds), cmocka_unit_test(test_mutations)};

    if (argc > 1) { /* also usable as the fuzz program itself */
        return standalone_main(argc, argv, seeds, seed_count);
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
