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

/* As long as a path that open() takes can be. */
#define PATH_MOST 4096

static int cannot_write(const char *path)
{
    brdffit_cli_tell("brdffit: %s: cannot write (%s)\n", path, strerror(errno));
    return CLI_EXIT_FAILURE;
}

/* 1 when it fits. Looking for a tile takes no memory: that there is none would pass for a tile that is not there. */
static int tile_path(const struct cli_map *map, size_t tile, char path[PATH_MOST])
{
    const int length = snprintf(path, PATH_MOST, "%s/tile-%zu", map->work, tile);
    return length > 0 && length < PATH_MOST;
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
    char path[PATH_MOST];
    describe_tile(map, tile, &header);
    header.data = data;
    header.counts = *counts;
    if (!tile_path(map, tile, path)) {
        errno = ENAMETOOLONG;
        return cannot_write(map->work);
    }
    return write_tile(path, &header, values, status);
}

/* ---- Reading ----------------------------------------------------------- */

static int open_tile(const struct cli_map *map, size_t tile)
{
    char path[PATH_MOST];
    return tile_path(map, tile, path) ? open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC) : -1;
}

static int get(int file, void *data, size_t size, unsigned long *crc)
{
    unsigned char *at = data;
    for (size_t left = size; left > 0;) {
        const ssize_t got = read(file, at, left < 1u << 30 ? left : 1u << 30);
        if (got <= 0 && !(got < 0 && errno == EINTR)) {
            return -1;
        }
        at += got > 0 ? got : 0;
        left -= got > 0 ? (size_t)got : 0;
    }
    *crc = brdffit_io_crc32(*crc, data, size);
    return 0;
}

/* 1 when the header is that of this tile, of this run. */
static int get_header(const struct cli_map *map, size_t tile, int file, struct tile_header *header, unsigned long *crc)
{
    struct tile_header wanted;
    describe_tile(map, tile, &wanted);
    return get(file, header, sizeof *header, crc) == 0 &&
           memcmp(header, &wanted, offsetof(struct tile_header, data)) == 0;
}

/* What follows the content: its checksum, and nothing. */
static int ends_well(int file, unsigned long crc)
{
    unsigned long ignored = 0;
    uint64_t sum = 0;
    char more;
    return get(file, &sum, sizeof sum, &ignored) == 0 && sum == crc && read(file, &more, 1) == 0;
}

int brdffit_cli_map_load_tile(const struct cli_map *map, size_t tile, struct cli_map_counts *counts, double *values,
                              unsigned char *status)
{
    struct tile_header header;
    unsigned long crc = 0;
    const int file = open_tile(map, tile);
    if (file < 0) {
        return -1;
    }
    const int good = get_header(map, tile, file, &header, &crc) &&
                     get(file, values, header.texels * header.depth * sizeof *values, &crc) == 0 &&
                     get(file, status, header.texels, &crc) == 0 && ends_well(file, crc);
    (void)close(file);
    if (good && counts != NULL) {
        *counts = header.counts;
    }
    return good ? 0 : -1;
}

int brdffit_cli_map_tile_data(const struct cli_map *map, size_t tile, uint64_t *data)
{
    struct tile_header header;
    unsigned long crc = 0;
    unsigned char block[16384];
    const int file = open_tile(map, tile);
    if (file < 0) {
        return 0;
    }
    int good = get_header(map, tile, file, &header, &crc);
    for (uint64_t left = good ? header.texels * (header.depth * sizeof(double) + 1) : 0; good && left > 0;) {
        const size_t size = left < sizeof block ? (size_t)left : sizeof block;
        good = get(file, block, size, &crc) == 0;
        left -= size;
    }
    good = good && ends_well(file, crc);
    (void)close(file);
    *data = good ? header.data : 0;
    return good;
}

int brdffit_cli_map_has_tile(const struct cli_map *map, size_t tile)
{
    uint64_t data;
    return brdffit_cli_map_tile_data(map, tile, &data);
}
