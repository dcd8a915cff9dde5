/* weigh.c: what samples count for, as --weight says.
 * SPDX-License-Identifier: MIT */
#include "weigh.h"

#include <stdlib.h>

#include "words.h"

const struct cli_choice brdffit_cli_weight_choices[] = {
    {"none", BRDFFIT_WEIGHTING_NONE, 0},         {"column", BRDFFIT_WEIGHTING_COLUMN, 0},
    {"cosine", BRDFFIT_WEIGHTING_COSINE, 0},     {"solid-angle", BRDFFIT_WEIGHTING_SOLID_ANGLE, 0},
    {"relative", BRDFFIT_WEIGHTING_RELATIVE, 0}, {NULL, 0, 0}};

/* Of fewer samples it is chance how they lie. */
#define FEW_SAMPLES 16

static brdffit_status fail(brdffit_error *error, brdffit_status status, const char *message)
{
    const brdffit_error made = {status, message, BRDFFIT_NONE, BRDFFIT_NONE, BRDFFIT_NONE, BRDFFIT_NONE, 0};
    *error = made;
    return status;
}

brdffit_weighting brdffit_cli_weighting(const brdffit_table *table, int asked)
{
    if (asked != CLI_UNSET) {
        return (brdffit_weighting)asked;
    }
    return table->samples->weights != NULL ? BRDFFIT_WEIGHTING_COLUMN : BRDFFIT_WEIGHTING_NONE;
}

/* *weights is NULL on failure. */
static brdffit_status make(const brdffit_samples *samples, brdffit_weighting weighting, double **weights,
                           brdffit_error *error)
{
    const size_t size = brdffit_weights_size(samples->count, samples->channels, weighting);
    void *const workspace = malloc(size > 0 ? size : 1);
    brdffit_status status = BRDFFIT_ERR_MEMORY;
    *weights = malloc(samples->count * sizeof **weights + 1);
    if (workspace != NULL && *weights != NULL) {
        status = brdffit_weights(samples, weighting, BRDFFIT_WEIGHT_FLOOR, workspace, size, *weights, error);
    } else {
        (void)fail(error, status, "no memory for weights");
    }
    free(workspace);
    if (status != BRDFFIT_OK) {
        free(*weights);
        *weights = NULL;
    }
    return status;
}

brdffit_status brdffit_cli_weigh(brdffit_table *table, int asked, double **owned, brdffit_error *error)
{
    const brdffit_weighting weighting = brdffit_cli_weighting(table, asked);
    brdffit_samples *const samples = table->samples;
    *owned = NULL;
    if (weighting == BRDFFIT_WEIGHTING_COLUMN && samples->weights == NULL) {
        return fail(error, BRDFFIT_ERR_FORMAT, "--weight column, but there is no column weight or uncertainty");
    }
    if (weighting == BRDFFIT_WEIGHTING_COLUMN || (weighting == BRDFFIT_WEIGHTING_NONE && samples->weights == NULL)) {
        return BRDFFIT_OK;
    }
    const brdffit_status status = make(samples, weighting, owned, error);
    if (status == BRDFFIT_OK) {
        samples->weights = *owned;
    }
    return status;
}

int brdffit_cli_crowded(const brdffit_table *table, double *share)
{
    const brdffit_samples *const samples = table->samples;
    double *weights;
    brdffit_error error;
    if (table->sums != NULL || samples->form != BRDFFIT_FORM_DIRECTIONS || samples->count < FEW_SAMPLES ||
        make(samples, BRDFFIT_WEIGHTING_SOLID_ANGLE, &weights, &error) != BRDFFIT_OK) {
        return 0;
    }
    const size_t size = brdffit_weights_size(samples->count, samples->channels, BRDFFIT_WEIGHTING_RELATIVE);
    void *const workspace = malloc(size);
    const int crowded = brdffit_weights_crowded(samples, weights, workspace, size);
    *share = brdffit_weights_effective(weights, samples->count);
    free(workspace);
    free(weights);
    return crowded;
}

void brdffit_cli_report_weights(struct cli_text *text, struct cli_style style, const brdffit_table *table,
                                brdffit_weighting weighting)
{
    static const char *const of[BRDFFIT_WEIGHTING_COUNT] = {
        "", "the file's own", "the cosine of the light", "the solid angle that each sample stands for",
        "one over the square of the value, but no less than 1 % of the largest"};
    const brdffit_samples *const samples = table->samples;
    struct cli_text words = {0};
    double share;
    if (weighting != BRDFFIT_WEIGHTING_NONE) {
        brdffit_cli_text_printf(&words, "%s; they count as ", of[weighting]);
        brdffit_cli_grouped(
            &words,
            (size_t)(brdffit_weights_effective(samples->weights, samples->count) * (double)samples->count + 0.5));
        brdffit_cli_text_puts(&words, "\tsamples of equal weight.");
        brdffit_cli_paragraph(text, style, CLI_BOLD, "Weights:", brdffit_cli_text_string(&words));
    } else if (brdffit_cli_crowded(table, &share)) {
        brdffit_cli_text_printf(
            &words,
            "most samples crowd where the material is bright (by solid angle they count as "
            "%.2g\t%% of their number), and the fit is to that part. --weight solid-angle fits all.",
            100 * share);
        brdffit_cli_paragraph(text, style, CLI_YELLOW, "Warning,", brdffit_cli_text_string(&words));
    }
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}
