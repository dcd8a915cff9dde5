/* reading.h: how a file is to be read, as options say it, and what its reading
 * found out. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_READING_H
#define BRDFFIT_CLI_READING_H

#include "json_write.h"
#include "settings.h"
#include "term.h"

/* What --values takes: the brdffit_quantity of that number, or beyond them
 * a brdffit_io_values that makes f_r of them. */
enum { CLI_VALUES_CCBRDF = 2, CLI_VALUES_REFLECTANCE_FACTOR = 3 };
extern const struct cli_choice brdffit_cli_values_choices[];

/* --missing and --directions hold words: 0, or -1 with the reason on stderr. */
int brdffit_cli_check_reading(const struct cli_settings *settings, const char *command);

/* Into the library's options, the room for a fault's text included. */
void brdffit_cli_reading_options(const struct cli_settings *settings, brdffit_io_options *options);

/* A line each of what was given: for runs that have to agree. */
void brdffit_cli_record_reading(struct cli_text *text, const struct cli_settings *settings);

/* "reading": what was given, so that eval reads alike; nothing without. */
void brdffit_cli_json_reading(struct cli_json *json, const struct cli_settings *settings);

/* "notes" and "data_warnings" of a table. */
void brdffit_cli_json_notes(struct cli_json *json, const brdffit_table *table);

/* On standard error: what was inferred; with `warnings` what looks wrong, too. */
void brdffit_cli_say_notes(const char *path, const brdffit_table *table, int warnings);

/* Paragraphs of what looks wrong; with `notes` of what was inferred, too. */
void brdffit_cli_note_paragraphs(struct cli_text *text, struct cli_style style, const brdffit_table *table, int notes);

#endif
