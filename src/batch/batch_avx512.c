/*
 * Tiles for AVX512; empty unless the build compiles this file for it (Makefile).
 * SPDX-License-Identifier: MIT
 */
#ifdef __AVX512F__
#define BATCH_KERNELS brdffit_batch_kernels_avx512
#include "batch/batch_body.h"
#else
typedef int many_kernels_avx512_is_empty;
#endif
