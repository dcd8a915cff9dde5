/* parse.c: argv -> settings. Options may stand anywhere, take their value as
 * --name value or --name=value, and end at "--".
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "criteria.h"
#include "failure.h"
#include "lobes.h"
#include "models.h"
#include "parse.h"
#include "reading.h"
#include "settings.h"
#include "suggest.h"
#include "tell.h"
#include "terms.h"

int brdffit_cli_number(const char *text, double *value)
{
    /* strtod alone would take hexadecimal, "inf", "nan" and leading blanks. */
    if (*text == '\0' || text[strspn(text, "+-.0123456789eE")] != '\0') {
        return 0;
    }
    char *end;
    const double number = strtod(text, &end);
    if (end == text || *end != '\0' || !(number >= -1e308 && number <= 1e308)) {
        return 0;
    }
    *value = number;
    return 1;
}

/* ---- Names ------------------------------------------------------------- */

static const struct cli_option *find_long(const struct parser *p, const char *name, size_t length)
{
    for (const struct cli_option *o = brdffit_cli_options; o->name != NULL; o++) {
        if ((o->commands & p->command) && strlen(o->name) == length && strncmp(o->name, name, length) == 0) {
            return o;
        }
    }
    return NULL;
}

static enum cli_parse unknown_option(const struct parser *p, const char *shown, const char *name)
{
    for (const struct cli_option *o = brdffit_cli_options; o->name != NULL && find_long(p, name, strlen(name)) == NULL;
         o++) {
        if (!o->hidden && strcmp(o->name, name) == 0) {
            brdffit_cli_tell("brdffit %s: --%s does not apply to '%s'\n", p->command_name, name, p->command_name);
            return brdffit_cli_parse_failed(p);
        }
    }
    struct cli_suggestion near = {0};
    for (const struct cli_option *o = brdffit_cli_options; o->name != NULL; o++) {
        if (!o->hidden && (o->commands & p->command)) {
            brdffit_cli_suggest(&near, name, o->name);
        }
    }
    brdffit_cli_tell("brdffit %s: unknown option '%s'", p->command_name, shown);
    if (near.word != NULL) {
        brdffit_cli_tell("; did you mean '--%s'?", near.word);
    }
    fputc('\n', stderr);
    return brdffit_cli_parse_failed(p);
}

static const struct cli_option *find_short(const struct parser *p, char letter)
{
    for (const struct cli_option *o = brdffit_cli_options; o->name != NULL; o++) {
        if ((o->commands & p->command) && o->letter != 0 && o->letter == letter) {
            return o;
        }
    }
    return NULL;
}

/* ---- Values ------------------------------------------------------------ */

const struct cli_choice *brdffit_cli_choices_of(const struct cli_option *o)
{
    return o->kind == CLI_DISTRIBUTION                        ? brdffit_cli_distribution_choices()
           : o->kind >= CLI_FRESNEL && o->kind <= CLI_MASKING ? brdffit_cli_term_choices(o->kind)
                                                              : o->choices;
}

static enum cli_parse bad_choice(const struct parser *p, const struct cli_option *o, const char *text)
{
    brdffit_cli_tell("brdffit %s: --%s does not take '%s'; valid values:", p->command_name, o->name, text);
    struct cli_suggestion near = {0};
    const char *separator = " ";
    for (const struct cli_choice *c = brdffit_cli_choices_of(o); c->name != NULL; c++) {
        brdffit_cli_suggest(&near, text, c->name);
        if (c->hidden) {
            continue;
        }
        brdffit_cli_tell("%s%s", separator, c->name);
        separator = ", ";
    }
    if (near.word != NULL) {
        brdffit_cli_tell("; did you mean '%s'?", near.word);
    }
    fputc('\n', stderr);
    return brdffit_cli_parse_failed(p);
}

