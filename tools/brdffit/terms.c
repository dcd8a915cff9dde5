/* terms.c: names and figures of Fresnel, masking and the diffuse term.
 * SPDX-License-Identifier: MIT */
#include "terms.h"

#include <math.h>

/* ---- Names ------------------------------------------------------------- */

/* The last of each ends the list. */
static struct cli_choice fresnels[BRDFFIT_FRESNEL_COUNT + 1], diffuses[BRDFFIT_DIFFUSE_COUNT + 1],
    maskings[BRDFFIT_MASKING_COUNT + 1];

const struct cli_choice *brdffit_cli_term_choices(enum cli_option_kind kind)
{
    for (int i = 0; i < BRDFFIT_FRESNEL_COUNT; i++) {
        fresnels[i] = (struct cli_choice){brdffit_fresnel_string((brdffit_fresnel)i), i, 0};
    }
    for (int i = 0; i < BRDFFIT_DIFFUSE_COUNT; i++) {
        diffuses[i] = (struct cli_choice){brdffit_diffuse_string((brdffit_diffuse)i), i, 0};
    }
    for (int i = 0; i < BRDFFIT_MASKING_COUNT; i++) {
        maskings[i] = (struct cli_choice){brdffit_masking_string((brdffit_masking)i), i, 0};
    }
    return kind == CLI_FRESNEL ? fresnels : kind == CLI_DIFFUSE ? diffuses : maskings;
}

void brdffit_cli_settle_incidence(struct cli_settings *settings)
{
    brdffit_options defaults;
    brdffit_options_init(&defaults);
    if (settings->max_incidence < 0) {
        settings->max_incidence = settings->fresnel != BRDFFIT_FRESNEL_NONE ? 90 : defaults.max_incidence;
    }
}

int brdffit_cli_special(const brdffit_options *options)
{
    return options->fresnel != BRDFFIT_FRESNEL_NONE || options->diffuse != BRDFFIT_DIFFUSE_LAMBERT ||
           options->masking != BRDFFIT_MASKING_V_CAVITY || options->anisotropic;
}

size_t brdffit_cli_more_columns(brdffit_diffuse diffuse)
{
    return (size_t)brdffit_diffuse_columns(diffuse) - 1;
}

static const char *masking_words(brdffit_masking masking)
{
    switch (masking) {
    case BRDFFIT_MASKING_SMITH: return "Smith masking";
    case BRDFFIT_MASKING_SMITH_SEPARABLE: return "separable Smith masking";
    case BRDFFIT_MASKING_NONE: return "no masking";
    default: return brdffit_masking_string(masking);
    }
}

static const char *diffuse_words(brdffit_diffuse diffuse)
{
    switch (diffuse) {
    case BRDFFIT_DIFFUSE_NONE: return "no diffuse term";
    case BRDFFIT_DIFFUSE_OREN_NAYAR: return "Oren-Nayar diffuse";
    case BRDFFIT_DIFFUSE_BURLEY: return "Burley diffuse";
    default: return brdffit_diffuse_string(diffuse);
    }
}

void brdffit_cli_add_terms(struct cli_text *text, const brdffit_options *options)
{
    const char *const words[] = {options->anisotropic ? options->lobes > 1 ? "the first anisotropic" : "anisotropic"
                                                      : NULL,
                                 options->fresnel != BRDFFIT_FRESNEL_NONE ? "Schlick Fresnel" : NULL,
                                 options->masking != BRDFFIT_MASKING_V_CAVITY ? masking_words(options->masking) : NULL,
                                 options->diffuse != BRDFFIT_DIFFUSE_LAMBERT ? diffuse_words(options->diffuse) : NULL};
    const char *separator = " (";
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (words[i] != NULL) {
            brdffit_cli_text_printf(text, "%s%s", separator, words[i]);
            separator = ", ";
        }
    }
    brdffit_cli_text_puts(text, brdffit_cli_special(options) ? ")" : "");
}

/* ---- Figures ----------------------------------------------------------- */

double brdffit_cli_ior(double f0)
{
    return f0 < 1 ? (1 + sqrt(f0)) / (1 - sqrt(f0)) : INFINITY;
}

/* b / a = B / A with A = 1 - u / (2 u + 0.66), B = 0.45 u / (u + 0.09), u the roughness squared: a quadratic in u. B / A
 * grows from 0 to 0.9. */
