/* family.c: which models a proof is about, in words. SPDX-License-Identifier: MIT */
#include "words.h"

#include <math.h>

#include "lobes.h"
#include "terms.h"

int brdffit_cli_proven(const brdffit_result *result, const brdffit_options *options, int exponent, double range[2])
{
    const double least = exponent ? 1 / sqrt(options->exponent_max) : options->sigma_min;
    double floor = least;
    for (int p = 0; p < result->model->lobes; p++) {
        const double of_lobe = result->lobe[p]->sigma_floor;
        if (brdffit_cli_by_exponent(result->model->distributions[p]) == exponent && of_lobe > floor &&
            isfinite(of_lobe)) {
            floor = of_lobe;
        }
    }
    const int cut = floor > least;
    range[0] = exponent ? options->exponent_min : floor;
    range[1] = !exponent ? options->sigma_max : cut ? (1 - 1e-15) / (floor * floor) : options->exponent_max;
    return cut;
}

/* Whether any lobe is left at all. */
static int any_lobe(const brdffit_result *result)
{
    int any = 0;
    for (int p = 0; p < result->model->lobes; p++) {
        any |= isfinite(result->lobe[p]->sigma_floor);
    }
    return any;
}

/* An end that is not what was asked for is rounded, so that what is said stays true. */
static void add_end(struct cli_text *text, double value, int cut, int up)
{
    if (cut) {
        brdffit_cli_directed(text, value, 6, up);
    } else {
        brdffit_cli_text_printf(text, "%.6g", value);
    }
}

static void add_range(struct cli_text *text, const char *before, const char *parameter, const brdffit_result *result,
                      const brdffit_options *options, int exponent)
{
    double range[2];
    const int cut = brdffit_cli_proven(result, options, exponent, range);
    brdffit_cli_text_printf(text, " %s %s%s in\t[", before, options->anisotropic ? "every " : "", parameter);
    add_end(text, range[0], cut && !exponent, 1);
    brdffit_cli_text_puts(text, ",\t");
    add_end(text, range[1], cut && exponent, 0);
    brdffit_cli_text_puts(text, "]");
}

void brdffit_cli_family(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                        const brdffit_options *options)
{
    const char *before = brdffit_cli_lobes_differ(options) ? "with" : "and";
    brdffit_cli_text_puts(text, options->physical ? "physical " : "");
    if (!any_lobe(result)) {
        brdffit_cli_text_puts(text, "diffuse fit");
        brdffit_cli_add_terms(text, options);
        return;
    }
    brdffit_cli_add_family(text, options);
    if (brdffit_cli_any_lobe_by(options, 0)) {
        add_range(text, before, brdffit_cli_glyph(style, CLI_SIGMA), result, options, 0);
        before = "and";
    }
    if (brdffit_cli_any_lobe_by(options, 1)) {
        add_range(text, before, "n", result, options, 1);
    }
}

void brdffit_cli_cut(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                     const brdffit_options *options)
{
    double range[2];
    if (!any_lobe(result)) {
        brdffit_cli_text_puts(text,
                              " No sample is near enough to the mirror direction for any lobe of the range that was"
                              " asked for: its coefficients would be beyond any double.");
        return;
    }
    for (int exponent = 0; exponent < 2; exponent++) {
        if (brdffit_cli_any_lobe_by(options, exponent) && brdffit_cli_proven(result, options, exponent, range)) {
            brdffit_cli_text_printf(text, " Of %s %s to %.6g, as asked for, nothing is said: no sample sees %s.",
                                    exponent ? "n" : brdffit_cli_glyph(style, CLI_SIGMA), exponent ? "up" : "down",
                                    exponent ? options->exponent_max : options->sigma_min,
                                    options->anisotropic ? "1e-7 of such lobes' peak but in the mirror direction"
                                                         : "such lobes, whose coefficients would be beyond any double");
        }
    }
}
