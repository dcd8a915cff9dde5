/*
 * Tiles for AVX512; empty unless the build compiles this file for it (Makefile). Layer 5.
 * SPDX-License-Identifier: MIT
 */
#ifdef __AVX512F__
#define MANY_KERNELS brdffit_many_kernels_avx512
#include "many_kernels_body.h"
#else
typedef int many_kernels_avx512_is_empty;
#endif
