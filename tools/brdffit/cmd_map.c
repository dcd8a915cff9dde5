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
#include "words.h"

void brdffit_cli_map_help(void)
{
    cli_text text = {0};
    brdffit_cli_text_puts(
        &text,
        "Usage: brdffit map STACK --geometry FILE.csv [options]\n"
        "       brdffit map STACK --lights FILE.npy [--views FILE.npy] [options]\n"
        "       brdffit map LIST.csv [options]\n"
        "\n"
        "Fit every texel of a stack of images, each with its own proof, and write maps\n"
        "of the parameters. STACK is an array samples x height x width x channels (or\n"
        "without channels), .npy or FILE.npz[:NAME]; or a folder of images (.pfm, .png,\n"
        ".npy), one a sample, in the order of their names or of a list's column file.\n"
        "\n");
    brdffit_cli_option_help(&text, CLI_MAP);
    brdffit_cli_text_puts(
        &text,
        "\n"
        "Maps: sigma (height x width x lobes), x (.. x channels), y (.. x channels x\n"
        "lobes), e2, lower_bound, and status: 0 certified, 1 open (the search stopped\n"
        "early), 2 no signal (all zero), 3 masked, 4 bad value (NaN or infinite),\n"
        "5 refused, 6 no samples. Texels of status 3 to 6 are NaN in the others.\n"
        "\n"
        "A run that is interrupted or killed keeps the tiles that it finished in\n"
        "OUTPUT.brdffit-work; the same command goes on with them.\n"
        "\n"
        "Exit status: 0 every texel is certified, without signal or masked; 1 a file\n"
        "cannot be read or written, or memory ran out; 2 wrong usage; 3 some texel's, or\n"
        "a file's, data cannot be used; 4 a search stopped before its gap closed, or the\n"
        "run was interrupted. The first of 1, 2, 3, 4 that occurred.\n");
    fputs(brdffit_cli_text_string(&text), stdout);
    brdffit_cli_text_free(&text);
}

/* ---- Where to ---------------------------------------------------------- */

static int is_npz(const char *path)
{
    const size_t length = strlen(path);
    return length > 4 && strcmp(path + length - 4, ".npz") == 0;
}

/* The output's name without slashes at its end: the work folder stands beside
 * it. NULL: no memory. */
static char *choose_target(const cli_settings *s)
{
    const char *from = s->output;
    cli_text text = {0};
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
    if (text.failed)
        brdffit_cli_text_free(&text);
    return text.data;
}

static int check_target(const cli_settings *s, const char *target)
{
    struct stat about;
    const int there = stat(target, &about) == 0, folder = there && S_ISDIR(about.st_mode);
    if (is_npz(target) && s->map_format == CLI_MAP_PFM)
        fprintf(stderr, "brdffit map: --format pfm needs a folder for --output, not %s\n", target);
    else if (there && folder == is_npz(target))
        fprintf(stderr, "brdffit map: --output %s is %s\n", target, folder ? "a folder" : "a file, and no .npz");
    else
        return 0;
    return CLI_EXIT_USAGE;
}

/* ---- What came of it --------------------------------------------------- */

static void add_count(cli_text *text, const char *before, uint64_t count, const char *what)
{
    if (count == 0)
        return;
    brdffit_cli_text_puts(text, before);
    brdffit_cli_grouped(text, (size_t)count);
    brdffit_cli_text_printf(text, "\t%s", what);
}

static void report_statuses(cli_text *text, const cli_map_counts *counts)
{
    static const char *const words[CLI_TEXEL_COUNT] = {
        "certified", "open: the search stopped early", "without signal", "masked", "with a bad value", "refused",
        "with no sample left to fit"};
    uint64_t total = 0;
    for (int s = 0; s < CLI_TEXEL_COUNT; s++)
        total += counts->status[s];
    brdffit_cli_grouped(text, (size_t)total);
    brdffit_cli_text_puts(text, " texels");
    const char *before = ": ";
    for (int s = 0; s < CLI_TEXEL_COUNT; s++) {
        add_count(text, before, counts->status[s], words[s]);
        before = counts->status[s] > 0 ? ", " : before;
    }
    brdffit_cli_text_puts(text, ".");
}

