/* json_fit.c: the line that a fit writes with --json. What it says about how
 * the file was read is what `eval` needs to re-evaluate the fit from the line
 * and the file alone. SPDX-License-Identifier: MIT */
#include "json_fit.h"

#include <math.h>

#include "confidence.h"
#include "failure.h"
#include "lobes.h"
#include "lobes_auto.h"
#include "misfit.h"
#include "reading.h"
#include "shard.h"
#include "terms.h"
#include "words.h"

static void place(struct cli_json *json, const char *key, size_t value, size_t add)
{
    if (value != BRDFFIT_NONE) {
        brdffit_cli_json_count(json, key, value + add);
    }
}

/* Line and column count from 1, sample and channel from 0, as in the API. */
void brdffit_cli_json_error(struct cli_json *json, const struct cli_job *job)
{
    const brdffit_error *const error = &job->error;
    size_t fault_size;
    brdffit_cli_json_open(json, "error", '{');
    if (job->not_begun) {
        brdffit_cli_json_string(json, "code", "interrupted");
        brdffit_cli_json_string(json, "message", "interrupted before this file was begun");
        brdffit_cli_json_close(json, '}');
        return;
    }
    brdffit_cli_json_string(json, "code", brdffit_cli_status_name(job->status));
    brdffit_cli_json_string(json, "message", brdffit_cli_message(error));
    if (*brdffit_cli_fault(&fault_size) && job->table == NULL) {
        brdffit_cli_json_string(json, "text", brdffit_cli_fault(&fault_size));
    }
    place(json, "line", brdffit_cli_error_line(error, job->table), 0);
    place(json, "column", error->column, 0);
    place(json, "sample", error->sample, 0);
    place(json, "channel", error->channel, 0);
    if (brdffit_cli_has_value(error)) {
        if (error->value - error->value == 0) {
            brdffit_cli_json_number(json, "value", error->value);
        } else {
            brdffit_cli_json_string(json, "value", error->value > 0 ? "inf" : error->value < 0 ? "-inf" : "nan");
        }
    }
    brdffit_cli_json_close(json, '}');
}

void brdffit_cli_json_channels(struct cli_json *json, const brdffit_table *table)
{
    brdffit_cli_json_open(json, "channels", '[');
    for (size_t k = 0; k < table->samples->channels; k++) {
        brdffit_cli_json_string(json, NULL, table->channel_names[k]);
    }
    brdffit_cli_json_close(json, ']');
}

static void directions(struct cli_json *json, const brdffit_samples *samples)
{
    brdffit_cli_json_open(json, "merl_directions", '[');
    for (size_t i = 0; i < samples->count; i++) {
        brdffit_cli_json_open(json, NULL, '[');
        for (size_t k = 0; k < 3; k++) {
            brdffit_cli_json_number(json, NULL, samples->light[3 * i + k]);
        }
        for (size_t k = 0; k < 3; k++) {
            brdffit_cli_json_number(json, NULL, samples->view[3 * i + k]);
        }
        brdffit_cli_json_close(json, ']');
    }
    brdffit_cli_json_close(json, ']');
}

/* How the file was read. */
void brdffit_cli_json_source(struct cli_json *json, const struct cli_job *job, const struct cli_settings *settings)
{
    const brdffit_table *const table = job->table;
    const int merl = table->format == BRDFFIT_IO_FORMAT_MERL;
    brdffit_cli_json_reading(json, settings);
    brdffit_cli_json_string(json, "format", brdffit_cli_choice_name(brdffit_cli_format_choices, (int)table->format));
    brdffit_cli_json_string(json, "quantity",
                            brdffit_cli_choice_name(brdffit_cli_quantity_choices, (int)table->samples->quantity));
    if (!merl) {
        brdffit_cli_json_null(json, "merl_bins");
        brdffit_cli_json_null(json, "merl_samples");
        return;
    }
    brdffit_cli_json_string(json, "merl_bins",
                            brdffit_cli_choice_name(brdffit_cli_bins_choices, (int)table->merl_bins));
    brdffit_cli_json_string(json, "merl_samples", settings->merl_samples);
}

