/*
 * Guards of engine moment, each watched where it acts: units in which nothing overflows, shifts within LIMIT_SHIFT, no
 * entry of M below 0 where a maximum is taken, cosines above their infimum. SPDX-License-Identifier: MIT
 *
 * Which test catches which fault. Each was tried with the library changed by hand, against a baseline that passes; where
 * test_bound_lobes is not named, its 1.3 million points did not notice.
 *
 *   value_scale always 1 (reduce.c)                              test_units
 *   interval usable() always 1; pairs not looked at (bound.c)    test_kernel_arguments
 *   make_constant() does nothing (bound.c)                       test_kernel_arguments
 *   infimum of unlike kinds that of the far corner itself        test_pairs_of_kinds
 *   w of one kind in a pair's curvature, or in its sums          test_pairs_of_kinds, test_bound_lobes
 *   shift of the second side of a pair ignored (bound.c)         test_bound_lobes
 *   tau shift halved (interval.c)                                test_bound_lobes, test_interval
 *   twins without their root; monotone bound's entries in another order    test_bound_lobes
 *   kappa of a node not lowered by its epsilon (moments.c)       test_moments
 *   cosines not clipped at 0, or above (gains.h, gain.h)         test_gains
 *   GAIN_LEAST 1e-3; rounds without enumeration after (gain_n.h) test_gains, test_bound_lobes
 *   a factor that is not definite trusted (gain_n.h)             test_gains
 *   a place wrong in box_maximum of three (gains.h)              test_gains
 *   NNLS_CLOSED 3 (nnls.h)                                       test_bound_lobes_conic
 *   tails in the order of groups (exponential.c)                 test_domain_lobes
 *   a node of the first incumbent left out (bound.c)             test_bound_lobes
 *   a child of a run, equal intervals of a multiset left out     test_search_lobes
 */
#include "lobes_case.h"

/* ---- Units ------------------------------------------------------------------------------------------------- */

/* Values and weights of any size, negative ones far larger than the largest: inside all are about 1. */
static void test_units(void **state)
{
    static struct lobes_case m;
    uint64_t seed;
    size_t i, k;
    long looked = 0;

    (void)state;
    for (seed = 1; seed <= 1500; seed++) {
        uint64_t s = seed;
        double largest = 0.0, weigh = pow(10.0, 290.0 * case_signed(&s)), scale = pow(10.0, 140.0 * case_signed(&s));
        int far = case_next(&s) % 3 == 0;

        if (!lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT)) {
            lc_close(&m);
            continue;
        }
        for (i = 0; i < m.count; i++) {
            for (k = 0; k < m.channels; k++) {
                m.values[i * m.channels + k] *= scale;
            }
            if (far && i > 0) { /* the largest value hardly counts, or a negative one dwarfs it */
                m.values[i * m.channels] = seed % 2 ? -fabs(m.values[i * m.channels]) * 1e130 : 1e-120 * scale;
            }
            m.weights[i] *= far && i == 0 ? 1e-200 : 1.0;
            m.weights[i] = lc_clamp(m.weights[i] * weigh, 1e-300, 1e300);
        }
        if (brdffit_reduce(&m.fit.data, &m.samples, &m.fit.model, &m.options, NULL) == BRDFFIT_OK &&
            m.fit.data.total > 0.0) {
            lc_rows(&m);
            looked++;
            for (k = 0; k < m.channels; k++) {
                for (i = 0; i < m.count; i++) {
                    largest = fmax(largest, (double)fabsl(m.row_value[k][i]));
                }
            }
            if (!(largest >= 0.25 && largest <= 1.0 + 1e-12 && m.fit.data.total >= 0.06 &&
                  m.fit.data.total <= 1.01 * (double)(m.count * m.channels))) {
                brdffit_test_print(&m.samples, &m.options);
                fail_msg("seed %u: largest value %g, sum of squares %g", (unsigned)seed, largest, m.fit.data.total);
            }
        }
        lc_close(&m);
    }
    assert_true(looked > 1000);
}

/* ---- What the kernels are given ------------------------------------------------------------------------------- */

/* A table that looks at its arguments. */
static struct {
    struct kernels table;
    const struct kernels *real;
    const struct moments *moments;
    int negative; /* whether the last shifted gains had an entry below 0 */
    long shifted, constants, maxima, unshifted;
} spy;

