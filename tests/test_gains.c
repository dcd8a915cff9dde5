/*
 * The kernels of engine moment, one, two and three sides: gains at every corner and subset of shifts against long double,
 * R of two to seven columns by trying every support, the maximum over a box against samples of it; and the same bits
 * with every instruction set. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "fewer.h"
#include "gain_reference.h"
#include "kernels/kernels.h"
#include "nnls_case.h"
#include "solve/nnls.h"

#define CHANNELS 4

/* The tables that this build and processor have. */
static size_t all_kernels(const struct kernels **table)
{
    size_t count = 0;
    int isa;

    for (isa = 0; isa < BRDFFIT_ISA_COUNT; isa++) {
        const struct kernels *k = brdffit_kernels((brdffit_isa)isa);

        if (k) {
            table[count++] = k;
        }
    }
    return count;
}

/* ---- R ------------------------------------------------------------------------------------------------------- */

struct matrix {
    int n;
    double cosine[GR_COLUMNS * (GR_COLUMNS - 1) / 2], t[GR_COLUMNS];
};

static double draw_cosine(uint64_t *s)
{
    switch (case_next(s) % 7) {
    case 0: return 0.0;
    case 1: return 1.0 - pow(10.0, -16.0 * case_uniform(s));
    case 2: return LIMIT_COSINE;
    case 3: return 1.0;
    case 4: return pow(10.0, -16.0 * case_uniform(s));
    default: return case_uniform(s);
    }
}

/* Of unit vectors >= 0, some of them close together or in the span of others: semidefinite, definite by a hair. */
static void cosines_of_vectors(struct matrix *m, uint64_t *s)
{
    double v[GR_COLUMNS][GR_COLUMNS];
    int i, j, k, rank = 1 + (int)(case_next(s) % (unsigned)m->n), e = 0;

    for (i = 0; i < m->n; i++) {
        double norm = 0.0, size = pow(10.0, -15.0 * case_uniform(s));
        int near = i > 0 && case_next(s) % 3 == 0, between = i > 1 && case_next(s) % 4 == 0;

        for (j = 0; j < m->n; j++) {
            v[i][j] = j < rank ? case_uniform(s) : 0.0;
            v[i][j] = between ? v[i - 1][j] + 0.7 * v[i - 2][j] : near ? v[i - 1][j] + size * v[i][j] : v[i][j];
            norm += v[i][j] * v[i][j];
        }
        for (j = 0; j < m->n; j++) {
            v[i][j] /= sqrt(norm);
        }
    }
    for (i = 0; i < m->n; i++) {
        for (j = i + 1; j < m->n; j++) {
            double sum = 0.0;

            for (k = 0; k < m->n; k++) {
                sum += v[i][k] * v[j][k];
            }
            m->cosine[e++] = fmin(1.0, sum);
        }
    }
}

/* M times a z, so that the answer is on the edge of a support, or any t. */
static void draw_t(struct matrix *m, uint64_t *s)
{
    static const double size[] = {1.0, 1.0, 1.0, 1e-140, 1e-20, 1e6, 1e140};
    double factor = size[case_next(s) % 7];
    int i, j, ties = case_next(s) % 3 == 0, equal = case_next(s) % 8 == 0;

    for (i = 0; i < m->n; i++) {
        m->t[i] = ties ? 0.0 : case_next(s) % 6 ? case_uniform(s) : case_signed(s);
        m->t[i] = equal ? 0.5 : m->t[i];
    }
    for (j = 0; j < m->n && ties && !equal; j++) {
        double z = case_next(s) % 2 ? case_uniform(s) : 0.0;

        for (i = 0; i < m->n; i++) {
            m->t[i] += z * (i == j ? 1.0 : m->cosine[i < j ? gr_entry(m->n, i, j) : gr_entry(m->n, j, i)]);
        }
    }
    for (i = 0; i < m->n; i++) {
        m->t[i] *= factor;
    }
}

