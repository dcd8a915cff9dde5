/*
 * A whole file into memory: see source.h. SPDX-License-Identifier: MIT
 *
 * Plain read(2) into one buffer: a mapping would turn a file that shrinks meanwhile into a signal. A regular
 * file's size is only a hint for the first allocation; the end of the data is where read() says it is.
 */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64
#include "io/bytes/source.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include "io/fail.h"

/* Largest single request; some systems refuse more than INT_MAX. */
#define CHUNK ((size_t)1 << 30)

static const char *reason(int code)
{
    switch (code) {
    case ENOENT: return "there is no such file";
    case EACCES:
    case EPERM: return "no permission to read the file";
    case EISDIR: return "it is a directory, not a file";
    case ENOTDIR: return "a part of the path is not a directory";
    case ENAMETOOLONG: return "the file name is too long";
    case ELOOP: return "the path has too many symbolic links";
    case EMFILE:
    case ENFILE: return "too many files are open";
    default: return NULL;
    }
}

static brdffit_status system_failure(brdffit_error *error, brdffit_status status, const char *general, int saved)
{
    const char *message = reason(errno);

    if (message) {
        errno = saved;
    }
    return brdffit_io_fail(error, status, message ? message : general);
}

static brdffit_status too_large(brdffit_error *error, size_t limit)
{
    return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT, "the file is larger than the limit (max_bytes) in bytes",
                                 (double)limit);
}

static brdffit_status prepare(int descriptor, size_t limit, struct io_bytes *out, brdffit_error *error)
{
    struct stat about;

    if (fstat(descriptor, &about) != 0) {
        return BRDFFIT_OK; /* a hint only; read() will say what is wrong */
    }
    if (S_ISDIR(about.st_mode)) {
        return brdffit_io_fail(error, BRDFFIT_ERR_OPEN, reason(EISDIR));
    }
    if (!S_ISREG(about.st_mode) || about.st_size <= 0) {
        return BRDFFIT_OK;
    }
    if ((unsigned long long)about.st_size > limit) {
        return too_large(error, limit);
    }
    /* One byte more, so that the end of file is seen without growing. */
    return brdffit_io_bytes_reserve(out, (size_t)about.st_size + 1) ? BRDFFIT_OK : brdffit_io_no_memory(error);
}

static brdffit_status drain(int descriptor, size_t limit, struct io_bytes *out, int saved, brdffit_error *error)
{
    for (;;) {
        size_t room;
        ssize_t got;

        if (out->size > limit) {
            return too_large(error, limit);
        }
        if (!brdffit_io_bytes_grow(out, limit + 1)) {
            return brdffit_io_no_memory(error);
        }
        room = out->capacity - out->size;
        got = read(descriptor, out->data + out->size, room < CHUNK ? room : CHUNK);
        if (got == 0) {
            return BRDFFIT_OK;
        }
        if (got > 0) {
            out->size += (size_t)got;
        } else if (errno != EINTR) {
            return system_failure(error, BRDFFIT_ERR_READ, "reading the file failed", saved);
        }
    }
}

static int open_file(const char *path)
{
    int descriptor;

    do {
        descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY);
    } while (descriptor < 0 && errno == EINTR);
    return descriptor;
}

brdffit_status brdffit_io_source_open(const char *path, int *descriptor, uint64_t *size, brdffit_error *error)
{
    int saved = errno;
    struct stat about;
    brdffit_status status = BRDFFIT_OK;

    *descriptor = open_file(path);
    if (*descriptor < 0) {
        return system_failure(error, BRDFFIT_ERR_OPEN, "the file cannot be opened", saved);
    }
    if (fstat(*descriptor, &about) != 0) {
        status = system_failure(error, BRDFFIT_ERR_READ, "reading the file failed", saved);
    } else if (S_ISDIR(about.st_mode)) {
        status = brdffit_io_fail(error, BRDFFIT_ERR_OPEN, reason(EISDIR));
    } else if (!S_ISREG(about.st_mode)) {
        status = brdffit_io_fail(error, BRDFFIT_ERR_OPEN,
                                 "it is no regular file: arrays are read at any place, not from front to back");
    } else {
        *size = (uint64_t)about.st_size;
    }
    if (status != BRDFFIT_OK) {
        (void)close(*descriptor);
        *descriptor = -1;
    }
    return status;
}

brdffit_status brdffit_io_source_read(const char *path, size_t limit, struct io_bytes *out, brdffit_error *error)
{
    int saved = errno;
    int standard_input = strcmp(path, "-") == 0;
    int descriptor = STDIN_FILENO;
    int code;
    brdffit_status status;

    if (!standard_input) {
        descriptor = open_file(path);
    }
    if (descriptor < 0) {
        return system_failure(error, BRDFFIT_ERR_OPEN, "the file cannot be opened", saved);
    }
    status = prepare(descriptor, limit, out, error);
    if (status == BRDFFIT_OK) {
        status = drain(descriptor, limit, out, saved, error);
    }
    code = status == BRDFFIT_ERR_READ ? errno : saved;
    if (!standard_input) {
        (void)close(descriptor); /* nothing was written: nothing to lose */
    }
    errno = code;
    return status;
}
