/*
 * Masking and shadowing of microfacets. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_MASKING_H
#define BRDFFIT_MASKING_H

#include <math.h>

#include "base/vector.h"
#include "model/geometry.h"

static inline double cos2_half(const struct geometry_angles *g)
{
    return 1.0 / (1.0 + g->tan2_half);
}

/* V-cavities, as the paper has it: G = min{1, 2 (n.h)(n.v) / (v.h), 2 (n.h)(n.l) / (v.h)}. It does not depend on s. */
static inline double masking_v_cavity(const struct geometry_angles *g)
{
    double shared = 2.0 * sqrt(cos2_half(g)) / g->cos_difference;

    return smaller(1.0, shared * smaller(g->cos_view, g->cos_light));
}

#endif
