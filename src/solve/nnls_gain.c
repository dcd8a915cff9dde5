/*
 * Restricted problem, Gram form, one at a time: see nnls.h, and gain.h and gain_n.h for the mathematics.
 * SPDX-License-Identifier: MIT
 */
#include "kernels/gain_n.h"
#include "solve/nnls.h"

static double gain2(double kappa, const double *t)
{
    vec clipped = gain_clip(vec_set(kappa));

    return gain2_vec(vec_set(t[0]), vec_set(t[1]), clipped, gain_inverse(clipped))[0];
}

static double gain3(const double *cosine, const double *t)
{
    struct gram3_vec gram = gram3_vec(vec_set(cosine[0]), vec_set(cosine[1]), vec_set(cosine[2]));

    return gain3_vec(&gram, vec_set(t[0]), vec_set(t[1]), vec_set(t[2]))[0];
}

LANES_INLINE double gain_n(const unsigned columns, const double *cosine, const double *t)
{
    vec entry[GAIN_COLUMNS * (GAIN_COLUMNS - 1) / 2], lanes[GAIN_COLUMNS];
    struct gram_n gram;
    unsigned i;

    for (i = 0; i < columns * (columns - 1) / 2; i++) {
        entry[i] = vec_set(cosine[i]);
    }
    for (i = 0; i < columns; i++) {
        lanes[i] = vec_set(t[i]);
    }
    gram_n_make(&gram, entry, columns);
    return gain_n_vec(&gram, lanes, columns)[0];
}

double brdffit_nnls_gain(int columns, const double *cosine, const double *t)
{
    switch (columns) {
    case 2: return gain2(cosine[0], t);
    case 3: return gain3(cosine, t);
#if COLUMNS_MOST > 4
    case 5: return gain_n(5, cosine, t);
#endif
#if COLUMNS_MOST > 5
    case 6: return gain_n(6, cosine, t);
#endif
#if COLUMNS_MOST > 6
    case 7: return gain_n(7, cosine, t);
#endif
    default: return gain_n(4, cosine, t);
    }
}
