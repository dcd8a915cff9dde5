/*
 * Floating-point environments that a caller may have: rounding modes, FTZ and DAZ, unmasked traps. To be included after
 * cmocka.h. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_ENVIRONMENTS_H
#define BRDFFIT_TESTS_ENVIRONMENTS_H

#include <fenv.h>

#include "base/environment.h"

#if defined(__SSE2__)
/* MXCSR: rounding 0x6000, FTZ 0x8000, DAZ 0x0040, masks 0x1f80 (cleared: division by zero, overflow, underflow and
 * inexact trap). */
static const unsigned modes[] = {0x1f80, 0x3f80, 0x5f80, 0x7f80, 0x9f80, 0x1fc0,
                                 0x9fc0, 0xffc0, 0x0080, 0xe0c0, 0x5fbf};

static inline void set_mode(unsigned mode)
{
    __builtin_ia32_ldmxcsr(mode);
}

static inline unsigned mode_now(void)
{
    return __builtin_ia32_stmxcsr();
}
#else
static const unsigned modes[] = {
    FE_TONEAREST,
#ifdef FE_UPWARD
    FE_UPWARD,
#endif
#ifdef FE_DOWNWARD
    FE_DOWNWARD,
#endif
#ifdef FE_TOWARDZERO
    FE_TOWARDZERO,
#endif
};

static inline void set_mode(unsigned mode)
{
    (void)fesetround((int)mode);
}

static inline unsigned mode_now(void)
{
    return (unsigned)fegetround();
}
#endif

#define MODES (sizeof modes / sizeof modes[0])

static struct environment ours;

/* Nothing of the test itself is computed between these two. */
static inline void leave_tests(size_t mode)
{
    brdffit_environment_enter(&ours);
    set_mode(modes[mode]);
}

static inline void back_to_tests(size_t mode)
{
    unsigned after = mode_now();

    brdffit_environment_leave(&ours);
    if (after != modes[mode]) {
        fail_msg("environment %#x came back as %#x", modes[mode], after);
    }
}

#endif
