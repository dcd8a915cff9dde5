/*
 * MERL tables as sums against the same tables as samples: what they count, the fits, every instruction set to the bit,
 * errors, and what cannot be summed. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io_support.h"
#include "support.h"
#include "verify.h"

static char path[] = "/tmp/brdffit_sums_XXXXXX";

static void write_file(const void *data, size_t size)
{
    FILE *file = fopen(path, "wb");

    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* A lobe on a floor, with noise; a share of the cells is masked, some are -0 or 0. */
static struct io_merl random_table(int32_t n_h, int32_t n_d, int32_t n_p, double masked, uint64_t seed)
{
    struct io_merl merl = io_merl_new(n_h, n_d, n_p);
    struct brdffit_test_random random = {seed};
    size_t i, k, row = (size_t)n_d * (size_t)n_p;

    for (i = 0; i < merl.cells; i++) {
        double part = ((double)(i / row) + 0.3) / n_h, floor = brdffit_test_uniform(&random, 50.0, 70.0);
        int gone = brdffit_test_uniform(&random, 0.0, 1.0) < masked;

        for (k = 0; k < 3; k++) {
            double value = floor * (1.0 + (double)k) +
                           3000.0 * exp(-40.0 * part * part * part * part) * brdffit_test_uniform(&random, 0.8, 1.2);

            io_put(&merl, k, i, gone && k == i % 3 ? -1.0 : i % 97 == 5 ? -0.0 : value);
        }
    }
    return merl;
}

struct both {
    brdffit_table *samples, *sums;
};

static struct both read_both(const brdffit_io_options *io, const brdffit_options *options)
{
    struct both both = {NULL, NULL};
    brdffit_error error;
    int i;

    assert_int_equal(brdffit_io_read(path, io, &both.samples, &error), BRDFFIT_OK);
    assert_int_equal(brdffit_io_read_sums(path, io, options, &both.sums, &error), BRDFFIT_OK);
    assert_int_equal(both.sums->samples->count, both.samples->samples->count);
    assert_int_equal(both.sums->samples->channels, 3);
    assert_int_equal(both.sums->rows, both.samples->rows);
    assert_memory_equal(both.sums->dims, both.samples->dims, sizeof both.sums->dims);
    assert_int_equal(both.sums->compressed, both.samples->compressed);
    assert_string_equal(both.sums->channel_names[2], both.samples->channel_names[2]);
    for (i = 0; i < BRDFFIT_IO_DROP_COUNT; i++) {
        assert_int_equal(both.sums->dropped[i], both.samples->dropped[i]);
    }
    return both;
}

static void free_both(struct both *both)
{
    brdffit_io_free(both->samples);
    brdffit_io_free(both->sums);
}

/* Fit the sums; the result lives in *workspace. */
static struct brdffit_test_result fit_sums(const brdffit_table *table, const brdffit_options *options, void **workspace)
{
    size_t size = brdffit_sums_workspace_size(table->sums, options);
    struct brdffit_test_result result;
    brdffit_error error;

    *workspace = malloc(size);
    assert_non_null(*workspace);
    assert_int_equal(brdffit_test_run_sums(table->sums, options, *workspace, size, &result, &error), BRDFFIT_OK);
    return result;
}

static void close_to(const char *what, double got, double expected, double allowed)
{
    if (!(fabs(got - expected) <= allowed)) {
        fail_msg("%s: %.17g, expected %.17g +- %g", what, got, expected, allowed);
    }
}

/* The claims hold for the samples, and the fit of the samples says the same. */
static void check_fit(const struct both *both, const brdffit_options *options)
{
    struct brdffit_test_fit direct;
    void *workspace;
    struct brdffit_test_result result = fit_sums(both->sums, options, &workspace);
    double largest[3];
    char why[512];
    size_t k;

    /* The judge knows of no e2_error: where a table of few cells is fitted exactly, it cannot judge. */
    if (result.e2 > 1e3 * result.e2_error &&
        brdffit_test_verify_deep(both->samples->samples, options, &result, 20, 1, why, sizeof why)) {
        fail_msg("%s, lobes %d: %s", brdffit_distribution_string(options->distribution), options->lobes, why);
    }
    brdffit_test_fit(both->samples->samples, options, &direct);
    assert_int_equal(result.distinct_c, direct.result.distinct_c);
    close_to("sum of squares", result.sum_of_squares, direct.result.sum_of_squares, 1e-13 * result.sum_of_squares);
    close_to("E^2", result.e2, direct.result.e2, result.e2_error + options->relative_gap * result.e2);
    assert_true(result.lower_bound <= direct.result.e2 && direct.result.lower_bound <= result.e2 + result.e2_error);
    for (k = 0; k < 3; k++) {
        largest[k] = brdffit_sums_largest(both->sums->sums, k);
        assert_true(result.channel_scale[k] == (options->normalise == BRDFFIT_NORMALISE_MAX ? largest[k] : 1.0));
        assert_true(result.channel_scale[k] == direct.result.channel_scale[k]);
    }
    brdffit_test_fit_free(&direct);
    free(workspace);
}

