/*
 * Strips for what the build targets anyway. SPDX-License-Identifier: MIT
 */
#define TABLE_ROW_KERNELS brdffit_table_row_base
#include "data/table_row_body.h"
