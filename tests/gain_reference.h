/*
 * R(t, M) of up to seven columns in long double, by trying every support.
 * SPDX-License-Identifier: MIT
 */
#ifndef GAIN_REFERENCE_H
#define GAIN_REFERENCE_H

#include <math.h>

#include "base/tolerance.h"

#define GR_COLUMNS 7

/* Entry i < j of the off-diagonals 01, 02, .., 12, .. */
static inline int gr_entry(int n, int i, int j)
{
    return i * n - i * (i + 1) / 2 + j - i - 1;
}

/* As bounds use them: in [0, LIMIT_COSINE]. */
static inline long double gr_clip(long double cosine)
{
    return cosine > (long double)LIMIT_COSINE ? (long double)LIMIT_COSINE : cosine > 0.0L ? cosine : 0.0L;
}

/* 2 t.z - z'M z at the stationary point of a support, or -1 where that is no maximum of its face. */
static inline long double gr_support(int n, const long double *cosine, const long double *t, unsigned support)
{
    long double lower[GR_COLUMNS][GR_COLUMNS], d[GR_COLUMNS], z[GR_COLUMNS], value = 0.0L;
    int index[GR_COLUMNS], m = 0, i, j, k;

    for (j = 0; j < n; j++) {
        if (support >> j & 1) {
            index[m++] = j;
        }
    }
    for (j = 0; j < m; j++) {
        d[j] = 1.0L;
        z[j] = t[index[j]];
        for (k = 0; k < j; k++) {
            d[j] -= lower[j][k] * lower[j][k] * d[k];
            z[j] -= lower[j][k] * z[k];
        }
        if (!(d[j] > 0.0L)) {
            return -1.0L;
        }
        for (i = j + 1; i < m; i++) {
            lower[i][j] = gr_clip(cosine[gr_entry(n, index[j], index[i])]);
            for (k = 0; k < j; k++) {
                lower[i][j] -= lower[i][k] * lower[j][k] * d[k];
            }
            lower[i][j] /= d[j];
        }
    }
    for (j = m; j-- > 0;) {
        z[j] /= d[j];
        for (k = j + 1; k < m; k++) {
            z[j] -= lower[k][j] * z[k];
        }
        if (!(z[j] > 0.0L)) {
            return -1.0L;
        }
    }
    for (i = 0; i < m; i++) {
        value += z[i] * (2.0L * t[index[i]] - z[i]);
        for (k = i + 1; k < m; k++) {
            value -= 2.0L * z[i] * z[k] * gr_clip(cosine[gr_entry(n, index[i], index[k])]);
        }
    }
    return value;
}

static inline long double gr_gain(int n, const long double *cosine, const long double *t)
{
    long double best = 0.0L;
    unsigned support;

    for (support = 1; support < 1u << n; support++) {
        long double here = gr_support(n, cosine, t, support);

        best = here > best ? here : best;
    }
    return best;
}

/* Rounding that the bounds allow R for n columns, relative to |t|^2. */
static inline long double gr_allowed(int n)
{
    return TOL_GAIN * (n > 3 ? TOL_GAIN_COLUMNS : 1.0L) * TOL_UNIT;
}

#endif
