/* compare_report.c: a comparison as a table, a line a model, best first.
 * SPDX-License-Identifier: MIT */
#include "compare.h"

#include <math.h>
#include <stdio.h>

#include "lobes.h"
#include "report.h"
#include "words.h"

/* Widths of the columns; with two of indentation and a mark, 100 in all. The first two share BOTH: see widths_of(). */
enum { MODEL = 21, BOTH = 42, COUNT = 3, RMS = 9, R2 = 9, DELTA = 8, TIME = 9 };

struct widths {
    int model, shape;
    int digits; /* of sigma */
};

/* "0.1198 0.4505", "n=102", "0.16 n=23": n where the number is not sigma. */
static void add_shape(struct cli_text *text, const struct cli_entry *entry, int digits)
{
    for (int p = 0; p < entry->model->lobes; p++) {
        const int by_exponent = brdffit_cli_by_exponent(entry->model->distributions[p]);
        brdffit_cli_text_printf(text, "%s%s%.*g", p > 0 ? " " : "", by_exponent ? "n=" : "", by_exponent ? 3 : digits,
                                entry->shape[p]);
    }
}

static int longer(int width, struct cli_text *text)
{
    const int size = (int)text->size + 1;
    brdffit_cli_text_free(text);
    return size > width ? size : width;
}

/* What titles and roughnesses need. */
static struct widths needed(const struct cli_comparison *c, int digits)
{
    struct widths w = {MODEL, 0, digits};
    for (size_t i = 0; i < c->count; i++) {
        struct cli_text title = {0}, shape = {0};
        brdffit_cli_add_model(&title, c->entries[i].model);
        if (!c->entries[i].not_begun && c->entries[i].status == BRDFFIT_OK) {
            add_shape(&shape, &c->entries[i], digits);
        }
        w.model = longer(w.model, &title);
        w.shape = longer(w.shape, &shape);
    }
    return w;
}

/* Long titles take what roughnesses leave, with a digit less if need be; what is longer still is cut. */
static struct widths widths_of(const struct cli_comparison *c)
{
    struct widths w = needed(c, 4);
    if (w.model + w.shape > BOTH) {
        w = needed(c, 3);
    }
    if (w.model + w.shape > BOTH) {
        w.model = BOTH - w.shape > MODEL ? BOTH - w.shape : MODEL;
    }
    w.shape = BOTH - w.model;
    return w;
}

/* `string` in a column to the left, cut where it is longer; its last blank is the gap to the next. */
static void left_cell(struct cli_text *text, struct cli_style style, const char *string, int width)
{
    struct cli_text cut = {0};
    brdffit_cli_text_printf(&cut, "%.*s", width - 1, string);
    brdffit_cli_cell(text, style, brdffit_cli_text_string(&cut), -width);
    text->failed |= cut.failed;
    brdffit_cli_text_free(&cut);
}

/* Of a criterion: a digit after the point, as long as there is room for it; rounded down where it is a claim. */
static void delta_cell(struct cli_text *text, struct cli_style style, int shown, double value, int down)
{
    struct cli_text number = {0};
    if (shown && fabs(value) < 9999.95) {
        brdffit_cli_text_printf(&number, "%.1f", down ? floor(value * 10) / 10 : value);
    } else if (shown && fabs(value) < 999999.5) {
        brdffit_cli_text_printf(&number, "%.0f", down ? floor(value) : value);
    } else if (shown) {
        brdffit_cli_directed(&number, value, 2, !down);
    }
    brdffit_cli_cell(text, style, brdffit_cli_text_string(&number), DELTA);
    text->failed |= number.failed;
    brdffit_cli_text_free(&number);
}

/* The criterion that did not decide: of BIC and AICc. */
static enum cli_criterion other(const struct cli_comparison *c)
{
    return c->criterion == CLI_BIC ? CLI_AICC : CLI_BIC;
}

static void delta_cells(struct cli_text *text, struct cli_style style, const struct cli_entry *entry,
                        const struct cli_comparison *c)
{
    const int ranked = entry->rank != CLI_RANK_UNRANKED;
    const double beside = ranked ? entry->fit.value[other(c)] - c->order[0]->fit.value[other(c)] : NAN;
    delta_cell(text, style, ranked, entry->delta, 0);
    delta_cell(text, style, ranked && entry->rank != CLI_RANK_BEST, entry->delta_proven, 1);
    delta_cell(text, style, !isnan(beside), beside, 0);
}

static void head(struct cli_text *text, struct cli_style style, const struct cli_comparison *c, struct widths widths,
                 const brdffit_options *options)
{
    char delta[16], beside[16];
    (void)snprintf(delta, sizeof delta, "d%s", brdffit_cli_criterion_title(c->criterion));
    (void)snprintf(beside, sizeof beside, "d%s", brdffit_cli_criterion_title(other(c)));
    brdffit_cli_text_puts(text, "\n    ");
    left_cell(text, style, "model", widths.model);
    brdffit_cli_cell(text, style, brdffit_cli_glyph(style, CLI_SIGMA), -widths.shape);
    brdffit_cli_cell(text, style, "p", COUNT);
    brdffit_cli_cell(text, style, options->normalise == BRDFFIT_NORMALISE_MAX ? "RMS %" : "RMS", RMS);
    brdffit_cli_cell(text, style, style.utf8 ? "R²" : "R^2", R2);
    brdffit_cli_cell(text, style, delta, DELTA);
    brdffit_cli_cell(text, style, "proven", DELTA);
    brdffit_cli_cell(text, style, beside, DELTA);
    brdffit_cli_cell(text, style, "time", TIME);
    brdffit_cli_text_puts(text, "\n");
}

