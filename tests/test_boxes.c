/*
 * The boxes that a search shows: each one once, all of the domain, and no bound above what the samples say in long
 * double at points inside. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"
#include "verify_problem.h"

#define MOST 20000
#define POINTS 400

/* A box that is kept; without a second lobe, [1] is 0. */
struct kept {
    double sigma_low[BRDFFIT_MAX_LOBES], sigma_high[BRDFFIT_MAX_LOBES], lower_bound;
    int level;
};

struct seen {
    struct kept box[MOST];
    size_t count;
    int lobes;
};

static void keep(void *user, const brdffit_box *box)
{
    struct seen *seen = user;
    struct kept kept = {.lower_bound = box->lower_bound, .level = box->level};
    int p;

    assert_true(seen->count < MOST);
    assert_int_equal(box->lobes, seen->lobes);
    for (p = 0; p < box->lobes; p++) {
        kept.sigma_low[p] = box->sigma_low[p];
        kept.sigma_high[p] = box->sigma_high[p];
    }
    seen->box[seen->count++] = kept;
}

static int contains(const struct seen *seen, const struct kept *box, const double *sigma)
{
    int p, inside = 1;

    for (p = 0; p < seen->lobes; p++) {
        inside = inside && box->sigma_low[p] <= sigma[p] && sigma[p] <= box->sigma_high[p];
    }
    return inside;
}

/* Every box is in the range, ordered, and its level fits its size where no side was extended to the floor. */
static void check_sides(const struct seen *seen, const struct brdffit_test_result *result, const brdffit_options *o)
{
    double floor = fmax(result->sigma_floor, o->sigma_min), width[2] = {0.0, 0.0};
    size_t i;
    int p;

    for (i = 0; i < seen->count; i++) {
        const struct kept *box = &seen->box[i];
        double halvings = 0.0;
        int whole = 1;

        for (p = 0; p < seen->lobes; p++) {
            assert_true(box->sigma_low[p] >= floor && box->sigma_low[p] < box->sigma_high[p]);
            assert_true(box->sigma_high[p] <= o->sigma_max);
            width[p] = log(box->sigma_high[p] / box->sigma_low[p]);
            whole = whole && box->sigma_low[p] > floor;
            halvings -= log2(width[p]);
        }
        assert_true(seen->lobes == 2 ? box->sigma_low[0] <= box->sigma_low[1] : box->sigma_low[1] == 0.0);
        assert_true(box->lower_bound >= 0.0);
        if (whole) { /* the first box shown is the widest sigma of the first partition */
            const struct kept *first = &seen->box[0];

            halvings += seen->lobes * log2(log(first->sigma_high[0] / first->sigma_low[0]));
            assert_true(fabs(halvings - box->level) < 0.01);
        }
    }
}

/* The leaves prove the result: the last of the smallest boxes around any point has at least its bound. */
static void check_points(const struct seen *seen, const brdffit_samples *samples, const brdffit_options *o,
                         const struct brdffit_test_result *result)
{
    struct brdffit_test_random random = {7};
    struct verify_problem p;
    int i;

    memset(&p, 0, sizeof p);
    p.samples = samples;
    p.options = o;
    p.floor = result->sigma_floor;
    verify_classify(&p);
    verify_rows(&p, result->channel_scale);
    verify_floors(&p);
    for (i = 0; i < POINTS; i++) {
        double low = i % 2 ? 1e-3 : result->sigma_floor, near = i % 4 == 3 ? 1e-3 : 0.0;
        double x = brdffit_test_log_uniform(&random, low, o->sigma_max);
        double y = brdffit_test_log_uniform(&random, low, o->sigma_max);
        double sigma[2] = {o->lobes > 1 ? fmin(x, y) : x, fmax(x, y)};
        const struct kept *leaf = NULL;
        long double at[2], e2;
        size_t j;

        if (near > 0.0) {
            sigma[0] = result->model.sigma[0] * (1.0 + near * brdffit_test_normal(&random));
            sigma[1] = result->model.sigma[1] * (1.0 + near * brdffit_test_normal(&random));
        }
        at[0] = sigma[0];
        at[1] = o->lobes > 1 ? sigma[1] : sigma[0];
        e2 = verify_optimum(&p, at) + verify_allowance(&p, at);
        for (j = 0; j < seen->count; j++) {
            if (contains(seen, &seen->box[j], sigma)) {
                assert_true(seen->box[j].lower_bound <= (double)e2);
                leaf = !leaf || seen->box[j].level >= leaf->level ? &seen->box[j] : leaf;
            }
        }
        assert_non_null(leaf);
        assert_true(leaf->lower_bound >= result->lower_bound);
    }
    verify_problem_free(&p);
}