static void test_tables(void **state)
{
    static const int32_t dims[][3] = {{4, 3, 6},   {1, 1, 1},   {9, 10, 4}, {3, 20, 2},
                                      {7, 5, 180}, {12, 9, 37}, {2, 3, 600}};
    size_t i;

    (void)state;
    for (i = 0; i < 4 * sizeof dims / sizeof *dims; i++) {
        const int32_t *d = dims[i / 4];
        struct io_merl merl = random_table(d[0], d[1], d[2], i % 4 == 2 ? 0.3 : 0.0, i);
        brdffit_io_options io;
        brdffit_options options;
        struct both both;

        brdffit_io_options_init(&io);
        io.merl_bins = i & 1 ? BRDFFIT_IO_MERL_CENTRE : BRDFFIT_IO_MERL_EDGE;
        brdffit_options_init(&options);
        options.lobes = 1 + (int)(i % 2);
        options.max_incidence = i % 3 == 1 ? 90.0 : 60.0;
        options.normalise = i % 5 == 1 ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
        options.distribution = (brdffit_distribution)(i % BRDFFIT_LAFORTUNE); /* the last is another test's */
        write_file(merl.data, merl.size);
        both = read_both(&io, &options);
        assert_non_null(both.sums->sums);
        assert_null(both.sums->samples->values);
        check_fit(&both, &options);
        free_both(&both);
        free(merl.data);
    }
}

static void test_instruction_sets(void **state)
{
    struct io_merl merl = random_table(11, 9, 61, 0.1, 3);
    int distribution, isa;

    (void)state;
    write_file(merl.data, merl.size);
    for (distribution = 0; distribution < BRDFFIT_LAFORTUNE; distribution++) {
        struct brdffit_test_result first = {.e2 = 0.0};
        double x[3] = {0.0}, y[3] = {0.0};

        for (isa = BRDFFIT_ISA_BASE; isa < BRDFFIT_ISA_COUNT; isa++) {
            brdffit_table *table = NULL;
            brdffit_options options;
            struct brdffit_test_result result;
            void *workspace;

            brdffit_options_init(&options);
            options.distribution = (brdffit_distribution)distribution;
            options.isa = (brdffit_isa)isa;
            if (!brdffit_isa_supported(options.isa)) {
                continue;
            }
            assert_int_equal(brdffit_io_read_sums(path, NULL, &options, &table, NULL), BRDFFIT_OK);
            result = fit_sums(table, &options, &workspace);
            if (isa == BRDFFIT_ISA_BASE) {
                first = result;
                memcpy(x, result.model.x, sizeof x);
                memcpy(y, result.model.y, sizeof y);
            }
            assert_memory_equal(&result.e2, &first.e2, sizeof first.e2);
            assert_memory_equal(&result.lower_bound, &first.lower_bound, sizeof first.lower_bound);
            assert_memory_equal(&result.lobe[0].effective_samples, &first.lobe[0].effective_samples, sizeof(double));
            assert_memory_equal(result.model.x, x, sizeof x);
            assert_memory_equal(result.model.y, y, sizeof y);
            free(workspace);
            brdffit_io_free(table);
        }
    }
    free(merl.data);
}

/* The same message and cell as the reader of samples, wherever the entry is. */
static void test_not_finite(void **state)
{
    static const size_t cells[] = {0, 7, 64, 65, 1439, 2000, 3599};
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    size_t i;

    (void)state;
    for (i = 0; i < 3 * sizeof cells / sizeof *cells; i++) {
        struct io_merl merl = random_table(10, 9, 40, 0.2, i);
        brdffit_table *table = NULL;
        brdffit_error error, same;

        io_put(&merl, i % 3, cells[i / 3], bad[(i / 2) % 3]);
        write_file(merl.data, merl.size);
        assert_int_equal(brdffit_io_read(path, NULL, &table, &same), BRDFFIT_ERR_VALUE);
        assert_int_equal(brdffit_io_read_sums(path, NULL, NULL, &table, &error), BRDFFIT_ERR_VALUE);
        assert_null(table);
        assert_string_equal(error.message, same.message);
        assert_int_equal(error.sample, cells[i / 3]);
        assert_int_equal(error.channel, i % 3);
        free(merl.data);
    }
}

