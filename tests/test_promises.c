/*
 * What brdffit.h promises besides the numbers: same input same bits, no allocation inside a fit, cancelling,
 * budgets that always leave a valid bound, any alignment. SPDX-License-Identifier: MIT
 *
 * Calls to the allocator are seen by the linker's --wrap, which works under sanitizers too.
 * LDFLAGS: -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"
#include "verify.h"

/* ---- The allocator ---------------------------------------------------------------------------------------- */

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
void __wrap_free(void *block);

static size_t allocator_calls;
static size_t fail_at; /* the allocation that fails; 0: none */
static size_t allocations;

static int allocation_fails(void)
{
    allocator_calls++;
    return ++allocations == fail_at;
}

void *__wrap_malloc(size_t size)
{
    return allocation_fails() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return allocation_fails() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *block, size_t size)
{
    return allocation_fails() ? NULL : __real_realloc(block, size);
}

void __wrap_free(void *block)
{
    allocator_calls++;
    __real_free(block);
}

/* ---- Problems --------------------------------------------------------------------------------------------- */

static void noisy(struct brdffit_test_data *data, brdffit_form form)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();

    spec.form = form;
    spec.noise = 0.02;
    spec.weighted = form == BRDFFIT_FORM_ANGLES;
    brdffit_test_data_new(&spec, data);
}

static void test_no_allocation(void **state)
{
    struct brdffit_test_data data;
    brdffit_options options;

    (void)state;
    noisy(&data, BRDFFIT_FORM_DIRECTIONS);
    for (brdffit_options_init(&options); options.lobes <= 2; options.lobes++) {
        size_t size = brdffit_workspace_size(data.samples.count, data.samples.channels, &options);
        void *workspace = malloc(size);
        double out[84 * 3];
        struct brdffit_test_result result;
        char why[512];

        assert_non_null(workspace);
        allocator_calls = 0;
        assert_int_equal(brdffit_test_run(&data.samples, &options, workspace, size, &result, NULL), BRDFFIT_OK);
        assert_int_equal(brdffit_test_eval(&result.model, &data.samples, out, NULL), BRDFFIT_OK);
        assert_int_equal(allocator_calls, 0);
        if (brdffit_test_verify(&data.samples, &options, &result, why, sizeof why)) {
            fail_msg("%s", why);
        }
        assert_true(allocator_calls > 0); /* the counter works */
        free(workspace);
    }
    brdffit_test_data_free(&data);
}

static void test_allocation_failure(void **state)
{
    struct brdffit_test_data data;
    size_t k, failures = 0;

    (void)state;
    noisy(&data, BRDFFIT_FORM_DIRECTIONS);
    for (k = 1;; k++) {
        const brdffit_result *result = NULL;
        brdffit_error error;
        brdffit_status status;

        allocations = 0;
        fail_at = k;
        status = brdffit_fit_new(&data.samples, NULL, &result, &error);
        fail_at = 0;
        if (status == BRDFFIT_OK) {
            struct brdffit_test_result flat;
            char why[512];

            brdffit_test_flatten(result, &flat);
            if (brdffit_test_verify(&data.samples, NULL, &flat, why, sizeof why)) {
                fail_msg("%s", why);
            }
            brdffit_result_free(result);
            break;
        }
        assert_int_equal(status, BRDFFIT_ERR_MEMORY);
        assert_int_equal(error.status, BRDFFIT_ERR_MEMORY);
        assert_null(result);
        failures++;
    }
    assert_true(failures >= 1);
    brdffit_test_data_free(&data);
}

/* ---- Same bits -------------------------------------------------------------------------------------------- */

/* Everything but the pointers, bit by bit, then the arrays. */
static void assert_same_bits(const struct brdffit_test_result *first, const struct brdffit_test_result *second)
{
    size_t lobes = (size_t)first->model.lobes, channels = first->model.channels;

    assert_memory_equal(first->model.sigma, second->model.sigma, lobes * sizeof(double));
    assert_memory_equal(first->model.x, second->model.x, channels * sizeof(double));
    assert_memory_equal(first->model.y, second->model.y, channels * lobes * sizeof(double));
    assert_memory_equal(first->channel_scale, second->channel_scale, channels * sizeof(double));
    assert_memory_equal(first->rms, second->rms, channels * sizeof(double));
    assert_memory_equal(&first->rms_total, &second->rms_total, sizeof(double));
    assert_memory_equal(&first->e2, &second->e2, sizeof(double));
    assert_memory_equal(&first->lower_bound, &second->lower_bound, sizeof(double));
    assert_memory_equal(&first->gap, &second->gap, sizeof(double));
    assert_memory_equal(&first->sum_of_squares, &second->sum_of_squares, sizeof(double));
    assert_memory_equal(&first->kkt_residual, &second->kkt_residual, sizeof(double));
    assert_int_equal(first->stop, second->stop);
    assert_int_equal(first->boxes, second->boxes);
    assert_int_equal(first->nodes, second->nodes);
    assert_int_equal(first->distinct_c, second->distinct_c);
}

