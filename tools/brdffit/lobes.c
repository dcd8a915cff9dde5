/* lobes.c: which lobes a fit has. SPDX-License-Identifier: MIT */
#include "lobes.h"

#include <stdio.h>
#include <string.h>

#include "suggest.h"
#include "tell.h"
#include "terms.h"

/* The last of these ends the list. */
static struct cli_choice choices[BRDFFIT_DISTRIBUTION_COUNT + 1];

const struct cli_choice *brdffit_cli_distribution_choices(void)
{
    for (int d = 0; d < BRDFFIT_DISTRIBUTION_COUNT; d++) {
        choices[d].name = brdffit_distribution_string((brdffit_distribution)d);
        choices[d].value = d;
    }
    return choices;
}

brdffit_distribution brdffit_cli_lobe(const brdffit_options *options, int p)
{
    return options->distributions != NULL ? options->distributions[p] : options->distribution;
}

int brdffit_cli_by_exponent(brdffit_distribution distribution)
{
    return strcmp(brdffit_parameter_string(distribution), "exponent") == 0;
}

int brdffit_cli_any_lobe_by(const brdffit_options *options, int exponent)
{
    int found = 0;
    for (int p = 0; p < options->lobes; p++) {
        found |= brdffit_cli_by_exponent(brdffit_cli_lobe(options, p)) == exponent;
    }
    return found;
}

int brdffit_cli_lobes_differ(const brdffit_options *options)
{
    int differ = 0;
    for (int p = 1; p < options->lobes; p++) {
        differ |= brdffit_cli_lobe(options, p) != brdffit_cli_lobe(options, 0);
    }
    return differ;
}

/* ---- Words ------------------------------------------------------------- */

const char *brdffit_cli_parameter(struct cli_style style, brdffit_distribution distribution)
{
    return brdffit_cli_by_exponent(distribution) ? "n" : brdffit_cli_glyph(style, CLI_SIGMA);
}

void brdffit_cli_add_parameters(struct cli_text *text, struct cli_style style, const brdffit_options *options)
{
    const int sigma = brdffit_cli_any_lobe_by(options, 0), exponent = brdffit_cli_any_lobe_by(options, 1);
    brdffit_cli_text_printf(text, "%s%s%s", sigma ? brdffit_cli_glyph(style, CLI_SIGMA) : "",
                            sigma && exponent ? " and " : "", exponent ? "n" : "");
}

/* "one Beckmann, one GGX and one Ward lobe", "two GGX lobes and one Ward lobe": in the order of a result. */
static void add_kinds(struct cli_text *text, const brdffit_options *options)
{
    static const char *const numbers[] = {"no", "one", "two", "three"};
    for (int p = 0, next; p < options->lobes; p = next) {
        const brdffit_distribution kind = brdffit_cli_lobe(options, p);
        int after = 0;
        for (next = p; next < options->lobes && brdffit_cli_lobe(options, next) == kind; next++)
            ;
        for (; next + after < options->lobes &&
               brdffit_cli_lobe(options, next + after) == brdffit_cli_lobe(options, next);
             after++)
            ;
        brdffit_cli_text_puts(text, p == 0 ? "" : next < options->lobes ? ", " : " and ");
        brdffit_cli_text_printf(text, "%s %s", numbers[next - p], brdffit_distribution_title(kind));
        if (after == 0 || (after == 1) != (next - p == 1)) { /* the noun serves the next kind too, if in its number */
            brdffit_cli_text_puts(text, next - p == 1 ? " lobe" : " lobes");
        }
    }
}

void brdffit_cli_add_family(struct cli_text *text, const brdffit_options *options)
{
    if (brdffit_cli_lobes_differ(options)) {
        brdffit_cli_text_puts(text, "fit of ");
        add_kinds(text, options);
    } else {
        brdffit_cli_text_printf(text, "%s fit with %d %s", brdffit_distribution_title(brdffit_cli_lobe(options, 0)),
                                options->lobes, options->lobes == 1 ? "lobe" : "lobes");
    }
    brdffit_cli_add_terms(text, options);
}

void brdffit_cli_add_names(struct cli_text *text, const brdffit_options *options)
{
    for (int p = 0; p < options->lobes; p++) {
        brdffit_cli_text_printf(text, "%s%s", p == 0 ? "" : ",",
                                brdffit_distribution_string(brdffit_cli_lobe(options, p)));
    }
}

