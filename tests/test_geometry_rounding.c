/*
 * The stated errors of geometry (src/model/rounding.h) and their charge (src/data/charge.c), judged in 113 bits: random and
 * adversarial directions, taken at their word and moved by what directions are known to; whole fits of data whose
 * half angles nearly agree, whose r.v is about 0, whose viewers and lights graze. No lower bound is above an E^2 that either
 * reading has. LDFLAGS: -lquadmath
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/tolerance.h"
#include "io/csv/angle.h"
#include "model/geometry.h"
#include "model/rounding.h"
#include "rounding_oracle.h"
#include "support.h"

#define DIRECTIONS 200000
#define MOST 160

/* ---- Directions ------------------------------------------------------------------------------------------------ */

struct scene {
    double light[3], view[3], normal[3];
    int general;
};

static double power(struct brdffit_test_random *random, double low, double high)
{
    return pow(10.0, brdffit_test_uniform(random, low, high));
}

static void spherical(double theta, double phi, double *out)
{
    out[0] = sin(theta) * cos(phi);
    out[1] = sin(theta) * sin(phi);
    out[2] = cos(theta);
}

static void nudge(struct brdffit_test_random *random, double by, double *v)
{
    int j;

    for (j = 0; j < 3; j++) {
        v[j] += by * brdffit_test_uniform(random, -1.0, 1.0);
    }
}

/* Around +z: what the kind asks for. */
static void make_upright(struct brdffit_test_random *random, int kind, struct scene *s)
{
    double theta = brdffit_test_uniform(random, 0.0, 1.57), phi = brdffit_test_uniform(random, 0.0, 6.3), graze;

    spherical(theta, phi, s->light);
    spherical(brdffit_test_uniform(random, 0.0, 1.57), brdffit_test_uniform(random, 0.0, 6.3), s->view);
    switch (kind) {
    case 1: /* near the mirror direction */
        s->view[0] = -s->light[0];
        s->view[1] = -s->light[1];
        s->view[2] = s->light[2];
        nudge(random, power(random, -17.0, -1.0), s->view);
        break;
    case 2: /* near the light */
        memcpy(s->view, s->light, sizeof s->view);
        nudge(random, power(random, -17.0, -1.0), s->view);
        break;
    case 3: /* 90 degrees off the mirror direction, in plane or not */
        spherical(1.5707963267948966 - theta, phi + (brdffit_test_below(random, 2) ? 0.0 : power(random, -9.0, 0.0)),
                  s->view);
        nudge(random, power(random, -18.0, -3.0), s->view);
        break;
    case 4: /* the viewer, the light, or both graze; opposite to each other, perhaps */
        graze = power(random, -20.0, -1.0);
        s->view[2] = graze;
        if (brdffit_test_below(random, 2)) {
            s->light[2] = brdffit_test_below(random, 2) ? graze : power(random, -20.0, -1.0);
        }
        if (brdffit_test_below(random, 3) == 0) {
            s->view[0] = -s->light[0];
            s->view[1] = -s->light[1];
            nudge(random, power(random, -17.0, -1.0), s->view);
        }
        break;
    case 5: /* mirror images as a table of angles has them */
        brdffit_io_direction(brdffit_test_uniform(random, 0.0, 89.0), 0.0, s->light);
        s->view[0] = -s->light[0];
        s->view[1] = s->light[1];
        s->view[2] = s->light[2];
        break;
    default: break;
    }
}

/* Turned to a random normal: everything rounds, so that what was exact is no more. */
static void turn(struct brdffit_test_random *random, struct scene *s)
{
    double theta = brdffit_test_uniform(random, 0.0, 3.14), phi = brdffit_test_uniform(random, 0.0, 6.3), frame[3][3];
    double *part[2] = {s->light, s->view}, old[3];
    int i, j;

    spherical(theta + 1.5707963267948966, phi, frame[0]);
    spherical(1.5707963267948966, phi + 1.5707963267948966, frame[1]);
    spherical(theta, phi, frame[2]);
    for (i = 0; i < 2; i++) {
        memcpy(old, part[i], sizeof old);
        for (j = 0; j < 3; j++) {
            part[i][j] = old[0] * frame[0][j] + old[1] * frame[1][j] + old[2] * frame[2][j];
        }
    }
    memcpy(s->normal, frame[2], sizeof s->normal);
    s->general = 1;
}

