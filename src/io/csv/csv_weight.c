/*
 * Weights from uncertainties: see csv_weight.h. SPDX-License-Identifier: MIT
 *
 * Residuals are of radiance, so w = 1 / var(I): with I = f_r (n.l) the standard deviation of f_r is multiplied by n.l.
 */
#include "io/csv/csv_weight.h"

#include <math.h>

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* In units of its largest component, so that no length overflows. */
static void scaled(const double *in, double *out)
{
    double largest = fmax(fabs(in[0]), fmax(fabs(in[1]), fabs(in[2])));
    int d;

    for (d = 0; d < 3; d++) {
        out[d] = in[d] / largest;
    }
}

double brdffit_io_csv_cosine(const struct io_table *table, enum io_array side, size_t i)
{
    static const double up[3] = {0.0, 0.0, 1.0};
    double direction[3], normal[3];

    scaled(table->array[side] + 3 * i, direction);
    scaled(table->width[IO_NORMAL] ? table->array[IO_NORMAL] + 3 * i : up, normal);
    return dot(direction, normal) / sqrt(dot(direction, direction) * dot(normal, normal));
}

/* What turns a value into radiance; 1 below the horizon, where no fit uses the sample. */
static double to_radiance(const struct io_table *table, size_t i)
{
    double cosine;

    if (table->samples.quantity == BRDFFIT_QUANTITY_RADIANCE) {
        return 1.0;
    }
    cosine = brdffit_io_csv_cosine(table, IO_LIGHT, i);
    return cosine > 0.0 ? cosine : 1.0;
}

int brdffit_io_csv_weight(const struct io_table *table, size_t i, double uncertainty, double *weight)
{
    double deviation = uncertainty * to_radiance(table, i), found = *weight / deviation / deviation;

    if (!isfinite(found) || (found == 0.0 && *weight > 0.0)) {
        return 0;
    }
    *weight = found;
    return 1;
}
