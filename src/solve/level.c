/*
 * Reach of functionals over a level set: see level.h. SPDX-License-Identifier: MIT
 *
 * Let q(z) = 2 t.z - z'Mz, a >= 0 and lambda > 0. Every z >= 0 with q(z) >= c has, for both signs,
 *
 *     c +- lambda a.z  <=  q(z) +- lambda a.z  <=  R(t +- lambda a / 2, M),
 *
 * so that +- a.z <= [R(t +- lambda a / 2, M) - c] / lambda. Any lambda proves, whatever M is; the best one is found by a golden
 * section in ln lambda. (With mu = 1 / lambda the right side is a perspective of the convex R - c, hence convex in mu, and
 * with a Gram matrix its least value is the supremum itself: strong duality of a convex problem.)
 *
 * Where the best one is. With v = a' M_S^-1 a over the columns in use, q falls by lambda^2 v / 4 from its maximum R(t, M):
 * lambda = 2 sqrt((R - c) / v). v is at least 1/7 and, as cosines end at 1 - 1e-15, at most 1e15.
 *
 * A share: z0 (1 - f) >= z1 f ratio says that z is a sum, >= 0, of column asked[0] and of (f ratio, 1 - f) of the two. So R of
 * the model with that column, at unit norm, in the place of asked[1] decides, exactly; and the set shrinks with f.
 *
 * Rounding: TOL_LEVEL u |t|^2, of the t that is evaluated.
 */
#include "solve/level.h"

#include <math.h>

#include "base/exp.h"
#include "base/tolerance.h"

/* Range of ln(lambda / (2 sqrt(R - c))): v from 1/7 to 1e15, and room. */
#define LEVEL_LOWEST (-18.5)
#define LEVEL_HIGHEST 2.5
/* Steps of the golden section, and of bisections of a share. */
#define LEVEL_STEPS 22
#define LEVEL_HALVINGS 40
/* Cosines of what only suggests a z. */
#define ATTAIN_COSINE (1.0 - 1e-13)

static double gain_above(int columns, const double *cosine, const double *t)
{
    double size = 0.0;
    int j;

    for (j = 0; j < columns; j++) {
        size += t[j] * t[j];
    }
    return brdffit_nnls_gain(columns, cosine, t) + TOL_LEVEL * TOL_UNIT * size;
}

static double reach_at(const struct level *v, int sense, double lambda)
{
    double t[NNLS_COLUMNS] = {0.0}, step = 0.5 * lambda * sense, above;
    int j;

    for (j = 0; j < v->columns; j++) {
        t[j] = v->t[j];
    }
    t[v->asked[0]] += step;
    if (v->asked[1] >= 0) {
        t[v->asked[1]] += step * v->second;
    }
    above = gain_above(v->columns, v->cosine, t) - v->gain;
    return above / lambda + 4.0 * TOL_UNIT * fabs(above / lambda);
}

/* Golden section in x = ln(lambda / unit); any value seen is a bound. */
static double best_reach(const struct level *v, int sense, double unit, double enough, double *multiplier)
{
    const double golden = 0.6180339887498949;
    double low = LEVEL_LOWEST, high = LEVEL_HIGHEST, best = INFINITY, x[2], value[2];
    int i, side;

    x[0] = high - golden * (high - low);
    x[1] = low + golden * (high - low);
    value[0] = reach_at(v, sense, unit * kernel_exp(x[0]));
    value[1] = reach_at(v, sense, unit * kernel_exp(x[1]));
    for (i = 0; i < LEVEL_STEPS; i++) {
        side = value[1] < value[0];
        if (value[side] < best) {
            best = value[side];
            *multiplier = unit * kernel_exp(x[side]);
        }
        if (best <= enough) {
            break;
        }
        if (side) {
            low = x[0];
            x[0] = x[1];
            value[0] = value[1];
            x[1] = low + golden * (high - low);
            value[1] = reach_at(v, sense, unit * kernel_exp(x[1]));
        } else {
            high = x[1];
            x[1] = x[0];
            value[1] = value[0];
            x[0] = high - golden * (high - low);
            value[0] = reach_at(v, sense, unit * kernel_exp(x[0]));
        }
    }
    return best;
}

double brdffit_level_reach(const struct level *v, int sense, double enough, double *multiplier)
{
    double above = gain_above(v->columns, v->cosine, v->t), room = above - v->gain, least = 0.0, reach = INFINITY, unit;
    int j;

    if (room < 0.0) {
        return -INFINITY;
    }
    if (!(v->gain > -INFINITY)) {
        return sense > 0 ? (double)INFINITY : 0.0;
    }
    if (*multiplier > 0.0) {
        reach = reach_at(v, sense, *multiplier);
        if (reach <= enough) {
            return reach;
        }
    }
    for (j = 0; j < v->columns; j++) {
        least += v->t[j] * v->t[j];
    }
    unit = 2.0 * sqrt(fmax(room, 1e-20 * least + 1e-290));
    reach = fmin(reach, best_reach(v, sense, unit, enough, multiplier));
    return sense < 0 ? fmin(reach, 0.0) : fmax(reach, 0.0);
}

