/*
 * Strips for AVX512; empty unless the build compiles this file for it (Makefile).
 * SPDX-License-Identifier: MIT
 */
#ifdef __AVX512F__
#define TABLE_ROW_KERNELS brdffit_table_row_avx512
#include "data/table_row_body.h"
#else
typedef int strip_avx512_is_empty;
#endif
