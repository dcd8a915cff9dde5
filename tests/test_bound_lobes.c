/*
 * Bounds of engine moment for any list of one to three lobes, attacked: random problems, boxes and more than a million
 * points, none of which may have an objective below its box's bound. And the first incumbent: the best of all nodes of
 * the first partition. SPDX-License-Identifier: MIT
 */
#include "lobes_case.h"

#if defined(__SANITIZE_ADDRESS__)
#define POINTS 60000L
#else
#define POINTS 1300000L
#endif
#define POINTS_PER_BOX 64
#define BOXES_PER_PROBLEM 24

struct tally {
    long points[LC_LOBES][2]; /* by lobes, and whether they are of one kind */
    long boxes, positive, tight, kind[BRDFFIT_DISTRIBUTION_COUNT], shared, problems;
};

/* The engine states its rounding a node at a time. */
static double largest_epsilon(const struct fit *f)
{
    double largest = 0.0;
    uint32_t i;
    int kind;

    for (kind = 0; kind < f->model.kinds; kind++) {
        for (i = 0; i < f->axis[kind].nodes; i++) {
            const struct marks *ready = &f->moment.moments.kind[kind].ready;

            if (i < ready->known && ready->on[i]) {
                largest = fmax(largest, f->moment.moments.kind[kind].node[i].epsilon);
            }
        }
    }
    return largest;
}

/* What is met is a true objective: an error of epsilon |I| in n entries of t, and of epsilon in n (n - 1) of M. */
static void check_met(const struct lobes_case *m, double objective, const struct point *met, const struct lc_box *b)
{
    double n = 1.0 + m->lobes, total = m->fit.data.total, epsilon = largest_epsilon(&m->fit);
    long double exact = lc_objective(m, met->theta);

    if (!(fabsl((long double)objective - exact) <=
          4.0L * m->fit.moment.moments.slack + (2.0L * n + n * (n - 1.0L)) * 2.0L * epsilon * total)) {
        lc_print(m, b);
        fail_msg("met %.17g, exactly %.17Lg, total %g", objective, exact, total);
    }
}

static void attack(struct lobes_case *m, struct lc_box *b, uint64_t *s, struct tally *tally)
{
    struct fit *f = &m->fit;
    struct point met = {{0.0}};
    long double least = INFINITY;
    double objective;
    int i, p;

    b->box.bound = INFINITY; /* unreachable: every bound is tried */
    brdffit_bound_moment_start(&f->moment, &f->data, &f->model, f->varpro.kernels, f->axis);
    objective = brdffit_bound_moment(&f->moment, &b->box, &met);
    assert_true(b->box.bound >= 0.0 && b->box.bound <= f->data.total);
    assert_true(b->box.split < (uint32_t)m->lobes);
    if (objective < INFINITY) {
        check_met(m, objective, &met, b);
    }
    for (i = 0; i < POINTS_PER_BOX; i++) {
        double theta[LC_LOBES] = {0.0};
        long double value;

        lc_draw_point(m, b, i, theta, s);
        value = lc_objective(m, theta);
        least = value < least ? value : least;
        if (!(value >= (long double)b->box.bound)) {
            lc_print(m, b);
            fail_msg("bound %.17g above objective %.17Lg at %a, %a, %a (total %g)", b->box.bound, value, theta[0],
                     theta[1], theta[2], f->data.total);
        }
    }
    for (p = 1; p < m->lobes; p++) {
        tally->shared += b->box.interval[p] == b->box.interval[p - 1];
    }
    tally->points[m->lobes - 1][lc_mixed(m)] += POINTS_PER_BOX;
    tally->boxes++;
    tally->positive += b->box.bound > 0.0;
    tally->tight += b->box.bound > 0.0 && (long double)b->box.bound >= 0.9L * least;
}

static long all_points(const struct tally *t)
{
    long sum = 0;
    int p;

    for (p = 0; p < LC_LOBES; p++) {
        sum += t->points[p][0] + t->points[p][1];
    }
    return sum;
}