static void look_at(const struct gains *in, int shifted, int sides)
{
    int p, q, e, c;
    size_t k;

    if (!shifted) {
        spy.unshifted++;
        return;
    }
    spy.shifted++;
    spy.constants += spy.negative; /* the call before had one: it is asked again */
    spy.negative = 0;
    for (p = 0; p < sides; p++) {
        for (k = 0; k < in->channels; k++) {
            assert_true(fabs(in->shift[p][k]) <= LIMIT_SHIFT * spy.moments->norm[k]);
        }
    }
    for (e = 0; e < COSINES(1 + sides); e++) {
        assert_true(fabs(in->fall[e][0]) <= LIMIT_SHIFT && fabs(in->fall[e][1]) <= LIMIT_SHIFT);
    }
    for (p = 0; p < sides; p++) {
        for (c = 0; c < 2; c++) {
            spy.negative |= in->cosine[p][c] - fmax(in->fall[p][0], 0.0) < 0.0;
        }
    }
    for (p = 0; p < sides; p++) {
        for (q = p + 1; q < sides; q++) {
            e = COSINE(1 + sides, 1 + p, 1 + q);
            for (c = 0; c < 4; c++) {
                spy.negative |= in->cosine[e][c] - (fmax(in->fall[e][0], 0.0) + fmax(in->fall[e][1], 0.0)) < 0.0;
            }
        }
    }
}

#define SPY(sides)                                                                                                     \
    static void spy_gains_##sides(const struct gains *in, int shifted, double *gain)                                   \
    {                                                                                                                  \
        unsigned i;                                                                                                    \
        look_at(in, shifted, sides);                                                                                   \
        spy.real->gains[0][0][sides - 1](in, shifted, gain);                                                           \
        for (i = 0; i < (shifted ? GAINS(sides) : 1u << sides); i++) {                                                 \
            assert_true(gain[i] >= 0.0 && gain[i] <= 1e16); /* (1 + sides) K LIMIT_SHIFT^2 and room */                 \
        }                                                                                                              \
    }                                                                                                                  \
    static double spy_maximum_##sides(const double *gain, double *lift)                                                \
    {                                                                                                                  \
        spy.maxima++;                                                                                                  \
        assert_false(spy.negative); /* R need not be finite, and the chord is none */                                  \
        return spy.real->box_maximum[sides - 1](gain, lift);                                                           \
    }

SPY(1)
SPY(2)
SPY(3)

static void test_kernel_arguments(void **state)
{
    static struct lobes_case m;
    uint64_t seed;
    int i;

    (void)state;
    memset(&spy, 0, sizeof spy);
    spy.real = brdffit_kernels(BRDFFIT_ISA_AUTO);
    spy.table = *spy.real;
    spy.table.gains[0][0][0] = spy_gains_1;
    spy.table.gains[0][0][1] = spy_gains_2;
    spy.table.gains[0][0][2] = spy_gains_3;
    spy.table.box_maximum[0] = spy_maximum_1;
    spy.table.box_maximum[1] = spy_maximum_2;
    spy.table.box_maximum[2] = spy_maximum_3;
    for (seed = 1; seed <= 800; seed++) {
        uint64_t s = seed;

        if (lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT)) {
            struct point optimum = lc_optimum(&m, &s);

            for (i = 0; i < 24; i++) {
                struct point met = {{0.0}};
                struct lc_box b;

                lc_draw_box(&m, &optimum, &b, &s);
                b.box.bound = INFINITY;
                spy.moments = &m.fit.moment.moments;
                spy.negative = 0;
                brdffit_bound_moment_start(&m.fit.moment, &m.fit.data, &m.fit.model, &spy.table, m.fit.axis);
                (void)brdffit_bound_moment(&m.fit.moment, &b.box, &met);
                assert_true(b.box.bound >= 0.0 && b.box.bound <= m.fit.data.total);
            }
        }
        lc_close(&m);
    }
    print_message("%ld calls with shifts, %ld again with constants, %ld without, %ld maxima\n", spy.shifted,
                  spy.constants, spy.unshifted, spy.maxima);
    assert_true(spy.shifted > 5000 && spy.constants > 500 && spy.unshifted > 100 && spy.maxima > 5000);
}

/* ---- Pairs of kinds --------------------------------------------------------------------------------------------- */