void brdffit_cli_json_skipped(struct cli_json *json, const size_t *skipped, const brdffit_table *table)
{
    brdffit_cli_json_open(json, "samples_skipped", '{');
    for (int i = 0; i < BRDFFIT_SKIP_COUNT; i++) {
        brdffit_cli_json_count(json, brdffit_skip_string((brdffit_skip)i), skipped[i]);
    }
    for (int i = 0; i < BRDFFIT_IO_DROP_COUNT; i++) {
        brdffit_cli_json_count(json, brdffit_io_drop_string((brdffit_io_drop)i), table->dropped[i]);
    }
    brdffit_cli_json_close(json, '}');
}

static int any_by_exponent(const brdffit_model *model)
{
    int found = 0;
    for (int p = 0; p < model->lobes; p++) {
        found |= brdffit_cli_by_exponent(model->distributions[p]);
    }
    return found;
}

/* Null where a lobe is known by sigma; nothing when all are. */
static void exponents(struct cli_json *json, const brdffit_result *result)
{
    if (!any_by_exponent(result->model)) {
        return;
    }
    brdffit_cli_json_open(json, "exponent", '[');
    for (int p = 0; p < result->model->lobes; p++) {
        if (brdffit_cli_by_exponent(result->model->distributions[p])) {
            brdffit_cli_json_number(json, NULL, result->lobe[p]->exponent);
        } else {
            brdffit_cli_json_null(json, NULL);
        }
    }
    brdffit_cli_json_close(json, ']');
}

/* With --physical: what the bounds do. */
static void physical(struct cli_json *json, const brdffit_result *result)
{
    if (result->at_limit == NULL) {
        return;
    }
    brdffit_cli_json_open(json, "physical", '{');
    brdffit_cli_json_count(json, "channels_at_limit", result->channels_at_limit);
    brdffit_cli_json_number(json, "e2_free", result->e2_free);
    brdffit_cli_json_close(json, '}');
}

/* A number, or null where it is none. */
static void number_or_null(struct cli_json *json, const char *key, double value)
{
    if (isfinite(value)) {
        brdffit_cli_json_number(json, key, value);
    } else {
        brdffit_cli_json_null(json, key);
    }
}

/* How good the fit is; nulls where only sums were there. */
static void quality(struct cli_json *json, const struct cli_job *job)
{
    static const char *const figures[] = {"r2_total", "relative_rms", "foreseen"};
    if (job->r2 == NULL) {
        brdffit_cli_json_null(json, "r2");
    } else {
        brdffit_cli_json_open(json, "r2", '[');
        for (size_t k = 0; k < job->result->model->channels; k++) {
            number_or_null(json, NULL, job->r2[k]);
        }
        brdffit_cli_json_close(json, ']');
    }
    for (int i = 0; i < 3; i++) {
        number_or_null(json, figures[i], job->r2 != NULL ? job->quality[i] : NAN);
    }
    brdffit_cli_json_open(json, "misfit", '[');
    for (unsigned bit = 1; job->r2 != NULL && bit <= job->misfit; bit <<= 1) {
        if (job->misfit & bit) {
            brdffit_cli_json_string(json, NULL, brdffit_cli_misfit_name(bit));
        }
    }
    brdffit_cli_json_close(json, ']');
}

