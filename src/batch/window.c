/*
 * Windows of a plan: polynomials with rigorous errors. SPDX-License-Identifier: MIT
 *
 * The range of theta = ln s is cut into windows. In each, what a texel needs is a polynomial in t: the shapes phi of the
 * groups, with the window's scale and tilt; u and D. All are Chebyshev interpolants of REFERENCE terms, cut off after 8 or 12
 * (shapes, u) or 16 (D): the part that is cut off is at most the sum of the magnitudes of its Chebyshev coefficients.
 *
 * What the interpolant itself misses. Every phi is a completely monotone function of s (exponentials; (1 + c s)^-2; one over a
 * sum of complete Bernstein functions, smith.h; products of these), hence |phi(z)| <= phi(Re z) for Re z > 0. (Beckmann with
 * Smith has a factor |(z + M) / (Re z + M)|^(1/2 or 1) in front, below MASKED.) With theta = center + radius t, t in the ellipse
 * with foci +-1 and semi-axes A, B such that radius B = REACH < pi / 2, s = exp(theta) has Re s >= s_center exp(-radius A) cos
 * REACH, so the values there are at most some Q, and the interpolant is within 4 Q rho^-(REFERENCE - 1) / (rho - 1), rho = A + B:
 * 1e-23 Q for windows of usual width. |exp(tilt t)| <= exp(|tilt| A). D and u are sums of products of such values.
 */
#include <math.h>

#include "base/exp.h"
#include "base/log.h"
#include "batch/fast.h"
#include "base/tolerance.h"

/* Rounding of polynomial coefficients and their use, in u relative to the sum of their magnitudes: an error of a
 * Chebyshev coefficient, a few u of the largest value, counts once whatever the degree; the rest are sums of terms. */
#define ROUNDING 4096.0
/* radius B of the ellipse, and what is below its cosine: 1 - REACH^2 / 2. */
#define REACH 0.95
#define REACH_COSINE 0.548
/* More than (1 / REACH_COSINE). */
#define MASKED 2.0
/* |tilt| at most. */
#define MOST_TILT 2.0

/* cos(j pi / 48), any j: the first quarter is tabulated. */
static double cosine(size_t j)
{
    /* clang-format off */
    static const double quarter_of[BATCH_REFERENCE + 1] = {
        1.0, 0.997858923238603507, 0.991444861373810411, 0.980785280403230449,
        0.965925826289068287, 0.946930129495105664, 0.923879532511286756, 0.896872741532688304,
        0.866025403784438647, 0.831469612302545237, 0.793353340291235165, 0.751839807478977396,
        0.707106781186547524, 0.659345815100068868, 0.608761429008720639, 0.555570233019602225,
        0.5, 0.442288690219001282, 0.382683432365089772, 0.321439465303161581,
        0.258819045102520762, 0.195090322016128268, 0.130526192220051592, 0.0654031292301430668,
        0.0};
    /* clang-format on */
    const size_t terms = BATCH_REFERENCE;
    size_t turn = j % (4 * terms), half = turn > 2 * terms ? 4 * terms - turn : turn;

    return half > terms ? -quarter_of[2 * terms - half] : quarter_of[half];
}

static double node_place(size_t j)
{
    return cosine(2 * j + 1);
}

/* Chebyshev coefficients of the polynomial through value[j] at node_place(j). */
static void interpolate(const double value[BATCH_REFERENCE], double chebyshev[BATCH_REFERENCE])
{
    size_t j, q;

    for (q = 0; q < BATCH_REFERENCE; q++) {
        double sum = 0.0;

        for (j = 0; j < BATCH_REFERENCE; j++) {
            sum += value[j] * cosine(q * (2 * j + 1));
        }
        chebyshev[q] = sum * (q ? 2.0 : 1.0) / BATCH_REFERENCE;
    }
}

