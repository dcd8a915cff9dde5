/*
 * The floating-point environment of a call: see environment.h. SPDX-License-Identifier: MIT
 *
 * x86: MXCSR alone. The x87 unit has a control word of its own, but doubles are never computed there
 * (exp.h refuses such a build).
 */
#include "base/environment.h"

#if defined(__SSE2__)

/* All exceptions masked, round to nearest, no flag, neither FTZ nor DAZ: the state of a new process. */
#define MXCSR_DEFAULT 0x1f80u

void brdffit_environment_enter(struct environment *callers)
{
    callers->mxcsr = __builtin_ia32_stmxcsr();
    __builtin_ia32_ldmxcsr(MXCSR_DEFAULT);
}

void brdffit_environment_leave(const struct environment *callers)
{
    __builtin_ia32_ldmxcsr(callers->mxcsr);
}

#elif defined(__aarch64__)

void brdffit_environment_enter(struct environment *callers)
{
    __asm__ volatile("mrs %0, fpcr" : "=r"(callers->control) : : "memory");
    __asm__ volatile("mrs %0, fpsr" : "=r"(callers->status) : : "memory");
    __asm__ volatile("msr fpcr, %0" : : "r"(0ull) : "memory"); /* FZ, DN, RMode and traps off */
}

void brdffit_environment_leave(const struct environment *callers)
{
    __asm__ volatile("msr fpcr, %0" : : "r"(callers->control) : "memory");
    __asm__ volatile("msr fpsr, %0" : : "r"(callers->status) : "memory");
}

#else

void brdffit_environment_enter(struct environment *callers)
{
    (void)fegetenv(&callers->all);
    (void)fesetenv(FE_DFL_ENV);
}

void brdffit_environment_leave(const struct environment *callers)
{
    (void)fesetenv(&callers->all);
}

#endif
