/* truth.h: truth.json, what the files were made from.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_GONIO_TRUTH_H
#define BRDFFIT_GONIO_TRUTH_H

#include "instrument.h"

void brdffit_gonio_truth_begin(struct gonio_file *file, uint64_t seed);

/* `wrong` NULL: no outliers (a MERL table). */
void brdffit_gonio_truth_add(struct gonio_file *file, const struct gonio_recipe *recipe, const unsigned char *wrong,
                             int first);
void brdffit_gonio_truth_end(struct gonio_file *file);

#endif
