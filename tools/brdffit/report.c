/* report.c: a fit as a table that a person can read. Channels are rows, so
 * that any number of them fits on 80 columns.
 * SPDX-License-Identifier: MIT */
#include "report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "confidence.h"
#include "lobes.h"
#include "misfit.h"
#include "reading.h"
#include "sample.h"
#include "tell.h"
#include "terms.h"
#include "weigh.h"
#include "words.h"

#define NUMBER_WIDTH 11
#define PARAMETER_WIDTH 15
#define LONGEST_CHANNEL 16
/* With three lobes, so that the table still fits. */
#define NUMBER_NARROW 10
/* Names in the table of channels, which has a column for each lobe. */
#define CHANNEL_TWO 14
#define CHANNEL_SHORT 9
#define R2_WIDTH 8

void brdffit_cli_cell(struct cli_text *text, struct cli_style style, const char *string, int width)
{
    const size_t wanted = (size_t)(width < 0 ? -width : width);
    const size_t taken = brdffit_cli_width(style, string);
    const size_t pad = taken < wanted ? wanted - taken : 0;
    if (width > 0) {
        brdffit_cli_text_pad(text, pad);
    }
    brdffit_cli_text_puts(text, string);
    if (width < 0) {
        brdffit_cli_text_pad(text, pad);
    }
}

void brdffit_cli_number_cell(struct cli_text *text, double value, int digits, int width)
{
    brdffit_cli_text_printf(text, " %*.*g", width - 1, digits, value); /* a blank even before 1.2345e-100 */
}

int brdffit_cli_channel_width(struct cli_style style, const brdffit_table *table)
{
    size_t width = strlen("channel");
    for (size_t k = 0; k < table->samples->channels; k++) {
        const size_t taken = brdffit_cli_width(style, table->channel_names[k]);
        width = taken > width ? taken : width;
    }
    return (int)(width > LONGEST_CHANNEL ? LONGEST_CHANNEL : width);
}

void brdffit_cli_channel_cell(struct cli_text *text, struct cli_style style, const brdffit_table *table, size_t channel,
                              int width)
{
    struct cli_text name = {0};
    brdffit_cli_name(&name, style, table->channel_names[channel]);
    size_t keep = 0, columns = 0;
    const char *string = brdffit_cli_text_string(&name);
    while (string[keep] && columns < (size_t)width) {
        const size_t length = brdffit_cli_utf8_length(string + keep);
        keep += length == 0 ? 1 : length;
        columns++;
    }
    brdffit_cli_text_add(text, string, keep);
    brdffit_cli_text_pad(text, (size_t)width - columns);
    text->failed |= name.failed;
    brdffit_cli_text_free(&name);
}

void brdffit_cli_report_title(struct cli_text *text, struct cli_style style, const struct cli_job *job, size_t used,
                              const size_t *skipped, double max_incidence, const char *verb)
{
    struct cli_text title = {0}, reasons = {0};
    brdffit_cli_name(&title, style, strcmp(job->path, "-") == 0 ? "standard input" : job->path);
    brdffit_cli_ink(text, style, CLI_BOLD, brdffit_cli_text_string(&title));
    brdffit_cli_text_puts(text, ": ");
    brdffit_cli_grouped(text, used);
    brdffit_cli_text_puts(text, " of ");
    brdffit_cli_grouped(text, brdffit_cli_entries(job->table));
    brdffit_cli_text_printf(text, " samples %s\n", verb);
    if (brdffit_cli_skipped(&reasons, style, skipped, job->table, max_incidence) > 0) {
        brdffit_cli_paragraph(text, style, CLI_BOLD, "Skipped:", brdffit_cli_text_string(&reasons));
    }
    text->failed |= title.failed | reasons.failed;
    brdffit_cli_text_free(&title);
    brdffit_cli_text_free(&reasons);
}

