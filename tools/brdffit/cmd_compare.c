/* cmd_compare.c: brdffit compare. SPDX-License-Identifier: MIT */
#include "commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "compare.h"
#include "failure.h"
#include "interrupt.h"
#include "output.h"
#include "reading.h"
#include "tell.h"
#include "terms.h"

struct run {
    struct cli_settings *settings;
    struct cli_fitter fitter;
    struct cli_progress progress;
    struct cli_output output;
    struct cli_style style;
    const struct cli_model *models;
    struct cli_model *owned; /* of --models */
    size_t count;
    int exit_code;
    int reports; /* printed so far */
    size_t not_begun;
};

static void add_defaults(struct cli_text *text)
{
    brdffit_cli_text_puts(text, "Models are joined with commas: [N]DISTRIBUTION, with + between distributions,\n"
                                "then /TERM as of --masking, --fresnel and --diffuse of 'brdffit fit'\n"
                                "(no-diffuse for none): 2beckmann, beckmann+ggx, ggx/smith/schlick. Or a preset\n"
                                "of its --model. Default:\n ");
    size_t column = 1;
    for (const struct cli_model *m = brdffit_cli_default_models; m->lobes > 0; m++) {
        const size_t length = strlen(m->name) + (m[1].lobes > 0);
        if (column + 1 + length > CLI_WIDTH) {
            brdffit_cli_text_puts(text, "\n ");
            column = 1;
        }
        brdffit_cli_text_printf(text, " %s%s", m->name, m[1].lobes > 0 ? "," : "\n");
        column += 1 + length;
    }
}

void brdffit_cli_compare_help(void)
{
    struct cli_text text = {0};
    brdffit_cli_text_puts(&text, "Usage: brdffit compare FILE... [options]\n"
                                 "\n"
                                 "Fit many forms of model to each FILE, with proof, and say which of them its\n"
                                 "data support, which they cannot tell apart, and which cannot be as good\n"
                                 "whatever their parameters are.\n"
                                 "\n");
    brdffit_cli_option_help(&text, CLI_COMPARE);
    brdffit_cli_text_puts(&text, "\n");
    add_defaults(&text);
    brdffit_cli_text_puts(&text, "\n"
                                 "A model that cannot be fitted is a line and stops nothing. Exit status as that\n"
                                 "of 'brdffit fit', of every fit of every FILE: 0 all are certified, and the\n"
                                 "first of 1, 2, 3, 4 that occurred otherwise.\n");
    fputs(brdffit_cli_text_string(&text), stdout);
    brdffit_cli_text_free(&text);
}

/* The exit code; `bad` is the culprit in the list, with what follows it. */
static int refuse(const char *bad)
{
    struct cli_text names = {0};
    brdffit_cli_add_term_names(&names);
    brdffit_cli_tell(
        "brdffit compare: --models does not take '%.*s'; a model is [N]DISTRIBUTION with + between, up to %d lobes, "
        "then /TERM, each model once; terms: %s; distributions and presets:",
        (int)strcspn(bad, ","), bad, BRDFFIT_MAX_LOBES, brdffit_cli_text_string(&names));
    brdffit_cli_text_free(&names);
    for (const struct cli_choice *c = brdffit_cli_distribution_choices(); c->name != NULL; c++) {
        brdffit_cli_tell("%s %s", c->value == 0 ? "" : ",", c->name);
    }
    for (const struct cli_preset *p = brdffit_cli_presets; p->model.lobes > 0; p++) {
        brdffit_cli_tell(", %s", p->model.name);
    }
    fputs("\nTry 'brdffit compare --help'.\n", stderr);
    return CLI_EXIT_USAGE;
}

/* 0, or the exit code of a failure that is on stderr. */
static int take_models(struct run *r)
{
    const char *const list = r->settings->models, *bad = NULL;
    r->models = brdffit_cli_default_models;
    if (list == NULL) {
        for (r->count = 0; r->models[r->count].lobes > 0; r->count++)
            ;
        return 0;
    }
    r->count = brdffit_cli_read_models(list, &r->owned, &bad);
    r->models = r->owned;
    if (r->count > 0) {
        return 0;
    }
    return bad == NULL ? brdffit_cli_no_memory() : refuse(bad);
}

/* All forms are fitted to the same samples: without a limit of incidence where one of them has none. */
static void settle_incidence(struct run *r)
{
    if (brdffit_cli_any_fresnel(r->models, r->count)) {
        r->settings->fresnel = BRDFFIT_FRESNEL_SCHLICK;
    }
    brdffit_cli_settle_incidence(r->settings);
}

