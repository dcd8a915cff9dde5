/* compare_words.c: what the data say of the forms of a list. What is called
 * proven follows from lower bounds. SPDX-License-Identifier: MIT */
#include "compare.h"

#include <math.h>

#include "words.h"

static void paragraph(struct cli_text *text, struct cli_style style, enum cli_ink ink, const char *lead,
                      struct cli_text *words)
{
    if (words->size > 0) {
        brdffit_cli_paragraph(text, style, ink, lead, brdffit_cli_text_string(words));
    }
    text->failed |= words->failed;
    brdffit_cli_text_free(words);
}

/* A title in a list: semicolons between, as a title may have commas. The blanks in it do not break. */
static void add_name(struct cli_text *words, const struct cli_entry *entry, size_t *listed)
{
    const size_t start = words->size + (*listed > 0 ? 2 : 0);
    brdffit_cli_text_puts(words, (*listed)++ > 0 ? "; " : "");
    brdffit_cli_add_model(words, entry->model);
    for (size_t i = start; i < words->size && !words->failed; i++) {
        words->data[i] = words->data[i] == ' ' ? '\t' : words->data[i];
    }
}

/* Whether E^2 is below what the certificates can see. */
static int exact(const struct cli_entry *entry)
{
    return entry->e2_ranked > entry->e2;
}

static void best(struct cli_text *text, struct cli_style style, const struct cli_comparison *c)
{
    const struct cli_entry *const first = c->order[0];
    struct cli_text words = {0};
    brdffit_cli_add_model(&words, first->model);
    brdffit_cli_text_printf(&words, " has the least %s", brdffit_cli_criterion_title(c->criterion));
    if (exact(first)) {
        brdffit_cli_text_puts(&words, ", and is exact as far as a certificate can tell");
    }
    if (c->tied == 0 && c->ranked > 1) {
        brdffit_cli_text_printf(&words, ", %.*f less than the next: ", c->order[1]->delta < 1000, c->order[1]->delta);
        brdffit_cli_add_model(&words, c->order[1]->model);
    }
    brdffit_cli_text_puts(&words, ".");
    paragraph(text, style, CLI_GREEN, "Best:", &words);
}

static void tied(struct cli_text *text, struct cli_style style, const struct cli_comparison *c)
{
    const struct cli_entry *const simplest = brdffit_cli_simplest(c);
    struct cli_text words = {0};
    size_t listed = 0;
    if (c->tied == 0) {
        return;
    }
    brdffit_cli_text_puts(&words, "the data cannot tell it from ");
    for (size_t i = 0; i < c->ranked; i++) {
        if (c->order[i]->rank == CLI_RANK_TIED) {
            add_name(&words, c->order[i], &listed);
            brdffit_cli_text_printf(&words, " (%.1f\tbehind)", c->order[i]->delta);
        }
    }
    brdffit_cli_text_puts(&words, ". More directions or less noise may.");
    if (simplest->parameters < c->order[0]->parameters) {
        brdffit_cli_text_puts(&words, " With the fewest parameters: ");
        brdffit_cli_add_model(&words, simplest->model);
        brdffit_cli_text_puts(&words, ".");
    }
    paragraph(text, style, CLI_YELLOW, "Undecided:", &words);
}

/* 1 when no fit of that form can be as good as the best one is, whatever its parameters; of both E^2. */
static int cannot_reach(const struct cli_entry *entry, const struct cli_entry *first)
{
    return entry->bound_ranked > first->e2_ranked + first->e2_error;
}

static void proven(struct cli_text *text, struct cli_style style, const struct cli_comparison *c)
{
    const struct cli_entry *const first = c->order[0];
    struct cli_text words = {0};
    size_t listed = 0;
    for (size_t i = 1; i < c->ranked; i++) {
        const struct cli_entry *const entry = c->order[i];
        if (!cannot_reach(entry, first)) {
            continue;
        }
        if (listed == 0) {
            brdffit_cli_text_printf(&words, "no fit of these forms, whatever its parameters, reaches the %s of this ",
                                    brdffit_cli_objective(style, BRDFFIT_NORM_L2));
            brdffit_cli_add_model(&words, first->model);
            brdffit_cli_text_puts(&words, "; they leave at least so many times as much: ");
        }
        add_name(&words, entry, &listed);
        brdffit_cli_text_puts(&words, "\t");
        brdffit_cli_directed(&words, entry->bound_ranked / (first->e2_ranked + first->e2_error) * (1 - 1e-15), 4, 0);
    }
    brdffit_cli_text_puts(&words, listed > 0 ? "." : "");
    paragraph(text, style, CLI_GREEN, "Proven:", &words);
}

