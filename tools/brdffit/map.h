/* map.h: fitting every texel of a stack of images. What the files map_*.c
 * share. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_MAP_H
#define BRDFFIT_CLI_MAP_H

#include <stdint.h>

#include "brdffit.h"
#include "brdffit_io.h"
#include "failure.h"
#include "settings.h"
#include "text.h"

/* A texel whose own geometry leaves no sample: beyond brdffit_texel_status. */
#define CLI_TEXEL_NO_SAMPLES BRDFFIT_TEXEL_STATUS_COUNT
#define CLI_TEXEL_COUNT (BRDFFIT_TEXEL_STATUS_COUNT + 1)

/* What happened in one tile, or in all of them. Only counts, all 64 bits:
 * written to the tile's file as it is. */
struct cli_map_counts {
    uint64_t status[CLI_TEXEL_COUNT];
    uint64_t equal, general, zero_channels, equal_channels, boxes, nodes, one_lobe_enough;
    uint64_t skipped[BRDFFIT_SKIP_COUNT]; /* samples, of texels with a geometry of their own */
    uint64_t bad_texel;                   /* the first of them; UINT64_MAX: none */
    uint64_t bad_where;                   /* sample * channels + channel */
};

struct cli_map {
    const struct cli_settings *settings;
    brdffit_options options;

    /* The stack: one array, or a file a sample. */
    size_t samples, height, width, channels;
    brdffit_array *stack;
    char **images; /* `samples` paths; NULL: the stack is one array */
    int png;       /* they are PNG, and become an array in the work folder */
    struct cli_text identity; /* of the manifest, a line each file: role, path, size, shape */
    struct cli_text times;    /* and when it was written */
    struct cli_map_input *inputs; /* the files as they were when they were opened */
    size_t input_count;

    /* The geometry: shared by all texels, or with arrays a texel. */
    brdffit_table *table; /* owns what `geometry` points to, or NULL */
    double *light, *view; /* or these do */
    brdffit_samples geometry;
    brdffit_array *light_map, *view_map, *normal_map, *mask;
    int general; /* a texel has directions of its own */
    void *plan_memory;
    const brdffit_plan *plan;
    size_t shared_skipped[BRDFFIT_SKIP_COUNT];

    /* The work: tiles of whole rows. */
    size_t tile_rows, tiles;
    char *work;   /* the work folder */
    int lock;     /* its lock file; -1: none */
    uint64_t key; /* of the manifest: a tile of another run has another */
    size_t resumed; /* tiles that were there already */
};

/* Doubles of the maps, a texel: sigma, x, y, e2, lower_bound, and f0 and x_more
 * where the model has them; its status follows as a byte. */
size_t brdffit_cli_map_depth(const struct cli_map *map);

/* Rows of a tile: the last one may have fewer. */
size_t brdffit_cli_map_rows(const struct cli_map *map, size_t tile);

/* map_input.c: open and check everything. 0, or an exit code with the reason
 * on stderr. */
int brdffit_cli_map_open(struct cli_map *map, const struct cli_settings *settings);
void brdffit_cli_map_close(struct cli_map *map);

/* An array, from FILE or FILE.npz:NAME; recorded in `identity` as `role`. */
int brdffit_cli_map_array(struct cli_map *map, const char *role, const char *path, brdffit_array **array);

/* "84 x 64 x 64 x 3" */
void brdffit_cli_map_shape(struct cli_text *text, const brdffit_array *array);

/* map_identity.c: before a file is opened: as what it is known from now on. */
void brdffit_cli_map_watch(struct cli_map *map, const char *path);

/* A line of `identity` and of `times` about the file watched last. `array` may be NULL. */
void brdffit_cli_map_record(struct cli_map *map, const char *role, const char *path, const brdffit_array *array);

/* The content of what all texels share, as a line of `identity`. */
void brdffit_cli_map_record_content(struct cli_map *map, const char *role, const void *data, size_t size);

