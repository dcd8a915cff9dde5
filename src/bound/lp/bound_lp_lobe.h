/*
 * Envelope of a lobe over an interval; only bound_lp.c calls it. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BOUND_LP_LOBE_H
#define BRDFFIT_BOUND_LP_LOBE_H

#include "bound/lp/bound_lp.h"

/* Fill engine->lobe[p] for theta in [low, high], with the centre's place. */
void brdffit_bound_lp_lobe(struct bound_lp *engine, int p, double low, double centre, double high);

#endif
