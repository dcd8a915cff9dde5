/*
 * Bounds of engine socp and of norms l1 and linf for any list of one to three lobes, attacked as test_bound_lobes.c
 * attacks those of engine moment, on a smaller scale. SPDX-License-Identifier: MIT
 */
#include "lobes_case.h"

#ifndef BRDFFIT_NO_ECOS

#if defined(__SANITIZE_ADDRESS__)
#define POINTS 3000L
#else
#define POINTS 60000L /* of each norm */
#endif
#define POINTS_PER_BOX 30
#define BOXES_PER_PROBLEM 12

struct tally {
    long points[LC_LOBES], boxes, positive, tight, mixed;
};

static double bound_of(struct fit *f, struct box *box, struct point *met)
{
    return f->norm == BRDFFIT_NORM_L2 ? brdffit_bound_socp(&f->socp, box, met) : brdffit_bound_lp(&f->linear, box, met);
}

/* The objective of l1 or linf at the library's coefficients: columns in long double. */
static long double norm_of(const struct lobes_case *m, const double *theta)
{
    const struct fit *f = &m->fit;
    long double column[LC_COLUMNS][LC_SAMPLES], total = 0.0L;
    size_t i, k;
    int p;

    for (p = 0; p < m->lobes; p++) {
        lc_column(m, p, theta[p], column[1 + p]);
    }
    memcpy(column[0], m->row_a, sizeof column[0]);
    for (k = 0; k < m->channels; k++) {
        long double sum = 0.0L;

        for (i = 0; i < m->count; i++) {
            long double r = m->row_value[k][i];

            for (p = 0; p <= m->lobes; p++) {
                r -= column[p][i] * f->varpro.answer[k].z[p];
            }
            sum = f->norm == BRDFFIT_NORM_L1 ? sum + fabsl(r) : fmaxl(sum, fabsl(r));
        }
        total = f->norm == BRDFFIT_NORM_L1 ? total + sum : fmaxl(total, sum);
    }
    return total;
}

/* Whether the coefficients of every channel are numbers that columns may be multiplied by. */
static int finite_answers(const struct lobes_case *m)
{
    size_t k;
    int p, fine = 1;

    for (k = 0; k < m->channels; k++) {
        for (p = 0; p <= m->lobes; p++) {
            fine = fine && isfinite(m->fit.varpro.answer[k].z[p]);
        }
    }
    return fine;
}

/* At a point: exact in l2; in the others at coefficients that the library claims, whose objective must be what it says. */
static long double objective_at(struct lobes_case *m, const double *theta)
{
    struct point at = {{0.0}};
    struct varpro_value value;
    long double here;

    if (m->fit.norm == BRDFFIT_NORM_L2) {
        return lc_objective(m, theta);
    }
    memcpy(at.theta, theta, (size_t)m->lobes * sizeof *theta);
    brdffit_fit_evaluate(&m->fit, &at, 0, &value);
    if (!finite_answers(m)) {
        return (long double)value.objective;
    }
    here = norm_of(m, theta);
    assert_true(fabsl(here - (long double)value.objective) <= 1e-12L * m->fit.data.total);
    return here;
}

static void attack(struct lobes_case *m, struct lc_box *b, double target, uint64_t *s, struct tally *tally)
{
    /* An l1 or linf objective is that of double columns, each within a dozen u of those here. */
    long double allowed = m->fit.norm == BRDFFIT_NORM_L2 ? 0.0L : 1e-14L * m->fit.data.total, least = INFINITY;
    struct point met = {{0.0}};
    int i;

    b->box.bound = target;
    (void)bound_of(&m->fit, &b->box, &met);
    assert_true(b->box.bound >= 0.0 && b->box.bound <= m->fit.data.total);
    assert_true(b->box.split < (uint32_t)m->lobes);
    for (i = 0; i < POINTS_PER_BOX; i++) {
        double theta[LC_LOBES] = {0.0};
        long double value;

        lc_draw_point(m, b, i, theta, s);
        value = objective_at(m, theta);
        least = value < least ? value : least;
        if (!(value >= (long double)b->box.bound - allowed)) {
            lc_print(m, b);
            fail_msg("%s: bound %.17g above objective %.17Lg at %a, %a, %a (total %g)",
                     brdffit_norm_string(m->fit.norm), b->box.bound, value, theta[0], theta[1], theta[2],
                     m->fit.data.total);
        }
    }
    tally->points[m->lobes - 1] += POINTS_PER_BOX;
    tally->mixed += lc_mixed(m) ? POINTS_PER_BOX : 0;
    tally->boxes++;
    tally->positive += b->box.bound > 0.0;
    tally->tight += b->box.bound > 0.0 && (long double)b->box.bound >= 0.9L * least;
}

static void attack_norm(brdffit_norm norm)
{
    static struct lobes_case m;
    struct tally t = {{0}, 0, 0, 0, 0};
    uint64_t seed;
    int i, kind;

    for (seed = 1; t.points[0] + t.points[1] + t.points[2] < POINTS; seed++) {
        uint64_t s = seed;

        if (lc_open(&m, seed, norm, BRDFFIT_ENGINE_SOCP)) {
            struct engine engine;
            struct point optimum = lc_optimum(&m, &s);

            for (kind = 0; kind < m.fit.model.kinds; kind++) {
                brdffit_axis_start(&m.fit.axis[kind], m.fit.domain[kind].low, m.fit.domain[kind].high, 1);
            }
            m.options.socp_every_box = (int)(seed % 2);
            assert_int_equal(brdffit_fit_engine_start(&m.fit, &m.options, &engine), BRDFFIT_OK);
            for (i = 0; i < BOXES_PER_PROBLEM; i++) {
                struct lc_box b;

                lc_draw_box(&m, &optimum, &b, &s);
                attack(&m, &b, i % 2 ? INFINITY : m.fit.data.total * case_uniform(&s), &s, &t);
            }
            brdffit_fit_engine_finish(&m.fit, &m.options);
        }
        lc_close(&m);
    }
    print_message(
        "%s: %ld, %ld, %ld points for 1, 2, 3 lobes (%ld of mixed ones) in %ld boxes; %ld bounds positive, %ld "
        "within 10 %% of the least objective met\n",
        brdffit_norm_string(norm), t.points[0], t.points[1], t.points[2], t.mixed, t.boxes, t.positive, t.tight);
    assert_true(t.points[1] > POINTS / 5 && t.points[2] > POINTS / 5 && t.mixed > POINTS / 5);
    assert_true(t.positive > t.boxes / 4 && t.tight > t.boxes / 8);
}

static void test_socp(void **state)
{
    (void)state;
    attack_norm(BRDFFIT_NORM_L2);
}

static void test_l1(void **state)
{
    (void)state;
    attack_norm(BRDFFIT_NORM_L1);
}

static void test_linf(void **state)
{
    (void)state;
    attack_norm(BRDFFIT_NORM_LINF);
}

#else

static void test_socp(void **state)
{
    (void)state;
    skip();
}
#define test_l1 test_socp
#define test_linf test_socp

#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_socp),
        cmocka_unit_test(test_l1),
        cmocka_unit_test(test_linf),
    };

    return cmocka_run_group_tests_name("bound_lobes_conic", tests, NULL, NULL);
}
