/* temporary.c: files that are written beside their target and then renamed. SPDX-License-Identifier: MIT
 *
 * .brdffit-PROCESS-NUMBER.tmp is locked by its writer as long as it is written: the lock dies with the process, whatever
 * ends it, and on a shared file system holds against other machines too, where the number of a process says nothing. So
 * a file of ours that can be locked is nobody's any more. Between its making and its locking a sweep may take a file
 * away: the writer looks whether it is there, and makes another one. Where there are no locks nothing is swept. */
#define _POSIX_C_SOURCE 200809L
#include "temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define ATTEMPTS 10000u

static size_t folder_length(const char *target)
{
    const char *const slash = strrchr(target, '/');
    return slash == NULL ? 0 : (size_t)(slash - target) + 1;
}

static int lock(int descriptor)
{
    struct flock whole;
    memset(&whole, 0, sizeof whole);
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    return fcntl(descriptor, F_SETLK, &whole);
}

/* 0 when a sweep was faster. A file system without locks has no sweeps either. */
static int keep(int descriptor)
{
    struct stat about;
    if (lock(descriptor) != 0 && (errno == EACCES || errno == EAGAIN)) {
        return 0;
    }
    return fstat(descriptor, &about) == 0 && about.st_nlink > 0;
}

int brdffit_cli_temporary(const char *target, mode_t mode, char **path)
{
    const size_t folder = folder_length(target), size = folder + 64;
    char *const name = malloc(size);
    int descriptor = -1;
    *path = NULL;
    if (name == NULL) {
        errno = ENOMEM;
        return -1;
    }
    for (unsigned attempt = 0; descriptor < 0 && attempt < ATTEMPTS; attempt++) {
        (void)snprintf(name, size, "%.*s.brdffit-%ld-%u.tmp", (int)folder, target, (long)getpid(), attempt);
        descriptor = open(name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
        if (descriptor < 0 && errno != EEXIST) {
            break;
        }
        if (descriptor >= 0 && !keep(descriptor)) {
            (void)close(descriptor);
            descriptor = -1;
        }
    }
    const int error = errno;
    if (descriptor < 0) {
        free(name);
    } else {
        *path = name;
    }
    errno = error;
    return descriptor;
}

/* .brdffit-PROCESS-NUMBER.tmp, but not of this process: its own lock would not stop it. */
static int is_temporary(const char *name)
{
    long process;
    unsigned number;
    int end = 0;
    return sscanf(name, ".brdffit-%ld-%u.tmp%n", &process, &number, &end) == 2 && end > 0 && name[end] == '\0' &&
           process != (long)getpid();
}

static void remove_dead(int folder, const char *name)
{
    struct stat about;
    const int descriptor = openat(folder, name, O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) {
        return;
    }
    if (fstat(descriptor, &about) == 0 && S_ISREG(about.st_mode) && about.st_uid == geteuid() &&
        lock(descriptor) == 0) {
        (void)unlinkat(folder, name, 0);
    }
    (void)close(descriptor);
}

void brdffit_cli_sweep(const char *target)
{
    const int before = errno;
    const size_t length = folder_length(target);
    char *const folder = length == 0 ? strdup(".") : strndup(target, length);
    DIR *const stream = folder != NULL ? opendir(folder) : NULL;
    free(folder);
    if (stream != NULL) {
        for (const struct dirent *entry; (entry = readdir(stream)) != NULL;) {
            if (is_temporary(entry->d_name)) {
                remove_dead(dirfd(stream), entry->d_name);
            }
        }
        (void)closedir(stream);
    }
    errno = before;
}
