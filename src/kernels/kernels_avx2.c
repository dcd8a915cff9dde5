/*
 * Kernels for AVX2; empty unless the build compiles this file for it (Makefile).
 * SPDX-License-Identifier: MIT
 */
#ifdef __AVX2__
#define KERNELS brdffit_kernels_avx2
#include "kernels/kernels_body.h"
#else
typedef int kernels_avx2_is_empty;
#endif
