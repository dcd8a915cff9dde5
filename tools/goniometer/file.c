/* file.c: a file built in memory and written whole or not at all.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void brdffit_gonio_add(struct gonio_file *file, const void *bytes, size_t size)
{
    if (file->failed) {
        return;
    }
    if (file->capacity - file->size < size) {
        const size_t wanted = file->size + size;
        const size_t capacity = wanted > SIZE_MAX / 2 ? 0 : 2 * wanted;
        char *const data = capacity == 0 ? NULL : realloc(file->data, capacity);
        if (data == NULL) {
            file->failed = 1;
            return;
        }
        file->data = data;
        file->capacity = capacity;
    }
    memcpy(file->data + file->size, bytes, size);
    file->size += size;
}

void brdffit_gonio_printf(struct gonio_file *file, const char *format, ...)
{
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    const int size = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (size < 0 || (size_t)size >= sizeof line) {
        file->failed = 1;
    } else {
        brdffit_gonio_add(file, line, (size_t)size);
    }
}

static int write_all(int descriptor, const char *data, size_t size)
{
    while (size > 0) {
        const ssize_t written = write(descriptor, data, size);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written < 0) {
            return -1;
        }
        data += written;
        size -= (size_t)written;
    }
    return 0;
}

/* Write `temporary`, then let it become `path`. */
static int replace(const struct gonio_file *file, const char *temporary, const char *path)
{
    const int descriptor = open(temporary, O_WRONLY | O_CREAT | O_EXCL, 0666);
    if (descriptor < 0) {
        return -1;
    }
    int failed = write_all(descriptor, file->data, file->size) != 0 || fsync(descriptor) != 0;
    int error = errno;
    if (close(descriptor) != 0 && !failed) {
        failed = 1;
        error = errno;
    }
    if (!failed && rename(temporary, path) == 0) {
        return 0;
    }
    if (!failed) {
        error = errno;
    }
    (void)unlink(temporary);
    errno = error;
    return -1;
}

int brdffit_gonio_write(struct gonio_file *file, const char *folder, const char *name)
{
    const size_t size = strlen(folder) + strlen(name) + 64;
    char *const paths = malloc(2 * size);
    int result = -1;
    if (paths == NULL || file->failed) {
        fprintf(stderr, "goniometer: %s/%s: out of memory\n", folder, name);
    } else {
        char *const temporary = paths + size;
        (void)snprintf(paths, size, "%s/%s", folder, name);
        (void)snprintf(temporary, size, "%s/.%s-%ld.tmp", folder, name, (long)getpid());
        result = replace(file, temporary, paths);
        if (result != 0) {
            fprintf(stderr, "goniometer: %s: cannot write: %s\n", paths, strerror(errno));
        }
    }
    free(paths);
    free(file->data);
    memset(file, 0, sizeof *file);
    return result;
}
