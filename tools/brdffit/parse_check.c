/* parse_check.c: what no single option can see. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "parse.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "lobes.h"
#include "reading.h"
#include "tell.h"

enum cli_parse brdffit_cli_parse_failed(const struct parser *p)
{
    brdffit_cli_tell("Try 'brdffit %s --help'.\n", p->command_name);
    return CLI_PARSE_FAILED;
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
            return brdffit_cli_parse_failed(p);
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
        return brdffit_cli_parse_failed(p);
    }
    if (s->norm != BRDFFIT_NORM_L2) {
        brdffit_cli_tell("brdffit %s: --verify is for --norm l2\n", p->command_name);
        return brdffit_cli_parse_failed(p);
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
    return brdffit_cli_parse_failed(p);
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
    return digits[strspn(digits, "0123456789")] == '\0' && brdffit_cli_whole_number(digits, value);
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
        return brdffit_cli_parse_failed(p);
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
    return brdffit_cli_parse_failed(p);
}

enum cli_parse brdffit_cli_parse_check(const struct parser *p)
{
    const struct cli_settings *s = p->settings;
    size_t standard_inputs = 0;
    for (size_t i = 0; i < s->file_count; i++) {
        standard_inputs += strcmp(s->files[i], "-") == 0;
    }
    if (s->file_count == 0) {
        brdffit_cli_tell("brdffit %s: no FILE given\n", p->command_name);
        return brdffit_cli_parse_failed(p);
    }
    if (p->command == CLI_EVAL && s->file_count != 2) {
        brdffit_cli_tell("brdffit eval: needs two files, FIT.json and FILE, not %zu\n", s->file_count);
        return brdffit_cli_parse_failed(p);
    }
    if (p->command == CLI_MAP && (s->file_count != 1 || standard_inputs > 0)) {
        brdffit_cli_tell("brdffit map: needs one STACK, a file or a folder\n");
        return brdffit_cli_parse_failed(p);
    }
    if (standard_inputs > 1) {
        brdffit_cli_tell("brdffit %s: standard input ('-') can be read only once\n", p->command_name);
        return brdffit_cli_parse_failed(p);
    }
    if (brdffit_cli_settle_lobes(p->settings, p->command_name) != 0 || check_ranges(p) != CLI_PARSED) {
        return brdffit_cli_parse_failed(p);
    }
    if (*s->merl_samples == '\0' || (s->output != NULL && *s->output == '\0')) {
        brdffit_cli_tell("brdffit %s: --merl-samples and --output need a file's name\n", p->command_name);
        return brdffit_cli_parse_failed(p);
    }
    if (check_shard(p) != CLI_PARSED) {
        return CLI_PARSE_FAILED;
    }
    if (brdffit_cli_check_reading(s, p->command_name) != 0) {
        return brdffit_cli_parse_failed(p);
    }
    const enum cli_parse verify = check_verify(p);
    if (verify != CLI_PARSED || check_confidence(p) != CLI_PARSED) {
        return CLI_PARSE_FAILED;
    }
    return check_output(p);
}
