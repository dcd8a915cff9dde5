/* compare_json.c: lines of a comparison: one of "brdffit.fit/1" a model, as
 * `fit --json` writes it and with a member more; then the verdict.
 * SPDX-License-Identifier: MIT */
#include "compare.h"

#include "failure.h"
#include "json_fit.h"

static void add_criteria(struct cli_json *json, const char *key, const struct cli_criteria *criteria)
{
    brdffit_cli_json_open(json, key, '{');
    brdffit_cli_json_number(json, "bic", criteria->value[CLI_BIC]);
    brdffit_cli_json_number(json, "aic", criteria->value[CLI_AIC]);
    brdffit_cli_json_number(json, "aicc", criteria->value[CLI_AICC]);
    brdffit_cli_json_close(json, '}');
}

static void add_title(struct cli_json *json, const struct cli_model *model)
{
    struct cli_text title = {0};
    brdffit_cli_add_model(&title, model);
    brdffit_cli_json_string(json, "model", model->name);
    brdffit_cli_json_string(json, "title", brdffit_cli_text_string(&title));
    json->text->failed |= title.failed;
    brdffit_cli_text_free(&title);
}

void brdffit_cli_compare_json(struct cli_text *text, const struct cli_entry *entry,
                              const struct cli_comparison *comparison, const struct cli_job *job,
                              const struct cli_fitter *fitter)
{
    struct cli_json json = {text, 0};
    brdffit_cli_json_open(&json, NULL, '{');
    brdffit_cli_json_fit_members(&json, job, fitter);
    brdffit_cli_json_open(&json, "comparison", '{');
    add_title(&json, entry->model);
    if (entry->status == BRDFFIT_OK) {
        brdffit_cli_json_count(&json, "parameters", entry->parameters);
        brdffit_cli_json_count(&json, "observations", comparison->observations);
        brdffit_cli_json_number(&json, "effective_observations", entry->effective);
        brdffit_cli_json_number(&json, "r2", entry->r2);
        brdffit_cli_json_number(&json, "seconds", entry->seconds);
    }
    brdffit_cli_json_close(&json, '}');
    brdffit_cli_json_close(&json, '}');
    brdffit_cli_text_puts(text, "\n");
}

static void add_entry(struct cli_json *json, const struct cli_entry *entry)
{
    static const char *const ranks[] = {"best", "tied", "behind", "proven_behind", "unranked"};
    const int fitted = !entry->not_begun && entry->status == BRDFFIT_OK;
    brdffit_cli_json_open(json, NULL, '{');
    add_title(json, entry->model);
    brdffit_cli_json_string(json, "rank", entry->not_begun ? "interrupted" : fitted ? ranks[entry->rank] : "error");
    if (fitted && entry->rank != CLI_RANK_UNRANKED) {
        brdffit_cli_json_number(json, "delta", entry->delta);
        brdffit_cli_json_number(json, "delta_proven", entry->delta_proven);
    }
    if (fitted) {
        brdffit_cli_json_count(json, "parameters", entry->parameters);
        brdffit_cli_json_number(json, "e2", entry->e2);
        brdffit_cli_json_number(json, "lower_bound", entry->lower_bound);
        add_criteria(json, "criteria", &entry->fit);
        add_criteria(json, "criteria_bound", &entry->bound);
    }
    brdffit_cli_json_close(json, '}');
}

static void add_models(struct cli_json *json, const struct cli_comparison *c)
{
    brdffit_cli_json_open(json, "tied", '[');
    for (size_t i = 0; i < c->count; i++) {
        if (c->order[i]->rank == CLI_RANK_TIED) {
            brdffit_cli_json_string(json, NULL, c->order[i]->model->name);
        }
    }
    brdffit_cli_json_close(json, ']');
    brdffit_cli_json_open(json, "models", '[');
    for (size_t i = 0; i < c->count; i++) {
        add_entry(json, c->order[i]);
    }
    brdffit_cli_json_close(json, ']');
}

void brdffit_cli_verdict_json(struct cli_text *text, const struct cli_comparison *c, const struct cli_job *job)
{
    static const char *const criteria[] = {"bic", "aic", "aicc"};
    struct cli_json json = {text, 0};
    const int compared = job->status == BRDFFIT_OK && !job->not_begun;
    brdffit_cli_json_open(&json, NULL, '{');
    brdffit_cli_json_string(&json, "schema", "brdffit.comparison/1");
    brdffit_cli_json_path(&json, job->path);
    brdffit_cli_json_string(&json, "verdict",
                            !compared        ? "error"
                            : c->ranked == 0 ? "none"
                            : c->tied > 0    ? "cannot_tell"
                                             : "one");
    if (!compared) {
        brdffit_cli_json_error(&json, job);
    } else {
        brdffit_cli_json_string(&json, "criterion", criteria[c->criterion]);
        brdffit_cli_json_number(&json, "threshold", c->threshold);
        brdffit_cli_json_count(&json, "samples_used", c->samples_used);
        brdffit_cli_json_count(&json, "observations", c->observations);
        brdffit_cli_json_number(&json, "effective_observations", c->effective);
        if (c->ranked > 0) {
            brdffit_cli_json_string(&json, "best", c->order[0]->model->name);
            brdffit_cli_json_string(&json, "simplest", brdffit_cli_simplest(c)->model->name);
        } else {
            brdffit_cli_json_null(&json, "best");
            brdffit_cli_json_null(&json, "simplest");
        }
        add_models(&json, c);
    }
    brdffit_cli_json_close(&json, '}');
    brdffit_cli_text_puts(text, "\n");
}