/* " (4 more; proven: at most 2.1 % smaller)" */
static void add_gain(struct cli_text *words, const struct cli_entry *entry, const struct cli_entry *first)
{
    const double most = 100 * (1 - entry->bound_ranked / (first->e2_ranked + first->e2_error));
    brdffit_cli_text_printf(words, " (%zu\tmore; ", entry->parameters - first->parameters);
    if (exact(first)) {
        brdffit_cli_text_puts(words, "as exact)");
        return;
    }
    brdffit_cli_text_puts(words, "proven: at most ");
    brdffit_cli_directed(words, most, 2, 1);
    brdffit_cli_text_puts(words, "\t%\tsmaller)");
}

/* Forms that may be as good or better, and are proven behind for their number of parameters. */
static void more(struct cli_text *text, struct cli_style style, const struct cli_comparison *c)
{
    const struct cli_entry *const first = c->order[0];
    struct cli_text words = {0};
    size_t listed = 0;
    for (size_t i = 1; i < c->ranked; i++) {
        const struct cli_entry *const entry = c->order[i];
        if (entry->rank != CLI_RANK_PROVEN || cannot_reach(entry, first) || entry->parameters <= first->parameters) {
            continue;
        }
        if (listed == 0) {
            brdffit_cli_text_printf(&words, "the %s of others is too little smaller for their number: ",
                                    brdffit_cli_objective(style, BRDFFIT_NORM_L2));
        }
        add_name(&words, entry, &listed);
        add_gain(&words, entry, first);
    }
    brdffit_cli_text_puts(&words, listed > 0 ? "." : "");
    paragraph(text, style, CLI_BOLD, "More parameters:", &words);
}

static void open_ones(struct cli_text *text, struct cli_style style, const struct cli_comparison *c)
{
    struct cli_text words = {0};
    size_t listed = 0;
    for (size_t i = 1; i < c->ranked; i++) {
        if (c->order[i]->rank == CLI_RANK_BEHIND) {
            brdffit_cli_text_puts(&words, listed == 0 ? "a better fit than was found is not ruled out of " : "");
            add_name(&words, c->order[i], &listed);
        }
    }
    brdffit_cli_text_puts(&words, listed > 0 ? ". A smaller --gap or a larger --box-budget tells." : "");
    paragraph(text, style, CLI_YELLOW, "NOT proven:", &words);
}

/* What is suspicious about the best one. */
static void warnings(struct cli_text *text, struct cli_style style, const struct cli_comparison *c)
{
    const struct cli_entry *const first = c->order[0];
    struct cli_text words = {0};
    unsigned all = 0;
    for (int p = 0; p < first->model->lobes; p++) {
        all |= first->warnings[p];
    }
    if (all & BRDFFIT_WARN_AT_LIMIT) {
        brdffit_cli_text_puts(&words,
                              "a lobe of the best sits on an end of the range searched: perhaps no form of this "
                              "list is that of the material. ");
    }
    if (all & BRDFFIT_WARN_UNRESOLVED) {
        brdffit_cli_text_puts(&words, "a lobe of the best rests on fewer than 3 effective samples: it may be a fit to "
                                      "single samples. ");
    }
    paragraph(text, style, CLI_YELLOW, "Warning:", &words);
}

static void nothing(struct cli_text *text, struct cli_style style, const struct cli_comparison *c)
{
    struct cli_text words = {0};
    brdffit_cli_text_puts(&words, c->samples_used == 0 ? "no model was fitted."
                                  : c->observations == 0
                                      ? "the data are all zero, and so is every model."
                                      : "no model has fewer parameters than there are observations.");
    paragraph(text, style, CLI_YELLOW, "No best:", &words);
}

void brdffit_cli_compare_words(struct cli_text *text, struct cli_style style, const struct cli_comparison *c)
{
    if (c->ranked == 0) {
        nothing(text, style, c);
        return;
    }
    best(text, style, c);
    tied(text, style, c);
    proven(text, style, c);
    more(text, style, c);
    open_ones(text, style, c);
    warnings(text, style, c);
}
