/* failure.h: exit codes, and errors in words. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_FAILURE_H
#define BRDFFIT_CLI_FAILURE_H

#include "brdffit.h"
#include "brdffit_io.h"
#include "term.h"

enum {
    CLI_EXIT_CERTIFIED = 0,
    CLI_EXIT_FAILURE = 1, /* cannot open, read or write; out of memory; a contradiction */
    CLI_EXIT_USAGE = 2,
    CLI_EXIT_DATA = 3, /* the file's content cannot be used */
    CLI_EXIT_OPEN = 4  /* stopped before the gap closed */
};

/* The code that several files end with: the worst, 1 > 2 > 3 > 4 > 0. */
int brdffit_cli_worse_exit(int a, int b);

int brdffit_cli_status_exit(brdffit_status status);

/* snake_case name of a status for JSON: "no_samples", "format", ... */
const char *brdffit_cli_status_name(brdffit_status status);

/* The error's own words, or its status's when it has none. */
const char *brdffit_cli_message(const brdffit_error *error);

/* 1 when the value is one that the error is about. */
int brdffit_cli_has_value(const brdffit_error *error);

/* Line of the text file that an error is at: the reader's, or that of its
 * sample. BRDFFIT_NONE when there is none. */
size_t brdffit_cli_error_line(const brdffit_error *error, const brdffit_table *table);

/* Room for the text of the field that a reader's error is about: brdffit_cli_describe() adds it. Readers empty it. */
char *brdffit_cli_fault(size_t *size);

/* "line 12, field 6 (channel g), sample 11: value is not a number: nan".
 * Everything counts from 1. `table` may be NULL. */
void brdffit_cli_describe(struct cli_text *text, struct cli_style style, const brdffit_error *error,
                          const brdffit_table *table);

/* "brdffit: PATH: ..." on standard error. `system_error` (an errno) is added
 * when it says why a file could not be opened or read; 0: nothing. */
void brdffit_cli_report_error(const char *path, const brdffit_error *error, const brdffit_table *table,
                              int system_error);

/* "brdffit: out of memory" on standard error; returns CLI_EXIT_FAILURE. */
int brdffit_cli_no_memory(void);

#endif