static long double cosine_of(const struct lobes_case *m, const double *theta)
{
    long double one[LC_SAMPLES], two[LC_SAMPLES];

    lc_column(m, 0, theta[0], one);
    lc_column(m, 1, theta[1], two);
    return lc_dot(one, two, m->count) / sqrtl(lc_dot(one, one, m->count) * lc_dot(two, two, m->count));
}

/* u of a lobe at theta, in long double. */
static long double variable_of(const struct lobes_case *m, int p, double theta)
{
    long double s = expl((long double)theta);

    return m->ggx[p] ? s / (1.0L + m->c_min[p] * s) : s;
}

static void check_pair(struct lobes_case *m, const struct lc_box *b, uint64_t *s)
{
    struct bound_moment *engine = &m->fit.moment;
    const struct model *model = &m->fit.model;
    struct sides sides = {&engine->moments, {model->lobe[0].kind, model->lobe[1].kind}, {NULL, NULL}};
    double least, shift[2], theta[LC_LOBES];
    int p, i, c;

    brdffit_bound_moment_start(engine, &m->fit.data, model, m->fit.varpro.kernels, m->fit.axis);
    for (p = 0; p < 2; p++) {
        sides.side[p] = brdffit_bound_moment_side(engine, sides.kind[p], b->box.interval[p], 0);
    }
    least = brdffit_pair_least(&sides);
    shift[0] = brdffit_pair_shift(&sides, 0, least);
    shift[1] = brdffit_pair_shift(&sides, 1, least);
    for (i = 0; i < 40; i++) {
        long double mu, chord = 0.0L, f[2];

        lc_draw_point(m, b, i, theta, s);
        if (sides.kind[0] == sides.kind[1] && theta[0] > theta[1]) {
            continue; /* the first side is the lower one */
        }
        mu = cosine_of(m, theta);
        for (p = 0; p < 2; p++) {
            long double low = variable_of(m, p, b->range[p][0]), high = variable_of(m, p, b->range[p][1]);

            f[p] = high > low ? (variable_of(m, p, theta[p]) - low) / (high - low) : 0.0L;
            chord -= 4.0L * f[p] * (1.0L - f[p]) * shift[p];
        }
        for (c = 0; c < 4; c++) {
            chord += (c & 1 ? f[0] : 1.0L - f[0]) * (c & 2 ? f[1] : 1.0L - f[1]) * brdffit_pair_corner(&sides, c)->mu;
        }
        if (!(mu >= least) || (isfinite(shift[0]) && isfinite(shift[1]) && !(mu >= chord))) {
            lc_print(m, b);
            fail_msg("mu %.20Lg, least %.20g, chord %.20Lg at %a %a", mu, least, chord, theta[0], theta[1]);
        }
    }
}

/* Cosine of two lobes over a box: not below its infimum, nor below its chord less the shifts. */
static void test_pairs_of_kinds(void **state)
{
    static struct lobes_case m;
    long mixed = 0, like = 0;
    uint64_t seed;
    int i;

    (void)state;
    for (seed = 1; seed <= 2500; seed++) {
        uint64_t s = seed;

        if (lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT) && m.lobes > 1 && !m.vanished[0] &&
            !m.vanished[1]) {
            struct point optimum = lc_optimum(&m, &s);
            long double one[LC_SAMPLES], two[LC_SAMPLES];

            lc_column(&m, 0, optimum.theta[0], one);
            lc_column(&m, 1, optimum.theta[1], two);
            for (i = 0; i < 8 && lc_dot(one, one, m.count) > 0.0L && lc_dot(two, two, m.count) > 0.0L; i++) {
                struct lc_box b;

                lc_draw_box(&m, &optimum, &b, &s);
                check_pair(&m, &b, &s);
                mixed += m.fit.model.lobe[1].kind > 0;
                like += m.fit.model.lobe[1].kind == 0;
            }
        }
        lc_close(&m);
    }
    print_message("%ld boxes of unlike lobes, %ld of like ones\n", mixed, like);
    assert_true(mixed > 3000 && like > 2000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_units),
        cmocka_unit_test(test_kernel_arguments),
        cmocka_unit_test(test_pairs_of_kinds),
    };

    return cmocka_run_group_tests_name("guards", tests, NULL, NULL);
}
