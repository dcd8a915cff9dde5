/* model_names.c: what forms of model are called:
 *
 *     [N]DISTRIBUTION[+[N]DISTRIBUTION...][/TERM...]
 *
 * The names are the library's. A term is a masking, a Fresnel term or a diffuse term, in any order, one of a kind; printed in
 * this order, and only where it is not the default. "none" is no-KIND, so that it says of what.
 * SPDX-License-Identifier: MIT */
#include "models.h"

#include <stdio.h>
#include <string.h>

#include "lobes.h"
#include "terms.h"

enum { TERMS = 3 };

static const struct {
    enum cli_option_kind kind;
    const char *none;
} terms[TERMS] = {{CLI_MASKING, "no-masking"}, {CLI_FRESNEL, "no-fresnel"}, {CLI_DIFFUSE, "no-diffuse"}};

static int term_of(const struct cli_model *model, int term)
{
    const int values[TERMS] = {(int)model->masking, (int)model->fresnel, (int)model->diffuse};
    return values[term];
}

static void set_term(struct cli_model *model, int term, int value)
{
    switch (terms[term].kind) {
    case CLI_MASKING: model->masking = (brdffit_masking)value; break;
    case CLI_FRESNEL: model->fresnel = (brdffit_fresnel)value; break;
    default: model->diffuse = (brdffit_diffuse)value; break;
    }
}

static const char *term_name(int term, const struct cli_choice *choice)
{
    return strcmp(choice->name, "none") == 0 ? terms[term].none : choice->name;
}

void brdffit_cli_add_term_names(struct cli_text *text)
{
    const char *separator = "";
    for (int t = 0; t < TERMS; t++) {
        for (const struct cli_choice *c = brdffit_cli_term_choices(terms[t].kind); c->name != NULL; c++) {
            brdffit_cli_text_printf(text, "%s%s", separator, term_name(t, c));
            separator = ", ";
        }
    }
}

/* ---- From a form to its name ------------------------------------------- */

/* How many lobes of one distribution stand at p and after. */
static int run_length(const struct cli_model *model, int p)
{
    int end = p;
    while (end < model->lobes && model->distributions[end] == model->distributions[p]) {
        end++;
    }
    return end - p;
}

static void set_name(struct cli_model *model)
{
    size_t size = 0;
    for (int p = 0; p < model->lobes; p += run_length(model, p)) {
        const int count = run_length(model, p);
        char number[12] = "";
        if (count > 1) {
            (void)snprintf(number, sizeof number, "%d", count);
        }
        size += (size_t)snprintf(model->name + size, sizeof model->name - size, "%s%s%s", p > 0 ? "+" : "", number,
                                 brdffit_distribution_string(model->distributions[p]));
    }
    for (int t = 0; t < TERMS; t++) {
        if (term_of(model, t) != 0) {
            const struct cli_choice *const choice = brdffit_cli_term_choices(terms[t].kind) + term_of(model, t);
            size += (size_t)snprintf(model->name + size, sizeof model->name - size, "/%s", term_name(t, choice));
        }
    }
}

void brdffit_cli_add_model(struct cli_text *text, const struct cli_model *model)
{
    static const char *const masking[] = {"", ", Smith", ", separable Smith", ", no masking"};
    static const char *const fresnel[] = {"", ", Schlick"};
    static const char *const diffuse[] = {"", ", no diffuse", ", Oren-Nayar", ", Burley"};
    for (int p = 0; p < model->lobes; p += run_length(model, p)) {
        const int count = run_length(model, p);
        brdffit_cli_text_puts(text, p > 0 ? " + " : "");
        if (count > 1) {
            brdffit_cli_text_printf(text, "%d ", count);
        }
        brdffit_cli_text_puts(text, brdffit_distribution_title(model->distributions[p]));
    }
    brdffit_cli_text_puts(text, masking[model->masking]);
    brdffit_cli_text_puts(text, fresnel[model->fresnel]);
    brdffit_cli_text_puts(text, diffuse[model->diffuse]);
}

/* ---- From a name to its form ------------------------------------------- */

static int is_called(const char *known, const char *name, size_t length)
{
    return strlen(known) == length && memcmp(known, name, length) == 0;
}

/* [N]DISTRIBUTION of `length` bytes, as further lobes of the model. */
static int add_part(struct cli_model *model, const char *part, size_t length)
{
    int count = 1;
    if (length > 0 && part[0] >= '1' && part[0] <= '0' + BRDFFIT_MAX_LOBES) {
        count = part[0] - '0';
        part++;
        length--;
    }
    for (const struct cli_choice *c = brdffit_cli_distribution_choices(); c->name != NULL; c++) {
        if (is_called(c->name, part, length)) {
            for (; count > 0 && model->lobes < BRDFFIT_MAX_LOBES; count--) {
                model->distributions[model->lobes++] = (brdffit_distribution)c->value;
            }
            return count == 0;
        }
    }
    return 0;
}

/* Lobes, with + between. */
static int add_lobes(struct cli_model *model, const char *lobes, size_t length)
{
    for (size_t at = 0; at <= length;) {
        const char *const plus = memchr(lobes + at, '+', length - at);
        const size_t part = plus != NULL ? (size_t)(plus - (lobes + at)) : length - at;
        if (!add_part(model, lobes + at, part)) {
            return 0;
        }
        at += part + 1;
    }
    brdffit_cli_group_lobes(model->distributions, model->lobes);
    return 1;
}

/* A term of `length` bytes; *given has the bits of the kinds that were there before. */
static int add_term(struct cli_model *model, const char *name, size_t length, unsigned *given)
{
    for (int t = 0; t < TERMS; t++) {
        for (const struct cli_choice *c = brdffit_cli_term_choices(terms[t].kind); c->name != NULL; c++) {
            if (is_called(term_name(t, c), name, length)) {
                const int again = *given >> t & 1;
                *given |= 1u << t;
                set_term(model, t, c->value);
                return !again;
            }
        }
    }
    return 0;
}

static size_t to_slash(const char *name, size_t length)
{
    const char *const slash = memchr(name, '/', length);
    return slash != NULL ? (size_t)(slash - name) : length;
}

int brdffit_cli_read_model(const char *name, size_t length, struct cli_model *model)
{
    const struct cli_model none = {
        "", 0, {BRDFFIT_BECKMANN}, BRDFFIT_FRESNEL_NONE, BRDFFIT_MASKING_V_CAVITY, BRDFFIT_DIFFUSE_LAMBERT};
    unsigned given = 0;
    size_t at = to_slash(name, length);
    *model = none;
    if (!add_lobes(model, name, at)) {
        return 0;
    }
    while (at < length) {
        at++; /* the slash */
        const size_t part = to_slash(name + at, length - at);
        if (!add_term(model, name + at, part, &given)) {
            return 0;
        }
        at += part;
    }
    set_name(model);
    return 1;
}
