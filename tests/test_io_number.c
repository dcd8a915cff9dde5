/*
 * Numbers and angles of the file readers. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <float.h>
#include <locale.h>
#include <math.h>

#include "io/csv/angle.h"
#include "io/csv/number.h"
#include "io_support.h"

static locale_t c_locale;

static enum io_number number(const char *text, double *value)
{
    return brdffit_io_number(text, strlen(text), &c_locale, value);
}

static uint64_t bits_of(double value)
{
    uint64_t bits;

    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void same_as_strtod(const char *text)
{
    double value = -7.0, expected = strtod(text, NULL);
    enum io_number kind = number(text, &value);

    if (kind != (isinf(expected) ? IO_NUMBER_OVERFLOW : IO_NUMBER_OK) || bits_of(value) != bits_of(expected)) {
        print_error("'%s': kind %d, %.17g instead of %.17g\n", text, (int)kind, value, expected);
        fail();
    }
}

static void test_chosen_numbers(void **state)
{
    /* clang-format off */
    static const char *const text[] = {
        "0", "-0", "+0", "1", "+1", "-1", "1.", ".5", "-.5", "0.1", "1e0", "1E5", "1e+5", "1e-5", "00012", "0.0001",
        "123456789012345678", "9007199254740992", "9007199254740993", "9007199254740993e22", "18446744073709551615",
        "18446744073709551616", "99999999999999999999", "1e22", "1e23", "1e-22", "1e-23", "8.5e22", "1e308",
        "1.7976931348623157e308", "1.7976931348623159e308", "1e309", "-1e999", "1e99999999999999999999", "0e999999",
        "4.9406564584124654e-324", "2.4703282292062327e-324", "2.4703282292062328e-324", "1e-400",
        "-1e-99999999999999999999", "2.2250738585072011e-308", "0.3183098861837907",
        "1.00000000000000000000000000000001",
        "0.000000000000000000000000000000000000000000000000000000000000000000012345",
        "100000000000000000000000000000000000000000000000000000000000000000000000",
        "1797693134862315807937289714053034150799341327100378269361737789804449682927647509466490179775872070963"
        "3028641669288791094655554785194040263065748867150582068190890200070838367627385484581771153176447573027",
    };
    /* clang-format on */
    size_t i;

    (void)state;
    for (i = 0; i < sizeof text / sizeof *text; i++) {
        same_as_strtod(text[i]);
    }
}

/* 200000 numbers in many shapes against the C library's conversion. */
static void test_random_numbers(void **state)
{
    uint64_t x = 88172645463325252u;
    char text[80];
    int i;

    (void)state;
    for (i = 0; i < 200000; i++) {
        double magnitude;

        x ^= x << 13;
        x ^= x >> 7;
        x ^= x << 17;
        magnitude = (double)(int64_t)x * pow(10.0, (double)((int)(x >> 20 & 63) - 40));
        switch (i % 5) {
        case 0: snprintf(text, sizeof text, "%.17g", magnitude); break;
        case 1: snprintf(text, sizeof text, "%.9g", magnitude); break;
        case 2: snprintf(text, sizeof text, "%.6f", (double)(int64_t)x * 1e-12); break;
        case 3:
            snprintf(text, sizeof text, "%d.%03de%d", (int)(x & 1023), (int)(x >> 10 & 511), (int)(x >> 32 & 63) - 31);
            break;
        default: snprintf(text, sizeof text, "%llue%d", (unsigned long long)x, (int)(x >> 40 & 63) - 31); break;
        }
        same_as_strtod(text);
    }
}

static void test_not_numbers(void **state)
{
    static const struct {
        const char *text;
        enum io_number kind;
        /* clang-format off */
    } bad[] = {
        {"", IO_NUMBER_EMPTY}, {"nan", IO_NUMBER_NAN}, {"NaN", IO_NUMBER_NAN}, {"-nan", IO_NUMBER_NAN},
        {"inf", IO_NUMBER_INFINITE}, {"-Infinity", IO_NUMBER_INFINITE}, {"0x10", IO_NUMBER_HEXADECIMAL},
        {"-0X1p3", IO_NUMBER_HEXADECIMAL}, {"1,5", IO_NUMBER_DECIMAL_COMMA}, {"-0,25", IO_NUMBER_DECIMAL_COMMA},
        {"1.2abc", IO_NUMBER_TEXT}, {"abc", IO_NUMBER_TEXT}, {"+", IO_NUMBER_TEXT}, {"-", IO_NUMBER_TEXT},
        {".", IO_NUMBER_TEXT}, {"-.", IO_NUMBER_TEXT}, {"1e", IO_NUMBER_TEXT}, {"1e+", IO_NUMBER_TEXT},
        {"e5", IO_NUMBER_TEXT}, {".e5", IO_NUMBER_TEXT}, {"1 2", IO_NUMBER_TEXT}, {" 1", IO_NUMBER_TEXT},
        {"1 ", IO_NUMBER_TEXT}, {"--1", IO_NUMBER_TEXT}, {"1.2.3", IO_NUMBER_TEXT}, {"1,", IO_NUMBER_TEXT},
        {"NA", IO_NUMBER_TEXT}, {"1e5.5", IO_NUMBER_TEXT}, {"1f5", IO_NUMBER_TEXT}, {"nan(1)", IO_NUMBER_TEXT},
        {"infinit", IO_NUMBER_TEXT}, {"\xc2\xa0" "1", IO_NUMBER_TEXT},
    };
    /* clang-format on */
    size_t i;

    (void)state;
    for (i = 0; i < sizeof bad / sizeof *bad; i++) {
        double value = -7.0;
        enum io_number kind = number(bad[i].text, &value);

        if (kind != bad[i].kind) {
            print_error("'%s': kind %d instead of %d\n", bad[i].text, (int)kind, (int)bad[i].kind);
            fail();
        }
        if (kind == IO_NUMBER_NAN) {
            assert_true(isnan(value));
        } else if (kind == IO_NUMBER_INFINITE) {
            assert_true(isinf(value) && (value < 0.0) == (bad[i].text[0] == '-'));
        } else {
            assert_same(value, 0.0);
        }
    }
}

