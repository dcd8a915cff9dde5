/* reading.c: how a file is to be read. SPDX-License-Identifier: MIT */
#include "reading.h"

#include <stdio.h>
#include <string.h>

#include "failure.h"
#include "tell.h"

const struct cli_choice brdffit_cli_values_choices[] = {{"brdf", BRDFFIT_QUANTITY_BRDF, 0},
                                                        {"radiance", BRDFFIT_QUANTITY_RADIANCE, 0},
                                                        {"ccbrdf", CLI_VALUES_CCBRDF, 0},
                                                        {"reflectance-factor", CLI_VALUES_REFLECTANCE_FACTOR, 0},
                                                        {NULL, 0, 0}};

static const struct cli_choice directions[] = {{"degrees", (int)BRDFFIT_IO_DEGREES, 0},
                                               {"radians", (int)BRDFFIT_IO_RADIANS, 0},
                                               {"elevation", (int)BRDFFIT_IO_ELEVATION, 0},
                                               {"mirror-at-0", (int)BRDFFIT_IO_MIRROR_AT_ZERO, 0},
                                               {"light-travels", (int)BRDFFIT_IO_LIGHT_TRAVELS, 0},
                                               {"y-up", (int)BRDFFIT_IO_Y_UP, 0},
                                               {"as-written", (int)BRDFFIT_IO_AS_WRITTEN, 0},
                                               {NULL, 0, 0}};

/* The bits of a list of words; 0 when one is none of them. */
static unsigned direction_bits(const char *list)
{
    unsigned bits = 0;
    for (const char *at = list; *at;) {
        const size_t length = strcspn(at, ",");
        const struct cli_choice *c = directions;
        while (c->name != NULL && (strlen(c->name) != length || strncmp(c->name, at, length) != 0)) {
            c++;
        }
        if (c->name == NULL) {
            return 0;
        }
        bits |= (unsigned)c->value;
        at += length + (at[length] == ',');
    }
    return bits;
}

/* What --missing says; 0 when it is neither a word nor a number. */
static int missing_kind(const char *text, brdffit_io_missing *kind, double *value)
{
    *value = 0;
    *kind = strcmp(text, "negative") == 0 ? BRDFFIT_IO_MISSING_NEGATIVE
            : strcmp(text, "none") == 0   ? BRDFFIT_IO_MISSING_NONE
                                          : BRDFFIT_IO_MISSING_VALUE;
    return *kind != BRDFFIT_IO_MISSING_VALUE || brdffit_cli_number(text, value);
}

int brdffit_cli_check_reading(const struct cli_settings *settings, const char *command)
{
    brdffit_io_missing kind;
    double value;
    if (settings->missing != NULL && !missing_kind(settings->missing, &kind, &value)) {
        brdffit_cli_tell("brdffit %s: --missing does not take '%s'; valid values: a number, negative, none\n", command,
                         settings->missing);
        return -1;
    }
    if (settings->directions != NULL && direction_bits(settings->directions) == 0) {
        brdffit_cli_tell("brdffit %s: --directions does not take '%s'; valid values: ", command, settings->directions);
        for (const struct cli_choice *c = directions; c->name != NULL; c++) {
            brdffit_cli_tell("%s%s", c == directions ? "" : ", ", c->name);
        }
        brdffit_cli_tell("; several with commas between them\n");
        return -1;
    }
    return 0;
}

void brdffit_cli_reading_options(const struct cli_settings *settings, brdffit_io_options *options)
{
    const int values = settings->values;
    options->quantity_set = values != CLI_UNSET;
    if (values == BRDFFIT_QUANTITY_BRDF || values == BRDFFIT_QUANTITY_RADIANCE) {
        options->quantity = (brdffit_quantity)values;
    } else if (values != CLI_UNSET) {
        options->quantity = BRDFFIT_QUANTITY_BRDF;
        options->values = values == CLI_VALUES_CCBRDF ? BRDFFIT_IO_VALUES_CCBRDF : BRDFFIT_IO_VALUES_REFLECTANCE_FACTOR;
    }
    options->channels = settings->channels;
    options->columns = settings->columns;
    if (settings->missing != NULL) {
        (void)missing_kind(settings->missing, &options->missing, &options->missing_value);
    }
    options->directions_as = settings->directions != NULL ? direction_bits(settings->directions) : 0;
    options->saturated = settings->saturated;
    options->fault = brdffit_cli_fault(&options->fault_size);
}