/* The first `terms` of them as coefficients of powers of t; returns the sum of the magnitudes of the others. */
static double cut_off(const double chebyshev[BATCH_REFERENCE], size_t terms, double *coefficient)
{
    double t0[BATCH_TERMS_D] = {1.0}, t1[BATCH_TERMS_D] = {0.0, 1.0}, next[BATCH_TERMS_D], rest = 0.0;
    size_t i, q;

    for (i = 0; i < terms; i++) {
        coefficient[i] = 0.0;
    }
    for (q = 0; q < terms; q++) {
        for (i = 0; i < terms; i++) { /* t0 is T_q; then a step of its recurrence */
            coefficient[i] += chebyshev[q] * t0[i];
            next[i] = (i ? 2.0 * t1[i - 1] : 0.0) - t0[i];
        }
        for (i = 0; i < terms; i++) {
            t0[i] = t1[i];
            t1[i] = next[i];
        }
    }
    for (; q < BATCH_REFERENCE; q++) {
        rest += fabs(chebyshev[q]);
    }
    return rest;
}

static double magnitude(const double *coefficient, size_t terms)
{
    double sum = 0.0;
    size_t j;

    for (j = 0; j < terms; j++) {
        sum += fabs(coefficient[j]);
    }
    return sum;
}

/* sup over [-1, 1] of |third derivative| / 6. */
static double third(const double *coefficient, size_t terms)
{
    double sum = 0.0;
    size_t j;

    for (j = 3; j < terms; j++) {
        sum += (double)(j * (j - 1) * (j - 2) / 6) * fabs(coefficient[j]);
    }
    return sum * (1.0 + TOL_CURVATURE);
}

/* The ellipse of a window. */
struct ellipse {
    double a;    /* A */
    double miss; /* what an interpolant misses of values that are at most 1 on it */
    double s;    /* of Re s, at least */
};

static struct ellipse ellipse_of(const struct batch_window *window)
{
    double b = REACH / window->radius;
    struct ellipse e = {.a = sqrt(1.0 + b * b)};
    double rho = e.a + b, power = 1.0;
    int i;

    for (i = 1; i < BATCH_REFERENCE; i++) {
        power /= rho;
    }
    e.miss = 4.1 * power / (rho - 1.0);
    e.s = kernel_exp(window->center - window->radius * e.a) * REACH_COSINE;
    return e;
}

/* A window in the making. Rows of the scratch: shapes at the nodes of the interpolants, and the largest in the ellipse. */
struct making {
    struct batch_fast *fast;
    struct batch_window *window;
    struct ellipse ellipse;
    double *value[BATCH_REFERENCE], *most;
    double stretch[EACH_MOST];             /* scale exp(|tilt| A) */
    double d[BATCH_PAIRS][BATCH_REFERENCE]; /* at the nodes of the interpolants, tilted */
    double u[EACH_MOST][BATCH_REFERENCE];
    double bound[EACH_MOST]; /* |b phi| in the ellipse, tilted and scaled */
};

static double theta_at(const struct batch_window *window, double t)
{
    return window->center + window->radius * t;
}

/* D at t, without scale and tilt. */
static void gram_at(const struct making *m, double t, double d[BATCH_PAIRS], double u[EACH_MOST])
{
    double *phi[EACH_MOST] = {m->value[0], m->value[1]};
    int j;

    for (j = 0; j < m->fast->each; j++) {
        brdffit_batch_shape(m->fast, j, kernel_exp(theta_at(m->window, t)), phi[j]);
    }
    brdffit_batch_gram(m->fast, (const double *const *)phi, d, u);
}

/* The factors of the columns: nothing that a proof rests on but that they are finite and positive. */
static int choose_factors(struct making *m)
{
    double low[BATCH_PAIRS], here[BATCH_PAIRS], high[BATCH_PAIRS], u[EACH_MOST];
    int j, usable = 1;

    gram_at(m, -0.5, low, u);
    gram_at(m, 0.5, high, u);
    gram_at(m, 0.0, here, u);
    for (j = 0; j < m->fast->each; j++) {
        int at = BATCH_PAIR(j, j);
        double tilt = low[at] > 0.0 && high[at] > 0.0 ? -0.5 * (kernel_log(high[at]) - kernel_log(low[at])) : 0.0;

        m->window->tilt[j] = fmin(MOST_TILT, fmax(-MOST_TILT, tilt));
        m->window->scale[j] = 1.0 / sqrt(here[at]);
        m->stretch[j] = m->window->scale[j] * kernel_exp(fabs(m->window->tilt[j]) * m->ellipse.a);
        usable = usable && here[at] > 0.0 && isfinite(m->stretch[j]);
    }
    return usable;
}

