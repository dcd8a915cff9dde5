/*
 * Models with an anisotropic lobe in long double, from their formulas, and random samples for them: shares no code with the
 * library. For test_anisotropic.c. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_ANISOTROPIC_CASE_H
#define BRDFFIT_TESTS_ANISOTROPIC_CASE_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "brdffit.h"
#include "gain_reference.h"
#include "nnls_case.h"

#define AC_SAMPLES 64
#define AC_CHANNELS 3
#define AC_COLUMNS 5

struct anisotropic_case {
    size_t count, channels;
    double light[3 * AC_SAMPLES], view[3 * AC_SAMPLES], normal[3 * AC_SAMPLES], tangent[3 * AC_SAMPLES];
    double weights[AC_SAMPLES], values[AC_SAMPLES * AC_CHANNELS];
    brdffit_samples samples;
};

/* Two lobes at most: the first anisotropic, s_x and s_y; the other with s[2]. */
struct anisotropic_model {
    brdffit_distribution distribution[2];
    int lobes, fresnel;
    double turned; /* degrees */
};

static inline long double ac_dot(const long double *u, const long double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

static inline void ac_cross(const long double *u, const long double *v, long double *out)
{
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
}

static inline void ac_unit(const double *from, long double *out)
{
    long double length = sqrtl((long double)from[0] * from[0] + (long double)from[1] * from[1] +
                               (long double)from[2] * from[2]);
    int j;

    for (j = 0; j < 3; j++) {
        out[j] = from[j] / length;
    }
}

/* Angles of sample i as the formulas have them: n.l, n.v, v.h, n.h, and the half vector along and across the tangent. */
struct anisotropic_angles {
    long double nl, nv, vh, nh, along, across;
};

static inline struct anisotropic_angles ac_angles(const struct anisotropic_case *c, size_t i, double turned)
{
    long double l[3], v[3], n[3] = {0, 0, 1}, t[3] = {1, 0, 0}, b[3], h[3], length, x, y, a;
    struct anisotropic_angles out;
    int j;

    ac_unit(c->light + 3 * i, l);
    ac_unit(c->view + 3 * i, v);
    if (c->samples.normal) {
        ac_unit(c->normal + 3 * i, n);
        ac_unit(c->tangent + 3 * i, t);
        a = ac_dot(n, t);
        for (j = 0; j < 3; j++) {
            t[j] -= a * n[j];
        }
        length = sqrtl(ac_dot(t, t));
        for (j = 0; j < 3; j++) {
            t[j] /= length;
        }
    }
    ac_cross(n, t, b);
    for (j = 0; j < 3; j++) {
        h[j] = l[j] + v[j];
    }
    length = sqrtl(ac_dot(h, h));
    for (j = 0; j < 3; j++) {
        h[j] /= length;
    }
    out.nl = ac_dot(n, l);
    out.nv = ac_dot(n, v);
    out.vh = ac_dot(v, h);
    out.nh = ac_dot(n, h);
    x = ac_dot(t, h);
    y = ac_dot(b, h);
    a = turned * (acosl(-1.0L) / 180.0L);
    out.along = x * cosl(a) + y * sinl(a);
    out.across = y * cosl(a) - x * sinl(a);
    return out;
}

/* Radiance of a lobe at y = 1. s: along and across, equal where it is isotropic. */
static inline long double ac_lobe(brdffit_distribution distribution, const struct anisotropic_angles *g,
                                  const long double s[2])
{
    const long double pi = acosl(-1.0L);
    long double cos2 = g->nh * g->nh, sin2 = 1.0L - cos2, E, b;
    long double g1 = 2.0L * g->nh * g->nv / g->vh, g2 = 2.0L * g->nh * g->nl / g->vh, G = fminl(1.0L, fminl(g1, g2));
    long double tan_x = g->along / g->nh, tan_y = g->across / g->nh;

    E = tan_x * tan_x * s[0] + tan_y * tan_y * s[1];
    switch (distribution) {
    case BRDFFIT_GGX: return G / (pi * g->nv * cos2 * cos2) * sqrtl(s[0] * s[1]) / ((1.0L + E) * (1.0L + E));
    case BRDFFIT_WARD: return sqrtl(g->nl / g->nv) / (4.0L * pi) * sqrtl(s[0] * s[1]) * expl(-E);
    case BRDFFIT_ASHIKHMIN_SHIRLEY:
        E = sin2 > 0.0L ? (s[0] * g->along * g->along + s[1] * g->across * g->across) /
                              (g->along * g->along + g->across * g->across)
                        : 0.0L;
        b = g->nl / (g->vh * fmaxl(g->nl, g->nv));
        return b * sqrtl((s[0] + 1.0L) * (s[1] + 1.0L)) / (8.0L * pi) * powl(g->nh, E);
    default: return G / (pi * g->nv * cos2 * cos2) * sqrtl(s[0] * s[1]) * expl(-E);
    }
}

/* Column j of the model at sample i: 0 diffuse, then those of the lobes, one or two each. */
static inline long double ac_column(const struct anisotropic_case *c, const struct anisotropic_model *m, size_t i,
                                    int j, const long double *s)
{
    struct anisotropic_angles g = ac_angles(c, i, m->turned);
    int each = m->fresnel ? 2 : 1, p = (j - 1) / each;
    long double both[2];

    if (j == 0) {
        return g.nl / acosl(-1.0L);
    }
    both[0] = s[2 * p];
    both[1] = p == 0 ? s[1] : s[2];
    return ac_lobe(m->distribution[p], &g, both) * ((j - 1) % each ? powl(1.0L - g.vh, 5.0L) : 1.0L);
}

static inline int ac_columns(const struct anisotropic_model *m)
{
    return 1 + m->lobes * (m->fresnel ? 2 : 1);
}

/* Smallest E^2 at s (values are f_r; each channel by its largest radiance). */
static inline long double ac_objective(const struct anisotropic_case *c, const struct anisotropic_model *m,
                                       const long double *s)
{
    long double column[AC_COLUMNS][AC_SAMPLES], cosine[AC_COLUMNS * AC_COLUMNS], t[AC_COLUMNS], sum = 0.0L;
    int n = ac_columns(m), j, q;
    size_t i, k;

    for (j = 0; j < n; j++) {
        long double norm = 0.0L;

        for (i = 0; i < c->count; i++) {
            column[j][i] = sqrtl(c->weights[i]) * ac_column(c, m, i, j, s);
            norm += column[j][i] * column[j][i];
        }
        for (i = 0; i < c->count; i++) {
            column[j][i] = norm > 0.0L ? column[j][i] / sqrtl(norm) : 0.0L;
        }
    }
    for (j = 0; j < n; j++) {
        for (q = j + 1; q < n; q++) {
            long double dot = 0.0L;

            for (i = 0; i < c->count; i++) {
                dot += column[j][i] * column[q][i];
            }
            cosine[gr_entry(n, j, q)] = dot;
        }
    }
    for (k = 0; k < c->channels; k++) {
        long double most = 0.0L, value[AC_SAMPLES];

        for (i = 0; i < c->count; i++) {
            value[i] = c->values[i * c->channels + k] * ac_angles(c, i, 0.0).nl;
            most = fmaxl(most, value[i]);
        }
        for (j = 0; j < n; j++) {
            t[j] = 0.0L;
            for (i = 0; i < c->count; i++) {
                t[j] += column[j][i] * sqrtl(c->weights[i]) * value[i] / most;
            }
        }
        for (i = 0; i < c->count; i++) {
            sum += c->weights[i] * (value[i] / most) * (value[i] / most);
        }
        sum -= gr_gain(n, cosine, t);
    }
    return sum;
}

static inline void ac_direction(uint64_t *state, double least, double *out)
{
    double z = least + (1.0 - least) * case_uniform(state), phi = 6.283185307179586 * case_uniform(state);

    out[0] = sqrt(1.0 - z * z) * cos(phi);
    out[1] = sqrt(1.0 - z * z) * sin(phi);
    out[2] = z;
}

/* Lights above the horizon and half vectors about the normal, so that lobes are seen; random weights where asked. */
static inline void ac_make(struct anisotropic_case *c, uint64_t *state, size_t count, size_t channels, int weighted)
{
    size_t i = 0, j;

    memset(c, 0, sizeof *c);
    c->count = count;
    c->channels = channels;
    while (i < count) {
        double h[3], d = 0.0, alpha = 0.9 * case_uniform(state) * case_uniform(state);
        double phi = 6.283185307179586 * case_uniform(state);
        double *l = c->light + 3 * i, *v = c->view + 3 * i;

        h[0] = sin(alpha) * cos(phi);
        h[1] = sin(alpha) * sin(phi);
        h[2] = cos(alpha);
        ac_direction(state, 0.55, l);
        for (j = 0; j < 3; j++) {
            d += 2.0 * l[j] * h[j];
        }
        for (j = 0; j < 3; j++) {
            v[j] = d * h[j] - l[j];
        }
        c->weights[i] = weighted ? pow(10.0, 2.0 * case_signed(state)) : 1.0;
        i += v[2] > 0.1;
    }
    brdffit_samples_init(&c->samples);
    c->samples.form = BRDFFIT_FORM_DIRECTIONS;
    c->samples.count = count;
    c->samples.channels = channels;
    c->samples.light = c->light;
    c->samples.view = c->view;
    c->samples.values = c->values;
    c->samples.weights = weighted ? c->weights : NULL;
}

/* Values of f_r of the model, coefficients random and positive, with relative noise. */
static inline void ac_fill(struct anisotropic_case *c, const struct anisotropic_model *m, uint64_t *state,
                           const long double *s, double noise, double f0)
{
    size_t i, k;
    int j, each = m->fresnel ? 2 : 1;

    for (k = 0; k < c->channels; k++) {
        long double z[AC_COLUMNS];

        z[0] = 0.1 + 0.4 * case_uniform(state);
        for (j = 1; j < ac_columns(m); j++) {
            z[j] = (j - 1) % each ? z[j - 1] * (1.0L - f0) / f0 : 0.01 + 0.04 * case_uniform(state);
        }
        for (i = 0; i < c->count; i++) {
            long double value = 0.0L;

            for (j = 0; j < ac_columns(m); j++) {
                value += z[j] * ac_column(c, m, i, j, s);
            }
            c->values[i * c->channels + k] = (double)(value / ac_angles(c, i, 0.0).nl) *
                                             (1.0 + noise * case_signed(state));
        }
    }
}

#endif
