/*
 * Anisotropic lobes: evaluation against formulas, truth recovered, bounds attacked, brute force, frames, the same bits.
 * SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "anisotropic_case.h"
#include "base/isa.h"
#include "fewer.h"
#include "fit/fit.h"

static const brdffit_distribution ours[] = {BRDFFIT_BECKMANN, BRDFFIT_GGX, BRDFFIT_WARD, BRDFFIT_ASHIKHMIN_SHIRLEY};

static brdffit_options options_of(const struct anisotropic_model *m)
{
    brdffit_options o;

    brdffit_options_init(&o);
    o.anisotropic = 1;
    o.lobes = m->lobes;
    o.distributions = m->distribution;
    o.distribution = m->distribution[0];
    o.fresnel = m->fresnel ? BRDFFIT_FRESNEL_SCHLICK : BRDFFIT_FRESNEL_NONE;
    o.max_incidence = 90.0;
    o.tangent_angle = m->turned;
    return o;
}

static const brdffit_result *fit(const struct anisotropic_case *c, const brdffit_options *o)
{
    const brdffit_result *result = NULL;
    brdffit_error error;
    brdffit_status status = brdffit_fit_new(&c->samples, o, &result, &error);

    if (status != BRDFFIT_OK) {
        print_error("%s\n", error.message);
    }
    assert_int_equal(status, BRDFFIT_OK);
    return result;
}

/* Roughnesses of a kind of lobe in an ordinary range, as s. */
static void draw_shape(uint64_t *state, brdffit_distribution distribution, long double *s)
{
    int j, exponent = distribution == BRDFFIT_ASHIKHMIN_SHIRLEY;

    for (j = 0; j < 3; j++) {
        double sigma = 0.08 * pow(6.0, case_uniform(state));

        s[j] = exponent ? floor(2.0 + 60.0 * case_uniform(state)) : 1.0 / (sigma * sigma);
    }
}

static void test_formulas(void **state)
{
    uint64_t seed = 11;
    int i, trial;

    (void)state;
    for (i = 0; i < 4; i++) {
        for (trial = 0; trial < 20; trial++) {
            struct anisotropic_model m = {
                {ours[i], ours[i]}, 1, trial % 2, trial % 3 ? 360.0 * case_signed(&seed) : 0.0};
            struct anisotropic_case c;
            long double s[3];
            double out[AC_SAMPLES], sigma[1], x[1] = {0.3}, y[1] = {0.7}, f0[1] = {0.2}, ratio[1], turned[1];
            brdffit_model model;
            size_t j;

            ac_make(&c, &seed, 40, 1, 0);
            draw_shape(&seed, ours[i], s);
            brdffit_model_init(&model);
            sigma[0] = (double)(1.0L / sqrtl(sqrtl(s[0] * s[1])));
            ratio[0] = (double)sqrtl(s[1] / s[0]);
            turned[0] = m.turned;
            model.distribution = ours[i];
            model.channels = 1;
            model.sigma = sigma;
            model.x = x;
            model.y = y;
            model.f0 = f0;
            model.fresnel = m.fresnel ? BRDFFIT_FRESNEL_SCHLICK : BRDFFIT_FRESNEL_NONE;
            model.anisotropy = ratio;
            model.tangent_angle = turned;
            assert_int_equal(brdffit_eval(&model, &c.samples, out, NULL), BRDFFIT_OK);
            for (j = 0; j < c.count; j++) {
                long double lobe = ac_column(&c, &m, j, 1, s), value = 0.3L * ac_column(&c, &m, j, 0, s);

                value += 0.7L * (m.fresnel ? 0.2L * lobe + 0.8L * ac_column(&c, &m, j, 2, s) : lobe);
                assert_true(fabsl(out[j] - value / ac_angles(&c, j, 0.0).nl) <= 1e-12L * fabsl(value) + 1e-14L);
            }
        }
    }
}

