/* terms.h: what a model has beside the distributions of its lobes: Fresnel,
 * masking, the diffuse term. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_TERMS_H
#define BRDFFIT_CLI_TERMS_H

#include "brdffit.h"
#include "job.h"
#include "json_write.h"
#include "settings.h"
#include "term.h"

/* --max-incidence where it was not given: the library's, and no limit with Fresnel, which grazing light tells. */
void brdffit_cli_settle_incidence(struct cli_settings *settings);

/* Whether Fresnel, masking or the diffuse term is not the default, or a lobe anisotropic. */
int brdffit_cli_special(const brdffit_options *options);

/* Coefficients of the diffuse term after the first. */
size_t brdffit_cli_more_columns(brdffit_diffuse diffuse);

/* " (Schlick Fresnel, Smith masking, Burley diffuse)": what is not the default; nothing when all is. */
void brdffit_cli_add_terms(struct cli_text *text, const brdffit_options *options);

/* Index of refraction that a reflectance at normal incidence stands for: (1 + sqrt F0) / (1 - sqrt F0), INFINITY for 1. */
double brdffit_cli_ior(double f0);

/* Roughness in radians that Oren-Nayar's two coefficients stand for: those of A and B of it; NAN when of none. */
double brdffit_cli_oren_nayar_roughness(double a, double b);

/* Tables of F0 and of the diffuse term's coefficients, a channel a row; nothing where the model has neither. */
void brdffit_cli_terms_report(struct cli_text *text, struct cli_style style, const struct cli_job *job);

/* A paragraph for data that an anisotropic lobe would fit, and for each lobe whose F0 the directions do not tell. */
void brdffit_cli_terms_warnings(struct cli_text *text, struct cli_style style, const struct cli_job *job);

/* "fresnel", "diffuse", "masking". */
void brdffit_cli_json_term_names(struct cli_json *json, const brdffit_options *options);

/* "azimuth_share", "sigma_xy", "anisotropy", "tangent_angle", "f0", "ior", "f0_interval", "x_more", where the model has them. */
void brdffit_cli_json_terms(struct cli_json *json, const struct cli_job *job);

#endif
