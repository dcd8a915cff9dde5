/*
 * The caller's structures as this version knows them: see base/intake.h. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_FIT_INTAKE_H
#define BRDFFIT_FIT_INTAKE_H

#include "brdffit.h"

/* What a message says of a structure that cannot be taken. */
#define INTAKE_REFUSED "NULL, without its struct_size, or asking for what this version does not know"

/* Copy *callers to *own. On failure BRDFFIT_ERR_ARGUMENT, and the message names the structure. */
brdffit_status brdffit_intake_samples(const brdffit_samples *callers, brdffit_samples *own, brdffit_error *error);
brdffit_status brdffit_intake_model(const brdffit_model *callers, brdffit_model *own, brdffit_error *error);
brdffit_status brdffit_intake_row(const brdffit_row *callers, brdffit_row *own, brdffit_error *error);
brdffit_status brdffit_intake_texels(const brdffit_texels *callers, brdffit_texels *own, brdffit_error *error);
brdffit_status brdffit_intake_texel_results(const brdffit_texel_results *callers, brdffit_texel_results *own,
                                            brdffit_error *error);
brdffit_status brdffit_intake_many_stats(const brdffit_many_stats *callers, brdffit_many_stats *own,
                                         brdffit_error *error);

/* NULL: the defaults. A list of distributions decides own->distribution too; whether the rest follows is checked by
 * brdffit_options_check(). */
brdffit_status brdffit_intake_options(const brdffit_options *callers, brdffit_options *own, brdffit_error *error);

#endif
