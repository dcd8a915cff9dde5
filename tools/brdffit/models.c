/* models.c: forms of model by name. A new form is a line in one of the two
 * tables. SPDX-License-Identifier: MIT */
#include "models.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lobes.h"
#include "tell.h"

/* Masking, Fresnel, diffuse term: the library's when nobody says what, and what renderers show. */
#define PLAIN BRDFFIT_FRESNEL_NONE, BRDFFIT_MASKING_V_CAVITY, BRDFFIT_DIFFUSE_LAMBERT
#define SCHLICK BRDFFIT_FRESNEL_SCHLICK, BRDFFIT_MASKING_V_CAVITY, BRDFFIT_DIFFUSE_LAMBERT
#define PRINCIPLED(diffuse) BRDFFIT_FRESNEL_SCHLICK, BRDFFIT_MASKING_SMITH, diffuse
#define ROUGH BRDFFIT_FRESNEL_NONE, BRDFFIT_MASKING_V_CAVITY, BRDFFIT_DIFFUSE_OREN_NAYAR
#define ONE(name, a, ...) {name, 1, {a}, __VA_ARGS__}
#define TWO(name, a, ...) {name, 2, {a, a}, __VA_ARGS__}
#define END {"", 0, {BRDFFIT_BECKMANN}, PLAIN}

/* Distributions alone, then more lobes and what does more than those: Fresnel, and diffuse terms. */
const struct cli_model brdffit_cli_default_models[] = {
    ONE("beckmann", BRDFFIT_BECKMANN, PLAIN),
    ONE("ggx", BRDFFIT_GGX, PLAIN),
    ONE("ward", BRDFFIT_WARD, PLAIN),
    ONE("blinn-phong", BRDFFIT_BLINN_PHONG, PLAIN),
    ONE("ashikhmin-shirley", BRDFFIT_ASHIKHMIN_SHIRLEY, PLAIN),
    ONE("lafortune", BRDFFIT_LAFORTUNE, PLAIN),
    TWO("2beckmann", BRDFFIT_BECKMANN, PLAIN),
    TWO("2ggx", BRDFFIT_GGX, PLAIN),
    ONE("beckmann/schlick", BRDFFIT_BECKMANN, SCHLICK),
    TWO("2beckmann/schlick", BRDFFIT_BECKMANN, SCHLICK),
    ONE("ggx/smith/schlick", BRDFFIT_GGX, PRINCIPLED(BRDFFIT_DIFFUSE_LAMBERT)),
    ONE("ggx/smith/schlick/burley", BRDFFIT_GGX, PRINCIPLED(BRDFFIT_DIFFUSE_BURLEY)),
    ONE("beckmann/oren-nayar", BRDFFIT_BECKMANN, ROUGH),
    END,
};

const struct cli_preset brdffit_cli_presets[] = {
    {TWO("paper", BRDFFIT_BECKMANN, PLAIN), 60, "84",
     "Yu, Seo and Lee: two Beckmann lobes, light up to 60 degrees;\n"
     "                  of a MERL table 84 directions"},
    {ONE("principled", BRDFFIT_GGX, PRINCIPLED(BRDFFIT_DIFFUSE_LAMBERT)), 0, NULL,
     "what renderers show: one GGX lobe, Smith, Schlick;\n"
     "                  the same as ggx/smith/schlick"},
    {ONE("disney", BRDFFIT_GGX, PRINCIPLED(BRDFFIT_DIFFUSE_BURLEY)), 0, NULL,
     "the same with Burley's diffuse term:\n"
     "                  ggx/smith/schlick/burley"},
    {ONE("cook-torrance", BRDFFIT_BECKMANN, PLAIN), 0, NULL, "Cook and Torrance 1982: one Beckmann lobe"},
    {ONE("phong", BRDFFIT_LAFORTUNE, PLAIN), 0, NULL, "a cosine lobe about the mirrored light"},
    {END, 0, NULL, NULL},
};

const struct cli_preset *brdffit_cli_find_preset(const char *name)
{
    for (const struct cli_preset *p = brdffit_cli_presets; p->model.lobes > 0; p++) {
        if (strcmp(p->model.name, name) == 0) {
            return p;
        }
    }
    return NULL;
}

void brdffit_cli_add_presets(struct cli_text *text)
{
    for (const struct cli_preset *p = brdffit_cli_presets; p->model.lobes > 0; p++) {
        brdffit_cli_text_printf(text, "  %-15s %s\n", p->model.name, p->summary);
    }
}

/* ---- Lists --------------------------------------------------------------- */

