/*
 * Samples in the order of a key. SPDX-License-Identifier: MIT
 */
#include "weight/cells.h"

/* Two neighbouring runs of `from` into one of `to`. */
static void merge_runs(const double *key, const uint32_t *from, uint32_t *to, size_t begin, size_t middle, size_t end)
{
    size_t left = begin, right = middle, out;

    for (out = begin; out < end; out++) {
        int take_left = left < middle && (right == end || key[from[left]] <= key[from[right]]);

        to[out] = take_left ? from[left++] : from[right++];
    }
}

uint32_t *brdffit_weight_sort(const double *key, uint32_t *order, uint32_t *spare, size_t count)
{
    size_t run, begin;

    for (run = 1; run < count; run *= 2) {
        uint32_t *sorted = spare;

        for (begin = 0; begin < count; begin += 2 * run) {
            size_t middle = count - begin < run ? count : begin + run;
            size_t end = count - middle < run ? count : middle + run;

            merge_runs(key, order, spare, begin, middle, end);
        }
        spare = order;
        order = sorted;
    }
    return order;
}
