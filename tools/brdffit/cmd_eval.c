/* cmd_eval.c: brdffit eval. SPDX-License-Identifier: MIT */
#include "commands.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "eval_table.h"
#include "failure.h"
#include "reading.h"
#include "sample.h"
#include "tell.h"
#include "weigh.h"
#include "words.h"

/* A fit of this very file gives its own E^2 again; further off than rounding
 * means that the file or the way it is read has changed. */
#define AGREEMENT 1e-9

/* An E^2 below this share of the data's sum of squares is rounding, and
 * differs from machine to machine: residuals of 1e-12 of the values. */
#define ROUNDING 1e-24

void brdffit_cli_eval_help(void)
{
    struct cli_text text = {0};
    brdffit_cli_text_puts(&text, "Usage: brdffit eval FIT.json FILE [options]\n"
                                 "\n"
                                 "Evaluate a fit at the directions of FILE and write a CSV table: directions,\n"
                                 "then for each channel the fitted value and, where FILE has a channel of that\n"
                                 "name, the measured one and the residual. FIT.json holds lines written by\n"
                                 "'brdffit fit --json'; FILE is read the way the line says. E^2 and RMS over the\n"
                                 "samples that a fit uses end up on standard error.\n"
                                 "\n");
    brdffit_cli_option_help(&text, CLI_EVAL);
    brdffit_cli_text_puts(&text, "\n"
                                 "Exit status: 0 done; 1 a file cannot be read or written, or memory ran\n"
                                 "out; 2 wrong usage; 3 the data or the fit cannot be used.\n");
    brdffit_cli_say(brdffit_cli_text_string(&text));
    brdffit_cli_text_free(&text);
}

/* How the line says that its file was read, under what is asked for now. */
static struct cli_settings as_the_fit(const struct cli_settings *settings, const struct cli_fit *fit)
{
    struct cli_settings read = *settings;
    read.values = settings->values == CLI_UNSET ? fit->quantity : settings->values;
    read.channels = settings->channels == NULL ? fit->channels : settings->channels;
    read.columns = settings->columns == NULL ? fit->columns : settings->columns;
    read.missing = settings->missing == NULL ? fit->missing : settings->missing;
    read.directions = settings->directions == NULL ? fit->directions : settings->directions;
    read.saturated = settings->saturated > 0 ? settings->saturated : fit->saturated;
    return read;
}

static int read_table(const struct cli_settings *settings, const struct cli_fit *fit, const char *path,
                      brdffit_table **table)
{
    brdffit_io_options options;
    brdffit_error error = {0};
    const struct cli_settings read = as_the_fit(settings, fit);
    brdffit_cli_io_options(&read, &options);
    options.merl_bins = (brdffit_io_merl_bins)fit->merl_bins;
    options.merl_sampling = (brdffit_io_merl_sampling)fit->merl_sampling;
    options.directions_only = 1;
    if (fit->merl_sampling == BRDFFIT_IO_MERL_DIRECTIONS) {
        options.directions = &fit->merl_directions;
    }
    errno = 0;
    const brdffit_status status = brdffit_io_read(path, &options, table, &error);
    if (status == BRDFFIT_OK) {
        if (!settings->quiet) {
            brdffit_cli_say_notes(path, *table, 1);
        }
        return 0;
    }
    brdffit_cli_report_error(path, &error, NULL, errno);
    return brdffit_cli_status_exit(status);
}

/* As the fit did; places without values have no weights, and need none. */
static int weigh(brdffit_table *table, const struct cli_fit *fit, const char *path, double **weights)
{
    brdffit_error error = {0};
    if (table->samples->channels == 0 ||
        (fit->weighting == BRDFFIT_WEIGHTING_COLUMN && table->samples->weights == NULL)) {
        return 0;
    }
    const brdffit_status status = brdffit_cli_weigh(table, fit->weighting, weights, &error);
    if (status != BRDFFIT_OK) {
        brdffit_cli_report_error(path, &error, table, 0);
        return brdffit_cli_status_exit(status);
    }
    return 0;
}

static void print_figures(const struct cli_comparison *c, const struct cli_figures *figures)
{
    const struct cli_style style = brdffit_cli_style(stderr);
    const struct cli_fit *const fit = c->fit;
    const char *objective = brdffit_cli_objective(style, fit->norm);
    const double rounding = fit->norm == BRDFFIT_NORM_L2 ? ROUNDING : sqrt(ROUNDING);
    struct cli_text text = {0};
    brdffit_cli_text_printf(&text, "%zu of %zu samples: %s %.15g here, %.15g in fit %zu; RMS", figures->used,
                            c->table->samples->count, objective, figures->e2, fit->e2, fit->line);
    for (size_t k = 0; k < fit->model.channels; k++) {
        brdffit_cli_text_puts(&text, k == 0 ? " " : ", ");
        brdffit_cli_name(&text, style, c->table->channel_names[c->measured[k]]);
        brdffit_cli_text_printf(&text, " %.15g", figures->rms[k]);
    }
    brdffit_cli_tell("brdffit: %s\n", brdffit_cli_text_string(&text));
    if (!(fabs(figures->e2 - fit->e2) <= AGREEMENT * fit->e2 + rounding * figures->data)) {
        brdffit_cli_tell("brdffit: this is not the %s of the fit: other data, or read another way\n", objective);
    }
    brdffit_cli_text_free(&text);
}

