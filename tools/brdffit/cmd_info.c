/* cmd_info.c: brdffit info. SPDX-License-Identifier: MIT */
#include "commands.h"

#include <stdio.h>
#include <string.h>

#include "failure.h"
#include "info_report.h"
#include "output.h"

/* The words that names of columns are made of: the reader's own. */
static void add_words(struct cli_text *text)
{
    const struct cli_style plain = {0, 0};
    const char *what = NULL;
    brdffit_cli_text_puts(
        text, "\nNames of a text's columns are made of these words, whatever their case and\npunctuation:\n");
    for (size_t i = 0; brdffit_io_column_words(i, &what) != NULL; i++) {
        struct cli_text line = {0};
        brdffit_cli_text_printf(&line, "%s: %s", what, brdffit_io_column_words(i, &what));
        brdffit_cli_paragraph(text, plain, CLI_BOLD, NULL, brdffit_cli_text_string(&line));
        brdffit_cli_text_free(&line);
    }
}

void brdffit_cli_info_help(void)
{
    struct cli_text text = {0};
    brdffit_cli_text_puts(&text, "Usage: brdffit info FILE... [options]\n"
                                 "\n"
                                 "Say what is in each FILE, what a fit would use of it, what it would skip\n"
                                 "and why, and how narrow a lobe its directions can resolve.\n"
                                 "\n");
    brdffit_cli_option_help(&text, CLI_INFO);
    add_words(&text);
    brdffit_cli_text_puts(&text, "\n"
                                 "Exit status: 0 done; 1 a file cannot be read or written, or memory ran\n"
                                 "out; 2 wrong usage; 3 a file's data cannot be used. With several files\n"
                                 "the first of 1, 2, 3 that occurred.\n");
    brdffit_cli_say(brdffit_cli_text_string(&text));
    brdffit_cli_text_free(&text);
}

/* Inspect one file into `text`. Returns its exit code. */
static int inspect(struct cli_text *text, struct cli_style style, struct cli_fitter *fitter, const char *path,
                   int first)
{
    struct cli_job job;
    struct cli_stats stats;
    brdffit_cli_job_read(&job, fitter, path);
    if (job.status == BRDFFIT_OK) {
        job.status = brdffit_cli_stats(job.table, &fitter->options, &stats, &job.error);
    }
    const int ok = job.status == BRDFFIT_OK;
    const int code = brdffit_cli_status_exit(job.status);
    if (!ok) {
        brdffit_cli_report_error(path, &job.error, job.table, job.system_error);
    }
    if (fitter->settings->json) {
        brdffit_cli_info_json(text, &job, fitter, ok ? &stats : NULL);
    } else if (ok && !fitter->settings->quiet) {
        brdffit_cli_text_puts(text, first ? "" : "\n");
        brdffit_cli_info_report(text, style, &job, fitter, &stats);
    }
    if (ok) {
        brdffit_cli_stats_free(&stats);
    }
    brdffit_cli_job_free(&job);
    return code;
}

static int run_info(const struct cli_settings *settings, struct cli_fitter *fitter)
{
    struct cli_output output;
    struct cli_text text = {0};
    int code = brdffit_cli_fitter_init(fitter, settings);
    if (code != 0) {
        return code;
    }
    if (brdffit_cli_output_open(&output, settings->output) != 0) {
        return CLI_EXIT_FAILURE;
    }
    const struct cli_style style = brdffit_cli_style(output.file);
    int printed = 0;
    for (size_t i = 0; i < settings->file_count; i++) {
        brdffit_cli_text_clear(&text);
        const int one = inspect(&text, style, fitter, settings->files[i], printed == 0);
        code = brdffit_cli_worse_exit(code, one);
        printed |= text.size > 0;
        if (brdffit_cli_output_write(&output, &text) != 0) {
            brdffit_cli_output_abandon(&output);
            brdffit_cli_text_free(&text);
            return CLI_EXIT_FAILURE;
        }
    }
    brdffit_cli_text_free(&text);
    return brdffit_cli_output_commit(&output) != 0 ? CLI_EXIT_FAILURE : code;
}

int brdffit_cli_info(int argc, char **argv)
{
    struct cli_settings settings;
    const enum cli_parse answer = brdffit_cli_parse(CLI_INFO, "info", argc, argv, &settings);
    int code = answer == CLI_PARSE_NO_MEMORY ? CLI_EXIT_FAILURE : CLI_EXIT_USAGE;
    if (answer == CLI_PARSED_HELP) {
        brdffit_cli_info_help();
        code = 0;
    } else if (answer == CLI_PARSED) {
        struct cli_fitter fitter;
        code = run_info(&settings, &fitter);
        brdffit_cli_fitter_free(&fitter);
    }
    brdffit_cli_settings_free(&settings);
    return code;
}
