/*
 * What a plan holds for one lobe of an exponential family. Layer 5. SPDX-License-Identifier: MIT
 *
 * Let I be a channel's weighted data, a and b the weighted columns, omega = I.a / |a|, and r = I - omega a / |a|
 * what the diffuse term leaves. For s = 1 / sigma^2 and phi_m = exp(-c_m s), m over distinct c,
 *
 *     n_k(s) = sum_m r_km phi_m        r_km: sum of r b over the samples of c_m, known once per texel
 *     u(s)   = sum_m ab_m phi_m / |a|, H(s) = sum_m bb_m phi_m^2, D(s) = H - u^2 = |b phi - u a / |a||^2
 *
 * What channel k gains beyond omega^2 when x_k may have any sign is n_k^2 / D for n_k > 0, else 0. For any
 * lambda >= 0, 2 omega x + 2 lambda x replaces 2 omega x without lowering the maximum over x >= 0, so
 *
 *     J_k <= (omega + lambda)^2 + max(0, n_k - lambda u)^2 / D
 *
 * with equality at one s for lambda = max(0, max(0, u V / H) - omega), V = n_k + omega u. So "no s of an interval
 * gains more than Gamma" is   sum_k max(0, n_k - lambda_k u)^2 - (Gamma - sum lambda (2 omega + lambda)) D <= 0:
 * n, u and D are sums of exponentials and smooth, D and u are the plan's, n is linear in the data.
 *
 * The range of theta = ln s is cut into N windows of equal width. In each, exp(-c s) is a polynomial of 8 terms in t:
 * Chebyshev interpolation, whose error is below sup |f^(8)| / (8! 2^7) = x^8 exp(-c s_low) / 5160960 with
 * x = c radius; and one of 12, for data with so little noise that this is not enough. Summed against data by
 * Cauchy-Schwarz it is n_error |I_k|. D has its own of 16 terms: |D^(16)| <= sum bb (2 x)^16 phi^2 +
 * 2^16 (sum ab x^16 phi)(sum ab phi), phi at the low end, as (x + x')^16 <= 2^15 (x^16 + x'^16). The bound on a piece of a window is in many_lanes_bound.h.
 *
 * Screening of a whole window from its end nodes: with chords in s, n_k exceeds its chord by at most
 * |r_k| h4 width^2 / 8, h4^2 = sum bb c^4 phi(low)^2, and g = sqrt(D) falls below its chord by at most
 * width^2 / 8 H''(low) / (2 inf g). Ratios of linear functions lie between their ends, and the norm over channels
 * of positive parts is convex, so   J <= (sqrt(max J at the ends) + delta |r|)^2 / shrink^2.
 */
#include "many_fast.h"

#include <math.h>

#include "fit.h"
#include "geometry.h"
#include "isa.h"
#include "kernel_exp.h"
#include "kernel_log.h"
#include "tolerance.h"

/* Tables grow with these; beyond, the general path is the better one. */
#define MOST_DISTINCT 512u
#define MOST_SAMPLES 8192u
#define MOST_CHANNELS 32u
#define MOST_WINDOWS 64u
/* Width of a window in theta: the error of its polynomials, about 1e-8 |I|, falls with its 8th power. */
#define WINDOW 0.375
/* Largest c_min s: y stays far from overflow (fit_domain.c). */
#define MOST_EXPONENT 200.0
/* Rounding of polynomial coefficients and their use, in u relative to the sum of their magnitudes: an error of a
 * Chebyshev coefficient, a few u of the largest value, counts once whatever the degree; the rest are sums of terms. */
#define ROUNDING 4096.0
/* Pieces that D is compared with its chord on. */
#define SCREEN_PIECES 32