void brdffit_cli_say_skipped(const struct cli_job *job, const struct cli_fitter *fitter)
{
    const struct cli_style style = brdffit_cli_style(stderr);
    size_t used, skipped[BRDFFIT_SKIP_COUNT] = {0};
    struct cli_text reasons = {0};
    if (job->table == NULL || job->status != BRDFFIT_ERR_NO_SAMPLES || job->table->sums != NULL) {
        return;
    }
    (void)brdffit_inspect(job->table->samples, &fitter->options, &used, skipped, BRDFFIT_SKIP_COUNT, NULL);
    if (brdffit_cli_skipped(&reasons, style, skipped, job->table, fitter->options.max_incidence) > 0) {
        brdffit_cli_tell("brdffit: skipped: %s\n", brdffit_cli_text_string(&reasons));
    }
    brdffit_cli_text_free(&reasons);
}

/* The distribution has a column when lobes have several; so has the parameter's name when both kinds are there. */
static void lobe_table(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                       const brdffit_options *options)
{
    const int differ = brdffit_cli_lobes_differ(options);
    const int exponents = brdffit_cli_any_lobe_by(options, 1), both = exponents && brdffit_cli_any_lobe_by(options, 0);
    brdffit_cli_text_puts(text, differ ? "\n  lobe  distribution     " : "\n  lobe");
    brdffit_cli_cell(text, style,
                     both        ? "parameter"
                     : exponents ? "exponent n"
                                 : brdffit_cli_glyph(style, CLI_SIGMA),
                     PARAMETER_WIDTH + (both ? 4 : 0));
    brdffit_cli_text_puts(text, "   share w   effective samples\n");
    for (int p = 0; p < result->model->lobes; p++) {
        const brdffit_lobe *const lobe = result->lobe[p];
        const brdffit_distribution distribution = result->model->distributions[p];
        struct cli_text value = {0};
        brdffit_cli_text_printf(text, "  %-4d", p + 1);
        if (differ) {
            brdffit_cli_text_printf(text, "  %-17s", brdffit_distribution_title(distribution));
        }
        brdffit_cli_text_printf(&value, "%s%s%.8g", both ? brdffit_cli_parameter(style, distribution) : "",
                                both ? " = " : "",
                                brdffit_cli_by_exponent(distribution) ? lobe->exponent : lobe->sigma);
        brdffit_cli_cell(text, style, brdffit_cli_text_string(&value), PARAMETER_WIDTH + (both ? 4 : 0));
        brdffit_cli_text_printf(text, "%8.1f %%%20.4g\n", 100 * lobe->weight, lobe->effective_samples);
        text->failed |= value.failed;
        brdffit_cli_text_free(&value);
    }
}

/* Largest used radiance of a channel: the scale of --normalise max. */
static double channel_maximum(const struct cli_job *job, const brdffit_options *options, size_t channel)
{
    const brdffit_samples *const samples = job->table->samples;
    if (options->normalise == BRDFFIT_NORMALISE_MAX) {
        return job->result->channel_scale[channel];
    }
    if (job->table->sums != NULL) {
        return brdffit_sums_largest(job->table->sums, channel);
    }
    double maximum = 0;
    for (size_t i = 0; i < samples->count; i++) {
        const double value = samples->values[i * samples->channels + channel];
        if (!brdffit_cli_is_used(samples, options, i)) {
            continue;
        }
        const double radiance = value * brdffit_cli_to_radiance(samples, i);
        maximum = radiance > maximum ? radiance : maximum;
    }
    return maximum;
}

