/*
 * A point of the domain. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_POINT_H
#define BRDFFIT_POINT_H

/* The coordinate of each lobe: theta = ln s. */
struct point {
    double theta[2];
};

#endif
