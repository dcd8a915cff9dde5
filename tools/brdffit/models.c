/* models.c: forms of model by name. A new form is a line in one of the two
 * tables. SPDX-License-Identifier: MIT */
#include "models.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lobes.h"

/* Fresnel, masking and diffuse term as the library has them when nobody says what. */
#define PLAIN BRDFFIT_FRESNEL_NONE, BRDFFIT_MASKING_V_CAVITY, BRDFFIT_DIFFUSE_LAMBERT
#define ONE(name, a) {name, 1, {a}, PLAIN}
#define TWO(name, a, b) {name, 2, {a, b}, PLAIN}
#define THREE(name, a, b, c) {name, 3, {a, b, c}, PLAIN}
#define END {"", 0, {BRDFFIT_BECKMANN}, PLAIN}

/* Every distribution once, then more lobes of those that renderers use. */
const struct cli_model brdffit_cli_default_models[] = {
    ONE("beckmann", BRDFFIT_BECKMANN),
    ONE("ggx", BRDFFIT_GGX),
    ONE("torrance-sparrow", BRDFFIT_TORRANCE_SPARROW),
    ONE("ward", BRDFFIT_WARD),
    ONE("blinn-phong", BRDFFIT_BLINN_PHONG),
    ONE("ashikhmin-shirley", BRDFFIT_ASHIKHMIN_SHIRLEY),
    ONE("lafortune", BRDFFIT_LAFORTUNE),
    TWO("2beckmann", BRDFFIT_BECKMANN, BRDFFIT_BECKMANN),
    TWO("2ggx", BRDFFIT_GGX, BRDFFIT_GGX),
    TWO("beckmann+ggx", BRDFFIT_BECKMANN, BRDFFIT_GGX),
    THREE("3beckmann", BRDFFIT_BECKMANN, BRDFFIT_BECKMANN, BRDFFIT_BECKMANN),
    THREE("3ggx", BRDFFIT_GGX, BRDFFIT_GGX, BRDFFIT_GGX),
    END,
};

const struct cli_preset brdffit_cli_presets[] = {
    {TWO("paper", BRDFFIT_BECKMANN, BRDFFIT_BECKMANN), 60, "84",
     "Yu, Seo and Lee: two Beckmann lobes, light up to 60 degrees;\n"
     "                  of a MERL table 84 directions"},
    {ONE("cook-torrance", BRDFFIT_BECKMANN), 0, NULL, "Cook and Torrance 1982: one Beckmann lobe"},
    {ONE("phong", BRDFFIT_LAFORTUNE), 0, NULL, "a cosine lobe about the mirrored light"},
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

/* ---- Names ------------------------------------------------------------- */

/* How many lobes of one distribution stand at p and after. */
static int run_length(const struct cli_model *model, int p)
{
    int end = p;
    while (end < model->lobes && model->distributions[end] == model->distributions[p]) {
        end++;
    }
    return end - p;
}

static void set_name(struct cli_model *model)
{
    size_t size = 0;
    for (int p = 0; p < model->lobes; p += run_length(model, p)) {
        const int count = run_length(model, p);
        char number[12] = "";
        if (count > 1) {
            (void)snprintf(number, sizeof number, "%d", count);
        }
        size += (size_t)snprintf(model->name + size, sizeof model->name - size, "%s%s%s", p > 0 ? "+" : "", number,
                                 brdffit_distribution_string(model->distributions[p]));
    }
}

/* [N]DISTRIBUTION of `length` bytes, as further lobes of the model. */
static int add_part(struct cli_model *model, const char *part, size_t length)
{
    int count = 1;
    if (length > 0 && part[0] >= '1' && part[0] <= '0' + BRDFFIT_MAX_LOBES) {
        count = part[0] - '0';
        part++;
        length--;
    }
    for (const struct cli_choice *c = brdffit_cli_distribution_choices(); c->name != NULL; c++) {
        if (strlen(c->name) == length && memcmp(c->name, part, length) == 0) {
            for (; count > 0 && model->lobes < BRDFFIT_MAX_LOBES; count--) {
                model->distributions[model->lobes++] = (brdffit_distribution)c->value;
            }
            return count == 0;
        }
    }
    return 0;
}

static int is_called(const struct cli_model *model, const char *name, size_t length)
{
    return strlen(model->name) == length && memcmp(model->name, name, length) == 0;
}

static const struct cli_model *in_table(const char *name, size_t length)
{
    for (const struct cli_preset *p = brdffit_cli_presets; p->model.lobes > 0; p++) {
        if (is_called(&p->model, name, length)) {
            return &p->model;
        }
    }
    for (const struct cli_model *m = brdffit_cli_default_models; m->lobes > 0; m++) {
        if (is_called(m, name, length)) {
            return m;
        }
    }
    return NULL;
}

int brdffit_cli_find_model(const char *name, size_t length, struct cli_model *model)
{
    const struct cli_model none = END;
    const struct cli_model *const known = in_table(name, length);
    if (known != NULL) {
        *model = *known;
        return 1;
    }
    *model = none;
    for (size_t at = 0; at <= length;) {
        const char *const plus = memchr(name + at, '+', length - at);
        const size_t part = plus != NULL ? (size_t)(plus - (name + at)) : length - at;
        if (!add_part(model, name + at, part)) {
            return 0;
        }
        at += part + 1;
    }
    brdffit_cli_group_lobes(model->distributions, model->lobes);
    set_name(model);
    return 1;
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

void brdffit_cli_add_model(struct cli_text *text, const struct cli_model *model)
{
    static const char *const masking[] = {"", " Smith", " separable Smith", " unmasked"};
    static const char *const fresnel[] = {"", " Schlick"};
    static const char *const diffuse[] = {"", " without diffuse", " Oren-Nayar", " Burley"};
    for (int p = 0; p < model->lobes; p += run_length(model, p)) {
        const int count = run_length(model, p);
        brdffit_cli_text_puts(text, p > 0 ? " + " : "");
        if (count > 1) {
            brdffit_cli_text_printf(text, "%d ", count);
        }
        brdffit_cli_text_puts(text, brdffit_distribution_title(model->distributions[p]));
    }
    brdffit_cli_text_puts(text, masking[model->masking]);
    brdffit_cli_text_puts(text, fresnel[model->fresnel]);
    brdffit_cli_text_puts(text, diffuse[model->diffuse]);
}

/* ---- What a form has --------------------------------------------------- */

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
    fprintf(stderr,
            "brdffit %s: --model does not take '%s'; valid values: [N]DISTRIBUTION with + between, up to %d lobes, as "
            "2beckmann or beckmann+ggx; or",
            command_name, name, BRDFFIT_MAX_LOBES);
    for (const struct cli_preset *p = brdffit_cli_presets; p->model.lobes > 0; p++) {
        fprintf(stderr, "%s %s", p == brdffit_cli_presets ? "" : ",", p->model.name);
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
