/*
 * Tiles for AVX2; empty unless the build compiles this file for it (Makefile). Layer 5.
 * SPDX-License-Identifier: MIT
 */
#ifdef __AVX2__
#define MANY_KERNELS brdffit_many_kernels_avx2
#include "many_kernels_body.h"
#else
typedef int many_kernels_avx2_is_empty;
#endif
