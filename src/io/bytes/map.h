/*
 * A regular file as memory, for one sweep over it. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_MAP_H
#define BRDFFIT_IO_MAP_H

#include <stddef.h>

struct io_map {
    const unsigned char *data; /* NULL: nothing is mapped */
    size_t size;
    int borrowed; /* somebody else's memory: not unmapped */
};

/* 0 when the file cannot be mapped, for whatever reason: reading it will tell. errno is kept. */
int brdffit_io_map(const char *path, size_t limit, struct io_map *map);
void brdffit_io_unmap(struct io_map *map);

#endif
