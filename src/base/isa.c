/*
 * Run-time dispatch: see isa.h. SPDX-License-Identifier: MIT
 *
 * BRDFFIT_HAVE_AVX2 and BRDFFIT_HAVE_AVX512 come from a build that compiles the files named *_avx2.c and *_avx512.c for
 * those instruction sets.
 */
#include "base/isa.h"

int brdffit_isa_runs(brdffit_isa isa)
{
    switch (isa) {
    case BRDFFIT_ISA_BASE: return 1;
#ifdef BRDFFIT_HAVE_AVX2
    case BRDFFIT_ISA_AVX2: return __builtin_cpu_supports("avx2") != 0;
#endif
#ifdef BRDFFIT_HAVE_AVX512
    case BRDFFIT_ISA_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl");
#endif
    default: return 0;
    }
}

brdffit_isa brdffit_isa_resolve(brdffit_isa isa)
{
    if (isa != BRDFFIT_ISA_AUTO) {
        return isa;
    }
    return brdffit_isa_runs(BRDFFIT_ISA_AVX512) ? BRDFFIT_ISA_AVX512
           : brdffit_isa_runs(BRDFFIT_ISA_AVX2) ? BRDFFIT_ISA_AVX2
                                                : BRDFFIT_ISA_BASE;
}

int brdffit_isa_supported(brdffit_isa isa)
{
    return isa == BRDFFIT_ISA_AUTO || brdffit_isa_runs(isa);
}

const char *brdffit_isa_string(brdffit_isa isa)
{
    static const char *const name[BRDFFIT_ISA_COUNT] = {"auto", "base", "avx2", "avx512"};

    return (unsigned)isa < BRDFFIT_ISA_COUNT ? name[isa] : "unknown";
}