static void test_truth_is_found(void **state)
{
    uint64_t seed = 5;
    int i, trial;

    (void)state;
    for (i = 0; i < 4; i++) {
        for (trial = 0; trial < FEWER(8, 2); trial++) {
            struct anisotropic_model m = {{ours[i], BRDFFIT_BECKMANN}, 1 + (trial == 7), trial % 2, 0.0};
            int exponent = ours[i] == BRDFFIT_ASHIKHMIN_SHIRLEY;
            struct anisotropic_case c;
            const brdffit_result *r;
            long double s[3];
            brdffit_options o = options_of(&m);
            double along, across;

            ac_make(&c, &seed, 64, 2, trial == 3);
            draw_shape(&seed, ours[i], s);
            s[2] = 1.0L / (0.3L * 0.3L);
            ac_fill(&c, &m, &seed, s, 0.0, 0.1);
            r = fit(&c, &o);
            along = exponent ? 1.0 / (r->lobe[0]->sigma_x * r->lobe[0]->sigma_x) : r->lobe[0]->sigma_x;
            across = exponent ? 1.0 / (r->lobe[0]->sigma_y * r->lobe[0]->sigma_y) : r->lobe[0]->sigma_y;
            assert_int_equal(r->certified, 1);
            assert_true(r->e2 <= 1e-20 * r->sum_of_squares);
            assert_true(fabs(along / (double)(exponent ? s[0] : 1.0L / sqrtl(s[0])) - 1.0) <= 1e-9);
            assert_true(fabs(across / (double)(exponent ? s[1] : 1.0L / sqrtl(s[1])) - 1.0) <= 1e-9);
            if (m.fresnel) {
                assert_true(fabs(r->model->f0[0] - 0.1) <= 1e-9);
            }
            brdffit_result_free(r);
        }
    }
}

/* A fit with its engine, box by box. */
struct opened {
    struct fit fit;
    struct engine engine;
    void *workspace;
    double scale;
};

static void open_engine(struct opened *f, const struct anisotropic_case *c, const brdffit_options *o)
{
    size_t size = brdffit_workspace_size(c->count, c->channels, o);

    f->workspace = malloc(size);
    assert_non_null(f->workspace);
    assert_int_equal(brdffit_fit_open(&f->fit, &c->samples, o, f->workspace, size, f->workspace, NULL), BRDFFIT_OK);
    brdffit_fit_anisotropic_engine(&f->fit, o, &f->engine);
    f->scale = brdffit_fit_scale(&f->fit.data, o);
}

/* A random box, by splitting at random, and its bound against the least objective at points of it. */
static void attack_box(struct opened *f, const struct anisotropic_case *c, const struct anisotropic_model *m,
                       uint64_t *seed, int points, size_t *tight)
{
    struct box box = {0.0, 0, 0, {0}};
    int side, depth, sides = f->fit.model.sides, i;
    struct point met;

    for (side = 0; side < sides; side++) {
        struct axis *axis = &f->fit.axis[side];

        box.interval[side] = (uint32_t)(case_next(seed) % axis->first);
        for (depth = (int)(case_next(seed) % 12); depth > 0; depth--) {
            uint32_t child = brdffit_axis_split(axis, box.interval[side]);

            box.interval[side] = child ? child + (uint32_t)(case_next(seed) % 2) : box.interval[side];
        }
    }
    box.bound = INFINITY;
    (void)f->engine.bound(f->engine.self, &box, &met);
    for (i = 0; i < points; i++) {
        long double s[3] = {1.0L, 1.0L, 1.0L}, objective;

        for (side = 0; side < sides; side++) {
            double low, high, at = i < 8 ? (double)(i >> side & 1) : case_uniform(seed);

            brdffit_axis_ends(&f->fit.axis[side], box.interval[side], &low, &high);
            s[side] = expl(low + (high - low) * (long double)at);
        }
        objective = ac_objective(c, m, s);
        if (!(box.bound * f->scale <= objective + 1e-15L * f->fit.data.total)) {
            print_error("box bound %.17g, but %.17Lg at s = %Lg %Lg %Lg\n", box.bound * f->scale, objective, s[0], s[1],
                        s[2]);
            fail();
        }
        *tight += box.bound * f->scale > 0.9 * (double)objective;
    }
}