static void draw_matrix(struct matrix *m, int n, uint64_t *s)
{
    int i;

    m->n = n;
    if (case_next(s) % 2) {
        cosines_of_vectors(m, s);
    } else {
        double most = case_next(s) % 3 ? 1.0 : 0.3;

        for (i = 0; i < n * (n - 1) / 2; i++) {
            m->cosine[i] = most * draw_cosine(s);
        }
    }
    draw_t(m, s);
}

static void fail_matrix(const struct matrix *m, double gain, long double exact)
{
    int i;

    for (i = 0; i < m->n; i++) {
        print_error("t %a\n", m->t[i]);
    }
    for (i = 0; i < m->n * (m->n - 1) / 2; i++) {
        print_error("cosine %a\n", m->cosine[i]);
    }
    fail_msg("%d columns: %.17g, exactly %.17Lg", m->n, gain, exact);
}

static void test_columns(void **state)
{
    static const long trials[GR_COLUMNS + 1] = {0, 0, 100000, 100000, 100000, 50000, 25000, 12000};
    uint64_t s = 3;
    int n, i;
    long trial;

    (void)state;
    for (n = 2; n <= GR_COLUMNS; n++) {
        for (trial = 0; trial < trials[n]; trial++) {
            long double cosine[GR_COLUMNS * (GR_COLUMNS - 1) / 2], t[GR_COLUMNS], norm2 = 0.0L, exact;
            struct matrix m;
            double gain;

            draw_matrix(&m, n, &s);
            for (i = 0; i < n * (n - 1) / 2; i++) {
                cosine[i] = m.cosine[i];
            }
            for (i = 0; i < n; i++) {
                t[i] = m.t[i];
                norm2 += t[i] * t[i];
            }
            exact = gr_gain(n, cosine, t);
            gain = brdffit_nnls_gain(n, m.cosine, m.t);
            if (!(fabsl((long double)gain - exact) <= gr_allowed(n) * norm2)) {
                fail_matrix(&m, gain, exact);
            }
        }
    }
}

/* ---- Corners and shifts ---------------------------------------------------------------------------------------- */

/* A model's columns: fixed, each of a side, sides. */
struct shape {
    int F, Q, S;
};

static int columns_of(struct shape m)
{
    return m.F + m.Q * m.S;
}

/* The side of column c, -1 of a fixed one. */
static int side_of(struct shape m, int c)
{
    return c < m.F ? -1 : (c - m.F) / m.Q;
}

struct corners {
    struct gains in;
    double omega[FIXED_MOST][CHANNELS], tau[MOVING_MOST][2][CHANNELS], shift[MOVING_MOST][CHANNELS];
};

static double draw_fall(uint64_t *s)
{
    switch (case_next(s) % 5) {
    case 0: return 0.0;
    case 1: return 1e-3 * case_signed(s);
    case 2: return 1e6 * case_signed(s);
    default: return case_signed(s);
    }
}

/* Columns of the sides at one channel. */
static void draw_channel(struct corners *c, struct shape m, size_t k, int near, double wide, uint64_t *s)
{
    int p;

    for (p = 0; p < m.F; p++) {
        c->omega[p][k] = case_next(s) % 6 ? case_uniform(s) : -case_uniform(s);
    }
    for (p = 0; p < m.Q * m.S; p++) {
        c->tau[p][0][k] = near ? c->omega[0][k] * (1.0 + 1e-9 * case_signed(s)) : case_uniform(s);
        c->tau[p][1][k] = case_next(s) % 6 ? c->tau[p][0][k] + 0.01 * case_signed(s) : case_signed(s);
        c->shift[p][k] = case_next(s) % 4 ? wide * case_signed(s) : 0.0;
    }
}