static void lengthen(struct brdffit_test_random *random, double *v)
{
    static const double factor[] = {1.0, 1.0, 3.0, 1e-290, 1e290, 1.6e308, 1e-307, 0x1p-1000};
    double by = factor[brdffit_test_below(random, sizeof factor / sizeof factor[0])];
    int j;

    for (j = 0; j < 3; j++) {
        v[j] *= by;
    }
}

static void make_scene(struct brdffit_test_random *random, struct scene *s)
{
    make_upright(random, (int)brdffit_test_below(random, 6), s);
    s->normal[0] = s->normal[1] = 0.0;
    s->normal[2] = 1.0;
    s->general = 0;
    if (brdffit_test_below(random, 2)) {
        turn(random, s);
    }
    lengthen(random, s->light);
    lengthen(random, s->view);
    if (s->general) {
        lengthen(random, s->normal);
    }
}

static void samples_of(const struct scene *s, brdffit_samples *samples)
{
    brdffit_samples_init(samples);
    samples->count = samples->channels = 1;
    samples->quantity = BRDFFIT_QUANTITY_RADIANCE;
    samples->light = s->light;
    samples->view = s->view;
    samples->normal = s->general ? s->normal : NULL;
}

/* Unit vector of doubles, moved by `by` radians in a random direction. */
static void moved(struct brdffit_test_random *random, const double *from, quad by, quad *to)
{
    quad length = 0, along = 0, size = 0, off[3];
    int j;

    for (j = 0; j < 3; j++) {
        to[j] = from[j];
        off[j] = brdffit_test_uniform(random, -1.0, 1.0);
    }
    length = sqrtq(oracle_dot(to, to));
    for (j = 0; j < 3; j++) {
        to[j] /= length;
        along += to[j] * off[j];
    }
    for (j = 0; j < 3; j++) {
        off[j] -= along * to[j];
        size += off[j] * off[j];
    }
    for (j = 0; j < 3; j++) {
        to[j] += by * off[j] / sqrtq(size);
    }
}

static struct oracle_angles truth_of(struct brdffit_test_random *random, const struct scene *s, quad by)
{
    quad l[3], v[3], n[3] = {0, 0, 1};

    moved(random, s->light, by, l);
    moved(random, s->view, by, v);
    if (s->general) {
        moved(random, s->normal, by, n);
    }
    return oracle_angles(l, v, n);
}

/* ---- Stated errors ---------------------------------------------------------------------------------------------- */

/* Doubles are converted to quad: their products with errors do not round. */
static int within(quad truth, double value, quad error)
{
    return fabsq(truth - value) <= error;
}

static void check_row(const struct scene *s, brdffit_distribution d, const struct oracle_angles *truth,
                      const struct geometry *got, const char *reading)
{
    struct oracle_row row = oracle_row(d, truth);
    int fine = within(row.a, got->a, (quad)got->light_error * got->a) &&
               within(truth->light, got->cos_light, (quad)got->light_error * got->cos_light);

    if (got->b > 0.0) {
        fine = fine && within(row.b, got->b, (quad)got->b_error * got->b) && within(row.c, got->c, got->c_error);
    } else {
        fine = fine && d == BRDFFIT_LAFORTUNE &&
               (row.b == 0 || (row.b <= got->b_hidden && row.c >= got->c_hidden));
    }
    if (!fine) {
        fail_msg("%s, %s: a %.17g b %.17g c %.17g, errors %g %g %g, truth off by %g %g (relative) %g; hidden %g %g; light "
                 "%a,%a,%a view %a,%a,%a normal %a,%a,%a",
                 brdffit_distribution_string(d), reading, got->a, got->b, got->c, got->light_error, got->b_error,
                 got->c_error, (double)(row.a / got->a - 1), (double)(row.b / got->b - 1), (double)(row.c - got->c),
                 got->b_hidden, got->c_hidden, s->light[0], s->light[1], s->light[2], s->view[0], s->view[1],
                 s->view[2], s->normal[0], s->normal[1], s->normal[2]);
    }
}

