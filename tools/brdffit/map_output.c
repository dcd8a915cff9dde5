/* map_output.c: from tiles to maps: a folder of NPY or PFM, or one NPZ. All
 * is written in the work folder first; what the user named appears whole.
 * SPDX-License-Identifier: MIT
 *
 * PFM is float32: E^2 is rounded up and the lower bound down, so that what is
 * claimed stays true. */
#define _POSIX_C_SOURCE 200809L
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "json_fit.h"
#include "lobes.h"
#include "map.h"
#include "output.h"
#include "tell.h"
#include "terms.h"
#include "words.h"

enum field_kind {
    FIELD_SIGMA,
    FIELD_EXPONENT,
    FIELD_X,
    FIELD_Y,
    FIELD_E2,
    FIELD_BOUND,
    FIELD_F0,
    FIELD_X_MORE,
    FIELD_STATUS
};

struct field {
    enum field_kind kind;
    const char *name;
    int dims; /* beyond height and width */
    size_t shape[2], width; /* their sizes and product */
    size_t offset; /* doubles a texel of a tile before this one's */
};

#define FIELDS_MAX 9

typedef int (*sink_fn)(void *user, const void *data, size_t size);

struct writer {
    struct cli_map *map;
    struct field fields[FIELDS_MAX];
    size_t count;
    double *values;
    unsigned char *status;
    unsigned char *bytes; /* what goes to the sink */
    struct cli_map_counts total;
};

static void add_field(struct writer *w, enum field_kind kind, const char *name, int dims, size_t a, size_t b,
                      size_t offset)
{
    struct field *const f = &w->fields[w->count++];
    f->kind = kind;
    f->name = name;
    f->dims = dims;
    f->shape[0] = a;
    f->shape[1] = b;
    f->width = (dims > 0 ? a : 1) * (dims > 1 ? b : 1);
    f->offset = offset;
}

/* Where the model has them. */
static void list_terms(struct writer *w, size_t offset)
{
    const size_t lobes = (size_t)w->map->options.lobes, channels = w->map->channels;
    const size_t more = brdffit_cli_more_columns(w->map->options.diffuse);
    if (w->map->options.fresnel != BRDFFIT_FRESNEL_NONE) {
        add_field(w, FIELD_F0, "f0", 2, channels, lobes, offset);
        offset += channels * lobes;
    }
    if (more > 0) {
        add_field(w, FIELD_X_MORE, "x_more", 2, channels, more, offset);
    }
}

static void list_fields(struct writer *w)
{
    const size_t lobes = (size_t)w->map->options.lobes, channels = w->map->channels;
    add_field(w, FIELD_SIGMA, "sigma", 1, lobes, 0, 0);
    if (brdffit_cli_any_lobe_by(&w->map->options, 1)) {
        add_field(w, FIELD_EXPONENT, "exponent", 1, lobes, 0, 0);
    }
    add_field(w, FIELD_X, "x", 1, channels, 0, lobes);
    add_field(w, FIELD_Y, "y", 2, channels, lobes, lobes + channels);
    add_field(w, FIELD_E2, "e2", 0, 0, 0, lobes + channels + channels * lobes);
    add_field(w, FIELD_BOUND, "lower_bound", 0, 0, 0, lobes + channels + channels * lobes + 1);
    list_terms(w, lobes + channels + channels * lobes + 2);
    add_field(w, FIELD_STATUS, "status", 0, 0, 0, 0);
}

/* An exponent of a lobe that is known by sigma is NaN. */
static double value_of(const struct writer *w, const struct field *f, size_t texels, size_t at)
{
    const double value = f->kind == FIELD_STATUS ? w->status[at] : w->values[f->offset * texels + at];
    if (f->kind != FIELD_EXPONENT) {
        return value;
    }
    return brdffit_cli_by_exponent(brdffit_cli_lobe(&w->map->options, (int)(at % f->width))) ? 1 / (value * value)
                                                                                             : NAN;
}