static void channel_table(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                          const brdffit_options *options)
{
    const brdffit_result *const result = job->result;
    const int lobes = result->model->lobes;
    const int digits = lobes > 2 ? 4 : 5, number = lobes > 2 ? NUMBER_NARROW : NUMBER_WIDTH,
              widest = lobes > 2   ? CHANNEL_SHORT
                       : lobes > 1 ? CHANNEL_TWO
                                   : LONGEST_CHANNEL;
    const int wanted = brdffit_cli_channel_width(style, job->table), width = wanted > widest ? widest : wanted;
    brdffit_cli_text_puts(text, "\n  ");
    brdffit_cli_cell(text, style, "channel", -width);
    brdffit_cli_cell(text, style, "diffuse x", number);
    for (int p = 0; p < lobes; p++) {
        char title[24];
        (void)snprintf(title, sizeof title, "lobe %d y", p + 1);
        brdffit_cli_cell(text, style, title, number);
    }
    brdffit_cli_cell(text, style, "RMS", number);
    brdffit_cli_cell(text, style, "of max", number);
    brdffit_cli_cell(text, style, style.utf8 ? "R²" : "R^2", R2_WIDTH);
    brdffit_cli_text_puts(text, "\n");
    for (size_t k = 0; k < result->model->channels; k++) {
        brdffit_cli_text_puts(text, "  ");
        brdffit_cli_channel_cell(text, style, job->table, k, width);
        brdffit_cli_number_cell(text, result->model->x[k], digits, number);
        for (int p = 0; p < lobes; p++) {
            brdffit_cli_number_cell(text, result->model->y[k * (size_t)lobes + (size_t)p], digits, number);
        }
        brdffit_cli_number_cell(text, result->rms[k], 3, number);
        const double maximum = channel_maximum(job, options, k);
        if (maximum > 0 && result->rms[k] >= 0) {
            brdffit_cli_number_cell(text, 100 * result->rms[k] / maximum, 3, number - 2);
            brdffit_cli_text_puts(text, " %");
        } else {
            brdffit_cli_cell(text, style, brdffit_cli_glyph(style, CLI_DASH), number);
        }
        if (job->r2 != NULL && isfinite(job->r2[k])) {
            brdffit_cli_number_cell(text, job->r2[k], 4, R2_WIDTH);
        } else {
            brdffit_cli_cell(text, style, brdffit_cli_glyph(style, CLI_DASH), R2_WIDTH);
        }
        brdffit_cli_text_puts(text, "\n");
    }
}

static void add_stop(struct cli_text *text, brdffit_stop stop, const brdffit_options *options)
{
    if (stop == BRDFFIT_STOP_RELATIVE_GAP) {
        brdffit_cli_text_printf(text, "at relative gap\t%g", options->relative_gap);
    } else if (stop == BRDFFIT_STOP_ABSOLUTE_GAP) {
        brdffit_cli_text_printf(text, "at absolute gap\t%g", options->absolute_gap);
    } else {
        brdffit_cli_text_printf(text, "by %s", brdffit_stop_string(stop));
    }
}

/* "32 nodes", or what ECOS did: "90 programs by ECOS (1 refused), 66 boxes decided without". */
static void add_work(struct cli_text *text, const brdffit_result *result)
{
    if (result->programs_solved + result->programs_decided == 0) {
        brdffit_cli_grouped(text, result->nodes);
        brdffit_cli_text_printf(text, " node%s", result->nodes == 1 ? "" : "s");
        return;
    }
    brdffit_cli_grouped(text, result->programs_solved);
    brdffit_cli_text_printf(text, " program%s by ECOS (", result->programs_solved == 1 ? "" : "s");
    brdffit_cli_grouped(text, result->programs_refused);
    brdffit_cli_text_puts(text, " refused), ");
    brdffit_cli_grouped(text, result->programs_decided);
    brdffit_cli_text_printf(text, " box%s decided without", result->programs_decided == 1 ? "" : "es");
}