/* Whether the other reading is allowed for: not near the horizon, nor for exact mirror images (rounding.h), whose tan^2 is
 * the rounding of both sides, 1e-28 squared. */
static int may_move(const struct oracle_angles *at)
{
    return at->light > 2 * GRAZE && at->view > 2 * GRAZE && at->tan2 > 1e-55;
}

static void test_stated_errors(void **state)
{
    struct brdffit_test_random random = {7};
    size_t i, counted = 0, hidden = 0, moves = 0;
    struct scene s;

    (void)state;
    for (i = 0; i < DIRECTIONS; i++) {
        struct oracle_angles at[2];
        struct geometry got;
        brdffit_samples samples;
        brdffit_status status;
        int d, move;

        make_scene(&random, &s);
        samples_of(&s, &samples);
        at[0] = truth_of(&random, &s, 0);
        move = may_move(&at[0]);
        if (move) {
            at[1] = truth_of(&random, &s, TOL_ANGLE);
        }
        for (d = 0; d < BRDFFIT_DISTRIBUTION_COUNT; d++) {
            brdffit_skip skip =
                brdffit_geometry_sample(&samples, (brdffit_distribution)d, 0.0, 0, &got, &status, NULL);

            assert_int_equal(status, BRDFFIT_OK);
            assert_true((skip == BRDFFIT_SKIP_COUNT) == (at[0].light > LIMIT_GRAZING && at[0].view > LIMIT_GRAZING));
            if (skip == BRDFFIT_SKIP_COUNT) {
                check_row(&s, (brdffit_distribution)d, &at[0], &got, "as doubles");
                if (move) {
                    check_row(&s, (brdffit_distribution)d, &at[1], &got, "moved");
                }
                counted++;
                moves += (size_t)move;
                hidden += got.b_hidden > 0.0;
            }
        }
    }
    assert_true(counted > 5 * DIRECTIONS && moves > 4 * DIRECTIONS && hidden > DIRECTIONS / 200);
}

/* c is worth something where it counts: relative to 1e-14 at alpha >= 1e-12, whatever the lengths and the normal. */
static void test_small_angles_keep_their_digits(void **state)
{
    struct brdffit_test_random random = {8};
    struct scene s;
    int i, general, seen = 0;

    (void)state;
    for (i = 0; i < 20000; i++) {
        struct oracle_angles at;
        struct geometry got;
        brdffit_samples samples;
        brdffit_status status;

        make_upright(&random, 1, &s);
        general = i % 2;
        s.general = 0;
        if (general) {
            turn(&random, &s);
        }
        samples_of(&s, &samples);
        s.normal[0] = general ? s.normal[0] : 0.0;
        at = truth_of(&random, &s, 0);
        if (brdffit_geometry_sample(&samples, BRDFFIT_BECKMANN, 0.0, 0, &got, &status, NULL) == BRDFFIT_SKIP_COUNT &&
            at.tan2 < 1e-9 && at.tan2 > 1e-24) {
            assert_true(within(at.tan2, got.c, (quad)1e-14 * at.tan2));
            seen++;
        }
    }
    assert_true(seen > 5000);
}