/* Numbers as bounds have them: anything that LIMIT_SHIFT lets through. */
static void draw_corners(struct corners *c, struct shape m, uint64_t *s)
{
    double wide = case_next(s) % 4 ? 0.1 : 1e6;
    int p, e, i, near = case_next(s) % 3 == 0;
    size_t k;

    c->in.channels = 1 + case_next(s) % CHANNELS;
    for (p = 0; p < m.F; p++) {
        c->in.omega[p] = c->omega[p];
    }
    for (p = 0; p < m.Q * m.S; p++) {
        c->in.tau[p][0] = c->tau[p][0];
        c->in.tau[p][1] = c->tau[p][1];
        c->in.shift[p] = c->shift[p];
    }
    for (k = 0; k < c->in.channels; k++) {
        draw_channel(c, m, k, near, wide, s);
    }
    for (e = 0; e < COSINES(columns_of(m)); e++) {
        for (i = 0; i < 4; i++) {
            c->in.cosine[e][i] = case_next(s) % 8 ? draw_cosine(s) : case_signed(s);
        }
        c->in.fall[e][0] = draw_fall(s);
        c->in.fall[e][1] = draw_fall(s);
    }
}

/* The cosine of columns i < j at a corner with some sides shifted. */
static long double exact_cosine(const struct corners *c, struct shape m, int i, int j, unsigned corner,
                                unsigned shifted)
{
    int e = COSINE(columns_of(m), i, j), p = side_of(m, i), q = side_of(m, j);
    unsigned high_p = p < 0 ? 0 : corner >> p & 1, high_q = q < 0 ? 0 : corner >> q & 1;
    long double v;

    if (q < 0) {
        return c->in.cosine[e][0];
    }
    if (p < 0 || p == q) {
        return (long double)c->in.cosine[e][high_q] - (shifted >> q & 1 ? c->in.fall[e][0] : 0.0);
    }
    v = c->in.cosine[e][high_p + 2 * high_q];
    v -= shifted >> p & 1 ? (long double)c->in.fall[e][0] : 0.0L;
    v -= shifted >> q & 1 ? (long double)c->in.fall[e][1] : 0.0L;
    return v;
}

/* J at corner c (bits) with the sides of subset z shifted; *norm2: what its rounding is relative to. */
static long double exact_gain(const struct corners *c, struct shape m, unsigned corner, unsigned shifted,
                              long double *norm2)
{
    long double cosine[COSINES(COLUMNS_MOST)], t[COLUMNS_MOST], sum = 0.0L;
    int i, j, e = 0, n = columns_of(m);
    size_t k;

    for (i = 0; i < n; i++) {
        for (j = i + 1; j < n; j++) {
            cosine[e++] = exact_cosine(c, m, i, j, corner, shifted);
        }
    }
    *norm2 = 0.0L;
    for (k = 0; k < c->in.channels; k++) {
        for (i = 0; i < n; i++) {
            int p = side_of(m, i), d = i - m.F;

            t[i] = p < 0 ? c->omega[i][k]
                         : (long double)c->tau[d][corner >> p & 1][k] + (shifted >> p & 1 ? c->shift[d][k] : 0.0);
            *norm2 += t[i] * t[i];
        }
        sum += gr_gain(n, cosine, t);
    }
    return sum;
}

/* Two shifts of 1e6 that cancel leave 1e-10 of rounding in an entry: what that is worth, beside R's own. */
static long double entry_rounding(const struct corners *c, struct shape m)
{
    long double largest = 0.0L;
    int e, n = columns_of(m);

    for (e = 0; e < COSINES(n); e++) {
        largest = fmaxl(largest, fabsl((long double)c->in.fall[e][0]) + fabsl((long double)c->in.fall[e][1]));
    }
    return 4.0L * TOL_UNIT * largest * n * (n - 1);
}

