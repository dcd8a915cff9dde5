/* family.c: which models a proof is about, in words. SPDX-License-Identifier: MIT */
#include "words.h"

#include <math.h>

static const char *distribution_title(brdffit_distribution distribution)
{
    switch (distribution) {
    case BRDFFIT_BECKMANN: return "Beckmann";
    case BRDFFIT_GGX: return "GGX";
    case BRDFFIT_TORRANCE_SPARROW: return "Torrance-Sparrow";
    case BRDFFIT_WARD: return "Ward";
    case BRDFFIT_BLINN_PHONG: return "Blinn-Phong";
    case BRDFFIT_ASHIKHMIN_SHIRLEY: return "Ashikhmin-Shirley";
    case BRDFFIT_LAFORTUNE: return "Lafortune";
    default: return "unknown";
    }
}

int brdffit_cli_proven(const brdffit_result *result, const brdffit_options *options, double range[2])
{
    const int by_exponent = brdffit_cli_by_exponent(result->model->distribution);
    const double least = by_exponent ? 1 / sqrt(options->exponent_max) : options->sigma_min;
    const int cut = result->sigma_floor > least;
    range[0] = by_exponent ? options->exponent_min : cut ? result->sigma_floor : options->sigma_min;
    range[1] = !by_exponent ? options->sigma_max
               : cut        ? (1 - 1e-15) / (result->sigma_floor * result->sigma_floor)
                            : options->exponent_max;
    return cut;
}

void brdffit_cli_family(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                        const brdffit_options *options)
{
    const int lobes = result->model->lobes;
    const brdffit_distribution distribution = result->model->distribution;
    const int by_exponent = brdffit_cli_by_exponent(distribution);
    double range[2];
    const int cut = brdffit_cli_proven(result, options, range);
    if (!isfinite(result->sigma_floor)) {
        brdffit_cli_text_puts(text, "diffuse fit");
        return;
    }
    brdffit_cli_text_printf(text, "%s fit with %d %s and %s in\t[", distribution_title(distribution), lobes,
                            lobes == 1 ? "lobe" : "lobes", brdffit_cli_parameter(style, distribution));
    if (cut && !by_exponent) {
        brdffit_cli_directed(text, range[0], 6, 1);
    } else {
        brdffit_cli_text_printf(text, "%.6g", range[0]);
    }
    brdffit_cli_text_puts(text, ",\t");
    if (cut && by_exponent) {
        brdffit_cli_directed(text, range[1], 6, 0);
    } else {
        brdffit_cli_text_printf(text, "%.6g", range[1]);
    }
    brdffit_cli_text_puts(text, "]");
}

void brdffit_cli_cut(struct cli_text *text, struct cli_style style, const brdffit_result *result,
                     const brdffit_options *options)
{
    const brdffit_distribution distribution = result->model->distribution;
    const char *const name = brdffit_cli_parameter(style, distribution);
    double range[2];
    if (!brdffit_cli_proven(result, options, range)) {
        return;
    }
    if (!isfinite(result->sigma_floor)) {
        brdffit_cli_text_printf(text, " No sample is near enough to the mirror direction for any lobe of the range"
                                      " that was asked for: its coefficients would be beyond any double.");
    } else if (brdffit_cli_by_exponent(distribution)) {
        brdffit_cli_text_printf(text,
                                " Of %s up to %.6g, as asked for, nothing is said: no sample sees such lobes,"
                                " whose coefficients would be beyond any double.",
                                name, options->exponent_max);
    } else {
        brdffit_cli_text_printf(text,
                                " Of %s down to %.6g, as asked for, nothing is said: no sample sees such lobes,"
                                " whose coefficients would be beyond any double.",
                                name, options->sigma_min);
    }
}
