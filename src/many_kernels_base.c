/*
 * Tiles for what the build targets anyway. Layer 5. SPDX-License-Identifier: MIT
 */
#define MANY_KERNELS brdffit_many_kernels_base
#include "many_kernels_body.h"
