/*
 * Supports of the restricted problem: their factorisation and their least squares. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "base/tolerance.h"
#include "solve/nnls_parts.h"

/* Count 0 when the columns of the support are dependent. */
void brdffit_nnls_support_factor(const struct nnls *nnls, unsigned bits, struct nnls_support *s)
{
    int i, j, k, pass;

    s->count = 0;
    for (j = 0; j < nnls->columns; j++) {
        if (bits & (1u << j)) {
            s->index[s->count++] = j;
        }
    }
    for (j = 0; j < s->count; j++) {
        double norm = 0.0;

        for (k = 0; k < nnls->columns; k++) {
            s->basis[j][k] = nnls->r[k][s->index[j]];
        }
        for (i = 0; i < j; i++) {
            s->upper[i][j] = 0.0;
        }
        for (pass = 0; pass < 2; pass++) {
            for (i = 0; i < j; i++) {
                double part = 0.0;

                for (k = 0; k < nnls->columns; k++) {
                    part += s->basis[i][k] * s->basis[j][k];
                }
                for (k = 0; k < nnls->columns; k++) {
                    s->basis[j][k] -= part * s->basis[i][k];
                }
                s->upper[i][j] += part;
            }
        }
        for (k = 0; k < nnls->columns; k++) {
            norm += s->basis[j][k] * s->basis[j][k];
        }
        norm = sqrt(norm);
        if (!(norm > TOL_DEPENDENT)) {
            s->count = 0;
            return;
        }
        s->upper[j][j] = norm;
        for (k = 0; k < nnls->columns; k++) {
            s->basis[j][k] /= norm;
        }
    }
}

const struct nnls_support *brdffit_nnls_factored(const struct nnls *nnls, unsigned bits, struct nnls_support *room)
{
    if (bits == 0 || nnls->columns <= NNLS_CLOSED) {
        return &nnls->support[bits];
    }
    brdffit_nnls_support_factor(nnls, bits, room);
    return room;
}

/*
 * Solve the support for t; z has one entry a column of the support. Returns the squared norm of what is left of t,
 * from the rest itself: where data are fitted exactly, supports whose projections agree to rounding differ in it.
 */
static inline __attribute__((always_inline)) double support_solve(const struct nnls_support *s, const double *t,
                                                                  int columns, double *z)
{
    double rest[NNLS_COLUMNS], left = 0.0;
    int i, j, k;

    for (k = 0; k < columns; k++) {
        rest[k] = t[k];
    }
    for (j = 0; j < s->count; j++) {
        z[j] = 0.0;
        for (k = 0; k < columns; k++) {
            z[j] += s->basis[j][k] * rest[k];
        }
        for (k = 0; k < columns; k++) {
            rest[k] -= z[j] * s->basis[j][k];
        }
    }
    for (k = 0; k < columns; k++) {
        left += rest[k] * rest[k];
    }
    for (j = s->count - 1; j >= 0; j--) {
        for (i = j + 1; i < s->count; i++) {
            z[j] -= s->upper[j][i] * z[i];
        }
        z[j] /= s->upper[j][j];
    }
    return left;
}

static inline __attribute__((always_inline)) unsigned enumerate(const struct nnls *nnls, const double *t, double *unit,
                                                                const int columns)
{
    struct nnls_support room;
    unsigned bits, chosen = 0;
    double least = 0.0;
    int j;

    for (j = 0; j < NNLS_COLUMNS; j++) {
        unit[j] = 0.0;
    }
    for (j = 0; j < columns; j++) {
        least += t[j] * t[j];
    }
    for (bits = 1; bits < 1u << columns; bits++) {
        const struct nnls_support *s = brdffit_nnls_factored(nnls, bits, &room);
        double z[NNLS_COLUMNS];
        double left;
        int feasible = s->count > 0;

        if (!feasible) {
            continue;
        }
        left = support_solve(s, t, columns, z);
        for (j = 0; j < s->count; j++) {
            feasible = feasible && z[j] > 0.0;
        }
        if (feasible && left < least) {
            least = left;
            chosen = bits;
            for (j = 0; j < columns; j++) {
                unit[j] = 0.0;
            }
            for (j = 0; j < s->count; j++) {
                unit[s->index[j]] = z[j];
            }
        }
    }
    return chosen;
}

/* Best feasible support for t of all; writes unit-column coefficients. Unrolled where most of the fits are. */
unsigned brdffit_nnls_enumerate(const struct nnls *nnls, const double *t, double *unit)
{
    switch (nnls->columns) {
    case 2: return enumerate(nnls, t, unit, 2);
    case 3: return enumerate(nnls, t, unit, 3);
    default: return enumerate(nnls, t, unit, nnls->columns);
    }
}

double brdffit_nnls_support_solve(const struct nnls_support *s, const double *t, int columns, double *z)
{
    return support_solve(s, t, columns, z);
}