double brdffit_cli_oren_nayar_roughness(double a, double b)
{
    const double q = b / a, second = 0.45 - 0.5 * q, first = 0.1485 - 0.375 * q, last = 0.0297 * q;
    if (!(a > 0 && q < 0.9)) {
        return NAN;
    }
    const double root = sqrt(first * first + 4 * second * last);
    return sqrt(first > 0 ? 2 * last / (first + root) : (root - first) / (2 * second));
}

/* ---- JSON -------------------------------------------------------------- */

void brdffit_cli_json_term_names(struct cli_json *json, const brdffit_options *options)
{
    brdffit_cli_json_string(json, "fresnel", brdffit_fresnel_string(options->fresnel));
    brdffit_cli_json_string(json, "diffuse", brdffit_diffuse_string(options->diffuse));
    brdffit_cli_json_string(json, "masking", brdffit_masking_string(options->masking));
}

static void rows(struct cli_json *json, const char *key, const double *values, size_t channels, size_t width)
{
    brdffit_cli_json_open(json, key, '[');
    for (size_t k = 0; k < channels; k++) {
        brdffit_cli_json_numbers(json, NULL, values + k * width, width);
    }
    brdffit_cli_json_close(json, ']');
}

/* Null where it is infinite. */
static void indices(struct cli_json *json, const brdffit_model *model)
{
    const size_t lobes = (size_t)model->lobes;
    brdffit_cli_json_open(json, "ior", '[');
    for (size_t k = 0; k < model->channels; k++) {
        brdffit_cli_json_open(json, NULL, '[');
        for (size_t p = 0; p < lobes; p++) {
            const double n = brdffit_cli_ior(model->f0[k * lobes + p]);
            if (isfinite(n)) {
                brdffit_cli_json_number(json, NULL, n);
            } else {
                brdffit_cli_json_null(json, NULL);
            }
        }
        brdffit_cli_json_close(json, ']');
    }
    brdffit_cli_json_close(json, ']');
}

/* Null where nothing is known. */
static void f0_intervals(struct cli_json *json, const struct cli_job *job)
{
    const size_t channels = job->result->model->channels, lobes = (size_t)job->result->model->lobes;
    if (job->f0_low == NULL) {
        brdffit_cli_json_null(json, "f0_interval");
        return;
    }
    brdffit_cli_json_open(json, "f0_interval", '[');
    for (size_t k = 0; k < channels; k++) {
        brdffit_cli_json_open(json, NULL, '[');
        for (size_t p = 0; p < lobes; p++) {
            const double ends[2] = {job->f0_low[k * lobes + p], job->f0_high[k * lobes + p]};
            brdffit_cli_json_numbers(json, NULL, ends, 2);
        }
        brdffit_cli_json_close(json, ']');
    }
    brdffit_cli_json_close(json, ']');
}

/* Of an anisotropic lobe: the two roughnesses of each lobe, their ratio, and where the tangent lies. */
static void roughnesses(struct cli_json *json, const brdffit_result *result)
{
    const size_t lobes = (size_t)result->model->lobes;
    if (result->model->anisotropy == NULL) {
        return;
    }
    brdffit_cli_json_open(json, "sigma_xy", '[');
    for (size_t p = 0; p < lobes; p++) {
        const double both[2] = {result->lobe[p]->sigma_x, result->lobe[p]->sigma_y};
        brdffit_cli_json_numbers(json, NULL, both, 2);
    }
    brdffit_cli_json_close(json, ']');
    brdffit_cli_json_numbers(json, "anisotropy", result->model->anisotropy, lobes);
    brdffit_cli_json_numbers(json, "tangent_angle", result->model->tangent_angle, lobes);
}

void brdffit_cli_json_terms(struct cli_json *json, const struct cli_job *job)
{
    const brdffit_model *const model = job->result->model;
    roughnesses(json, job->result);
    if (job->azimuth >= 0) {
        brdffit_cli_json_number(json, "azimuth_share", job->azimuth);
    }
    if (model->fresnel != BRDFFIT_FRESNEL_NONE) {
        rows(json, "f0", model->f0, model->channels, (size_t)model->lobes);
        indices(json, model);
        f0_intervals(json, job);
    }
    if (brdffit_cli_more_columns(model->diffuse) > 0) {
        rows(json, "x_more", model->x_more, model->channels, brdffit_cli_more_columns(model->diffuse));
    }
}
