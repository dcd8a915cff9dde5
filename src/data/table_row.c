/*
 * The strip functions of an instruction set: see table_row.h. SPDX-License-Identifier: MIT
 */
#include "data/table_row.h"

#include "base/isa.h"

const struct table_row_kernels *brdffit_table_row_kernels(brdffit_isa isa)
{
    isa = brdffit_isa_resolve(isa);
    if (!brdffit_isa_runs(isa)) {
        return NULL;
    }
    switch (isa) {
#ifdef BRDFFIT_HAVE_AVX2
    case BRDFFIT_ISA_AVX2: return &brdffit_table_row_avx2;
#endif
#ifdef BRDFFIT_HAVE_AVX512
    case BRDFFIT_ISA_AVX512: return &brdffit_table_row_avx512;
#endif
    default: return &brdffit_table_row_base;
    }
}
