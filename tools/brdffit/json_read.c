/* json_read.c: fits read back from their JSON lines. Nothing in a line is
 * trusted: a member that is missing or of the wrong type is named.
 * SPDX-License-Identifier: MIT */
#include "json_read.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "failure.h"
#include "reading.h"
#include "tell.h"
#include "terms.h"
#include "weigh.h"

/* ---- Members ----------------------------------------------------------- */

static const cJSON *member(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static const char *string_member(const cJSON *object, const char *name)
{
    return cJSON_GetStringValue(member(object, name));
}

/* Store `count` numbers that are finite and not below `low`. */
static int numbers(const cJSON *array, double *out, size_t count, double low)
{
    if (!cJSON_IsArray(array) || (size_t)cJSON_GetArraySize(array) != count) {
        return 0;
    }
    const cJSON *item;
    cJSON_ArrayForEach(item, array)
    {
        if (!cJSON_IsNumber(item) || !(item->valuedouble >= low && item->valuedouble <= 1e308)) {
            return 0;
        }
        *out++ = item->valuedouble;
    }
    return 1;
}

/* Returns 1, or 0 when the item exists and names none of the choices. */
static int choice_item(const cJSON *item, const struct cli_choice *choices, int *value)
{
    if (item == NULL || cJSON_IsNull(item)) {
        return 1;
    }
    const char *string = cJSON_GetStringValue(item);
    for (; string != NULL && choices->name != NULL; choices++) {
        if (strcmp(choices->name, string) == 0) {
            *value = choices->value;
            return 1;
        }
    }
    return 0;
}

static int choice_member(const cJSON *object, const char *name, const struct cli_choice *choices, int *value)
{
    return choice_item(member(object, name), choices, value);
}

/* ---- One fit ----------------------------------------------------------- */

/* A list, one a lobe; or, as lines had it that knew no lists, one for all. The name of the member that is wrong. */
static const char *read_distributions(struct cli_fit *fit, const cJSON *object, size_t lobes)
{
    const cJSON *const list = member(object, "distributions");
    int all = CLI_UNSET;
    if (!choice_member(object, "distribution", brdffit_cli_distribution_choices(), &all)) {
        return "distribution";
    }
    if (list != NULL && (!cJSON_IsArray(list) || (size_t)cJSON_GetArraySize(list) != lobes)) {
        return "distributions";
    }
    for (size_t p = 0; p < lobes; p++) {
        int distribution = list != NULL ? CLI_UNSET : all;
        if (list != NULL &&
            !choice_item(cJSON_GetArrayItem(list, (int)p), brdffit_cli_distribution_choices(), &distribution)) {
            return "distributions";
        }
        if (distribution == CLI_UNSET || (all != CLI_UNSET && distribution != all)) {
            return list != NULL ? "distributions" : "distribution";
        }
        fit->distributions[p] = (brdffit_distribution)distribution;
    }
    fit->model.distribution = fit->distributions[0];
    fit->model.distributions = fit->distributions;
    return NULL;
}

/* K rows of numbers >= 0. */
static int rows(const cJSON *list, double *out, size_t channels, size_t width)
{
    if (!cJSON_IsArray(list) || (size_t)cJSON_GetArraySize(list) != channels) {
        return 0;
    }
    const cJSON *row;
    cJSON_ArrayForEach(row, list)
    {
        if (!numbers(row, out, width, 0)) {
            return 0;
        }
        out += width;
    }
    return 1;
}

/* F0, K x P reflectances. */
static int read_f0(struct cli_fit *fit, const cJSON *object, double *to)
{
    const size_t channels = fit->model.channels, lobes = (size_t)fit->model.lobes;
    int good = rows(member(object, "f0"), to, channels, lobes);
    for (size_t i = 0; good && i < channels * lobes; i++) {
        good = to[i] <= 1;
    }
    fit->model.f0 = to;
    return good;
}

/* Most coefficients of a diffuse term after the first. */
#define MORE_MOST 2

/* Fresnel, masking and the diffuse term, with their coefficients into `to`. Lines from before there were any name none. */
static const char *read_terms(struct cli_fit *fit, const cJSON *object, double *to)
{
    static const char *const name[] = {"fresnel", "diffuse", "masking"};
    static const enum cli_option_kind kind[] = {CLI_FRESNEL, CLI_DIFFUSE, CLI_MASKING};
    int value[] = {BRDFFIT_FRESNEL_NONE, BRDFFIT_DIFFUSE_LAMBERT, BRDFFIT_MASKING_V_CAVITY};
    for (size_t i = 0; i < 3; i++) {
        if (!choice_member(object, name[i], brdffit_cli_term_choices(kind[i]), &value[i])) {
            return name[i];
        }
    }
    fit->model.fresnel = (brdffit_fresnel)value[0];
    fit->model.diffuse = (brdffit_diffuse)value[1];
    fit->model.masking = (brdffit_masking)value[2];
    if (fit->model.fresnel != BRDFFIT_FRESNEL_NONE && !read_f0(fit, object, to)) {
        return "f0";
    }
    const size_t more = brdffit_cli_more_columns(fit->model.diffuse);
    double *const x_more = to + fit->model.channels * (size_t)fit->model.lobes;
    if (more > MORE_MOST || (more > 0 && !rows(member(object, "x_more"), x_more, fit->model.channels, more))) {
        return "x_more";
    }
    fit->model.x_more = more > 0 ? x_more : NULL;
    return NULL;
}

/* Two roughnesses of a lobe, where there are any. The name of the member that is wrong. */
static const char *read_anisotropy(struct cli_fit *fit, const cJSON *object)
{
    const cJSON *const angle = member(object, "tangent_angle");
    const size_t lobes = (size_t)fit->model.lobes;
    if (member(object, "anisotropy") == NULL) {
        return NULL;
    }
    if (!numbers(member(object, "anisotropy"), fit->anisotropy, lobes, 1e-300)) {
        return "anisotropy";
    }
    if (!numbers(angle, fit->tangent_angle, lobes, -360)) {
        return "tangent_angle";
    }
    fit->model.anisotropy = fit->anisotropy;
    fit->model.tangent_angle = fit->tangent_angle;
    return NULL;
}

/* The members that a fit cannot do without, in one block of numbers:
 * x, channel_scale, rms (K each), y (K P), then f0 and x_more, of which there may be none. Returns the name of a bad one. */
static const char *read_model(struct cli_fit *fit, const cJSON *object)
{
    const cJSON *const lobes = member(object, "lobes");
    const cJSON *const x = member(object, "x");
    if (!cJSON_IsNumber(lobes) || !(lobes->valueint >= 1 && lobes->valueint <= BRDFFIT_MAX_LOBES)) {
        return "lobes";
    }
    if (!cJSON_IsArray(x) || cJSON_GetArraySize(x) < 1) {
        return "x";
    }
    const size_t channels = (size_t)cJSON_GetArraySize(x);
    const size_t p = (size_t)lobes->valueint;
    fit->numbers = calloc(channels, (3 + 2 * p + MORE_MOST) * sizeof *fit->numbers);
    if (fit->numbers == NULL) {
        return "memory";
    }
    double *const scale = fit->numbers + channels;
    double *const rms = scale + channels;
    double *const y = rms + channels;
    brdffit_model_init(&fit->model);
    fit->model.sigma = fit->sigma;
    fit->model.lobes = (int)p;
    fit->model.channels = channels;
    fit->model.x = fit->numbers;
    fit->model.y = y;
    fit->channel_scale = scale;
    fit->rms = rms;
    const char *bad = read_distributions(fit, object, p);
    if (bad != NULL) {
        return bad;
    }
    if (!numbers(member(object, "sigma"), fit->sigma, p, 1e-300)) {
        return "sigma";
    }
    bad = read_anisotropy(fit, object);
    if (bad != NULL) {
        return bad;
    }
    if (!numbers(x, fit->numbers, channels, 0)) {
        return "x";
    }
    if (!numbers(member(object, "channel_scale"), scale, channels, 1e-300)) {
        return "channel_scale";
    }
    if (!numbers(member(object, "rms"), rms, channels, 0)) {
        return "rms";
    }
    return rows(member(object, "y"), y, channels, p) ? read_terms(fit, object, y + p * channels) : "y";
}

static const char *read_names(struct cli_fit *fit, const cJSON *object)
{
    const cJSON *const array = member(object, "channels");
    if (array == NULL) {
        return NULL;
    }
    if (!cJSON_IsArray(array) || (size_t)cJSON_GetArraySize(array) != fit->model.channels) {
        return "channels";
    }
    fit->names = calloc(fit->model.channels, sizeof *fit->names);
    if (fit->names == NULL) {
        return "memory";
    }
    size_t k = 0;
    const cJSON *item;
    cJSON_ArrayForEach(item, array)
    {
        if (!cJSON_IsString(item)) {
            return "channels";
        }
        const size_t size = strlen(item->valuestring) + 1;
        fit->names[k] = malloc(size);
        if (fit->names[k] == NULL) {
            return "memory";
        }
        memcpy(fit->names[k++], item->valuestring, size);
    }
    return NULL;
}

static const char *read_directions(struct cli_fit *fit, const cJSON *object)
{
    const cJSON *const array = member(object, "merl_directions");
    if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) < 1) {
        return "merl_directions";
    }
    const size_t count = (size_t)cJSON_GetArraySize(array);
    fit->vectors = calloc(count, 6 * sizeof *fit->vectors);
    if (fit->vectors == NULL) {
        return "memory";
    }
    size_t i = 0;
    const cJSON *item;
    cJSON_ArrayForEach(item, array)
    {
        double pair[6];
        if (!numbers(item, pair, 6, -1e308)) {
            return "merl_directions";
        }
        memcpy(fit->vectors + 3 * i, pair, 3 * sizeof *pair);
        memcpy(fit->vectors + 3 * (count + i), pair + 3, 3 * sizeof *pair);
        i++;
    }
    brdffit_samples_init(&fit->merl_directions);
    fit->merl_directions.count = count;
    fit->merl_directions.form = BRDFFIT_FORM_DIRECTIONS;
    fit->merl_directions.light = fit->vectors;
    fit->merl_directions.view = fit->vectors + 3 * count;
    return NULL;
}

