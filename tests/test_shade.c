/*
 * brdffit_shade.h: values are those of brdffit_eval(), packets those of single directions, float near double; densities
 * integrate to what their draws say, draws follow them; albedos, a white furnace, reciprocity. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support.h"

#include "brdffit_shade.h"

#define PAIRS 400
#define FLOAT_ERROR 4e-6 /* what brdffit_shade.h states */
#define TURN 6.283185307179586

static const double x3[] = {0.3, 0.2, 0.1}, more6[] = {0.1, 0.05, 0.2, 0.1, 0.05, 0.15};
static const double y9[] = {0.11, 0.07, 0.03, 0.10, 0.06, 0.05, 0.09, 0.05, 0.02};
static const double f9[] = {0.04, 0.5, 1.0, 0.05, 0.9, 0.3, 0.06, 0.2, 0.0};

/* ---- Models and directions --------------------------------------------------- */

static struct brdffit_shade_description one_lobe(int distribution, int masking, const double *sigma)
{
    struct brdffit_shade_description d = {
        1, 3, {distribution, 0, 0}, masking, BRDFFIT_SHADE_LAMBERT, 0, sigma, x3, y9, f9, more6};

    return d;
}

static brdffit_model same_model(const struct brdffit_shade_description *d, brdffit_distribution kinds[3])
{
    brdffit_model m;
    int p;

    brdffit_model_init(&m);
    for (p = 0; p < 3; p++) {
        kinds[p] = (brdffit_distribution)d->distribution[p];
    }
    m.distributions = kinds;
    m.lobes = d->lobes;
    m.channels = (size_t)d->channels;
    m.sigma = d->sigma;
    m.x = d->x;
    m.y = d->y;
    m.f0 = d->schlick ? d->f0 : NULL;
    m.fresnel = d->schlick ? BRDFFIT_FRESNEL_SCHLICK : BRDFFIT_FRESNEL_NONE;
    m.diffuse = (brdffit_diffuse)d->diffuse;
    m.x_more = d->x_more;
    m.masking = (brdffit_masking)d->masking;
    return m;
}

/* Half of them near the mirror direction, at every scale; down to a degree above the surface. */
static void draw_pair(struct brdffit_test_random *random, double l[3], double v[3])
{
    double phi = brdffit_test_uniform(random, 0.0, TURN), spread = brdffit_test_log_uniform(random, 1e-4, 1.0), length;
    int j;

    l[2] = brdffit_test_uniform(random, 0.02, 1.0);
    l[0] = sqrt(1.0 - l[2] * l[2]) * cos(phi);
    l[1] = sqrt(1.0 - l[2] * l[2]) * sin(phi);
    for (j = 0; j < 3; j++) {
        v[j] = (j < 2 ? -l[j] : l[j]) + spread * brdffit_test_uniform(random, -1.0, 1.0);
    }
    v[2] = fabs(v[2]) + 0.02;
    length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (j = 0; j < 3; j++) {
        v[j] /= length;
    }
}

typedef void (*visit_fn)(const struct brdffit_shade_description *d);

/* Every distribution with every masking that it has; Fresnel and diffuse terms beside them; mixed lobes. */
static void for_each_model(visit_fn visit)
{
    static const double sigma[] = {0.15, 0.3, 0.6}, narrow[] = {0.01};
    struct brdffit_shade_description d;
    int k, g;

    for (k = 0; k < BRDFFIT_SHADE_DISTRIBUTIONS; k++) {
        for (g = 0; g < (k <= BRDFFIT_SHADE_GGX ? BRDFFIT_SHADE_MASKINGS : 1); g++) {
            d = one_lobe(k, g, sigma + g % 3);
            d.schlick = g % 2;
            d.diffuse = (k + g) % BRDFFIT_SHADE_DIFFUSES;
            visit(&d);
            d = one_lobe(k, g, narrow);
            visit(&d);
        }
    }
    d = one_lobe(BRDFFIT_SHADE_GGX, BRDFFIT_SHADE_V_CAVITY, sigma);
    d.lobes = 3;
    d.schlick = 1;
    d.diffuse = BRDFFIT_SHADE_BURLEY;
    d.distribution[1] = BRDFFIT_SHADE_WARD;
    d.distribution[2] = BRDFFIT_SHADE_LAFORTUNE;
    visit(&d);
}

