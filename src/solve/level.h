/*
 * How far linear functionals of the coefficients reach over those that gain at least so much (theory 7.10).
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_LEVEL_H
#define BRDFFIT_LEVEL_H

#include "solve/nnls.h"

/* The set { z >= 0 : 2 t.z - z'Mz >= gain }, M as of brdffit_nnls_gain(), with what is asked of it: one or two columns. */
struct level {
    int columns; /* 2 to 7 */
    const double *cosine, *t;
    double gain;
    int asked[2]; /* columns; asked[1] < 0: there is one */
    double second; /* weight of the second, >= 0; that of the first is 1 */
};

/*
 * sense = 1: at least the supremum of z[asked[0]] + second z[asked[1]] over the set; sense = -1: at least that of its
 * negative. -INFINITY where the set is proven empty. When it is known to be at most `enough` the value may be anything in
 * between. *multiplier: 0, or where a similar problem was decided; receives where this one was.
 */
double brdffit_level_reach(const struct level *level, int sense, double enough, double *multiplier);

/*
 * At least the supremum of f in [0, 1] such that the set has a z with (1 - f) z[asked[0]] >= f ratio z[asked[1]]; ratio in
 * [0, infinity). -INFINITY where the set is proven empty; when it is known to be at most `enough`, `enough`.
 */
double brdffit_level_share(const struct level *level, double ratio, double enough);

/*
 * The same from inside, for M that is a Gram matrix of at least rank 1: z of the set with a functional near the supremum.
 * Returns 0, and nothing in z, where none is found.
 */
int brdffit_level_attain(const struct level *level, int sense, double z[NNLS_COLUMNS]);

#endif
