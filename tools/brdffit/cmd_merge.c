/* cmd_merge.c: brdffit merge. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "commands.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "failure.h"
#include "merge.h"
#include "output.h"
#include "settings.h"
#include "tell.h"

static const char work_suffix[] = ".brdffit-work";

void brdffit_cli_merge_help(void)
{
    struct cli_text text = {0};
    brdffit_cli_text_puts(&text, "Usage: brdffit merge PART.json... [--output FILE]\n"
                                 "       brdffit merge MAPS [--format npy|pfm]\n"
                                 "\n"
                                 "Put together what the parts of a run did, on one machine or many.\n"
                                 "\n"
                                 "PART.json are what 'brdffit fit --json --shard I/N FILE...' wrote for I from 1\n"
                                 "to N, each with the same FILEs and options; - is standard input. Lines may come\n"
                                 "in any order. The result is, byte for byte, what one run without --shard writes\n"
                                 "(seconds are those of the parts).\n"
                                 "\n"
                                 "MAPS is what 'brdffit map --shard I/N' was told as --output. Its tiles become\n"
                                 "the maps, as those of one run, and MAPS.brdffit-work is removed.\n"
                                 "\n");
    brdffit_cli_option_help(&text, CLI_MERGE);
    brdffit_cli_text_puts(&text, "\n"
                                 "Parts that are missing, incomplete, there twice, cut off or of another run are\n"
                                 "named, and nothing is written.\n"
                                 "\n"
                                 "Exit status: that of one run without --shard; or 1 when something cannot be\n"
                                 "read or written, or memory ran out, 2 wrong usage, and 3 when the parts are not\n"
                                 "all of one run.\n");
    brdffit_cli_say(brdffit_cli_text_string(&text));
    brdffit_cli_text_free(&text);
}

static int is_folder(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

/* `length` bytes of `path` end so. */
static int ends(const char *path, size_t length, const char *with)
{
    const size_t size = strlen(with);
    return length > size && memcmp(path + length - size, with, size) == 0;
}

/* The maps' name, when `path` is one, or their work folder; empty when not. */
static void find_maps(struct cli_text *target, const char *path)
{
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/') {
        length--;
    }
    const int is_work = ends(path, length, work_suffix);
    if (is_work) {
        length -= strlen(work_suffix);
    }
    struct cli_text work = {0};
    brdffit_cli_text_printf(&work, "%.*s%s", (int)length, path, work_suffix);
    if (is_work || ends(path, length, ".npz") || is_folder(path) || is_folder(brdffit_cli_text_string(&work))) {
        brdffit_cli_text_add(target, path, length);
    }
    target->failed |= work.failed;
    brdffit_cli_text_free(&work);
}

static int merge(struct cli_settings *settings)
{
    struct cli_text target = {0};
    int code = 0;
    for (size_t i = 0; i < settings->file_count && target.size == 0; i++) {
        find_maps(&target, settings->files[i]);
    }
    if (target.failed) {
        code = brdffit_cli_no_memory();
    } else if (target.size == 0) {
        code = brdffit_cli_merge_fits(settings);
    } else if (settings->file_count > 1 || settings->output != NULL) {
        brdffit_cli_tell("brdffit merge: %s are maps: %s\nTry 'brdffit merge --help'.\n", target.data,
                         settings->output != NULL ? "they go where 'brdffit map' was told to put them, without --output"
                                                  : "one at a time");
        code = CLI_EXIT_USAGE;
    } else {
        code = brdffit_cli_merge_map(settings, target.data);
    }
    brdffit_cli_text_free(&target);
    return code;
}

int brdffit_cli_merge(int argc, char **argv)
{
    struct cli_settings settings;
    const enum cli_parse answer = brdffit_cli_parse(CLI_MERGE, "merge", argc, argv, &settings);
    int code = answer == CLI_PARSE_NO_MEMORY ? CLI_EXIT_FAILURE : CLI_EXIT_USAGE;
    if (answer == CLI_PARSED_HELP) {
        brdffit_cli_merge_help();
        code = 0;
    } else if (answer == CLI_PARSED) {
        code = merge(&settings);
    }
    brdffit_cli_settings_free(&settings);
    return code;
}
