/*
 * Physical bounds (theory 7.9): what each coefficient of a model counts for in x + sum of reflectances <= 1, for columns of
 * the reduced data. Reflectances are x of every diffuse column, and y times lobe_kind.reflectance; none is negative, so that
 * each of them is at most 1 where their sum is. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_PHYSICAL_H
#define BRDFFIT_PHYSICAL_H

#include "base/wide.h"
#include "data/reduce.h"

/* What a coefficient of a column in internal units counts for, but for a channel's unit. */
struct wide brdffit_physical_fixed(const struct reduced *data, int column);
struct wide brdffit_physical_lobe(const struct lobe_kind *kind, const struct table *table, double theta);

/* Not above that of any theta in [low, high], but for rounding: lambda and the conversion rise with s, phi falls. */
struct wide brdffit_physical_least(const struct lobe_kind *kind, const struct table *table, double low, double high);

/* The same of channel k and a column of this norm taken as a unit one, in [0, infinity]; 0 where the norm is. */
double brdffit_physical_unit(const struct reduced *data, struct wide counts, double norm, size_t k);

#endif
