/*
 * The table of an instruction set: see kernels.h. SPDX-License-Identifier: MIT
 */
#include "kernels/kernels.h"

#include "base/isa.h"

const struct kernels *brdffit_kernels(brdffit_isa isa)
{
    isa = brdffit_isa_resolve(isa);
    if (!brdffit_isa_runs(isa)) {
        return NULL;
    }
    switch (isa) {
#ifdef BRDFFIT_HAVE_AVX2
    case BRDFFIT_ISA_AVX2: return &brdffit_kernels_avx2;
#endif
#ifdef BRDFFIT_HAVE_AVX512
    case BRDFFIT_ISA_AVX512: return &brdffit_kernels_avx512;
#endif
    default: return &brdffit_kernels_base;
    }
}
