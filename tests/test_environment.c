/*
 * Same bits in every floating-point environment of the caller: rounding modes, FTZ and DAZ, unmasked traps; and the
 * caller's own environment is there again afterwards. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "brdffit_io.h"
#include "environments.h"
#include "support.h"

/* ---- What is compared ------------------------------------------------------------------------------------- */

#define CHANNELS 3
#define SAMPLES 84

struct outcome {
    brdffit_status fitted, inspected, evaluated, verified;
    struct brdffit_test_result result;
    brdffit_verification verification;
    double x[CHANNELS], y[CHANNELS * BRDFFIT_MAX_LOBES], scale[CHANNELS], rms[CHANNELS], table[SAMPLES * CHANNELS];
    size_t used, skipped[BRDFFIT_SKIP_COUNT], workspace;
};

struct problem {
    struct brdffit_test_data data;
    brdffit_options options;
    void *workspace;
    size_t size;
};

static void run(const struct problem *p, size_t mode, double level, struct outcome *out)
{
    const brdffit_verification *verification;
    size_t lobes = (size_t)p->options.lobes;

    memset(out, 0, sizeof *out);
    leave_tests(mode);
    out->workspace = brdffit_workspace_size(SAMPLES, CHANNELS, &p->options);
    out->inspected = brdffit_inspect(&p->data.samples, &p->options, &out->used, out->skipped, BRDFFIT_SKIP_COUNT, NULL);
    out->fitted = brdffit_test_run(&p->data.samples, &p->options, p->workspace, p->size, &out->result, NULL);
    out->evaluated = brdffit_test_eval(&out->result.model, &p->data.samples, out->table, NULL);
    back_to_tests(mode);
    if (out->fitted != BRDFFIT_OK) {
        fail_msg("environment %#x: the fit fails", modes[mode]);
    }
    memcpy(out->x, out->result.model.x, sizeof out->x);
    memcpy(out->y, out->result.model.y, CHANNELS * lobes * sizeof(double));
    memcpy(out->scale, out->result.channel_scale, sizeof out->scale);
    memcpy(out->rms, out->result.rms, sizeof out->rms);
    out->result.model.x = out->result.model.y = out->result.channel_scale = out->result.rms = NULL;
    if (level > 0.0) {
        leave_tests(mode);
        out->verified = brdffit_verify(&p->data.samples, &p->options, level, p->workspace, p->size, &verification,
                                       NULL);
        back_to_tests(mode);
        if (out->verified == BRDFFIT_OK) {
            out->verification = *verification;
        }
    }
}

static void compare(struct problem *p, int verify)
{
    struct outcome *first = malloc(sizeof *first), *other = malloc(sizeof *other);
    brdffit_options larger = p->options;
    size_t mode;
    double level = 0.0;

    assert_non_null(first);
    assert_non_null(other);
    larger.engine = verify ? BRDFFIT_ENGINE_SOCP : larger.engine;
    p->size = brdffit_workspace_size(SAMPLES, CHANNELS, &larger);
    if (p->size < brdffit_workspace_size(SAMPLES, CHANNELS, &p->options)) {
        p->size = brdffit_workspace_size(SAMPLES, CHANNELS, &p->options);
    }
    p->workspace = malloc(p->size);
    assert_non_null(p->workspace);
    run(p, 0, 0.0, first);
    if (verify) {
        level = 0.5 * first->result.lower_bound;
        run(p, 0, level, first);
        assert_int_equal(first->verified, BRDFFIT_OK);
        assert_true(first->verification.proven);
    }
    for (mode = 0; mode < MODES; mode++) {
        run(p, mode, level, other);
        if (memcmp(first, other, sizeof *first)) {
            brdffit_test_print(&p->data.samples, &p->options);
            fail_msg("environment %#x: other bits: E^2 %a, not %a; bound %a, not %a; boxes %zu, not %zu", modes[mode],
                     other->result.e2, first->result.e2, other->result.lower_bound, first->result.lower_bound,
                     other->result.boxes, first->result.boxes);
        }
    }
    free(p->workspace);
    free(first);
    free(other);
    brdffit_test_data_free(&p->data);
}

static struct problem problem(int lobes, brdffit_distribution distribution, double noise, double factor)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct problem p;
    size_t i;

    spec.noise = noise;
    spec.distribution = distribution;
    spec.form = BRDFFIT_FORM_DIRECTIONS;
    brdffit_test_data_new(&spec, &p.data);
    assert_int_equal(p.data.samples.count, SAMPLES);
    assert_int_equal(p.data.samples.channels, CHANNELS);
    for (i = 0; i < SAMPLES * CHANNELS; i++) {
        p.data.values[i] *= factor;
    }
    brdffit_options_init(&p.options);
    p.options.lobes = lobes;
    p.options.distribution = distribution;
    return p;
}

