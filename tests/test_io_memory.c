/*
 * Every allocation of the readers fails once: the reading says so, and nothing leaks. SPDX-License-Identifier: MIT
 *
 * This program brings its own memory.c, compiled with failure injection; the linker then takes every other part
 * from the library as it is. zlib's allocations come through it as well.
 */
#define _POSIX_C_SOURCE 200809L
#define BRDFFIT_TEST_ALLOC
#include "io/bytes/memory.c"

#include <unistd.h>

#define BRDFFIT_FUZZ_IN_TEST
#include "fuzz/fuzz_npz.c"
#include "io_support.h"

static brdffit_status read_one(const void *data, size_t size, const char *path, const brdffit_io_options *options,
                               int sums, brdffit_table **table, brdffit_error *error)
{
    if (sums) {
        return data ? brdffit_io_read_sums_memory(data, size, options, NULL, table, error)
                    : brdffit_io_read_sums(path, options, NULL, table, error);
    }
    return data ? brdffit_io_read_memory(data, size, options, table, error)
                : brdffit_io_read(path, options, table, error);
}

/* Read `data` (or, with data NULL, `path`), failing allocation 0, 1, ... until none is left to fail. */
static size_t fail_each_of(const void *data, size_t size, const char *path, const brdffit_io_options *options, int sums)
{
    long k;

    for (k = 0; k < 100000; k++) {
        brdffit_table *table = (brdffit_table *)&table;
        brdffit_error error;
        brdffit_status status;

        memset(&error, 0, sizeof error);
        brdffit_io_test_fail_after(k);
        status = read_one(data, size, path, options, sums, &table, &error);
        brdffit_io_test_fail_after(-1);
        if (status == BRDFFIT_OK) {
            assert_true(brdffit_io_test_live() > 0);
            brdffit_io_free(table);
            assert_int_equal(brdffit_io_test_live(), 0);
            return (size_t)k;
        }
        io_assert_failed(status, table, &error, BRDFFIT_ERR_MEMORY, "out of memory");
        assert_int_equal(brdffit_io_test_live(), 0);
    }
    fail();
    return 0;
}

static size_t fail_each(const void *data, size_t size, const char *path, const brdffit_io_options *options)
{
    return fail_each_of(data, size, path, options, 0);
}

static void test_csv(void **state)
{
    /* clang-format off */
    static const char *const text[] = {
        "theta_i,theta_o,weight,r,g,b\n1,2,3,4,5,6\n1,1,1,,1,1\n",
        "lx;ly;lz;vx;vy;vz;nx;ny;nz;\"one \"\"name\"\"\"\n0;0;1;0;0;1;0;0;1;5\n",
        "a,b,c,r\n1,1,1,0.0000000000000000000000000000000000000000000000000000000000000000000000000000000000"
        "000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000001\n",
    };
    /* clang-format on */
    size_t i;

    (void)state;
    for (i = 0; i < sizeof text / sizeof *text; i++) {
        /* The table, its names, roles, fields, arrays: at least these. */
        assert_true(fail_each(text[i], strlen(text[i]), NULL, NULL) >= 8);
    }
}

static void test_csv_grows(void **state)
{
    char *text = malloc(100000), *at = text;
    int i;

    (void)state;
    assert_non_null(text);
    at += sprintf(at, "theta_i,theta_o,w,r\n");
    for (i = 0; i < 2000; i++) {
        at += sprintf(at, "%d,%d,1,%d\n", i % 90, i % 80, i);
    }
    assert_true(fail_each(text, (size_t)(at - text), NULL, NULL) >= 20);
    free(text);
}

static void test_merl(void **state)
{
    static const double up[3] = {0, 0, 1};
    struct io_merl merl = io_merl_new(4, 3, 6);
    brdffit_io_options options;
    brdffit_samples at;

    (void)state;
    brdffit_io_options_init(&options);
    assert_true(fail_each(merl.data, merl.size, NULL, &options) >= 16);
    options.merl_sampling = BRDFFIT_IO_MERL_PROTOCOL84;
    assert_true(fail_each(merl.data, merl.size, NULL, &options) >= 8);
    brdffit_samples_init(&at);
    at.count = 1;
    at.light = up;
    at.view = up;
    at.normal = up;
    at.weights = up + 2;
    options.merl_sampling = BRDFFIT_IO_MERL_DIRECTIONS;
    options.directions = &at;
    assert_true(fail_each(merl.data, merl.size, NULL, &options) >= 10);
    free(merl.data);
}

