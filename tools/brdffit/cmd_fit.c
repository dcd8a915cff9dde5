/* cmd_fit.c: brdffit fit. SPDX-License-Identifier: MIT */
#include "commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "failure.h"
#include "interrupt.h"
#include "job.h"
#include "json_fit.h"
#include "lobes_auto.h"
#include "misfit.h"
#include "models.h"
#include "output.h"
#include "reading.h"
#include "report.h"
#include "tell.h"

struct run {
    struct cli_settings *settings;
    struct cli_fitter fitter;
    struct cli_shard shard;
    struct cli_progress progress;
    struct cli_output output;
    struct cli_style style;
    int exit_code;
    int reports;      /* printed so far */
    size_t certified, open, failed, not_begun;
    unsigned char *bad; /* a file each: 1 when it failed */
};

void brdffit_cli_fit_help(void)
{
    struct cli_text text = {0};
    brdffit_cli_text_puts(&text, "Usage: brdffit fit FILE... [options]\n"
                                 "\n"
                                 "Fit a diffuse term and one to three specular lobes to each FILE (CSV, TSV or\n"
                                 "MERL .binary, plain or gzip; - is standard input) and prove how close the\n"
                                 "result is to the best that any such model could reach.\n"
                                 "\n");
    brdffit_cli_option_help(&text, CLI_FIT);
    brdffit_cli_text_puts(&text, "\nPresets of --model:\n");
    brdffit_cli_add_presets(&text);
    brdffit_cli_text_puts(&text, "\n"
                                 "Options may follow files; -- ends them. British and American spellings of\n"
                                 "normalise and centre are both understood.\n"
                                 "\n"
                                 "Exit status: 0 every fit is certified; 1 a file cannot be read or written,\n"
                                 "memory ran out, or a proof contradicts its fit; 2 wrong usage; 3 a file's\n"
                                 "data cannot be used; 4 a search stopped before its gap closed. With several\n"
                                 "files the first of 1, 2, 3, 4 that occurred.\n");
    brdffit_cli_say(brdffit_cli_text_string(&text));
    brdffit_cli_text_free(&text);
}

static void count_job(struct run *r, const struct cli_job *job, size_t index)
{
    r->exit_code = brdffit_cli_worse_exit(r->exit_code, brdffit_cli_job_exit(job));
    if (job->not_begun) {
        r->not_begun++;
    } else if (job->status != BRDFFIT_OK) {
        r->failed++;
        r->bad[index] = 1;
    } else if (job->result->certified) {
        r->certified++;
    } else {
        r->open++;
    }
}

/* Messages on standard error, the result on the output. 0 on success. */
static int publish(struct run *r, const struct cli_job *job)
{
    struct cli_text text = {0};
    const int fitted = job->status == BRDFFIT_OK && !job->not_begun;
    if (!fitted && !job->not_begun) {
        brdffit_cli_report_error(job->path, &job->error, job->table, job->system_error);
        brdffit_cli_say_skipped(job, &r->fitter);
    }
    if (job->table != NULL && !r->settings->quiet) {
        brdffit_cli_say_notes(job->path, job->table, r->settings->json || !fitted);
    }
    if (fitted && job->result->stop == BRDFFIT_STOP_CONTRADICTION) {
        brdffit_cli_tell("brdffit: %s: the proof contradicts the fit: an error in brdffit, nothing is proven\n",
                         job->path);
    }
    if (fitted && r->settings->json && !r->settings->quiet) {
        brdffit_cli_say_misfit(job);
    }
    if (r->settings->json) {
        brdffit_cli_json_fit(&text, job, &r->fitter);
    } else if (fitted && !r->settings->quiet) {
        if (r->reports++ > 0) {
            brdffit_cli_text_puts(&text, "\n");
        }
        brdffit_cli_report_fit(&text, r->style, job, &r->fitter);
        brdffit_cli_report_lobes(&text, r->style, job, &r->fitter);
    }
    const int failed = brdffit_cli_output_write(&r->output, &text);
    brdffit_cli_text_free(&text);
    return failed;
}