/* Messages on standard error, the result on the output. 0 on success. */
static int publish(struct run *r, const struct cli_comparison *comparison, const struct cli_job *job,
                   struct cli_text *text)
{
    const int compared = job->status == BRDFFIT_OK && !job->not_begun;
    if (!compared && !job->not_begun) {
        brdffit_cli_report_error(job->path, &job->error, job->table, job->system_error);
    }
    if (job->table != NULL && !r->settings->quiet) {
        brdffit_cli_say_notes(job->path, job->table, 1);
    }
    if (r->settings->json) {
        brdffit_cli_verdict_json(text, comparison, job);
    } else if (compared && !r->settings->quiet) {
        if (r->reports++ > 0) {
            brdffit_cli_text_puts(text, "\n");
        }
        brdffit_cli_compare_report(text, r->style, comparison, job, &r->fitter.options);
    }
    return brdffit_cli_output_write(&r->output, text);
}

static int compare_file(struct run *r, size_t index)
{
    struct cli_comparison comparison;
    struct cli_job job;
    struct cli_text text = {0};
    const char *const path = r->settings->files[index];
    if (brdffit_cli_comparison_init(&comparison, r->models, r->count, r->settings) != 0) {
        brdffit_cli_comparison_free(&comparison);
        (void)brdffit_cli_no_memory();
        return -1;
    }
    brdffit_cli_progress_file(&r->progress, index, path);
    brdffit_cli_compare_models(&comparison, &r->fitter, &job, path, r->settings->json ? &text : NULL);
    brdffit_cli_progress_erase(&r->progress);
    const int usable = job.status == BRDFFIT_OK && !job.not_begun;
    r->exit_code = brdffit_cli_worse_exit(r->exit_code, usable ? brdffit_cli_comparison_exit(&comparison)
                                                               : brdffit_cli_job_exit(&job));
    r->not_begun += (size_t)job.not_begun;
    const int failed = publish(r, &comparison, &job, &text);
    brdffit_cli_text_free(&text);
    brdffit_cli_job_free(&job);
    brdffit_cli_comparison_free(&comparison);
    return failed;
}

static int compare_files(struct run *r)
{
    for (size_t i = 0; i < r->settings->file_count; i++) {
        if (compare_file(r, i) != 0) {
            return -1;
        }
    }
    return 0;
}

/* The settings are fine; open, compare, close. */
static int run_compare(struct run *r)
{
    int code = take_models(r);
    if (code == 0) {
        settle_incidence(r);
        code = brdffit_cli_fitter_init(&r->fitter, r->settings);
    }
    if (code != 0) {
        return code;
    }
    if (brdffit_cli_output_open(&r->output, r->settings->output) != 0) {
        return CLI_EXIT_FAILURE;
    }
    r->style = brdffit_cli_style(r->output.file);
    brdffit_cli_progress_start(&r->progress, r->settings->file_count, r->settings->quiet);
    r->fitter.progress = &r->progress;
    brdffit_cli_cancel_on_interrupt();
    if (compare_files(r) != 0) {
        brdffit_cli_output_abandon(&r->output);
        return CLI_EXIT_FAILURE;
    }
    if (r->not_begun > 0) {
        brdffit_cli_tell("brdffit: interrupted; %zu file%s not begun\n", r->not_begun,
                         r->not_begun == 1 ? " was" : "s were");
    }
    return brdffit_cli_output_commit(&r->output) != 0 ? CLI_EXIT_FAILURE : r->exit_code;
}

int brdffit_cli_compare(int argc, char **argv)
{
    struct cli_settings settings;
    const enum cli_parse answer = brdffit_cli_parse(CLI_COMPARE, "compare", argc, argv, &settings);
    int code = answer == CLI_PARSE_NO_MEMORY ? CLI_EXIT_FAILURE : CLI_EXIT_USAGE;
    if (answer == CLI_PARSED_HELP) {
        brdffit_cli_compare_help();
        code = 0;
    } else if (answer == CLI_PARSED) {
        struct run r;
        memset(&r, 0, sizeof r);
        r.settings = &settings;
        code = run_compare(&r);
        brdffit_cli_fitter_free(&r.fitter);
        free(r.owned);
    }
    brdffit_cli_settings_free(&settings);
    return code;
}