static void test_no_point_below_its_bound(void **state)
{
    static struct lobes_case m;
    struct tally tally = {{{0}}, 0, 0, 0, {0}, 0, 0};
    uint64_t seed;
    int i, p;

    (void)state;
    for (seed = 1; all_points(&tally) < POINTS; seed++) {
        uint64_t s = seed;

        if (lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT)) {
            struct point optimum = lc_optimum(&m, &s);

            if (seed % 2) {
                brdffit_reduce_channels(&m.fit.data);
            }
            for (i = 0; i < BOXES_PER_PROBLEM; i++) {
                struct lc_box b;

                lc_draw_box(&m, &optimum, &b, &s);
                attack(&m, &b, &s, &tally);
            }
            for (p = 0; p < m.lobes; p++) {
                tally.kind[m.asked[p]]++;
            }
            tally.problems++;
        }
        lc_close(&m);
    }
    print_message(
        "%ld points in %ld boxes of %ld problems; like lobes %ld, %ld, %ld, mixed %ld, %ld; %ld bounds positive, "
        "%ld within 10 %% of the least objective met; %ld shared sides\n",
        all_points(&tally), tally.boxes, tally.problems, tally.points[0][0], tally.points[1][0], tally.points[2][0],
        tally.points[1][1], tally.points[2][1], tally.positive, tally.tight, tally.shared);
    /* Enough of everything, and an engine that never says anything would pass. */
    for (i = 0; i < BRDFFIT_DISTRIBUTION_COUNT; i++) {
        assert_true(tally.kind[i] > tally.problems / 20);
    }
    assert_true(tally.points[2][0] > POINTS / 10 && tally.points[2][1] > POINTS / 10);
    assert_true(tally.points[1][0] > POINTS / 20 && tally.points[1][1] > POINTS / 10 &&
                tally.points[0][0] > POINTS / 20);
    assert_true(tally.positive > tally.boxes / 3 && tally.tight > tally.boxes / 5);
}

/* ---- The first incumbent ------------------------------------------------------------------------------------ */

#define FIRST 4u

/* The least objective of all nodes, like lobes in any order. */
static long double best_node(const struct lobes_case *m)
{
    uint32_t index[LC_LOBES] = {0};
    long double best = INFINITY;
    int p = 0;

    while (p < m->lobes) {
        double theta[LC_LOBES];
        long double value;

        for (p = 0; p < m->lobes; p++) {
            theta[p] = m->fit.axis[m->fit.model.lobe[p].kind].coordinate[index[p]];
        }
        value = lc_objective(m, theta);
        best = value < best ? value : best;
        for (p = 0; p < m->lobes && ++index[p] > m->fit.axis[m->fit.model.lobe[p].kind].first; p++) {
            index[p] = 0;
        }
    }
    return best;
}

static void test_first_incumbent(void **state)
{
    static struct lobes_case m;
    uint64_t seed;
    long done = 0;
    int kind, p;

    (void)state;
    for (seed = 1; done < 400; seed++) {
        if (lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT)) {
            struct lc_box none = {.range = {{0.0}}};
            struct point met = {{0.0}};
            long double best;
            double n = 1.0 + m.lobes, said;

            for (kind = 0; kind < m.fit.model.kinds; kind++) {
                brdffit_axis_start(&m.fit.axis[kind], m.fit.domain[kind].low, m.fit.domain[kind].high, FIRST);
            }
            brdffit_bound_moment_start(&m.fit.moment, &m.fit.data, &m.fit.model, m.fit.varpro.kernels, m.fit.axis);
            said = brdffit_bound_moment_first(&m.fit.moment, &met);
            check_met(&m, said, &met, &none);
            best = best_node(&m);
            assert_true((long double)said <=
                        best + 4.0L * m.fit.moment.moments.slack +
                            (2.0L * n + n * (n - 1.0L)) * 2.0L * largest_epsilon(&m.fit) * m.fit.data.total);
            for (p = 1; p < m.lobes; p++) {
                assert_true(p == m.fit.model.lobe[p].first || met.theta[p - 1] <= met.theta[p]);
            }
            done++;
        }
        lc_close(&m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_point_below_its_bound),
        cmocka_unit_test(test_first_incumbent),
    };

    return cmocka_run_group_tests_name("bound_lobes", tests, NULL, NULL);
}