/* What engine socp did at the level of --verify, which is rounded down, so that the claim stays true. */
static void add_verification(struct cli_text *text, struct cli_style style, const struct cli_job *job)
{
    const brdffit_verification *const r = &job->verification;
    brdffit_cli_text_printf(text,
                            r->proven ? "by engine socp alone, no E%s lies below "
                                      : "engine socp alone could not prove that no E%s lies below ",
                            brdffit_cli_glyph(style, CLI_SQUARED));
    brdffit_cli_directed(text, r->level, 6, 0);
    brdffit_cli_text_puts(text, ": ");
    brdffit_cli_grouped(text, r->leaves);
    brdffit_cli_text_printf(text, " box%s discarded ", r->leaves == 1 ? "" : "es");
    if (r->proven) {
        brdffit_cli_text_puts(text, "cover the whole domain");
    } else {
        brdffit_cli_text_puts(text, "leave ");
        brdffit_cli_directed(text, 100 * r->unproven, 2, 1);
        brdffit_cli_text_printf(text, "\t%% of the domain (stopped by %s)", brdffit_stop_string(r->stop));
    }
    brdffit_cli_text_puts(text, ", ");
    brdffit_cli_grouped(text, r->solved);
    brdffit_cli_text_printf(text, " program%s by ECOS (", r->solved == 1 ? "" : "s");
    brdffit_cli_grouped(text, r->refused);
    brdffit_cli_text_puts(text, " refused), ");
    brdffit_cli_duration(text, job->verify_seconds);
    brdffit_cli_text_puts(text, ".");
}