/* gzip; a table of huge values, of Lafortune's c, of no cells that count; text; samples after all. */
static void test_other_ways(void **state)
{
    struct io_merl merl = random_table(6, 5, 8, 0.0, 9);
    brdffit_options options;
    brdffit_io_options io;
    brdffit_table *table = NULL;
    struct both both;
    brdffit_error error;
    unsigned char *packed;
    size_t size, i;

    (void)state;
    packed = io_gzip(merl.data, merl.size, &size);
    write_file(packed, size);
    free(packed);
    brdffit_options_init(&options);
    both = read_both(NULL, &options);
    assert_true(both.sums->compressed && both.sums->sums);
    check_fit(&both, &options);
    assert_int_equal(brdffit_io_samples(both.sums, &error), BRDFFIT_OK);
    assert_int_equal(brdffit_io_samples(both.sums, &error), BRDFFIT_OK);
    assert_null(both.sums->sums);
    assert_true(both.sums->compressed);
    assert_memory_equal(both.sums->samples->values, both.samples->samples->values,
                        3 * both.samples->samples->count * sizeof(double));
    free_both(&both);

    write_file(merl.data, merl.size);
    options.distribution = BRDFFIT_LAFORTUNE;
    both = read_both(NULL, &options);
    assert_null(both.sums->sums);
    free_both(&both);
    brdffit_options_init(&options);
    brdffit_io_options_init(&io);
    io.merl_sampling = BRDFFIT_IO_MERL_PROTOCOL84;
    both = read_both(&io, &options);
    assert_null(both.sums->sums);
    free_both(&both);
    io_put(&merl, 1, 3, 1e140);
    write_file(merl.data, merl.size);
    both = read_both(NULL, &options);
    assert_null(both.sums->sums);
    free_both(&both);
    for (i = 0; i < merl.cells; i++) {
        io_put(&merl, 2, i, -1.0);
    }
    write_file(merl.data, merl.size);
    assert_int_equal(brdffit_io_read_sums(path, NULL, NULL, &table, &error), BRDFFIT_ERR_NO_SAMPLES);
    write_file(merl.data, merl.size - 1);
    assert_int_equal(brdffit_io_read_sums(path, NULL, NULL, &table, &error), BRDFFIT_ERR_FORMAT);
    write_file("a,b,c,i\n1,2,3,4\n", 16);
    assert_int_equal(brdffit_io_read_sums(path, NULL, NULL, &table, &error), BRDFFIT_OK);
    assert_true(table->sums == NULL && table->samples->count == 1);
    brdffit_io_free(table);
    assert_int_equal(brdffit_io_read_sums("/nowhere/at all", NULL, NULL, &table, &error), BRDFFIT_ERR_OPEN);
    assert_int_equal(brdffit_io_read_sums(NULL, NULL, NULL, &table, &error), BRDFFIT_ERR_ARGUMENT);
    free(merl.data);
}

/* A named pipe is opened once, and its writer is not cut off. */
static void test_pipe(void **state)
{
    static char fifo[] = "/tmp/brdffit_sums_fifo_XXXXXX";
    struct io_merl merl = random_table(30, 9, 40, 0.0, 4);
    brdffit_table *table = NULL;
    brdffit_error error;
    pid_t writer;
    int status;

    (void)state;
    assert_int_equal(close(mkstemp(fifo)), 0);
    assert_int_equal(unlink(fifo), 0);
    assert_int_equal(mkfifo(fifo, 0600), 0);
    writer = fork();
    if (writer == 0) {
        FILE *file = fopen(fifo, "wb");

        _exit(!(file && fwrite(merl.data, 1, merl.size, file) == merl.size && fclose(file) == 0));
    }
    assert_true(writer > 0);
    assert_int_equal(brdffit_io_read_sums(fifo, NULL, NULL, &table, &error), BRDFFIT_OK);
    assert_true(table->sums && table->rows == merl.cells);
    assert_int_equal(waitpid(writer, &status, 0), writer);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    assert_int_equal(unlink(fifo), 0);
    brdffit_io_free(table);
    free(merl.data);
}

static int open_path(void **state)
{
    int descriptor = mkstemp(path);

    (void)state;
    return descriptor < 0 ? -1 : close(descriptor);
}

static int remove_path(void **state)
{
    (void)state;
    return unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tables),     cmocka_unit_test(test_instruction_sets),
        cmocka_unit_test(test_not_finite), cmocka_unit_test(test_other_ways),
        cmocka_unit_test(test_pipe),
    };

    return cmocka_run_group_tests(tests, open_path, remove_path);
}
