/*
 * Exponential lobes: see exponential.h. SPDX-License-Identifier: MIT
 */
#include "model/exponential.h"

#include <math.h>

#include "base/exp.h"
#include "base/tolerance.h"
#include "model/weight.h"

void brdffit_exponential_variable(const struct lobe_sight *sight, double theta, double u[3])
{
    (void)sight;
    u[0] = kernel_exp(theta);
    u[1] = u[0];
    u[2] = u[0];
}

double brdffit_exponential_argument(const struct lobe_sight *sight, double s)
{
    (void)sight;
    return s;
}

void brdffit_exponential_slope(double c, double u, double *ell, double *slope)
{
    (void)u;
    *ell = -c;
    *slope = 0.0;
}

double brdffit_exponential_tail(const struct lobe_sight *sight, const double *bb, size_t m)
{
    const double *c = sight->c;
    double least = weight_least_c(c, bb, m), sharpest = weight_sharpest(c, bb, m, least), tail = 0.0, most = 0.0, cap;
    size_t j;

    for (j = 0; j < m; j++) {
        most = c[j] > least && bb[j] > most ? bb[j] : most;
    }
    cap = most > 0.0 ? TAIL_EXPONENT + weight_exponent(most, sharpest, m) : 0.0;
    for (j = 0; j < m; j++) {
        if (c[j] > least && bb[j] > 0.0 && cap > tail * (c[j] - least)) { /* else it cannot matter */
            tail = fmax(tail, (TAIL_EXPONENT + weight_exponent(bb[j], sharpest, m)) / (c[j] - least));
        }
    }
    return tail;
}

double brdffit_exponential_exponent(double c_min, double s)
{
    return c_min * s;
}

struct wide brdffit_exponential_phi(struct twofold s, double c)
{
    return wide_exp_minus(twofold_times(s, c));
}

double brdffit_exponential_sensitivity(double s, double c)
{
    (void)c;
    return s;
}

void brdffit_exponential_shape(const struct kernels *kernels, const struct lobe_sight *sight, size_t n, double u,
                               double *phi)
{
    kernels->exponential_shape(sight->c, n, u, phi);
}