static void parameters(struct cli_json *json, const struct cli_job *job)
{
    const brdffit_result *const result = job->result;
    const brdffit_model *const model = result->model;
    const size_t lobes = (size_t)model->lobes;
    brdffit_cli_json_numbers(json, "sigma", model->sigma, lobes);
    exponents(json, result);
    brdffit_cli_json_numbers(json, "x", model->x, model->channels);
    brdffit_cli_json_open(json, "y", '[');
    for (size_t k = 0; k < model->channels; k++) {
        brdffit_cli_json_numbers(json, NULL, model->y + k * lobes, lobes);
    }
    brdffit_cli_json_close(json, ']');
    brdffit_cli_json_terms(json, job);
    brdffit_cli_json_numbers(json, "channel_scale", result->channel_scale, model->channels);
    brdffit_cli_json_number(json, "e2", result->e2);
    brdffit_cli_json_number(json, "objective", result->e2);
    brdffit_cli_json_number(json, "e2_error", result->e2_error);
    brdffit_cli_json_number(json, "lower_bound", result->lower_bound);
    brdffit_cli_json_number(json, "gap", result->gap);
    brdffit_cli_json_numbers(json, "rms", result->rms, model->channels);
    brdffit_cli_json_number(json, "rms_total", result->rms_total);
    quality(json, job);
    brdffit_cli_json_number(json, "sum_of_squares", result->sum_of_squares);
    brdffit_cli_json_number(json, "kkt_residual", result->kkt_residual);
}

/* What lower_bound is about, a range for each lobe: of sigma, or with `exponent` of n where it has one. Null: no lobe of its
 * kind is left. */
static void proven_ranges(struct cli_json *json, const brdffit_result *result, const brdffit_options *options,
                          int exponent)
{
    brdffit_cli_json_open(json, exponent ? "proven_exponent" : "proven_sigma", '[');
    for (int p = 0; p < result->model->lobes; p++) {
        const int by = brdffit_cli_by_exponent(result->model->distributions[p]);
        const double floor = result->lobe[p]->sigma_floor;
        const int cut = floor > 1 / sqrt(options->exponent_max);
        const double sigma[2] = {floor, by ? 1 / sqrt(options->exponent_min) : options->sigma_max};
        const double n[2] = {options->exponent_min, cut ? (1 - 1e-15) / (floor * floor) : options->exponent_max};
        if (!isfinite(floor) || (exponent && !by)) {
            brdffit_cli_json_null(json, NULL);
        } else {
            brdffit_cli_json_numbers(json, NULL, exponent ? n : sigma, 2);
        }
    }
    brdffit_cli_json_close(json, ']');
}

static void exponent_intervals(struct cli_json *json, const brdffit_result *result)
{
    if (!any_by_exponent(result->model)) {
        return;
    }
    brdffit_cli_json_open(json, "exponent_interval", '[');
    for (int p = 0; p < result->model->lobes; p++) {
        const double ends[2] = {result->lobe[p]->exponent_low, result->lobe[p]->exponent_high};
        if (brdffit_cli_by_exponent(result->model->distributions[p])) {
            brdffit_cli_json_numbers(json, NULL, ends, 2);
        } else {
            brdffit_cli_json_null(json, NULL);
        }
    }
    brdffit_cli_json_close(json, ']');
}

static void lobes(struct cli_json *json, const brdffit_result *result)
{
    const int count = result->model->lobes;
    brdffit_cli_json_open(json, "weight", '[');
    for (int p = 0; p < count; p++) {
        brdffit_cli_json_number(json, NULL, result->lobe[p]->weight);
    }
    brdffit_cli_json_close(json, ']');
    brdffit_cli_json_open(json, "effective_samples", '[');
    for (int p = 0; p < count; p++) {
        brdffit_cli_json_number(json, NULL, result->lobe[p]->effective_samples);
    }
    brdffit_cli_json_close(json, ']');
    brdffit_cli_json_open(json, "sigma_interval", '[');
    for (int p = 0; p < count; p++) {
        const double ends[2] = {result->lobe[p]->sigma_low, result->lobe[p]->sigma_high};
        brdffit_cli_json_numbers(json, NULL, ends, 2);
    }
    brdffit_cli_json_close(json, ']');
    exponent_intervals(json, result);
    brdffit_cli_json_open(json, "warnings", '[');
    for (int p = 0; p < count; p++) {
        brdffit_cli_json_open(json, NULL, '[');
        for (unsigned bit = 1; bit != 0 && bit <= result->lobe[p]->warnings; bit <<= 1) {
            if (result->lobe[p]->warnings & bit) {
                brdffit_cli_json_string(json, NULL, brdffit_cli_warning_name(bit));
            }
        }
        brdffit_cli_json_close(json, ']');
    }
    brdffit_cli_json_close(json, ']');
}

