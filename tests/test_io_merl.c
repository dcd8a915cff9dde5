/*
 * MERL .binary tables, whole. Look-ups: test_io_merl_lookup.c. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include "io_support.h"

static const long double right_angle = 1.57079632679489661923132169163975144L;

static brdffit_table *read_good(const struct io_merl *merl, const brdffit_io_options *options)
{
    brdffit_table *table = NULL;
    brdffit_error error;

    memset(&error, 0, sizeof error);
    if (brdffit_io_read_memory(merl->data, merl->size, options, &table, &error) != BRDFFIT_OK) {
        print_error("refused: %s\n", error.message);
        fail();
    }
    return table;
}

static void refuse(const void *data, size_t size, brdffit_io_format format, brdffit_status expected,
                   const char *message, double value)
{
    brdffit_io_options options;
    brdffit_table *table;
    brdffit_error error;
    brdffit_status status;

    brdffit_io_options_init(&options);
    options.format = format;
    status = brdffit_io_read_memory(data, size, &options, &table, &error);
    io_assert_failed(status, table, &error, expected, message);
    assert_same(error.value, value);
    assert_int_equal(error.line, BRDFFIT_NONE);
    assert_int_equal(error.column, BRDFFIT_NONE);
}

/* What cell (h, d, p) stands for, from the definition; 0 when it is on or below the horizon. */
static int exact_cell(const size_t dims[3], size_t h, size_t d, size_t p, long double offset, long double out[4])
{
    long double part = ((long double)h + offset) / (long double)dims[0], th = right_angle * part * part;
    long double td = right_angle * ((long double)d + offset) / (long double)dims[1];
    long double pd = 2 * right_angle * ((long double)p + offset) / (long double)dims[2];
    long double up = cosl(th) * cosl(td), across = sinl(th) * sinl(td) * cosl(pd);

    out[0] = up - across;
    out[1] = up + across;
    out[2] = tanl(th) * tanl(th);
    out[3] = cosl(td);
    return out[0] > 1e-15L && out[1] > 1e-15L;
}

static void check_whole(int32_t n_h, int32_t n_d, int32_t n_p, brdffit_io_merl_bins bins)
{
    static const double scale[3] = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};
    struct io_merl merl = io_merl_new(n_h, n_d, n_p);
    brdffit_io_options options;
    brdffit_table *table;
    const brdffit_samples *s;
    size_t h, d, p, k, at = 0, below = 0, cell = 0;
    long double exact[4];

    brdffit_io_options_init(&options);
    options.merl_bins = bins;
    table = read_good(&merl, &options);
    s = table->samples;
    for (h = 0; h < table->dims[0]; h++) {
        double row = NAN; /* tan^2 of this theta_h: the same bits in every cell */

        for (d = 0; d < table->dims[1]; d++) {
            for (p = 0; p < table->dims[2]; p++, cell++) {
                if (!exact_cell(table->dims, h, d, p, bins == BRDFFIT_IO_MERL_CENTRE ? 0.5L : 0.0L, exact)) {
                    below++;
                    continue;
                }
                assert_true(at < s->count);
                io_assert_near(s->cos_light[at], exact[0], 1e-15);
                io_assert_near(s->cos_view[at], exact[1], 1e-15);
                io_assert_near(s->tan2_half[at], exact[2], 2e-15 * (double)exact[2]);
                io_assert_near(s->cos_difference[at], exact[3], 4e-16);
                assert_true(s->cos_light[at] <= 1.0 && s->cos_view[at] <= 1.0);
                assert_true(s->cos_difference[at] > 0.0 && s->cos_difference[at] <= 1.0);
                row = row == row ? row : s->tan2_half[at];
                assert_memory_equal(&s->tan2_half[at], &row, sizeof row);
                for (k = 0; k < 3; k++) {
                    assert_same(s->values[3 * at + k], (double)(1 + cell + 10000 * k) * scale[k]);
                }
                at++;
            }
        }
    }
    assert_int_equal(s->count, at);
    assert_int_equal(table->rows, cell);
    assert_int_equal(table->dropped[BRDFFIT_IO_DROP_BELOW_HORIZON], below);
    assert_int_equal(table->dropped[BRDFFIT_IO_DROP_MASKED], 0);
    assert_int_equal(table->merl_bins, bins);
    brdffit_io_free(table);
    free(merl.data);
}