int brdffit_many_fast_possible(const brdffit_options *o)
{
    return o->norm == BRDFFIT_NORM_L2 && o->engine == BRDFFIT_ENGINE_MOMENT && o->lobes == 1 &&
           brdffit_family_of(o->distribution)->exponential && o->sigma_resolution == 0.0 && o->box_budget >= 1000;
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

void brdffit_many_fast_layout(struct many_fast *f, struct arena *arena, size_t count)
{
    size_t m = PADDED(least(count, MOST_DISTINCT)), nodes = PADDED(MOST_WINDOWS + 1);

    f->sample = brdffit_arena_take(arena, count, sizeof *f->sample);
    f->begin = brdffit_arena_take(arena, m + 1, sizeof *f->begin);
    f->a = ARENA_DOUBLES(arena, count);
    f->b = ARENA_DOUBLES(arena, count);
    f->factor = ARENA_DOUBLES(arena, count);
    f->radiance = ARENA_DOUBLES(arena, count);
    f->c = ARENA_DOUBLES(arena, m);
    f->bb = ARENA_DOUBLES(arena, m);
    f->ab = ARENA_DOUBLES(arena, m);
    f->phi = ARENA_DOUBLES(arena, nodes * m);
    f->inverse_d = ARENA_DOUBLES(arena, nodes);
    f->shape[0] = ARENA_DOUBLES(arena, MOST_WINDOWS * m * MANY_TERMS);
    f->shape[1] = ARENA_DOUBLES(arena, MOST_WINDOWS * m * MANY_STRIDE_MORE);
    f->window = brdffit_arena_take(arena, MOST_WINDOWS, sizeof *f->window);
}

void brdffit_many_tile_layout(struct many_tile *t, struct arena *arena, size_t count, size_t channels)
{
    size_t m = PADDED(least(count, MOST_DISTINCT)), nodes = PADDED(MOST_WINDOWS + 1);
    size_t n = least(count, MOST_SAMPLES), K = least(channels, MOST_CHANNELS);

    t->value = ARENA_DOUBLES(arena, n * K * LANES);
    t->sum = ARENA_DOUBLES(arena, K * m * LANES);
    t->gain = ARENA_DOUBLES(arena, nodes * LANES);
    t->scale = ARENA_DOUBLES(arena, K * LANES);
    t->omega = ARENA_DOUBLES(arena, K * LANES);
    t->ii = ARENA_DOUBLES(arena, K * LANES);
    t->x = ARENA_DOUBLES(arena, K * LANES);
    t->y = ARENA_DOUBLES(arena, K * LANES);
    t->n = ARENA_DOUBLES(arena, K * MANY_TERMS * LANES);
    t->work = ARENA_DOUBLES(arena, K * (MANY_STRIDE_MORE + 4));
    t->phi = ARENA_DOUBLES(arena, m * LANES);
    t->scan.largest = ARENA_DOUBLES(arena, K * LANES);
    t->scan.magnitude = ARENA_DOUBLES(arena, K * LANES);
}

void brdffit_many_fast_scratch(struct reduced *r, double **values, struct arena *arena, size_t count)
{
    brdffit_reduce_layout(r, arena, count, 1);
    *values = ARENA_DOUBLES(arena, count);
}

/* ---- functions of s ---- */

/* |b phi - u a / |a||^2 from the samples themselves: no cancellation. *h, *u: H and u, or NULL. */
static double d_of(const struct many_fast *f, double s, double *u_of_s)
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
    static const double of8[8] = {1.0, 0.980785280403230449, 0.923879532511286756, 0.831469612302545237, 0.707106781186547524, 0.555570233019602225, 0.382683432365089772, 0.195090322016128268};
    static const double of12[12] = {1.0, 0.991444861373810411, 0.965925826289068287, 0.923879532511286756, 0.866025403784438647, 0.793353340291235165, 0.707106781186547524, 0.608761429008720639, 0.5, 0.382683432365089772, 0.258819045102520762, 0.130526192220051592};
    static const double of16[16] = {1.0, 0.995184726672196886, 0.980785280403230449, 0.956940335732208865, 0.923879532511286756, 0.88192126434835503, 0.831469612302545237, 0.773010453362736961, 0.707106781186547524, 0.634393284163645498, 0.555570233019602225, 0.471396736825997649, 0.382683432365089772, 0.290284677254462368, 0.195090322016128268, 0.098017140329560602};
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
    double t0[MANY_TERMS_D] = {1.0}, t1[MANY_TERMS_D] = {0.0, 1.0}, next[MANY_TERMS_D];
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

    return 1.01 * (terms == MANY_TERMS        ? x8 / 5160960.0
                   : terms == MANY_TERMS_MORE ? x8 * x4 / (479001600.0 * 2048.0)
                                              : x8 * x8 / (20922789888000.0 * 32768.0));
}

