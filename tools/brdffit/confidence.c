/* confidence.c: see confidence.h. SPDX-License-Identifier: MIT */
#include "confidence.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "lobes.h"
#include "report.h"
#include "words.h"

#define NAME_WIDTH 18
#define END_WIDTH 14
#define DIGITS 5

void brdffit_cli_confidence_run(struct cli_job *job, struct cli_fitter *fitter)
{
    const brdffit_samples *const samples = job->table->samples;
    const size_t size = brdffit_intervals_workspace_size(samples->count, samples->channels, &fitter->options);
    brdffit_interval_options asked;
    brdffit_interval_options_init(&asked);
    asked.level = fitter->settings->confidence / 100;
    if (fitter->interval_capacity < size) {
        free(fitter->interval_workspace);
        fitter->interval_workspace = malloc(size);
        fitter->interval_capacity = fitter->interval_workspace != NULL ? size : 0;
    }
    if (size == 0 || fitter->interval_workspace == NULL) {
        job->status = job->error.status = BRDFFIT_ERR_MEMORY;
        job->error.message = brdffit_status_string(BRDFFIT_ERR_MEMORY);
        return;
    }
    const double start = brdffit_cli_clock();
    job->status = brdffit_intervals(samples, &fitter->options, job->result->model, job->result->e2, &asked,
                                    fitter->interval_workspace, fitter->interval_capacity, &job->intervals,
                                    &job->error);
    job->interval_seconds = brdffit_cli_clock() - start;
}

/* ---- the table ---- */

static void end_cell(struct cli_text *text, struct cli_style style, double value, int up)
{
    struct cli_text number = {0};
    if (isfinite(value)) {
        brdffit_cli_directed(&number, value, DIGITS, up);
    } else {
        brdffit_cli_text_puts(&number, "no limit");
    }
    brdffit_cli_cell(text, style, brdffit_cli_text_string(&number), END_WIDTH);
    text->failed |= number.failed;
    brdffit_cli_text_free(&number);
}

static void row(struct cli_text *text, struct cli_style style, const char *name, const brdffit_range *range)
{
    const size_t both = BRDFFIT_INTERVAL_LOW_END | BRDFFIT_INTERVAL_HIGH_END;
    brdffit_cli_text_puts(text, "  ");
    brdffit_cli_cell(text, style, name, -NAME_WIDTH);
    end_cell(text, style, range->low, 0);
    end_cell(text, style, range->high, 1);
    if ((range->flags & both) == both && range->low < range->high) {
        brdffit_cli_text_puts(text, "   the data cannot tell");
    } else if (range->flags & BRDFFIT_INTERVAL_OPEN) {
        brdffit_cli_text_puts(text, "   or less");
    }
    brdffit_cli_text_puts(text, "\n");
}

static void roughness_rows(struct cli_text *text, struct cli_style style, const struct cli_job *job, int width)
{
    const brdffit_interval_result *const r = job->intervals;
    for (int p = 0; p < r->lobes; p++) {
        const brdffit_distribution distribution = job->result->model->distributions[p];
        const int exponent = brdffit_cli_by_exponent(distribution);
        struct cli_text name = {0};
        brdffit_cli_text_printf(&name, "lobe %d %s", p + 1, brdffit_cli_parameter(style, distribution));
        brdffit_cli_text_puts(text, "  ");
        brdffit_cli_cell(text, style, "", -width);
        row(text, style, brdffit_cli_text_string(&name), exponent ? &r->exponent[p] : &r->sigma[p]);
        text->failed |= name.failed;
        brdffit_cli_text_free(&name);
    }
}

static void channel_rows(struct cli_text *text, struct cli_style style, const struct cli_job *job, size_t k, int width)
{
    const brdffit_interval_result *const r = job->intervals;
    const size_t columns = (size_t)r->diffuse_columns, lobes = (size_t)r->lobes;
    char name[32];
    for (size_t f = 0; f < columns + lobes; f++) {
        const size_t p = f - columns;
        (void)snprintf(name, sizeof name,
                       f == 0        ? "diffuse x"
                       : f < columns ? "diffuse x%zu"
                                     : "lobe %zu y",
                       f < columns ? f + 1 : p + 1);
        brdffit_cli_text_puts(text, "  ");
        if (f == 0) {
            brdffit_cli_channel_cell(text, style, job->table, k, width);
        } else {
            brdffit_cli_cell(text, style, "", -width);
        }
        row(text, style, name, f < columns ? &r->x[k * columns + f] : &r->y[k * lobes + p]);
        if (f >= columns && r->f0 != NULL) {
            (void)snprintf(name, sizeof name, "lobe %zu F0", p + 1);
            brdffit_cli_text_puts(text, "  ");
            brdffit_cli_cell(text, style, "", -width);
            row(text, style, name, &r->f0[k * lobes + p]);
        }
    }
}

