/* output.c: where results go. SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700 /* POSIX 2008 with realpath() */
#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "interrupt.h"
#include "tell.h"
#include "temporary.h"

static int complain(const char *path, const char *what, int error)
{
    if (error != EPIPE) {
        brdffit_cli_tell("brdffit: %s: %s: %s\n", path, what, strerror(error));
    }
    return -1;
}

/* Symbolic links are followed, so that renaming does not replace the link. */
static char *resolve(const char *path)
{
    char *resolved = realpath(path, NULL);
    return resolved != NULL || errno != ENOENT ? resolved : strdup(path);
}

/* Into a new file beside output->target. A target that exists keeps its permissions. */
static int open_temporary(struct cli_output *output, const struct stat *existing)
{
    const char *const path = output->shown;
    brdffit_cli_sweep(output->target);
    const int descriptor = brdffit_cli_temporary(output->target, 0666, &output->temporary);
    if (descriptor < 0) {
        const int error = errno;
        brdffit_cli_output_abandon(output);
        return complain(path, "cannot create a file beside it", error);
    }
    brdffit_cli_remove_on_signal(output->temporary);
    if (existing != NULL) {
        (void)fchmod(descriptor, existing->st_mode & 07777);
    }
    output->file = fdopen(descriptor, "w");
    if (output->file == NULL) {
        const int error = errno;
        (void)close(descriptor);
        brdffit_cli_output_abandon(output);
        return complain(path, "cannot write", error);
    }
    return 0;
}

int brdffit_cli_output_replace(struct cli_output *output, const char *path)
{
    memset(output, 0, sizeof *output);
    output->shown = path;
    output->target = strdup(path);
    return output->target == NULL ? complain(path, "cannot write", ENOMEM) : open_temporary(output, NULL);
}

int brdffit_cli_output_open(struct cli_output *output, const char *path)
{
    memset(output, 0, sizeof *output);
    output->file = stdout;
    output->shown = "standard output";
    if (path == NULL || strcmp(path, "-") == 0) {
        return 0;
    }
    output->shown = path;
    struct stat existing;
    const int exists = stat(path, &existing) == 0;
    if (!exists || S_ISREG(existing.st_mode)) {
        output->target = resolve(path);
        return output->target == NULL ? complain(path, "cannot write", errno)
                                      : open_temporary(output, exists ? &existing : NULL);
    }
    if (S_ISDIR(existing.st_mode)) {
        return complain(path, "cannot write", EISDIR);
    }
    output->file = fopen(path, "w");
    return output->file == NULL ? complain(path, "cannot write", errno) : 0;
}

int brdffit_cli_output_add(struct cli_output *output, const struct cli_text *text)
{
    if (text->failed) {
        return complain(output->shown, "cannot write", ENOMEM);
    }
    if (text->size == 0) {
        return 0;
    }
    if (fwrite(text->data, 1, text->size, output->file) != text->size) {
        return complain(output->shown, "cannot write", errno);
    }
    output->written = 1;
    return 0;
}

int brdffit_cli_output_write(struct cli_output *output, const struct cli_text *text)
{
    if (brdffit_cli_output_add(output, text) != 0) {
        return -1;
    }
    return fflush(output->file) == 0 ? 0 : complain(output->shown, "cannot write", errno);
}

/* The rename itself has to survive a crash too. Not every file system can
 * sync a folder, and the data are safe already, so failure is no error. */
static void sync_folder(const char *target)
{
    const char *slash = strrchr(target, '/');
    char *folder = slash == NULL ? strdup(".") : strndup(target, (size_t)(slash - target) + 1);
    const int descriptor = folder == NULL ? -1 : open(folder, O_RDONLY | O_DIRECTORY);
    if (descriptor >= 0) {
        (void)fsync(descriptor);
        (void)close(descriptor);
    }
    free(folder);
}

/* Renamed before it is closed: brdffit_cli_temporary() says why. What close() may still find was synced before. */
static int put_in_place(struct cli_output *output)
{
    if (fflush(output->file) != 0) {
        return -1;
    }
    if (output->temporary == NULL) {
        return 0;
    }
    if (fsync(fileno(output->file)) != 0 || rename(output->temporary, output->target) != 0) {
        return -1;
    }
    brdffit_cli_remove_on_signal(NULL);
    sync_folder(output->target);
    free(output->temporary);
    output->temporary = NULL;
    return 0;
}

int brdffit_cli_output_commit(struct cli_output *output)
{
    if (output->file == stdout || output->file == NULL) {
        return 0;
    }
    const int empty = output->temporary != NULL && !output->written && !output->may_be_empty;
    int failed = !empty && put_in_place(output) != 0, error = errno;
    if (fclose(output->file) != 0 && !failed) {
        failed = 1;
        error = errno;
    }
    output->file = NULL;
    const char *const shown = output->shown;
    brdffit_cli_output_abandon(output);
    return failed ? complain(shown, "cannot write", error) : 0;
}

void brdffit_cli_output_abandon(struct cli_output *output)
{
    if (output->temporary != NULL) {
        brdffit_cli_remove_on_signal(NULL);
        (void)unlink(output->temporary);
    }
    if (output->file != NULL && output->file != stdout) {
        (void)fclose(output->file);
    }
    free(output->temporary);
    free(output->target);
    memset(output, 0, sizeof *output);
}

void brdffit_cli_say(const char *text)
{
    if (fputs(text, stdout) == EOF || fflush(stdout) != 0) {
        (void)complain("standard output", "cannot write", errno);
    }
}

int brdffit_cli_close_stdout(void)
{
    int failed = ferror(stdout) != 0;
    errno = 0;
    if (fclose(stdout) != 0) {
        failed = failed ? 1 : complain("standard output", "cannot write", errno) != 0;
    }
    return failed ? -1 : 0;
}
