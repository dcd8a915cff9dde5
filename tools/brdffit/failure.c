/* failure.c: exit codes, and errors in words. SPDX-License-Identifier: MIT */
#include "failure.h"
#include "tell.h"

#include <stdio.h>
#include <string.h>

int brdffit_cli_worse_exit(int a, int b)
{
    if (a == CLI_EXIT_CERTIFIED || b == CLI_EXIT_CERTIFIED) {
        return a + b;
    }
    return a < b ? a : b;
}

int brdffit_cli_status_exit(brdffit_status status)
{
    switch (status) {
    case BRDFFIT_OK: return CLI_EXIT_CERTIFIED;
    case BRDFFIT_ERR_OPTION:
    case BRDFFIT_ERR_UNSUPPORTED: return CLI_EXIT_USAGE;
    case BRDFFIT_ERR_VALUE:
    case BRDFFIT_ERR_NO_SAMPLES:
    case BRDFFIT_ERR_FORMAT: return CLI_EXIT_DATA;
    default: return CLI_EXIT_FAILURE;
    }
}

const char *brdffit_cli_status_name(brdffit_status status)
{
    switch (status) {
    case BRDFFIT_OK: return "ok";
    case BRDFFIT_ERR_ARGUMENT: return "argument";
    case BRDFFIT_ERR_OPTION: return "option";
    case BRDFFIT_ERR_UNSUPPORTED: return "unsupported";
    case BRDFFIT_ERR_WORKSPACE: return "workspace";
    case BRDFFIT_ERR_VALUE: return "value";
    case BRDFFIT_ERR_NO_SAMPLES: return "no_samples";
    case BRDFFIT_ERR_MEMORY: return "memory";
    case BRDFFIT_ERR_OPEN: return "open";
    case BRDFFIT_ERR_READ: return "read";
    case BRDFFIT_ERR_FORMAT: return "format";
    case BRDFFIT_STATUS_COUNT: break;
    }
    return "unknown";
}

const char *brdffit_cli_message(const brdffit_error *error)
{
    return error->message != NULL ? error->message : brdffit_status_string(error->status);
}

int brdffit_cli_has_value(const brdffit_error *error)
{
    /* 0 also means "does not apply"; a zero that is itself wrong is rare and
     * its place is given anyway. */
    return error->value > 0 || error->value < 0 || error->value != error->value;
}

size_t brdffit_cli_error_line(const brdffit_error *error, const brdffit_table *table)
{
    if (error->line != BRDFFIT_NONE) {
        return error->line;
    }
    if (table != NULL && table->lines != NULL && error->sample < table->samples->count) {
        return table->lines[error->sample];
    }
    return BRDFFIT_NONE;
}

static char fault[80];

char *brdffit_cli_fault(size_t *size)
{
    *size = sizeof fault;
    return fault;
}

/* The message and the value. A message that says what its value is, as in
 * "the line is too short (value: fields found)", becomes "the line is too
 * short (fields found: 6)". */
static void add_message(struct cli_text *text, const brdffit_error *error)
{
    const char *message = brdffit_cli_message(error);
    const char *label = strstr(message, "(value: ");
    if (label != NULL && label[strlen(label) - 1] == ')') {
        brdffit_cli_text_add(text, message, (size_t)(label - message) + 1);
        label += strlen("(value: ");
        brdffit_cli_text_add(text, label, strlen(label) - 1);
        brdffit_cli_text_printf(text, ": %.17g)", error->value);
        return;
    }
    brdffit_cli_text_puts(text, message);
    if (brdffit_cli_has_value(error) && (!fault[0] || error->value - error->value == 0)) {
        brdffit_cli_text_printf(text, ": %.17g", error->value);
    }
}

void brdffit_cli_describe(struct cli_text *text, struct cli_style style, const brdffit_error *error,
                          const brdffit_table *table)
{
    const size_t line = brdffit_cli_error_line(error, table);
    const char *separator = "";
    if (line != BRDFFIT_NONE) {
        brdffit_cli_text_printf(text, "line %zu", line);
        separator = ", ";
    }
    if (error->column != BRDFFIT_NONE) {
        brdffit_cli_text_printf(text, "%sfield %zu", separator, error->column);
        separator = ", ";
    }
    if (error->channel != BRDFFIT_NONE) {
        const int inside = error->column != BRDFFIT_NONE;
        brdffit_cli_text_puts(text, inside ? " (channel " : separator);
        if (!inside) {
            brdffit_cli_text_puts(text, "channel ");
        }
        if (table != NULL && error->channel < table->samples->channels) {
            brdffit_cli_name(text, style, table->channel_names[error->channel]);
        } else {
            brdffit_cli_text_printf(text, "%zu", error->channel + 1);
        }
        brdffit_cli_text_puts(text, inside ? ")" : "");
        separator = ", ";
    }
    if (error->sample != BRDFFIT_NONE) {
        brdffit_cli_text_printf(text, "%ssample %zu", separator, error->sample + 1);
        separator = ", ";
    }
    brdffit_cli_text_puts(text, *separator ? ": " : "");
    add_message(text, error);
    if (fault[0] && !(brdffit_cli_has_value(error) && error->value - error->value == 0)) {
        brdffit_cli_text_puts(text, ": '");
        brdffit_cli_name(text, style, fault);
        brdffit_cli_text_puts(text, "'");
    }
}

void brdffit_cli_report_error(const char *path, const brdffit_error *error, const brdffit_table *table,
                              int system_error)
{
    const struct cli_style style = brdffit_cli_style(stderr);
    struct cli_text text = {0};
    brdffit_cli_text_puts(&text, "brdffit: ");
    brdffit_cli_name(&text, style, strcmp(path, "-") == 0 ? "standard input" : path);
    brdffit_cli_text_puts(&text, ": ");
    brdffit_cli_describe(&text, style, error, table);
    if (system_error != 0 && (error->status == BRDFFIT_ERR_OPEN || error->status == BRDFFIT_ERR_READ)) {
        brdffit_cli_text_printf(&text, " (%s)", strerror(system_error));
    }
    brdffit_cli_tell("%s\n", text.failed ? "brdffit: out of memory" : brdffit_cli_text_string(&text));
    brdffit_cli_text_free(&text);
}

int brdffit_cli_no_memory(void)
{
    brdffit_cli_tell("brdffit: out of memory\n");
    return CLI_EXIT_FAILURE;
}