static enum cli_parse bad_number(const struct parser *p, const struct cli_option *o, const char *text)
{
    brdffit_cli_tell("brdffit %s: --%s does not take '%s'; valid values: ", p->command_name, o->name, text);
    if (o->kind == CLI_COUNT) {
        fputs("whole numbers from 1", stderr);
    } else if (o->high >= 1e300) {
        brdffit_cli_tell("numbers %s %g", o->low_open ? "above" : "from", o->low);
    } else {
        brdffit_cli_tell("numbers %s %g %s %g", o->low_open ? "above" : "from", o->low, o->low_open ? "up to" : "to",
                         o->high);
    }
    brdffit_cli_tell("%s\n", o->kind == CLI_DEGREES ? ", or off" : "");
    return brdffit_cli_parse_failed(p);
}

int brdffit_cli_whole_number(const char *text, size_t *value)
{
    double number;
    if (!brdffit_cli_number(text, &number) || !(number >= 1 && number <= 9e15)) {
        return 0;
    }
    *value = (size_t)number;
    return (double)*value == number;
}

static enum cli_parse add_to_list(char **list, const char *text)
{
    const size_t before = *list == NULL ? 0 : strlen(*list) + 1;
    char *const more = realloc(*list, before + strlen(text) + 1);
    if (more == NULL) {
        (void)brdffit_cli_no_memory();
        return CLI_PARSE_FAILED;
    }
    if (before > 0) {
        more[before - 1] = ',';
    }
    memcpy(more + before, text, strlen(text) + 1);
    *list = more;
    return CLI_PARSED;
}

static enum cli_parse set_value(const struct parser *p, const struct cli_option *o, const char *text)
{
    char *const member = (char *)p->settings + o->offset;
    double number;
    switch (o->kind) {
    case CLI_HELP: return CLI_PARSED_HELP;
    case CLI_FLAG: *(int *)(void *)member = 1; return CLI_PARSED;
    case CLI_STRING: *(const char **)(void *)member = text; return CLI_PARSED;
    case CLI_LIST: return add_to_list((char **)(void *)member, text);
    case CLI_CHOICE:
    case CLI_DISTRIBUTION:
    case CLI_FRESNEL:
    case CLI_DIFFUSE:
    case CLI_MASKING:
        for (const struct cli_choice *c = brdffit_cli_choices_of(o); c->name != NULL; c++) {
            if (strcmp(c->name, text) == 0) {
                *(int *)(void *)member = c->value;
                return CLI_PARSED;
            }
        }
        return bad_choice(p, o, text);
    case CLI_COUNT:
        return brdffit_cli_whole_number(text, (size_t *)(void *)member) ? CLI_PARSED : bad_number(p, o, text);
    case CLI_DEGREES:
    case CLI_NUMBER:
        if (o->kind == CLI_DEGREES && strcmp(text, "off") == 0) {
            number = 90;
        } else if (!brdffit_cli_number(text, &number) || !(number >= o->low && number <= o->high) ||
                   (o->low_open && !(number > o->low))) {
            return bad_number(p, o, text);
        }
        *(double *)(void *)member = number;
        return CLI_PARSED;
    }
    return CLI_PARSE_FAILED;
}

/* ---- Arguments --------------------------------------------------------- */

/* One option at argv[*at]; moves *at to the last argument that it took. */
static enum cli_parse parse_option(const struct parser *p, int argc, char **argv, int *at)
{
    const char *const given = argv[*at];
    const struct cli_option *option;
    const char *value = NULL;
    if (given[1] == '-') {
        const size_t length = strcspn(given + 2, "=");
        option = find_long(p, given + 2, length);
        if (given[2 + length] == '=') {
            value = given + 3 + length;
        }
        if (option == NULL) {
            char name[64] = "";
            memcpy(name, given + 2, length < sizeof name ? length : sizeof name - 1);
            return unknown_option(p, given, name);
        }
    } else {
        option = find_short(p, given[1]);
        /* -output is not -o utput, but a slip. */
        if (option == NULL || (given[2] != '\0' && find_long(p, given + 1, strcspn(given + 1, "=")) != NULL)) {
            char name[64] = "";
            const size_t length = strcspn(given + 1, "=");
            memcpy(name, given + 1, length < sizeof name ? length : sizeof name - 1);
            return unknown_option(p, given, name);
        }
        if (given[2] != '\0') {
            value = given + 2 + (given[2] == '=');
        }
    }
    const int takes_value = option->kind != CLI_FLAG && option->kind != CLI_HELP;
    if (!takes_value && value != NULL) {
        brdffit_cli_tell("brdffit %s: --%s takes no value\n", p->command_name, option->name);
        return brdffit_cli_parse_failed(p);
    }
    if (takes_value && value == NULL) {
        if (*at + 1 >= argc) {
            brdffit_cli_tell("brdffit %s: --%s needs a value: %s\n", p->command_name, option->name, option->value);
            return brdffit_cli_parse_failed(p);
        }
        value = argv[++*at];
    }
    return set_value(p, option, value);
}