static void check_fit(const brdffit_samples *samples, brdffit_options *o)
{
    static struct seen seen;
    struct brdffit_test_fit fit, bare;

    brdffit_test_fit(samples, o, &bare);
    seen.count = 0;
    seen.lobes = o->lobes;
    o->box = keep;
    o->box_user = &seen;
    brdffit_test_fit(samples, o, &fit);
    assert_int_equal(seen.count, fit.result.boxes);
    assert_int_equal(fit.workspace_size, bare.workspace_size);
    assert_int_equal(fit.result.boxes, bare.result.boxes);
    assert_int_equal(fit.result.nodes, bare.result.nodes);
    assert_true(fit.result.e2 == bare.result.e2 && fit.result.lower_bound == bare.result.lower_bound);
    assert_true(fit.result.model.sigma[0] == bare.result.model.sigma[0]);
    check_sides(&seen, &fit.result, o);
    check_points(&seen, samples, o, &fit.result);
    brdffit_test_fit_free(&bare);
    brdffit_test_fit_free(&fit);
}

static void check_engine(brdffit_engine engine, int lobes, double gap)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    brdffit_options o;

    spec.noise = 0.02;
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init(&o);
    o.engine = engine;
    o.lobes = lobes;
    o.relative_gap = gap;
    check_fit(&data.samples, &o);
    brdffit_test_data_free(&data);
}

static void test_moment(void **state)
{
    (void)state;
    check_engine(BRDFFIT_ENGINE_MOMENT, 1, 1e-6);
    check_engine(BRDFFIT_ENGINE_MOMENT, 2, 1e-3);
}

#ifndef BRDFFIT_NO_ECOS
static void test_socp(void **state)
{
    (void)state;
    check_engine(BRDFFIT_ENGINE_SOCP, 1, 1e-4);
    check_engine(BRDFFIT_ENGINE_SOCP, 2, 0.3);
}

/* A verification shows its boxes too. */
static void test_verification(void **state)
{
    static struct seen seen;
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    const brdffit_result *result;
    const brdffit_verification *verification;
    brdffit_options o;
    size_t size, i, leaves = 0;
    double level;
    void *workspace;

    (void)state;
    spec.noise = 0.02;
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init(&o);
    assert_int_equal(brdffit_fit_new(&data.samples, &o, &result, NULL), BRDFFIT_OK);
    level = 0.9 * result->lower_bound;
    brdffit_result_free(result);
    seen.count = 0;
    seen.lobes = 1;
    o.engine = BRDFFIT_ENGINE_SOCP;
    o.box = keep;
    o.box_user = &seen;
    size = brdffit_workspace_size(data.samples.count, data.samples.channels, &o);
    workspace = malloc(size);
    assert_non_null(workspace);
    assert_int_equal(brdffit_verify(&data.samples, &o, level, workspace, size, &verification, NULL), BRDFFIT_OK);
    assert_int_equal(verification->proven, 1);
    assert_int_equal(seen.count, verification->boxes);
    for (i = 0; i < seen.count; i++) {
        leaves += seen.box[i].lower_bound >= level;
    }
    assert_int_equal(leaves, verification->leaves);
    free(workspace);
    brdffit_test_data_free(&data);
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moment),
#ifndef BRDFFIT_NO_ECOS
        cmocka_unit_test(test_socp),
        cmocka_unit_test(test_verification),
#endif
    };

    return cmocka_run_group_tests_name("boxes", tests, NULL, NULL);
}