static void test_every_cell(void **state)
{
    /* In the last, cos^2 + sin^2 of theta_h = theta_d = 2.5 degrees rounds above 1. */
    static const int32_t dims[][3] = {{4, 3, 6},   {1, 1, 1},    {90, 9, 4}, {3, 90, 2},
                                      {7, 5, 180}, {30, 18, 12}, {2, 1, 1},  {6, 36, 2}};
    size_t i;

    (void)state;
    for (i = 0; i < sizeof dims / sizeof *dims; i++) {
        check_whole(dims[i][0], dims[i][1], dims[i][2], BRDFFIT_IO_MERL_EDGE);
        check_whole(dims[i][0], dims[i][1], dims[i][2], BRDFFIT_IO_MERL_CENTRE);
    }
}

static void test_what_it_says(void **state)
{
    struct io_merl merl = io_merl_new(4, 3, 6);
    brdffit_table *table = read_good(&merl, NULL);
    const brdffit_samples *s = table->samples;
    brdffit_io_options options;

    (void)state;
    assert_in_range(s->struct_size, offsetof(brdffit_samples, weights) + sizeof s->weights, sizeof *s);
    assert_int_equal(s->form, BRDFFIT_FORM_ANGLES);
    assert_int_equal(s->quantity, BRDFFIT_QUANTITY_BRDF);
    assert_int_equal(s->channels, 3);
    assert_null(s->light);
    assert_null(s->a);
    assert_null(s->weights);
    assert_null(table->lines);
    assert_string_equal(table->channel_names[0], "r");
    assert_string_equal(table->channel_names[1], "g");
    assert_string_equal(table->channel_names[2], "b");
    assert_int_equal(table->format, BRDFFIT_IO_FORMAT_MERL);
    assert_int_equal(table->dims[0], 4);
    assert_int_equal(table->dims[1], 3);
    assert_int_equal(table->dims[2], 6);
    assert_int_equal(table->rows, 72);
    assert_int_equal(table->merl_sampling, BRDFFIT_IO_MERL_TABLE);
    assert_int_equal(table->negative, 0);
    /* Cell 0 looks along the normal. */
    assert_same(s->cos_light[0], 1);
    assert_same(s->cos_view[0], 1);
    assert_same(s->tan2_half[0], 0);
    assert_same(s->cos_difference[0], 1);
    brdffit_io_free(table);
    brdffit_io_options_init(&options);
    options.quantity_set = 1;
    options.quantity = BRDFFIT_QUANTITY_RADIANCE;
    options.format = BRDFFIT_IO_FORMAT_MERL;
    table = read_good(&merl, &options);
    assert_int_equal(table->samples->quantity, BRDFFIT_QUANTITY_RADIANCE);
    brdffit_io_free(table);
    free(merl.data);
}

/* 60 degrees and 30 degrees in plane lie exactly on the horizon, and no rounding may say otherwise. */
static void test_exactly_on_the_horizon(void **state)
{
    struct io_merl merl = io_merl_new(3, 18, 2); /* theta_h 0, 10, 40; theta_d by 5; phi_d 0, 90 */
    brdffit_table *table = read_good(&merl, NULL);
    size_t i;

    (void)state;
    for (i = 0; i < table->samples->count; i++) {
        assert_true(table->samples->cos_light[i] > 1e-3 && table->samples->cos_view[i] > 1e-3);
    }
    /* Below or on: theta_h = 10 with theta_d = 80, 85; 40 with 50 ... 85: 2 + 8, at phi_d = 0 alone. */
    assert_int_equal(table->dropped[BRDFFIT_IO_DROP_BELOW_HORIZON], 10);
    brdffit_io_free(table);
    free(merl.data);
}

/* A negative entry in any channel masks the cell; below the horizon counts first, masked or not. */
static void test_masked(void **state)
{
    struct io_merl merl = io_merl_new(3, 18, 2);
    brdffit_table *table;
    size_t low = 2 + 2 * (17 + 18 * 2) - 2; /* (h 2, d 17, p 0) */

    (void)state;
    io_put(&merl, 0, 0, -1.0);
    io_put(&merl, 1, 1, -1e-300);
    io_put(&merl, 2, 2, -5.0);
    io_put(&merl, 0, 3, -0.0); /* zero, not negative */
    io_put(&merl, 1, 4, 0.0);
    io_put(&merl, 0, low, -1.0);
    table = read_good(&merl, NULL);
    assert_int_equal(table->dropped[BRDFFIT_IO_DROP_MASKED], 3);
    assert_int_equal(table->dropped[BRDFFIT_IO_DROP_BELOW_HORIZON], 10);
    assert_int_equal(table->samples->count, merl.cells - 13);
    assert_same(table->samples->values[0], 0.0); /* the fourth cell comes first now */
    assert_same(table->samples->values[1], 10004 * (1.15 / 1500.0));
    brdffit_io_free(table);
    free(merl.data);
}

