/*
 * Mapped files: see map.h. SPDX-License-Identifier: MIT
 *
 * Mapping saves the copy of read(2), which takes longer than everything else that is done to a MERL table. Its price
 * is in brdffit_io.h: whoever truncates the file meanwhile ends the process with SIGBUS.
 */
#define _DEFAULT_SOURCE
#include "io/bytes/map.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static void map_descriptor(int descriptor, size_t limit, struct io_map *map)
{
    struct stat about;
    void *data;

    if (fstat(descriptor, &about) != 0 || !S_ISREG(about.st_mode) || about.st_size <= 0 ||
        (unsigned long long)about.st_size > limit) {
        return;
    }
    data = mmap(NULL, (size_t)about.st_size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (data != MAP_FAILED) {
        map->data = data;
        map->size = (size_t)about.st_size;
    }
}

/* A pipe must not even be opened: its writer would see a reader come and go. */
static int is_regular(const char *path)
{
    struct stat about;

    return strcmp(path, "-") != 0 && stat(path, &about) == 0 && S_ISREG(about.st_mode);
}

int brdffit_io_map(const char *path, size_t limit, struct io_map *map)
{
    int saved = errno, descriptor;

    map->data = NULL;
    map->size = 0;
    map->borrowed = 0;
    descriptor = is_regular(path) ? open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK) : -1;
    if (descriptor >= 0) {
        map_descriptor(descriptor, limit, map);
        (void)close(descriptor);
    }
    errno = saved;
    return map->data != NULL;
}

void brdffit_io_unmap(struct io_map *map)
{
    if (map->data && !map->borrowed) {
        (void)munmap((void *)(uintptr_t)map->data, map->size);
    }
    map->data = NULL;
    map->size = 0;
}
