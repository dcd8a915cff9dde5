/*
 * Columns of a plan's lobe at one roughness: their shapes and what is beside a. SPDX-License-Identifier: MIT
 */
#include "batch/fast.h"

void brdffit_batch_shape(const struct batch_fast *f, int j, double s, double *phi)
{
    const struct lobe_sight *sight = &f->column[j].sight;

    f->kind->shape(f->kernels, sight, PADDED(f->distinct), f->kind->argument(sight, s), phi);
}

void brdffit_batch_gram(const struct batch_fast *f, const double *const phi[EACH_MOST], double d[BATCH_PAIRS],
                        double u[EACH_MOST])
{
    double rest[EACH_MOST];
    size_t m, i;
    int j, l;

    for (j = 0; j < f->each; j++) {
        for (u[j] = 0.0, m = 0; m < f->distinct; m++) {
            u[j] += f->column[j].ab[m] * phi[j][m];
        }
        for (l = 0; l <= j; l++) {
            d[BATCH_PAIR(l, j)] = 0.0;
        }
    }
    for (m = 0; m <= f->distinct; m++) {
        size_t end = m < f->distinct ? f->begin[m + 1] : f->used;

        for (i = f->begin[m]; i < end; i++) {
            for (j = 0; j < f->each; j++) {
                rest[j] = (m < f->distinct ? f->column[j].b[i] * phi[j][m] : 0.0) -
                          (f->root_a > 0.0 ? u[j] * (f->a[i] / f->root_a) : 0.0);
                for (l = 0; l <= j; l++) {
                    d[BATCH_PAIR(l, j)] += rest[l] * rest[j];
                }
            }
        }
    }
}