static void test_all_masked(void **state)
{
    struct io_merl merl = io_merl_new(4, 3, 6);
    size_t i;

    (void)state;
    for (i = 0; i < merl.cells; i++) {
        io_put(&merl, i % 3, i, -1.0);
    }
    refuse(merl.data, merl.size, BRDFFIT_IO_FORMAT_AUTO, BRDFFIT_ERR_NO_SAMPLES, "masked", 0);
    free(merl.data);
}

static void test_not_finite(void **state)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    size_t i, channel;

    (void)state;
    for (i = 0; i < 3; i++) {
        for (channel = 0; channel < 3; channel++) {
            struct io_merl merl = io_merl_new(4, 3, 6);
            brdffit_io_options options;
            brdffit_table *table;
            brdffit_error error;
            brdffit_status status;

            io_put(&merl, channel, 71 - i, bad[i]);
            brdffit_io_options_init(&options);
            options.merl_sampling = i ? BRDFFIT_IO_MERL_TABLE : BRDFFIT_IO_MERL_PROTOCOL84;
            status = brdffit_io_read_memory(merl.data, merl.size, &options, &table, &error);
            io_assert_failed(status, table, &error, BRDFFIT_ERR_VALUE, "NaN or an infinity");
            assert_int_equal(error.sample, 71 - i);
            assert_int_equal(error.channel, channel);
            assert_same(error.value, bad[i]);
            free(merl.data);
        }
    }
}

/* Every length but the right one. */
static void test_wrong_size(void **state)
{
    struct io_merl merl = io_merl_new(4, 3, 6);
    unsigned char *longer = malloc(merl.size + 1);
    size_t size;

    (void)state;
    assert_non_null(longer);
    memcpy(longer, merl.data, merl.size);
    longer[merl.size] = 0;
    refuse(longer, 0, BRDFFIT_IO_FORMAT_MERL, BRDFFIT_ERR_FORMAT, "empty", 0);
    for (size = 1; size < 12; size++) {
        refuse(longer, size, BRDFFIT_IO_FORMAT_AUTO, BRDFFIT_ERR_FORMAT, "than the 12-byte header", (double)size);
        refuse(longer, size, BRDFFIT_IO_FORMAT_MERL, BRDFFIT_ERR_FORMAT, "than the 12-byte header", (double)size);
    }
    for (; size < merl.size; size++) {
        refuse(longer, size, BRDFFIT_IO_FORMAT_AUTO, BRDFFIT_ERR_FORMAT, "shorter than its header says",
               (double)merl.size);
    }
    refuse(longer, merl.size + 1, BRDFFIT_IO_FORMAT_AUTO, BRDFFIT_ERR_FORMAT, "longer than its header says",
           (double)merl.size);
    free(longer);
    free(merl.data);
}

/* A header that lies: nothing is allocated by what it says (ASan and ulimit would notice). */
static void test_lying_header(void **state)
{
    static const struct {
        int32_t dims[3];
        const char *message;
        double value;
        int automatic; /* seen for a MERL table without being told */
    } lie[] = {
        {{5, 3, 6}, "shorter than its header says", 12 + 24.0 * 90, 1},
        {{4, 3, 5}, "longer than its header says", 12 + 24.0 * 60, 1},
        {{90, 90, 180}, "shorter than its header says", 34992012, 1},
        {{0, 3, 6}, "not positive", 0, 0},
        {{4, -3, 6}, "not positive", -3, 0},
        {{4, 3, INT32_MIN}, "not positive", (double)INT32_MIN, 0},
        {{INT32_MAX, INT32_MAX, INT32_MAX}, "overflows", 2147483647.0 * 2147483647.0 * 2147483647.0, 0},
        /* 2^62 cells: 24 times that wraps around to 0 modulo 2^64 */
        {{1 << 30, 1 << 30, 4}, "overflows", 4611686018427387904.0, 0},
        /* the largest product of these that fits 64 bits */
        {{INT32_MAX, INT32_MAX / 8, 1}, "shorter than its header says", 12 + 24.0 * (2147483647.0 * 268435455.0), 1},
    };
    size_t i;

    (void)state;
    for (i = 0; i < sizeof lie / sizeof *lie; i++) {
        struct io_merl merl = io_merl_new(4, 3, 6);
        int k;

        for (k = 0; k < 3; k++) {
            io_put_int(merl.data + 4 * k, lie[i].dims[k]);
        }
        refuse(merl.data, merl.size, BRDFFIT_IO_FORMAT_MERL, BRDFFIT_ERR_FORMAT, lie[i].message, lie[i].value);
        refuse(merl.data, merl.size, BRDFFIT_IO_FORMAT_AUTO, BRDFFIT_ERR_FORMAT,
               lie[i].automatic ? lie[i].message : "neither a text table nor a MERL",
               lie[i].automatic ? lie[i].value : 0);
        free(merl.data);
    }
}