static void time_cell(struct cli_text *text, struct cli_style style, double seconds)
{
    struct cli_text words = {0};
    brdffit_cli_duration(&words, seconds);
    for (size_t i = 0; i < words.size; i++) {
        words.data[i] = words.data[i] == '\t' ? ' ' : words.data[i];
    }
    brdffit_cli_cell(text, style, brdffit_cli_text_string(&words), TIME);
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

static void fitted_cells(struct cli_text *text, struct cli_style style, const struct cli_entry *entry,
                         const struct cli_comparison *c, struct widths widths, const brdffit_options *options)
{
    struct cli_text shape = {0};
    add_shape(&shape, entry, widths.digits);
    brdffit_cli_cell(text, style, brdffit_cli_text_string(&shape), -widths.shape);
    brdffit_cli_text_printf(text, "%*zu", COUNT, entry->parameters);
    brdffit_cli_number_cell(text, entry->rms_total * (options->normalise == BRDFFIT_NORMALISE_MAX ? 100 : 1), 3, RMS);
    if (isnan(entry->r2)) {
        brdffit_cli_cell(text, style, "", R2);
    } else {
        brdffit_cli_text_printf(text, "%*.6f", R2, entry->r2);
    }
    delta_cells(text, style, entry, c);
    time_cell(text, style, entry->seconds);
    text->failed |= shape.failed;
    brdffit_cli_text_free(&shape);
}

static void line(struct cli_text *text, struct cli_style style, const struct cli_entry *entry,
                 const struct cli_comparison *c, struct widths widths, const brdffit_options *options)
{
    static const char *const marks[] = {"* ", "= ", "? ", "  ", "  "};
    struct cli_text title = {0};
    brdffit_cli_add_model(&title, entry->model);
    brdffit_cli_text_printf(text, "  %s", marks[entry->rank]);
    left_cell(text, style, brdffit_cli_text_string(&title), widths.model);
    if (entry->not_begun) {
        brdffit_cli_text_puts(text, "interrupted before its turn");
    } else if (entry->status != BRDFFIT_OK) {
        brdffit_cli_text_printf(text, "not fitted: %s", entry->message);
    } else {
        fitted_cells(text, style, entry, c, widths, options);
    }
    brdffit_cli_text_puts(text, "\n");
    text->failed |= title.failed;
    brdffit_cli_text_free(&title);
}

/* "780 observations (3 channels)", and how many of them count. */
static void add_observations(struct cli_text *words, const struct cli_comparison *c)
{
    brdffit_cli_grouped(words, c->observations);
    brdffit_cli_text_printf(words, " observations (%zu\tchannel%s)", c->channels, c->channels == 1 ? "" : "s");
    if (c->effective < (double)c->observations) {
        brdffit_cli_text_puts(words, ", counted as ");
        brdffit_cli_grouped(words, (size_t)(c->effective + 0.5));
        brdffit_cli_text_puts(words, ": so many Gaussian residuals are as uneven");
    }
}

/* Why light is not limited, where it otherwise would be. */
static void add_incidence(struct cli_text *words, const struct cli_comparison *c, const brdffit_options *options)
{
    int fresnel = 0;
    for (size_t i = 0; i < c->count; i++) {
        fresnel |= c->entries[i].model->fresnel != BRDFFIT_FRESNEL_NONE;
    }
    if (fresnel && options->max_incidence >= 90) {
        brdffit_cli_text_puts(words,
                              " All forms are fitted to light from everywhere, as grazing light tells of Fresnel: "
                              "--max-incidence limits it.");
    }
}

static void legend(struct cli_text *text, struct cli_style style, const struct cli_comparison *c,
                   const brdffit_options *options)
{
    struct cli_text words = {0};
    const char *const criterion = brdffit_cli_criterion_title(c->criterion);
    brdffit_cli_text_printf(&words,
                            "* best by %s; = less than %g behind, which is no evidence to speak of; ? behind, but not "
                            "proven. p: parameters, on ",
                            criterion, c->threshold);
    add_observations(&words, c);
    brdffit_cli_text_printf(
        &words,
        ". RMS: of radiance, %s. d%s: from the best; proven: the least of any fit of that form, whatever its parameters.",
        options->normalise == BRDFFIT_NORMALISE_MAX ? "each channel by its largest" : "in the data's units", criterion);
    add_incidence(&words, c, options);
    brdffit_cli_text_puts(text, "\n");
    brdffit_cli_paragraph(text, style, CLI_BOLD, NULL, brdffit_cli_text_string(&words));
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

void brdffit_cli_compare_report(struct cli_text *text, struct cli_style style, const struct cli_comparison *c,
                                const struct cli_job *job, const brdffit_options *options)
{
    brdffit_cli_report_title(text, style, job, c->samples_used, c->skipped, options->max_incidence, "used");
    const struct widths widths = widths_of(c);
    head(text, style, c, widths, options);
    for (size_t i = 0; i < c->count; i++) {
        line(text, style, c->order[i], c, widths, options);
    }
    legend(text, style, c, options);
    brdffit_cli_text_puts(text, "\n");
    brdffit_cli_compare_words(text, style, c);
}
