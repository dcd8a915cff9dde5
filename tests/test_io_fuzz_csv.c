/*
 * A bounded, deterministic run of the text fuzz target. SPDX-License-Identifier: MIT
 */
#define BRDFFIT_FUZZ_IN_TEST
#include "fuzz/fuzz_csv.c"

#include "io_support.h"

#include "fuzz/in_test.h"

static brdffit_status read_seed(const struct fuzz_seed *seed)
{
    brdffit_table *table = NULL;
    brdffit_error error;
    brdffit_status status = brdffit_io_read_memory(seed->data, seed->size, NULL, &table, &error);

    brdffit_io_free(table);
    return status;
}

int main(int argc, char **argv)
{
    struct fuzz_run run = {seeds, seed_count, 60000, read_seed};

    return run_fuzz_tests(argc, argv, &run);
}
