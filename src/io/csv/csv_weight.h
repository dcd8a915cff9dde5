/*
 * Weights from uncertainties. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_CSV_WEIGHT_H
#define BRDFFIT_IO_CSV_WEIGHT_H

#include "io/table.h"

/* Divide *weight by the variance of sample i's radiance, uncertainty > 0 being that of its values. 0: no double. */
int brdffit_io_csv_weight(const struct io_table *table, size_t i, double uncertainty, double *weight);

#endif
