/*
 * The cache of finished blocks of starts: a CSV file that is only ever appended to. SPDX-License-Identifier: MIT
 */
#ifndef PEERS_CACHE_H
#define PEERS_CACHE_H

#include <stdint.h>
#include <stdio.h>

#include "peers_problem.h"

/* What was run: together, what a row is found by. */
struct peers_block {
    char material[128]; /* file name without its folder and endings; "," and quotes become "_" */
    uint64_t data;      /* digest of the samples */
    int lobes;
    const char *peer, *chart, *coefficients, *sigma;
    uint64_t seed;
    uint64_t first, last; /* starts [first, last) */
};

/* What came out. */
struct peers_outcome {
    double best_e2, best_sigma[PEERS_MOST_LOBES]; /* over the starts that were not excluded; infinite without one */
    uint64_t reached, near, excluded;             /* starts within 1e-6, within 1e-3 of the certified E^2; left
                                                     out */
    double iterations, seconds;                   /* sums; processor time */
    double certified_e2, lower_bound, sum_of_squares;
};

struct peers_cache {
    FILE *file;
    char **known; /* sorted keys */
    size_t count;
};

/* "-" writes to standard output and knows nothing. 0 when the file cannot be opened, read or written. */
int peers_cache_open(const char *path, struct peers_cache *cache);
int peers_cache_knows(const struct peers_cache *cache, const struct peers_block *block);
int peers_cache_add(struct peers_cache *cache, const struct peers_block *block, const struct peers_outcome *outcome);
/* 0 when something could not be written. */
int peers_cache_close(struct peers_cache *cache);

#endif
