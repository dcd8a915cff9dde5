/*
 * Quantile of chi-squared with one degree of freedom, with the same bits everywhere. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_CHI2_H
#define BRDFFIT_CHI2_H

#include "base/erf.h"

/*
 * The q with P(chi2_1 <= q) = erf(sqrt(q / 2)) = level, for level in (0, 1): 3.84 for 0.95. By bisection on erf, whose 1.5 ulp
 * make of the root of q an error of 2e-16 / density: below 1e-6 of it up to a level of 1 - 1e-9.
 */
static inline double chi2_quantile(double level)
{
    double low = 0.0, high = ERF_LEVEL;
    int i;

    for (i = 0; i < 100; i++) {
        double middle = 0.5 * (low + high);

        if (kernel_erf(middle) < level) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 2.0 * high * high;
}

#endif