void brdffit_cli_record_reading(struct cli_text *text, const struct cli_settings *s)
{
    const char *const given[] = {s->channels, s->columns, s->missing, s->directions};
    static const char *const names[] = {"channels", "column", "missing", "directions"};
    for (int i = 0; i < 4; i++) {
        if (given[i] != NULL) {
            brdffit_cli_text_printf(text, "--%s %s\n", names[i], given[i]);
        }
    }
    if (s->saturated > 0) {
        brdffit_cli_text_printf(text, "--saturated %.17g\n", s->saturated);
    }
}

void brdffit_cli_json_reading(struct cli_json *json, const struct cli_settings *s)
{
    const int converted = s->values == CLI_VALUES_CCBRDF || s->values == CLI_VALUES_REFLECTANCE_FACTOR;
    const char *const given[] = {s->channels, s->columns, s->missing, s->directions,
                                 converted ? brdffit_cli_choice_name(brdffit_cli_values_choices, s->values) : NULL};
    static const char *const names[] = {"channels", "column", "missing", "directions", "values"};
    int any = s->saturated > 0;
    for (int i = 0; i < 5; i++) {
        any |= given[i] != NULL;
    }
    if (!any) {
        return;
    }
    brdffit_cli_json_open(json, "reading", '{');
    for (int i = 0; i < 5; i++) {
        if (given[i] != NULL) {
            brdffit_cli_json_string(json, names[i], given[i]);
        }
    }
    if (s->saturated > 0) {
        brdffit_cli_json_number(json, "saturated", s->saturated);
    }
    brdffit_cli_json_close(json, '}');
}

static void json_list(struct cli_json *json, const char *key, const brdffit_table *table, int warnings)
{
    brdffit_cli_json_open(json, key, '[');
    for (size_t i = 0; i < table->note_count; i++) {
        if ((table->notes[i]->warning != 0) == warnings) {
            brdffit_cli_json_string(json, NULL, table->notes[i]->text);
        }
    }
    brdffit_cli_json_close(json, ']');
}

void brdffit_cli_json_notes(struct cli_json *json, const brdffit_table *table)
{
    json_list(json, "notes", table, 0);
    json_list(json, "data_warnings", table, 1);
}

void brdffit_cli_say_notes(const char *path, const brdffit_table *table, int warnings)
{
    const struct cli_style style = brdffit_cli_style(stderr);
    for (size_t i = 0; i < table->note_count; i++) {
        if (table->notes[i]->warning && !warnings) {
            continue;
        }
        struct cli_text text = {0};
        brdffit_cli_text_puts(&text, "brdffit: ");
        brdffit_cli_name(&text, style, strcmp(path, "-") == 0 ? "standard input" : path);
        brdffit_cli_text_puts(&text, table->notes[i]->warning ? ": warning: " : ": ");
        brdffit_cli_name(&text, style, table->notes[i]->text);
        brdffit_cli_tell("%s\n", brdffit_cli_text_string(&text));
        brdffit_cli_text_free(&text);
    }
}

void brdffit_cli_note_paragraphs(struct cli_text *text, struct cli_style style, const brdffit_table *table, int notes)
{
    for (size_t i = 0; i < table->note_count; i++) {
        const int warning = table->notes[i]->warning != 0;
        if (!warning && !notes) {
            continue;
        }
        struct cli_text words = {0};
        brdffit_cli_text_puts(&words, warning ? "data: " : "");
        brdffit_cli_name(&words, style, table->notes[i]->text);
        brdffit_cli_text_puts(&words, words.size > 0 && words.data[words.size - 1] == '?' ? "" : ".");
        brdffit_cli_paragraph(text, style, warning ? CLI_YELLOW : CLI_BOLD,
                              warning ? "Warning," : "Read:", brdffit_cli_text_string(&words));
        text->failed |= words.failed;
        brdffit_cli_text_free(&words);
    }
}
