/*
 * Data of a tile to sums: loads, scales, sums over distinct c, gains at the plan's nodes. Part of
 * batch_body.h, compiled once per instruction set; lanes are texels. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BATCH_LANES_SUMS_H
#define BRDFFIT_BATCH_LANES_SUMS_H

#include "batch/fast.h"

/* Element `at` of the rows of a part. */
LANES_INLINE vec column(const double *const *row, size_t at)
{
#if VEC == 8
    return (vec){row[0][at], row[1][at], row[2][at], row[3][at], row[4][at], row[5][at], row[6][at], row[7][at]};
#elif VEC == 4
    return (vec){row[0][at], row[1][at], row[2][at], row[3][at]};
#else
    return (vec){row[0][at], row[1][at]};
#endif
}

/* Texels into lanes, with their largest values. */
static void load_tile(const struct batch_fast *f, const double *const row[BATCH_TILE], struct batch_tile *tile,
                      struct batch_scan *scan)
{
    size_t K = f->channels, i, k, part;

    for (part = 0; part < LANES; part += VEC) {
        vec strange = vec_set(0.0);

        for (k = 0; k < K; k++) {
            vec largest = vec_set(0.0), magnitude = vec_set(0.0);

            for (i = 0; i < f->used; i++) {
                vec v = column(row + part, f->sample[i] * K + k), radiance = v * f->radiance[i];

                strange += v - v;
                largest = vec_max(radiance, largest);
                magnitude = vec_max(vec_abs(radiance), magnitude);
                vec_store(tile->value + (i * K + k) * LANES + part, v);
            }
            vec_store(scan->largest + k * LANES + part, largest);
            vec_store(scan->magnitude + k * LANES + part, magnitude);
        }
        vec_store(scan->not_finite + part, strange);
    }
}

/* tile->value holds values; to weighted, scaled radiance. */
static void weigh(const struct batch_fast *f, struct batch_tile *tile)
{
    size_t K = f->channels, i, k, part;

    for (part = 0; part < LANES; part += VEC) {
        for (k = 0; k < K; k++) {
            vec inverse = 1.0 / vec_load(tile->scale + k * LANES + part);

            for (i = 0; i < f->used; i++) {
                double *at = tile->value + (i * K + k) * LANES + part;

                vec_store(at, (vec_load(at) * f->factor[i]) * inverse);
            }
        }
    }
}

/* |I_k|^2, omega, and the sums of residual times b. */
LANES_INLINE void sum_channel(const struct batch_fast *f, struct batch_tile *tile, size_t k, size_t part, int each)
{
    size_t K = f->channels, M = f->distinct, m, i;
    const double *value = tile->value + k * LANES + part;
    double *one = tile->sum[0] + k * M * LANES + part, *two = each > 1 ? tile->sum[1] + k * M * LANES + part : one;
    vec ii = vec_set(0.0), ai = vec_set(0.0), omega;

    for (m = 0; m < M; m++) {
        vec bi = vec_set(0.0), wi = vec_set(0.0);

        for (i = f->begin[m]; i < f->begin[m + 1]; i++) {
            vec v = vec_load(value + i * K * LANES);

            ii += v * v;
            ai += v * f->a[i];
            bi += v * f->column[0].b[i];
            if (each > 1) {
                wi += v * f->column[1].b[i];
            }
        }
        if (each > 1) {
            vec_store(two + m * LANES, wi);
        }
        vec_store(one + m * LANES, bi);
    }
    for (i = f->begin[M]; i < f->used; i++) {
        vec v = vec_load(value + i * K * LANES);

        ii += v * v;
        ai += v * f->a[i];
    }
    omega = f->root_a > 0.0 ? ai / f->root_a : vec_set(0.0);
    vec_store(tile->ii + k * LANES + part, ii);
    vec_store(tile->omega + k * LANES + part, omega);
    for (m = 0; m < M; m++) {
        vec_store(one + m * LANES, vec_load(one + m * LANES) - omega * f->column[0].ab[m]);
        if (each > 1) {
            vec_store(two + m * LANES, vec_load(two + m * LANES) - omega * f->column[1].ab[m]);
        }
    }
}

static void sum_texels(const struct batch_fast *f, struct batch_tile *tile)
{
    size_t k, part;

    for (part = 0; part < LANES; part += VEC) {
        for (k = 0; k < f->channels; k++) {
            if (EACH_MOST > 1 && f->each > 1) {
                sum_channel(f, tile, k, part, 2);
            } else {
                sum_channel(f, tile, k, part, 1);
            }
        }
    }
}

/* n_k of one column at eight nodes. */
LANES_INLINE void node_block(const double *sum, const double *node, size_t M, vec n[LANES])
{
    vec n0 = vec_set(0.0), n1 = n0, n2 = n0, n3 = n0, n4 = n0, n5 = n0, n6 = n0, n7 = n0;
    size_t m;

    for (m = 0; m < M; m++) {
        vec r = vec_load(sum + m * LANES);
        const double *at = node + m * LANES;

        n0 += r * at[0];
        n1 += r * at[1];
        n2 += r * at[2];
        n3 += r * at[3];
        n4 += r * at[4];
        n5 += r * at[5];
        n6 += r * at[6];
        n7 += r * at[7];
    }
    n[0] = n0;
    n[1] = n1;
    n[2] = n2;
    n[3] = n3;
    n[4] = n4;
    n[5] = n5;
    n[6] = n6;
    n[7] = n7;
}

/* What unit columns with this cosine gain, coefficients >= 0. */
LANES_INLINE vec gain_of_two(vec one, vec two, double cosine)
{
    vec zero = vec_set(0.0), first = vec_max(one, zero), second = vec_max(two, zero), most;
    vec_mask both = (one > cosine * two) & (two > cosine * one);

    first = first * first;
    second = second * second;
    most = vec_max(first, second);
    return vec_select(both, (one * one + two * two - (2.0 * cosine) * (one * two)) / ((1.0 - cosine) * (1.0 + cosine)),
                      most);
}

/* Sum over channels of what is gained at every node where x may have any sign. */
LANES_INLINE void node_gains_of(const struct batch_fast *f, struct batch_tile *tile, int each)
{
    size_t K = f->channels, M = f->distinct, block, k, j, part;

    for (part = 0; part < LANES; part += VEC) {
        for (block = 0; block < f->nodes / LANES; block++) {
            vec gain[LANES], n[LANES], more[LANES];

            for (j = 0; j < LANES; j++) {
                gain[j] = vec_set(0.0);
            }
            for (k = 0; k < K; k++) {
                node_block(tile->sum[0] + k * M * LANES + part, f->column[0].node + block * M * LANES, M, n);
                if (each > 1) {
                    node_block(tile->sum[1] + k * M * LANES + part, f->column[1].node + block * M * LANES, M, more);
                }
                for (j = 0; j < LANES; j++) {
                    if (each > 1) {
                        gain[j] += gain_of_two(n[j], more[j], f->cosine[block * LANES + j]);
                    } else {
                        vec positive = vec_max(n[j], vec_set(0.0));

                        gain[j] += positive * positive;
                    }
                }
            }
            for (j = 0; j < LANES; j++) {
                vec_store(tile->gain + (block * LANES + j) * LANES + part, gain[j]);
            }
        }
    }
}

static void node_gains(const struct batch_fast *f, struct batch_tile *tile)
{
    if (EACH_MOST > 1 && f->each > 1) {
        node_gains_of(f, tile, 2);
    } else {
        node_gains_of(f, tile, 1);
    }
}

#endif