/* Whether the set may have a z with that share: cosines with columns asked[1] replaced. */
static int share_possible(const struct level *v, double ratio, double f)
{
    double cosine[COSINES(NNLS_COLUMNS)], t[NNLS_COLUMNS], first = f * ratio, second = 1.0 - f, m, norm;
    int a = v->asked[0], b = v->asked[1], n = v->columns, i, j;

    m = v->cosine[a < b ? COSINE(n, a, b) : COSINE(n, b, a)];
    m = m < 1.0 ? m : 1.0;
    if (first > 1e100) {
        first = 1.0;
        second = 0.0;
    }
    norm = sqrt(first * first + second * second + 2.0 * first * second * m);
    if (!(norm > 0.0)) {
        return 1;
    }
    for (i = 0; i < n; i++) {
        t[i] = v->t[i];
        for (j = i + 1; j < n; j++) {
            int e = COSINE(n, i, j), other = i == b ? j : i;

            cosine[e] = v->cosine[e];
            if (i == b || j == b) {
                double with_first = other == a  ? 1.0
                                    : other < a ? v->cosine[COSINE(n, other, a)]
                                                : v->cosine[COSINE(n, a, other)];

                cosine[e] = (first * with_first + second * v->cosine[e]) / norm;
                cosine[e] = (other == a ? (first + second * m) / norm : cosine[e]) * (1.0 - 16.0 * TOL_UNIT);
            }
        }
    }
    t[b] = (first * v->t[a] + second * v->t[b]) / norm;
    return gain_above(n, cosine, t) >= v->gain;
}

double brdffit_level_share(const struct level *v, double ratio, double enough)
{
    double low = 0.0, high = 1.0;
    int i;

    if (gain_above(v->columns, v->cosine, v->t) < v->gain) {
        return -INFINITY;
    }
    if (!share_possible(v, ratio, enough > 0.0 ? enough : 0.0)) {
        return enough;
    }
    if (share_possible(v, ratio, 1.0)) {
        return 1.0;
    }
    low = enough > 0.0 ? enough : 0.0;
    for (i = 0; i < LEVEL_HALVINGS; i++) {
        double middle = 0.5 * (low + high);

        if (share_possible(v, ratio, middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return high;
}

static double gain_of(const struct level *v, const double *z)
{
    double linear = 0.0, square = 0.0;
    int i, j;

    for (i = 0; i < v->columns; i++) {
        linear += v->t[i] * z[i];
        square += z[i] * z[i];
        for (j = i + 1; j < v->columns; j++) {
            square += 2.0 * z[i] * z[j] * v->cosine[COSINE(v->columns, i, j)];
        }
    }
    return 2.0 * linear - square;
}

/* The maximum with t moved by lambda / 2 times what is asked. */
static void maximise(const struct level *v, const struct nnls *factored, double step, double *z)
{
    double t[NNLS_COLUMNS];
    int j;

    for (j = 0; j < v->columns; j++) {
        t[j] = v->t[j];
    }
    t[v->asked[0]] += step;
    if (v->asked[1] >= 0) {
        t[v->asked[1]] += step * v->second;
    }
    (void)brdffit_nnls_support(factored, t, z);
}

int brdffit_level_attain(const struct level *v, int sense, double z[NNLS_COLUMNS])
{
    double cosine[NNLS_COLUMNS][NNLS_COLUMNS] = {{0.0}}, low = LEVEL_LOWEST, high = LEVEL_HIGHEST + 4.0, unit,
           trial[NNLS_COLUMNS];
    struct nnls factored;
    int i, j;

    for (i = 0; i < v->columns; i++) {
        for (j = i + 1; j < v->columns; j++) {
            cosine[i][j] = fmin(v->cosine[COSINE(v->columns, i, j)], ATTAIN_COSINE); /* t need not fit parallel ones */
        }
    }
    brdffit_nnls_factor_gram(&factored, v->columns, cosine);
    maximise(v, &factored, 0.0, z);
    unit = gain_of(v, z) - v->gain;
    if (!(unit >= 0.0)) {
        return 0;
    }
    unit = sqrt(unit);
    for (i = 0; i < LEVEL_STEPS && unit > 0.0; i++) {
        double middle = 0.5 * (low + high);

        maximise(v, &factored, sense * unit * kernel_exp(middle), trial);
        if (gain_of(v, trial) >= v->gain) {
            low = middle;
            for (j = 0; j < v->columns; j++) {
                z[j] = trial[j];
            }
        } else {
            high = middle;
        }
    }
    return 1;
}
