/*
 * Options, arguments and names of the readers. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "io_support.h"

static const char text[] = "theta_i,theta_o,r\n1,2,3\n";

static void refuse(const brdffit_io_options *options, brdffit_status expected, const char *message)
{
    brdffit_table *table = (brdffit_table *)&table;
    brdffit_error error;
    brdffit_status status = io_text(text, options, &table, &error);

    io_assert_failed(status, table, &error, expected, message);
    table = (brdffit_table *)&table;
    status = brdffit_io_read("/does/not/matter", options, &table, &error);
    io_assert_failed(status, table, &error, expected, message);
}

static void test_defaults(void **state)
{
    brdffit_io_options options;

    (void)state;
    memset(&options, 0x5a, sizeof options);
    brdffit_io_options_init(&options);
    assert_int_equal(options.struct_size, sizeof options);
    assert_int_equal(options.format, BRDFFIT_IO_FORMAT_AUTO);
    assert_int_equal(options.quantity_set, 0);
    assert_int_equal(options.merl_bins, BRDFFIT_IO_MERL_EDGE);
    assert_int_equal(options.merl_sampling, BRDFFIT_IO_MERL_TABLE);
    assert_null(options.directions);
}

static void test_ranges(void **state)
{
    brdffit_io_options options;

    (void)state;
    brdffit_io_options_init(&options);
    options.struct_size = offsetof(brdffit_io_options, directions); /* shorter than the first version's */
    refuse(&options, BRDFFIT_ERR_ARGUMENT, "struct_size");
    brdffit_io_options_init(&options);
    options.format = (brdffit_io_format)3;
    refuse(&options, BRDFFIT_ERR_OPTION, "file format");
    brdffit_io_options_init(&options);
    options.quantity_set = 1;
    options.quantity = (brdffit_quantity)2;
    refuse(&options, BRDFFIT_ERR_OPTION, "quantity");
    brdffit_io_options_init(&options);
    options.merl_bins = (brdffit_io_merl_bins)-1;
    refuse(&options, BRDFFIT_ERR_OPTION, "bins");
    brdffit_io_options_init(&options);
    options.merl_sampling = (brdffit_io_merl_sampling)3;
    refuse(&options, BRDFFIT_ERR_OPTION, "sampling");
}

static void test_directions(void **state)
{
    double light[6] = {0, 0, 1, 1, 0, 1}, view[6] = {0, 0, 1, 0, 1, 1}, normal[6] = {0, 0, 1, 0, 0, 1};
    double weights[2] = {1, 0};
    brdffit_io_options options;
    brdffit_samples at;

    (void)state;
    brdffit_io_options_init(&options);
    options.merl_sampling = BRDFFIT_IO_MERL_DIRECTIONS;
    refuse(&options, BRDFFIT_ERR_ARGUMENT, "without directions");
    brdffit_samples_init(&at);
    options.directions = &at;
    refuse(&options, BRDFFIT_ERR_ARGUMENT, "light and view");
    at.light = light;
    at.view = view;
    refuse(&options, BRDFFIT_ERR_NO_SAMPLES, "none");
    at.count = 2;
    at.normal = normal;
    at.weights = weights;
    at.form = BRDFFIT_FORM_COEFFICIENTS;
    refuse(&options, BRDFFIT_ERR_ARGUMENT, "light and view");
    at.form = BRDFFIT_FORM_DIRECTIONS;
    at.struct_size = 0;
    refuse(&options, BRDFFIT_ERR_ARGUMENT, "struct_size");
    at.struct_size = sizeof at;
    light[4] = NAN;
    refuse(&options, BRDFFIT_ERR_VALUE, "light direction");
    light[4] = 0;
    view[3] = view[4] = view[5] = 0;
    refuse(&options, BRDFFIT_ERR_VALUE, "view direction");
    view[5] = 1;
    normal[5] = INFINITY;
    refuse(&options, BRDFFIT_ERR_VALUE, "normal");
    normal[5] = 1;
    weights[1] = -1;
    refuse(&options, BRDFFIT_ERR_VALUE, "weight");
    weights[1] = NAN;
    refuse(&options, BRDFFIT_ERR_VALUE, "weight");
}