/* ---- Values -------------------------------------------------------------------- */

/* Relative, but for what a lobe is below its largest; rounding grows with the exponent of narrow lobes. */
static void values_agree(const struct brdffit_shade_description *d)
{
    struct brdffit_test_random random = {7};
    struct brdffit_shade_d model;
    brdffit_distribution kinds[3];
    brdffit_model m = same_model(d, kinds);
    struct brdffit_shade_description again = brdffit_shade_of_model(&m);
    int i, k;

    assert_true(brdffit_shade_make_d(&model, &again));
    for (i = 0; i < PAIRS; i++) {
        double l[3], v[3], ours[3], theirs[3];
        brdffit_samples at;

        draw_pair(&random, l, v);
        brdffit_samples_init(&at);
        at.count = 1;
        at.channels = 3;
        at.light = l;
        at.view = v;
        at.quantity = BRDFFIT_QUANTITY_RADIANCE;
        assert_int_equal(brdffit_eval(&m, &at, theirs, NULL), BRDFFIT_OK);
        brdffit_shade_eval_d(&model, l, v, ours);
        for (k = 0; k < 3; k++) {
            /* 2e-15 of |n x h| near the mirror direction is 2e-15 / 1e-4 of its square; 745 is the largest exponent. */
            if (!(fabs(ours[k] - theirs[k]) <= 2e-11 * fabs(theirs[k]) + 1e-300)) {
                fail_msg("distribution %d masking %d: %.17g, not %.17g", d->distribution[0], d->masking, ours[k],
                         theirs[k]);
            }
        }
    }
}

static void test_values(void **state)
{
    (void)state;
    for_each_model(values_agree);
}

/* What exp makes of roundings of its argument: the exponent of the sharpest lobe at this pair. */
static double exponent_of(const struct brdffit_shade_description *d, const double l[3], const double v[3])
{
    struct brdffit_shade_direction_d light = {l[0], l[1], l[2]}, view = {v[0], v[1], v[2]};
    struct brdffit_shade_angles_d a = brdffit_shade_angles_of_d(light, view);
    double s = 1.0 / (d->sigma[0] * d->sigma[0]);

    return d->distribution[0] == BRDFFIT_SHADE_RETRO ? s * a.lv : s * a.tan2_half;
}

static void floats_agree(const struct brdffit_shade_description *d)
{
    static struct brdffit_shade_f single;
    static struct brdffit_shade_d twice;
    struct brdffit_test_random random = {8};
    float in[6][PAIRS], out[3][PAIRS], pdf[PAIRS];
    float *const to[3] = {out[0], out[1], out[2]};
    const struct brdffit_shade_pairs_f at = {in[0], in[1], in[2], in[3], in[4], in[5]};
    int i, j, k;

    assert_true(brdffit_shade_make_f(&single, d) && brdffit_shade_make_d(&twice, d));
    for (i = 0; i < PAIRS; i++) {
        double l[3], v[3];

        draw_pair(&random, l, v);
        for (j = 0; j < 3; j++) {
            in[j][i] = (float)(j == 2 && i % 50 == 0 ? -l[j] : l[j]);
            in[3 + j][i] = (float)(j == 2 && i % 50 == 1 ? -v[j] : v[j]);
        }
    }
    brdffit_shade_eval_many_f(&single, PAIRS, &at, to);
    brdffit_shade_pdf_many_f(&single, PAIRS, &at, pdf);
    for (i = 0; i < PAIRS; i++) {
        float l[3] = {in[0][i], in[1][i], in[2][i]}, v[3] = {in[3][i], in[4][i], in[5][i]}, one[3];
        double ld[3] = {l[0], l[1], l[2]}, vd[3] = {v[0], v[1], v[2]}, exact[3], exponent = exponent_of(d, ld, vd);

        brdffit_shade_eval_f(&single, l, v, one);
        brdffit_shade_eval_d(&twice, ld, vd, exact);
        assert_true(fabs((double)(brdffit_shade_pdf_f(&single, l, v) - pdf[i])) <= 1e-6 * (double)pdf[i]);
        for (k = 0; k < 3; k++) {
            double off = fabs((double)out[k][i] - exact[k]), most = FLOAT_ERROR + 2e-7 * fmin(exponent, 87.0);

            assert_true(fabs((double)(one[k] - out[k][i])) <= 1e-6 * fabs((double)one[k]));
            if (!(off <= most * exact[k] + 1e-30)) {
                fail_msg("distribution %d masking %d: %.9g, not %.9g (exponent %g)", d->distribution[0], d->masking,
                         (double)out[k][i], exact[k], exponent);
            }
        }
    }
}