/* eval is the model, within what the errors of its geometry make of it and a few units of its own. */
static void test_eval(void **state)
{
    struct brdffit_test_random random = {9};
    struct scene s;
    size_t i;

    (void)state;
    for (i = 0; i < 30000; i++) {
        brdffit_distribution d = (brdffit_distribution)brdffit_test_below(&random, BRDFFIT_DISTRIBUTION_COUNT);
        double x = brdffit_test_uniform(&random, 0.0, 1.0), y = brdffit_test_uniform(&random, 0.0, 1.0), out;
        double sigma = d < BRDFFIT_BLINN_PHONG || i % 2 ? power(&random, -3.0, 0.5) : power(&random, -1.0, 1.0);
        brdffit_model model = {.distribution = d, .lobes = 1, .channels = 1, .sigma = {sigma}, .x = &x, .y = &y};
        brdffit_status status;
        brdffit_samples samples;
        struct geometry g;
        struct oracle_angles at;
        struct oracle_row row;
        quad lobe, most, change, exponent, concentration = 1 / ((quad)sigma * sigma);

        make_scene(&random, &s);
        samples_of(&s, &samples);
        assert_int_equal(brdffit_eval(&model, &samples, &out, NULL), BRDFFIT_OK);
        if (brdffit_geometry_sample(&samples, d, 0.0, 0, &g, &status, NULL) != BRDFFIT_SKIP_COUNT) {
            assert_true(out == 0.0);
            continue;
        }
        at = truth_of(&random, &s, 0);
        row = oracle_row(d, &at);
        lobe = y * row.b * oracle_lambda(d, concentration) * oracle_shape(d, concentration, row.c, 0);
        if (g.b > 0.0) {
            exponent = fminq(row.c, 1e4) * concentration; /* error of c s, and its own rounding */
            change = g.c_error * concentration + 8 * TOL_UNIT * (2 + (d == BRDFFIT_GGX ? 0 : exponent));
            most = lobe * (2 * g.b_error + expm1q(fminq(2 * change, 10000)));
        } else {
            most = y * (quad)g.b_hidden * oracle_lambda(d, concentration) *
                   oracle_shape(d, concentration, g.c_hidden, 0);
        }
        most += x * row.a * g.light_error + 8 * TOL_UNIT * (x * row.a + lobe) + 1e-290;
        if (!within(x * row.a + lobe, out, most)) {
            fail_msg("%s sigma %.17g: %.17g, not %.17g, allowed %g", brdffit_distribution_string(d), sigma, out,
                     (double)(x * row.a + lobe), (double)most);
        }
    }
}

/* ---- Whole fits ------------------------------------------------------------------------------------------------- */

/* Directions of a reading, and the data: radiance or f_r of one channel. */
struct reading {
    size_t count;
    quad light[MOST][3], view[MOST][3], normal[MOST][3], value[MOST];
    int brdf;
    quad scale; /* channel_scale of the result */
};

struct problem {
    double light[MOST][3], view[MOST][3], normal[MOST][3], value[MOST];
    brdffit_samples samples;
    brdffit_options options;
};

static void problem_start(struct problem *p)
{
    brdffit_samples_init(&p->samples);
    brdffit_options_init(&p->options);
    p->samples.channels = 1;
    p->samples.quantity = BRDFFIT_QUANTITY_RADIANCE;
    p->samples.light = &p->light[0][0];
    p->samples.view = &p->view[0][0];
    p->samples.values = p->value;
    p->options.max_incidence = 90.0;
    p->options.box_budget = 20000;
}

/* `by`: radians that every direction is moved. */
static void read_doubles(struct brdffit_test_random *random, const struct problem *p, quad by, struct reading *r)
{
    size_t i;

    r->count = p->samples.count;
    r->brdf = p->samples.quantity == BRDFFIT_QUANTITY_BRDF;
    for (i = 0; i < r->count; i++) {
        moved(random, p->light[i], by, r->light[i]);
        moved(random, p->view[i], by, r->view[i]);
        r->normal[i][0] = r->normal[i][1] = 0;
        r->normal[i][2] = 1;
        if (p->samples.normal) {
            moved(random, p->normal[i], by, r->normal[i]);
        }
        r->value[i] = p->value[i];
    }
}

/* Samples that count, and the lobe's column at some s. */
struct columns {
    quad a[MOST], b[MOST], c[MOST], g[MOST], data[MOST], least;
    size_t count;
};

static void open_columns(const struct reading *r, brdffit_distribution d, struct columns *out)
{
    size_t i;

    out->count = 0;
    out->least = -1;
    for (i = 0; i < r->count; i++) {
        struct oracle_angles at = oracle_angles(r->light[i], r->view[i], r->normal[i]);
        struct oracle_row row;

        if (!(at.light > 0 && at.view > 0)) {
            continue;
        }
        row = oracle_row(d, &at);
        out->a[out->count] = row.a;
        out->b[out->count] = row.b;
        out->c[out->count] = row.c;
        out->data[out->count] = r->value[i] * (r->brdf ? at.light : 1) / r->scale;
        out->least = row.b > 0 && (out->least < 0 || row.c < out->least) ? row.c : out->least;
        out->count++;
    }
}

