/*
 * Windows of a plan: polynomials with rigorous errors, and how a window is screened.
 * SPDX-License-Identifier: MIT
 *
 * The range of theta = ln s is cut into N windows of equal width. In each, exp(-c s) is a polynomial of 8 terms in t:
 * Chebyshev interpolation, whose error is below sup |f^(8)| / (8! 2^7) = x^8 exp(-c s_low) / 5160960 with
 * x = c radius; and one of 12, for data with so little noise that this is not enough. Summed against data by
 * Cauchy-Schwarz it is n_error |I_k|. D has its own of 16 terms: |D^(16)| <= sum bb (2 x)^16 phi^2 +
 * 2^16 (sum ab x^16 phi)(sum ab phi), phi at the low end, as (x + x')^16 <= 2^15 (x^16 + x'^16).
 *
 * Screening of a whole window from its end nodes, with chords in s. n_k is off its chord by at most |r_k| times the
 * distance of b phi from its chord, less what of that lies along a, where r_k has nothing: by delta |r_k| times the
 * chord of sqrt(D) at most. And sqrt(D) >= shrink times its chord. Ratios of linear functions lie between their ends
 * and the norm over channels of positive parts is convex, so
 *
 *     J <= (sqrt(max J at the ends) + delta |r|)^2 / shrink^2
 */
#include <math.h>

#include "base/exp.h"
#include "batch/fast.h"
#include "base/tolerance.h"

/* Rounding of polynomial coefficients and their use, in u relative to the sum of their magnitudes: an error of a
 * Chebyshev coefficient, a few u of the largest value, counts once whatever the degree; the rest are sums of terms. */
#define ROUNDING 4096.0
/* Pieces that D is compared with its chord on. */
#define SCREEN_PIECES 32

double brdffit_batch_d(const struct batch_fast *f, double s, double *u_of_s)
{
    double u = 0.0, d = 0.0;
    size_t m, i;

    for (m = 0; m < f->distinct; m++) {
        u += f->ab[m] * kernel_exp(-f->c[m] * s);
    }
    for (m = 0; m <= f->distinct; m++) {
        double phi = m < f->distinct ? kernel_exp(-f->c[m] * s) : 0.0;
        size_t end = m < f->distinct ? f->begin[m + 1] : f->used;

        for (i = f->begin[m]; i < end; i++) {
            double rest = f->b[i] * phi - (f->root_a > 0.0 ? u * (f->a[i] / f->root_a) : 0.0);

            d += rest * rest;
        }
    }
    *u_of_s = u;
    return d;
}

/* cos(j pi / (2 terms)), 8, 12 or 16 terms, any j: the first quarter is tabulated. */
static double cosine(size_t j, size_t terms)
{
    /* clang-format off */
    static const double of8[8] = {
        1.0, 0.980785280403230449, 0.923879532511286756, 0.831469612302545237,
        0.707106781186547524, 0.555570233019602225, 0.382683432365089772, 0.195090322016128268};
    static const double of12[12] = {
        1.0, 0.991444861373810411, 0.965925826289068287, 0.923879532511286756,
        0.866025403784438647, 0.793353340291235165, 0.707106781186547524, 0.608761429008720639,
        0.5, 0.382683432365089772, 0.258819045102520762, 0.130526192220051592};
    static const double of16[16] = {
        1.0, 0.995184726672196886, 0.980785280403230449, 0.956940335732208865,
        0.923879532511286756, 0.88192126434835503, 0.831469612302545237, 0.773010453362736961,
        0.707106781186547524, 0.634393284163645498, 0.555570233019602225, 0.471396736825997649,
        0.382683432365089772, 0.290284677254462368, 0.195090322016128268, 0.098017140329560602};
    /* clang-format on */
    size_t turn = j % (4 * terms), half = turn > 2 * terms ? 4 * terms - turn : turn;
    size_t quarter = half > terms ? 2 * terms - half : half;
    double value = quarter == terms ? 0.0 : terms == 8 ? of8[quarter] : terms == 12 ? of12[quarter] : of16[quarter];

    return half > terms ? -value : value;
}

static double node_place(size_t j, size_t terms)
{
    return cosine(2 * j + 1, terms);
}