static int load(struct writer *w, size_t tile, struct cli_map_counts *counts)
{
    if (brdffit_cli_map_load_tile(w->map, tile, counts, w->values, w->status) == 0) {
        return 0;
    }
    brdffit_cli_tell("brdffit: %s: tile %zu cannot be read again; repeat the command\n", w->map->work, tile);
    return CLI_EXIT_FAILURE;
}

static size_t put_little(unsigned char *to, uint64_t bits, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        to[i] = (unsigned char)(bits >> 8 * i);
    }
    return size;
}

static size_t put_double(unsigned char *to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return put_little(to, bits, 8);
}

/* ---- NPY --------------------------------------------------------------- */

static uint64_t npy_start(const struct writer *w, const struct field *f, unsigned char header[BRDFFIT_IO_HEADER_MAX],
                          size_t *length)
{
    const int bytes = f->kind == FIELD_STATUS;
    const size_t shape[4] = {w->map->height, w->map->width, f->shape[0], f->shape[1]};
    *length = brdffit_io_npy_header(bytes ? 'u' : 'f', bytes ? 1 : 8, 2 + f->dims, shape, header);
    return *length + (uint64_t)w->map->height * w->map->width * f->width * (bytes ? 1 : 8);
}

/* The whole file of a map, in order, into a sink. 0 or an exit code. */
static int stream_npy(struct writer *w, const struct field *f, sink_fn sink, void *user)
{
    unsigned char header[BRDFFIT_IO_HEADER_MAX];
    size_t length;
    (void)npy_start(w, f, header, &length);
    if (sink(user, header, length) != 0) {
        return CLI_EXIT_FAILURE;
    }
    for (size_t tile = 0; tile < w->map->tiles; tile++) {
        const size_t texels = brdffit_cli_map_rows(w->map, tile) * w->map->width;
        size_t size = 0;
        const int code = load(w, tile, NULL);
        if (code != 0) {
            return code;
        }
        for (size_t i = 0; f->kind != FIELD_STATUS && i < texels * f->width; i++) {
            size += put_double(w->bytes + size, value_of(w, f, texels, i));
        }
        const int failed = f->kind == FIELD_STATUS ? sink(user, w->status, texels) : sink(user, w->bytes, size);
        if (failed) {
            return CLI_EXIT_FAILURE;
        }
    }
    return 0;
}

/* ---- PFM --------------------------------------------------------------- */

static float as_float(enum field_kind kind, double value)
{
    const float near = (float)value;
    if (kind == FIELD_E2 && near < value) {
        return nextafterf(near, INFINITY);
    }
    if (kind == FIELD_BOUND && near > value) {
        return nextafterf(near, 0);
    }
    return near;
}

/* Component `first` and, `step` apart, `channels` - 1 more, from the bottom up. */
static int stream_pfm(struct writer *w, const struct field *f, size_t first, size_t step, int channels, sink_fn sink,
                      void *user)
{
    unsigned char header[BRDFFIT_IO_HEADER_MAX];
    const size_t width = w->map->width;
    const size_t length = brdffit_io_pfm_header(width, w->map->height, channels, header);
    if (sink(user, header, length) != 0) {
        return CLI_EXIT_FAILURE;
    }
    for (size_t tile = w->map->tiles; tile-- > 0;) {
        const size_t rows = brdffit_cli_map_rows(w->map, tile);
        size_t size = 0;
        const int code = load(w, tile, NULL);
        if (code != 0) {
            return code;
        }
        for (size_t y = rows; y-- > 0;) {
            for (size_t i = 0; i < width * (size_t)channels; i++) {
                const size_t texel = y * width + i / (size_t)channels, k = first + i % (size_t)channels * step;
                const float value = as_float(f->kind, value_of(w, f, rows * width, texel * f->width + k));
                uint32_t bits;
                memcpy(&bits, &value, sizeof bits);
                size += put_little(w->bytes + size, bits, 4);
            }
        }
        if (sink(user, w->bytes, size) != 0) {
            return CLI_EXIT_FAILURE;
        }
    }
    return 0;
}

/* ---- Files ------------------------------------------------------------- */

static int to_file(void *user, const void *data, size_t size)
{
    struct cli_text view = {0};
    view.data = (char *)(uintptr_t)data;
    view.size = size;
    return brdffit_cli_output_add(user, &view);
}

