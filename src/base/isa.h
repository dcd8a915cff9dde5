/*
 * Which instruction sets this build has code for and this processor runs. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_ISA_H
#define BRDFFIT_ISA_H

#include "brdffit.h"

/* Whether code compiled for `isa` (not AUTO) can run here. */
int brdffit_isa_runs(brdffit_isa isa);

/* AUTO to the best that runs here, the others to themselves. */
brdffit_isa brdffit_isa_resolve(brdffit_isa isa);

#endif
