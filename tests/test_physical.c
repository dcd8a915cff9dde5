/*
 * Fits with physical bounds, judged from outside: published coefficients obey them in exact arithmetic, no box's bound and no
 * result's is above the objective of a physical model that brute force finds at random roughnesses in it (physical_oracle.h,
 * on columns of brdffit_eval()), and where the free fit obeys, the result has its bits. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fewer.h"
#include "physical_oracle.h"
#include "support.h"

#define PROBLEMS FEWER(200, 40)
#define POINTS 3
#define BOXES 24
#define CHANNELS 3
#define SAMPLES 40

struct box_seen {
    double low[BRDFFIT_MAX_LOBES], high[BRDFFIT_MAX_LOBES], bound;
};

struct problem {
    struct brdffit_test_data data;
    brdffit_options options;
    brdffit_distribution lobes[BRDFFIT_MAX_LOBES];
    struct brdffit_test_random random;
    struct box_seen box[BOXES]; /* a random choice of those seen */
    size_t seen;
    const brdffit_result *result;
};

static double weight_of(brdffit_distribution d)
{
    return d == BRDFFIT_BECKMANN || d == BRDFFIT_GGX ? 4.0 : 1.0;
}

static void see(void *user, const brdffit_box *box)
{
    struct problem *p = user;
    size_t place = p->seen++ < BOXES ? p->seen - 1 : brdffit_test_below(&p->random, p->seen);
    int i;

    for (i = 0; i < box->lobes && place < BOXES; i++) {
        p->box[place].low[i] = box->sigma_low[i];
        p->box[place].high[i] = box->sigma_high[i];
        p->box[place].bound = box->lower_bound;
    }
}

static void draw_options(struct problem *p)
{
    static const brdffit_distribution any[] = {
        BRDFFIT_BECKMANN,          BRDFFIT_GGX,       BRDFFIT_WARD, BRDFFIT_BLINN_PHONG,
        BRDFFIT_ASHIKHMIN_SHIRLEY, BRDFFIT_LAFORTUNE, BRDFFIT_RETRO};
    brdffit_options *o = &p->options;
    int i;

    brdffit_options_init(o);
    o->lobes = 1 + (int)brdffit_test_below(&p->random, 2 + (brdffit_test_below(&p->random, 6) == 0));
    o->fresnel = (brdffit_fresnel)(brdffit_test_below(&p->random, 3) == 0);
    o->diffuse = brdffit_test_below(&p->random, 4) || o->fresnel ? BRDFFIT_DIFFUSE_LAMBERT : BRDFFIT_DIFFUSE_OREN_NAYAR;
    o->masking = (brdffit_masking)(brdffit_test_below(&p->random, 3)
                                       ? 0
                                       : brdffit_test_below(&p->random, BRDFFIT_MASKING_COUNT));
    o->normalise = (brdffit_normalise)(brdffit_test_below(&p->random, 4) == 0);
    for (i = 0; i < o->lobes; i++) {
        p->lobes[i] = any[brdffit_test_below(&p->random, o->masking ? 2 : 7)];
        p->lobes[i] = i > 0 && brdffit_test_below(&p->random, 2) ? p->lobes[0] : p->lobes[i];
    }
    o->distributions = p->lobes;
    o->relative_gap = 1e-2;
    o->box_budget = 3000;
    o->max_incidence = 90.0;
    o->box = see;
    o->box_user = p;
}

/* Data of one or two lobes, and a scale that makes some of them reflect too much, all or none. */
static void draw(struct problem *p, uint64_t seed)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    double scale;
    size_t i;

    memset(p, 0, sizeof *p);
    p->random.state = seed;
    draw_options(p);
    spec.seed = seed;
    spec.count = SAMPLES;
    spec.channels = CHANNELS;
    spec.layout = (enum brdffit_test_layout)brdffit_test_below(&p->random, 3);
    spec.form = BRDFFIT_FORM_DIRECTIONS;
    spec.quantity = BRDFFIT_QUANTITY_RADIANCE;
    spec.sigma[0] = brdffit_test_log_uniform(&p->random, 0.01, 1.0);
    spec.sigma[1] = brdffit_test_log_uniform(&p->random, 0.05, 1.0);
    spec.diffuse = brdffit_test_uniform(&p->random, 0.0, 1.0);
    spec.specular[0] = brdffit_test_uniform(&p->random, 0.0, 0.2);
    spec.specular[1] = brdffit_test_uniform(&p->random, 0.0, 0.2);
    spec.noise = brdffit_test_log_uniform(&p->random, 1e-4, 0.1);
    spec.weighted = brdffit_test_below(&p->random, 3) == 0;
    brdffit_test_data_new(&spec, &p->data);
    scale = brdffit_test_log_uniform(&p->random, 0.3, 30.0);
    scale = brdffit_test_below(&p->random, 20) || p->options.normalise == BRDFFIT_NORMALISE_NONE ? scale
            : brdffit_test_below(&p->random, 2)                                                  ? 1e-250
                                                                                                 : 1e60;
    for (i = 0; i < SAMPLES * CHANNELS; i++) {
        p->data.values[i] *= scale;
    }
}

