/* map_run.c: the tiles that are missing, shared out among threads. Which
 * thread fits a tile, and when, changes nothing in it.
 * SPDX-License-Identifier: MIT */
#define _GNU_SOURCE /* sched_getaffinity, where there is one */
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "interrupt.h"
#include "job.h"
#include "map.h"
#include "progress.h"
#include "tell.h"

struct pool {
    const struct cli_map *map;
    pthread_mutex_t mutex; /* guards what follows */
    pthread_cond_t changed;
    unsigned char *done;   /* a tile each: another part's */
    unsigned char *kept;   /* a tile each: there, when its data are still the same */
    size_t stale;          /* kept tiles that had to be fitted again */
    size_t next, running;
    size_t texels;         /* fitted in this run */
    int code;              /* the worst so far */
    int stop;
};

size_t brdffit_cli_processors(void)
{
#ifdef __linux__
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) {
        return (size_t)CPU_COUNT(&set);
    }
#endif
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online > 0 ? (size_t)online : 1;
}

static int tick(void *user, size_t texels)
{
    struct pool *const p = user;
    pthread_mutex_lock(&p->mutex);
    p->texels += texels;
    const int stop = p->stop || brdffit_cli_interrupted();
    pthread_mutex_unlock(&p->mutex);
    return stop;
}

/* A tile that nobody has; 0 when there is none, or reason to stop. */
static int take(struct pool *p, size_t *tile)
{
    pthread_mutex_lock(&p->mutex);
    while (p->next < p->map->tiles && p->done[p->next]) {
        p->next++;
    }
    const int got = !p->stop && !brdffit_cli_interrupted() && p->next < p->map->tiles;
    *tile = p->next;
    p->next += (size_t)got;
    pthread_mutex_unlock(&p->mutex);
    return got;
}

static void *work(void *user)
{
    struct pool *const p = user;
    struct cli_map_worker *const worker = brdffit_cli_map_worker(p->map);
    int code = worker == NULL ? brdffit_cli_no_memory() : 0;
    for (size_t tile; code == 0 && take(p, &tile);) {
        int stale = 0;
        code = brdffit_cli_map_tile(worker, tile, &stale, tick, p);
        pthread_mutex_lock(&p->mutex);
        p->stale += stale > 0;
        pthread_mutex_unlock(&p->mutex);
    }
    brdffit_cli_map_worker_free(worker);
    pthread_mutex_lock(&p->mutex);
    if (code > 0) {
        p->code = brdffit_cli_worse_exit(p->code, code);
        p->stop = 1;
    }
    p->running--;
    pthread_cond_signal(&p->changed);
    pthread_mutex_unlock(&p->mutex);
    return NULL;
}

/* Until the last thread is done: the line of progress. */
static void watch(struct pool *p, struct cli_progress *progress)
{
    pthread_mutex_lock(&p->mutex);
    while (p->running > 0) {
        struct timespec until;
        (void)clock_gettime(CLOCK_REALTIME, &until);
        until.tv_nsec += 200000000;
        until.tv_sec += until.tv_nsec / 1000000000;
        until.tv_nsec %= 1000000000;
        (void)pthread_cond_timedwait(&p->changed, &p->mutex, &until);
        const size_t texels = p->texels;
        pthread_mutex_unlock(&p->mutex);
        brdffit_cli_progress_amount(progress, texels);
        pthread_mutex_lock(&p->mutex);
    }
    pthread_mutex_unlock(&p->mutex);
    brdffit_cli_progress_erase(progress);
}

static size_t texels_missing(const struct pool *p, size_t *tiles)
{
    size_t texels = 0;
    for (size_t tile = 0; tile < p->map->tiles; tile++) {
        texels += p->done[tile] || p->kept[tile] ? 0 : brdffit_cli_map_rows(p->map, tile) * p->map->width;
        *tiles += !p->done[tile];
    }
    return texels;
}

/* Signals are for the main thread. */
static size_t start(struct pool *p, pthread_t *threads, size_t wanted)
{
    sigset_t all, before;
    size_t started = 0;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_BLOCK, &all, &before);
    p->running = wanted;
    while (started < wanted && pthread_create(&threads[started], NULL, work, p) == 0) {
        started++;
    }
    pthread_mutex_lock(&p->mutex);
    p->running -= wanted - started;
    pthread_mutex_unlock(&p->mutex);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    return started;
}

static int run(struct pool *p, size_t threads, size_t *texels)
{
    struct cli_progress progress;
    size_t missing = 0;
    const size_t total = texels_missing(p, &missing);
    threads = threads < missing ? threads : missing;
    pthread_t *const ids = calloc(threads > 0 ? threads : 1, sizeof *ids);
    if (ids == NULL) {
        return brdffit_cli_no_memory();
    }
    brdffit_cli_progress_start(&progress, total, p->map->settings->quiet);
    progress.unit = "texels";
    const size_t started = start(p, ids, threads);
    watch(p, &progress);
    for (size_t i = 0; i < started; i++) {
        (void)pthread_join(ids[i], NULL);
    }
    free(ids);
    if (started == 0 && threads > 0) {
        brdffit_cli_tell("brdffit: no thread can be started\n");
        return CLI_EXIT_FAILURE;
    }
    *texels = p->texels;
    if (p->stale > 0) {
        brdffit_cli_tell("brdffit: %zu kept tile%s of other data than the files have now, and fitted again\n", p->stale,
                         p->stale == 1 ? " was" : "s were");
    }
    return p->code != 0 ? p->code : brdffit_cli_interrupted() ? -1 : 0;
}

int brdffit_cli_map_run(struct cli_map *map, size_t threads, double *seconds, size_t *texels)
{
    struct pool p;
    memset(&p, 0, sizeof p);
    p.map = map;
    p.done = calloc(map->tiles, 2);
    if (p.done == NULL) {
        return brdffit_cli_no_memory();
    }
    p.kept = p.done + map->tiles;
    for (size_t tile = 0; tile < map->tiles; tile++) {
        p.done[tile] = tile % map->settings->shard_count != map->settings->shard_index;
        p.kept[tile] = (unsigned char)(!p.done[tile] && map->resumed > 0 && brdffit_cli_map_has_tile(map, tile));
    }
    (void)pthread_mutex_init(&p.mutex, NULL);
    (void)pthread_cond_init(&p.changed, NULL);
    const double began = brdffit_cli_clock();
    const int code = run(&p, threads, texels);
    *seconds = brdffit_cli_clock() - began;
    map->resumed -= p.stale < map->resumed ? p.stale : map->resumed;
    (void)pthread_cond_destroy(&p.changed);
    (void)pthread_mutex_destroy(&p.mutex);
    free(p.done);
    return code;
}
