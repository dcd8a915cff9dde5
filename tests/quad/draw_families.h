/*
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_TESTS_DRAW_FAMILIES_H
#define BRDFFIT_TESTS_DRAW_FAMILIES_H

#include "draw.h"

void draw_ordinary(struct draw *d);
void draw_relative(struct draw *d);
void draw_spans(struct draw *d);
void draw_units(struct draw *d);
void draw_no_mirror(struct draw *d);
void draw_near_equal(struct draw *d);
void draw_channels(struct draw *d);
void draw_gaps(struct draw *d);
void draw_grazing(struct draw *d);
void draw_degenerate(struct draw *d);
void draw_batch(struct draw *d);
void draw_columns(struct draw *d);
void draw_columns_edges(struct draw *d);
void draw_columns_batch(struct draw *d);

#endif
