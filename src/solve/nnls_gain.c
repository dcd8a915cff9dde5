/*
 * Restricted problem, Gram form, one at a time: see nnls.h, and gain.h for the mathematics.
 * SPDX-License-Identifier: MIT
 */
#include "kernels/gain.h"
#include "solve/nnls.h"

double brdffit_nnls_gain2(double p, double q, double kappa)
{
    vec clipped = gain_clip(vec_set(kappa));

    return gain2_vec(vec_set(p), vec_set(q), clipped, gain_inverse(clipped))[0];
}

double brdffit_nnls_gain3(const double cosine[3], const double t[3])
{
    struct gram3_vec gram = gram3_vec(vec_set(cosine[0]), vec_set(cosine[1]), vec_set(cosine[2]));

    return gain3_vec(&gram, vec_set(t[0]), vec_set(t[1]), vec_set(t[2]))[0];
}