static int lobe_columns(const struct problem *p)
{
    return p->options.fresnel ? 2 : 1;
}

static int fixed_columns(const struct problem *p)
{
    return p->options.diffuse == BRDFFIT_DIFFUSE_OREN_NAYAR ? 2 : 1;
}

static int columns_of(const struct problem *p)
{
    return fixed_columns(p) + p->options.lobes * lobe_columns(p);
}

/* Column j of the model with these roughnesses: what brdffit_eval() makes of a 1 there. */
static void column(const struct problem *p, const double *sigma, int j, double *out)
{
    double x = 0.0, more = 0.0, y[BRDFFIT_MAX_LOBES] = {0.0}, f0[BRDFFIT_MAX_LOBES] = {0.0};
    int F = fixed_columns(p), Q = lobe_columns(p);
    brdffit_model m;

    if (j == 0) {
        x = 1.0;
    } else if (j < F) {
        more = 1.0;
    } else {
        y[(j - F) / Q] = 1.0;
        f0[(j - F) / Q] = (j - F) % Q ? 0.0 : 1.0;
    }
    brdffit_model_init(&m);
    m.lobes = p->options.lobes;
    m.distribution = p->result->model->distributions[0];
    m.distributions = p->result->model->distributions;
    m.channels = 1;
    m.sigma = sigma;
    m.x = &x;
    m.y = y;
    m.fresnel = p->options.fresnel;
    m.diffuse = p->options.diffuse;
    m.masking = p->options.masking;
    m.f0 = p->options.fresnel ? f0 : NULL;
    m.x_more = F > 1 ? &more : NULL;
    assert_int_equal(brdffit_eval(&m, &p->data.samples, out, NULL), BRDFFIT_OK);
}

static long double root_weight(const struct problem *p, size_t i)
{
    return p->data.samples.weights ? sqrtl((long double)p->data.samples.weights[i]) : 1.0L;
}

/* Columns at unit norm in o->column; what their coefficients count for, but for the channel's scale, in `counts`. */
static void open_columns(const struct problem *p, const double *sigma, struct physical_oracle *o, long double *counts)
{
    int F = fixed_columns(p), Q = lobe_columns(p), j;
    double values[SAMPLES];
    size_t i;

    o->rows = SAMPLES;
    o->columns = columns_of(p);
    for (j = 0; j < o->columns; j++) {
        long double norm;

        column(p, sigma, j, values);
        for (i = 0; i < SAMPLES; i++) {
            o->column[j][i] = root_weight(p, i) * values[i];
        }
        norm = sqrtl(po_dot(o->column[j], o->column[j], SAMPLES));
        for (i = 0; i < SAMPLES && norm > 0.0L; i++) {
            o->column[j][i] /= norm;
        }
        counts[j] = norm > 0.0L ? (j < F ? 1.0L : weight_of(p->result->model->distributions[(j - F) / Q])) / norm
                                : 1e40L;
    }
}

/* E^2 of the best physical model with these roughnesses that is found, in the result's units. */
static long double physical_e2(const struct problem *p, const double *sigma)
{
    static struct physical_oracle o;
    long double counts[PO_COLUMNS], z[PO_COLUMNS], sum = 0.0L;
    size_t i, k;
    int j;

    open_columns(p, sigma, &o, counts);
    for (k = 0; k < CHANNELS; k++) {
        double divisor = p->result->channel_scale[k];
        long double size = 0.0L;

        for (i = 0; i < SAMPLES; i++) {
            o.data[i] = root_weight(p, i) * p->data.values[i * CHANNELS + k];
            size = fmaxl(size, fabsl(o.data[i]));
        }
        for (i = 0; i < SAMPLES && size > 0.0L; i++) {
            o.data[i] /= size;
        }
        for (j = 0; j < o.columns; j++) {
            o.a[j] = fminl(1e40L, counts[j] * size);
        }
        sum += physical_best(&o, z) * (size / divisor) * (size / divisor);
    }
    return sum;
}

/* Exactly: sums of these doubles fit a long double, or are rounded by 1e-19. */
static long double reflected(const struct problem *p, size_t k)
{
    const brdffit_model *m = p->result->model;
    long double sum = m->x[k];
    int i;

    for (i = 0; i < m->lobes; i++) {
        sum += weight_of(m->distributions[i]) * (long double)m->y[k * (size_t)m->lobes + (size_t)i];
    }
    return sum + (m->x_more ? (long double)m->x_more[k] : 0.0L);
}

static void run(struct problem *p)
{
    brdffit_error error;

    if (brdffit_fit_new(&p->data.samples, &p->options, &p->result, &error) != BRDFFIT_OK) {
        fail_msg("%s", error.message);
    }
}

