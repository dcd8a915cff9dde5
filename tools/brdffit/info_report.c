/* info_report.c: the answer of brdffit info. SPDX-License-Identifier: MIT */
#include "info_report.h"

#include "json_fit.h"
#include "json_write.h"
#include "reading.h"
#include "report.h"
#include "words.h"

#define NUMBER_WIDTH 13

/* ---- For people -------------------------------------------------------- */

static void add_format(struct cli_text *text, const brdffit_table *table)
{
    const int brdf = table->samples->quantity == BRDFFIT_QUANTITY_BRDF;
    if (table->format == BRDFFIT_IO_FORMAT_MERL) {
        brdffit_cli_text_printf(text,
                                "MERL table of %zu x %zu x %zu cells (half angle, difference "
                                "angle, azimuth)",
                                table->dims[0], table->dims[1], table->dims[2]);
        brdffit_cli_text_printf(text, ", read at bin %ss",
                                brdffit_cli_choice_name(brdffit_cli_bins_choices, (int)table->merl_bins));
    } else {
        brdffit_cli_text_puts(text, "table of ");
        brdffit_cli_grouped(text, table->rows);
        brdffit_cli_text_puts(text, table->rows == 1 ? " line" : " lines");
        brdffit_cli_text_puts(text,
                              table->samples->form == BRDFFIT_FORM_COEFFICIENTS ? " with a, b, c" : " with directions");
        if (table->samples->normal != NULL) {
            brdffit_cli_text_puts(text, " and normals");
        }
        if (table->samples->weights != NULL) {
            brdffit_cli_text_puts(text, " and weights");
        }
    }
    brdffit_cli_text_printf(text, "%s; values taken as %s", table->compressed ? ", gzip" : "",
                            brdf ? "f_r" : "radiance, f_r (n.l)");
}

static void channel_table(struct cli_text *text, struct cli_style style, const brdffit_table *table,
                          const struct cli_stats *stats)
{
    const int width = brdffit_cli_channel_width(style, table);
    if (table->samples->count == 0) {
        return;
    }
    brdffit_cli_text_puts(text, "\n  ");
    brdffit_cli_cell(text, style, "channel", -width);
    brdffit_cli_cell(text, style, "smallest", NUMBER_WIDTH);
    brdffit_cli_cell(text, style, "mean", NUMBER_WIDTH);
    brdffit_cli_cell(text, style, "largest", NUMBER_WIDTH);
    brdffit_cli_cell(text, style, "negative", NUMBER_WIDTH);
    brdffit_cli_text_puts(text, "\n");
    for (size_t k = 0; k < table->samples->channels; k++) {
        const struct cli_channel_stats *const channel = &stats->channel[k];
        brdffit_cli_text_puts(text, "  ");
        brdffit_cli_channel_cell(text, style, table, k, width);
        brdffit_cli_number_cell(text, channel->low, 5, NUMBER_WIDTH);
        brdffit_cli_number_cell(text, channel->mean, 5, NUMBER_WIDTH);
        brdffit_cli_number_cell(text, channel->high, 5, NUMBER_WIDTH);
        brdffit_cli_text_printf(text, "%*zu\n", NUMBER_WIDTH, channel->negative);
    }
    brdffit_cli_text_puts(text, "\n");
}

/* Degrees, without the rounding that cosines leave behind. */
static double tidy(double degrees)
{
    return degrees < 1e-7 ? 0 : degrees;
}

static void add_range(struct cli_text *text, struct cli_style style, const char *what, const struct cli_range *range)
{
    if (!(range->low <= range->high)) {
        return;
    }
    const char *degree = brdffit_cli_glyph(style, CLI_DEGREE);
    brdffit_cli_text_printf(text, "%s %.4g%s to %.4g%s, ", what, tidy(range->low), degree, tidy(range->high), degree);
}

static void add_resolution(struct cli_text *text, struct cli_style style, const struct cli_stats *stats)
{
    const char *sigma = brdffit_cli_glyph(style, CLI_SIGMA);
    const char *degree = brdffit_cli_glyph(style, CLI_DEGREE);
    if (stats->distinct < 3) {
        brdffit_cli_text_puts(text, "With fewer than three distinct half angles no roughness can be "
                                    "told from another.");
        return;
    }
    brdffit_cli_text_printf(text,
                            "The smallest half angles are %.4g%s, %.4g%s and %.4g%s: a lobe with %s "
                            "below about %.2g reaches fewer than three of them, and these "
                            "directions do not resolve it.",
                            tidy(stats->smallest[0]), degree, tidy(stats->smallest[1]), degree,
                            tidy(stats->smallest[2]), degree, sigma, brdffit_cli_resolved_sigma(stats));
}

