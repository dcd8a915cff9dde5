/* map_report.c: what came of a map, in words and as an exit code.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "map.h"
#include "tell.h"
#include "words.h"

int brdffit_cli_map_is_npz(const char *path)
{
    const size_t length = strlen(path);
    return length > 4 && strcmp(path + length - 4, ".npz") == 0;
}

static void add_count(struct cli_text *text, const char *before, uint64_t count, const char *what)
{
    if (count == 0) {
        return;
    }
    brdffit_cli_text_puts(text, before);
    brdffit_cli_grouped(text, (size_t)count);
    brdffit_cli_text_printf(text, "\t%s", what);
}

static void report_statuses(struct cli_text *text, const struct cli_map_counts *counts)
{
    static const char *const words[CLI_TEXEL_COUNT] = {
        "certified", "open: the search stopped early", "without signal", "masked", "with a bad value",
        "refused",   "with no sample left to fit"};
    uint64_t total = 0;
    for (int s = 0; s < CLI_TEXEL_COUNT; s++) {
        total += counts->status[s];
    }
    brdffit_cli_grouped(text, (size_t)total);
    brdffit_cli_text_puts(text, " texels");
    const char *before = ": ";
    for (int s = 0; s < CLI_TEXEL_COUNT; s++) {
        add_count(text, before, counts->status[s], words[s]);
        before = counts->status[s] > 0 ? ", " : before;
    }
    brdffit_cli_text_puts(text, ".");
}

static void report_stats(struct cli_text *text, struct cli_style style, const struct cli_map *map,
                         const struct cli_map_counts *counts)
{
    struct cli_text words = {0};
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

static void add_run(struct cli_text *words, const struct cli_map *map, size_t threads, double seconds, size_t texels)
{
    brdffit_cli_text_printf(words, "; %zu thread%s, at most %.3g\tMB each;\t", threads, threads == 1 ? "" : "s",
                            (double)brdffit_cli_map_worker_bytes(map) / 1e6);
    brdffit_cli_duration(words, seconds);
    if (texels > 0 && seconds > 0) {
        brdffit_cli_text_printf(words, ", %.3g\ttexels/s", (double)texels / seconds);
    }
}

void brdffit_cli_map_report(const struct cli_map *map, const char *target, const struct cli_map_counts *counts,
                            size_t threads, double seconds, size_t texels)
{
    const struct cli_style style = brdffit_cli_style(stdout);
    struct cli_text text = {0}, words = {0};
    brdffit_cli_name(&text, style, map->settings->files[0]);
    brdffit_cli_text_printf(&text, ": %zu samples of %zu x %zu texels, %zu channel%s\n", map->samples, map->height,
                            map->width, map->channels, map->channels == 1 ? "" : "s");
    report_statuses(&words, counts);
    brdffit_cli_paragraph(&text, style, CLI_BOLD, "Fitted:", brdffit_cli_text_string(&words));
    brdffit_cli_text_clear(&words);
    brdffit_cli_text_printf(&words, "%zu tile%s of %zu row%s", map->tiles, map->tiles == 1 ? "" : "s", map->tile_rows,
                            map->tile_rows == 1 ? "" : "s");
    if (map->resumed > 0 && threads > 0) {
        brdffit_cli_text_printf(&words, ", %zu of them from an earlier run", map->resumed);
    }
    if (threads > 0) {
        add_run(&words, map, threads, seconds, texels);
    }
    brdffit_cli_text_puts(&words, ".");
    brdffit_cli_paragraph(&text, style, CLI_BOLD, "Run:", brdffit_cli_text_string(&words));
    if (map->settings->stats) {
        report_stats(&text, style, map, counts);
    }
    brdffit_cli_text_puts(&text, "  Maps: ");
    brdffit_cli_name(&text, style, target);
    brdffit_cli_text_puts(&text, brdffit_cli_map_is_npz(target) ? "\n" : "/\n");
    fputs(brdffit_cli_text_string(&text), stdout);
    brdffit_cli_text_free(&text);
    brdffit_cli_text_free(&words);
}

int brdffit_cli_map_finish(const struct cli_map *map, const struct cli_map_counts *counts)
{
    const uint64_t unusable = counts->status[BRDFFIT_TEXEL_BAD_VALUE] + counts->status[BRDFFIT_TEXEL_REFUSED] +
                              counts->status[CLI_TEXEL_NO_SAMPLES];
    if (counts->bad_texel != UINT64_MAX) {
        brdffit_cli_tell(
            "brdffit: %s: %llu texel%s with a bad value; the first: row %llu, column %llu, sample %llu, channel "
            "%llu, all from 0\n",
            map->settings->files[0], (unsigned long long)counts->status[BRDFFIT_TEXEL_BAD_VALUE],
            counts->status[BRDFFIT_TEXEL_BAD_VALUE] == 1 ? "" : "s",
            (unsigned long long)(counts->bad_texel / map->width), (unsigned long long)(counts->bad_texel % map->width),
            (unsigned long long)(counts->bad_where / map->channels),
            (unsigned long long)(counts->bad_where % map->channels));
    }
    if (unusable > 0) {
        return CLI_EXIT_DATA;
    }
    return counts->status[BRDFFIT_TEXEL_OPEN] > 0 ? CLI_EXIT_OPEN : 0;
}