static void test_bounds_hold(void **state)
{
    uint64_t seed = 77;
    size_t tight = 0, all = 0;
    int i, trial, boxes;

    (void)state;
    for (trial = 0; trial < FEWER(60, 8); trial++) {
        struct anisotropic_model m = {
            {ours[trial % 4], ours[(trial / 4) % 3]}, 1 + (trial % 3 == 0), trial % 5 > 2, 0.0};
        struct anisotropic_case c;
        struct opened f;
        long double s[3];
        brdffit_options o = options_of(&m);

        ac_make(&c, &seed, 12 + (size_t)(case_next(&seed) % 30), 1 + (size_t)(trial % 3), trial % 2);
        draw_shape(&seed, ours[trial % 4], s);
        ac_fill(&c, &m, &seed, s, trial % 4 ? 0.05 : 0.8, 0.1);
        open_engine(&f, &c, &o);
        boxes = FEWER(60, 10);
        for (i = 0; i < boxes; i++, all += 24) {
            attack_box(&f, &c, &m, &seed, 24, &tight);
        }
        free(f.workspace);
    }
    assert_true(tight > all / 20); /* the attack meets bounds that are close */
}

/* No point of a grid is below the bound, and none is better than what is certified allows. */
static void test_brute_force(void **state)
{
    uint64_t seed = 901;
    int trial, i, j;

    (void)state;
    for (trial = 0; trial < FEWER(12, 3); trial++) {
        struct anisotropic_model m = {{ours[trial % 4], BRDFFIT_BECKMANN}, 1, trial % 2, trial * 10.0};
        struct anisotropic_case c;
        const brdffit_result *r;
        long double s[3] = {1.0L, 1.0L, 1.0L}, least = INFINITY;
        brdffit_options o = options_of(&m);

        ac_make(&c, &seed, 40, 2, 1);
        draw_shape(&seed, ours[trial % 4], s);
        ac_fill(&c, &m, &seed, s, 0.2, 0.1);
        r = fit(&c, &o);
        assert_int_equal(r->certified, 1);
        for (i = 0; i < 40; i++) {
            for (j = 0; j < 40; j++) {
                long double from = ours[trial % 4] == BRDFFIT_ASHIKHMIN_SHIRLEY ? 0.2L : 0.1L;

                s[0] = from * powl(2e4L, i / 39.0L);
                s[1] = from * powl(2e4L, j / 39.0L);
                least = fminl(least, ac_objective(&c, &m, s));
            }
        }
        assert_true(least >= r->lower_bound * (1.0L - 1e-12L));
        assert_true(r->e2 <= (double)least * (1.0 + o.relative_gap));
        brdffit_result_free(r);
    }
}

/* The model of a result, at its own numbers, leaves the E^2 that is said. */
static void test_result_describes_its_model(void **state)
{
    struct anisotropic_model m = {{BRDFFIT_GGX, BRDFFIT_BECKMANN}, 2, 1, 25.0};
    long double s[3] = {100.0L, 8.0L, 11.0L};
    struct anisotropic_case c;
    double out[AC_SAMPLES * 3], sum = 0.0, most[3] = {0.0};
    const brdffit_result *r;
    brdffit_options o = options_of(&m);
    uint64_t seed = 3;
    size_t i, k;

    (void)state;
    ac_make(&c, &seed, 50, 3, 0);
    ac_fill(&c, &m, &seed, s, 0.02, 0.1);
    r = fit(&c, &o);
    assert_int_equal(r->certified, 1);
    assert_true(r->lobe[0]->tangent_angle == 25.0 && r->lobe[1]->tangent_angle == 0.0);
    assert_true(fabs(r->lobe[0]->sigma_x * r->lobe[0]->sigma_y / (r->lobe[0]->sigma * r->lobe[0]->sigma) - 1.0) <=
                1e-14);
    assert_true(r->lobe[1]->sigma_x == r->lobe[1]->sigma && r->lobe[1]->sigma_y == r->lobe[1]->sigma);
    assert_int_equal(brdffit_eval(r->model, &c.samples, out, NULL), BRDFFIT_OK);
    for (k = 0; k < 3; k++) {
        for (i = 0; i < c.count; i++) {
            most[k] = fmax(most[k], c.values[3 * i + k] * (double)ac_angles(&c, i, 0.0).nl);
        }
        for (i = 0; i < c.count; i++) {
            double residual = (out[3 * i + k] - c.values[3 * i + k]) * (double)ac_angles(&c, i, 0.0).nl / most[k];

            sum += residual * residual;
        }
    }
    assert_true(fabs(sum / r->e2 - 1.0) <= 1e-9);
    brdffit_result_free(r);
}