void brdffit_cli_info_report(struct cli_text *text, struct cli_style style, const struct cli_job *job,
                             const struct cli_fitter *fitter, const struct cli_stats *stats)
{
    struct cli_text words = {0};
    brdffit_cli_report_title(text, style, job, stats->used, stats->skipped, fitter->options.max_incidence,
                             "would be used");
    add_format(&words, job->table);
    brdffit_cli_paragraph(text, style, CLI_BOLD, "Format:", brdffit_cli_text_string(&words));
    brdffit_cli_note_paragraphs(text, style, job->table, 1);
    channel_table(text, style, job->table, stats);
    brdffit_cli_text_clear(&words);
    if (stats->used > 0) {
        add_range(&words, style, "light", &stats->incidence);
        add_range(&words, style, "view", &stats->view);
        add_range(&words, style, "half angle", &stats->half);
        brdffit_cli_grouped(&words, stats->distinct);
        brdffit_cli_text_puts(&words, " distinct. ");
        add_resolution(&words, style, stats);
    } else {
        brdffit_cli_text_puts(&words, "nothing would be left to fit.");
    }
    brdffit_cli_paragraph(text, style, CLI_BOLD, "Used:", brdffit_cli_text_string(&words));
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

/* ---- JSON -------------------------------------------------------------- */

static void json_range(struct cli_json *json, const char *key, const struct cli_range *range)
{
    const double ends[2] = {range->low, range->high};
    if (range->low <= range->high) {
        brdffit_cli_json_numbers(json, key, ends, 2);
    } else {
        brdffit_cli_json_null(json, key);
    }
}

static void json_channels(struct cli_json *json, const brdffit_table *table, const struct cli_stats *stats)
{
    static const char *const names[] = {"minimum", "mean", "maximum"};
    brdffit_cli_json_channels(json, table);
    for (int which = 0; which < 3; which++) {
        brdffit_cli_json_open(json, names[which], '[');
        for (size_t k = 0; k < table->samples->channels; k++) {
            const struct cli_channel_stats *const c = &stats->channel[k];
            const double value = which == 0 ? c->low : which == 1 ? c->mean : c->high;
            brdffit_cli_json_number(json, NULL, value);
        }
        brdffit_cli_json_close(json, ']');
    }
    brdffit_cli_json_open(json, "negative", '[');
    for (size_t k = 0; k < table->samples->channels; k++) {
        brdffit_cli_json_count(json, NULL, stats->channel[k].negative);
    }
    brdffit_cli_json_close(json, ']');
}

static void json_content(struct cli_json *json, const struct cli_job *job, const struct cli_fitter *fitter,
                         const struct cli_stats *stats)
{
    static const char *const forms[] = {"directions", "angles", "coefficients"};
    const brdffit_table *const table = job->table;
    brdffit_cli_json_source(json, job, fitter->settings);
    brdffit_cli_json_notes(json, table);
    brdffit_cli_json_string(json, "form", forms[table->samples->form]);
    brdffit_cli_json_count(json, "compressed", table->compressed != 0);
    brdffit_cli_json_count(json, "rows", table->rows);
    if (table->format == BRDFFIT_IO_FORMAT_MERL) {
        brdffit_cli_json_open(json, "dims", '[');
        for (int i = 0; i < 3; i++) {
            brdffit_cli_json_count(json, NULL, table->dims[i]);
        }
        brdffit_cli_json_close(json, ']');
    } else {
        brdffit_cli_json_null(json, "dims");
    }
    json_channels(json, table, stats);
    brdffit_cli_json_number(json, "max_incidence", fitter->options.max_incidence);
    brdffit_cli_json_count(json, "samples_used", stats->used);
    brdffit_cli_json_skipped(json, stats->skipped, table);
    json_range(json, "incidence_range", &stats->incidence);
    json_range(json, "view_range", &stats->view);
    json_range(json, "half_angle_range", &stats->half);
    brdffit_cli_json_count(json, "distinct_half_angles", stats->distinct);
    brdffit_cli_json_number(json, "resolved_sigma", brdffit_cli_resolved_sigma(stats));
}

void brdffit_cli_info_json(struct cli_text *text, const struct cli_job *job, const struct cli_fitter *fitter,
                           const struct cli_stats *stats)
{
    struct cli_json json = {text, 0};
    brdffit_cli_json_open(&json, NULL, '{');
    brdffit_cli_json_string(&json, "schema", "brdffit.info/1");
    brdffit_cli_json_path(&json, job->path);
    brdffit_cli_json_string(&json, "status", stats == NULL ? "error" : "ok");
    if (stats == NULL) {
        brdffit_cli_json_error(&json, job);
    } else {
        json_content(&json, job, fitter, stats);
    }
    brdffit_cli_json_close(&json, '}');
    brdffit_cli_text_puts(text, "\n");
}