/* ---- Tests ------------------------------------------------------------------------------------------------ */

static void test_fits(void **state)
{
    static const brdffit_distribution some[] = {BRDFFIT_BECKMANN, BRDFFIT_GGX, BRDFFIT_LAFORTUNE};
    size_t d;
    int lobes;

    (void)state;
    for (d = 0; d < sizeof some / sizeof some[0]; d++) {
        for (lobes = 1; lobes <= 2; lobes++) {
            struct problem p = problem(lobes, some[d], 0.02, 1.0);

            compare(&p, 0);
        }
    }
}

/* Values that are subnormal beside larger ones, and data whose squares are: both are data under DAZ and FTZ too. */
static void test_subnormals(void **state)
{
    static const double factors[] = {1e-300, 1e-155, 1e100};
    size_t f, i;

    (void)state;
    for (f = 0; f < sizeof factors / sizeof factors[0]; f++) {
        struct problem p = problem(1, BRDFFIT_BECKMANN, 0.02, factors[f]);

        for (i = 0; i < SAMPLES; i += 3) {
            p.data.values[CHANNELS * i] = (double)i * 4.9406564584124654e-324;
        }
        p.options.absolute_gap = 1e-310; /* a subnormal option */
        compare(&p, 0);
    }
}

/* An option that is refused or not must not depend on DAZ. */
static void test_subnormal_option(void **state)
{
    brdffit_options options;
    size_t mode;

    (void)state;
    brdffit_options_init(&options);
    options.relative_gap = 1e-310; /* > 0 */
    for (mode = 0; mode < MODES; mode++) {
        size_t size;

        leave_tests(mode);
        size = brdffit_workspace_size(SAMPLES, CHANNELS, &options);
        back_to_tests(mode);
        assert_true(size > 0);
    }
}

/* Decimal numbers that rounding decides, a subnormal one, and angles. */
static void test_reading(void **state)
{
    static const char text[] = "theta_i,phi_i,theta_o,phi_o,weight,r\n"
                               "10.1,33.3,20.7,200,0.1,1.1\n"
                               "41.3,1e-3,7.77,12,1e-310,123456789012345678901234567890e-31\n"
                               "0.3,359.9,59.999999999999,180,3e-5,1.00000000000000011102230246251565\n";
    double light[2][84 * 3], view[2][84 * 3];
    brdffit_table *first, *other;
    size_t mode;

    (void)state;
    assert_int_equal(brdffit_io_read_memory(text, sizeof text - 1, NULL, &first, NULL), BRDFFIT_OK);
    assert_int_equal(first->samples->count, 3);
    brdffit_io_protocol84(light[0], view[0]);
    for (mode = 0; mode < MODES; mode++) {
        brdffit_status status;

        leave_tests(mode);
        status = brdffit_io_read_memory(text, sizeof text - 1, NULL, &other, NULL);
        brdffit_io_protocol84(light[1], view[1]);
        back_to_tests(mode);
        assert_int_equal(status, BRDFFIT_OK);
        assert_memory_equal(first->samples->light, other->samples->light, 9 * sizeof(double));
        assert_memory_equal(first->samples->view, other->samples->view, 9 * sizeof(double));
        assert_memory_equal(first->samples->values, other->samples->values, 3 * sizeof(double));
        assert_memory_equal(first->samples->weights, other->samples->weights, 3 * sizeof(double));
        assert_memory_equal(light[0], light[1], sizeof light[0]);
        assert_memory_equal(view[0], view[1], sizeof view[0]);
        brdffit_io_free(other);
    }
    brdffit_io_free(first);
}

#ifndef BRDFFIT_NO_ECOS
static void test_norms_and_cones(void **state)
{
    struct problem p = problem(1, BRDFFIT_BECKMANN, 0.02, 1.0);

    (void)state;
    p.options.norm = BRDFFIT_NORM_L1;
    compare(&p, 0);
    p = problem(1, BRDFFIT_BECKMANN, 0.02, 1.0);
    p.options.engine = BRDFFIT_ENGINE_SOCP;
    p.options.relative_gap = 0.05;
    compare(&p, 1);
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fits),
        cmocka_unit_test(test_subnormals),
        cmocka_unit_test(test_subnormal_option),
        cmocka_unit_test(test_reading),
#ifndef BRDFFIT_NO_ECOS
        cmocka_unit_test(test_norms_and_cones),
#endif
    };

    return cmocka_run_group_tests_name("floating-point environment", tests, NULL, NULL);
}