/* `least`: the c where the shape is 1. */
static void columns_at(struct columns *m, brdffit_distribution d, quad s, quad least)
{
    size_t i;

    for (i = 0; i < m->count; i++) {
        m->g[i] = m->b[i] > 0 ? m->b[i] * oracle_shape(d, s, m->c[i], least) : 0;
    }
}

/* The norm's objective at coefficients. */
static quad objective(const struct columns *m, brdffit_norm norm, quad x, quad y)
{
    quad sum = 0;
    size_t i;

    for (i = 0; i < m->count; i++) {
        quad r = fabsq(m->data[i] - x * m->a[i] - y * m->g[i]);

        sum = norm == BRDFFIT_NORM_L2 ? sum + r * r : norm == BRDFFIT_NORM_L1 ? sum + r : fmaxq(sum, r);
    }
    return sum;
}

/* The least over x, y >= 0 in l2. */
static quad least_squares(const struct columns *m)
{
    quad aa = 0, ag = 0, gg = 0, ai = 0, gi = 0, det, best, x, y;
    size_t i;

    for (i = 0; i < m->count; i++) {
        aa += m->a[i] * m->a[i];
        ag += m->a[i] * m->g[i];
        gg += m->g[i] * m->g[i];
        ai += m->a[i] * m->data[i];
        gi += m->g[i] * m->data[i];
    }
    best = fminq(objective(m, BRDFFIT_NORM_L2, fmaxq(0, ai / aa), 0),
                 gg > 0 ? objective(m, BRDFFIT_NORM_L2, 0, fmaxq(0, gi / gg)) : (quad)INFINITY);
    det = aa * gg - ag * ag;
    if (det > (quad)1e-25 * aa * gg) {
        x = (gg * ai - ag * gi) / det;
        y = (aa * gi - ag * ai) / det;
        best = x >= 0 && y >= 0 ? fminq(best, objective(m, BRDFFIT_NORM_L2, x, y)) : best;
    }
    return best;
}

/* s of the fit's lobe as the reported sigma says it. */
static quad reported_s(const brdffit_result *r)
{
    return 1 / ((quad)r->model.sigma[0] * r->model.sigma[0]);
}

/* Objective at the reported parameters. */
static quad at_model(const struct reading *r, const struct problem *p, const brdffit_result *result)
{
    quad s = reported_s(result);
    struct columns m;

    open_columns(r, p->options.distribution, &m);
    columns_at(&m, p->options.distribution, s, 0);
    return objective(&m, p->options.norm, result->model.x[0] / r->scale,
                     result->model.y[0] * oracle_lambda(p->options.distribution, s) / r->scale);
}

/* The least objective met at many s of the domain, and near the reported one: all of them bound the truth from above. */
static quad least_met(const struct reading *r, const struct problem *p, const brdffit_result *result)
{
    int exponent = p->options.distribution >= BRDFFIT_BLINN_PHONG, i;
    quad low = exponent ? (quad)p->options.exponent_min : 1 / ((quad)p->options.sigma_max * p->options.sigma_max);
    quad high = exponent ? (quad)p->options.exponent_max : 1 / ((quad)p->options.sigma_min * p->options.sigma_min);
    quad best = (quad)INFINITY, at = reported_s(result), s, width = (quad)0.1;
    struct columns m;

    high = fminq(high, result->sigma_floor > 0.0 ? 1 / ((quad)result->sigma_floor * result->sigma_floor) : high);
    at = fminq(fmaxq(at, low), high);
    if (p->options.norm != BRDFFIT_NORM_L2) {
        return at_model(r, p, result);
    }
    open_columns(r, p->options.distribution, &m);
    for (i = 0; i <= 60; i++) {
        s = low * powq(high / low, (quad)i / 60);
        columns_at(&m, p->options.distribution, s, m.least);
        best = fminq(best, least_squares(&m));
    }
    for (i = 0; i < 40; i++, width *= i % 2 ? 1 : (quad)0.5) { /* around the reported one, closer and closer */
        s = fminq(fmaxq(at * (1 + (i % 2 ? width : -width)), low), high);
        columns_at(&m, p->options.distribution, s, m.least);
        best = fminq(best, least_squares(&m));
    }
    columns_at(&m, p->options.distribution, at, m.least);
    return fminq(best, least_squares(&m));
}

