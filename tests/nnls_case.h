/*
 * Random and adversarial restricted problems, shared by test_nnls.c and ref/nnls_cases.c (which hands them to
 * SciPy). A seed names a case for ever. SPDX-License-Identifier: MIT
 */
#ifndef NNLS_CASE_H
#define NNLS_CASE_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>

#define CASE_ROWS 12
#define CASE_COLUMNS 7

struct nnls_case {
    int rows, columns;
    double column[CASE_COLUMNS][CASE_ROWS], data[CASE_ROWS];
    double column_scale[CASE_COLUMNS], data_scale; /* powers of two that bring them to about 1 */
    const char *kind;
};

static inline uint64_t case_next(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);

    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline double case_uniform(uint64_t *state)
{
    return (double)(case_next(state) >> 11) * 0x1p-53;
}

static inline double case_signed(uint64_t *state)
{
    return 2.0 * case_uniform(state) - 1.0;
}

/* One column like `from`, moved by `size` relative: 0 copies it, 1e-16 changes single bits. */
static inline void case_near(const double *from, double *to, int rows, double size, uint64_t *state)
{
    int i;

    for (i = 0; i < rows; i++) {
        to[i] = fabs(from[i] * (1.0 + size * case_signed(state)));
    }
}

static inline void case_scale(double *v, int rows, double *scale, int exponent)
{
    int i;

    *scale = ldexp(1.0, exponent);
    for (i = 0; i < rows; i++) {
        v[i] *= *scale;
    }
}

/* wide: columns and data are scaled by up to 2^500 either way (1e150). */
static inline void nnls_case_make(struct nnls_case *c, uint64_t seed, int wide)
{
    static const double nearness[] = {0.0, 1.2e-16, 2.5e-16, 1e-15, 1e-12, 1e-8, 1e-4};
    uint64_t s = seed * 0x2545f4914f6cdd1du + 1;
    unsigned kind = (unsigned)(case_next(&s) % 8);
    int i, j;

    c->rows = 1 + (int)(case_next(&s) % CASE_ROWS);
    c->columns = 1 + (int)(case_next(&s) % 3);
    c->kind = "random";
    for (j = 0; j < 3; j++) {
        for (i = 0; i < CASE_ROWS; i++) {
            c->column[j][i] = i < c->rows ? case_uniform(&s) : 0.0;
        }
    }
    if (kind == 1 || kind == 2) {
        c->kind = "collinear";
        for (j = 1; j < 3; j++) {
            case_near(c->column[(int)(case_next(&s) % (unsigned)j)], c->column[j], c->rows, nearness[case_next(&s) % 7],
                      &s);
        }
    } else if (kind == 3) {
        c->kind = "one ulp";
        for (j = 1; j < 3; j++) {
            for (i = 0; i < c->rows; i++) {
                c->column[j][i] = c->column[0][i];
            }
            i = (int)(case_next(&s) % (unsigned)c->rows);
            c->column[j][i] = nextafter(c->column[j][i], 2.0);
        }
    } else if (kind == 4) {
        c->kind = "zero column";
        j = (int)(case_next(&s) % 3);
        for (i = 0; i < c->rows; i++) {
            c->column[j][i] = 0.0;
        }
    } else if (kind == 5) {
        c->kind = "sharp lobes";
        for (j = 1; j < 3; j++) {
            double sharp = pow(10.0, 6.0 * case_uniform(&s));

            for (i = 0; i < c->rows; i++) {
                c->column[j][i] = exp(-sharp * i * i / 1e3);
            }
        }
    }
    for (i = 0; i < CASE_ROWS; i++) {
        double model = 0.7 * c->column[0][i] + case_uniform(&s) * c->column[1][i] + 0.1 * c->column[2][i];

        c->data[i] = kind == 6 ? -model : kind == 7 ? case_signed(&s) : model * (1.0 + 0.1 * case_signed(&s));
        if (i >= c->rows) {
            c->data[i] = 0.0;
        }
    }
    if (case_next(&s) % 16 == 0) {
        c->kind = "zero data";
        for (i = 0; i < CASE_ROWS; i++) {
            c->data[i] = 0.0;
        }
    } else if (case_next(&s) % 8 == 0) {
        for (i = 0; i < c->rows; i++) { /* an exact fit */
            c->data[i] = c->column[0][i];
        }
    }
    for (j = 0; j < 3; j++) {
        case_scale(c->column[j], c->rows, &c->column_scale[j], wide ? (int)(case_next(&s) % 999) - 499 : 0);
    }
    case_scale(c->data, c->rows, &c->data_scale, wide ? (int)(case_next(&s) % 999) - 499 : 0);
}