int brdffit_cli_find_model(const char *name, size_t length, struct cli_model *model)
{
    for (const struct cli_preset *p = brdffit_cli_presets; p->model.lobes > 0; p++) {
        if (strlen(p->model.name) == length && memcmp(p->model.name, name, length) == 0) {
            *model = p->model;
            return 1;
        }
    }
    return brdffit_cli_read_model(name, length, model);
}

size_t brdffit_cli_read_models(const char *list, struct cli_model **models, const char **bad)
{
    size_t most = 1, count = 0;
    for (const char *c = list; *c; c++) {
        most += *c == ',';
    }
    *bad = NULL;
    *models = calloc(most, sizeof **models);
    for (const char *at = list; *models != NULL && *bad == NULL && count < most;) {
        const size_t length = strcspn(at, ",");
        struct cli_model *const model = *models + count;
        if (!brdffit_cli_find_model(at, length, model)) {
            *bad = at;
        }
        for (size_t i = 0; i < count && *bad == NULL; i++) {
            *bad = strcmp(model->name, (*models)[i].name) == 0 ? at : NULL;
        }
        at += length + (at[length] == ',');
        count++;
    }
    if (*models == NULL || *bad != NULL) {
        free(*models);
        *models = NULL;
        return 0;
    }
    return count;
}

/* ---- What a form has --------------------------------------------------- */

int brdffit_cli_any_fresnel(const struct cli_model *models, size_t count)
{
    int any = 0;
    for (size_t i = 0; i < count; i++) {
        any |= models[i].fresnel != BRDFFIT_FRESNEL_NONE;
    }
    return any;
}

size_t brdffit_cli_parameters(const brdffit_options *form, int lobes, size_t channels)
{
    const int zero = form->diffuse == BRDFFIT_DIFFUSE_NONE; /* a column, but no coefficient */
    const int diffuse = zero ? 0 : brdffit_diffuse_columns(form->diffuse);
    const int columns = diffuse + lobes * (form->fresnel == BRDFFIT_FRESNEL_NONE ? 1 : 2);
    return channels * (size_t)columns + (size_t)lobes + 1;
}

void brdffit_cli_use_model(const struct cli_model *model, brdffit_options *options)
{
    options->lobes = model->lobes;
    options->distributions = model->distributions;
    options->distribution = model->distributions[0];
    options->fresnel = model->fresnel;
    options->masking = model->masking;
    options->diffuse = model->diffuse;
}

/* ---- Presets ----------------------------------------------------------- */

static void refuse(const char *command_name, const char *name)
{
    brdffit_cli_tell(
        "brdffit %s: --model does not take '%s'; valid values: [N]DISTRIBUTION with + between, up to %d lobes, then "
        "/TERM, as 2beckmann or ggx/smith/schlick; or",
        command_name, name, BRDFFIT_MAX_LOBES);
    for (const struct cli_preset *p = brdffit_cli_presets; p->model.lobes > 0; p++) {
        brdffit_cli_tell("%s %s", p == brdffit_cli_presets ? "" : ",", p->model.name);
    }
    fputc('\n', stderr);
}

/* As --lobes and --distribution would: so that those can be given beside it. */
static void take_lobes(struct cli_settings *settings, const struct cli_model *model)
{
    brdffit_options form;
    struct cli_text names = {0};
    brdffit_options_init(&form);
    brdffit_cli_use_model(model, &form);
    if (brdffit_cli_lobes_differ(&form)) {
        brdffit_cli_add_names(&names, &form);
    } else {
        brdffit_cli_text_printf(&names, "%d", form.lobes);
    }
    (void)snprintf(settings->model_lobes, sizeof settings->model_lobes, "%s", brdffit_cli_text_string(&names));
    settings->lobes_given = settings->model_lobes;
    settings->model_distribution = (int)form.distribution;
    brdffit_cli_text_free(&names);
}

int brdffit_cli_take_model(struct cli_settings *settings, const char *command_name, const char *name)
{
    const struct cli_preset *const preset = brdffit_cli_find_preset(name);
    struct cli_model model;
    if (!brdffit_cli_find_model(name, strlen(name), &model)) {
        refuse(command_name, name);
        return -1;
    }
    take_lobes(settings, &model);
    settings->fresnel = (int)model.fresnel;
    settings->diffuse = (int)model.diffuse;
    settings->masking = (int)model.masking;
    if (preset != NULL && preset->max_incidence > 0) {
        settings->max_incidence = preset->max_incidence;
    }
    if (preset != NULL && preset->merl_samples != NULL) {
        settings->merl_samples = preset->merl_samples;
    }
    return 0;
}