static void test_floats(void **state)
{
    (void)state;
    for_each_model(floats_agree);
}

static void test_functions(void **state)
{
    double worst[4] = {0}, x;

    (void)state;
    for (x = 1e-9; x < 86.0; x *= 1.001) {
        float down = (float)-x, up = (float)x;

        worst[0] = fmax(worst[0], fabs((double)brdffit_shade_expf(down) / exp((double)down) - 1.0));
        worst[1] = fmax(worst[1],
                        fabs((double)brdffit_shade_logf(up) - log((double)up)) / fmax(1e-3, fabs(log((double)up))));
        worst[2] = fmax(worst[2], fabs((double)brdffit_shade_atanf(up) / atan((double)up) - 1.0));
        worst[3] = fmax(worst[3], fabs((double)brdffit_shade_erff(up) - erf((double)up)));
    }
    if (!(worst[0] <= 1.5e-7 && worst[1] <= 1.5e-7 && worst[2] <= 3e-7 && worst[3] <= 7e-7)) {
        fail_msg("exp %g log %g atan %g erf %g", worst[0], worst[1], worst[2], worst[3]);
    }
    assert_true(brdffit_shade_expf(-1e30f) == 0.0f && brdffit_shade_expf(0.0f) == 1.0f);
}

static void reciprocal(const struct brdffit_shade_description *d)
{
    struct brdffit_test_random random = {9};
    static struct brdffit_shade_d model;
    int i, k;

    assert_true(brdffit_shade_make_d(&model, d));
    for (i = 0; i < PAIRS; i++) {
        double l[3], v[3], there[3], back[3];

        draw_pair(&random, l, v);
        brdffit_shade_eval_d(&model, l, v, there);
        brdffit_shade_eval_d(&model, v, l, back);
        for (k = 0; k < 3; k++) {
            assert_true(fabs(there[k] / l[2] - back[k] / v[2]) <= 1e-12 * (there[k] / l[2]) + 1e-300);
        }
    }
}

static void test_reciprocity(void **state)
{
    (void)state;
    for_each_model(reciprocal);
}

/* ---- Densities --------------------------------------------------------------------- */

#define RINGS 12
#define SECTORS 16
#define FINE 24 /* points a side of a bin */
#define DRAWS 20000

/* Integral of the density over the bins of cosine and azimuth, by midpoints. */
static double integrate(const struct brdffit_shade_d *m, const double v[3], double share[RINGS * SECTORS])
{
    double total = 0.0, step = 1.0 / (RINGS * FINE), turn = TURN / (SECTORS * FINE);
    int i, j;

    memset(share, 0, RINGS * SECTORS * sizeof *share);
    for (i = 0; i < RINGS * FINE; i++) {
        for (j = 0; j < SECTORS * FINE; j++) {
            double z = ((double)i + 0.5) * step, phi = ((double)j + 0.5) * turn, r = sqrt(1.0 - z * z);
            double l[3] = {r * cos(phi), r * sin(phi), z}, part = brdffit_shade_pdf_d(m, l, v) * step * turn;

            share[i / FINE * SECTORS + j / FINE] += part;
            total += part;
        }
    }
    return total;
}

/* The 99.99 % point of chi-square (Wilson and Hilferty). */
static double chi2_most(int freedom)
{
    double a = 2.0 / (9.0 * freedom), b = 1.0 - a + 3.719 * sqrt(a);

    return freedom * b * b * b;
}