/* Coefficients in t of the polynomial through value[j] at cos((2 j + 1) pi / (2 terms)). */
static void interpolate(const double *value, size_t terms, double *coefficient)
{
    double t0[BATCH_TERMS_D] = {1.0}, t1[BATCH_TERMS_D] = {0.0, 1.0}, next[BATCH_TERMS_D];
    size_t i, j, q;

    for (i = 0; i < terms; i++) {
        coefficient[i] = 0.0;
    }
    for (q = 0; q < terms; q++) {
        double chebyshev = 0.0;

        for (j = 0; j < terms; j++) {
            chebyshev += value[j] * cosine(q * (2 * j + 1), terms);
        }
        chebyshev *= (q ? 2.0 : 1.0) / (double)terms;
        for (i = 0; i < terms; i++) { /* t0 is T_q; then a step of its recurrence */
            coefficient[i] += chebyshev * t0[i];
            next[i] = (i ? 2.0 * t1[i - 1] : 0.0) - t0[i];
        }
        for (i = 0; i < terms; i++) {
            t0[i] = t1[i];
            t1[i] = next[i];
        }
    }
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

/* sup |f^(terms)| / (terms! 2^(terms - 1)) for exp(-x t) times what it is at the low end. */
static double remainder_of(double x, size_t terms)
{
    double x4 = (x * x) * (x * x), x8 = x4 * x4;

    return 1.01 * (terms == BATCH_TERMS        ? x8 / 5160960.0
                   : terms == BATCH_TERMS_MORE ? x8 * x4 / (479001600.0 * 2048.0)
                                               : x8 * x8 / (20922789888000.0 * 32768.0));
}

/* exp(-c_m s) over window w, and the errors of it, n and u; with more terms or not. */
static void fill_shapes(struct batch_fast *f, size_t w, int more, double snapped)
{
    struct batch_window *window = &f->window[w];
    double low = window->center - window->radius, high = window->center + window->radius;
    double n2 = 0.0, u = 0.0;
    size_t terms = more ? BATCH_TERMS_MORE : BATCH_TERMS, stride = more ? BATCH_STRIDE_MORE : BATCH_TERMS, m, j;

    for (m = 0; m < f->distinct; m++) {
        double *shape = f->shape[more] + (w * f->distinct + m) * stride, value[BATCH_TERMS_MORE], error, size;
        double phi = kernel_exp(-f->c[m] * low);

        for (j = 0; j < terms; j++) {
            value[j] = kernel_exp(-f->c[m] * (window->center + window->radius * node_place(j, terms)));
        }
        interpolate(value, terms, shape);
        for (j = terms; j < stride; j++) {
            shape[j] = 0.0;
        }
        size = fmax(phi, magnitude(shape, terms));
        error = phi * remainder_of(f->c[m] * window->radius, terms) +
                size * (TOL_UNIT * (ROUNDING + 8.0 * f->c[m] * high + 4.0 * (double)f->used) +
                        2.0 * snapped * f->c[m] * high);
        n2 += f->bb[m] * (error * error);
        u += f->ab[m] * error;
    }
    window->n_error[more] = 1.01 * sqrt(n2);
    window->u_error[more] = 1.01 * u;
}

/* D and u over window w. */
static void fill_geometry(struct batch_fast *f, size_t w, double snapped)
{
    struct batch_window *window = &f->window[w];
    double d[BATCH_TERMS_D], u[BATCH_TERMS_D], unused, low = window->center - window->radius;
    double high = window->center + window->radius;
    double h16 = 0.0, u16 = 0.0, u0 = 0.0, h = 0.0, largest = 0.0, rounding;
    size_t j, m;
    int more;

    for (more = 0; more < 2; more++) {
        size_t terms = more ? BATCH_TERMS_MORE : BATCH_TERMS;

        for (j = 0; j < terms; j++) {
            (void)brdffit_batch_d(f, window->center + window->radius * node_place(j, terms), &u[j]);
        }
        interpolate(u, terms, window->u[more]);
        window->u_third[more] = third(window->u[more], terms);
    }
    for (j = 0; j < BATCH_TERMS_D; j++) {
        d[j] = brdffit_batch_d(f, window->center + window->radius * node_place(j, BATCH_TERMS_D), &unused);
    }
    interpolate(d, BATCH_TERMS_D, window->d);
    for (m = 0; m < f->distinct; m++) {
        double phi = kernel_exp(-f->c[m] * low), rest = remainder_of(f->c[m] * window->radius, BATCH_TERMS_D);

        h += f->bb[m] * phi * phi;
        h16 += 65536.0 * rest * f->bb[m] * phi * phi;
        u16 += rest * f->ab[m] * phi;
        u0 += f->ab[m] * phi;
        largest = fmax(largest, f->c[m] * high * phi);
    }
    rounding = TOL_UNIT * (ROUNDING + 16.0 * largest + 4.0 * (double)f->used) + 4.0 * snapped * largest;
    window->d_error = 1.01 * (h16 + 65536.0 * u16 * u0) +
                      (h + u0 * u0 + magnitude(window->d, BATCH_TERMS_D)) * rounding;
    window->d_third = third(window->d, BATCH_TERMS_D);
}

/*
 * Smallest sqrt(D) over its chord, piece by piece. With D >= d0 + d1 d - miss and chord = c (1 + rate d) on |d| <= h,
 * D c^2 / chord^2 >= (d0 + d1 d - miss) (1 - 2 rate d).
 */
static double chord_share(const struct batch_window *window, double root_low, double root_high)
{
    double least = 1.0, h = 1.0 / SCREEN_PIECES, slope = 0.5 * (root_high - root_low);
    int i, j;

    for (i = 0; i < SCREEN_PIECES; i++) {
        double t = -1.0 + h * (2.0 * i + 1.0), d[3] = {0.0, 0.0, 0.0}, chord, rate, miss, low;

        for (j = (int)BATCH_TERMS_D - 1; j >= 0; j--) {
            d[2] = d[2] * t + d[1];
            d[1] = d[1] * t + d[0];
            d[0] = d[0] * t + window->d[j];
        }
        chord = 0.5 * (root_high + root_low) + slope * t;
        rate = slope / chord;
        miss = fabs(d[2]) * h * h + window->d_third * h * h * h + window->d_error;
        low = d[0] - fabs(d[1] - 2.0 * rate * d[0]) * h - 2.0 * fabs(rate * d[1]) * h * h -
              miss * (1.0 + 2.0 * fabs(rate) * h);
        least = fmin(least, low > 0.0 ? sqrt(low) / chord : -1.0);
    }
    return least;
}

/* |b (phi - chord) less its part along a| at t, where the ends of the chord are given; 0 at the ends. */
static double off_chord(const struct batch_fast *f, const struct batch_window *window, double t)
{
    double low = window->center - window->radius, high = window->center + window->radius;
    double square = 0.0, along = 0.0;
    size_t m;

    for (m = 0; m < f->distinct; m++) {
        double chord = 0.5 * ((1.0 - t) * kernel_exp(-f->c[m] * low) + (1.0 + t) * kernel_exp(-f->c[m] * high));
        double off = chord - kernel_exp(-f->c[m] * (window->center + window->radius * t));

        square += f->bb[m] * (off * off);
        along += f->ab[m] * off;
    }
    return sqrt(fmax(square - along * along, 0.0) + 1e-12 * square);
}

/*
 * How a window is screened from its ends, whose D are given. The distance from the chord is taken at places that cut
 * the window evenly; between two of them it is at most the larger, by convexity, and what a chord of that length misses.
 */
static void fill_screen(struct batch_fast *f, size_t w, double d_low, double d_high)
{
    struct batch_window *window = &f->window[w];
    double low = window->center - window->radius, missed = 0.0, before = 0.0, root_low = sqrt(d_low);
    double root_high = sqrt(d_high);
    size_t m;
    int i;

    for (m = 0; m < f->distinct; m++) {
        double x = 2.0 * f->c[m] * window->radius / SCREEN_PIECES, phi = kernel_exp(-f->c[m] * low);

        missed += f->bb[m] * (x * x / 8.0 * phi) * (x * x / 8.0 * phi);
    }
    missed = sqrt(missed);
    window->delta = 0.0;
    for (i = 1; i <= SCREEN_PIECES; i++) {
        double share = (double)i / SCREEN_PIECES, last = share - 1.0 / SCREEN_PIECES;
        double here = i < SCREEN_PIECES ? off_chord(f, window, 2.0 * share - 1.0) : 0.0;
        double root = fmin(root_low + (root_high - root_low) * share, root_low + (root_high - root_low) * last);

        window->delta = fmax(window->delta, 1.01 * (fmax(here, before) + missed) / root);
        before = here;
    }
    window->delta += TOL_CURVATURE;
    window->shrink = chord_share(window, root_low, root_high) - TOL_CURVATURE;
}

void brdffit_batch_window(struct batch_fast *f, size_t w, double d_low, double d_high, double snapped)
{
    fill_shapes(f, w, 0, snapped);
    fill_shapes(f, w, 1, snapped);
    fill_geometry(f, w, snapped);
    fill_screen(f, w, d_low, d_high);
}