/* One model's instance against the truth, and every instruction set against the first. */
static long check_shape(struct shape m, const struct kernels *const *table, size_t tables, long trials, uint64_t *s)
{
    long trial, checked = 0;
    size_t i;

    for (trial = 0; trial < trials; trial++) {
        double gain[GAINS(SIDES_MOST)], first[GAINS(SIDES_MOST)];
        unsigned corners = 1u << m.S, c;
        struct corners in;

        draw_corners(&in, m, s);
        table[0]->gains[m.F - 1][m.Q - 1][m.S - 1](&in.in, 1, first);
        for (c = 0; c < GAINS((unsigned)m.S); c++) {
            long double norm2, exact = exact_gain(&in, m, c % corners, c / corners, &norm2);

            if (!(fabsl((long double)first[c] - exact) <=
                  (gr_allowed(columns_of(m)) + entry_rounding(&in, m)) * norm2)) {
                fail_msg("%d fixed, %d of %d sides, trial %ld, number %u: %.17g, exactly %.17Lg", m.F, m.Q, m.S, trial,
                         c, first[c], exact);
            }
            checked++;
        }
        for (i = 0; i < tables; i++) {
            memset(gain, 0xff, sizeof gain);
            table[i]->gains[m.F - 1][m.Q - 1][m.S - 1](&in.in, 1, gain);
            assert_memory_equal(gain, first, GAINS((unsigned)m.S) * sizeof *gain);
            memset(gain, 0xff, sizeof gain);
            table[i]->gains[m.F - 1][m.Q - 1][m.S - 1](&in.in, 0, gain);
            assert_memory_equal(gain, first, corners * sizeof *gain);
        }
    }
    return checked;
}

static void test_corners(void **state)
{
    const struct kernels *table[BRDFFIT_ISA_COUNT];
    size_t tables = all_kernels(table);
    long checked = 0, models = 0;
    uint64_t s = 5;
    struct shape m;

    (void)state;
    for (m.F = 1; m.F <= FIXED_MOST; m.F++) {
        for (m.Q = 1; m.Q <= EACH_MOST; m.Q++) {
            for (m.S = 1; m.S <= SIDES_MOST; m.S++) {
                if (columns_of(m) > COLUMNS_MOST) {
                    assert_null(table[0]->gains[m.F - 1][m.Q - 1][m.S - 1]);
                    continue;
                }
                checked += check_shape(m, table, tables,
                                       m.F == 1 && m.Q == 1 ? 6000
                                       : columns_of(m) > 5  ? 200
                                                            : 1500,
                                       &s);
                models++;
            }
        }
    }
    assert_int_equal(models, 16);
    print_message("%ld gains, %zu instruction sets\n", checked, tables);
}

/* ---- The maximum over a box ------------------------------------------------------------------------------------ */

/* The mean of the numbers at a place of the box, by their weights. */
static long double mean_at(const double *gain, int sides, const long double *x)
{
    long double sum = 0.0L;
    unsigned i;
    int p;

    for (i = 0; i < GAINS((unsigned)sides); i++) {
        long double weight = 1.0L;

        for (p = 0; p < sides; p++) {
            long double w = 4.0L * x[p] * (1.0L - x[p]);

            weight *= i >> p & 1 ? x[p] : 1.0L - x[p];
            weight *= i >> (sides + p) & 1 ? w : 1.0L - w;
        }
        sum += weight * gain[i];
    }
    return sum;
}

/* Numbers like those of boxes: nearly level, steep, some shifts that do nothing, equal ones, all zero. */
static void draw_numbers(double *gain, int sides, uint64_t *s)
{
    double level = case_uniform(s), rise = pow(10.0, -12.0 * case_uniform(s)), size = case_next(s) % 5 ? 1.0 : 1e-155;
    unsigned i, corners = 1u << sides;
    int kind = (int)(case_next(s) % 5);

    for (i = 0; i < GAINS((unsigned)sides); i++) {
        gain[i] = size * (kind == 0                                       ? case_uniform(s)
                          : kind == 1                                     ? level + rise * case_uniform(s)
                          : kind == 2 && i >= corners && case_next(s) % 2 ? gain[i % corners] / size
                          : kind == 3 ? level * (double)(case_next(s) % 3)
                                      : 1e6 * case_uniform(s) * (double)(case_next(s) % 2));
    }
}

