/* misfit.c: whether a fit's model describes its data. SPDX-License-Identifier: MIT */
#include "misfit.h"

#include <stdio.h>

#include "tell.h"
#include "terms.h"

/* Of x + sum of 4 y, beyond which a model reflects more than it receives; a little more, as fits of exact data round. */
#define ALL_LIGHT 1.001

const char *brdffit_cli_misfit_name(unsigned bit)
{
    switch (bit) {
    case BRDFFIT_MISFIT_POOR: return "poor";
    case BRDFFIT_MISFIT_PATTERNED: return "patterned";
    default: return "unknown";
    }
}

/* Each fills in `words` and returns 1, or returns 0: there is nothing to say. */
static int misfit(struct cli_text *words, struct cli_style style, const struct cli_job *job)
{
    if (job->r2 == NULL || job->misfit == 0) {
        return 0;
    }
    brdffit_cli_text_printf(words,
                            "misfit: this model does not describe these data. R%s is %.3g\tin all, residuals are "
                            "%.2g\t%% of the data",
                            brdffit_cli_glyph(style, CLI_SQUARED), job->quality[0], 100 * job->quality[1]);
    if (job->misfit & BRDFFIT_MISFIT_PATTERNED) {
        brdffit_cli_text_printf(
            words, ", and those of neighbouring samples foretell %.2g\t%% of their squares, which are no noise",
            100 * job->quality[2]);
    }
    brdffit_cli_text_puts(words,
                          ". Are directions and values what they are read as ('brdffit info')? Or is this another "
                          "kind of material ('brdffit compare')?");
    return 1;
}

/* Coefficients of all channels, and a roughness a lobe. */
static size_t count_parameters(const brdffit_model *model)
{
    const size_t lobes = (size_t)model->lobes, diffuse = 1 + brdffit_cli_more_columns(model->diffuse);
    const size_t each = diffuse + lobes * (model->fresnel == BRDFFIT_FRESNEL_NONE ? 1 : 2);
    return model->channels * each + lobes;
}

static int few_samples(struct cli_text *words, const struct cli_job *job)
{
    const size_t values = job->result->samples_used * job->result->model->channels;
    const size_t parameters = count_parameters(job->result->model);
    if (values > parameters) {
        return 0;
    }
    brdffit_cli_text_printf(words,
                            "%zu value%s for %zu parameters: such a fit is close whatever the material, and proves "
                            "nothing about it.",
                            values, values == 1 ? "" : "s", parameters);
    return 1;
}

/* x, and with the lobes x + sum of 4 y. */
static double reflected(const brdffit_model *model, size_t k)
{
    const size_t lobes = (size_t)model->lobes;
    double all = model->x[k];
    for (size_t p = 0; p < lobes; p++) {
        all += 4 * model->y[k * lobes + p];
    }
    return all;
}

/* Of values that are absolute: the first channel that reflects more than it receives. */
static int more_than_all(struct cli_text *words, struct cli_style style, const struct cli_job *job)
{
    const brdffit_model *const model = job->result->model;
    size_t k = 0;
    while (k < model->channels && !(reflected(model, k) > ALL_LIGHT)) {
        k++;
    }
    if (k == model->channels || job->table->samples->quantity != BRDFFIT_QUANTITY_BRDF) {
        return 0;
    }
    const int diffuse = model->x[k] > ALL_LIGHT;
    brdffit_cli_text_puts(words, "channel ");
    brdffit_cli_name(words, style, job->table->channel_names[k]);
    brdffit_cli_text_printf(words,
                            ": %s is %.3g, above 1: more light than came, if the values are absolute f_r in 1/sr "
                            "(--physical keeps to 1).",
                            diffuse ? "the albedo x" : "x and 4 y together",
                            diffuse ? model->x[k] : reflected(model, k));
    return 1;
}

static void paragraph(struct cli_text *text, struct cli_style style, struct cli_text *words)
{
    brdffit_cli_paragraph(text, style, CLI_YELLOW, "Warning,", brdffit_cli_text_string(words));
    text->failed |= words->failed;
    brdffit_cli_text_clear(words);
}

void brdffit_cli_misfit_warnings(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                                 const brdffit_options *options)
{
    struct cli_text words = {0};
    if (misfit(&words, style, job)) {
        paragraph(text, style, &words);
    }
    if (few_samples(&words, job)) {
        paragraph(text, style, &words);
    }
    if (!options->physical && more_than_all(&words, style, job)) {
        paragraph(text, style, &words);
    }
    brdffit_cli_text_free(&words);
}

static void say(const struct cli_job *job, struct cli_style style, struct cli_text *words)
{
    struct cli_text line = {0};
    brdffit_cli_name(&line, style, job->path);
    for (char *tab = words->data; tab != NULL && *tab != '\0'; tab++) {
        *tab = *tab == '\t' ? ' ' : *tab;
    }
    brdffit_cli_tell("brdffit: %s: warning: %s\n", brdffit_cli_text_string(&line), brdffit_cli_text_string(words));
    brdffit_cli_text_free(&line);
    brdffit_cli_text_clear(words);
}

void brdffit_cli_say_misfit(const struct cli_job *job)
{
    const struct cli_style style = brdffit_cli_style(stderr);
    struct cli_text words = {0};
    if (misfit(&words, style, job)) {
        say(job, style, &words);
    }
    if (few_samples(&words, job)) {
        say(job, style, &words);
    }
    brdffit_cli_text_free(&words);
}
