/*
 * Restricted problem, Gram form, one at a time: see nnls.h, and gain.h for the mathematics. Layer 1.
 * SPDX-License-Identifier: MIT
 */
#include "gain.h"
#include "nnls.h"

double brdffit_nnls_gain2(double p, double q, double kappa)
{
    lanes clipped = gain_clip(lanes_set(kappa));

    return gain2_lanes(lanes_set(p), lanes_set(q), clipped, gain_inverse(clipped))[0];
}

double brdffit_nnls_gain3(const double cosine[3], const double t[3])
{
    struct gram3_lanes gram = gram3_lanes(lanes_set(cosine[0]), lanes_set(cosine[1]), lanes_set(cosine[2]));

    return gain3_lanes(&gram, lanes_set(t[0]), lanes_set(t[1]), lanes_set(t[2]))[0];
}
