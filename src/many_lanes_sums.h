/*
 * Data of a tile to sums: loads, scales, sums over distinct c, gains at the plan's nodes. Part of
 * many_kernels_body.h, compiled once per instruction set; lanes are texels. Layer 5. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_MANY_LANES_SUMS_H
#define BRDFFIT_MANY_LANES_SUMS_H

#include "many_fast.h"

/* Texels into lanes, with their largest values. */
static void load_tile(const struct many_fast *f, const double *const row[MANY_TILE], struct many_tile *tile,
                      struct many_scan *scan)
{
    size_t K = f->channels, i, k;
    lanes strange = lanes_set(0.0);

    for (k = 0; k < K; k++) {
        lanes largest = lanes_set(0.0), magnitude = lanes_set(0.0);

        for (i = 0; i < f->used; i++) {
            size_t at = f->sample[i] * K + k;
            lanes v = {row[0][at], row[1][at], row[2][at], row[3][at], row[4][at], row[5][at], row[6][at], row[7][at]};
            lanes radiance = v * f->radiance[i];

            strange += v - v;
            largest = lanes_max(radiance, largest);
            magnitude = lanes_max(lanes_abs(radiance), magnitude);
            lanes_store(tile->value + (i * K + k) * LANES, v);
        }
        lanes_store(scan->largest + k * LANES, largest);
        lanes_store(scan->magnitude + k * LANES, magnitude);
    }
    lanes_store(scan->not_finite, strange);
}

/* tile->value holds values; to weighted, scaled radiance. */
static void weigh(const struct many_fast *f, struct many_tile *tile)
{
    size_t K = f->channels, i, k;

    for (k = 0; k < K; k++) {
        lanes inverse = 1.0 / lanes_load(tile->scale + k * LANES);

        for (i = 0; i < f->used; i++) {
            double *at = tile->value + (i * K + k) * LANES;

            lanes_store(at, (lanes_load(at) * f->factor[i]) * inverse);
        }
    }
}

/* |I_k|^2, omega, and the sums of residual times b. */
static void sum_texels(const struct many_fast *f, struct many_tile *tile)
{
    size_t K = f->channels, M = f->distinct, k, m, i;

    for (k = 0; k < K; k++) {
        const double *value = tile->value + k * LANES;
        double *sum = tile->sum + k * M * LANES;
        lanes ii = lanes_set(0.0), ai = lanes_set(0.0), omega;

        for (m = 0; m < M; m++) {
            lanes bi = lanes_set(0.0);

            for (i = f->begin[m]; i < f->begin[m + 1]; i++) {
                lanes v = lanes_load(value + i * K * LANES);

                ii += v * v;
                ai += v * f->a[i];
                bi += v * f->b[i];
            }
            lanes_store(sum + m * LANES, bi);
        }
        for (i = f->begin[M]; i < f->used; i++) {
            lanes v = lanes_load(value + i * K * LANES);

            ii += v * v;
            ai += v * f->a[i];
        }
        omega = f->root_a > 0.0 ? ai / f->root_a : lanes_set(0.0);
        lanes_store(tile->ii + k * LANES, ii);
        lanes_store(tile->omega + k * LANES, omega);
        for (m = 0; m < M; m++) {
            lanes_store(sum + m * LANES, lanes_load(sum + m * LANES) - omega * f->ab[m]);
        }
    }
}

/* Sum over channels of max(0, n)^2 / D at every node: what is gained where x may have any sign. */
static void node_gains(const struct many_fast *f, struct many_tile *tile)
{
    size_t K = f->channels, M = f->distinct, block, k, m, j;

    for (block = 0; block < f->nodes / LANES; block++) {
        const double *phi = f->phi + block * M * LANES;
        lanes gain[LANES];

        for (j = 0; j < LANES; j++) {
            gain[j] = lanes_set(0.0);
        }
        for (k = 0; k < K; k++) {
            const double *sum = tile->sum + k * M * LANES;
            lanes n0 = lanes_set(0.0), n1 = n0, n2 = n0, n3 = n0, n4 = n0, n5 = n0, n6 = n0, n7 = n0;

            for (m = 0; m < M; m++) {
                lanes r = lanes_load(sum + m * LANES);
                const double *at = phi + m * LANES;

                n0 += r * at[0];
                n1 += r * at[1];
                n2 += r * at[2];
                n3 += r * at[3];
                n4 += r * at[4];
                n5 += r * at[5];
                n6 += r * at[6];
                n7 += r * at[7];
            }
            {
                lanes n[LANES] = {n0, n1, n2, n3, n4, n5, n6, n7};

                for (j = 0; j < LANES; j++) {
                    lanes positive = lanes_max(n[j], lanes_set(0.0));

                    gain[j] += positive * positive;
                }
            }
        }
        for (j = 0; j < LANES; j++) {
            lanes_store(tile->gain + (block * LANES + j) * LANES, gain[j] * f->inverse_d[block * LANES + j]);
        }
    }
}

#endif