static void report_stats(cli_text *text, cli_style style, const cli_map *map, const cli_map_counts *counts)
{
    cli_text words = {0};
    brdffit_cli_grouped(&words, (size_t)counts->boxes);
    brdffit_cli_text_puts(&words, "\tboxes, ");
    brdffit_cli_grouped(&words, (size_t)counts->nodes);
    brdffit_cli_text_puts(&words, "\tnodes");
    add_count(&words, "; ", counts->equal, "texels equal to the one before, copied");
    add_count(&words, "; ", counts->zero_channels, "channels without signal");
    add_count(&words, "; ", counts->equal_channels, "channels that repeat another");
    add_count(&words, "; ", counts->one_lobe_enough, "texels that one lobe is proven to fit as well");
    add_count(&words, "; ", counts->general, "texels by the general path");
    brdffit_cli_text_puts(&words, ".");
    brdffit_cli_paragraph(text, style, CLI_BOLD, "Search:", brdffit_cli_text_string(&words));
    brdffit_cli_text_clear(&words);
    const char *before = "";
    for (int reason = 0; reason < BRDFFIT_SKIP_COUNT; reason++) {
        const uint64_t count = map->general ? counts->skipped[reason] : map->shared_skipped[reason];
        add_count(&words, before, count, brdffit_skip_string((brdffit_skip)reason));
        before = count > 0 ? ", " : before;
    }
    if (words.size > 0) {
        brdffit_cli_text_puts(&words, map->general ? " (samples of all texels)." : " (samples, in every texel).");
        brdffit_cli_paragraph(text, style, CLI_BOLD, "Skipped:", brdffit_cli_text_string(&words));
    }
    brdffit_cli_text_free(&words);
}

static void report(const cli_map *map, const char *target, const cli_map_counts *counts, size_t threads,
                   double seconds, size_t texels)
{
    const cli_style style = brdffit_cli_style(stdout);
    cli_text text = {0}, words = {0};
    brdffit_cli_name(&text, style, map->settings->files[0]);
    brdffit_cli_text_printf(&text, ": %zu samples of %zu x %zu texels, %zu channel%s\n", map->samples, map->height,
                            map->width, map->channels, map->channels == 1 ? "" : "s");
    report_statuses(&words, counts);
    brdffit_cli_paragraph(&text, style, CLI_BOLD, "Fitted:", brdffit_cli_text_string(&words));
    brdffit_cli_text_clear(&words);
    brdffit_cli_text_printf(&words, "%zu tile%s of %zu row%s", map->tiles, map->tiles == 1 ? "" : "s", map->tile_rows,
                            map->tile_rows == 1 ? "" : "s");
    if (map->resumed > 0)
        brdffit_cli_text_printf(&words, ", %zu of them from an earlier run", map->resumed);
    brdffit_cli_text_printf(&words, "; %zu thread%s, at most %.3g\tMB each;\t", threads, threads == 1 ? "" : "s",
                            (double)brdffit_cli_map_worker_bytes(map) / 1e6);
    brdffit_cli_duration(&words, seconds);
    if (texels > 0 && seconds > 0)
        brdffit_cli_text_printf(&words, ", %.3g\ttexels/s", (double)texels / seconds);
    brdffit_cli_text_puts(&words, ".");
    brdffit_cli_paragraph(&text, style, CLI_BOLD, "Run:", brdffit_cli_text_string(&words));
    if (map->settings->stats)
        report_stats(&text, style, map, counts);
    brdffit_cli_text_puts(&text, "  Maps: ");
    brdffit_cli_name(&text, style, target);
    brdffit_cli_text_puts(&text, is_npz(target) ? "\n" : "/\n");
    fputs(brdffit_cli_text_string(&text), stdout);
    brdffit_cli_text_free(&text);
    brdffit_cli_text_free(&words);
}

