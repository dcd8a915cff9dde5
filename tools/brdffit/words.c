/* words.c: what a result means, in words. SPDX-License-Identifier: MIT */
#include "words.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "lobes.h"

const char *brdffit_cli_warning_name(unsigned bit)
{
    switch (bit) {
    case BRDFFIT_WARN_UNRESOLVED: return "unresolved";
    case BRDFFIT_WARN_FLAT: return "flat";
    case BRDFFIT_WARN_UNUSED: return "unused";
    case BRDFFIT_WARN_AT_LIMIT: return "at_limit";
    default: return "unknown";
    }
}

const char *brdffit_cli_objective(struct cli_style style, brdffit_norm norm)
{
    if (norm == BRDFFIT_NORM_L1) {
        return "sum of absolute residuals";
    }
    if (norm == BRDFFIT_NORM_LINF) {
        return "maximum absolute residual";
    }
    return style.utf8 ? "E²" : "E^2";
}

void brdffit_cli_grouped(struct cli_text *text, size_t number)
{
    if (number >= 1000) {
        brdffit_cli_grouped(text, number / 1000);
        brdffit_cli_text_printf(text, ",%03zu", number % 1000);
    } else {
        brdffit_cli_text_printf(text, "%zu", number);
    }
}

void brdffit_cli_duration(struct cli_text *text, double seconds)
{
    if (!(seconds >= 0.00995)) {
        brdffit_cli_text_printf(text, "%.2g\tms", 1e3 * seconds);
    } else if (seconds < 0.9995) {
        brdffit_cli_text_printf(text, "%.0f\tms", 1e3 * seconds);
    } else if (seconds < 99.5) {
        brdffit_cli_text_printf(text, "%.3g\ts", seconds);
    } else {
        brdffit_cli_text_printf(text, "%.0f\ts", seconds);
    }
}

void brdffit_cli_directed(struct cli_text *text, double value, int digits, int up)
{
    char shown[64];
    double shifted = value;
    for (int attempt = 0; attempt < 4; attempt++) {
        (void)snprintf(shown, sizeof shown, "%.*g", digits, shifted);
        const double back = strtod(shown, NULL);
        if (up ? back >= value : back <= value) {
            break;
        }
        /* One unit of the last digit, on the side that is wanted. */
        const double unit = pow(10, floor(log10(fabs(value))) + 1 - digits);
        shifted = back + (up ? unit : -unit);
    }
    brdffit_cli_text_puts(text, shown);
}

/* ---- Certificate ------------------------------------------------------- */

/* Digits that show the two apart, and at least five. */
static int telling_digits(double low, double high)
{
    if (!(low > 0 && high > low)) {
        return 6;
    }
    const double digits = 2 - floor(log10(high / low - 1));
    return digits < 5 ? 5 : digits > 17 ? 17 : (int)digits;
}

/* " (0.003 % above)" */
static void add_above(struct cli_text *text, const brdffit_result *result)
{
    if (!(result->lower_bound > 0)) {
        return;
    }
    const double above = 100 * (result->e2 / result->lower_bound - 1);
    if (above > 0) {
        brdffit_cli_text_puts(text, " (");
        brdffit_cli_directed(text, above, 2, 1);
        brdffit_cli_text_puts(text, "\t%\tabove)");
    } else {
        brdffit_cli_text_puts(text, " (the same to rounding)");
    }
}

/* The noun in a sentence: "has E² below", "has a sum of absolute residuals below". */
static const char *article(brdffit_norm norm)
{
    return norm == BRDFFIT_NORM_L2 ? "" : "a ";
}

static void exact(struct cli_text *text, struct cli_style style, const brdffit_options *options)
{
    brdffit_cli_text_printf(text, "this fit is exact, %s%s is 0.", options->norm == BRDFFIT_NORM_L2 ? "" : "its ",
                            brdffit_cli_objective(style, options->norm));
}

static void proven_relative(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                            const brdffit_options *options)
{
    const int digits = telling_digits(result->lower_bound, result->e2);
    if (!(result->e2 > 0)) {
        exact(text, style, options);
        return;
    }
    brdffit_cli_text_puts(text, "no ");
    brdffit_cli_family(text, style, result, options);
    brdffit_cli_text_printf(text, " has %s%s below ", article(options->norm),
                            brdffit_cli_objective(style, options->norm));
    brdffit_cli_directed(text, result->lower_bound, digits, 0);
    brdffit_cli_text_puts(text, "; this one has ");
    brdffit_cli_directed(text, result->e2, digits, 1);
    add_above(text, result);
    brdffit_cli_text_puts(text, ".");
}

