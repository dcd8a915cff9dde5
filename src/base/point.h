/*
 * A point of the domain. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_POINT_H
#define BRDFFIT_POINT_H

#include "base/ieee.h"
#include "brdffit.h"

/* Most sides that a box can have: shape coordinates of all lobes together, one a lobe. */
#define SIDES_MOST BRDFFIT_MAX_LOBES

/* The coordinate of each side: theta = ln s. */
struct point {
    double theta[SIDES_MOST];
};

#endif
