/*
 * Kernels for what the build targets anyway: SSE2 on x86-64, NEON on AArch64.
 * SPDX-License-Identifier: MIT
 */
#define KERNELS brdffit_kernels_base
#include "kernels/kernels_body.h"
