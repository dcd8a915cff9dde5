/*
 * --lobes of the benchmarks: how many (2), or what each is (ggx,ward). SPDX-License-Identifier: MIT
 */
#ifndef BENCH_LOBES_H
#define BENCH_LOBES_H

#include <string.h>

#include "brdffit.h"

/* The distribution whose name the first `length` characters are; the count of them when there is none. */
static inline brdffit_distribution bench_distribution(const char *text, size_t length)
{
    int d;

    for (d = 0; d < BRDFFIT_DISTRIBUTION_COUNT; d++) {
        const char *name = brdffit_distribution_string((brdffit_distribution)d);

        if (strlen(name) == length && strncmp(name, text, length) == 0) {
            break;
        }
    }
    return (brdffit_distribution)d;
}

/* 1 when understood: options->lobes, and options->distributions pointing to `list`, or NULL for a number. */
static inline int bench_lobes(const char *text, brdffit_options *options, brdffit_distribution list[BRDFFIT_MAX_LOBES])
{
    int count = 0;

    options->distributions = NULL;
    options->lobes = text[0] - '0';
    if (text[0] && !text[1]) {
        return options->lobes >= 1 && options->lobes <= BRDFFIT_MAX_LOBES;
    }
    for (;; text++) {
        size_t length = strcspn(text, ",");
        brdffit_distribution found = bench_distribution(text, length);

        if (found == BRDFFIT_DISTRIBUTION_COUNT || count == BRDFFIT_MAX_LOBES) {
            return 0;
        }
        list[count++] = found;
        text += length;
        if (!*text) {
            break;
        }
    }
    options->lobes = count;
    options->distributions = list;
    return 1;
}

#endif
