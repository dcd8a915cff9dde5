/*
 * The ground floor: exp and log kernels against long double, the arena in both modes.
 * SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/arena.h"
#include "base/exp.h"
#include "base/log.h"
#include "support.h"
#include "base/tolerance.h"

/* ---- kernels ------------------------------------------------------------------------------------------ */

/* Relative error in units of u (TOL_UNIT), which is what the kernels' comments speak of. */
static double error_in_units(double value, long double truth)
{
    return (double)(fabsl((long double)value - truth) / fabsl(truth)) / TOL_UNIT;
}

static void test_exp_error(void **state)
{
    struct brdffit_test_random random = {1};
    double worst = 0.0;
    long i;

    (void)state;
    for (i = 0; i < 1500000; i++) {
        double scale = i % 3 ? 1.0 : brdffit_test_log_uniform(&random, 1e-18, 1.0);
        double x = brdffit_test_uniform(&random, -708.0, 709.0) * scale;
        double error = error_in_units(kernel_exp(x), expl((long double)x));

        if (!(error < 2.0)) {
            fail_msg("kernel_exp(%a): %g u", x, error);
        }
        worst = fmax(worst, error);
    }
    print_message("exp: %.3f u at worst\n", worst);
}

/* Where k changes, |r| is largest: odd multiples of ln(2) / 2 and their neighbours. */
static void test_exp_between_powers(void **state)
{
    int k, i;

    (void)state;
    for (k = -1021; k <= 1022; k++) {
        double x = (k + 0.5) * 0.69314718055994530942;

        for (i = 0; i < 16; i++, x = nextafter(x, INFINITY)) {
            double y = x - 8.0 * (nextafter(x, INFINITY) - x);

            assert_true(!(y >= -708.0) || error_in_units(kernel_exp(y), expl((long double)y)) < 2.0);
        }
    }
}

static void test_exp_special_values(void **state)
{
    (void)state;
    assert_true(kernel_exp(0.0) == 1.0);
    assert_true(kernel_exp(-0.0) == 1.0);
    assert_true(kernel_exp(-INFINITY) == 0.0);
    assert_true(kernel_exp(-1e308) == 0.0);
    assert_true(kernel_exp(nextafter(-708.0, -INFINITY)) == 0.0);
    assert_true(kernel_exp(-708.0) > 3e-308);
    assert_true(error_in_units(kernel_exp(-708.0), expl(-708.0L)) < 2.0);
    assert_true(error_in_units(kernel_exp(709.0), expl(709.0L)) < 2.0);
    assert_true(kernel_exp(5e-324) == 1.0);
    assert_true(kernel_exp(-TOL_UNIT) <= 1.0);
}

/* phi = exp(-c u) of c, u >= 0 must never exceed 1, and may step up by no more than its error. */
static void test_exp_monotone(void **state)
{
    double before = 0.0, x;
    long i;

    (void)state;
    for (x = -709.0; x <= 709.0; x += 1.0 / 1024.0) {
        double value = kernel_exp(x);

        assert_true(value >= before * (1.0 - 4.0 * TOL_UNIT));
        assert_true(x > 0.0 || value <= 1.0);
        before = value;
    }
    for (i = 0, x = -1.0; i < 100000; i++, x = nextafter(x, 0.0)) {
        assert_true(kernel_exp(nextafter(x, 0.0)) >= kernel_exp(x) * (1.0 - 4.0 * TOL_UNIT));
    }
}

/* Below two ulp, as its comment says. */
static void check_log(double x)
{
    long double truth = logl((long double)x);

    if (x == 1.0) {
        assert_true(kernel_log(x) == 0.0);
    } else if (!(fabsl((long double)kernel_log(x) - truth) <= 2.0L * 2.0L * TOL_UNIT * fabsl(truth))) {
        fail_msg("kernel_log(%a) = %a, not %La", x, kernel_log(x), truth);
    }
}

static void test_log_error(void **state)
{
    struct brdffit_test_random random = {2};
    long i;

    (void)state;
    for (i = 0; i < 400000; i++) {
        double decades = i % 2 ? 307.0 : brdffit_test_log_uniform(&random, 1e-17, 1.0);

        check_log(pow(10.0, brdffit_test_uniform(&random, -decades, decades)));
    }
    check_log(1.0);
    check_log(nextafter(1.0, 2.0));
    check_log(nextafter(1.0, 0.0));
    check_log(0x1p-1022);
    check_log(0x1.fffffffffffffp1023);
    check_log(0.70710678118654752);
    check_log(nextafter(0.70710678118654752, 0.0));
    check_log(1.4142135623730951);
    check_log(nextafter(1.4142135623730951, 0.0));
}