/* Turned a quarter, along and across change places; in a tilted frame with normals and tangents nothing changes. */
static void test_frames(void **state)
{
    struct anisotropic_model m = {{BRDFFIT_BECKMANN, BRDFFIT_BECKMANN}, 1, 0, 0.0};
    long double s[3] = {150.0L, 9.0L, 1.0L};
    struct anisotropic_case c;
    const double n[3] = {0.6, 0.0, 0.8}, t[3] = {0.8, 0.0, -0.6}, b[3] = {0.0, 1.0, 0.0};
    const brdffit_result *plain, *turned, *tilted;
    brdffit_options o = options_of(&m);
    uint64_t seed = 21;
    size_t i, j;

    (void)state;
    ac_make(&c, &seed, 48, 1, 0);
    ac_fill(&c, &m, &seed, s, 0.05, 0.1);
    plain = fit(&c, &o);
    o.tangent_angle = 90.0;
    turned = fit(&c, &o);
    assert_true(fabs(turned->lobe[0]->sigma_x / plain->lobe[0]->sigma_y - 1.0) <= 1e-9);
    assert_true(fabs(turned->lobe[0]->sigma_y / plain->lobe[0]->sigma_x - 1.0) <= 1e-9);
    for (i = 0; i < c.count; i++) {
        double *vectors[2] = {c.light + 3 * i, c.view + 3 * i};

        for (j = 0; j < 6; j++) {
            double *v = vectors[j / 3], x = v[0], y = v[1], z = v[2];

            if (j % 3 == 0) {
                v[0] = x * t[0] + y * b[0] + z * n[0];
                v[1] = x * t[1] + y * b[1] + z * n[1];
                v[2] = x * t[2] + y * b[2] + z * n[2];
            }
            c.normal[3 * i + j % 3] = n[j % 3];
            c.tangent[3 * i + j % 3] = 2.0 * t[j % 3] + 0.7 * n[j % 3]; /* what is along the normal does not count */
        }
    }
    c.samples.normal = c.normal;
    c.samples.tangent = c.tangent;
    o.tangent_angle = 0.0;
    tilted = fit(&c, &o);
    assert_true(fabs(tilted->lobe[0]->sigma_x / plain->lobe[0]->sigma_x - 1.0) <= 1e-9);
    assert_true(fabs(tilted->lobe[0]->sigma_y / plain->lobe[0]->sigma_y - 1.0) <= 1e-9);
    brdffit_result_free(plain);
    brdffit_result_free(turned);
    brdffit_result_free(tilted);
}

/* Data of an isotropic lobe: the ratio is 1, and no worse than the isotropic fit; a given ratio is kept. */
static void test_isotropic_data(void **state)
{
    struct anisotropic_model m = {{BRDFFIT_GGX, BRDFFIT_GGX}, 1, 1, 0.0};
    long double s[3] = {30.0L, 30.0L, 1.0L};
    struct anisotropic_case c;
    const brdffit_result *r, *plain, *given;
    brdffit_options o = options_of(&m);
    uint64_t seed = 8;

    (void)state;
    ac_make(&c, &seed, 60, 3, 0);
    ac_fill(&c, &m, &seed, s, 0.01, 0.1);
    r = fit(&c, &o);
    o.anisotropy = 1.5;
    given = fit(&c, &o);
    o.anisotropic = 0;
    o.anisotropy = 0.0;
    plain = fit(&c, &o);
    assert_true(fabs(r->lobe[0]->sigma_x / r->lobe[0]->sigma_y - 1.0) < 0.05);
    assert_true(r->e2 <= plain->e2 && r->lower_bound <= plain->e2);
    assert_true(given->lower_bound > r->e2);
    assert_true(fabs(given->lobe[0]->sigma_x / given->lobe[0]->sigma_y / 1.5 - 1.0) <= 1e-14);
    brdffit_result_free(r);
    brdffit_result_free(plain);
    brdffit_result_free(given);
}