/* Write out/NAME by `stream`, or as a PFM when it has channels. */
static int write_file(struct writer *w, const char *name, const struct field *f, size_t first, size_t step,
                      int channels)
{
    struct cli_output output;
    char inside[128];
    (void)snprintf(inside, sizeof inside, "out/%s", name);
    char *const path = brdffit_cli_map_path(w->map, inside);
    if (path == NULL) {
        return brdffit_cli_no_memory();
    }
    int code = brdffit_cli_output_replace(&output, path) != 0 ? CLI_EXIT_FAILURE : 0;
    if (code == 0) {
        code = channels == 0 ? stream_npy(w, f, to_file, &output)
                             : stream_pfm(w, f, first, step, channels, to_file, &output);
        if (code != 0) {
            brdffit_cli_output_abandon(&output);
        } else if (brdffit_cli_output_commit(&output) != 0) {
            code = CLI_EXIT_FAILURE;
        }
    }
    free(path);
    return code;
}

/* Three channels are a colour image; otherwise each has a file, counted from 1. */
static int write_pfm(struct writer *w, const struct field *f)
{
    const int colour = w->map->channels == 3 && (f->kind == FIELD_X || f->dims == 2);
    const size_t step = f->dims == 2 ? f->shape[1] : 1;
    char name[64];
    int code = 0;
    for (size_t i = 0; code == 0 && i < (colour ? step : f->width); i++) {
        if (f->width == 1 || (colour && f->kind == FIELD_X)) {
            (void)snprintf(name, sizeof name, "%s.pfm", f->name);
        } else if (f->dims == 2 && !colour) {
            (void)snprintf(name, sizeof name, "%s_%zu_%zu.pfm", f->name, i / step + 1, i % step + 1);
        } else {
            (void)snprintf(name, sizeof name, "%s_%zu.pfm", f->name, i + 1);
        }
        code = write_file(w, name, f, i, step, colour ? 3 : 1);
    }
    return code;
}

/* ---- A folder ---------------------------------------------------------- */

static int move(const char *from, const char *to, const char *name)
{
    struct cli_text a = {0}, b = {0};
    brdffit_cli_text_printf(&a, "%s/%s", from, name);
    brdffit_cli_text_printf(&b, "%s/%s", to, name);
    int code = a.failed || b.failed ? brdffit_cli_no_memory() : 0;
    if (code == 0 && rename(a.data, b.data) != 0) {
        brdffit_cli_tell("brdffit: %s: cannot write (%s)\n", b.data, strerror(errno));
        code = CLI_EXIT_FAILURE;
    }
    brdffit_cli_text_free(&a);
    brdffit_cli_text_free(&b);
    return code;
}

/* Into a folder that is there already: file by file, each whole. */
static int move_all(const char *out, const char *target)
{
    DIR *const stream = opendir(out);
    int code = 0;
    if (stream == NULL) {
        brdffit_cli_tell("brdffit: %s: cannot open the folder (%s)\n", out, strerror(errno));
        return CLI_EXIT_FAILURE;
    }
    for (const struct dirent *entry; code == 0 && (entry = readdir(stream)) != NULL;) {
        if (entry->d_name[0] != '.') {
            code = move(out, target, entry->d_name);
        }
    }
    (void)closedir(stream);
    return code;
}

/* One that is there already has to be one, and no link to another. */
static int make_folder(const char *path)
{
    struct stat about;
    if (mkdir(path, 0777) == 0) {
        return 0;
    }
    const int error = errno;
    if (error == EEXIST && lstat(path, &about) == 0 && S_ISDIR(about.st_mode)) {
        return 0;
    }
    brdffit_cli_tell("brdffit: %s: cannot create the folder (%s)\n", path, strerror(error));
    return CLI_EXIT_FAILURE;
}