static void set_defaults(struct cli_settings *settings)
{
    brdffit_options fit;
    brdffit_options_init(&fit);
    memset(settings, 0, sizeof *settings);
    settings->distribution = CLI_UNSET;
    settings->model_distribution = (int)fit.distribution;
    settings->norm = (int)fit.norm;
    settings->engine = (int)fit.engine;
    settings->verify_margin = 1e-3;
    settings->normalise = (int)fit.normalise;
    settings->sigma_min = fit.sigma_min;
    settings->sigma_max = fit.sigma_max;
    settings->exponent_min = fit.exponent_min;
    settings->exponent_max = fit.exponent_max;
    settings->gap = fit.relative_gap;
    settings->absolute_gap = fit.absolute_gap;
    settings->resolution = fit.sigma_resolution;
    settings->fresnel = (int)fit.fresnel;
    settings->diffuse = (int)fit.diffuse;
    settings->masking = (int)fit.masking;
    settings->max_incidence = CLI_UNSET;
    settings->box_budget = fit.box_budget;
    settings->values = CLI_UNSET;
    settings->weight = CLI_UNSET;
    settings->format = BRDFFIT_IO_FORMAT_AUTO;
    settings->merl_bins = BRDFFIT_IO_MERL_EDGE;
    settings->merl_samples = "table";
    settings->criterion = CLI_BIC;
    settings->threshold = CLI_TELLING;
}

/* Options and files, over what the settings hold. */
static enum cli_parse parse_arguments(const struct parser *p, int argc, char **argv)
{
    struct cli_settings *const settings = p->settings;
    int options_ended = 0;
    settings->file_count = 0;
    for (int at = 1; at < argc; at++) {
        if (options_ended || argv[at][0] != '-' || argv[at][1] == '\0') {
            settings->files[settings->file_count++] = argv[at];
        } else if (strcmp(argv[at], "--") == 0) {
            options_ended = 1;
        } else {
            const enum cli_parse answer = parse_option(p, argc, argv, &at);
            if (answer != CLI_PARSED) {
                return answer;
            }
        }
    }
    return CLI_PARSED;
}

/* --model stands for options, and those that are given with it come after it wherever it stands: once more, over them. */
static enum cli_parse parse_over_model(const struct parser *p, int argc, char **argv)
{
    const char **const files = p->settings->files;
    const char *const model = p->settings->model;
    free(p->settings->columns); /* to be read again */
    set_defaults(p->settings);
    p->settings->files = files;
    if (brdffit_cli_take_model(p->settings, p->command_name, model) != 0) {
        return brdffit_cli_parse_failed(p);
    }
    return parse_arguments(p, argc, argv);
}

enum cli_parse brdffit_cli_parse(unsigned command, const char *command_name, int argc, char **argv,
                                 struct cli_settings *settings)
{
    const struct parser p = {command, command_name, settings};
    set_defaults(settings);
    settings->files = calloc((size_t)argc + 1, sizeof *settings->files);
    if (settings->files == NULL) {
        (void)brdffit_cli_no_memory();
        return CLI_PARSE_NO_MEMORY;
    }
    enum cli_parse answer = parse_arguments(&p, argc, argv);
    if (answer == CLI_PARSED && settings->model != NULL) {
        answer = parse_over_model(&p, argc, argv);
    }
    if (command != CLI_COMPARE) { /* whose list of models settles it */
        brdffit_cli_settle_incidence(settings);
    }
    return answer == CLI_PARSED ? brdffit_cli_parse_check(&p) : answer;
}