static void test_same_bits(void **state)
{
    struct anisotropic_model m = {{BRDFFIT_BECKMANN, BRDFFIT_GGX}, 2, 1, 12.0};
    long double s[3] = {60.0L, 10.0L, 20.0L};
    struct anisotropic_case c;
    brdffit_options o = options_of(&m);
    const brdffit_result *first = NULL, *r;
    uint64_t seed = 4;
    int isa;

    (void)state;
    ac_make(&c, &seed, 40, 2, 1);
    ac_fill(&c, &m, &seed, s, 0.1, 0.1);
    for (isa = 0; isa < BRDFFIT_ISA_COUNT; isa++) {
        if (!brdffit_isa_supported((brdffit_isa)isa)) {
            continue;
        }
        o.isa = (brdffit_isa)isa;
        r = fit(&c, &o);
        if (first) {
            assert_memory_equal(&r->e2, &first->e2, sizeof r->e2);
            assert_memory_equal(&r->lower_bound, &first->lower_bound, sizeof r->e2);
            assert_int_equal(r->boxes, first->boxes);
            assert_memory_equal(r->lobe[0], first->lobe[0], sizeof *r->lobe[0]);
            brdffit_result_free(r);
        } else {
            first = r;
        }
    }
    brdffit_result_free(first);
}

static void refused(const struct anisotropic_case *c, const brdffit_options *o, brdffit_status expected)
{
    const brdffit_result *result = NULL;
    brdffit_error error;

    assert_int_equal(brdffit_fit_new(&c->samples, o, &result, &error), expected);
    assert_null(result);
    assert_true(error.message[0]);
}

static void test_refusals(void **state)
{
    struct anisotropic_model m = {{BRDFFIT_BECKMANN, BRDFFIT_GGX}, 1, 0, 0.0};
    const brdffit_options good = options_of(&m);
    long double s[3] = {60.0L, 10.0L, 20.0L};
    struct anisotropic_case c;
    brdffit_options o = good;
    uint64_t seed = 4;

    (void)state;
    ac_make(&c, &seed, 20, 1, 0);
    ac_fill(&c, &m, &seed, s, 0.1, 0.1);
    o.distributions = NULL;
    o.distribution = BRDFFIT_LAFORTUNE;
    refused(&c, &o, BRDFFIT_ERR_UNSUPPORTED);
    o = good;
    o.masking = BRDFFIT_MASKING_SMITH;
    refused(&c, &o, BRDFFIT_ERR_UNSUPPORTED);
    o = good;
    o.norm = BRDFFIT_NORM_L1;
    refused(&c, &o, BRDFFIT_ERR_UNSUPPORTED);
    o = good;
    o.anisotropy = -1.0;
    refused(&c, &o, BRDFFIT_ERR_OPTION);
    o = good;
    o.anisotropic = 2;
    refused(&c, &o, BRDFFIT_ERR_OPTION);
    o = good;
    for (c.count = 0; c.count < 20; c.count++) { /* a normal that is not +z, and nobody says where the tangent is */
        c.normal[3 * c.count] = 0.1;
        c.normal[3 * c.count + 2] = 1.0;
    }
    c.samples.normal = c.normal;
    refused(&c, &o, BRDFFIT_ERR_VALUE);
    c.samples.normal = NULL;
    c.samples.form = BRDFFIT_FORM_ANGLES;
    c.samples.cos_light = c.samples.cos_view = c.samples.tan2_half = c.samples.cos_difference = c.weights;
    refused(&c, &o, BRDFFIT_ERR_UNSUPPORTED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formulas),
        cmocka_unit_test(test_truth_is_found),
        cmocka_unit_test(test_bounds_hold),
        cmocka_unit_test(test_brute_force),
        cmocka_unit_test(test_result_describes_its_model),
        cmocka_unit_test(test_frames),
        cmocka_unit_test(test_isotropic_data),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_refusals),
    };

    return cmocka_run_group_tests_name("anisotropic", tests, NULL, NULL);
}