/* Draws fall into bins as the density says, those below the surface too. */
static void draws_follow(const struct brdffit_shade_description *d, const double v[3])
{
    static struct brdffit_shade_d model;
    struct brdffit_test_random random = {10};
    double share[RINGS * SECTORS], total, chi2 = 0.0, rest = 0.0, rest_seen = 0.0;
    int seen[RINGS * SECTORS] = {0}, below = 0, i, freedom = 0;

    assert_true(brdffit_shade_make_d(&model, d));
    total = integrate(&model, v, share);
    for (i = 0; i < DRAWS; i++) {
        double u[3] = {brdffit_test_uniform(&random, 0.0, 1.0), brdffit_test_uniform(&random, 0.0, 1.0),
                       brdffit_test_uniform(&random, 0.0, 1.0)};
        double l[3], pdf = brdffit_shade_sample_d(&model, v, u, l), phi = atan2(l[1], l[0]);
        int ring = (int)(l[2] * RINGS), sector = (int)((phi < 0.0 ? phi + TURN : phi) / TURN * SECTORS);

        if (!(pdf > 0.0)) {
            assert_true(l[2] <= 1e-9);
            below++;
            continue;
        }
        assert_true(fabs(l[0] * l[0] + l[1] * l[1] + l[2] * l[2] - 1.0) <= 1e-12);
        seen[(ring < RINGS ? ring : RINGS - 1) * SECTORS + (sector < SECTORS ? sector : SECTORS - 1)]++;
    }
    /* A density integrates to 1 less what falls below: four standard errors of that, and the midpoints' error. */
    if (!(fabs(total + (double)below / DRAWS - 1.0) <= 4.0 * sqrt((double)(below + 1)) / DRAWS + 2e-3)) {
        fail_msg("distribution %d: density integrates to %g, %d of %d below", d->distribution[0], total, below, DRAWS);
    }
    for (i = 0; i < RINGS * SECTORS; i++) {
        double expected = share[i] * DRAWS;

        if (expected < 10.0) {
            rest += expected;
            rest_seen += seen[i];
            continue;
        }
        chi2 += (seen[i] - expected) * (seen[i] - expected) / expected;
        freedom++;
    }
    chi2 += rest > 10.0 ? (rest_seen - rest) * (rest_seen - rest) / rest : 0.0;
    if (!(chi2 <= chi2_most(freedom))) {
        fail_msg("distribution %d: chi-square %g of %d", d->distribution[0], chi2, freedom);
    }
}

static void test_draws(void **state)
{
    static const double sigma[] = {0.25, 0.5, 0.7}, views[2][3] = {{0.28, 0.0, 0.96}, {0.0, -0.96, 0.28}};
    struct brdffit_shade_description d;
    int k, i;

    (void)state;
    for (k = 0; k < BRDFFIT_SHADE_DISTRIBUTIONS; k++) {
        for (i = 0; i < 2; i++) {
            d = one_lobe(k, BRDFFIT_SHADE_V_CAVITY, sigma + i);
            d.diffuse = BRDFFIT_SHADE_NO_DIFFUSE;
            draws_follow(&d, views[i]);
        }
    }
    d = one_lobe(BRDFFIT_SHADE_GGX, BRDFFIT_SHADE_SMITH, sigma);
    d.lobes = 3;
    d.schlick = 1;
    d.distribution[1] = BRDFFIT_SHADE_BECKMANN;
    d.distribution[2] = BRDFFIT_SHADE_RETRO;
    draws_follow(&d, views[1]);
}

/* ---- Albedos -------------------------------------------------------------------------- */

/* Against midpoints over the hemisphere, in cos^2, where Lambert's term is flat. */
static void integrate_value(const struct brdffit_shade_d *m, const double v[3], double sum[3])
{
    enum { SIDE = 600 };
    int i, j, k;

    sum[0] = sum[1] = sum[2] = 0.0;
    for (i = 0; i < SIDE; i++) {
        for (j = 0; j < SIDE; j++) {
            double z = sqrt((i + 0.5) / SIDE), phi = TURN * (j + 0.5) / SIDE, r = sqrt(1.0 - z * z), out[3];
            double l[3] = {r * cos(phi), r * sin(phi), z};

            brdffit_shade_eval_d(m, l, v, out);
            for (k = 0; k < 3; k++) {
                sum[k] += out[k] * (TURN / 2.0) / (z * SIDE * SIDE);
            }
        }
    }
}

