/*
 * A bounded, deterministic run of the .npz fuzz target. SPDX-License-Identifier: MIT
 */
#define BRDFFIT_FUZZ_IN_TEST
#include "fuzz/fuzz_npz.c"

#include "io_support.h"

#include "fuzz/in_test.h"

static brdffit_status read_seed(const struct fuzz_seed *seed)
{
    brdffit_array *array = NULL;
    brdffit_error error;
    brdffit_status status = brdffit_io_array_open_memory(seed->data, seed->size, "b", &array, &error);

    brdffit_io_array_close(array);
    return status;
}

int main(int argc, char **argv)
{
    struct fuzz_run run = {make_seeds(), SEED_COUNT, 30000, read_seed};

    return run_fuzz_tests(argc, argv, &run);
}
