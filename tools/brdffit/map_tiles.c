/* map_tiles.c: the tiles that the work folder keeps: header, counts, values, statuses, checksum.
 * SPDX-License-Identifier: MIT
 *
 * A tile bears the hash of its run's manifest, and of the data that it was fitted to. One that is damaged, of another
 * run, or not whole is as good as none. */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "map.h"
#include "tell.h"
#include "temporary.h"

struct tile_header {
    char magic[8];
    uint64_t key, tile, texels, depth;
    uint64_t data; /* hash of what it was fitted to */
    struct cli_map_counts counts;
};

static const char tile_magic[8] = "BRDFTIL2";

static int cannot_write(const char *path)
{
    brdffit_cli_tell("brdffit: %s: cannot write (%s)\n", path, strerror(errno));
    return CLI_EXIT_FAILURE;
}

static char *tile_path(const struct cli_map *map, size_t tile)
{
    char name[64];
    (void)snprintf(name, sizeof name, "tile-%zu", tile);
    return brdffit_cli_map_path(map, name);
}

static void describe_tile(const struct cli_map *map, size_t tile, struct tile_header *header)
{
    memset(header, 0, sizeof *header);
    memcpy(header->magic, tile_magic, sizeof header->magic);
    header->key = map->key;
    header->tile = tile;
    header->texels = brdffit_cli_map_rows(map, tile) * map->width;
    header->depth = brdffit_cli_map_depth(map);
}

static int put(FILE *file, const void *data, size_t size, unsigned long *crc)
{
    *crc = brdffit_io_crc32(*crc, data, size);
    return fwrite(data, 1, size, file) == size ? 0 : -1;
}

static int get(FILE *file, void *data, size_t size, unsigned long *crc)
{
    if (fread(data, 1, size, file) != size) {
        return -1;
    }
    *crc = brdffit_io_crc32(*crc, data, size);
    return 0;
}

static int put_tile(FILE *file, const struct tile_header *header, const double *values, const unsigned char *status)
{
    unsigned long crc = 0;
    const int failed = put(file, header, sizeof *header, &crc) ||
                       put(file, values, header->texels * header->depth * sizeof *values, &crc) ||
                       put(file, status, header->texels, &crc);
    const uint64_t sum = crc;
    return failed || fwrite(&sum, sizeof sum, 1, file) != 1 || fflush(file) != 0 || fsync(fileno(file)) != 0 ? -1 : 0;
}

/* Under a name of its own until it is whole: another run of the same part may be at the same tile. */
static int write_tile(const char *path, const struct tile_header *header, const double *values,
                      const unsigned char *status)
{
    char *temporary;
    const int descriptor = brdffit_cli_temporary(path, 0666, &temporary);
    FILE *const file = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
    if (descriptor >= 0 && file == NULL) {
        (void)close(descriptor);
    }
    int failed = file == NULL || put_tile(file, header, values, status) != 0 || rename(temporary, path) != 0;
    const int error = errno;
    if (failed && temporary != NULL) {
        (void)unlink(temporary);
    }
    if (file != NULL) {
        (void)fclose(file); /* synced, or given up */
    }
    free(temporary);
    errno = error;
    return failed ? cannot_write(path) : 0;
}

int brdffit_cli_map_keep_tile(const struct cli_map *map, size_t tile, uint64_t data,
                              const struct cli_map_counts *counts, const double *values, const unsigned char *status)
{
    struct tile_header header;
    char *const path = tile_path(map, tile);
    describe_tile(map, tile, &header);
    header.data = data;
    header.counts = *counts;
    const int code = path == NULL ? brdffit_cli_no_memory() : write_tile(path, &header, values, status);
    free(path);
    return code;
}

static FILE *open_tile(const struct cli_map *map, size_t tile)
{
    char *const path = tile_path(map, tile);
    const int descriptor = path != NULL ? open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC) : -1;
    FILE *const file = descriptor < 0 ? NULL : fdopen(descriptor, "rb");
    if (descriptor >= 0 && file == NULL) {
        (void)close(descriptor);
    }
    free(path);
    return file;
}

/* 1 when the header is that of this tile, of this run. */
static int get_header(const struct cli_map *map, size_t tile, FILE *file, struct tile_header *header,
                      unsigned long *crc)
{
    struct tile_header wanted;
    describe_tile(map, tile, &wanted);
    return get(file, header, sizeof *header, crc) == 0 &&
           memcmp(header, &wanted, offsetof(struct tile_header, data)) == 0;
}

int brdffit_cli_map_load_tile(const struct cli_map *map, size_t tile, struct cli_map_counts *counts, double *values,
                              unsigned char *status)
{
    struct tile_header header;
    unsigned long crc = 0;
    uint64_t sum = 0;
    FILE *const file = open_tile(map, tile);
    if (file == NULL) {
        return -1;
    }
    const int failed = !get_header(map, tile, file, &header, &crc) ||
                       get(file, values, header.texels * header.depth * sizeof *values, &crc) ||
                       get(file, status, header.texels, &crc) || fread(&sum, sizeof sum, 1, file) != 1 || sum != crc ||
                       fgetc(file) != EOF;
    (void)fclose(file);
    if (!failed && counts != NULL) {
        *counts = header.counts;
    }
    return failed ? -1 : 0;
}

int brdffit_cli_map_has_tile(const struct cli_map *map, size_t tile)
{
    const size_t texels = brdffit_cli_map_rows(map, tile) * map->width;
    FILE *const file = open_tile(map, tile);
    if (file == NULL) {
        return 0;
    }
    (void)fclose(file);
    double *const values = malloc(texels * brdffit_cli_map_depth(map) * sizeof *values);
    unsigned char *const status = malloc(texels);
    const int good = values != NULL && status != NULL &&
                     brdffit_cli_map_load_tile(map, tile, NULL, values, status) == 0;
    free(values);
    free(status);
    return good;
}

int brdffit_cli_map_tile_data(const struct cli_map *map, size_t tile, uint64_t *data)
{
    struct tile_header header;
    unsigned long crc = 0;
    FILE *const file = brdffit_cli_map_has_tile(map, tile) ? open_tile(map, tile) : NULL;
    const int there = file != NULL && get_header(map, tile, file, &header, &crc);
    if (file != NULL) {
        (void)fclose(file);
    }
    *data = there ? header.data : 0;
    return there;
}
