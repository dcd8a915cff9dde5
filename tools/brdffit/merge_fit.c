/* merge_fit.c: the lines of the parts of a run, in the order of the whole.
 * SPDX-License-Identifier: MIT
 *
 * Where a line stands tells nothing: its stamp does (shard.h). So parts may be
 * files of their own, or one stream of lines as GNU parallel collects them. */
#include "merge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "failure.h"
#include "json_parse.h"
#include "output.h"
#include "shard.h"
#include "slurp.h"
#include "tell.h"

struct entry {
    const char *line;  /* ends with a NUL */
    size_t length;     /* before the stamp */
    size_t part, position;
    size_t source, row; /* file and line, for messages */
};

struct merger {
    const struct cli_settings *settings;
    struct cli_text *texts; /* one a file */
    struct entry *entries;
    size_t count, capacity;
    struct cli_shard run;   /* that of the first line */
    int exit_code;
    size_t certified, open, failed, not_begun;
};

static int refuse(const struct merger *m, size_t source, size_t row, const char *what)
{
    const char *const path = m->settings->files[source];
    brdffit_cli_tell("brdffit merge: %s: line %zu: %s\n", strcmp(path, "-") == 0 ? "standard input" : path, row, what);
    return CLI_EXIT_DATA;
}

/* ---- What a line says -------------------------------------------------- */

/* The exit code that this file gave its run; -1: the line does not say. */
static int exit_of(struct merger *m, const cJSON *line)
{
    const char *const status = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(line, "status"));
    const cJSON *const verify = cJSON_GetObjectItemCaseSensitive(line, "verify");
    const cJSON *const error = cJSON_GetObjectItemCaseSensitive(line, "error");
    const char *const word = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(error, "code"));
    if (status == NULL) {
        return -1;
    }
    if (strcmp(status, "certified") == 0) {
        m->certified++;
        const cJSON *const proven = cJSON_GetObjectItemCaseSensitive(verify, "proven");
        return proven == NULL || cJSON_IsTrue(proven) ? CLI_EXIT_CERTIFIED : CLI_EXIT_OPEN;
    }
    if (strcmp(status, "gap_open") == 0) {
        m->open++;
        return CLI_EXIT_OPEN;
    }
    if (strcmp(status, "contradiction") == 0) {
        m->open++;
        return CLI_EXIT_FAILURE;
    }
    if (word != NULL && strcmp(word, "interrupted") == 0) {
        m->not_begun++;
        return CLI_EXIT_OPEN;
    }
    m->failed++;
    for (int s = 0; word != NULL && s < BRDFFIT_STATUS_COUNT; s++) {
        if (strcmp(word, brdffit_cli_status_name((brdffit_status)s)) == 0) {
            return brdffit_cli_status_exit((brdffit_status)s);
        }
    }
    return -1;
}

/* Lines of another run are told by what differs first. */
static int check_run(struct merger *m, const struct cli_shard *shard, size_t source, size_t row)
{
    char what[160];
    if (m->count == 0) {
        m->run = *shard;
        return 0;
    }
    if (shard->of == m->run.of && shard->files == m->run.files && shard->run == m->run.run) {
        return 0;
    }
    if (shard->of != m->run.of) {
        (void)snprintf(what, sizeof what, "part %zu/%zu, but the lines before are of parts N/%zu", shard->part,
                       shard->of, m->run.of);
    } else if (shard->files != m->run.files) {
        (void)snprintf(what, sizeof what, "of a run on %zu files, but the lines before are of one on %zu", shard->files,
                       m->run.files);
    } else {
        (void)snprintf(
            what, sizeof what,
            "of another run than the lines before: its files, their order, the options or the version differ");
    }
    return refuse(m, source, row, what);
}

static int add_entry(struct merger *m, const struct entry *e)
{
    if (m->count == m->capacity) {
        const size_t capacity = m->capacity * 2 + 64;
        struct entry *const more = realloc(m->entries, capacity * sizeof *more);
        if (more == NULL) {
            return brdffit_cli_no_memory();
        }
        m->entries = more;
        m->capacity = capacity;
    }
    m->entries[m->count++] = *e;
    return 0;
}

/* ---- Reading ----------------------------------------------------------- */

static int read_line(struct merger *m, const char *line, size_t source, size_t row)
{
    struct cli_shard shard;
    struct entry e = {line, 0, 0, 0, source, row};
    const char *why;
    e.length = brdffit_cli_shard_read(line, &shard, &e.position, &why);
    if (why == brdffit_cli_shard_memory) {
        return brdffit_cli_no_memory();
    }
    if (why != NULL) {
        return refuse(m, source, row, why);
    }
    e.part = shard.part;
    int code = check_run(m, &shard, source, row);
    if (code != 0) {
        return code;
    }
    const char *end;
    int no_memory;
    cJSON *const object = brdffit_cli_json_parse(line, strlen(line) + 1, &end, &no_memory);
    if (no_memory) {
        return brdffit_cli_no_memory();
    }
    code = exit_of(m, object);
    cJSON_Delete(object);
    if (code < 0) {
        return refuse(m, source, row, "this is not a line of 'brdffit fit --json --shard'");
    }
    m->exit_code = brdffit_cli_worse_exit(m->exit_code, code);
    return add_entry(m, &e);
}

