/* progress.c: one line on a terminal that says how far it is.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "progress.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "job.h"

/* Redrawing faster than this would cost time and nobody could read it. */
#define INTERVAL 0.2

void brdffit_cli_progress_start(struct cli_progress *progress, size_t count, int quiet)
{
    memset(progress, 0, sizeof *progress);
    progress->style = brdffit_cli_style(stderr);
    progress->shown = !quiet && isatty(STDERR_FILENO);
    progress->unit = "files";
    progress->count = count;
    progress->started = brdffit_cli_clock();
    progress->last = progress->started;
}

static void add_rate(struct cli_text *line, const struct cli_progress *progress, double now)
{
    const double elapsed = now - progress->started;
    if (progress->done == 0 || !(elapsed > 0)) {
        return;
    }
    const double rate = (double)progress->done / elapsed;
    const double left = (double)(progress->count - progress->done) / rate;
    brdffit_cli_text_printf(line, ", %.3g %s/s, ", rate, progress->unit);
    if (left < 90) {
        brdffit_cli_text_printf(line, "%.0f s left", left);
    } else {
        brdffit_cli_text_printf(line, "%.0f min left", left / 60);
    }
}

/* Draw `detail` after the count of files, cut at the terminal's width. */
static void draw(struct cli_progress *progress, const char *detail, double now)
{
    struct cli_text line = {0};
    if (progress->count > 1) {
        brdffit_cli_text_printf(&line, "file %zu of %zu", progress->done + 1, progress->count);
    } else {
        brdffit_cli_text_puts(&line, "fitting");
    }
    add_rate(&line, progress, now);
    brdffit_cli_text_puts(&line, detail);
    const size_t width = brdffit_cli_width(progress->style, brdffit_cli_text_string(&line));
    if (width + 3 < CLI_WIDTH) {
        struct cli_text name = {0};
        brdffit_cli_name(&name, progress->style, progress->path);
        /* A cut may not fall inside a character. */
        size_t keep = name.size;
        while (keep > 0 && (keep > CLI_WIDTH - 2 - width || ((unsigned char)name.data[keep] & 0xC0) == 0x80)) {
            keep--;
        }
        brdffit_cli_text_puts(&line, "  ");
        brdffit_cli_text_add(&line, brdffit_cli_text_string(&name), keep);
        brdffit_cli_text_free(&name);
    }
    if (!line.failed) {
        fprintf(stderr, "\r%s\033[K", brdffit_cli_text_string(&line));
    }
    fflush(stderr);
    brdffit_cli_text_free(&line);
    progress->visible = 1;
    progress->last = now;
}

void brdffit_cli_progress_file(struct cli_progress *progress, size_t index, const char *path)
{
    progress->done = index;
    progress->path = path;
    const double now = brdffit_cli_clock();
    if (progress->shown && progress->count > 1 && now - progress->last >= INTERVAL) {
        draw(progress, "", now);
    }
}

void brdffit_cli_progress_search(struct cli_progress *progress, const brdffit_progress *search)
{
    if (!progress->shown) {
        return;
    }
    const double now = brdffit_cli_clock();
    if (now - progress->last < INTERVAL) {
        return;
    }
    char detail[80];
    if (search->lower_bound > 0) {
        (void)snprintf(detail, sizeof detail, ": %zu boxes, gap %.2g %%", search->boxes,
                       100 * (search->e2 / search->lower_bound - 1));
    } else {
        (void)snprintf(detail, sizeof detail, ": %zu boxes, no bound yet", search->boxes);
    }
    draw(progress, detail, now);
}

void brdffit_cli_progress_amount(struct cli_progress *progress, size_t done)
{
    const double now = brdffit_cli_clock();
    progress->done = done;
    if (!progress->shown || now - progress->last < INTERVAL) {
        return;
    }
    struct cli_text line = {0};
    brdffit_cli_text_printf(&line, "%zu of %zu %s", done, progress->count, progress->unit);
    add_rate(&line, progress, now);
    fprintf(stderr, "\r%s\033[K", brdffit_cli_text_string(&line));
    fflush(stderr);
    brdffit_cli_text_free(&line);
    progress->visible = 1;
    progress->last = now;
}

void brdffit_cli_progress_erase(struct cli_progress *progress)
{
    if (!progress->visible) {
        return;
    }
    fputs("\r\033[K", stderr);
    fflush(stderr);
    progress->visible = 0;
}
