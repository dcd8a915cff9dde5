/*
 * Kernels for AVX512; empty unless the build compiles this file for it (Makefile).
 * SPDX-License-Identifier: MIT
 */
#ifdef __AVX512F__
#define KERNELS brdffit_kernels_avx512
#include "kernels/kernels_body.h"
#else
typedef int kernels_avx512_is_empty;
#endif
