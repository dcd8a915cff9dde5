/*
 * Weights from uncertainties. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_CSV_WEIGHT_H
#define BRDFFIT_IO_CSV_WEIGHT_H

#include "io/table.h"

/* Divide *weight by the variance of sample i's radiance, uncertainty > 0 being that of its values. 0: no double. */
int brdffit_io_csv_weight(const struct io_table *table, size_t i, double uncertainty, double *weight);

/* Of the angle between a direction of sample i, IO_LIGHT or IO_VIEW, and its normal. */
double brdffit_io_csv_cosine(const struct io_table *table, enum io_array side, size_t i);

#endif
