/*
 * Text tables that are fine. What is refused: test_io_csv_errors.c. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <locale.h>
#include <math.h>

#include "io_support.h"

#define RIGHT_ROOT 0.86602540378443865 /* sin 60 */

static void assert_vector(const double *v, double x, double y, double z)
{
    assert_same(v[0], x);
    assert_same(v[1], y);
    assert_same(v[2], z);
}

static void test_angles(void **state)
{
    brdffit_table *table = io_good("theta_i,phi_i,theta_o,phi_o,r,g,b\n0,0,60,180,1,2,3\n60,90,30,-90,4,5,6.5\n");
    const brdffit_samples *s = table->samples;

    (void)state;
    assert_in_range(s->struct_size, offsetof(brdffit_samples, weights) + sizeof s->weights, sizeof *s);
    assert_int_equal(s->form, BRDFFIT_FORM_DIRECTIONS);
    assert_int_equal(s->quantity, BRDFFIT_QUANTITY_BRDF);
    assert_int_equal(s->count, 2);
    assert_int_equal(s->channels, 3);
    assert_vector(s->light, 0, 0, 1);
    assert_vector(s->view, -RIGHT_ROOT, 0, 0.5);
    assert_vector(s->light + 3, 0, RIGHT_ROOT, 0.5);
    assert_vector(s->view + 3, 0, -0.5, RIGHT_ROOT);
    assert_null(s->normal);
    assert_null(s->weights);
    assert_null(s->a);
    assert_null(s->cos_light);
    assert_same(s->values[0], 1);
    assert_same(s->values[5], 6.5);
    assert_string_equal(table->channel_names[0], "r");
    assert_string_equal(table->channel_names[2], "b");
    assert_int_equal(table->lines[0], 2);
    assert_int_equal(table->lines[1], 3);
    assert_int_equal(table->rows, 2);
    assert_int_equal(table->format, BRDFFIT_IO_FORMAT_CSV);
    assert_int_equal(table->compressed, 0);
    assert_int_equal(table->negative, 0);
    assert_int_equal(table->dims[0] + table->dims[1] + table->dims[2], 0);
    assert_int_equal(table->dropped[0] + table->dropped[1] + table->dropped[2], 0);
    brdffit_io_free(table);
}

static void test_angles_in_plane(void **state)
{
    brdffit_table *table = io_good("theta_o_deg,mwir,theta_i\n60,7,30\n");

    (void)state;
    assert_vector(table->samples->light, 0.5, 0, RIGHT_ROOT);
    assert_vector(table->samples->view, -RIGHT_ROOT, 0, 0.5);
    assert_same(table->samples->values[0], 7);
    assert_string_equal(table->channel_names[0], "mwir");
    brdffit_io_free(table);
}

/* phi goes to two turns, theta to 180: below the horizon is the fit's to judge. */
static void test_angles_range(void **state)
{
    brdffit_table *table = io_good("theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,x\n90,450,180,-720,1\n");

    (void)state;
    assert_vector(table->samples->light, 0, 1, 0);
    assert_same(table->samples->view[2], -1);
    assert_int_equal(table->samples->count, 1);
    brdffit_io_free(table);
}

static void test_vectors(void **state)
{
    brdffit_table *table = io_good("lx,ly,lz,vx,vy,vz,a,b,c\n1,2,3,-4,5,1e-300,7,8,9\n");
    const brdffit_samples *s = table->samples;

    (void)state;
    assert_int_equal(s->form, BRDFFIT_FORM_DIRECTIONS);
    assert_vector(s->light, 1, 2, 3);
    assert_vector(s->view, -4, 5, 1e-300);
    assert_null(s->normal);
    assert_int_equal(s->channels, 3); /* next to directions, a b c are channels */
    assert_vector(s->values, 7, 8, 9);
    assert_string_equal(table->channel_names[1], "b");
    brdffit_io_free(table);

    table = io_good("nz;ny;nx;lx;ly;lz;vx;vy;vz;Y\n1;0.5;-0.5;0;0;1;0;1;0;-3\n");
    assert_vector(table->samples->normal, -0.5, 0.5, 1);
    assert_int_equal(table->negative, 1);
    assert_same(table->samples->values[0], -3);
    brdffit_io_free(table);
}

static void test_coefficients(void **state)
{
    brdffit_table *table = io_good("a\tb\tc\tred\tw\n0.25\t0\t1e3\t-1\t2\n1\t1\t0\t1\t0\n");
    const brdffit_samples *s = table->samples;

    (void)state;
    assert_int_equal(s->form, BRDFFIT_FORM_COEFFICIENTS);
    assert_int_equal(s->quantity, BRDFFIT_QUANTITY_RADIANCE);
    assert_int_equal(s->count, 2);
    assert_same(s->a[0], 0.25);
    assert_same(s->b[0], 0);
    assert_same(s->c[0], 1000);
    assert_same(s->weights[0], 2);
    assert_same(s->weights[1], 0);
    assert_null(s->light);
    assert_int_equal(table->negative, 1);
    brdffit_io_free(table);
}

