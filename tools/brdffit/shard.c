/* shard.c: one part of a run that is split over processes.
 * SPDX-License-Identifier: MIT */
#include "shard.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "reading.h"

static void record_bytes(struct cli_text *text, const char *name, const double *values, size_t count)
{
    brdffit_cli_text_printf(text, "%s %zu\n", name, count);
    for (size_t i = 0; i < count; i++) {
        brdffit_cli_text_printf(text, "%.17g\n", values[i]);
    }
}

/* Everything on which the lines depend, but the content of the files: their
 * names have to tell that, as parts may run on machines with copies. */
static void record(struct cli_text *text, const struct cli_settings *s, const brdffit_options *options,
                   const brdffit_samples *directions)
{
    brdffit_cli_text_printf(text, "brdffit fit 1, version %s\n", brdffit_version());
    brdffit_cli_record_options(text, options);
    brdffit_cli_text_printf(text, "--weight %d\n", s->weight);
    brdffit_cli_text_printf(text, "--verify %s\n--values %d\n--format %d\n--merl-bins %d\n--merl-samples %s\n",
                            s->verify != NULL ? s->verify : "", s->values, s->format, s->merl_bins, s->merl_samples);
    if (s->confidence > 0) {
        brdffit_cli_text_printf(text, "--confidence %.17g\n", s->confidence);
    }
    brdffit_cli_record_reading(text, s);
    brdffit_cli_text_puts(text, s->lobes_auto ? "--lobes auto\n" : "");
    if (directions != NULL) {
        record_bytes(text, "light", directions->light, 3 * directions->count);
        record_bytes(text, "view", directions->view, 3 * directions->count);
    }
    for (size_t i = 0; i < s->file_count; i++) {
        brdffit_cli_text_add(text, s->files[i], strlen(s->files[i]) + 1);
    }
}

int brdffit_cli_shard_take(struct cli_shard *shard, struct cli_settings *settings, const brdffit_options *options,
                           const brdffit_samples *directions)
{
    struct cli_text text = {0};
    record(&text, settings, options, directions);
    shard->part = settings->shard_index + 1;
    shard->of = settings->shard_count;
    shard->files = settings->file_count;
    shard->run = brdffit_cli_text_hash(&text);
    const int failed = text.failed;
    brdffit_cli_text_free(&text);
    size_t kept = 0;
    for (size_t i = settings->shard_index; i < shard->files; i += shard->of) {
        settings->files[kept++] = settings->files[i];
    }
    settings->file_count = kept;
    return failed ? -1 : 0;
}

size_t brdffit_cli_shard_position(const struct cli_shard *shard, size_t index)
{
    return shard->part + index * shard->of;
}

/* ---- The stamp --------------------------------------------------------- */

/* No string in JSON holds this: its quotes would have backslashes. */
static const char mark[] = ",\"shard\":{";

static void add_members(struct cli_text *text, const struct cli_shard *shard, size_t position)
{
    brdffit_cli_text_printf(text, "%s\"part\":%zu,\"of\":%zu,\"position\":%zu,\"files\":%zu,\"run\":\"%016" PRIx64 "\"",
                            mark, shard->part, shard->of, position, shard->files, shard->run);
}

static void add_crc(struct cli_text *text, unsigned long crc)
{
    brdffit_cli_text_printf(text, ",\"crc32\":\"%08lx\"}", crc);
}

void brdffit_cli_shard_stamp(struct cli_text *text, size_t start, const struct cli_shard *shard, size_t position)
{
    add_members(text, shard, position);
    if (!text->failed) {
        add_crc(text, brdffit_io_crc32(0, text->data + start, text->size - start));
    }
}

const char brdffit_cli_shard_memory[] = "out of memory";

/* The members as numbers; what they were printed from, or not at all. -1: no memory. */
static int parse_members(const char *at, struct cli_shard *shard, size_t *position, unsigned long *crc)
{
    struct cli_text again = {0};
    const int found = sscanf(at,
                             ",\"shard\":{\"part\":%zu,\"of\":%zu,\"position\":%zu,\"files\":%zu,\"run\":\"%16" SCNx64
                             "\",\"crc32\":\"%8lx\"}}",
                             &shard->part, &shard->of, position, &shard->files, &shard->run, crc);
    if (found != 6) {
        return 0;
    }
    add_members(&again, shard, *position);
    add_crc(&again, *crc);
    brdffit_cli_text_puts(&again, "}");
    const int failed = again.failed, same = !failed && strcmp(again.data, at) == 0;
    brdffit_cli_text_free(&again);
    if (failed) {
        return -1;
    }
    return same && shard->part >= 1 && shard->part <= shard->of && *position >= shard->part &&
           *position <= shard->files && (*position - shard->part) % shard->of == 0;
}

size_t brdffit_cli_shard_read(const char *line, struct cli_shard *shard, size_t *position, const char **why)
{
    const char *const at = strstr(line, mark);
    unsigned long crc;
    *why = "this is not a line of 'brdffit fit --json --shard'";
    if (at == NULL) {
        return 0;
    }
    *why = "this line is cut off, or not as it was written";
    const int found = parse_members(at, shard, position, &crc);
    if (found != 1) {
        *why = found < 0 ? brdffit_cli_shard_memory : *why;
        return 0;
    }
    const size_t covered = (size_t)(strstr(at, ",\"crc32\"") - line);
    if (brdffit_io_crc32(0, line, covered) != crc) {
        return 0;
    }
    *why = NULL;
    return (size_t)(at - line);
}