static void verification(struct cli_text *text, struct cli_style style, const struct cli_job *job)
{
    const int proven = job->verification.proven;
    struct cli_text words = {0};
    if (!job->verified) {
        return;
    }
    if (job->verification.level > 0) {
        add_verification(&words, style, job);
    } else {
        brdffit_cli_text_puts(&words, "the bound is 0, which needs no proof.");
    }
    brdffit_cli_paragraph(text, style, proven ? CLI_GREEN : CLI_YELLOW,
                          proven ? "Verified:" : "NOT verified:", brdffit_cli_text_string(&words));
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

/* --physical: whether the bounds bind, where, and what that costs. */
static void physical(struct cli_text *text, struct cli_style style, const struct cli_job *job)
{
    const brdffit_result *const r = job->result;
    struct cli_text words = {0};
    size_t named = 0;
    if (r->at_limit == NULL) {
        return;
    }
    brdffit_cli_text_puts(&words, r->channels_at_limit == 0   ? "the bounds hold, and bind nowhere."
                                  : r->channels_at_limit == 1 ? "the bounds hold, and bind in channel "
                                                              : "the bounds hold, and bind in channels ");
    for (size_t k = 0; k < r->model->channels; k++) {
        if (r->at_limit[k]) {
            brdffit_cli_text_puts(&words, named++ > 0 ? ", " : "");
            brdffit_cli_name(&words, style, job->table->channel_names[k]);
        }
    }
    if (named > 0 && r->e2_free > 0) {
        brdffit_cli_text_printf(&words, ": E%s is %.3g\t%% above that of the fit without them.",
                                brdffit_cli_glyph(style, CLI_SQUARED), 100 * fmax(0, r->e2 / r->e2_free - 1));
    } else if (named > 0) {
        brdffit_cli_text_puts(&words, ".");
    }
    brdffit_cli_paragraph(text, style, CLI_BOLD, "Physical:", brdffit_cli_text_string(&words));
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

static void effort(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                   const brdffit_options *options)
{
    struct cli_text words = {0};
    brdffit_cli_grouped(&words, job->result->boxes);
    brdffit_cli_text_printf(&words, " box%s, ", job->result->boxes == 1 ? "" : "es");
    add_work(&words, job->result);
    brdffit_cli_text_puts(&words, ", stopped ");
    add_stop(&words, job->result->stop, options);
    brdffit_cli_text_puts(&words, "; read ");
    brdffit_cli_duration(&words, job->read_seconds);
    brdffit_cli_text_puts(&words, ", reduce ");
    brdffit_cli_duration(&words, job->reduce_seconds);
    brdffit_cli_text_puts(&words, ", search ");
    brdffit_cli_duration(&words, job->search_seconds);
    brdffit_cli_paragraph(text, style, CLI_BOLD, "Search:", brdffit_cli_text_string(&words));
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

/* A count and what it is of, after a separator from the second on; nothing for 0. */
static void add_saving(struct cli_text *words, size_t count, const char *one, const char *many)
{
    if (count == 0) {
        return;
    }
    brdffit_cli_text_puts(words, words->size > 0 ? "; " : "");
    brdffit_cli_grouped(words, count);
    brdffit_cli_text_printf(words, "\t%s", count == 1 ? one : many);
}

/* Of sigma, which 1/sqrt(n) stands for; a little more, as that is rounded. */
static double smallest_asked(const brdffit_options *options)
{
    const double sigma = brdffit_cli_any_lobe_by(options, 0) ? options->sigma_min : INFINITY;
    const double other = brdffit_cli_any_lobe_by(options, 1) ? 1 / sqrt(options->exponent_max) : INFINITY;
    return (sigma < other ? sigma : other) * (1 + 1e-12);
}

/* --stats: work that this file did not need. Skipped samples have a line of their own. */
static void savings(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                    const brdffit_options *options)
{
    const brdffit_result *const r = job->result;
    struct cli_text words = {0};
    add_saving(&words, r->samples_used > r->distinct_c ? r->samples_used - r->distinct_c : 0,
               "sample merged into one of the same half angle", "samples merged into others of the same half angle");
    add_saving(&words, r->channels_zero, "channel without signal", "channels without signal");
    add_saving(&words, r->channels_identical, "channel that repeats another", "channels that repeat another");
    add_saving(&words, r->programs_decided, "box decided without ECOS", "boxes decided without ECOS");
    if (r->sigma_tail > smallest_asked(options)) {
        brdffit_cli_text_printf(&words, "%snothing searched below %s = %.3g, where the data see no change",
                                words.size > 0 ? "; " : "", brdffit_cli_glyph(style, CLI_SIGMA), r->sigma_tail);
    }
    if (job->one_lobe_fitted && job->one_lobe_e2 > 0) {
        brdffit_cli_text_puts(&words, words.size > 0 ? "; one " : "one ");
        if (brdffit_cli_lobes_differ(options)) {
            brdffit_cli_text_printf(&words, "%s ", brdffit_distribution_title(brdffit_cli_lobe(options, 0)));
        }
        brdffit_cli_text_printf(&words, "lobe alone reaches E%s = %.6g, and no %s that by more than ",
                                brdffit_cli_glyph(style, CLI_SQUARED), job->one_lobe_e2,
                                options->lobes > 2 ? "further lobes lower" : "second lobe lowers");
        brdffit_cli_directed(&words, 100 * (1 - r->lower_bound / job->one_lobe_e2), 2, 1);
        brdffit_cli_text_puts(&words, "\t%");
    }
    brdffit_cli_text_puts(&words, words.size > 0 ? "." : "nothing: this file needed all of it.");
    brdffit_cli_paragraph(text, style, CLI_BOLD, "Saved:", brdffit_cli_text_string(&words));
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

void brdffit_cli_report_fit(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                            const struct cli_fitter *fitter)
{
    const brdffit_result *const result = job->result;
    brdffit_cli_report_title(text, style, job, result->samples_used, result->samples_skipped,
                             fitter->options.max_incidence, "used");
    lobe_table(text, style, result, &fitter->options);
    channel_table(text, style, job, &fitter->options);
    brdffit_cli_terms_report(text, style, job);
    brdffit_cli_confidence_report(text, style, job, fitter);
    brdffit_cli_text_puts(text, "\n");
    brdffit_cli_certificate(text, style, result, &fitter->options);
    verification(text, style, job);
    physical(text, style, job);
    brdffit_cli_report_weights(text, style, job->table, job->weighting);
    brdffit_cli_note_paragraphs(text, style, job->table, 0);
    brdffit_cli_misfit_warnings(text, style, job, &fitter->options);
    brdffit_cli_warnings(text, style, result, &fitter->options);
    brdffit_cli_terms_warnings(text, style, job);
    effort(text, style, job, &fitter->options);
    if (fitter->settings->stats) {
        savings(text, style, job, &fitter->options);
    }
}