static int write_folder(struct writer *w, const char *target)
{
    const int pfm = w->map->settings->map_format == CLI_MAP_PFM;
    char name[64];
    char *const out = brdffit_cli_map_path(w->map, "out");
    int code = out == NULL ? brdffit_cli_no_memory() : make_folder(out);
    for (size_t i = 0; code == 0 && i < w->count; i++) {
        (void)snprintf(name, sizeof name, "%s.npy", w->fields[i].name);
        code = pfm ? write_pfm(w, &w->fields[i]) : write_file(w, name, &w->fields[i], 0, 0, 0);
    }
    if (code == 0) {
        code = brdffit_cli_map_describe(w->map, &w->total);
    }
    if (code == 0 && rename(out, target) != 0) {
        code = move_all(out, target);
    }
    free(out);
    return code;
}

/* ---- One NPZ ----------------------------------------------------------- */

static int to_checksum(void *user, const void *data, size_t size)
{
    unsigned long *const crc = user;
    *crc = brdffit_io_crc32(*crc, data, size);
    return 0;
}

static int to_zip(void *user, const void *data, size_t size)
{
    return brdffit_io_zip_write(user, data, size) == BRDFFIT_OK ? 0 : -1;
}

/* What to_file() refused it has told. */
static int zip_code(brdffit_status status)
{
    return status == BRDFFIT_OK ? 0 : status == BRDFFIT_ERR_MEMORY ? brdffit_cli_no_memory() : CLI_EXIT_FAILURE;
}

static int write_members(struct writer *w, brdffit_io_zip *zip)
{
    for (size_t i = 0; i < w->count; i++) {
        const struct field *const f = &w->fields[i];
        unsigned char header[BRDFFIT_IO_HEADER_MAX];
        unsigned long crc = 0;
        size_t length;
        char name[64];
        (void)snprintf(name, sizeof name, "%s.npy", f->name);
        int code = stream_npy(w, f, to_checksum, &crc);
        if (code == 0) {
            code = zip_code(brdffit_io_zip_begin(zip, name, npy_start(w, f, header, &length), crc));
        }
        if (code == 0) {
            code = stream_npy(w, f, to_zip, zip);
        }
        if (code != 0) {
            return code;
        }
    }
    return 0;
}

static int write_npz(struct writer *w, const char *target)
{
    struct cli_output output;
    if (brdffit_cli_output_open(&output, target) != 0) {
        return CLI_EXIT_FAILURE;
    }
    brdffit_io_zip *const zip = brdffit_io_zip_new(to_file, &output);
    int code = zip == NULL ? brdffit_cli_no_memory() : write_members(w, zip);
    if (zip != NULL && brdffit_io_zip_finish(zip, code != 0) != BRDFFIT_OK) {
        code = CLI_EXIT_FAILURE;
    }
    if (code != 0) {
        brdffit_cli_output_abandon(&output);
    } else if (brdffit_cli_output_commit(&output) != 0) {
        code = CLI_EXIT_FAILURE;
    }
    return code;
}

/* ---- All --------------------------------------------------------------- */

static int add_up(struct writer *w)
{
    memset(&w->total, 0, sizeof w->total);
    w->total.bad_texel = UINT64_MAX;
    for (size_t tile = 0; tile < w->map->tiles; tile++) {
        struct cli_map_counts counts;
        const int code = load(w, tile, &counts);
        if (code != 0) {
            return code;
        }
        brdffit_cli_map_add(&w->total, &counts);
    }
    return 0;
}

int brdffit_cli_map_write(struct cli_map *map, const char *target, struct cli_map_counts *counts)
{
    const size_t texels = map->tile_rows * map->width, length = strlen(target);
    const int npz = length > 4 && strcmp(target + length - 4, ".npz") == 0;
    struct writer w;
    memset(&w, 0, sizeof w);
    w.map = map;
    w.values = malloc(texels * brdffit_cli_map_depth(map) * sizeof *w.values);
    w.bytes = malloc(texels * brdffit_cli_map_depth(map) * sizeof *w.values);
    w.status = malloc(texels);
    int code = w.values == NULL || w.bytes == NULL || w.status == NULL ? brdffit_cli_no_memory() : 0;
    list_fields(&w);
    if (code == 0) {
        code = add_up(&w);
    }
    if (code == 0) {
        code = npz ? write_npz(&w, target) : write_folder(&w, target);
    }
    *counts = w.total;
    free(w.values);
    free(w.bytes);
    free(w.status);
    return code;
}
