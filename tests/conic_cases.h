/*
 * Random conic programs whose optimum is known exactly, for test_certificate.c and test_socp.c.
 *
 * x, G, s and z are small integers; s and z are complementary (for a linear row one of them is 0; for a
 * cone, s and z are 0, or inside it with the other 0, or s = (5, 3, 4, 0..) and z = (5, -3, -4, 0..) up to
 * factors and signs). Then h = G x + s and c = -G'z are integers, x is optimal and c'x = -h'z exactly.
 * SPDX-License-Identifier: MIT
 */
#ifndef CONIC_CASES_H
#define CONIC_CASES_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "solve/conic/certificate.h"

#define CASE_VARIABLES 8
#define CASE_CONES 3
#define CASE_ROWS (12 + 5 * CASE_CONES)

struct conic_case {
    struct conic_shape shape;
    struct conic_data data;
    size_t rows;
    size_t cone[CASE_CONES];
    double g[CASE_VARIABLES * CASE_ROWS], c[CASE_VARIABLES], h[CASE_ROWS];
    double x[CASE_VARIABLES], s[CASE_ROWS], z[CASE_ROWS];
    double optimum, scale; /* scale: sum of the magnitudes that the optimum is a sum of, and 1 */
};

/* 0 .. below - 1 (splitmix64). */
static inline int64_t conic_case_random(uint64_t *seed, int64_t below)
{
    uint64_t v = *seed += UINT64_C(0x9E3779B97F4A7C15);

    v = (v ^ (v >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    v = (v ^ (v >> 27)) * UINT64_C(0x94D049BB133111EB);
    v ^= v >> 31;
    return (int64_t)(v % (uint64_t)below);
}

static inline double conic_case_integer(uint64_t *seed, int64_t magnitude)
{
    return (double)(conic_case_random(seed, 2 * magnitude + 1) - magnitude);
}

static inline void conic_case_shape(struct conic_case *problem, uint64_t *seed)
{
    size_t i;

    memset(problem, 0, sizeof *problem);
    problem->shape.variables = 1 + (size_t)conic_case_random(seed, CASE_VARIABLES);
    problem->shape.linear = (size_t)conic_case_random(seed, 13);
    problem->shape.cones = (size_t)conic_case_random(seed, CASE_CONES) + (problem->shape.linear == 0);
    problem->shape.cone = problem->cone;
    for (i = 0; i < problem->shape.cones; i++) {
        problem->cone[i] = 3 + (size_t)conic_case_random(seed, 3);
    }
    problem->rows = brdffit_conic_rows(&problem->shape);
    problem->data.g = problem->g;
    problem->data.c = problem->c;
    problem->data.h = problem->h;
}

static inline void conic_case_pair(double *s, double *z, uint64_t *seed)
{
    double p = (double)(1 + conic_case_random(seed, 3)), q = (double)(1 + conic_case_random(seed, 3));
    double sign = conic_case_random(seed, 2) ? 1.0 : -1.0;

    switch (conic_case_random(seed, 3)) {
    case 0: /* both on the boundary, opposite */
        s[0] = 5 * p;
        s[1] = 3 * p * sign;
        s[2] = 4 * p;
        z[0] = 5 * q;
        z[1] = -3 * q * sign;
        z[2] = -4 * q;
        break;
    case 1:
        s[0] = 7 * p;
        s[1] = p;
        s[2] = -2 * p * sign;
        break;
    default:
        z[0] = 7 * q;
        z[1] = q * sign;
        z[2] = -2 * q;
        break;
    }
}

static inline void conic_case_make(struct conic_case *problem, uint64_t *seed)
{
    size_t row, i, j;

    conic_case_shape(problem, seed);
    for (i = 0; i < problem->shape.linear; i++) {
        double value = (double)(1 + conic_case_random(seed, 4));

        *(conic_case_random(seed, 2) ? &problem->s[i] : &problem->z[i]) = value;
    }
    for (i = 0, row = problem->shape.linear; i < problem->shape.cones; row += problem->cone[i++]) {
        conic_case_pair(problem->s + row, problem->z + row, seed);
    }
    memcpy(problem->h, problem->s, sizeof problem->h);
    problem->scale = 1.0;
    for (j = 0; j < problem->shape.variables; j++) {
        problem->x[j] = conic_case_integer(seed, 5);
        for (i = 0; i < problem->rows; i++) {
            double entry = conic_case_integer(seed, 4);

            problem->g[j * problem->rows + i] = entry;
            problem->h[i] += entry * problem->x[j];
            problem->c[j] -= entry * problem->z[i];
        }
        problem->optimum += problem->c[j] * problem->x[j];
        problem->scale += fabs(problem->c[j] * problem->x[j]);
    }
    for (i = 0; i < problem->rows; i++) {
        problem->scale += fabs(problem->h[i] * problem->z[i]);
    }
}

static inline void conic_case_print(const struct conic_case *problem)
{
    size_t i, j;

    printf("variables %zu, linear rows %zu, cones", problem->shape.variables, problem->shape.linear);
    for (i = 0; i < problem->shape.cones; i++) {
        printf(" %zu", problem->cone[i]);
    }
    for (i = 0; i < problem->rows; i++) {
        printf("\nrow %zu: h %g, s %g, z %g, G", i, problem->h[i], problem->s[i], problem->z[i]);
        for (j = 0; j < problem->shape.variables; j++) {
            printf(" %g", problem->g[j * problem->rows + i]);
        }
    }
    for (j = 0; j < problem->shape.variables; j++) {
        printf("\nvariable %zu: c %g, x %g", j, problem->c[j], problem->x[j]);
    }
    printf("\n");
}

#endif