/*
 * More columns: each random, near an earlier one, near a mean of two earlier ones (dependent but for a little), a sharp
 * lobe, zero, or one that earlier ones span; data in the cone, on its edge, outside of it.
 */
static inline void nnls_case_many(struct nnls_case *c, uint64_t seed, int columns, int wide)
{
    static const double nearness[] = {0.0, 1.2e-16, 1e-15, 1e-12, 1e-10, 1e-8, 1e-4};
    uint64_t s = seed * 0x2545f4914f6cdd1du + 7;
    double sharp;
    int i, j, outside = case_next(&s) % 4 == 0, exact = case_next(&s) % 4 == 0;

    c->rows = 1 + (int)(case_next(&s) % CASE_ROWS);
    c->columns = columns;
    c->kind = "many";
    for (i = 0; i < CASE_ROWS; i++) {
        c->data[i] = 0.0;
    }
    for (j = 0; j < columns; j++) {
        unsigned kind = (unsigned)(case_next(&s) % 8), one = (unsigned)j ? (unsigned)(case_next(&s) % (unsigned)j) : 0;
        unsigned two = (unsigned)j ? (unsigned)(case_next(&s) % (unsigned)j) : 0;
        double size = nearness[case_next(&s) % 7], z = case_next(&s) % 3 ? case_uniform(&s) : 0.0;

        sharp = pow(10.0, 6.0 * case_uniform(&s));
        for (i = 0; i < CASE_ROWS; i++) {
            double v = case_uniform(&s), wobble = 1.0 + size * case_signed(&s);

            if (j > 0 && kind < 2) {
                v = fabs(c->column[one][i] * wobble);
            } else if (j > 1 && kind < 4) {
                v = fabs((c->column[one][i] + 0.6 * c->column[two][i]) * wobble);
            } else if (kind == 4) {
                v = exp(-sharp * i * i / 1e3);
            } else if (kind == 5 && size == 0.0) {
                v = 0.0;
            }
            c->column[j][i] = i < c->rows ? v : 0.0;
            c->data[i] += c->column[j][i] * z;
        }
    }
    for (i = 0; i < c->rows; i++) {
        c->data[i] = outside ? case_signed(&s) : exact ? c->data[i] : c->data[i] * (1.0 + 0.1 * case_signed(&s));
    }
    for (j = 0; j < columns; j++) {
        case_scale(c->column[j], c->rows, &c->column_scale[j], wide ? (int)(case_next(&s) % 999) - 499 : 0);
    }
    case_scale(c->data, c->rows, &c->data_scale, wide ? (int)(case_next(&s) % 999) - 499 : 0);
}

static inline void nnls_case_print(const struct nnls_case *c, FILE *out)
{
    int i, j;

    fprintf(out, "kind %s, %d x %d\n", c->kind, c->rows, c->columns);
    for (j = 0; j < c->columns; j++) {
        for (i = 0; i < c->rows; i++) {
            fprintf(out, "%a ", c->column[j][i]);
        }
        fprintf(out, "\n");
    }
    for (i = 0; i < c->rows; i++) {
        fprintf(out, "%a ", c->data[i]);
    }
    fprintf(out, "\n");
}

#endif
