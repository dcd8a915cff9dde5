/*
 * How many random problems a test tries. The sanitizers are several times slower and look for faults of memory, not of
 * numbers, and a build without ECOS repeats what that with it has tried: fewer of each kind there, never a kind less.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_FEWER_H
#define BRDFFIT_TESTS_FEWER_H

#if defined(__SANITIZE_ADDRESS__) || defined(BRDFFIT_NO_ECOS)
#define FEWER(count, repeated) (repeated)
#else
#define FEWER(count, repeated) (count)
#endif

#endif