static void say_what(struct cli_text *text, struct cli_style style, const struct cli_job *job)
{
    const brdffit_interval_result *const r = job->intervals;
    struct cli_text words = {0};
    brdffit_cli_text_printf(&words, "proven: outside of them every fit has E%s above ",
                            brdffit_cli_glyph(style, CLI_SQUARED));
    brdffit_cli_directed(&words, r->threshold, 6, 0);
    brdffit_cli_text_printf(
        &words,
        ", the threshold of %g\t%% for independent Gaussian noise of standard deviation %.3g (from the "
        "residual, of units that were minimised); ",
        100 * r->level, r->noise);
    brdffit_cli_grouped(&words, r->boxes);
    brdffit_cli_text_puts(&words, " boxes, ");
    brdffit_cli_duration(&words, job->interval_seconds);
    brdffit_cli_text_puts(&words, r->stopped    ? "; interrupted."
                                  : r->complete ? "."
                                                : "; where it says \"or less\", the budget ended first.");
    brdffit_cli_paragraph(text, style, CLI_BOLD, "Intervals:", brdffit_cli_text_string(&words));
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

void brdffit_cli_confidence_report(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                                   const struct cli_fitter *fitter)
{
    if (job->intervals == NULL) {
        return;
    }
    const int width = brdffit_cli_channel_width(style, job->table);
    char title[48];
    (void)snprintf(title, sizeof title, "%g %% interval", fitter->settings->confidence);
    brdffit_cli_text_puts(text, "\n  ");
    brdffit_cli_cell(text, style, "channel", -width);
    brdffit_cli_text_puts(text, "  ");
    brdffit_cli_cell(text, style, title, -NAME_WIDTH);
    brdffit_cli_cell(text, style, "from", END_WIDTH);
    brdffit_cli_cell(text, style, "to", END_WIDTH);
    brdffit_cli_text_puts(text, "\n");
    roughness_rows(text, style, job, width);
    for (size_t k = 0; k < job->intervals->channels; k++) {
        channel_rows(text, style, job, k, width);
    }
    brdffit_cli_text_puts(text, "\n");
    say_what(text, style, job);
}

/* ---- JSON ---- */

static void json_range(struct cli_json *json, const brdffit_range *range)
{
    const double ends[2] = {range->low, range->high};
    brdffit_cli_json_numbers(json, NULL, ends, 2);
}

static void json_ranges(struct cli_json *json, const char *key, const brdffit_range *range, size_t rows, size_t columns)
{
    brdffit_cli_json_open(json, key, '[');
    for (size_t k = 0; k < rows; k++) {
        brdffit_cli_json_open(json, NULL, '[');
        for (size_t p = 0; p < columns; p++) {
            json_range(json, &range[k * columns + p]);
        }
        brdffit_cli_json_close(json, ']');
    }
    brdffit_cli_json_close(json, ']');
}

static void json_lobes(struct cli_json *json, const char *key, const struct cli_job *job, int exponent)
{
    const brdffit_interval_result *const r = job->intervals;
    brdffit_cli_json_open(json, key, '[');
    for (int p = 0; p < r->lobes; p++) {
        if (!exponent) {
            json_range(json, &r->sigma[p]);
        } else if (brdffit_cli_by_exponent(job->result->model->distributions[p])) {
            json_range(json, &r->exponent[p]);
        } else {
            brdffit_cli_json_null(json, NULL);
        }
    }
    brdffit_cli_json_close(json, ']');
}

static int any_exponent(const struct cli_job *job)
{
    int found = 0;
    for (int p = 0; p < job->intervals->lobes; p++) {
        found |= brdffit_cli_by_exponent(job->result->model->distributions[p]);
    }
    return found;
}

void brdffit_cli_confidence_json(struct cli_json *json, const struct cli_job *job)
{
    const brdffit_interval_result *const r = job->intervals;
    if (r == NULL) {
        return;
    }
    const size_t lobes = (size_t)r->lobes;
    brdffit_cli_json_open(json, "intervals", '{');
    brdffit_cli_json_number(json, "level", r->level);
    brdffit_cli_json_number(json, "threshold", r->threshold);
    brdffit_cli_json_number(json, "noise", r->noise);
    brdffit_cli_json_number(json, "degrees", r->degrees);
    json_lobes(json, "sigma", job, 0);
    if (any_exponent(job)) {
        json_lobes(json, "exponent", job, 1);
    }
    json_ranges(json, "x", r->x, r->channels, (size_t)r->diffuse_columns);
    json_ranges(json, "y", r->y, r->channels, lobes);
    if (r->f0 != NULL) {
        json_ranges(json, "f0", r->f0, r->channels, lobes);
    }
    brdffit_cli_json_bool(json, "complete", r->complete);
    brdffit_cli_json_count(json, "boxes", r->boxes);
    brdffit_cli_json_number(json, "seconds", job->interval_seconds);
    brdffit_cli_json_close(json, '}');
}
