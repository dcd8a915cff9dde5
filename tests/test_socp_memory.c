/*
 * Cone programs when memory runs out: every allocation of a solver and of a fit is refused once, and from there on. What
 * is left is BRDFFIT_ERR_MEMORY and no block; solving allocates nothing.
 *
 * SPDX-License-Identifier: MIT
 *
 * LDFLAGS: -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=aligned_alloc,--wrap=free
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "brdffit.h"
#include "solve/conic/socp.h"

/* Allocations left before one is refused; negative: none is. `for_good`: and all after it. */
static long left = -1;
static int for_good;
static long live, made;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *block);

static int refused(void)
{
    made++;
    if (left == 0) {
        left = for_good ? 0 : -1;
        return 1;
    }
    left -= left > 0;
    return 0;
}

static void *born(void *block)
{
    live += block != NULL;
    return block;
}

void *__wrap_malloc(size_t size)
{
    return refused() ? NULL : born(__real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size)
{
    return refused() ? NULL : born(__real_calloc(count, size));
}

void *__wrap_realloc(void *block, size_t size)
{
    if (refused()) {
        return NULL;
    }
    return block ? __real_realloc(block, size) : born(__real_realloc(NULL, size));
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return refused() ? NULL : born(__real_aligned_alloc(alignment, size));
}

void __wrap_free(void *block)
{
    live -= block != NULL;
    __real_free(block);
}

/* minimise -x0 - x1 in the unit disc */
static const size_t disc_cone[] = {3};
static const size_t disc_column[] = {0, 1, 2}, disc_row[] = {1, 2};
static const struct conic_shape disc = {
    .variables = 2, .linear = 0, .cones = 1, .cone = disc_cone, .column = disc_column, .row = disc_row};
static const double disc_g[] = {-1.0, -1.0}, disc_c[] = {-1.0, -1.0}, disc_h[] = {1.0, 0.0, 0.0};

static void test_solver(void **state)
{
    long k, needed;
    struct socp *socp;

    (void)state;
    live = made = 0;
    assert_int_equal(brdffit_socp_new(&disc, &socp), BRDFFIT_OK);
    needed = made;
    assert_true(needed > 50); /* ECOS's own are among them */
    brdffit_socp_free(socp);
    assert_int_equal(live, 0);
    for (for_good = 0; for_good < 2; for_good++) {
        for (k = 0; k < needed; k++) {
            left = k;
            assert_int_equal(brdffit_socp_new(&disc, &socp), BRDFFIT_ERR_MEMORY);
            left = -1;
            assert_null(socp);
            assert_int_equal(live, 0);
        }
    }
}

static void test_solving_allocates_nothing(void **state)
{
    const struct conic_data data = {disc_g, disc_c, disc_h};
    double x[2], z[3];
    struct socp_result result;
    struct socp *socp;
    int i;

    (void)state;
    assert_int_equal(brdffit_socp_new(&disc, &socp), BRDFFIT_OK);
    for (i = 0; i < 3; i++) {
        made = 0;
        assert_int_equal(brdffit_socp_solve(socp, &data, x, z, &result), BRDFFIT_OK);
        assert_int_equal(made, 0);
        assert_int_equal(result.outcome, SOCP_OPTIMAL);
        assert_true(result.primal > -1.4142136 && result.primal < -1.4142135);
    }
    brdffit_socp_free(socp);
}

static void fit_without_memory(brdffit_options *options)
{
    const double angle[] = {0.0, 0.2, 0.4, 0.6, 0.8, 1.0};
    double light[18], view[18], values[6];
    const brdffit_result *result;
    brdffit_samples samples;
    brdffit_error error;
    long k, needed;
    int i;

    for (i = 0; i < 6; i++) {
        light[3 * i] = 0.1 * angle[i];
        light[3 * i + 1] = 0.0;
        light[3 * i + 2] = 1.0;
        view[3 * i] = angle[i];
        view[3 * i + 1] = 0.0;
        view[3 * i + 2] = 1.0;
        values[i] = 0.1 + 1.0 / (1.0 + 20.0 * angle[i] * angle[i]);
    }
    brdffit_samples_init(&samples);
    samples.count = 6;
    samples.channels = 1;
    samples.light = light;
    samples.view = view;
    samples.values = values;
    live = made = 0;
    assert_int_equal(brdffit_fit_new(&samples, options, &result, &error), BRDFFIT_OK);
    needed = made;
    brdffit_result_free(result);
    assert_int_equal(live, 0);
    for (for_good = 0; for_good < 2; for_good++) {
        for (k = 0; k < needed; k += k < 100 ? 1 : 37) {
            left = k;
            assert_int_equal(brdffit_fit_new(&samples, options, &result, &error), BRDFFIT_ERR_MEMORY);
            left = -1;
            assert_null(result);
            assert_int_equal(live, 0);
        }
    }
}

static void test_fits(void **state)
{
    brdffit_options options;

    (void)state;
    brdffit_options_init(&options);
    options.relative_gap = 0.05;
    fit_without_memory(&options);
    options.engine = BRDFFIT_ENGINE_SOCP;
    fit_without_memory(&options);
    options.engine = BRDFFIT_ENGINE_MOMENT;
    options.norm = BRDFFIT_NORM_L1;
    fit_without_memory(&options);
    options.norm = BRDFFIT_NORM_LINF;
    fit_without_memory(&options);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_solver), cmocka_unit_test(test_solving_allocates_nothing),
                                       cmocka_unit_test(test_fits)};

#ifdef BRDFFIT_NO_ECOS
    return cmocka_run_group_tests(tests + 3, NULL, NULL);
#else
    return cmocka_run_group_tests(tests, NULL, NULL);
#endif
}
