/*
 * The floating-point environment of a call: round to nearest, subnormal numbers kept, no traps.
 * SPDX-License-Identifier: MIT
 *
 * A caller may have set another rounding mode, FTZ and DAZ (as -ffast-math does at start-up for a whole process), or
 * traps. Every bound is derived for the default environment, and "same input, same bits" means it: so each public
 * function that computes enters it, and leaves with the caller's own again, sticky flags included (entry.c).
 */
#ifndef BRDFFIT_ENVIRONMENT_H
#define BRDFFIT_ENVIRONMENT_H

#if defined(__SSE2__)
struct environment {
    unsigned mxcsr;
};
#elif defined(__aarch64__)
struct environment {
    unsigned long long control, status;
};
#else
#include <fenv.h>
struct environment {
    fenv_t all;
};
#endif

/*
 * Functions that run between enter and leave: an optimiser knows of no environment and may move arithmetic across the
 * two, but not out of a function that it does not inline.
 */
#define ENVIRONMENT_APART __attribute__((noinline))

ENVIRONMENT_APART void brdffit_environment_enter(struct environment *callers);
ENVIRONMENT_APART void brdffit_environment_leave(const struct environment *callers);

#endif