/* The text is a piece of something longer: what follows must not be looked at. */
static void test_number_is_bounded(void **state)
{
    double value;

    (void)state;
    assert_int_equal(brdffit_io_number("12345678901234567890123", 20, &c_locale, &value), IO_NUMBER_OK);
    assert_same(value, 12345678901234567890.0);
    assert_int_equal(brdffit_io_number("1e5", 1, &c_locale, &value), IO_NUMBER_OK);
    assert_same(value, 1.0);
    assert_true(brdffit_io_is_number("-1e400", 6));
    assert_false(brdffit_io_is_number("", 0));
    assert_false(brdffit_io_is_number("1x", 2));
}

static void test_angles_exact(void **state)
{
    /* clang-format off */
    static const double table[][3] = {
        {0, 0, 1}, {30, 0.5, 0.86602540378443865}, {45, 0.70710678118654752, 0.70710678118654752},
        {60, 0.86602540378443865, 0.5}, {90, 1, 0}, {120, 0.86602540378443865, -0.5},
        {150, 0.5, -0.86602540378443865},
        {180, 0, -1}, {210, -0.5, -0.86602540378443865}, {270, -1, 0}, {360, 0, 1}, {450, 1, 0}, {-90, -1, 0},
        {-180, 0, -1}, {-30, -0.5, 0.86602540378443865}, {36000000090.0, 1, 0}, {-3.6e17, 0, 1},
    };
    /* clang-format on */
    size_t i;
    double s, c;

    (void)state;
    for (i = 0; i < sizeof table / sizeof *table; i++) {
        brdffit_io_sincos_degrees(table[i][0], &s, &c);
        assert_same(s, table[i][1]);
        assert_same(c, table[i][2]);
        assert_false(s == 0.0 && signbit(s));
        assert_false(c == 0.0 && signbit(c));
    }
    brdffit_io_sincos_degrees(DBL_MAX, &s, &c);
    io_assert_near(s * s + c * c, 1.0L, 4 * DBL_EPSILON);
}

static double two_ulp(long double exact)
{
    double magnitude = (double)fabsl(exact);

    return 2.0 * (nextafter(magnitude, 2.0) - magnitude);
}

static void test_angles_accurate(void **state)
{
    const long double radians = 3.14159265358979323846264338327950288L / 180.0L;
    int i;

    (void)state;
    /* (1e-18: near multiples of 180 degrees the long double reference itself is only this good.) */
    for (i = -400000; i <= 400000; i++) {
        double degrees = i * 0.0009765625 * 1.1, s, c;
        long double exact_s = sinl((long double)degrees * radians), exact_c = cosl((long double)degrees * radians);

        brdffit_io_sincos_degrees(degrees, &s, &c);
        io_assert_near(s, exact_s, two_ulp(exact_s) + 1e-18);
        io_assert_near(c, exact_c, two_ulp(exact_c) + 1e-18);
    }
}

/* Near a right angle the cosine keeps its relative accuracy: (n - 1)/n right angles. */
static void test_ratio(void **state)
{
    const long double right = 1.57079632679489661923132169163975144L;
    uint64_t n, i;
    double s, c;

    (void)state;
    for (n = 1; n < 300; n++) {
        for (i = 0; i <= 2 * n; i++) {
            long double exact_s = i <= n ? sinl(right * (long double)i / (long double)n)
                                         : sinl(right * (long double)(2 * n - i) / (long double)n);
            long double exact_c = i <= n ? sinl(right * (long double)(n - i) / (long double)n)
                                         : -sinl(right * (long double)(i - n) / (long double)n);

            brdffit_io_sincos_ratio(i, n, &s, &c);
            io_assert_near(s, exact_s, two_ulp(exact_s));
            io_assert_near(c, exact_c, two_ulp(exact_c));
        }
    }
    brdffit_io_sincos_ratio(999999999999, 1000000000000, &s, &c);
    io_assert_near(c, right * 1e-12L, 4e-28);
}

static void test_direction(void **state)
{
    double out[3];

    (void)state;
    brdffit_io_direction(90, 90, out);
    assert_same(out[0], 0.0);
    assert_same(out[1], 1.0);
    assert_same(out[2], 0.0);
    brdffit_io_direction(30, 180, out);
    assert_same(out[0], -0.5);
    assert_same(out[1], 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_chosen_numbers), cmocka_unit_test(test_random_numbers),
        cmocka_unit_test(test_not_numbers),    cmocka_unit_test(test_number_is_bounded),
        cmocka_unit_test(test_angles_exact),   cmocka_unit_test(test_angles_accurate),
        cmocka_unit_test(test_ratio),          cmocka_unit_test(test_direction),
    };
    int failed;

    c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    freelocale(c_locale);
    return failed;
}