static void test_gzip(void **state)
{
    struct io_merl merl = io_merl_new(30, 30, 10);
    unsigned char *gz;
    size_t size, plain = fail_each(merl.data, merl.size, NULL, NULL);

    (void)state;
    gz = io_gzip(merl.data, merl.size, &size);
    assert_true(fail_each(gz, size, NULL, NULL) >= plain + 3);
    assert_true(fail_each_of(merl.data, merl.size, NULL, NULL, 1) >= 10);
    assert_true(fail_each_of(gz, size, NULL, NULL, 1) >= 13);
    free(gz);
    free(merl.data);
}

static void test_file(void **state)
{
    static const char text[] = "theta_i,theta_o,r\n1,2,3\n";
    char path[] = "/tmp/brdffit_memory_XXXXXX";
    int file = mkstemp(path);

    (void)state;
    assert_true(file >= 0);
    assert_int_equal(write(file, text, sizeof text - 1), sizeof text - 1);
    assert_int_equal(close(file), 0);
    assert_true(fail_each(NULL, 0, path, NULL) > fail_each(text, sizeof text - 1, NULL, NULL));
    assert_int_equal(unlink(path), 0);
}

/* Failures of other kinds leak nothing either. */
static void test_refusals(void **state)
{
    static const char *const text[] = {"",
                                       "x",
                                       "theta_i,theta_o,r,r\n",
                                       "theta_i,theta_o,r\n1,2\n",
                                       "theta_i,theta_o,r\n1,2,x\n",
                                       "theta_i,theta_o,r\n1,2,\n",
                                       "theta_i,theta_o\n",
                                       "a,b,c,\"r\n",
                                       "a,b,c,r,lx\n",
                                       "\x1f\x8b\x08",
                                       "\001\002"};
    size_t i;

    (void)state;
    for (i = 0; i < sizeof text / sizeof *text; i++) {
        brdffit_table *table;
        brdffit_error error;

        assert_int_not_equal(io_text(text[i], NULL, &table, &error), BRDFFIT_OK);
        assert_null(table);
        assert_int_equal(brdffit_io_test_live(), 0);
    }
}

static void test_sizes(void **state)
{
    void *block;

    (void)state;
    assert_null(brdffit_io_alloc((size_t)-1 / 2, 3)); /* overflows */
    block = brdffit_io_alloc(0, 8);
    assert_non_null(block);
    brdffit_io_release(block);
    brdffit_io_release(NULL);
    assert_int_equal(brdffit_io_test_live(), 0);
}

/* An array in a .npz: file or memory, stored or deflated. */
static void test_array(void **state)
{
    const struct fuzz_seed *seeds = make_seeds();
    size_t i;
    long k;

    (void)state;
    for (i = 0; i < SEED_COUNT; i++) {
        for (k = 0;; k++) {
            brdffit_array *array = (brdffit_array *)&array;
            brdffit_error error;
            brdffit_status status;

            assert_true(k < 100);
            memset(&error, 0, sizeof error);
            brdffit_io_test_fail_after(k);
            status = brdffit_io_array_open_memory(seeds[i].data, seeds[i].size, "b", &array, &error);
            brdffit_io_test_fail_after(-1);
            if (status == BRDFFIT_OK) {
                brdffit_io_array_close(array);
                break;
            }
            io_assert_failed(status, (brdffit_table *)array, &error, BRDFFIT_ERR_MEMORY, "out of memory");
            assert_int_equal(brdffit_io_test_live(), 0);
        }
        assert_int_equal(brdffit_io_test_live(), 0);
        assert_true(k >= (i == 0 ? 4 : 6)); /* array, tail, directory, header; unpacked bytes and zlib's */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_csv),   cmocka_unit_test(test_csv_grows), cmocka_unit_test(test_merl),
        cmocka_unit_test(test_gzip),  cmocka_unit_test(test_file),      cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_sizes), cmocka_unit_test(test_array),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
