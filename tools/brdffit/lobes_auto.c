/* lobes_auto.c: --lobes auto: the fewest lobes that the data support.
 * SPDX-License-Identifier: MIT */
#include "lobes_auto.h"

#include <math.h>

#include "criteria.h"
#include "interrupt.h"
#include "models.h"
#include "observations.h"
#include "words.h"

/* By how much the last of so many lobes lowers BIC, when they leave that E^2; observations as the richer fit sees them. */
static double gain(const struct cli_lobe_trial *trial, const brdffit_options *form, int lobes, double e2)
{
    const size_t before = brdffit_cli_parameters(form, lobes - 1, trial->channels),
                 after = brdffit_cli_parameters(form, lobes, trial->channels);
    return brdffit_cli_criteria(trial[-1].e2_most, trial->effective, before).value[CLI_BIC] -
           brdffit_cli_criteria(e2, trial->effective, after).value[CLI_BIC];
}

/* Fit with so many; 1 when the trial is there. */
static int try_lobes(struct cli_job *job, struct cli_fitter *fitter, int lobes)
{
    fitter->options.lobes = lobes;
    brdffit_cli_job_fit(job, fitter);
    if (job->status != BRDFFIT_OK) {
        return 0;
    }
    const brdffit_result *const r = job->result;
    const double floor = brdffit_cli_e2_floor(r, &fitter->options);
    struct cli_lobe_trial *const trial = &job->trials[lobes - 1];
    trial->e2 = r->e2;
    trial->e2_most = fmax(r->e2 + r->e2_error, floor);
    trial->lower_bound = fmax(r->lower_bound, floor);
    trial->effective = brdffit_cli_effective_observations(job, &fitter->options);
    if (job->status != BRDFFIT_OK) {
        return 0;
    }
    trial->channels = brdffit_cli_distinct_channels(r);
    job->trial_count = lobes > job->trial_count ? lobes : job->trial_count;
    if (lobes > 1) {
        trial->gain = gain(trial, &fitter->options, lobes, trial->e2_most);
        trial->gain_most = gain(trial, &fitter->options, lobes, trial->lower_bound);
    }
    return 1;
}

static int gains(const struct cli_job *job, int lobes)
{
    return job->trials[lobes - 1].gain >= CLI_TELLING; /* NaN, as many parameters as observations, is no gain */
}

static void choose(struct cli_job *job, struct cli_fitter *fitter)
{
    int lobes = 1;
    if (!try_lobes(job, fitter, 1)) {
        return;
    }
    while (lobes < BRDFFIT_MAX_LOBES && !brdffit_cli_interrupted()) {
        if (!try_lobes(job, fitter, lobes + 1)) {
            return;
        }
        if (!gains(job, lobes + 1)) {
            (void)try_lobes(job, fitter, lobes); /* once more: the same bits */
            return;
        }
        lobes++;
    }
}

void brdffit_cli_job_run_auto(struct cli_job *job, struct cli_fitter *fitter, const char *path)
{
    fitter->options.lobes = 1;
    brdffit_cli_job_open(job, fitter, path);
    if (job->status == BRDFFIT_OK) {
        choose(job, fitter);
    }
    brdffit_cli_job_check(job, fitter);
}

/* ---- What came of it --------------------------------------------------- */

static void add_step(struct cli_text *words, const struct cli_job *job, int lobes)
{
    static const char *const names[] = {"", "", "second", "third"};
    const struct cli_lobe_trial *const trial = &job->trials[lobes - 1];
    if (isnan(trial->gain)) {
        brdffit_cli_text_printf(words, "; a %s would need more observations", names[lobes]);
        return;
    }
    brdffit_cli_text_printf(words, "; a %s %s BIC by %.*f", names[lobes], trial->gain > 0 ? "lowers" : "raises",
                            fabs(trial->gain) < 1000, fabs(trial->gain));
    if (!gains(job, lobes)) {
        brdffit_cli_text_printf(words, ", and no %s lobe%s lowers it by %d or more", names[lobes],
                                trial->gain_most < CLI_TELLING ? ", whatever its roughness," : " that was found",
                                CLI_TELLING);
    }
}

void brdffit_cli_report_lobes(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                              const struct cli_fitter *fitter)
{
    struct cli_text words = {0};
    const int kept = fitter->options.lobes, all = job->trial_count;
    if (job->trial_count == 0) {
        return;
    }
    brdffit_cli_text_printf(&words, "%d, the fewest that the data support", kept);
    for (int lobes = 2; lobes <= all; lobes++) {
        add_step(&words, job, lobes);
    }
    brdffit_cli_text_puts(&words, ".");
    brdffit_cli_paragraph(text, style, CLI_BOLD, "Lobes:", brdffit_cli_text_string(&words));
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

void brdffit_cli_json_trials(struct cli_json *json, const struct cli_job *job, const struct cli_fitter *fitter)
{
    const int all = job->trial_count, kept = fitter->options.lobes;
    if (job->trial_count == 0) {
        return;
    }
    brdffit_cli_json_open(json, "lobes_auto", '{');
    brdffit_cli_json_string(json, "criterion", "bic");
    brdffit_cli_json_number(json, "threshold", CLI_TELLING);
    brdffit_cli_json_bool(json, "proven", kept < all && job->trials[kept].gain_most < CLI_TELLING);
    brdffit_cli_json_open(json, "trials", '[');
    for (int p = 0; p < all; p++) {
        brdffit_cli_json_open(json, NULL, '{');
        brdffit_cli_json_count(json, "lobes", (size_t)p + 1);
        brdffit_cli_json_number(json, "e2", job->trials[p].e2);
        brdffit_cli_json_number(json, "lower_bound", job->trials[p].lower_bound);
        brdffit_cli_json_number(json, "effective_observations", job->trials[p].effective);
        if (p > 0) {
            brdffit_cli_json_number(json, "gain", job->trials[p].gain);
            brdffit_cli_json_number(json, "gain_most", job->trials[p].gain_most);
        }
        brdffit_cli_json_close(json, '}');
    }
    brdffit_cli_json_close(json, ']');
    brdffit_cli_json_close(json, '}');
}
