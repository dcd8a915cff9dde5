/*
 * Tiles for what the build targets anyway. SPDX-License-Identifier: MIT
 */
#define BATCH_KERNELS brdffit_batch_kernels_base
#include "batch/batch_body.h"