static void check_bound(const struct problem *p, const brdffit_result *result, const struct reading *r, const char *what)
{
    quad least = least_met(r, p, result);

    if ((quad)result->lower_bound > least * (1 + (quad)1e-25)) {
        fail_msg("%s, %s: lower bound %.17g of e2 %.17g is above %.17g, by %g of it (sigma %.17g)",
                 brdffit_distribution_string(p->options.distribution), what, result->lower_bound, result->e2,
                 (double)least, (double)(result->lower_bound / least - 1), result->model.sigma[0]);
    }
}

/* Fit and compare: as doubles, and moved `moves` times by what directions are known to. e2 is that of the doubles. */
static void check_fit(struct brdffit_test_random *random, const struct problem *p, int moves, int exact, int *certified)
{
    static struct reading r;
    brdffit_result *result;
    brdffit_error error;
    brdffit_status status = brdffit_fit_new(&p->samples, &p->options, &result, &error);
    quad e2;
    int i;

    if (status == BRDFFIT_ERR_UNSUPPORTED) {
        return; /* without ECOS */
    }
    if (status != BRDFFIT_OK) {
        fail_msg("%s (sample %zu)", error.message, error.sample);
    }
    *certified += result->certified;
    r.scale = result->channel_scale[0];
    read_doubles(random, p, 0, &r);
    check_bound(p, result, &r, "as doubles");
    e2 = at_model(&r, p, result);
    if (exact && !(fabsq(e2 - result->e2) <= (quad)1e-9 * e2 + (quad)1e-13 * (quad)result->sum_of_squares)) {
        fail_msg("%s: e2 %.17g, of its model %.17g", brdffit_distribution_string(p->options.distribution), result->e2,
                 (double)e2);
    }
    for (i = 0; i < moves; i++) {
        read_doubles(random, p, TOL_ANGLE, &r);
        check_bound(p, result, &r, "moved");
    }
    brdffit_fit_free(result);
}

/* ---- Lafortune at 90 degrees ------------------------------------------------------------------------------------ */

static void quad_direction(double theta, double phi, quad *out)
{
    quad t = theta * oracle_pi() / 180, f = phi * oracle_pi() / 180;

    out[0] = sinq(t) * cosq(f);
    out[1] = sinq(t) * sinq(f);
    out[2] = cosq(t);
}

/* In plane, every 10 degrees: 90 degrees off the mirror direction where theta_i + theta_o = 90 on the light's side. */
static void lafortune_case(struct problem *p, struct reading *degrees, double at_right_angles)
{
    int ti, to;
    size_t n = 0;

    problem_start(p);
    p->options.distribution = BRDFFIT_LAFORTUNE;
    p->options.max_incidence = 60.0;
    p->samples.quantity = BRDFFIT_QUANTITY_BRDF;
    for (ti = 10; ti <= 60; ti += 10) {
        for (to = -80; to <= 80; to += 10) {
            brdffit_io_direction(ti, 0.0, p->light[n]);
            brdffit_io_direction(abs(to), to < 0 ? 180.0 : 0.0, p->view[n]);
            quad_direction(ti, 0.0, degrees->light[n]);
            quad_direction(abs(to), to < 0 ? 180.0 : 0.0, degrees->view[n]);
            degrees->normal[n][0] = degrees->normal[n][1] = 0;
            degrees->normal[n][2] = 1;
            p->value[n] = ti + to == 90 ? at_right_angles : ti + to > 90 ? 0.0 : 1.0;
            degrees->value[n] = p->value[n];
            n++;
        }
    }
    p->samples.count = degrees->count = n;
    degrees->brdf = 1;
}