void brdffit_cli_json_lobes(struct cli_json *json, const brdffit_options *o)
{
    if (brdffit_cli_lobes_differ(o)) {
        brdffit_cli_json_null(json, "distribution");
    } else {
        brdffit_cli_json_string(json, "distribution", brdffit_distribution_string(brdffit_cli_lobe(o, 0)));
    }
    brdffit_cli_json_open(json, "distributions", '[');
    for (int p = 0; p < o->lobes; p++) {
        brdffit_cli_json_string(json, NULL, brdffit_distribution_string(brdffit_cli_lobe(o, p)));
    }
    brdffit_cli_json_close(json, ']');
    brdffit_cli_json_term_names(json, o);
}

void brdffit_cli_json_options(struct cli_json *json, const brdffit_options *o)
{
    const double exponents[2] = {o->exponent_min, o->exponent_max};
    const int by_sigma = brdffit_cli_any_lobe_by(o, 0), by_exponent = brdffit_cli_any_lobe_by(o, 1);
    const double range[2] = {by_sigma ? o->sigma_min : 1 / sqrt(o->exponent_max),
                             by_sigma ? o->sigma_max : 1 / sqrt(o->exponent_min)};
    brdffit_cli_json_string(json, "normalise",
                            brdffit_cli_choice_name(brdffit_cli_normalise_choices, (int)o->normalise));
    brdffit_cli_json_numbers(json, "sigma_range", range, 2);
    if (by_exponent) {
        brdffit_cli_json_numbers(json, "exponent_range", exponents, 2);
    }
    brdffit_cli_json_number(json, "relative_gap", o->relative_gap);
    brdffit_cli_json_number(json, "absolute_gap", o->absolute_gap);
    brdffit_cli_json_number(json, "sigma_resolution", o->sigma_resolution);
    brdffit_cli_json_count(json, "box_budget", o->box_budget);
    brdffit_cli_json_number(json, "max_incidence", o->max_incidence);
}

/* What ECOS did; null when it was not used. */
static void socp(struct cli_json *json, const brdffit_result *result)
{
    if (result->programs_solved + result->programs_decided == 0) {
        brdffit_cli_json_null(json, "socp");
        return;
    }
    brdffit_cli_json_open(json, "socp", '{');
    brdffit_cli_json_count(json, "solved", result->programs_solved);
    brdffit_cli_json_count(json, "refused", result->programs_refused);
    brdffit_cli_json_count(json, "decided", result->programs_decided);
    brdffit_cli_json_close(json, '}');
}

/* --verify; null without. */
static void verification(struct cli_json *json, const struct cli_job *job)
{
    const brdffit_verification *const r = &job->verification;
    if (!job->verified) {
        brdffit_cli_json_null(json, "verify");
        return;
    }
    brdffit_cli_json_open(json, "verify", '{');
    brdffit_cli_json_string(json, "engine", "socp");
    brdffit_cli_json_number(json, "level", r->level);
    brdffit_cli_json_bool(json, "proven", r->proven);
    brdffit_cli_json_number(json, "unproven", r->unproven);
    if (r->proven) {
        brdffit_cli_json_null(json, "stop");
    } else {
        brdffit_cli_json_string(json, "stop", brdffit_stop_string(r->stop));
    }
    brdffit_cli_json_count(json, "boxes", r->boxes);
    brdffit_cli_json_count(json, "leaves", r->leaves);
    brdffit_cli_json_count(json, "solved", r->solved);
    brdffit_cli_json_count(json, "refused", r->refused);
    brdffit_cli_json_count(json, "decided", r->decided);
    brdffit_cli_json_number(json, "seconds", job->verify_seconds);
    brdffit_cli_json_close(json, '}');
}