/* How much faster than s a shape may fall: what an error of s does to it. */
static double steepness(const struct batch_fast *f, double c, double high)
{
    return f->steep ? c * high + 2.0 : 3.0;
}

/* Polynomials of the shapes of column j, with 8 terms and with more; values in the window's factors are in m->value. */
static void fill_shapes(const struct making *m, int j)
{
    const struct batch_fast *f = m->fast;
    const struct batch_column *column = &f->column[j];
    struct batch_window *window = m->window;
    double high = kernel_exp(theta_at(window, 1.0)), n2[2] = {0.0, 0.0}, u[2] = {0.0, 0.0};
    double argument = 8.0 + 2.0 * fmax(fabs(theta_at(window, 1.0)), fabs(theta_at(window, -1.0)));
    size_t w = (size_t)(window - f->window), group, q;
    int more;

    for (group = 0; group < f->distinct; group++) {
        double values[BATCH_REFERENCE], chebyshev[BATCH_REFERENCE], largest = 0.0;
        double steep = steepness(f, column->sight.c[group], high);

        for (q = 0; q < BATCH_REFERENCE; q++) {
            values[q] = m->value[q][group];
            largest = fmax(largest, values[q]);
        }
        interpolate(values, chebyshev);
        for (more = 0; more < 2; more++) {
            size_t terms = more ? BATCH_TERMS_MORE : BATCH_TERMS, stride = more ? BATCH_STRIDE_MORE : BATCH_TERMS;
            double *shape = column->shape[more] + (w * f->distinct + group) * stride, error;

            error = cut_off(chebyshev, terms, shape) + m->ellipse.miss * m->most[group] * m->stretch[j];
            for (q = terms; q < stride; q++) {
                shape[q] = 0.0;
            }
            error += fmax(largest, magnitude(shape, terms)) *
                     (TOL_UNIT * (ROUNDING + argument * steep + 4.0 * (double)f->used) + 2.0 * f->snapped * steep);
            n2[more] += column->bb[group] * (error * error);
            u[more] += column->ab[group] * error;
        }
    }
    for (more = 0; more < 2; more++) {
        window->n_error[j][more] = 1.01 * sqrt(n2[more]);
        window->u_error[j][more] = 1.01 * u[more];
    }
}

/* Column j at the nodes of the interpolants, and what it is in the ellipse at most. */
static void sample_column(struct making *m, int j)
{
    const struct batch_fast *f = m->fast;
    const struct batch_column *column = &f->column[j];
    double square = 0.0, factor = f->kind->smith ? MASKED : 1.0;
    size_t group, q;

    brdffit_batch_shape(f, j, m->ellipse.s, m->most);
    for (group = 0; group < f->distinct; group++) {
        m->most[group] *= factor * 1.01;
        square += column->bb[group] * (m->most[group] * m->most[group]);
    }
    m->bound[j] = 1.01 * sqrt(square) * m->stretch[j];
    for (q = 0; q < BATCH_REFERENCE; q++) {
        double t = node_place(q), lift = m->window->scale[j] * kernel_exp(m->window->tilt[j] * t), u = 0.0;

        brdffit_batch_shape(f, j, kernel_exp(theta_at(m->window, t)), m->value[q]);
        for (group = 0; group < f->distinct; group++) {
            m->value[q][group] *= lift;
            u += column->ab[group] * m->value[q][group];
        }
        m->u[j][q] = u;
    }
}