static void check_lafortune(struct brdffit_test_random *random, struct problem *p, struct reading *degrees)
{
    brdffit_result *result;
    brdffit_error error;
    struct reading zero;
    size_t i;
    int certified = 0;

    if (brdffit_fit_new(&p->samples, &p->options, &result, &error) != BRDFFIT_OK) {
        assert_int_equal(error.status, BRDFFIT_ERR_UNSUPPORTED);
        return;
    }
    degrees->scale = result->channel_scale[0];
    check_bound(p, result, degrees, "as degrees");
    zero = *degrees; /* exactly 90 degrees is none of ours: 1e-15 more, or less */
    for (i = 0; i < zero.count; i++) {
        zero.view[i][0] -= (quad)1e-15 * zero.view[i][2];
    }
    check_bound(p, result, &zero, "as degrees, towards the mirror direction");
    for (i = 0; i < zero.count; i++) {
        zero.view[i][0] += (quad)2e-15 * zero.view[i][2];
    }
    check_bound(p, result, &zero, "as degrees, away from it");
    brdffit_fit_free(result);
    check_fit(random, p, 2, 0, &certified);
}

static void test_lafortune(void **state)
{
    static const double value[3] = {0.0, 1.0, 0.02}, least[3] = {0.1, 1e-3, 1e-6};
    static struct problem p;
    static struct reading degrees;
    struct brdffit_test_random random = {10};
    int i, j, k;

    (void)state;
    for (i = 0; i < 3; i++) {
        for (j = 0; j < 3; j++) {
            for (k = 0; k < 4; k++) {
                lafortune_case(&p, &degrees, value[i]);
                p.options.exponent_min = least[j];
                p.options.relative_gap = k ? 1e-3 : 1e-6;
                p.options.engine = k == 1 ? BRDFFIT_ENGINE_SOCP : BRDFFIT_ENGINE_MOMENT;
                p.options.norm = k == 2 ? BRDFFIT_NORM_L1 : k == 3 ? BRDFFIT_NORM_LINF : BRDFFIT_NORM_L2;
                p.options.box_budget = k ? 300 : 20000;
                check_lafortune(&random, &p, &degrees);
            }
        }
    }
}

/* ---- Half angles that nearly agree ------------------------------------------------------------------------------ */

/* Half angles of 5e-16 to 1e-8 rad from a table of angles: two that merged at a loss, and e2 said so. */
static void test_snapped(void **state)
{
    static const double angle[10][4] = {
        {44.491334676726751, 180, 44.491335676726749, 0},
        {51.0643664322007, 180, 51.0643664322007, 0},
        {13.547535678625897, 180, 13.547535678626897, 0},
        {17.447000763684233, 41.690045262265471, 17.447001763684234, 221.69004526226547},
        {39.248685264139823, 180, 39.24868626413982, 0},
        {21.411624188275795, 90, 21.411624189275795, 270},
        {28.868319230262156, 0, 28.868319230262155, 180},
        {29.055471136983357, 90, 29.055472136983358, 270},
        {23.160435208379774, 260.80629022718068, 23.160435208379873, 80.806290227180682},
        {21.17431660195119, 180, 21.17431660195119, 0},
    };
    static const double value[10] = {6.4, 1.9, 16.5, 1.5e-3, 2e-4, 0.72, 0.65, 0.044, 8.8, 8.9};
    static struct problem p;
    struct brdffit_test_random random = {11};
    size_t i;
    int d, certified = 0;

    (void)state;
    for (d = 0; d < BRDFFIT_DISTRIBUTION_COUNT; d++) {
        problem_start(&p);
        p.samples.quantity = BRDFFIT_QUANTITY_BRDF;
        p.samples.count = 10;
        p.options.distribution = (brdffit_distribution)d;
        p.options.exponent_max = 1e24;
        for (i = 0; i < 10; i++) {
            brdffit_io_direction(angle[i][0], angle[i][1], p.light[i]);
            brdffit_io_direction(angle[i][2], angle[i][3], p.view[i]);
            p.value[i] = value[i];
        }
        check_fit(&random, &p, 4, 1, &certified);
    }
    assert_true(certified >= 4);
}

