/*
 * Smith masking at one value of u: what every sample shares (model/smith.h has the mathematics and fills it in).
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_SMITH_POINT_H
#define BRDFFIT_SMITH_POINT_H

struct smith_point {
    double u;
    double kappa, widest; /* u = s / (1 + kappa s); M, above every tan^2 */
    double level, rate;   /* T = M + rate u, rate = 1 - kappa M */
    double scale;         /* phi is the shape of the normals times this over a denominator */

    /* GGX */
    double v, fall,
        bend; /* shape (1 + c v)^-2: v = u f, f = 1 / (1 + (c_min - kappa) u), fall = f^2, bend = 2 (c_min - kappa) f */

    /* Beckmann */
    double share; /* u / M, at most SMITH_SHARE_MOST */
    double first, second; /* M / (2 u T) and M / (4 u^2 T) */
};

/* exp(-u / tan^2) is 0 beyond this exponent (exp.h flushes at 708): normal incidence is taken to be there. */
#define SMITH_EXPONENT_MOST 900.0
/* Where u / M is larger, that exponent is, for every sample (M >= 4 tan^2). */
#define SMITH_SHARE_MOST 225.0

#endif