/* Places that are lit from further off than any sample of the fit, which knows nothing of Fresnel there. */
static void say_extrapolated(const struct cli_comparison *c)
{
    const struct cli_fit *const fit = c->fit;
    const brdffit_samples *const samples = c->table->samples;
    size_t beyond = 0;
    if (!(fit->max_incidence < 90) || fit->model.fresnel != BRDFFIT_FRESNEL_NONE) {
        return;
    }
    const double least = cos((fit->max_incidence + 1e-6) * (3.14159265358979323846 / 180));
    for (size_t i = 0; i < samples->count; i++) {
        struct cli_angles angles;
        brdffit_cli_angles(samples, i, &angles);
        beyond += angles.cos_light > 0 && angles.cos_light < least;
    }
    if (beyond > 0) {
        brdffit_cli_tell(
            "brdffit: %zu of %zu places are lit from beyond %.6g degrees, further than the samples of the fit: "
            "extrapolated, without Fresnel\n",
            beyond, samples->count, fit->max_incidence);
    }
}

/* The table is there: evaluate, write, compare. */
static int evaluate(const struct cli_settings *settings, struct cli_comparison *c, double *fitted, double *rms)
{
    brdffit_error error = {0};
    const brdffit_status status = brdffit_eval(&c->fit->model, c->table->samples, fitted, &error);
    if (status != BRDFFIT_OK) {
        brdffit_cli_report_error(settings->files[1], &error, c->table, 0);
        return brdffit_cli_status_exit(status);
    }
    struct cli_output output;
    brdffit_cli_match_channels(c);
    if (brdffit_cli_output_open(&output, settings->output) != 0) {
        return CLI_EXIT_FAILURE;
    }
    if (brdffit_cli_eval_rows(c, &output) != 0) {
        brdffit_cli_output_abandon(&output);
        return CLI_EXIT_FAILURE;
    }
    if (brdffit_cli_output_commit(&output) != 0) {
        return CLI_EXIT_FAILURE;
    }
    if (settings->quiet) {
        return 0;
    }
    say_extrapolated(c);
    if (!c->complete) {
        brdffit_cli_tell("brdffit: not every channel of the fit is in the file: no E^2 or RMS\n");
        return 0;
    }
    struct cli_figures figures = {0, 0, 0, rms};
    brdffit_cli_eval_figures(c, &figures);
    print_figures(c, &figures);
    return 0;
}

static int run_eval(const struct cli_settings *settings)
{
    struct cli_fit fit;
    brdffit_table *table = NULL;
    double *weights = NULL;
    const char *const file = settings->files[1];
    int code = brdffit_cli_fit_read(&fit, settings->files[0], file, settings->select);
    if (code == 0) {
        code = read_table(settings, &fit, file, &table);
    }
    if (code == 0) {
        code = weigh(table, &fit, file, &weights);
    }
    if (code == 0) {
        const size_t channels = fit.model.channels, count = table->samples->count;
        struct cli_comparison c = {&fit, table, NULL, calloc(channels, sizeof *c.measured), 0};
        double *const rms = calloc(channels, sizeof *rms);
        double *const fitted = calloc(count > 0 ? count : 1, channels * sizeof *fitted);
        c.fitted = fitted;
        code = c.measured == NULL || rms == NULL || fitted == NULL ? brdffit_cli_no_memory()
                                                                   : evaluate(settings, &c, fitted, rms);
        free(c.measured);
        free(rms);
        free(fitted);
    }
    brdffit_io_free(table);
    free(weights);
    brdffit_cli_fit_free(&fit);
    return code;
}

int brdffit_cli_eval(int argc, char **argv)
{
    struct cli_settings settings;
    const enum cli_parse answer = brdffit_cli_parse(CLI_EVAL, "eval", argc, argv, &settings);
    int code = answer == CLI_PARSE_NO_MEMORY ? CLI_EXIT_FAILURE : CLI_EXIT_USAGE;
    if (answer == CLI_PARSED_HELP) {
        brdffit_cli_eval_help();
        code = 0;
    } else if (answer == CLI_PARSED) {
        code = run_eval(&settings);
    }
    brdffit_cli_settings_free(&settings);
    return code;
}