/* ---- From the command line --------------------------------------------- */

void brdffit_cli_group_lobes(brdffit_distribution *list, int count)
{
    for (int p = 1; p < count; p++) {
        const brdffit_distribution moved = list[p];
        int to = p;
        for (int q = 0; q < p; q++) {
            to = list[q] == moved ? q + 1 : to;
        }
        memmove(list + to + 1, list + to, (size_t)(p - to) * sizeof *list);
        list[to] = moved;
    }
}

int brdffit_cli_read_names(const char *names, brdffit_distribution list[BRDFFIT_MAX_LOBES], char bad[32])
{
    int count = 0;
    for (const char *at = names;; count++) {
        const size_t length = strcspn(at, ",");
        const struct cli_choice *c = brdffit_cli_distribution_choices();
        for (; c->name != NULL && !(strlen(c->name) == length && strncmp(c->name, at, length) == 0); c++)
            ;
        if (c->name == NULL) {
            (void)snprintf(bad, 32, "%.*s", (int)(length < 31 ? length : 31), at);
            return -1;
        }
        if (count < BRDFFIT_MAX_LOBES) {
            list[count] = (brdffit_distribution)c->value;
        }
        if (at[length] == '\0') {
            return count < BRDFFIT_MAX_LOBES ? count + 1 : 0;
        }
        at += length + 1;
    }
}

/* What --lobes takes, after what it was given. */
static void refuse(const char *command_name, const char *given, const char *bad)
{
    struct cli_suggestion near = {0};
    if (command_name == NULL) {
        return;
    }
    brdffit_cli_tell(
        "brdffit %s: --lobes does not take '%s'; valid values: 1 to %d, %sor up to %d names with commas:", command_name,
        given, BRDFFIT_MAX_LOBES, strcmp(command_name, "fit") == 0 ? "auto, " : "", BRDFFIT_MAX_LOBES);
    for (const struct cli_choice *c = brdffit_cli_distribution_choices(); c->name != NULL; c++) {
        brdffit_cli_tell("%s %s", c == choices ? "" : ",", c->name);
        brdffit_cli_suggest(&near, bad, c->name);
    }
    if (near.word != NULL) {
        brdffit_cli_tell("; did you mean '%s'?", near.word);
    }
    fputc('\n', stderr);
}

/* So many of one distribution; all that there can be are filled in, as --lobes auto tries them. */
static void take_count(struct cli_settings *s, int lobes)
{
    const int distribution = s->distribution != CLI_UNSET ? s->distribution : s->model_distribution;
    s->lobes = lobes;
    for (int p = 0; p < BRDFFIT_MAX_LOBES; p++) {
        s->distributions[p] = (brdffit_distribution)distribution;
    }
}

/* 0, or the reason is on stderr. */
static int take_auto(struct cli_settings *s, const char *command_name)
{
    s->lobes_auto = 1;
    take_count(s, 1);
    if (s->norm != BRDFFIT_NORM_L2) {
        brdffit_cli_tell("brdffit %s: --lobes auto is for --norm l2\n", command_name);
        return -1;
    }
    return 0;
}

int brdffit_cli_settle_lobes(struct cli_settings *s, const char *command_name)
{
    const char *const given = s->lobes_given;
    char bad[32] = "";
    brdffit_options defaults;
    brdffit_options_init(&defaults);
    if (given == NULL || (given[0] >= '1' && given[0] <= '0' + BRDFFIT_MAX_LOBES && given[1] == '\0')) {
        take_count(s, given == NULL ? defaults.lobes : given[0] - '0');
        return 0;
    }
    if (strcmp(given, "auto") == 0 && command_name != NULL && strcmp(command_name, "fit") == 0) {
        return take_auto(s, command_name);
    }
    s->lobes = brdffit_cli_read_names(given, s->distributions, bad);
    if (s->lobes < 1) {
        refuse(command_name, given, bad);
        return -1;
    }
    if (s->distribution != CLI_UNSET && command_name == NULL) {
        return -1;
    }
    if (s->distribution != CLI_UNSET) {
        brdffit_cli_tell(
            "brdffit %s: --lobes %s names the distributions: --distribution %s does not go with it, only with a "
            "number\n",
            command_name, given, brdffit_distribution_string((brdffit_distribution)s->distribution));
        return -1;
    }
    brdffit_cli_group_lobes(s->distributions, s->lobes);
    return 0;
}
