/*
 * The cache of finished blocks of starts: see peers_cache.h. A line that an interruption cut short has no line end or
 * too few fields: it is not known, its block is run again, and readers skip it. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include "peers_cache.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define KEY_FIELDS 10
#define FIELDS 22

static const char header[] =
    "material,data,lobes,peer,chart,coefficients,sigma,seed,first,last,best_e2,sigma_1,sigma_2,"
    "reached,near,excluded,iterations,seconds,certified_e2,lower_bound,sum_of_squares,end\n";

static int write_key(char *to, size_t size, const struct peers_block *b)
{
    return snprintf(to, size, "%s,%016" PRIx64 ",%d,%s,%s,%s,%s,%" PRIu64 ",%" PRIu64 ",%" PRIu64, b->material, b->data,
                    b->lobes, b->peer, b->chart, b->coefficients, b->sigma, b->seed, b->first, b->last);
}

/* Cut a line after its key; 0 when it is not a whole row. */
static int cut(char *line)
{
    size_t fields = 1;
    char *at, *end = NULL;

    if (!strchr(line, '\n')) {
        return 0;
    }
    for (at = line; *at; at++) {
        if (*at == ',' && fields++ == KEY_FIELDS) {
            end = at;
        }
    }
    if (fields != FIELDS) {
        return 0;
    }
    *end = '\0';
    return 1;
}

static int compare(const void *first, const void *second)
{
    return strcmp(*(char *const *)first, *(char *const *)second);
}

static int load(FILE *file, struct peers_cache *cache, int *whole)
{
    char *line = NULL;
    size_t size = 0, room = 0;
    int good = 1;

    *whole = 1;
    while (good && getline(&line, &size, file) > 0) {
        *whole = strchr(line, '\n') != NULL;
        if (!cut(line)) {
            continue;
        }
        if (cache->count == room) {
            char **more = realloc(cache->known, (room = 2 * room + 64) * sizeof *more);

            good = more != NULL;
            cache->known = good ? more : cache->known;
        }
        if (good) {
            cache->known[cache->count] = strdup(line);
            good = cache->known[cache->count] != NULL;
            cache->count += (size_t)good;
        }
    }
    free(line);
    if (cache->count > 0) {
        qsort(cache->known, cache->count, sizeof *cache->known, compare);
    }
    return good && !ferror(file);
}

int peers_cache_open(const char *path, struct peers_cache *cache)
{
    FILE *old = strcmp(path, "-") == 0 ? NULL : fopen(path, "r");
    int whole = 1, empty = old == NULL, good = 1;

    memset(cache, 0, sizeof *cache);
    if (old) {
        good = load(old, cache, &whole);
        empty = ftell(old) == 0;
        fclose(old);
    }
    cache->file = strcmp(path, "-") == 0 ? stdout : good ? fopen(path, "a") : NULL;
    if (!cache->file) {
        return 0;
    }
    if (!whole) {
        fputc('\n', cache->file);
    }
    if (empty) {
        fputs(header, cache->file);
    }
    return fflush(cache->file) == 0;
}

int peers_cache_knows(const struct peers_cache *cache, const struct peers_block *block)
{
    char key[512];
    const char *wanted = key;

    if (cache->count == 0 || write_key(key, sizeof key, block) >= (int)sizeof key) {
        return 0;
    }
    return bsearch(&wanted, cache->known, cache->count, sizeof *cache->known, compare) != NULL;
}

int peers_cache_add(struct peers_cache *cache, const struct peers_block *block, const struct peers_outcome *o)
{
    char key[512];

    if (write_key(key, sizeof key, block) >= (int)sizeof key) {
        return 0;
    }
    fprintf(cache->file, "%s,%.17g,%.9g,%.9g,%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%.0f,%.6f,%.17g,%.17g,%.17g,.\n", key,
            o->best_e2, o->best_sigma[0], o->best_sigma[1], o->reached, o->near, o->excluded, o->iterations, o->seconds,
            o->certified_e2, o->lower_bound, o->sum_of_squares);
    return fflush(cache->file) == 0 && !ferror(cache->file);
}

int peers_cache_close(struct peers_cache *cache)
{
    int good = !ferror(cache->file);
    size_t i;

    good = (cache->file == stdout ? fflush(stdout) == 0 : fclose(cache->file) == 0) && good;
    for (i = 0; i < cache->count; i++) {
        free(cache->known[i]);
    }
    free(cache->known);
    return good;
}