/* A string of "reading", copied; absent ones stay NULL. 0: it is no string, or no memory. */
static int copy_member(const cJSON *object, const char *name, char **out)
{
    const char *const text = string_member(object, name);
    if (text != NULL) {
        *out = malloc(strlen(text) + 1);
        return *out != NULL && strcpy(*out, text) != NULL;
    }
    return member(object, name) == NULL;
}

static int read_reading(struct cli_fit *fit, const cJSON *reading)
{
    const cJSON *const saturated = member(reading, "saturated");
    if (reading == NULL) {
        return 1;
    }
    fit->saturated = cJSON_IsNumber(saturated) && saturated->valuedouble > 0 ? saturated->valuedouble : 0;
    return choice_member(reading, "values", brdffit_cli_values_choices, &fit->quantity) &&
           copy_member(reading, "channels", &fit->channels) && copy_member(reading, "column", &fit->columns) &&
           copy_member(reading, "missing", &fit->missing) && copy_member(reading, "directions", &fit->directions);
}

/* How the file was read, and which of its samples count. */
static const char *read_source(struct cli_fit *fit, const cJSON *object)
{
    if (!choice_member(object, "quantity", brdffit_cli_quantity_choices, &fit->quantity)) {
        return "quantity";
    }
    if (!read_reading(fit, member(object, "reading"))) {
        return "reading";
    }
    if (!choice_member(object, "weighting", brdffit_cli_weight_choices, &fit->weighting)) {
        return "weighting";
    }
    if (!choice_member(object, "merl_bins", brdffit_cli_bins_choices, &fit->merl_bins)) {
        return "merl_bins";
    }
    const cJSON *const incidence = member(object, "max_incidence");
    if (incidence != NULL) {
        if (!cJSON_IsNumber(incidence) || !(incidence->valuedouble > 0)) {
            return "max_incidence";
        }
        fit->max_incidence = incidence->valuedouble;
    }
    const char *samples = string_member(object, "merl_samples");
    if (samples == NULL || strcmp(samples, "table") == 0) {
        return NULL;
    }
    if (strcmp(samples, "84") == 0) {
        fit->merl_sampling = BRDFFIT_IO_MERL_PROTOCOL84;
        return NULL;
    }
    fit->merl_sampling = BRDFFIT_IO_MERL_DIRECTIONS;
    return read_directions(fit, object);
}

