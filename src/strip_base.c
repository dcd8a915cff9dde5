/*
 * Strips for what the build targets anyway. Layer 1. SPDX-License-Identifier: MIT
 */
#define STRIP_KERNELS brdffit_strip_base
#include "strip_body.h"
