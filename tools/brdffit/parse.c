/* parse.c: argv -> settings. Options may stand anywhere, take their value as
 * --name value or --name=value, and end at "--".
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "criteria.h"
#include "failure.h"
#include "lobes.h"
#include "models.h"
#include "reading.h"
#include "settings.h"
#include "suggest.h"
#include "tell.h"
#include "terms.h"

struct parser {
    unsigned command;
    const char *command_name;
    struct cli_settings *settings;
};

static enum cli_parse usage(const struct parser *p)
{
    brdffit_cli_tell("Try 'brdffit %s --help'.\n", p->command_name);
    return CLI_PARSE_FAILED;
}

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
            return usage(p);
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
    return usage(p);
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
    return usage(p);
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
    return usage(p);
}

static int whole_number(const char *text, size_t *value)
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
    case CLI_COUNT: return whole_number(text, (size_t *)(void *)member) ? CLI_PARSED : bad_number(p, o, text);
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
        return usage(p);
    }
    if (takes_value && value == NULL) {
        if (*at + 1 >= argc) {
            brdffit_cli_tell("brdffit %s: --%s needs a value: %s\n", p->command_name, option->name, option->value);
            return usage(p);
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

/* Measurements are not to be lost to a slip of the keyboard. */
static enum cli_parse check_output(const struct parser *p)
{
    const struct cli_settings *s = p->settings;
    struct stat output, input;
    if (s->output == NULL || stat(s->output, &output) != 0 || !S_ISREG(output.st_mode)) {
        return CLI_PARSED;
    }
    for (size_t i = 0; i < s->file_count; i++) {
        if (stat(s->files[i], &input) == 0 && input.st_dev == output.st_dev && input.st_ino == output.st_ino) {
            brdffit_cli_tell("brdffit %s: --output %s would replace the input %s\n", p->command_name, s->output,
                             s->files[i]);
            return usage(p);
        }
    }
    return CLI_PARSED;
}

/* The range of a parameter: in order, and left alone where no lobe has that parameter. */
static enum cli_parse check_range(const struct parser *p, const char *name, double low, double high, double default_low,
                                  double default_high)
{
    const struct cli_settings *s = p->settings;
    int found = 0;
    if (!(low <= high)) {
        brdffit_cli_tell("brdffit %s: --%s-min %g is above --%s-max %g\n", p->command_name, name, low, name, high);
        return CLI_PARSE_FAILED;
    }
    for (int k = 0; k < s->lobes; k++) {
        found |= strcmp(name, brdffit_parameter_string(s->distributions[k])) == 0;
    }
    if (found || p->command == CLI_COMPARE || (low == default_low && high == default_high)) {
        return CLI_PARSED;
    }
    const char *parameter = brdffit_parameter_string(s->distributions[0]);
    const int named = s->lobes_given != NULL && strchr("123", s->lobes_given[0]) == NULL;
    brdffit_cli_tell("brdffit %s: --%s %s has no %s; its range is --%s-min to --%s-max\n", p->command_name,
                     named ? "lobes" : "distribution",
                     named ? s->lobes_given : brdffit_distribution_string(s->distributions[0]), name, parameter,
                     parameter);
    return CLI_PARSE_FAILED;
}

static enum cli_parse check_ranges(const struct parser *p)
{
    const struct cli_settings *s = p->settings;
    brdffit_options fit;
    brdffit_options_init(&fit);
    if (check_range(p, "sigma", s->sigma_min, s->sigma_max, fit.sigma_min, fit.sigma_max) != CLI_PARSED) {
        return CLI_PARSE_FAILED;
    }
    return check_range(p, "exponent", s->exponent_min, s->exponent_max, fit.exponent_min, fit.exponent_max);
}

/* socp or socp=MARGIN, and only for what it can verify. */
static enum cli_parse check_verify(const struct parser *p)
{
    struct cli_settings *s = p->settings;
    if (s->verify == NULL) {
        return CLI_PARSED;
    }
    const int plain = strcmp(s->verify, "socp") == 0;
    if (!plain && !(strncmp(s->verify, "socp=", 5) == 0 && brdffit_cli_number(s->verify + 5, &s->verify_margin) &&
                    s->verify_margin >= 0 && s->verify_margin < 1)) {
        brdffit_cli_tell("brdffit %s: --verify does not take '%s'; valid values: socp, or socp=X with X "
                         "from 0 to below 1\n",
                         p->command_name, s->verify);
        return usage(p);
    }
    if (s->norm != BRDFFIT_NORM_L2) {
        brdffit_cli_tell("brdffit %s: --verify is for --norm l2\n", p->command_name);
        return usage(p);
    }
    return CLI_PARSED;
}