/* Samples near the mirror direction at all scales, values of a lobe that tells them apart, and noise. */
static void near_mirror_case(struct brdffit_test_random *random, struct problem *p, double finest)
{
    double width = power(random, finest, -3.0), noise = power(random, -4.0, -0.5);
    size_t i, n = 5 + brdffit_test_below(random, 8);

    problem_start(p);
    p->samples.count = n;
    p->options.exponent_max = 1e24;
    for (i = 0; i < n; i++) {
        double theta = brdffit_test_uniform(random, 0.05, 1.0), phi = brdffit_test_uniform(random, 0.0, 6.3);
        double tilt = width * brdffit_test_uniform(random, 0.0, 3.0), x;

        spherical(theta, phi, p->light[i]);
        spherical(theta, phi, p->view[i]);
        p->view[i][0] = -p->view[i][0];
        p->view[i][1] = -p->view[i][1];
        if (i % 4) { /* by the half angle tilt / 2 in plane */
            double cosine = cos(theta), sine = sin(theta);

            p->view[i][0] -= tilt * cosine * cos(phi);
            p->view[i][1] -= tilt * cosine * sin(phi);
            p->view[i][2] -= tilt * sine;
        } else {
            tilt = 0.0;
        }
        x = 0.5 * tilt / width;
        p->value[i] = 0.1 * cos(theta) + exp(-2.0 * x * x) * (1.0 + noise * brdffit_test_uniform(random, -1.0, 1.0));
    }
}

static void test_near_mirror(void **state)
{
    struct brdffit_test_random random = {12};
    static struct problem p;
    int i, certified = 0;

    (void)state;
    for (i = 0; i < 400; i++) {
        near_mirror_case(&random, &p, i % 2 ? -12.0 : -9.0);
        p.options.distribution = (brdffit_distribution)(i % BRDFFIT_DISTRIBUTION_COUNT);
        p.options.relative_gap = i % 3 ? 1e-3 : 1e-8;
        p.options.engine = i % 8 == 7 ? BRDFFIT_ENGINE_SOCP : BRDFFIT_ENGINE_MOMENT;
        p.options.norm = i % 16 == 3 ? BRDFFIT_NORM_L1 : i % 16 == 11 ? BRDFFIT_NORM_LINF : BRDFFIT_NORM_L2;
        p.options.box_budget = i % 8 == 7 || p.options.norm != BRDFFIT_NORM_L2 ? 200 : 2000;
        check_fit(&random, &p, 3, 1, &certified);
    }
    assert_true(certified > 150);
}

/* ---- Grazing ---------------------------------------------------------------------------------------------------- */

/* One viewer (kind 0) or light (kind 1) that grazes, with a given normal, and data that it matters to. */
static void grazing_case(struct brdffit_test_random *random, struct problem *p, int kind)
{
    double graze = power(random, -9.0, -3.0);
    size_t i, n = 8;

    problem_start(p);
    p->samples.count = n;
    p->samples.normal = &p->normal[0][0];
    p->samples.quantity = kind ? BRDFFIT_QUANTITY_BRDF : BRDFFIT_QUANTITY_RADIANCE;
    for (i = 0; i < n; i++) {
        struct scene s;

        make_upright(random, 0, &s);
        if (i < 2) {
            (kind ? s.light : s.view)[2] = graze * (1.0 + (double)i);
        }
        turn(random, &s);
        memcpy(p->light[i], s.light, sizeof s.light);
        memcpy(p->view[i], s.view, sizeof s.view);
        memcpy(p->normal[i], s.normal, sizeof s.normal);
        p->value[i] = brdffit_test_uniform(random, 0.2, 1.0) / (i < 2 && kind ? graze : 1.0);
    }
}

static void test_grazing(void **state)
{
    struct brdffit_test_random random = {13};
    static struct problem p;
    int i, certified = 0;

    (void)state;
    for (i = 0; i < 300; i++) {
        grazing_case(&random, &p, i % 2);
        p.options.distribution = i % 4 == 0 ? BRDFFIT_WARD : (brdffit_distribution)(i % BRDFFIT_DISTRIBUTION_COUNT);
        p.options.relative_gap = 1e-11;
        p.options.absolute_gap = 1e-14;
        check_fit(&random, &p, 6, 1, &certified);
    }
    assert_true(certified > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stated_errors), cmocka_unit_test(test_small_angles_keep_their_digits),
        cmocka_unit_test(test_eval),          cmocka_unit_test(test_lafortune),
        cmocka_unit_test(test_snapped),       cmocka_unit_test(test_near_mirror),
        cmocka_unit_test(test_grazing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