/* Whatever the workspace held before, and wherever it starts. */
static void test_any_workspace(void **state)
{
    struct brdffit_test_data data;
    struct brdffit_test_fit fit;
    brdffit_options options;
    size_t offset;

    (void)state;
    noisy(&data, BRDFFIT_FORM_ANGLES);
    for (brdffit_options_init(&options); options.lobes <= 2; options.lobes++) {
        brdffit_test_fit(&data.samples, &options, &fit);
        for (offset = 0; offset < 64; offset++) {
            unsigned char *block = malloc(fit.workspace_size + offset);
            struct brdffit_test_result result;

            assert_non_null(block);
            memset(block, (int)(offset * 37 + 255), fit.workspace_size + offset);
            memset(&result, 0xa5, sizeof result);
            assert_int_equal(
                brdffit_test_run(&data.samples, &options, block + offset, fit.workspace_size, &result, NULL),
                BRDFFIT_OK);
            assert_same_bits(&fit.result, &result);
            free(block);
        }
        brdffit_test_fit_free(&fit);
    }
    brdffit_test_data_free(&data);
}

/* Order of samples and channels changes nothing but roundings. */
static void test_permutations(void **state)
{
    struct brdffit_test_data data, mixed;
    brdffit_options options;
    size_t n, k;

    (void)state;
    noisy(&data, BRDFFIT_FORM_COEFFICIENTS);
    noisy(&mixed, BRDFFIT_FORM_COEFFICIENTS);
    n = data.samples.count;
    for (brdffit_options_init(&options); options.lobes <= 2; options.lobes++) {
        struct brdffit_test_fit fit, other;
        double a[84], b[84], c[84];
        size_t i;

        for (i = 0; i < n; i++) {
            size_t from = (i * 25 + 7) % n; /* 25 and 84 have no common factor */

            a[i] = data.samples.a[from];
            b[i] = data.samples.b[from];
            c[i] = data.samples.c[from];
            for (k = 0; k < 3; k++) {
                mixed.values[3 * i + k] = data.values[3 * from + (k + 1) % 3];
            }
        }
        mixed.samples.a = a;
        mixed.samples.b = b;
        mixed.samples.c = c;
        brdffit_test_fit(&data.samples, &options, &fit);
        brdffit_test_fit(&mixed.samples, &options, &other);
        assert_true(fabs(other.result.e2 / fit.result.e2 - 1.0) <= 1e-12);
        assert_true(fabs(other.result.model.sigma[0] / fit.result.model.sigma[0] - 1.0) <= 1e-6);
        for (k = 0; k < 3; k++) {
            assert_true(fabs(other.result.model.x[k] / fit.result.model.x[(k + 1) % 3] - 1.0) <= 1e-5);
        }
        brdffit_test_fit_free(&fit);
        brdffit_test_fit_free(&other);
    }
    brdffit_test_data_free(&data);
    brdffit_test_data_free(&mixed);
}

/* ---- Stops ------------------------------------------------------------------------------------------------ */

struct watch {
    size_t calls, reduced, cancel_at; /* cancel_at: the call that says stop; 0: none */
    size_t boxes;
    double e2, lower_bound;
    int ordered;
};

static int watch_progress(void *user, const brdffit_progress *progress)
{
    struct watch *watch = user;

    watch->calls++;
    watch->reduced += progress->phase == BRDFFIT_PHASE_REDUCED;
    if (watch->calls > 1) { /* the first call is the reduction's: later ones only get better */
        watch->ordered &= progress->phase == BRDFFIT_PHASE_SEARCH && progress->boxes >= watch->boxes;
        watch->ordered &= progress->e2 <= watch->e2 && progress->lower_bound <= progress->e2;
        watch->ordered &= progress->lower_bound >= watch->lower_bound;
    } else {
        watch->ordered = progress->phase == BRDFFIT_PHASE_REDUCED;
    }
    watch->boxes = progress->boxes;
    watch->e2 = progress->e2;
    watch->lower_bound = progress->lower_bound;
    return watch->calls == watch->cancel_at;
}