static int read_part(struct merger *m, size_t source)
{
    struct cli_text *const text = &m->texts[source];
    int code = brdffit_cli_slurp(text, m->settings->files[source]);
    size_t row = 1;
    for (size_t at = 0; code == 0 && at < text->size; row++) {
        char *const line = text->data + at;
        char *const end = memchr(line, '\n', text->size - at);
        if (end == NULL) {
            return refuse(m, source, row, "this line is cut off: the part did not end, or was not copied whole");
        }
        *end = '\0';
        if (strlen(line) != (size_t)(end - line)) {
            return refuse(m, source, row, "this line is cut off, or not as it was written");
        }
        at += (size_t)(end - line) + 1;
        code = read_line(m, line, source, row);
    }
    return code;
}

/* ---- Is it all there, and once? ---------------------------------------- */

static int by_position(const void *a, const void *b)
{
    const struct entry *const one = a, *const other = b;
    if (one->position != other->position) {
        return one->position < other->position ? -1 : 1;
    }
    if (one->source != other->source) {
        return one->source < other->source ? -1 : 1;
    }
    return one->row < other->row ? -1 : one->row > other->row;
}

static int check_once(const struct merger *m)
{
    for (size_t i = 1; i < m->count; i++) {
        const struct entry *const one = &m->entries[i - 1], *const other = &m->entries[i];
        if (one->position != other->position) {
            continue;
        }
        brdffit_cli_tell(
            "brdffit merge: file %zu of the run, in part %zu/%zu, is there twice: %s, line %zu, and %s, line %zu\n",
            one->position, one->part, m->run.of, m->settings->files[one->source], one->row,
            m->settings->files[other->source], other->row);
        return CLI_EXIT_DATA;
    }
    return 0;
}

static int by_part(const void *a, const void *b)
{
    const struct entry *const one = a, *const other = b;
    if (one->part != other->part) {
        return one->part < other->part ? -1 : 1;
    }
    return by_position(a, b);
}

#define PARTS_SHOWN 12

/* Which parts to run again. Work and words stay bounded whatever numbers the
 * lines claim: a part that is whole has lines, and of others few are shown. */
static int check_all(struct merger *m)
{
    if (m->count == m->run.files) {
        return 0;
    }
    brdffit_cli_tell("brdffit merge: %zu of %zu files are missing:", m->run.files - m->count, m->run.files);
    qsort(m->entries, m->count, sizeof *m->entries, by_part);
    size_t shown = 0, at = 0;
    for (size_t part = 1; part <= m->run.of && part <= m->run.files; part++) {
        const size_t wanted = (m->run.files - part) / m->run.of + 1, first = at;
        while (at < m->count && m->entries[at].part == part) {
            at++;
        }
        if (at - first == wanted) {
            continue;
        }
        if (shown == PARTS_SHOWN) {
            fputs(", ...", stderr);
            break;
        }
        brdffit_cli_tell("%s part %zu/%zu", shown++ > 0 ? "," : "", part, m->run.of);
        if (at > first) {
            brdffit_cli_tell(" (only %zu of %zu)", at - first, wanted);
        }
    }
    fputc('\n', stderr);
    return CLI_EXIT_DATA;
}

/* ---- Writing ----------------------------------------------------------- */

static int write_lines(const struct merger *m)
{
    struct cli_output output;
    struct cli_text line = {0};
    int failed = 0;
    if (brdffit_cli_output_open(&output, m->settings->output) != 0) {
        return CLI_EXIT_FAILURE;
    }
    for (size_t i = 0; !failed && i < m->count; i++) {
        brdffit_cli_text_clear(&line);
        brdffit_cli_text_add(&line, m->entries[i].line, m->entries[i].length);
        brdffit_cli_text_puts(&line, "}\n");
        failed = brdffit_cli_output_add(&output, &line) != 0;
    }
    brdffit_cli_text_clear(&line);
    failed = failed || brdffit_cli_output_write(&output, &line) != 0;
    brdffit_cli_text_free(&line);
    if (failed) {
        brdffit_cli_output_abandon(&output);
    } else {
        failed = brdffit_cli_output_commit(&output) != 0;
    }
    return failed ? CLI_EXIT_FAILURE : 0;
}

static void summary(const struct merger *m)
{
    if (m->not_begun > 0) {
        brdffit_cli_tell("brdffit merge: a part was interrupted; %zu file%s not begun\n", m->not_begun,
                         m->not_begun == 1 ? " was" : "s were");
    }
    if (!m->settings->quiet) {
        brdffit_cli_tell("brdffit: %zu file%s: %zu certified, %zu open, %zu failed\n", m->count,
                         m->count == 1 ? "" : "s", m->certified, m->open, m->failed);
    }
}

static int merge(struct merger *m)
{
    int code = 0;
    for (size_t i = 0; code == 0 && i < m->settings->file_count; i++) {
        code = read_part(m, i);
    }
    if (code != 0) {
        return code;
    }
    if (m->count == 0) {
        brdffit_cli_tell("brdffit merge: there is no line of 'brdffit fit --json --shard' to merge\n");
        return CLI_EXIT_DATA;
    }
    qsort(m->entries, m->count, sizeof *m->entries, by_position);
    code = check_once(m);
    if (code == 0) {
        code = check_all(m);
    }
    if (code == 0) {
        code = write_lines(m);
    }
    if (code != 0) {
        return code;
    }
    summary(m);
    return m->exit_code;
}

int brdffit_cli_merge_fits(const struct cli_settings *settings)
{
    struct merger m;
    memset(&m, 0, sizeof m);
    m.settings = settings;
    m.texts = calloc(settings->file_count, sizeof *m.texts);
    if (m.texts == NULL) {
        return brdffit_cli_no_memory();
    }
    const int code = merge(&m);
    for (size_t i = 0; i < settings->file_count; i++) {
        brdffit_cli_text_free(&m.texts[i]);
    }
    free(m.texts);
    free(m.entries);
    return code;
}
