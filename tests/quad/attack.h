/*
 * Other claims of the library against quad precision: what was proven of single boxes, and proofs of a level.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_ATTACK_H
#define BRDFFIT_TESTS_ATTACK_H

#include "judge.h"

/* Random boxes of the fit's own search, each by its corners and a descent inside of it. Adds to *out. */
void attack_boxes(const struct fit_question *q, unsigned long long seed, size_t effort, struct judgement *out);

/* A level above the least E^2 found, out->best, must not be proven. Adds to *out. */
void attack_proof(const struct fit_question *q, double level, struct judgement *out);

#endif