static void proven_absolute(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                            const brdffit_options *options)
{
    const int squares = options->norm == BRDFFIT_NORM_L2;
    if (!(result->e2 > 0 && result->sum_of_squares > 0)) {
        exact(text, style, options);
        return;
    }
    const double share = result->gap / result->sum_of_squares;
    brdffit_cli_text_printf(text, "%s%s is ", squares ? "" : "the ", brdffit_cli_objective(style, options->norm));
    brdffit_cli_directed(text, result->e2, 3, 1);
    brdffit_cli_text_printf(text, ", the data's %s %.6g", squares ? "sum of squares" : "own", result->sum_of_squares);
    if (result->e2 <= (squares ? 1e-20 : 1e-12) * result->sum_of_squares) {
        brdffit_cli_text_puts(text, ": zero to rounding");
    }
    if (share > 0) {
        brdffit_cli_text_puts(text, "; no ");
        brdffit_cli_family(text, style, result, options);
        brdffit_cli_text_puts(text, " can lower it by more than ");
        brdffit_cli_directed(text, share, 2, 1);
        brdffit_cli_text_puts(text, options->norm == BRDFFIT_NORM_LINF ? " of that" : " of that sum");
    }
    brdffit_cli_text_puts(text, ".");
}

static void add_stop(struct cli_text *text, const brdffit_result *result, const brdffit_options *options)
{
    switch (result->stop) {
    case BRDFFIT_STOP_RESOLUTION:
        brdffit_cli_text_printf(text, "every box left is narrower than --resolution %.6g", options->sigma_resolution);
        return;
    case BRDFFIT_STOP_ROUNDING:
        brdffit_cli_text_puts(text, "what is left of the gap is rounding of double precision");
        return;
    case BRDFFIT_STOP_BUDGET:
        brdffit_cli_text_puts(text, "the box budget of ");
        brdffit_cli_grouped(text, options->box_budget);
        brdffit_cli_text_puts(text, " was used up");
        return;
    case BRDFFIT_STOP_MEMORY: brdffit_cli_text_puts(text, "its memory was full"); return;
    case BRDFFIT_STOP_CANCELLED: brdffit_cli_text_puts(text, "it was interrupted"); return;
    default: brdffit_cli_text_puts(text, brdffit_stop_string(result->stop)); return;
    }
}

static const char *advice(brdffit_stop stop)
{
    switch (stop) {
    case BRDFFIT_STOP_RESOLUTION: return " Lower --resolution to close the gap.";
    case BRDFFIT_STOP_ROUNDING: return " A larger --gap can be proven.";
    case BRDFFIT_STOP_BUDGET: return " Raise --box-budget to close the gap.";
    default: return "";
    }
}

static void not_proven(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                       const brdffit_options *options)
{
    const int digits = telling_digits(result->lower_bound, result->e2);
    brdffit_cli_text_puts(text, "the search stopped because ");
    add_stop(text, result, options);
    brdffit_cli_text_printf(text, ". The smallest %s of any ", brdffit_cli_objective(style, options->norm));
    brdffit_cli_family(text, style, result, options);
    brdffit_cli_text_puts(text, " lies between ");
    brdffit_cli_directed(text, result->lower_bound, digits, 0);
    brdffit_cli_text_puts(text, " and this fit's ");
    brdffit_cli_directed(text, result->e2, digits, 1);
    add_above(text, result);
    brdffit_cli_text_puts(text, ".");
    brdffit_cli_text_puts(text, advice(result->stop));
}

static void contradiction(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                          const brdffit_options *options)
{
    brdffit_cli_text_printf(text,
                            "the bound came out above this fit's own %s, %.6g. Neither can be trusted: this is an"
                            " error in brdffit. Please report it, with the file and the options.",
                            brdffit_cli_objective(style, options->norm), result->e2);
}

