/* slurp.c: a whole file in memory. SPDX-License-Identifier: MIT */
#include "slurp.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "failure.h"
#include "tell.h"

int brdffit_cli_slurp(struct cli_text *text, const char *path)
{
    const int standard = strcmp(path, "-") == 0;
    char block[16384];
    size_t size;
    FILE *file = standard ? stdin : fopen(path, "rb");
    if (file == NULL) {
        brdffit_cli_tell("brdffit: %s: cannot open the file (%s)\n", path, strerror(errno));
        return CLI_EXIT_FAILURE;
    }
    errno = 0;
    while ((size = fread(block, 1, sizeof block, file)) > 0) {
        brdffit_cli_text_add(text, block, size);
    }
    const int failed = ferror(file);
    const int error = errno;
    if (!standard) {
        (void)fclose(file);
    }
    if (failed) {
        brdffit_cli_tell("brdffit: %s: cannot read the file (%s)\n", standard ? "standard input" : path,
                         strerror(error));
        return CLI_EXIT_FAILURE;
    }
    return text->failed ? brdffit_cli_no_memory() : 0;
}