/* Shapes, coefficients and numbers of two results. */
static void same_bits(const brdffit_result *one, const brdffit_result *two)
{
    size_t K = one->model->channels, P = (size_t)one->model->lobes;

    assert_memory_equal(one->model->sigma, two->model->sigma, P * sizeof(double));
    assert_memory_equal(one->model->x, two->model->x, K * sizeof(double));
    assert_memory_equal(one->model->y, two->model->y, K * P * sizeof(double));
    assert_memory_equal(&one->e2, &two->e2, sizeof(double));
    assert_memory_equal(&one->lower_bound, &two->lower_bound, sizeof(double));
    assert_int_equal(one->boxes, two->boxes);
    assert_int_equal(one->stop, two->stop);
}

/* Rounding of the columns and of E^2, in units of the data's sum of squares. */
#define TOLERANCE 1e-13L

static void attack(struct problem *p, const double *low, const double *high, double bound, uint64_t seed)
{
    int i, n;

    for (n = 0; n < POINTS; n++) {
        double sigma[BRDFFIT_MAX_LOBES];
        long double e2;

        for (i = 0; i < p->options.lobes; i++) {
            sigma[i] = n == 0 ? low[i] : n == 1 ? high[i] : brdffit_test_log_uniform(&p->random, low[i], high[i]);
        }
        e2 = physical_e2(p, sigma);
        if (!(e2 >= bound - TOLERANCE * p->result->sum_of_squares)) {
            brdffit_test_print(&p->data.samples, &p->options);
            fail_msg("seed %u: bound %.17g above E^2 %.17Lg at %.17g %.17g %.17g", (unsigned)seed, bound, e2, sigma[0],
                     sigma[1], sigma[2]);
        }
    }
}

static void attack_all(struct problem *p, uint64_t seed)
{
    double low[BRDFFIT_MAX_LOBES], high[BRDFFIT_MAX_LOBES];
    const brdffit_model *m = p->result->model;
    size_t i;
    int n, round;

    for (i = 0; i < p->seen && i < BOXES; i++) {
        attack(p, p->box[i].low, p->box[i].high, p->box[i].bound, seed);
    }
    for (round = 0; round < 6; round++) { /* all over, and close to the optimum */
        for (n = 0; n < m->lobes; n++) {
            double near = round < 2 ? 3.0 : 1.0 + pow(10.0, -(double)round);

            low[n] = fmax(m->sigma[n] / near, fmax(1e-4, p->result->lobe[n]->sigma_floor));
            high[n] = fmax(low[n], fmin(m->sigma[n] * near, 3.0));
        }
        attack(p, low, high, p->result->lower_bound, seed);
    }
}

struct tally {
    unsigned binding, free, certified, fresnel, rough, smith, lobes[BRDFFIT_MAX_LOBES + 1];
};

static void judge(struct problem *p, uint64_t seed, struct tally *tally)
{
    const brdffit_result *r, *free_result;
    int channels = 0, obeys = 1;
    size_t k;

    run(p);
    r = p->result;
    for (k = 0; k < CHANNELS; k++) {
        assert_true(reflected(p, k) <= 1.0L);
        assert_true(!r->at_limit[k] || reflected(p, k) >= 1.0L - 1e-9L);
        channels += r->at_limit[k];
    }
    assert_int_equal(channels, r->channels_at_limit);
    assert_true(r->lower_bound <= r->e2 && r->stop != BRDFFIT_STOP_CONTRADICTION);
    attack_all(p, seed);
    p->options.physical = 0;
    p->options.box = NULL;
    run(p);
    free_result = p->result;
    for (k = 0; k < CHANNELS; k++) {
        obeys = obeys && reflected(p, k) <= 1.0L - 1e-14L;
    }
    assert_true(r->e2_free == free_result->e2 && r->e2 >= free_result->lower_bound);
    if (obeys) {
        same_bits(r, free_result);
    }
    tally->binding += channels > 0;
    tally->free += !channels;
    tally->certified += (unsigned)r->certified;
    tally->fresnel += channels && p->options.fresnel;
    tally->rough += channels && p->options.diffuse != BRDFFIT_DIFFUSE_LAMBERT;
    tally->smith += channels && p->options.masking != BRDFFIT_MASKING_V_CAVITY;
    tally->lobes[p->options.lobes] += channels > 0;
    brdffit_result_free(free_result);
    brdffit_result_free(r);
}

static void test_random(void **state)
{
    static struct problem p;
    struct tally t = {.binding = 0};
    uint64_t seed;

    (void)state;
    for (seed = 1; seed <= PROBLEMS; seed++) {
        draw(&p, seed);
        p.options.physical = 1;
        judge(&p, seed, &t);
        brdffit_test_data_free(&p.data);
    }
    print_message(
        "%u bind, %u do not, %u certified; binding with Fresnel %u, rough diffuse %u, masking %u; lobes %u %u %u\n",
        t.binding, t.free, t.certified, t.fresnel, t.rough, t.smith, t.lobes[1], t.lobes[2], t.lobes[3]);
    assert_true(t.binding > PROBLEMS / 4 && t.free > PROBLEMS / 10 && t.certified > PROBLEMS / 2);
    assert_true(t.fresnel && t.rough && t.smith && t.lobes[1] && t.lobes[2] && t.lobes[3]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