/* The sides' shifts as the box's advice has them. */
static double exact_lift(const double *gain, int sides, int p)
{
    double most = 0.0;
    unsigned i, corners = 1u << sides, bit = 1u << (sides + p);

    for (i = 0; i < GAINS((unsigned)sides); i++) {
        if ((i & bit) && (sides > 2 || i / corners == 1u << p)) {
            most = fmax(most, fabs(gain[i] - gain[i ^ bit]));
        }
    }
    return sides > 1 ? most : 0.0;
}

static void check_maximum(const double *gain, int sides, double maximum, uint64_t *s)
{
    long double largest = 0.0L, met = 0.0L, x[SIDES_MOST], step = 0.25L;
    double best[SIDES_MOST] = {0.0};
    unsigned i;
    int point, p;

    for (i = 0; i < GAINS((unsigned)sides); i++) {
        largest = fmaxl(largest, gain[i]);
    }
    for (point = 0; point <= 400; point++) {
        for (p = 0; p < sides; p++) { /* all over it or anywhere, and closer and closer to the best */
            x[p] = sides == 1    ? point / 400.0L
                   : point < 100 ? (long double)case_uniform(s)
                                 : best[p] + step * case_signed(s);
            x[p] = fminl(fmaxl(x[p], 0.0L), 1.0L);
        }
        if (mean_at(gain, sides, x) > met) {
            met = mean_at(gain, sides, x);
            for (p = 0; p < sides; p++) {
                best[p] = (double)x[p];
            }
        }
        step *= point < 100 ? 1.0L : 0.97L;
    }
    /* A cubic's own rounding, relative to the largest number; below 1e-150 its discriminant underflows (gains.h). */
    if (!((long double)maximum >= met - (largest < 1e-150L ? 1.0L : 16.0L * sides * TOL_UNIT) * largest)) {
        fail_msg("%d sides: maximum %.17g, but %.17Lg at %g %g %g", sides, maximum, met, best[0], best[1], best[2]);
    }
    assert_true((long double)maximum <= largest * (1.0L + 16.0L * sides * TOL_UNIT));
    /* One side is exact: a cubic's second derivative is 40 times the largest number at most, and 40 / 400^2 / 8 = 3.2e-5. */
    if (sides == 1 && !((long double)maximum <= met + 3.2e-5L * largest)) {
        fail_msg("%a %a %a %a: maximum %.17g, met %.17Lg", gain[0], gain[1], gain[2], gain[3], maximum, met);
    }
}

static void test_box_maximum(void **state)
{
    const struct kernels *table[BRDFFIT_ISA_COUNT];
    size_t tables = all_kernels(table), i;
    uint64_t s = 9;
    long trial;
    int sides, p;

    (void)state;
    for (sides = 1; sides <= SIDES_MOST; sides++) {
        for (trial = 0; trial < FEWER(sides > 2 ? 400 : 1500, 150); trial++) {
            double gain[GAINS(SIDES_MOST)] = {0.0}, lift[SIDES_MOST], first_lift[SIDES_MOST] = {0.0}, first;

            draw_numbers(gain, sides, &s);
            first = table[0]->box_maximum[sides - 1](gain, first_lift);
            check_maximum(gain, sides, first, &s);
            for (p = 0; p < sides; p++) {
                assert_true(first_lift[p] == exact_lift(gain, sides, p));
            }
            for (i = 0; i < tables; i++) {
                assert_true(table[i]->box_maximum[sides - 1](gain, lift) == first);
                assert_memory_equal(lift, first_lift, (size_t)sides * sizeof *lift);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_columns),
        cmocka_unit_test(test_corners),
        cmocka_unit_test(test_box_maximum),
    };

    return cmocka_run_group_tests_name("gains", tests, NULL, NULL);
}