static void test_albedo(void **state)
{
    static const double sigma[] = {0.2, 0.5, 0.7}, views[3][3] = {{0.0, 0.0, 1.0}, {0.6, 0.0, 0.8}, {0.0, -0.96, 0.28}};
    static struct brdffit_shade_d model;
    int k, i, c;

    (void)state;
    for (k = 0; k < BRDFFIT_SHADE_DISTRIBUTIONS; k++) {
        struct brdffit_shade_description d = one_lobe(k, BRDFFIT_SHADE_V_CAVITY, sigma + k % 3);

        d.schlick = 1;
        d.diffuse = k % BRDFFIT_SHADE_DIFFUSES;
        assert_true(brdffit_shade_make_d(&model, &d));
        for (i = 0; i < 3; i++) {
            double table[3], fine[3];

            brdffit_shade_albedo_d(&model, views[i], table);
            integrate_value(&model, views[i], fine);
            for (c = 0; c < 3; c++) {
                if (!(fabs(table[c] - fine[c]) <= 0.005)) {
                    fail_msg("distribution %d view %d: albedo %g, not %g", k, i, table[c], fine[c]);
                }
            }
        }
    }
}

/* F = 1: what is not reflected is lost in masking, and more the rougher; a Lambertian surface loses nothing. */
static void test_furnace(void **state)
{
    static const double none[3] = {0, 0, 0}, all[3] = {1, 1, 1}, quarter[3] = {0.25, 0.25, 0.25},
                        v[3] = {0.6, 0.0, 0.8};
    static const double sigmas[] = {0.05, 0.3, 0.6, 1.0};
    static struct brdffit_shade_d model;
    double last = 1.005, out[3];
    int i;

    (void)state;
    for (i = 0; i < 4; i++) {
        struct brdffit_shade_description d = one_lobe(BRDFFIT_SHADE_GGX, BRDFFIT_SHADE_SMITH, sigmas + i);

        d.x = none;
        d.y = quarter;
        assert_true(brdffit_shade_make_d(&model, &d));
        brdffit_shade_albedo_d(&model, v, out);
        assert_true(out[0] < last && out[0] > 0.3);
        last = out[0];
        d.x = all;
        d.y = none;
        assert_true(brdffit_shade_make_d(&model, &d));
        brdffit_shade_albedo_d(&model, v, out);
        assert_true(fabs(out[0] - 1.0) <= 1e-12);
    }
}

/* ---- What is refused ---------------------------------------------------------------------- */

static void test_refused(void **state)
{
    static const double sigma[] = {0.3, 0.3, 0.3}, bad[] = {NAN};
    static const double stretched[] = {0.5};
    static struct brdffit_shade_f model;
    struct brdffit_shade_description d = one_lobe(0, 0, sigma);
    brdffit_distribution kinds[3];
    brdffit_model m;

    (void)state;
    assert_int_equal(brdffit_shade_make_f(&model, &d), 1);
    d.channels = BRDFFIT_SHADE_CHANNELS + 1;
    assert_int_equal(brdffit_shade_make_f(&model, &d), 0);
    d = one_lobe(BRDFFIT_SHADE_DISTRIBUTIONS, 0, sigma);
    assert_int_equal(brdffit_shade_make_f(&model, &d), 0);
    d = one_lobe(0, 0, bad);
    assert_int_equal(brdffit_shade_make_f(&model, &d), 0);
    d = one_lobe(0, 0, sigma);
    d.schlick = 1;
    d.f0 = NULL;
    assert_int_equal(brdffit_shade_make_f(&model, &d), 0);
    d = one_lobe(0, 0, sigma);
    m = same_model(&d, kinds);
    m.anisotropy = stretched;
    d = brdffit_shade_of_model(&m);
    assert_int_equal(brdffit_shade_make_f(&model, &d), 0);
    assert_int_equal(BRDFFIT_SHADE_DISTRIBUTIONS, BRDFFIT_DISTRIBUTION_COUNT);
    assert_int_equal(BRDFFIT_SHADE_RETRO, BRDFFIT_RETRO);
    assert_int_equal(BRDFFIT_SHADE_MASKINGS, BRDFFIT_MASKING_COUNT);
    assert_int_equal(BRDFFIT_SHADE_DIFFUSES, BRDFFIT_DIFFUSE_COUNT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values),      cmocka_unit_test(test_floats),  cmocka_unit_test(test_functions),
        cmocka_unit_test(test_reciprocity), cmocka_unit_test(test_draws),   cmocka_unit_test(test_albedo),
        cmocka_unit_test(test_furnace),     cmocka_unit_test(test_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
