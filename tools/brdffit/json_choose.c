/* json_choose.c: which of the lines of --json is the fit of a file.
 * SPDX-License-Identifier: MIT */
#include "json_read.h"

#include <stdio.h>
#include <string.h>

#include "failure.h"
#include "json_parse.h"
#include "slurp.h"
#include "tell.h"

static const char *string_member(const cJSON *object, const char *name)
{
    return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
}

struct choice {
    cJSON *exact, *base, *any;
    size_t exact_at, base_at, any_at;
    size_t base_count, count;
};

static const char *last_component(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash == NULL ? path : slash + 1;
}

/* Paths that are not UTF-8 stand in "file_bytes", in hexadecimal. */
static int same_file(const cJSON *object, const char *file)
{
    const char *bytes = string_member(object, "file_bytes");
    const char *name = string_member(object, "file");
    if (bytes == NULL) {
        return name != NULL && strcmp(name, file) == 0;
    }
    if (strlen(bytes) != 2 * strlen(file)) {
        return 0;
    }
    for (; *file; file++, bytes += 2) {
        char pair[3];
        (void)snprintf(pair, sizeof pair, "%02x", (unsigned)(unsigned char)*file);
        if (strncmp(pair, bytes, 2) != 0) {
            return 0;
        }
    }
    return 1;
}

/* Keep `object` where it fits; 1 when the choice took it over. */
static int offer(struct choice *c, cJSON *object, const char *file, size_t select)
{
    const size_t at = ++c->count;
    const char *name = string_member(object, "file");
    if (select != 0 ? select == at : c->exact == NULL && same_file(object, file)) {
        c->exact = object;
        c->exact_at = at;
        return 1;
    }
    if (select != 0) {
        return 0;
    }
    if (name != NULL && strcmp(last_component(name), last_component(file)) == 0 && c->base_count++ == 0) {
        c->base = object;
        c->base_at = at;
        return 1;
    }
    if (c->any == NULL) {
        c->any = object;
        c->any_at = at;
        return 1;
    }
    return 0;
}

static int bad_json(const char *path, const char *text, const char *at)
{
    size_t line = 1;
    for (; text < at; text++) {
        line += *text == '\n';
    }
    brdffit_cli_tell("brdffit: %s: line %zu: this is not a line of 'brdffit fit --json'\n", path, line);
    return CLI_EXIT_DATA;
}

static int collect(struct choice *c, const struct cli_text *text, const char *path, const char *file, size_t select)
{
    const char *at = brdffit_cli_text_string(text);
    const char *const end = at + text->size;
    for (;;) {
        at += strspn(at, " \t\r\n");
        if (at >= end) {
            return 0;
        }
        const char *stop = at;
        int no_memory;
        cJSON *object = brdffit_cli_json_parse(at, (size_t)(end - at) + 1, &stop, &no_memory);
        if (no_memory) {
            return brdffit_cli_no_memory();
        }
        const char *schema = string_member(object, "schema");
        if (schema != NULL && strcmp(schema, "brdffit.comparison/1") == 0) { /* what compare says of the lines before */
            cJSON_Delete(object);
            at = stop;
            continue;
        }
        if (schema == NULL || strcmp(schema, "brdffit.fit/1") != 0) {
            const char *const where = object == NULL ? stop : at;
            cJSON_Delete(object);
            return bad_json(path, brdffit_cli_text_string(text), where);
        }
        if (!offer(c, object, file, select)) {
            cJSON_Delete(object);
        }
        at = stop;
    }
}

/* The chosen one, or NULL with the reason on stderr. */
static const cJSON *choose(const struct choice *c, const char *path, const char *file, size_t select, size_t *at)
{
    if (c->exact != NULL) {
        *at = c->exact_at;
        return c->exact;
    }
    if (select == 0 && c->base_count == 1) {
        *at = c->base_at;
        return c->base;
    }
    if (select == 0 && c->count == 1) {
        *at = c->any_at;
        return c->any;
    }
    if (c->count == 0) {
        brdffit_cli_tell("brdffit: %s: there is no fit in it\n", path);
    } else if (select != 0) {
        brdffit_cli_tell("brdffit: %s: --select %zu, but there are only %zu fits\n", path, select, c->count);
    } else {
        brdffit_cli_tell("brdffit: %s: none of its %zu fits is of %s alone; choose one with --select N\n", path,
                         c->count, file);
    }
    return NULL;
}

int brdffit_cli_fit_read(struct cli_fit *fit, const char *path, const char *file, size_t select)
{
    struct cli_text text = {0};
    memset(fit, 0, sizeof *fit);
    int code = brdffit_cli_slurp(&text, path);
    if (code == 0) {
        code = brdffit_cli_fit_find(fit, &text, path, file, select);
    }
    brdffit_cli_text_free(&text);
    return code;
}

int brdffit_cli_fit_find(struct cli_fit *fit, const struct cli_text *text, const char *path, const char *file,
                         size_t select)
{
    struct choice c;
    memset(fit, 0, sizeof *fit);
    memset(&c, 0, sizeof c);
    int code = collect(&c, text, path, file, select);
    if (code == 0) {
        const cJSON *object = choose(&c, path, file, select, &fit->line);
        code = object == NULL ? CLI_EXIT_DATA : brdffit_cli_fit_parse(fit, object, path);
    }
    cJSON_Delete(c.exact);
    cJSON_Delete(c.base);
    cJSON_Delete(c.any);
    return code;
}
