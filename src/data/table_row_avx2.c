/*
 * Strips for AVX2; empty unless the build compiles this file for it (Makefile).
 * SPDX-License-Identifier: MIT
 */
#ifdef __AVX2__
#define TABLE_ROW_KERNELS brdffit_table_row_avx2
#include "data/table_row_body.h"
#else
typedef int strip_avx2_is_empty;
#endif