void brdffit_cli_certificate(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                             const brdffit_options *options)
{
    struct cli_text words = {0};
    if (result->stop == BRDFFIT_STOP_CONTRADICTION) {
        contradiction(&words, style, result, options);
    } else if (!result->certified) {
        not_proven(&words, style, result, options);
    } else if (result->stop == BRDFFIT_STOP_ABSOLUTE_GAP) {
        proven_absolute(&words, style, result, options);
    } else {
        proven_relative(&words, style, result, options);
    }
    if (result->stop != BRDFFIT_STOP_CONTRADICTION) {
        brdffit_cli_cut(&words, style, result, options);
    }
    if (result->stop == BRDFFIT_STOP_CONTRADICTION) {
        brdffit_cli_paragraph(text, style, CLI_RED,
                              "CONTRADICTION, nothing is proven:", brdffit_cli_text_string(&words));
    } else if (result->certified) {
        brdffit_cli_paragraph(text, style, CLI_GREEN, "Proven:", brdffit_cli_text_string(&words));
    } else {
        brdffit_cli_paragraph(text, style, CLI_YELLOW, "NOT proven:", brdffit_cli_text_string(&words));
    }
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

/* ---- Warnings ---------------------------------------------------------- */

/* "σ sits on the lower end of the range searched; lower --sigma-min." */
static void add_at_limit(struct cli_text *words, struct cli_style style, const brdffit_lobe *lobe,
                         brdffit_distribution distribution, const brdffit_options *options)
{
    const char *name = brdffit_parameter_string(distribution);
    const int by_exponent = brdffit_cli_by_exponent(distribution);
    const double value = by_exponent ? lobe->exponent : lobe->sigma;
    const double low = by_exponent ? options->exponent_min : options->sigma_min;
    const double high = by_exponent ? options->exponent_max : options->sigma_max;
    const char *parameter = brdffit_cli_parameter(style, distribution);
    if (value - low < high - value) {
        brdffit_cli_text_printf(words,
                                "%s sits on the lower end of the range searched; lower "
                                "--%s-min.",
                                parameter, name);
    } else {
        brdffit_cli_text_printf(words,
                                "%s sits on the upper end of the range searched; raise "
                                "--%s-max.",
                                parameter, name);
    }
}

static void add_warning(struct cli_text *words, struct cli_style style, const brdffit_result *result, int p,
                        unsigned bit, const brdffit_options *options)
{
    const brdffit_lobe *const lobe = result->lobe[p];
    const brdffit_distribution distribution = result->model->distributions[p];
    const int by_exponent = brdffit_cli_by_exponent(distribution);
    switch (bit) {
    case BRDFFIT_WARN_UNRESOLVED:
        brdffit_cli_text_puts(words, "rests on no more than ");
        brdffit_cli_directed(words, lobe->effective_samples, 2, 1);
        brdffit_cli_text_puts(words, " effective samples: these directions do not resolve it, and "
                                     "it is a fit to single samples.");
        break;
    case BRDFFIT_WARN_FLAT:
        brdffit_cli_text_printf(words,
                                "the data cannot tell %s inside [%.6g,\t%.6g]: any value there fits "
                                "as well.",
                                brdffit_cli_parameter(style, distribution),
                                by_exponent ? lobe->exponent_low : lobe->sigma_low,
                                by_exponent ? lobe->exponent_high : lobe->sigma_high);
        break;
    case BRDFFIT_WARN_UNUSED:
        brdffit_cli_text_printf(words, "its coefficient is 0 in every channel: %s.",
                                result->model->lobes == 1 ? "the data show no such lobe"
                                                          : "one lobe fewer fits as well");
        break;
    case BRDFFIT_WARN_AT_LIMIT: add_at_limit(words, style, lobe, distribution, options); break;
    default: brdffit_cli_text_printf(words, "warning %u.", bit); break;
    }
}

void brdffit_cli_warnings(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                          const brdffit_options *options)
{
    for (int p = 0; p < result->model->lobes; p++) {
        const brdffit_lobe *const lobe = result->lobe[p];
        for (unsigned bit = 1; bit != 0 && bit <= lobe->warnings; bit <<= 1) {
            /* Of a lobe that is not there nothing else is worth saying. */
            if (!(lobe->warnings & bit) || (bit != BRDFFIT_WARN_UNUSED && (lobe->warnings & BRDFFIT_WARN_UNUSED))) {
                continue;
            }
            struct cli_text words = {0};
            brdffit_cli_text_printf(&words, "lobe %d: ", p + 1);
            add_warning(&words, style, result, p, bit, options);
            brdffit_cli_paragraph(text, style, CLI_YELLOW, "Warning,", brdffit_cli_text_string(&words));
            text->failed |= words.failed;
            brdffit_cli_text_free(&words);
        }
    }
}

/* ---- Samples that were not used ---------------------------------------- */

static void add_reason(struct cli_text *text, size_t *total, size_t count, const char *words)
{
    if (count == 0) {
        return;
    }
    if (*total > 0) {
        brdffit_cli_text_puts(text, ", ");
    }
    brdffit_cli_grouped(text, count);
    brdffit_cli_text_printf(text, " %s", words);
    *total += count;
}

size_t brdffit_cli_skipped(struct cli_text *text, struct cli_style style, const size_t *skipped,
                           const brdffit_table *table, double max_incidence)
{
    size_t total = 0;
    char incidence[80];
    (void)snprintf(incidence, sizeof incidence, "lit from beyond %.6g%s", max_incidence,
                   brdffit_cli_glyph(style, CLI_DEGREE));
    add_reason(text, &total, skipped[BRDFFIT_SKIP_INCIDENCE], incidence);
    add_reason(text, &total, skipped[BRDFFIT_SKIP_LIGHT_BELOW_HORIZON], "with the light below the horizon");
    add_reason(text, &total, skipped[BRDFFIT_SKIP_VIEW_BELOW_HORIZON], "with the viewer below the horizon");
    add_reason(text, &total, skipped[BRDFFIT_SKIP_ZERO_WEIGHT], "of weight 0");
    add_reason(text, &total, table->dropped[BRDFFIT_IO_DROP_MASKED], "masked (not measured)");
    add_reason(text, &total, table->dropped[BRDFFIT_IO_DROP_ABSENT], "without a value");
    add_reason(text, &total, table->dropped[BRDFFIT_IO_DROP_SATURATED], "saturated");
    add_reason(text, &total, table->dropped[BRDFFIT_IO_DROP_BELOW_HORIZON], "cells beyond the hemisphere");
    return total;
}
