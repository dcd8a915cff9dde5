/*
 * Strips for AVX2; empty unless the build compiles this file for it (Makefile). Layer 1.
 * SPDX-License-Identifier: MIT
 */
#ifdef __AVX2__
#define STRIP_KERNELS brdffit_strip_avx2
#include "strip_body.h"
#else
typedef int strip_avx2_is_empty;
#endif