/* What was minimised, and how small it was. */
static const char *read_objective(struct cli_fit *fit, const cJSON *object)
{
    int norm = BRDFFIT_NORM_L2;
    if (!choice_member(object, "norm", brdffit_cli_norm_choices, &norm)) {
        return "norm";
    }
    fit->norm = (brdffit_norm)norm;
    const cJSON *const e2 = member(object, "e2");
    if (!cJSON_IsNumber(e2) || !(e2->valuedouble >= 0)) {
        return "e2";
    }
    fit->e2 = e2->valuedouble;
    return NULL;
}

/* The name of the member that makes the fit unusable, or NULL. */
static const char *read_fit(struct cli_fit *fit, const cJSON *object)
{
    brdffit_options defaults;
    brdffit_options_init(&defaults);
    fit->max_incidence = defaults.max_incidence;
    fit->quantity = CLI_UNSET;
    fit->weighting = CLI_UNSET;
    const char *bad = read_model(fit, object);
    if (bad == NULL) {
        bad = read_names(fit, object);
    }
    if (bad == NULL) {
        bad = read_source(fit, object);
    }
    return bad != NULL ? bad : read_objective(fit, object);
}

int brdffit_cli_fit_parse(struct cli_fit *fit, const cJSON *object, const char *path)
{
    const char *status = string_member(object, "status");
    if (status != NULL && strcmp(status, "error") == 0) {
        const char *why = string_member(member(object, "error"), "message");
        brdffit_cli_tell("brdffit: %s: fit %zu failed: %s\n", path, fit->line, why == NULL ? "no reason given" : why);
        return CLI_EXIT_DATA;
    }
    const char *bad = read_fit(fit, object);
    if (bad == NULL) {
        return 0;
    }
    if (strcmp(bad, "memory") == 0) {
        return brdffit_cli_no_memory();
    }
    brdffit_cli_tell("brdffit: %s: fit %zu: \"%s\" is missing or wrong\n", path, fit->line, bad);
    return CLI_EXIT_DATA;
}

void brdffit_cli_fit_free(struct cli_fit *fit)
{
    for (size_t k = 0; fit->names != NULL && k < fit->model.channels; k++) {
        free(fit->names[k]);
    }
    free(fit->names);
    free(fit->channels);
    free(fit->columns);
    free(fit->missing);
    free(fit->directions);
    free(fit->numbers);
    free(fit->vectors);
    memset(fit, 0, sizeof *fit);
}