/* D at the nodes of the interpolants; before the rows of the scratch are filled. */
static void sample_gram(struct making *m)
{
    int i, j;
    size_t q;

    for (q = 0; q < BATCH_REFERENCE; q++) {
        double t = node_place(q), d[BATCH_PAIRS], u[EACH_MOST], lift[EACH_MOST];

        gram_at(m, t, d, u);
        for (j = 0; j < m->fast->each; j++) {
            lift[j] = m->window->scale[j] * kernel_exp(m->window->tilt[j] * t);
            for (i = 0; i <= j; i++) {
                m->d[BATCH_PAIR(i, j)][q] = d[BATCH_PAIR(i, j)] * lift[i] * lift[j];
            }
        }
    }
}

/* u of column j. */
static void fill_u(const struct making *m, int j)
{
    double chebyshev[BATCH_REFERENCE];
    int more;

    interpolate(m->u[j], chebyshev);
    for (more = 0; more < 2; more++) {
        size_t terms = more ? BATCH_TERMS_MORE : BATCH_TERMS;

        m->window->u_error[j][more] += cut_off(chebyshev, terms, m->window->u[j][more]) + m->ellipse.miss * m->bound[j];
        m->window->u_third[j][more] = third(m->window->u[j][more], terms);
    }
}

/* |b phi| of column j in the window, tilted and scaled, and what rounding makes of D, relative to two such. */
struct size {
    double norm, rounding;
};

static struct size size_of(const struct making *m, int j)
{
    const struct batch_fast *f = m->fast;
    double high = kernel_exp(theta_at(m->window, 1.0)), h = 0.0, first = 0.0, second = 0.0;
    double argument = 8.0 + 2.0 * fmax(fabs(theta_at(m->window, 1.0)), fabs(theta_at(m->window, -1.0)));
    size_t group, q;

    for (group = 0; group < f->distinct; group++) {
        double largest = 0.0, steep = steepness(f, f->column[j].sight.c[group], high), weight;
        double error = TOL_UNIT * (ROUNDING + argument * steep + 4.0 * (double)f->used) + 2.0 * f->snapped * steep;

        for (q = 0; q < BATCH_REFERENCE; q++) {
            largest = fmax(largest, m->value[q][group]);
        }
        weight = f->column[j].bb[group] * (largest * largest);
        h += weight;
        first += weight * error;
        second += weight * (error * error);
    }
    return (struct size){1.01 * sqrt(h), h > 0.0 ? 2.02 * (first / h + sqrt(second / h)) : 0.0};
}

/* D_ij. */
static void fill_d(const struct making *m, int i, int j, const struct size size[EACH_MOST])
{
    struct batch_window *window = m->window;
    double chebyshev[BATCH_REFERENCE];
    int at = BATCH_PAIR(i, j);

    interpolate(m->d[at], chebyshev);
    window->d_error[at] = cut_off(chebyshev, BATCH_TERMS_D, window->d[at]) +
                          2.0 * m->ellipse.miss * m->bound[i] * m->bound[j] +
                          TOL_UNIT * ROUNDING * magnitude(window->d[at], BATCH_TERMS_D) +
                          size[i].norm * size[j].norm * fmax(size[i].rounding, size[j].rounding);
    window->d_third[at] = third(window->d[at], BATCH_TERMS_D);
}

int brdffit_batch_window(struct batch_fast *f, size_t w)
{
    struct making m = {.fast = f, .window = &f->window[w], .ellipse = ellipse_of(&f->window[w])};
    struct size size[EACH_MOST];
    size_t q;
    int i, j;

    for (q = 0; q < BATCH_REFERENCE; q++) {
        m.value[q] = f->scratch + q * PADDED(f->distinct);
    }
    m.most = f->scratch + q * PADDED(f->distinct);
    if (!choose_factors(&m)) {
        return 0;
    }
    sample_gram(&m);
    for (j = 0; j < f->each; j++) {
        sample_column(&m, j);
        fill_shapes(&m, j);
        fill_u(&m, j);
        size[j] = size_of(&m, j);
    }
    for (j = 0; j < f->each; j++) {
        for (i = 0; i <= j; i++) {
            fill_d(&m, i, j, size);
        }
    }
    return 1;
}