/* exp(-c_m s) over window w, and the errors of it, n and u; with more terms or not. */
static void fill_shapes(struct many_fast *f, size_t w, int more, double snapped)
{
    struct many_window *window = &f->window[w];
    double low = window->center - window->radius, high = window->center + window->radius;
    double n2 = 0.0, u = 0.0;
    size_t terms = more ? MANY_TERMS_MORE : MANY_TERMS, stride = more ? MANY_STRIDE_MORE : MANY_TERMS, m, j;

    for (m = 0; m < f->distinct; m++) {
        double *shape = f->shape[more] + (w * f->distinct + m) * stride, value[MANY_TERMS_MORE], error, size;
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
static void fill_geometry(struct many_fast *f, size_t w, double snapped)
{
    struct many_window *window = &f->window[w];
    double d[MANY_TERMS_D], u[MANY_TERMS_D], unused, low = window->center - window->radius;
    double high = window->center + window->radius;
    double h16 = 0.0, u16 = 0.0, u0 = 0.0, h = 0.0, largest = 0.0, rounding;
    size_t j, m;
    int more;

    for (more = 0; more < 2; more++) {
        size_t terms = more ? MANY_TERMS_MORE : MANY_TERMS;

        for (j = 0; j < terms; j++) {
            (void)d_of(f, window->center + window->radius * node_place(j, terms), &u[j]);
        }
        interpolate(u, terms, window->u[more]);
        window->u_third[more] = third(window->u[more], terms);
    }
    for (j = 0; j < MANY_TERMS_D; j++) {
        d[j] = d_of(f, window->center + window->radius * node_place(j, MANY_TERMS_D), &unused);
    }
    interpolate(d, MANY_TERMS_D, window->d);
    for (m = 0; m < f->distinct; m++) {
        double phi = kernel_exp(-f->c[m] * low), rest = remainder_of(f->c[m] * window->radius, MANY_TERMS_D);

        h += f->bb[m] * phi * phi;
        h16 += 65536.0 * rest * f->bb[m] * phi * phi;
        u16 += rest * f->ab[m] * phi;
        u0 += f->ab[m] * phi;
        largest = fmax(largest, f->c[m] * high * phi);
    }
    rounding = TOL_UNIT * (ROUNDING + 16.0 * largest + 4.0 * (double)f->used) + 4.0 * snapped * largest;
    window->d_error = 1.01 * (h16 + 65536.0 * u16 * u0) + (h + u0 * u0 + magnitude(window->d, MANY_TERMS_D)) * rounding;
    window->d_third = third(window->d, MANY_TERMS_D);
}

/* Smallest sqrt(D) over its chord from root_low to root_high, piece by piece. */
static double chord_share(const struct many_window *window, double root_low, double root_high)
{
    double least = 1.0, h = 1.0 / SCREEN_PIECES;
    int i, j;

    for (i = 0; i < SCREEN_PIECES; i++) {
        double t = -1.0 + h * (2.0 * i + 1.0), d[3] = {0.0, 0.0, 0.0}, low, chord, slope = 0.5 * (root_high - root_low);

        for (j = (int)MANY_TERMS_D - 1; j >= 0; j--) {
            d[2] = d[2] * t + d[1];
            d[1] = d[1] * t + d[0];
            d[0] = d[0] * t + window->d[j];
        }
        chord = 0.5 * (root_high + root_low) + slope * t;
        /* Of D / chord^2: chord^2 is taken out at the middle, with its slope, so that only curvature is lost. */
        low = d[0] - fabs(d[1] - 2.0 * d[0] * slope / chord) * h - (fabs(d[2]) + 3.0 * d[0] * slope * slope / (chord * chord) +
              2.0 * fabs(d[1] * slope / chord)) * h * h - window->d_third * h * h * h - window->d_error;
        least = fmin(least, low > 0.0 ? sqrt(low) / chord : -1.0);
    }
    return least;
}

/* |b (phi - chord) less its part along a| at t, where the ends of the chord are given; 0 at the ends. */
static double off_chord(const struct many_fast *f, const struct many_window *window, double t)
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
static void fill_screen(struct many_fast *f, size_t w, double d_low, double d_high)
{
    struct many_window *window = &f->window[w];
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

/* ---- the plan ---- */

/* What turns a value of sample i, which counts, into radiance. */
static double radiance_of(const brdffit_samples *geometry, brdffit_distribution distribution, size_t i)
{
    struct geometry g = {0.0, 0.0, 0.0, 1.0};
    brdffit_status status;

    if (geometry->quantity == BRDFFIT_QUANTITY_RADIANCE) {
        return 1.0;
    }
    (void)brdffit_geometry_sample(geometry, distribution, 0.0, i, &g, &status, NULL);
    return g.cos_light;
}

/* Samples in order of c, their sums, scales. */
static void keep_samples(struct many_fast *f, const struct reduced *r, const brdffit_samples *geometry,
                         brdffit_distribution distribution)
{
    size_t place, m = 0;

    f->used = r->used;
    f->channels = geometry->channels;
    f->distinct = r->distinct;
    f->root_a = sqrt(r->aa);
    f->c_min = r->c_min;
    f->scale_a = r->scale_a;
    f->scale_b = r->scale_b;
    f->scale_w = r->scale_w;
    f->slack = TOL_UNIT * (8.0 * (TOL_MOMENT_BASE + (double)r->used) + 2.0 * TOL_GAIN);
    for (place = 0; place < r->used; place++) {
        uint32_t j = r->order[place];

        while (m < r->distinct && r->sample_c[j] - r->c_min > r->c[m]) {
            f->begin[++m] = (uint32_t)place;
        }
        f->sample[place] = r->sample[j];
        f->a[place] = r->sample_a[j];
        f->b[place] = r->sample_b[j];
        f->factor[place] = r->sample_factor[j];
        f->radiance[place] = radiance_of(geometry, distribution, r->sample[j]);
    }
    f->begin[0] = 0;
    while (m < r->distinct) {
        f->begin[++m] = (uint32_t)place;
    }
    for (m = 0; m < PADDED(f->distinct); m++) {
        f->c[m] = r->c[m];
        f->bb[m] = r->bb[m];
        f->ab[m] = f->root_a > 0.0 ? r->linear[m] / f->root_a : 0.0;
    }
}

/* Nodes and windows over [theta_low, theta_high]; 0 when D is lost in rounding somewhere. */
static int fill_tables(struct many_fast *f, double theta_low, double theta_high, double snapped)
{
    double d_before = 0.0, s_before = 0.0;
    size_t w, m, node;

    for (node = 0; node <= f->windows; node++) {
        double s = kernel_exp(node == f->windows ? theta_high
                                                 : theta_low + (theta_high - theta_low) *
                                                                   ((double)node / (double)f->windows));
        double u, d = d_of(f, s, &u);

        if (!(d > 1e-6 * (d + u * u))) {
            return 0;
        }
        f->inverse_d[node] = 1.0 / d;
        for (m = 0; m < f->distinct; m++) {
            f->phi[(node / LANES * f->distinct + m) * LANES + node % LANES] = kernel_exp(-f->c[m] * s);
        }
        if (node > 0) {
            w = node - 1;
            f->window[w].center = 0.5 * (s_before + s);
            f->window[w].radius = 0.5 * (s - s_before) * (1.0 + 1e-15); /* covers its ends whatever was rounded */
            fill_shapes(f, w, 0, snapped);
            fill_shapes(f, w, 1, snapped);
            fill_geometry(f, w, snapped);
            fill_screen(f, w, d_before, d);
        } else {
            f->s_low = s;
        }
        d_before = d;
        s_before = s;
    }
    for (; node < f->nodes; node++) {
        f->inverse_d[node] = 0.0;
        for (m = 0; m < f->distinct; m++) {
            f->phi[(node / LANES * f->distinct + m) * LANES + node % LANES] = 0.0;
        }
    }
    return 1;
}

int brdffit_many_fast_start(struct many_fast *f, const brdffit_samples *geometry, const brdffit_options *o,
                            struct reduced *r, double *values)
{
    const struct family *family = brdffit_family_of(o->distribution);
    brdffit_samples samples = *geometry;
    double theta_low, theta_high, tail;
    size_t i;

    for (i = 0; i < geometry->count; i++) {
        values[i] = 0.0;
    }
    samples.values = values;
    samples.channels = 1;
    if (geometry->channels > MOST_CHANNELS || brdffit_reduce(r, &samples, o, NULL) != BRDFFIT_OK ||
        r->distinct > MOST_DISTINCT || r->distinct < 2 || r->used > MOST_SAMPLES || !(r->bb[0] > 0.0)) {
        return 0;
    }
    theta_low = family->by_exponent ? kernel_log(o->exponent_min) : -2.0 * kernel_log(o->sigma_max);
    theta_high = family->by_exponent ? kernel_log(o->exponent_max) : -2.0 * kernel_log(o->sigma_min);
    tail = family->tail(r->c, r->bb, r->distinct, r->c_min);
    if (!(tail > 0.0 && isfinite(tail))) {
        return 0;
    }
    theta_high = fmin(theta_high, kernel_log(tail));
    if (!(theta_high > theta_low && r->c_min * kernel_exp(theta_high) <= MOST_EXPONENT)) {
        return 0;
    }
    f->family = family;
    f->windows = (size_t)fmin(fmax(1.0, ceil((theta_high - theta_low) / WINDOW)), (double)MOST_WINDOWS);
    f->nodes = PADDED(f->windows + 1);
    keep_samples(f, r, geometry, o->distribution);
    return fill_tables(f, theta_low, theta_high, r->snapped);
}

const struct many_kernels *brdffit_many_kernels(brdffit_isa isa)
{
    isa = brdffit_isa_resolve(isa);
    switch (isa) {
#ifdef BRDFFIT_HAVE_AVX2
    case BRDFFIT_ISA_AVX2:
        return &brdffit_many_kernels_avx2;
#endif
#ifdef BRDFFIT_HAVE_AVX512
    case BRDFFIT_ISA_AVX512:
        return &brdffit_many_kernels_avx512;
#endif
    default:
        return &brdffit_many_kernels_base;
    }
}
