/*
 * Tiles for AVX2; empty unless the build compiles this file for it (Makefile).
 * SPDX-License-Identifier: MIT
 */
#ifdef __AVX2__
#define BATCH_KERNELS brdffit_batch_kernels_avx2
#include "batch/batch_body.h"
#else
typedef int many_kernels_avx2_is_empty;
#endif
