/*
 * Names of weightings, and what weights amount to. SPDX-License-Identifier: MIT
 */
#include "base/vector.h"
#include "weight/weights.h"

const char *brdffit_weighting_string(brdffit_weighting weighting)
{
    static const char *const text[BRDFFIT_WEIGHTING_COUNT] = {"none", "column", "cosine", "solid-angle", "relative"};

    return (unsigned)weighting < BRDFFIT_WEIGHTING_COUNT ? text[weighting] : "unknown";
}

/* In units of the largest, so that nothing overflows. */
double brdffit_weights_share(const double *weights, size_t count)
{
    double largest = vector_largest(weights, weights ? count : 0), sum = 0.0, squares = 0.0;
    size_t i;

    for (i = 0; i < count && largest > 0.0; i++) {
        double w = weights[i] / largest;

        sum += w;
        squares += w * w;
    }
    return squares > 0.0 ? sum * sum / (squares * (double)count) : 0.0;
}