static void test_quantity(void **state)
{
    static const char angles[] = "theta_i,theta_o,r\n1,2,3\n", coefficients[] = "a,b,c,r\n1,2,3,4\n";
    brdffit_io_options options;
    brdffit_table *table;
    brdffit_error error;
    brdffit_status status;

    (void)state;
    brdffit_io_options_init(&options);
    options.quantity = BRDFFIT_QUANTITY_RADIANCE; /* not set: no effect */
    assert_int_equal(io_text(angles, &options, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->samples->quantity, BRDFFIT_QUANTITY_BRDF);
    brdffit_io_free(table);
    options.quantity_set = 1;
    assert_int_equal(io_text(angles, &options, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->samples->quantity, BRDFFIT_QUANTITY_RADIANCE);
    brdffit_io_free(table);
    assert_int_equal(io_text(coefficients, &options, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->samples->quantity, BRDFFIT_QUANTITY_RADIANCE);
    brdffit_io_free(table);
    options.quantity = BRDFFIT_QUANTITY_BRDF;
    status = io_text(coefficients, &options, &table, &error);
    io_assert_failed(status, table, &error, BRDFFIT_ERR_OPTION, "radiance");
}

/* The same two samples in every dress. */
static void test_dresses(void **state)
{
    static const char *const text[] = {
        "theta_i,theta_o,weight,r\n30,60,1,2\n90,0,3,4\n",
        "theta_i,theta_o,weight,r\r\n30,60,1,2\r\n90,0,3,4",
        "theta_i,theta_o,w,r\r30,60,1,2\r90,0,3,4\r",
        "theta_i;theta_o;w;r\n30;60;1;2\n90;0;3;4\n",
        "theta_i\ttheta_o\tw\tr\n30\t60\t1\t2\n90\t0\t3\t4\n",
        "\xef\xbb\xbftheta_i,theta_o,w,r\n30,60,1,2\n90,0,3,4\n",
        "# a comment, with commas\n\n  \t \n # indented\ntheta_i,theta_o,w,r\n#\n30,60,1,2\n\n90,0,3,4\n\n#end",
        "  theta_i ,\ttheta_o\t,  w,r  \n 30 ,60\t, 1 ,\t2 \n90,0,  3  ,  4\t\n",
        "\"theta_i\",\"theta_o\",\"w\",\"r\"\n\"30\",\"60\",1,2\n90,0 , \"3\" ,4\n",
        "\xef\xbb\xbf\"theta_i\"\t \"theta_o\" \t\"w\"\tr\r\n+30\t6e1\t1.0\t.2e1\r\n90.\t-0\t3\t4\r\n",
        "theta_i,\ttheta_o,\tw,\tr\n30,\t60,\t1,\t2\n90,\t0,\t3,\t4\n", /* as many tabs as commas */
        "weight,r,theta_o,theta_i\n1,2,60,30\n3,4,0,90\n",
    };
    size_t i;

    (void)state;
    for (i = 0; i < sizeof text / sizeof *text; i++) {
        brdffit_table *table = io_good(text[i]);
        const brdffit_samples *s = table->samples;

        assert_int_equal(s->count, 2);
        assert_int_equal(s->channels, 1);
        assert_string_equal(table->channel_names[0], "r");
        assert_vector(s->light, 0.5, 0, RIGHT_ROOT);
        assert_vector(s->view, -RIGHT_ROOT, 0, 0.5);
        assert_vector(s->light + 3, 1, 0, 0);
        assert_vector(s->view + 3, 0, 0, 1);
        assert_same(s->weights[0], 1);
        assert_same(s->weights[1], 3);
        assert_same(s->values[0], 2);
        assert_same(s->values[1], 4);
        brdffit_io_free(table);
    }
}

static void test_lines_are_the_files(void **state)
{
    brdffit_table *table = io_good("# 1\n# 2\ntheta_i,theta_o,r\n\n1,1,1\r\n# 6\n\n1,1,\n2,2,2\n");

    (void)state;
    assert_int_equal(table->samples->count, 2);
    assert_int_equal(table->lines[0], 5);
    assert_int_equal(table->lines[1], 9);
    assert_int_equal(table->rows, 3);
    brdffit_io_free(table);
}

static void test_channel_names(void **state)
{
    brdffit_table *table = io_good("theta_i;theta_o;\"I(0,5) \"\"x\"\"; y\";\xce\xbb 550 nm ;R;"
                                   "nir\n1;2;3;4;5;6\n");

    (void)state;
    assert_int_equal(table->samples->channels, 4);
    assert_string_equal(table->channel_names[0], "I(0,5) \"x\"; y");
    assert_string_equal(table->channel_names[1], "\xce\xbb 550 nm");
    assert_string_equal(table->channel_names[2], "R");
    assert_string_equal(table->channel_names[3], "nir");
    brdffit_io_free(table);
}

static void test_absent_and_negative(void **state)
{
    brdffit_table *table = io_good("theta_i,theta_o,r,g\n1,1,1,2\n1,1,,2\n1,1,-1,-2\n1,1,3,\n"
                                   "1,1, ,\"\"\n1,1,-5,6\n1,1,-7,\n");

    (void)state;
    assert_int_equal(table->samples->count, 3);
    assert_int_equal(table->rows, 7);
    assert_int_equal(table->dropped[BRDFFIT_IO_DROP_ABSENT], 4);
    assert_int_equal(table->dropped[BRDFFIT_IO_DROP_MASKED], 0);
    assert_int_equal(table->dropped[BRDFFIT_IO_DROP_BELOW_HORIZON], 0);
    assert_int_equal(table->negative, 2); /* samples, and only those that were kept */
    assert_same(table->samples->values[2], -1);
    assert_same(table->samples->values[5], 6);
    assert_int_equal(table->lines[2], 7);
    brdffit_io_free(table);
}

/* More rows than any first guess, more columns than any fixed buffer. */
static void test_many(void **state)
{
    const int rows = 3000, columns = 40;
    char *text = malloc(40000000), *at = text;
    brdffit_table *table;
    int i, k;

    (void)state;
    assert_non_null(text);
    at += sprintf(at, "theta_i,theta_o");
    for (k = 0; k < columns; k++) {
        at += sprintf(at, ",lambda%d", k);
    }
    for (i = 0; i < rows; i++) {
        at += sprintf(at, "\n%d,0", i % 90);
        for (k = 0; k < columns; k++) {
            at += sprintf(at, ",%.17g", i / 7.0 + k);
        }
    }
    table = io_good(text);
    assert_int_equal(table->samples->count, rows);
    for (i = 0; i < rows; i++) {
        assert_int_equal(table->lines[i], i + 2);
        for (k = 0; k < columns; k++) {
            assert_same(table->samples->values[i * columns + k], i / 7.0 + k);
        }
    }
    assert_string_equal(table->channel_names[39], "lambda39");
    brdffit_io_free(table);
    free(text);
}

/* A locale with a decimal comma: an installed one, or one made in a temporary directory. 0: impossible. */
static int comma_locale(char *directory)
{
    static const char *const names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "nl_NL.UTF-8"};
    char command[200];
    size_t i;

    directory[0] = '\0';
    for (i = 0; i < sizeof names / sizeof *names; i++) {
        if (setlocale(LC_ALL, names[i]) && localeconv()->decimal_point[0] == ',') {
            return 1;
        }
    }
    strcpy(directory, "/tmp/brdffit_locale_XXXXXX");
    if (!mkdtemp(directory)) {
        return 0;
    }
    (void)snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s/de_DE.UTF-8 >%s/log 2>&1", directory,
                   directory);
    return system(command) == 0 && setenv("LOCPATH", directory, 1) == 0 && setlocale(LC_ALL, names[0]) &&
           localeconv()->decimal_point[0] == ',';
}

static void remove_directory(const char *directory)
{
    char command[100];

    (void)unsetenv("LOCPATH");
    (void)snprintf(command, sizeof command, "rm -rf %s", directory);
    if (directory[0]) {
        assert_int_equal(system(command), 0);
    }
}

/* Under a locale that writes 0,5 the file still says 0.5, and the locale is left as it was. */
static void test_locale(void **state)
{
    char directory[40];
    brdffit_table *table;

    (void)state;
    if (!comma_locale(directory)) {
        remove_directory(directory);
        print_message("no locale with a decimal comma is installed or can be made\n");
        skip();
    }
    assert_true(strtod("0.5", NULL) == 0.0); /* this is what the file must not suffer from */
    table = io_good("theta_i,theta_o,r,g\n1.5,2.5,0.5,0.12345678901234567890\n");
    assert_same(table->samples->values[0], 0.5);
    assert_same(table->samples->values[1], 0.12345678901234567890);
    assert_int_equal(localeconv()->decimal_point[0], ',');
    brdffit_io_free(table);
    (void)setlocale(LC_ALL, "C");
    remove_directory(directory);
}

/* Text that is not followed by a terminator, in a block of exactly its size. */
static void test_unterminated_memory(void **state)
{
    static const char text[] = "theta_i,theta_o,r\n1,2,0.12345678901234567890";
    size_t size = sizeof text - 1;
    char *copy = malloc(size);
    brdffit_table *table;
    brdffit_error error;

    (void)state;
    assert_non_null(copy);
    memcpy(copy, text, size);
    assert_int_equal(brdffit_io_read_memory(copy, size, NULL, &table, &error), BRDFFIT_OK);
    assert_same(table->samples->values[0], 0.12345678901234567890);
    brdffit_io_free(table);
    free(copy);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_angles),
                                       cmocka_unit_test(test_angles_in_plane),
                                       cmocka_unit_test(test_angles_range),
                                       cmocka_unit_test(test_vectors),
                                       cmocka_unit_test(test_coefficients),
                                       cmocka_unit_test(test_quantity),
                                       cmocka_unit_test(test_dresses),
                                       cmocka_unit_test(test_lines_are_the_files),
                                       cmocka_unit_test(test_channel_names),
                                       cmocka_unit_test(test_absent_and_negative),
                                       cmocka_unit_test(test_many),
                                       cmocka_unit_test(test_locale),
                                       cmocka_unit_test(test_unterminated_memory)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
