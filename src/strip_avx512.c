/*
 * Strips for AVX512; empty unless the build compiles this file for it (Makefile). Layer 1.
 * SPDX-License-Identifier: MIT
 */
#ifdef __AVX512F__
#define STRIP_KERNELS brdffit_strip_avx512
#include "strip_body.h"
#else
typedef int strip_avx512_is_empty;
#endif