static void test_other_binaries(void **state)
{
    static const unsigned char png[] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1", npy[] = "\x93NUMPY\1\0v\0{'descr': ";
    brdffit_io_options options;
    brdffit_table *table;
    brdffit_error error;
    brdffit_status status;

    (void)state;
    refuse(png, sizeof png, BRDFFIT_IO_FORMAT_AUTO, BRDFFIT_ERR_FORMAT, "neither a text table nor a MERL", 0);
    refuse(npy, sizeof npy, BRDFFIT_IO_FORMAT_AUTO, BRDFFIT_ERR_FORMAT, "neither a text table nor a MERL", 0);
    brdffit_io_options_init(&options);
    options.format = BRDFFIT_IO_FORMAT_CSV;
    status = brdffit_io_read_memory(npy, sizeof npy, &options, &table, &error);
    io_assert_failed(status, table, &error, BRDFFIT_ERR_FORMAT, "control characters");
    assert_int_equal(error.line, 1);
}

/* What is for text is not left unheard. */
static void test_options_of_text(void **state)
{
    struct io_merl merl = io_merl_new(6, 4, 8);
    brdffit_io_options options;
    int which;

    (void)state;
    for (which = 0; which < 5; which++) {
        brdffit_table *table;
        brdffit_error error;
        brdffit_status status;

        brdffit_io_options_init(&options);
        options.values = which == 0 ? BRDFFIT_IO_VALUES_CCBRDF : BRDFFIT_IO_VALUES_PLAIN;
        options.channels = which == 1 ? "r" : NULL;
        options.missing = which == 2 ? BRDFFIT_IO_MISSING_NEGATIVE : BRDFFIT_IO_MISSING_MARKED;
        options.directions_as = which == 3 ? BRDFFIT_IO_Y_UP : 0;
        options.saturated = which == 4 ? 2.0 : 0.0;
        status = brdffit_io_read_memory(merl.data, merl.size, &options, &table, &error);
        io_assert_failed(status, table, &error, BRDFFIT_ERR_OPTION, "for text");
        status = brdffit_io_read_sums_memory(merl.data, merl.size, &options, NULL, &table, &error);
        io_assert_failed(status, table, &error, BRDFFIT_ERR_OPTION, "for text");
    }
    free(merl.data);
}

/* Written on another machine: named, not read as what its bytes happen to be. */
static void test_big_endian(void **state)
{
    struct io_merl merl = io_merl_new(6, 4, 8);
    brdffit_table *table;
    brdffit_error error;
    brdffit_status status;
    size_t i, k;

    (void)state;
    for (i = 0; i < 3 * merl.cells; i++) {
        unsigned char *entry = merl.data + 12 + 8 * i;

        io_put(&merl, i / merl.cells, i % merl.cells, i % 7 == 3 ? -1.0 : (double)(i + 1) / 7.0);
        for (k = 0; k < 4; k++) {
            const unsigned char swap = entry[k];

            entry[k] = entry[7 - k];
            entry[7 - k] = swap;
        }
    }
    status = brdffit_io_read_memory(merl.data, merl.size, NULL, &table, &error);
    io_assert_failed(status, table, &error, BRDFFIT_ERR_FORMAT, "big-endian");
    free(merl.data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_options_of_text),
                                       cmocka_unit_test(test_big_endian),
                                       cmocka_unit_test(test_every_cell),
                                       cmocka_unit_test(test_what_it_says),
                                       cmocka_unit_test(test_exactly_on_the_horizon),
                                       cmocka_unit_test(test_masked),
                                       cmocka_unit_test(test_all_masked),
                                       cmocka_unit_test(test_not_finite),
                                       cmocka_unit_test(test_wrong_size),
                                       cmocka_unit_test(test_lying_header),
                                       cmocka_unit_test(test_other_binaries)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