/* Only for what has intervals. */
static enum cli_parse check_confidence(const struct parser *p)
{
    const struct cli_settings *s = p->settings;
    if (s->confidence == 0 || (s->norm == BRDFFIT_NORM_L2 && s->engine == BRDFFIT_ENGINE_MOMENT)) {
        return CLI_PARSED;
    }
    brdffit_cli_tell("brdffit %s: --confidence is for --norm l2 and --engine moment\n", p->command_name);
    return usage(p);
}

/* Digits and no more: 1/4, but not 1.0/4 or +1/4. */
static int plain_count(const char *text, size_t length, size_t *value)
{
    char digits[20];
    if (length == 0 || length >= sizeof digits) {
        return 0;
    }
    memcpy(digits, text, length);
    digits[length] = '\0';
    return digits[strspn(digits, "0123456789")] == '\0' && whole_number(digits, value);
}

/* I/N with 1 <= I <= N; without it, all is part 1 of 1. */
static enum cli_parse check_shard(const struct parser *p)
{
    struct cli_settings *s = p->settings;
    s->shard_count = 1;
    if (s->shard == NULL) {
        return CLI_PARSED;
    }
    const size_t slash = strcspn(s->shard, "/");
    if (s->shard[slash] == '\0' || !plain_count(s->shard, slash, &s->shard_index) ||
        !plain_count(s->shard + slash + 1, strlen(s->shard + slash + 1), &s->shard_count) ||
        s->shard_index > s->shard_count) {
        brdffit_cli_tell("brdffit %s: --shard does not take '%s'; valid values: I/N, I from 1 to N\n", p->command_name,
                         s->shard);
        return usage(p);
    }
    s->shard_index--;
    const char *not_with = s->fresh ? "does not go with --fresh: other parts may be at work" : NULL;
    if (p->command == CLI_FIT && !s->json) {
        not_with = "needs --json: reports cannot be merged";
    }
    for (size_t i = 0; p->command == CLI_FIT && i < s->file_count; i++) {
        if (strcmp(s->files[i], "-") == 0) {
            not_with = "needs files with names: parts do not share standard input";
        }
    }
    if (not_with == NULL) {
        return CLI_PARSED;
    }
    brdffit_cli_tell("brdffit %s: --shard %s\n", p->command_name, not_with);
    return usage(p);
}

/* What no single option can see. */
static enum cli_parse check_together(const struct parser *p)
{
    const struct cli_settings *s = p->settings;
    size_t standard_inputs = 0;
    for (size_t i = 0; i < s->file_count; i++) {
        standard_inputs += strcmp(s->files[i], "-") == 0;
    }
    if (s->file_count == 0) {
        brdffit_cli_tell("brdffit %s: no FILE given\n", p->command_name);
        return usage(p);
    }
    if (p->command == CLI_EVAL && s->file_count != 2) {
        brdffit_cli_tell("brdffit eval: needs two files, FIT.json and FILE, not %zu\n", s->file_count);
        return usage(p);
    }
    if (p->command == CLI_MAP && (s->file_count != 1 || standard_inputs > 0)) {
        brdffit_cli_tell("brdffit map: needs one STACK, a file or a folder\n");
        return usage(p);
    }
    if (standard_inputs > 1) {
        brdffit_cli_tell("brdffit %s: standard input ('-') can be read only once\n", p->command_name);
        return usage(p);
    }
    if (brdffit_cli_settle_lobes(p->settings, p->command_name) != 0 || check_ranges(p) != CLI_PARSED) {
        return usage(p);
    }
    if (*s->merl_samples == '\0' || (s->output != NULL && *s->output == '\0')) {
        brdffit_cli_tell("brdffit %s: --merl-samples and --output need a file's name\n", p->command_name);
        return usage(p);
    }
    if (check_shard(p) != CLI_PARSED) {
        return CLI_PARSE_FAILED;
    }
    if (brdffit_cli_check_reading(s, p->command_name) != 0) {
        return usage(p);
    }
    const enum cli_parse verify = check_verify(p);
    if (verify != CLI_PARSED || check_confidence(p) != CLI_PARSED) {
        return CLI_PARSE_FAILED;
    }
    return check_output(p);
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
        return usage(p);
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
    return answer == CLI_PARSED ? check_together(&p) : answer;
}
