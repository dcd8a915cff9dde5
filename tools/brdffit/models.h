/* models.h: forms of model by name: what `compare` fits one after the other,
 * and the presets of `fit --model`. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_MODELS_H
#define BRDFFIT_CLI_MODELS_H

#include <stddef.h>

#include "brdffit.h"
#include "settings.h"
#include "text.h"

/* Three of the longest names, a term of each kind, and what joins them. */
#define CLI_MODEL_NAME 96

/* A diffuse term and lobes. The last three are those of brdffit_options, 0 its defaults. */
struct cli_model {
    char name[CLI_MODEL_NAME]; /* as --models takes it: "2beckmann", "ggx/smith/schlick" */
    int lobes;
    brdffit_distribution distributions[BRDFFIT_MAX_LOBES]; /* in the order of a result */
    brdffit_fresnel fresnel;
    brdffit_masking masking;
    brdffit_diffuse diffuse;
};

/* A model with a name of its own, and what else that name stands for in `fit`. */
struct cli_preset {
    struct cli_model model;
    double max_incidence;     /* degrees; 0: as without */
    const char *merl_samples; /* NULL: as without */
    const char *summary;
};

extern const struct cli_preset brdffit_cli_presets[]; /* ends with one without lobes */

/* What `compare` fits when nobody says what; ends with one without lobes. */
extern const struct cli_model brdffit_cli_default_models[];

/* A line a preset: its name, and what it stands for. */
void brdffit_cli_add_presets(struct cli_text *text);

/* The preset of that name, or NULL. */
const struct cli_preset *brdffit_cli_find_preset(const char *name);

/* The model that the first `length` bytes of `name` call so: [N]DISTRIBUTION with + between several, then /TERM, into a model
 * whose own name has them in their order (model_names.c). 1, or 0 when that is no model. */
int brdffit_cli_read_model(const char *name, size_t length, struct cli_model *model);

/* The same, or a preset, which keeps its name. */
int brdffit_cli_find_model(const char *name, size_t length, struct cli_model *model);

/* "v-cavity, smith, ...": every TERM. */
void brdffit_cli_add_term_names(struct cli_text *text);

/* The same of a whole list with commas, each once, into an array that the caller frees: how many; 0 and *bad, where the
 * culprit starts, when one is no model or is there twice, and *bad is NULL when memory ran out. */
size_t brdffit_cli_read_models(const char *list, struct cli_model **models, const char **bad);

/* "2 Beckmann", "Beckmann + GGX", "GGX, Smith, Schlick, Burley". */
void brdffit_cli_add_model(struct cli_text *text, const struct cli_model *model);

/* Whether one of so many has a Fresnel term. */
int brdffit_cli_any_fresnel(const struct cli_model *models, size_t count);

/* All that is fitted with so many lobes: non-negative coefficients of so many channels, those of the diffuse term and of each
 * lobe; the roughness of each lobe; and the size of the noise. */
size_t brdffit_cli_parameters(const brdffit_options *form, int lobes, size_t channels);

/* Ask for this form. The options then point into the model. */
void brdffit_cli_use_model(const struct cli_model *model, brdffit_options *options);

/* What --model stands for, over the defaults and under the options that are given beside it. 0, or the reason is on
 * stderr. */
int brdffit_cli_take_model(struct cli_settings *settings, const char *command_name, const char *name);

#endif