static int finish(const cli_map *map, const cli_map_counts *counts)
{
    const uint64_t unusable = counts->status[BRDFFIT_TEXEL_BAD_VALUE] + counts->status[BRDFFIT_TEXEL_REFUSED] +
                              counts->status[CLI_TEXEL_NO_SAMPLES];
    if (counts->bad_texel != UINT64_MAX)
        fprintf(stderr,
                "brdffit: %s: %llu texel%s with a bad value; the first: row %llu, column %llu, sample %llu, channel "
                "%llu, all from 0\n",
                map->settings->files[0], (unsigned long long)counts->status[BRDFFIT_TEXEL_BAD_VALUE],
                counts->status[BRDFFIT_TEXEL_BAD_VALUE] == 1 ? "" : "s",
                (unsigned long long)(counts->bad_texel / map->width),
                (unsigned long long)(counts->bad_texel % map->width),
                (unsigned long long)(counts->bad_where / map->channels),
                (unsigned long long)(counts->bad_where % map->channels));
    if (unusable > 0)
        return CLI_EXIT_DATA;
    return counts->status[BRDFFIT_TEXEL_OPEN] > 0 ? CLI_EXIT_OPEN : 0;
}

static size_t tiles_kept(const cli_map *map)
{
    size_t kept = 0;
    for (size_t tile = 0; tile < map->tiles; tile++)
        kept += (size_t)brdffit_cli_map_has_tile(map, tile);
    return kept;
}

/* A part is done; the maps need the others too. */
static int finish_shard(const cli_map *map)
{
    if (!map->settings->quiet)
        printf("%s: part %s is done; %zu of %zu tiles are in %s\n", map->settings->files[0], map->settings->shard,
               tiles_kept(map), map->tiles, map->work);
    return 0;
}

static int interrupted(const cli_map *map)
{
    const size_t kept = tiles_kept(map);
    fprintf(stderr, "brdffit: interrupted; %zu of %zu tiles are kept in %s: the same command goes on with them\n", kept,
            map->tiles, map->work);
    return CLI_EXIT_OPEN;
}

static int run(cli_map *map, const cli_settings *settings, const char *target)
{
    cli_map_counts counts;
    double seconds = 0;
    size_t texels = 0;
    const size_t threads = settings->threads > 0 ? settings->threads : brdffit_cli_processors();
    int code = brdffit_cli_map_open(map, settings);
    if (code == 0)
        code = brdffit_cli_map_begin(map, target);
    if (code == 0 && map->png)
        code = brdffit_cli_png_unpack(map);
    if (code != 0)
        return code;
    brdffit_cli_cancel_on_interrupt();
    code = brdffit_cli_map_run(map, threads, &seconds, &texels);
    if (code == -1)
        return interrupted(map);
    if (code == 0 && settings->shard != NULL)
        return finish_shard(map);
    if (code == 0)
        code = brdffit_cli_map_write(map, target, &counts);
    if (code != 0)
        return code;
    brdffit_cli_map_forget(map);
    if (!settings->quiet)
        report(map, target, &counts, threads < map->tiles ? threads : map->tiles, seconds, texels);
    return finish(map, &counts);
}

int brdffit_cli_map(int argc, char **argv)
{
    cli_settings settings;
    int code = CLI_EXIT_USAGE;
    const cli_parse answer = brdffit_cli_parse(CLI_MAP, "map", argc, argv, &settings);
    if (answer == CLI_PARSED_HELP) {
        brdffit_cli_map_help();
        code = 0;
    } else if (answer == CLI_PARSED) {
        cli_map map;
        char *const target = choose_target(&settings);
        memset(&map, 0, sizeof map);
        code = target == NULL ? brdffit_cli_no_memory() : check_target(&settings, target);
        if (code == 0)
            code = run(&map, &settings, target);
        brdffit_cli_map_close(&map);
        free(target);
    }
    brdffit_cli_settings_free(&settings);
    return code;
}