static void result_members(struct cli_json *json, const struct cli_job *job, const struct cli_fitter *fitter)
{
    const brdffit_result *const result = job->result;
    parameters(json, job);
    physical(json, result);
    brdffit_cli_json_count(json, "samples_used", result->samples_used);
    brdffit_cli_json_skipped(json, result->samples_skipped, job->table);
    brdffit_cli_json_count(json, "boxes", result->boxes);
    brdffit_cli_json_count(json, "nodes", result->nodes);
    socp(json, result);
    verification(json, job);
    brdffit_cli_confidence_json(json, job);
    brdffit_cli_json_count(json, "distinct_c", result->distinct_c);
    brdffit_cli_json_string(json, "stop", brdffit_stop_string(result->stop));
    lobes(json, result);
    brdffit_cli_json_channels(json, job->table);
    brdffit_cli_json_options(json, &fitter->options);
    proven_ranges(json, result, &fitter->options, 0);
    if (any_by_exponent(result->model)) {
        proven_ranges(json, result, &fitter->options, 1);
    }
    brdffit_cli_json_source(json, job, fitter->settings);
    brdffit_cli_json_string(json, "weighting", brdffit_weighting_string(job->weighting));
    brdffit_cli_json_notes(json, job->table);
    if (job->table->format == BRDFFIT_IO_FORMAT_MERL && fitter->io.directions != NULL) {
        directions(json, fitter->io.directions);
    }
}

void brdffit_cli_json_fit_members(struct cli_json *json, const struct cli_job *job, const struct cli_fitter *fitter)
{
    const int fitted = job->status == BRDFFIT_OK && !job->not_begun;
    brdffit_cli_json_string(json, "schema", "brdffit.fit/1");
    brdffit_cli_json_path(json, job->path);
    brdffit_cli_json_string(json, "status",
                            !fitted                                           ? "error"
                            : job->result->stop == BRDFFIT_STOP_CONTRADICTION ? "contradiction"
                            : job->result->certified                          ? "certified"
                                                                              : "gap_open");
    if (!fitted) {
        brdffit_cli_json_error(json, job);
    }
    brdffit_cli_json_lobes(json, &fitter->options);
    brdffit_cli_json_string(json, "norm", brdffit_norm_string(fitter->options.norm));
    if (fitter->options.norm == BRDFFIT_NORM_L2) {
        brdffit_cli_json_string(json, "engine", brdffit_engine_string(fitter->options.engine));
    } else {
        brdffit_cli_json_null(json, "engine");
    }
    brdffit_cli_json_count(json, "lobes", (size_t)fitter->options.lobes);
    if (fitted) {
        result_members(json, job, fitter);
    }
    if (!job->not_begun) {
        brdffit_cli_json_open(json, "seconds", '{');
        brdffit_cli_json_number(json, "read", job->read_seconds);
        brdffit_cli_json_number(json, "reduce", job->reduce_seconds);
        brdffit_cli_json_number(json, "search", job->search_seconds);
        brdffit_cli_json_close(json, '}');
    }
    brdffit_cli_json_trials(json, job, fitter);
}

void brdffit_cli_json_fit(struct cli_text *text, const struct cli_job *job, const struct cli_fitter *fitter)
{
    struct cli_json json = {text, 0};
    const size_t start = text->size;
    brdffit_cli_json_open(&json, NULL, '{');
    brdffit_cli_json_fit_members(&json, job, fitter);
    if (fitter->shard != NULL) {
        brdffit_cli_shard_stamp(text, start, fitter->shard, job->position);
    }
    brdffit_cli_json_close(&json, '}');
    brdffit_cli_text_puts(text, "\n");
}