/* 0 when every result was written. */
static int fit_files(struct run *r)
{
    for (size_t i = 0; i < r->settings->file_count; i++) {
        const char *path = r->settings->files[i];
        struct cli_job job;
        memset(&job, 0, sizeof job);
        job.path = path;
        if (brdffit_cli_interrupted()) {
            job.not_begun = 1;
        } else {
            brdffit_cli_progress_file(&r->progress, i, path);
            (r->settings->lobes_auto ? brdffit_cli_job_run_auto : brdffit_cli_job_run)(&job, &r->fitter, path);
        }
        job.position = brdffit_cli_shard_position(&r->shard, i);
        brdffit_cli_progress_erase(&r->progress);
        count_job(r, &job, i);
        const int failed = publish(r, &job);
        brdffit_cli_job_free(&job);
        if (failed) {
            return -1;
        }
    }
    return 0;
}

static void summary(const struct run *r)
{
    if (r->not_begun > 0) {
        brdffit_cli_tell("brdffit: interrupted; %zu file%s not begun\n", r->not_begun,
                         r->not_begun == 1 ? " was" : "s were");
    }
    if (r->settings->json || r->settings->quiet || r->settings->file_count < 2) {
        return;
    }
    const struct cli_style style = brdffit_cli_style(stderr);
    struct cli_text text = {0};
    brdffit_cli_text_printf(&text, "%zu files: %zu certified, %zu open, %zu failed", r->settings->file_count,
                            r->certified, r->open, r->failed);
    const char *separator = " (";
    for (size_t i = 0; i < r->settings->file_count; i++) {
        if (!r->bad[i]) {
            continue;
        }
        brdffit_cli_text_puts(&text, separator);
        brdffit_cli_name(&text, style, r->settings->files[i]);
        separator = ", ";
    }
    brdffit_cli_tell("brdffit: %s%s\n", brdffit_cli_text_string(&text), r->failed ? ")" : "");
    brdffit_cli_text_free(&text);
}

/* The settings are fine; open, fit, close. */
static int run_fit(struct run *r)
{
    const int code = brdffit_cli_fitter_init(&r->fitter, r->settings);
    if (code != 0) {
        return code;
    }
    if (r->settings->shard != NULL) {
        if (brdffit_cli_shard_take(&r->shard, r->settings, &r->fitter.options, r->fitter.io.directions) != 0) {
            return brdffit_cli_no_memory();
        }
        r->fitter.shard = &r->shard;
    }
    r->bad = calloc(r->settings->file_count + 1, 1);
    if (r->bad == NULL) {
        return brdffit_cli_no_memory();
    }
    if (brdffit_cli_output_open(&r->output, r->settings->output) != 0) {
        return CLI_EXIT_FAILURE;
    }
    r->style = brdffit_cli_style(r->output.file);
    brdffit_cli_progress_start(&r->progress, r->settings->file_count, r->settings->quiet);
    r->fitter.progress = &r->progress;
    brdffit_cli_cancel_on_interrupt();
    if (fit_files(r) != 0) {
        brdffit_cli_output_abandon(&r->output);
        return CLI_EXIT_FAILURE;
    }
    r->output.may_be_empty = r->settings->json; /* a part (--shard) without files */
    if (brdffit_cli_output_commit(&r->output) != 0) {
        return CLI_EXIT_FAILURE;
    }
    summary(r);
    return r->exit_code;
}

int brdffit_cli_fit(int argc, char **argv)
{
    struct cli_settings settings;
    const enum cli_parse answer = brdffit_cli_parse(CLI_FIT, "fit", argc, argv, &settings);
    int code = answer == CLI_PARSE_NO_MEMORY ? CLI_EXIT_FAILURE : CLI_EXIT_USAGE;
    if (answer == CLI_PARSED_HELP) {
        brdffit_cli_fit_help();
        code = 0;
    } else if (answer == CLI_PARSED) {
        struct run r;
        memset(&r, 0, sizeof r);
        r.settings = &settings;
        code = run_fit(&r);
        brdffit_cli_fitter_free(&r.fitter);
        free(r.bad);
    }
    brdffit_cli_settings_free(&settings);
    return code;
}