/* Go on hashing: no protection from malice, but no two stacks that people have. */
uint64_t brdffit_cli_map_hash(uint64_t hash, const void *data, size_t size);

/* 0, or CLI_EXIT_FAILURE when a file is not what it was when the run began: the reason is on stderr. */
int brdffit_cli_map_unchanged(const struct cli_map *map);
void brdffit_cli_map_forget_inputs(struct cli_map *map);

/* map_images.c: a folder, or the files of a list. `list` is a CSV text whose
 * column `file` is taken out; *found tells whether it had one. */
int brdffit_cli_map_take_files(struct cli_map *map, struct cli_text *list, const char *path, const char *folder,
                               int *found);
int brdffit_cli_map_folder(struct cli_map *map, const char *folder);
int brdffit_cli_map_images(struct cli_map *map);

/* map_png.c */
int brdffit_cli_png_shape(const char *path, size_t shape[3]);
int brdffit_cli_png_unpack(struct cli_map *map);

/* map_work.c: the work folder. */
uint64_t brdffit_cli_map_key(const char *manifest);
int brdffit_cli_map_begin(struct cli_map *map, const char *target);
char *brdffit_cli_map_path(const struct cli_map *map, const char *name);
void brdffit_cli_map_forget(struct cli_map *map);

/* Find and lock the work folder that parts have filled. */
int brdffit_cli_map_reopen(struct cli_map *map, const char *target);

/* map_tiles.c: the tiles in it. */
int brdffit_cli_map_has_tile(const struct cli_map *map, size_t tile);

/* The hash of the data that a kept tile was fitted to; 0: there is none. */
int brdffit_cli_map_tile_data(const struct cli_map *map, size_t tile, uint64_t *data);
int brdffit_cli_map_keep_tile(const struct cli_map *map, size_t tile, uint64_t data,
                              const struct cli_map_counts *counts, const double *values, const unsigned char *status);
int brdffit_cli_map_load_tile(const struct cli_map *map, size_t tile, struct cli_map_counts *counts, double *values,
                              unsigned char *status);

/* map_fit.c: one tile. A worker has its own memory. */
struct cli_map_worker;
struct cli_map_worker *brdffit_cli_map_worker(const struct cli_map *map);
void brdffit_cli_map_worker_free(struct cli_map_worker *worker);
size_t brdffit_cli_map_worker_bytes(const struct cli_map *map);

/* Called with texels done since the last call; non-zero: stop. */
typedef int (*cli_map_tick)(void *user, size_t texels);

/* 0; -1: stopped; else an exit code with the reason on stderr. A tile that is there already, fitted to the same data,
 * stays; of other data, it is counted in *stale and fitted again. */
int brdffit_cli_map_tile(struct cli_map_worker *worker, size_t tile, int *stale, cli_map_tick tick, void *user);

/* map_run.c: all tiles that are missing, in threads. As above. */
int brdffit_cli_map_run(struct cli_map *map, size_t threads, double *seconds, size_t *texels);
size_t brdffit_cli_processors(void);

/* map_output.c: tiles to maps. */
int brdffit_cli_map_write(struct cli_map *map, const char *target, struct cli_map_counts *counts);
void brdffit_cli_map_add(struct cli_map_counts *sum, const struct cli_map_counts *counts);

/* Write out/map.json of the work folder: nothing in it depends on threads, tiles or time. An exit code. */
int brdffit_cli_map_describe(const struct cli_map *map, const struct cli_map_counts *total);

/* map_report.c: in words on standard output, and the exit code. `threads` 0:
 * nothing was fitted, the maps were only put together. */
void brdffit_cli_map_report(const struct cli_map *map, const char *target, const struct cli_map_counts *counts,
                            size_t threads, double seconds, size_t texels);
int brdffit_cli_map_finish(const struct cli_map *map, const struct cli_map_counts *counts);
int brdffit_cli_map_is_npz(const char *path);

/* cmd_map.c: 0 when maps can be written to `target`. */
int brdffit_cli_map_check_target(const struct cli_settings *settings, const char *target);

#endif