static void test_progress_and_cancel(void **state)
{
    struct brdffit_test_data data;
    struct brdffit_test_fit quiet, fit;
    struct watch watch;
    brdffit_options options;
    size_t cancel_at;

    struct brdffit_test_spec spec = brdffit_test_spec_default();

    (void)state;
    spec.noise = 0.02;
    spec.lobes = 1; /* where the second lobe fits noise, the search takes a while */
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init(&options);
    options.lobes = 2;
    options.relative_gap = 1e-10;
    brdffit_test_fit(&data.samples, &options, &quiet);
    options.progress = watch_progress;
    options.progress_user = &watch;
    memset(&watch, 0, sizeof watch);
    brdffit_test_fit(&data.samples, &options, &fit);
    assert_same_bits(&quiet.result, &fit.result); /* watching changes nothing */
    assert_int_equal(watch.reduced, 1);
    assert_true(watch.calls >= 4);
    assert_true(watch.calls <= 2 + fit.result.boxes / 256);
    assert_true(watch.ordered);
    brdffit_test_fit_free(&fit);
    for (cancel_at = 1; cancel_at <= 3; cancel_at++) {
        memset(&watch, 0, sizeof watch);
        watch.cancel_at = cancel_at;
        brdffit_test_fit(&data.samples, &options, &fit);
        assert_int_equal(watch.calls, cancel_at);
        assert_int_equal(fit.result.stop, BRDFFIT_STOP_CANCELLED);
        assert_int_equal(fit.result.certified, 0);
        assert_true(fit.result.boxes < quiet.result.boxes);
        brdffit_test_fit_free(&fit);
    }
    brdffit_test_fit_free(&quiet);
    brdffit_test_data_free(&data);
}

static void test_budgets(void **state)
{
    static const size_t budget[] = {1, 2, 3, 10, 100, 1000};
    struct brdffit_test_data data;
    brdffit_options options;
    size_t i;

    (void)state;
    noisy(&data, BRDFFIT_FORM_DIRECTIONS);
    for (brdffit_options_init(&options); options.lobes <= 2; options.lobes++) {
        for (options.distribution = BRDFFIT_BECKMANN; options.distribution < BRDFFIT_DISTRIBUTION_COUNT;
             options.distribution = (brdffit_distribution)(options.distribution + 1)) {
            for (i = 0; i < sizeof budget / sizeof budget[0]; i++) {
                struct brdffit_test_fit fit;

                options.box_budget = budget[i];
                options.relative_gap = 1e-13;
                options.absolute_gap = 0.0;
                brdffit_test_fit(&data.samples, &options, &fit);
                assert_int_equal(fit.result.certified, 0);
                assert_true(fit.result.lower_bound < fit.result.e2);
                assert_true(i > 2 || fit.result.stop == BRDFFIT_STOP_BUDGET);
                brdffit_test_fit_free(&fit);
            }
        }
    }
    brdffit_test_data_free(&data);
}

static void test_sigma_resolution(void **state)
{
    struct brdffit_test_data data;
    brdffit_options options;

    (void)state;
    noisy(&data, BRDFFIT_FORM_DIRECTIONS);
    for (brdffit_options_init(&options); options.lobes <= 2; options.lobes++) {
        struct brdffit_test_fit fine, coarse;

        options.relative_gap = 1e-9;
        options.absolute_gap = 0.0;
        options.sigma_resolution = 1e-3;
        brdffit_test_fit(&data.samples, &options, &fine);
        assert_true(fine.result.stop == BRDFFIT_STOP_RESOLUTION || fine.result.certified);
        options.sigma_resolution = 0.5;
        brdffit_test_fit(&data.samples, &options, &coarse);
        assert_int_equal(coarse.result.stop, BRDFFIT_STOP_RESOLUTION);
        assert_true(coarse.result.boxes < fine.result.boxes);
        options.sigma_resolution = 0.0;
        brdffit_test_fit_free(&fine);
        brdffit_test_fit_free(&coarse);
    }
    brdffit_test_data_free(&data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_allocation),       cmocka_unit_test(test_allocation_failure),
        cmocka_unit_test(test_any_workspace),       cmocka_unit_test(test_permutations),
        cmocka_unit_test(test_progress_and_cancel), cmocka_unit_test(test_budgets),
        cmocka_unit_test(test_sigma_resolution),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