/* The axis is ln s: what goes through both must come back. */
static void test_log_undoes_exp(void **state)
{
    double theta;

    (void)state;
    for (theta = -690.0; theta < 690.0; theta += 0.37) {
        assert_true(fabs(kernel_log(kernel_exp(theta)) - theta) <= 4.0 * TOL_UNIT * (1.0 + fabs(theta)));
    }
}

/* ---- arena -------------------------------------------------------------------------------------------- */

/* One layout, as the library does it: returns the bytes used, and marks what it was given. */
static size_t lay_out(struct arena *arena, uint64_t seed)
{
    struct brdffit_test_random random = {seed};
    int i;

    for (i = 0; i < 20; i++) {
        size_t count = brdffit_test_below(&random, 300), bytes = 1 + brdffit_test_below(&random, 40), j;
        unsigned char *p = brdffit_arena_take(arena, count, bytes);

        for (j = 0; p && j < count * bytes; j++) {
            p[j] = (unsigned char)i;
        }
        assert_true((uintptr_t)p % ARENA_ALIGNMENT == 0);
        assert_int_equal(p != NULL, arena->base != NULL && !arena->failed);
    }
    return arena->used;
}

/* What counting says suffices at every misalignment, exactly as the sanitizer sees the block. */
static void test_arena_counts_what_it_takes(void **state)
{
    uint64_t seed;

    (void)state;
    for (seed = 1; seed <= 130; seed++) {
        struct arena arena;
        size_t size, offset = seed % 65;
        unsigned char *block;

        brdffit_arena_init(&arena, NULL, 0);
        size = lay_out(&arena, seed);
        assert_false(arena.failed);
        block = malloc(size + offset);
        assert_non_null(block);
        brdffit_arena_init(&arena, block + offset, size);
        (void)lay_out(&arena, seed);
        assert_false(arena.failed);
        assert_true(arena.used <= size);
        free(block);
    }
}

/* An arena that is too small fails, stays failed, and never hands out memory beyond its end. */
static void test_arena_too_small(void **state)
{
    struct arena arena;
    unsigned char *block;
    size_t size, needed;

    (void)state;
    brdffit_arena_init(&arena, NULL, 0);
    needed = lay_out(&arena, 7);
    for (size = 0; size + 2 * ARENA_ALIGNMENT < needed; size += 97) {
        block = malloc(size + 1);
        assert_non_null(block);
        brdffit_arena_init(&arena, block, size);
        (void)lay_out(&arena, 7);
        assert_true(arena.failed);
        assert_null(brdffit_arena_take(&arena, 1, 1));
        free(block);
    }
}

static void test_arena_overflow(void **state)
{
    static const size_t count[] = {SIZE_MAX, SIZE_MAX / 8, SIZE_MAX / 8 - 7, SIZE_MAX / 2, SIZE_MAX - 64};
    unsigned char block[256];
    size_t i;

    (void)state;
    for (i = 0; i < sizeof count / sizeof count[0]; i++) {
        struct arena arena;

        brdffit_arena_init(&arena, NULL, 0);
        (void)brdffit_arena_take(&arena, count[i], 8);
        (void)brdffit_arena_take(&arena, count[i], 8);
        assert_true(arena.failed);
        brdffit_arena_init(&arena, block, sizeof block);
        assert_null(brdffit_arena_take(&arena, count[i], 1));
        assert_true(arena.failed);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exp_error),
        cmocka_unit_test(test_exp_between_powers),
        cmocka_unit_test(test_exp_special_values),
        cmocka_unit_test(test_exp_monotone),
        cmocka_unit_test(test_log_error),
        cmocka_unit_test(test_log_undoes_exp),
        cmocka_unit_test(test_arena_counts_what_it_takes),
        cmocka_unit_test(test_arena_too_small),
        cmocka_unit_test(test_arena_overflow),
    };

    return cmocka_run_group_tests_name("foundation", tests, NULL, NULL);
}
