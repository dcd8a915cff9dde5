/*
 * Rows of geometry: (a, b, c) of each distribution from the same few angles. Layer 2. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_GEOMETRY_ROWS_H
#define BRDFFIT_GEOMETRY_ROWS_H

#include "geometry.h"

/* Fill out->a, b, c and cos_light; both cosines are above LIMIT_GRAZING, and the distribution is one of ours. */
void brdffit_geometry_row(brdffit_distribution distribution, const struct geometry_angles *angles,
                          struct geometry *out);

#endif
