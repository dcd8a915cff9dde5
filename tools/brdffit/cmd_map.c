/* cmd_map.c: brdffit map. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "interrupt.h"
#include "map.h"
#include "output.h"
#include "tell.h"

void brdffit_cli_map_help(void)
{
    struct cli_text text = {0};
    brdffit_cli_text_puts(&text, "Usage: brdffit map STACK --geometry FILE.csv [options]\n"
                                 "       brdffit map STACK --lights FILE.npy [--views FILE.npy] [options]\n"
                                 "       brdffit map LIST.csv [options]\n"
                                 "\n"
                                 "Fit every texel of a stack of images, each with its own proof, and write maps\n"
                                 "of the parameters. STACK is an array samples x height x width x channels (or\n"
                                 "without channels), .npy or FILE.npz[:NAME]; or a folder of images (.pfm, .png,\n"
                                 ".npy), one a sample, in the order of their names or of a list's column file.\n"
                                 "\n");
    brdffit_cli_option_help(&text, CLI_MAP);
    brdffit_cli_text_puts(&text, "\n"
                                 "Maps: sigma (height x width x lobes), x (.. x channels), y (.. x channels x\n"
                                 "lobes), e2, lower_bound, and status: 0 certified, 1 open (the search stopped\n"
                                 "early), 2 no signal (all zero), 3 masked, 4 bad value (NaN or infinite),\n"
                                 "5 refused, 6 no samples. Texels of status 3 to 6 are NaN in the others.\n"
                                 "\n"
                                 "A run that is interrupted or killed keeps the tiles that it finished in\n"
                                 "OUTPUT.brdffit-work; the same command goes on with them. Parts (--shard) keep\n"
                                 "theirs there, too, until 'brdffit merge OUTPUT' puts the maps together.\n"
                                 "\n"
                                 "Exit status: 0 every texel is certified, without signal or masked; 1 a file\n"
                                 "cannot be read or written, or memory ran out; 2 wrong usage; 3 some texel's, or\n"
                                 "a file's, data cannot be used; 4 a search stopped before its gap closed, or the\n"
                                 "run was interrupted. The first of 1, 2, 3, 4 that occurred.\n");
    brdffit_cli_say(brdffit_cli_text_string(&text));
    brdffit_cli_text_free(&text);
}

/* ---- Where to ---------------------------------------------------------- */

/* The output's name without slashes at its end: the work folder stands beside
 * it. NULL: no memory. */
static char *choose_target(const struct cli_settings *s)
{
    const char *from = s->output;
    struct cli_text text = {0};
    size_t length;
    if (from != NULL) {
        for (length = strlen(from); length > 1 && from[length - 1] == '/'; length--)
            ;
        brdffit_cli_text_add(&text, from, length);
    } else {
        const char *stack = s->files[0];
        size_t end = strlen(stack);
        for (; end > 1 && stack[end - 1] == '/'; end--)
            ;
        size_t start = end;
        for (; start > 0 && stack[start - 1] != '/'; start--)
            ;
        const char *dot = memchr(stack + start + 1, '.', end - start - (end > start));
        brdffit_cli_text_add(&text, stack + start, dot != NULL ? (size_t)(dot - stack) - start : end - start);
        brdffit_cli_text_puts(&text, "-maps");
    }
    if (text.failed) {
        brdffit_cli_text_free(&text);
    }
    return text.data;
}

int brdffit_cli_map_check_target(const struct cli_settings *s, const char *target)
{
    struct stat about;
    const int there = stat(target, &about) == 0, folder = there && S_ISDIR(about.st_mode);
    if (brdffit_cli_map_is_npz(target) && s->map_format == CLI_MAP_PFM) {
        brdffit_cli_tell("brdffit: --format pfm needs a folder for the maps, not %s\n", target);
    } else if (there && folder == brdffit_cli_map_is_npz(target)) {
        brdffit_cli_tell("brdffit: the maps' place %s is %s\n", target, folder ? "a folder" : "a file, and no .npz");
    } else {
        return 0;
    }
    return CLI_EXIT_USAGE;
}

/* ---- The run ----------------------------------------------------------- */

static size_t tiles_kept(const struct cli_map *map)
{
    size_t kept = 0;
    for (size_t tile = 0; tile < map->tiles; tile++) {
        kept += (size_t)brdffit_cli_map_has_tile(map, tile);
    }
    return kept;
}

/* A part is done; the maps need the others too. */
static int finish_shard(const struct cli_map *map)
{
    if (!map->settings->quiet) {
        brdffit_cli_tell_to(stdout, "%s: part %s is done; %zu of %zu tiles are in %s\n", map->settings->files[0],
                            map->settings->shard, tiles_kept(map), map->tiles, map->work);
    }
    return 0;
}

static int interrupted(const struct cli_map *map)
{
    const size_t kept = tiles_kept(map);
    brdffit_cli_tell("brdffit: interrupted; %zu of %zu tiles are kept in %s: the same command goes on with them\n",
                     kept, map->tiles, map->work);
    return CLI_EXIT_OPEN;
}

static int run(struct cli_map *map, const struct cli_settings *settings, const char *target)
{
    struct cli_map_counts counts;
    double seconds = 0;
    size_t texels = 0;
    const size_t threads = settings->threads > 0 ? settings->threads : brdffit_cli_processors();
    int code = brdffit_cli_map_open(map, settings);
    if (code == 0) {
        code = brdffit_cli_map_begin(map, target);
    }
    if (code == 0 && map->png) {
        code = brdffit_cli_png_unpack(map);
    }
    if (code != 0) {
        return code;
    }
    brdffit_cli_cancel_on_interrupt();
    code = brdffit_cli_map_run(map, threads, &seconds, &texels);
    if (code == -1) {
        return interrupted(map);
    }
    if (code == 0) {
        code = brdffit_cli_map_unchanged(map);
    }
    if (code == 0 && settings->shard != NULL) {
        return finish_shard(map);
    }
    if (code == 0) {
        code = brdffit_cli_map_write(map, target, &counts);
    }
    if (code != 0) {
        return code;
    }
    brdffit_cli_map_forget(map);
    if (!settings->quiet) {
        brdffit_cli_map_report(map, target, &counts, threads < map->tiles ? threads : map->tiles, seconds, texels);
    }
    return brdffit_cli_map_finish(map, &counts);
}

int brdffit_cli_map(int argc, char **argv)
{
    struct cli_settings settings;
    const enum cli_parse answer = brdffit_cli_parse(CLI_MAP, "map", argc, argv, &settings);
    int code = answer == CLI_PARSE_NO_MEMORY ? CLI_EXIT_FAILURE : CLI_EXIT_USAGE;
    if (answer == CLI_PARSED_HELP) {
        brdffit_cli_map_help();
        code = 0;
    } else if (answer == CLI_PARSED) {
        struct cli_map map;
        char *const target = choose_target(&settings);
        memset(&map, 0, sizeof map);
        code = target == NULL ? brdffit_cli_no_memory() : brdffit_cli_map_check_target(&settings, target);
        if (code == 0) {
            code = run(&map, &settings, target);
        }
        brdffit_cli_map_close(&map);
        free(target);
    }
    brdffit_cli_settings_free(&settings);
    return code;
}