static void test_places_of_directions(void **state)
{
    static const double light[6] = {0, 0, 1, 0, -INFINITY, 1}, view[6] = {0, 0, 1, 0, 1, 1};
    brdffit_io_options options;
    brdffit_samples at;
    brdffit_table *table;
    brdffit_error error;

    (void)state;
    brdffit_samples_init(&at);
    at.count = 2;
    at.light = light;
    at.view = view;
    brdffit_io_options_init(&options);
    options.merl_sampling = BRDFFIT_IO_MERL_DIRECTIONS;
    options.directions = &at;
    assert_int_equal(io_text(text, &options, &table, &error), BRDFFIT_ERR_VALUE);
    assert_int_equal(error.sample, 1);
    assert_int_equal(error.line, BRDFFIT_NONE);
    assert_same(error.value, -INFINITY);
}

static void test_arguments(void **state)
{
    brdffit_table *table = (brdffit_table *)&table;
    brdffit_error error;

    (void)state;
    assert_int_equal(brdffit_io_read(NULL, NULL, &table, &error), BRDFFIT_ERR_ARGUMENT);
    assert_null(table);
    assert_int_equal(brdffit_io_read("x", NULL, NULL, &error), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_io_read("x", NULL, NULL, NULL), BRDFFIT_ERR_ARGUMENT);
    table = (brdffit_table *)&table;
    assert_int_equal(brdffit_io_read_memory(NULL, 5, NULL, &table, &error), BRDFFIT_ERR_ARGUMENT);
    assert_null(table);
    assert_int_equal(brdffit_io_read_memory(text, 5, NULL, NULL, &error), BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_io_read_memory(NULL, 0, NULL, &table, &error), BRDFFIT_ERR_FORMAT);
    assert_string_equal(error.message, "the file is empty");
    if (sizeof(size_t) > 4) { /* refused by its size alone: the bytes are not there */
        assert_int_equal(brdffit_io_read_memory(text, (size_t)-1 / 2, NULL, &table, &error), BRDFFIT_ERR_FORMAT);
        assert_non_null(strstr(error.message, "limit"));
    }
    brdffit_io_free(NULL);
}

static void test_drop_names(void **state)
{
    (void)state;
    assert_string_equal(brdffit_io_drop_string(BRDFFIT_IO_DROP_MASKED), "masked");
    assert_string_equal(brdffit_io_drop_string(BRDFFIT_IO_DROP_ABSENT), "absent");
    assert_string_equal(brdffit_io_drop_string(BRDFFIT_IO_DROP_BELOW_HORIZON), "cell_below_horizon");
    assert_string_equal(brdffit_io_drop_string(BRDFFIT_IO_DROP_COUNT), "unknown");
    assert_string_equal(brdffit_io_drop_string((brdffit_io_drop)-1), "unknown");
}

/* Places without measurements: refused as data, accepted as directions. */
static void test_directions_only(void **state)
{
    static const char places[] = "theta_i,phi_i,theta_o,phi_o\n10,0,20,180\n30,0,30,180\n";
    brdffit_io_options options;
    brdffit_table *table = NULL;
    brdffit_error error;

    (void)state;
    brdffit_io_options_init(&options);
    assert_int_equal(options.directions_only, 0);
    assert_int_equal(io_text(places, &options, &table, &error), BRDFFIT_ERR_FORMAT);
    assert_int_equal(error.line, 1);
    options.directions_only = 1;
    assert_int_equal(io_text(places, &options, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->samples->count, 2);
    assert_int_equal(table->samples->channels, 0);
    assert_null(table->samples->values);
    io_assert_near(table->samples->light[2], 0.98480775301220805937L, 2e-16);
    brdffit_io_free(table);
    assert_int_equal(io_text("theta_i,phi_i,theta_o,phi_o,r\n10,0,20,180,0.5\n", &options, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->samples->channels, 1);
    brdffit_io_free(table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults),        cmocka_unit_test(test_ranges),
        cmocka_unit_test(test_directions),      cmocka_unit_test(test_places_of_directions),
        cmocka_unit_test(test_arguments),       cmocka_unit_test(test_drop_names),
        cmocka_unit_test(test_directions_only),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
