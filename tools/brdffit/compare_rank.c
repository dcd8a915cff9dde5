/* compare_rank.c: which forms the criterion keeps. SPDX-License-Identifier: MIT */
#include "compare.h"

#include <math.h>
#include <stdlib.h>

#include "failure.h"

int brdffit_cli_comparison_init(struct cli_comparison *comparison, const struct cli_model *models, size_t count,
                                const struct cli_settings *settings)
{
    const struct cli_comparison none = {.count = count,
                                        .criterion = (enum cli_criterion)settings->criterion,
                                        .threshold = settings->threshold,
                                        .count_all = settings->count_all};
    *comparison = none;
    comparison->entries = calloc(count, sizeof *comparison->entries);
    comparison->order = calloc(count, sizeof *comparison->order);
    if (comparison->entries == NULL || comparison->order == NULL) {
        return -1;
    }
    for (size_t i = 0; i < count; i++) {
        comparison->entries[i].model = &models[i];
        comparison->entries[i].not_begun = 1;
        comparison->entries[i].rank = CLI_RANK_UNRANKED;
    }
    return 0;
}

void brdffit_cli_comparison_free(struct cli_comparison *comparison)
{
    free(comparison->entries);
    free((void *)comparison->order);
}

static int is_fitted(const struct cli_entry *entry)
{
    return !entry->not_begun && entry->status == BRDFFIT_OK;
}

static int has_criterion(const struct cli_comparison *c, const struct cli_entry *entry)
{
    return is_fitted(entry) && !isnan(entry->fit.value[c->criterion]);
}

/* By the criterion, and in the order of the list where it is the same: insertion, as lists are short. */
static void sort(struct cli_comparison *c)
{
    const enum cli_criterion by = c->criterion;
    for (size_t i = 0; i < c->count; i++) {
        const struct cli_entry *const entry = &c->entries[i];
        size_t at = c->ranked;
        if (!has_criterion(c, entry)) {
            continue;
        }
        for (; at > 0 && c->order[at - 1]->fit.value[by] > entry->fit.value[by]; at--) {
            c->order[at] = c->order[at - 1];
        }
        c->order[at] = entry;
        c->ranked++;
    }
    for (size_t i = 0, at = c->ranked; i < c->count; i++) {
        if (!has_criterion(c, &c->entries[i])) {
            c->order[at++] = &c->entries[i];
        }
    }
}

static enum cli_rank rank_of(const struct cli_comparison *c, const struct cli_entry *entry)
{
    if (entry == c->order[0]) {
        return CLI_RANK_BEST;
    }
    if (entry->delta < c->threshold) {
        return CLI_RANK_TIED;
    }
    return entry->delta_proven >= c->threshold ? CLI_RANK_PROVEN : CLI_RANK_BEHIND;
}

/* The best fit's own E^2 is known to e2_error: what is said to be proven grants it the worst. */
static double worst_of_best(const struct cli_comparison *c)
{
    const struct cli_entry *const best = c->order[0];
    const double e2 = best->e2_ranked + best->e2_error;
    return brdffit_cli_criteria(e2, c->effective, best->parameters).value[c->criterion];
}

/* By the residuals that are nearest to noise alone: those of the least E^2. */
static void count_observations(struct cli_comparison *c)
{
    double least = INFINITY;
    c->effective = (double)c->observations;
    for (size_t i = 0; i < c->count && !c->count_all; i++) {
        if (is_fitted(&c->entries[i]) && c->entries[i].e2_ranked < least) {
            least = c->entries[i].e2_ranked;
            c->effective = c->entries[i].effective;
        }
    }
}

static void weigh(struct cli_comparison *c)
{
    count_observations(c);
    for (size_t i = 0; i < c->count; i++) {
        struct cli_entry *const entry = &c->entries[i];
        if (is_fitted(entry)) {
            entry->fit = brdffit_cli_criteria(entry->e2_ranked, c->effective, entry->parameters);
            entry->bound = brdffit_cli_criteria(entry->bound_ranked, c->effective, entry->parameters);
        }
    }
}

void brdffit_cli_rank(struct cli_comparison *c)
{
    weigh(c);
    sort(c);
    if (c->ranked == 0) {
        return;
    }
    const double best = c->order[0]->fit.value[c->criterion], worst = worst_of_best(c);
    for (size_t i = 0; i < c->count; i++) {
        struct cli_entry *const entry = &c->entries[i];
        if (has_criterion(c, entry)) {
            entry->delta = entry->fit.value[c->criterion] - best;
            entry->delta_proven = entry->bound.value[c->criterion] - worst;
            entry->rank = rank_of(c, entry);
            c->tied += entry->rank == CLI_RANK_TIED;
        }
    }
}

const struct cli_entry *brdffit_cli_simplest(const struct cli_comparison *c)
{
    const struct cli_entry *simplest = c->order[0];
    for (size_t i = 1; i < c->ranked; i++) {
        if (c->order[i]->rank == CLI_RANK_TIED && c->order[i]->parameters < simplest->parameters) {
            simplest = c->order[i];
        }
    }
    return simplest;
}

static int entry_exit(const struct cli_entry *entry)
{
    if (entry->not_begun) {
        return CLI_EXIT_OPEN;
    }
    if (entry->status != BRDFFIT_OK) {
        return brdffit_cli_status_exit(entry->status);
    }
    if (entry->stop == BRDFFIT_STOP_CONTRADICTION) {
        return CLI_EXIT_FAILURE;
    }
    return entry->certified ? CLI_EXIT_CERTIFIED : CLI_EXIT_OPEN;
}

int brdffit_cli_comparison_exit(const struct cli_comparison *c)
{
    int code = CLI_EXIT_CERTIFIED;
    for (size_t i = 0; i < c->count; i++) {
        code = brdffit_cli_worse_exit(code, entry_exit(&c->entries[i]));
    }
    return code;
}
