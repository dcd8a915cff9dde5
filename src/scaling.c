/*
 * Scaling of conic programs: see scaling.h.
 *
 * Geometric: every group and every column in turn is divided by the middle of the range of its exponents,
 * which converges within a few passes on programs of our shapes; a last pass brings the tops to [1, 2).
 * Layer 1. SPDX-License-Identifier: MIT
 */
#include "scaling.h"

#include <limits.h>
#include <math.h>

#define PASSES 8
#define IS_ZERO INT_MIN
/* Entries below 2^-60 of the top of a range do not count, or a rounding error beside a 1 would decide. */
#define NEGLIGIBLE 60

void brdffit_scaling_layout(struct scaling *scaling, struct arena *arena, const struct conic_shape *shape)
{
    scaling->variables = shape->variables;
    scaling->rows = brdffit_conic_rows(shape);
    scaling->entries = brdffit_conic_entries(shape);
    scaling->groups = shape->linear + shape->cones;
    scaling->column = brdffit_arena_take(arena, scaling->variables + 1, sizeof *scaling->column);
    scaling->row = brdffit_arena_take(arena, scaling->entries, sizeof *scaling->row);
    scaling->group = brdffit_arena_take(arena, scaling->rows, sizeof *scaling->group);
    scaling->exponent = brdffit_arena_take(arena, scaling->entries, sizeof *scaling->exponent);
    scaling->group_scale = brdffit_arena_take(arena, scaling->groups, sizeof *scaling->group_scale);
    scaling->column_scale = brdffit_arena_take(arena, scaling->variables, sizeof *scaling->column_scale);
    scaling->range = brdffit_arena_take(arena, scaling->groups, sizeof *scaling->range);
}

void brdffit_scaling_start(struct scaling *scaling, const struct conic_shape *shape)
{
    size_t row = shape->linear;
    size_t i, j;

    for (j = 0; j <= scaling->variables; j++) {
        scaling->column[j] = shape->column ? shape->column[j] : j * scaling->rows;
    }
    for (i = 0; i < scaling->entries; i++) {
        scaling->row[i] = shape->row ? shape->row[i] : i % scaling->rows;
    }
    for (i = 0; i < shape->linear; i++) {
        scaling->group[i] = i;
    }
    for (i = 0; i < shape->cones; i++) {
        for (j = 0; j < shape->cone[i]; j++) {
            scaling->group[row++] = shape->linear + i;
        }
    }
}

static const struct scaling_range NOTHING = {INT_MAX, INT_MIN};

static void widen(struct scaling_range *range, int exponent)
{
    range->low = exponent < range->low ? exponent : range->low;
    range->high = exponent > range->high ? exponent : range->high;
}

/* What to take off: the middle of the range, or its top. */
static int excess(struct scaling_range range, int to_top)
{
    int low = range.low;

    if (range.low > range.high) {
        return 0;
    }
    low = low < range.high - NEGLIGIBLE ? range.high - NEGLIGIBLE : low;
    return to_top ? range.high : (low + range.high) / 2;
}

/* Exponent of entry k of column j with the scales so far, added to a range; zeros have none. */
static void see(const struct scaling *scaling, size_t j, size_t k, struct scaling_range *range)
{
    if (scaling->exponent[k] != IS_ZERO) {
        widen(range, scaling->exponent[k] - scaling->group_scale[scaling->group[scaling->row[k]]] -
                         scaling->column_scale[j]);
    }
}

/* One pass over the groups, then one over the columns. */
static void balance(struct scaling *scaling, int to_top)
{
    size_t i, j, k;

    for (i = 0; i < scaling->groups; i++) {
        scaling->range[i] = NOTHING;
    }
    for (j = 0; j < scaling->variables; j++) {
        for (k = scaling->column[j]; k < scaling->column[j + 1]; k++) {
            see(scaling, j, k, &scaling->range[scaling->group[scaling->row[k]]]);
        }
    }
    for (i = 0; i < scaling->groups; i++) {
        scaling->group_scale[i] += excess(scaling->range[i], to_top);
    }
    for (j = 0; j < scaling->variables; j++) {
        struct scaling_range range = NOTHING;

        for (k = scaling->column[j]; k < scaling->column[j + 1]; k++) {
            see(scaling, j, k, &range);
        }
        scaling->column_scale[j] += excess(range, to_top);
    }
}

static void find_scales(struct scaling *scaling, const double *g)
{
    size_t i;
    int pass;

    for (i = 0; i < scaling->entries; i++) {
        scaling->exponent[i] = g[i] != 0.0 ? ilogb(g[i]) : IS_ZERO;
    }
    for (i = 0; i < scaling->groups; i++) {
        scaling->group_scale[i] = 0;
    }
    for (i = 0; i < scaling->variables; i++) {
        scaling->column_scale[i] = 0;
    }
    for (pass = 1; pass <= PASSES; pass++) {
        balance(scaling, pass == PASSES);
    }
}

/* Bring the largest magnitude to [1, 2); returns the exponent taken off. */
static int scale_whole(double *value, size_t count)
{
    double largest = 0.0;
    int exponent;
    size_t i;

    for (i = 0; i < count; i++) {
        largest = fmax(largest, fabs(value[i]));
    }
    exponent = largest > 0.0 ? ilogb(largest) : 0;
    for (i = 0; i < count; i++) {
        value[i] = ldexp(value[i], -exponent);
    }
    return exponent;
}

void brdffit_scaling_apply(struct scaling *scaling, const struct conic_data *data, double *g, double *c, double *h)
{
    size_t i, j, k;

    find_scales(scaling, data->g);
    for (j = 0; j < scaling->variables; j++) {
        for (k = scaling->column[j]; k < scaling->column[j + 1]; k++) {
            int group = scaling->group_scale[scaling->group[scaling->row[k]]];

            g[k] = ldexp(data->g[k], -(group + scaling->column_scale[j]));
        }
        c[j] = ldexp(data->c[j], -scaling->column_scale[j]);
    }
    for (i = 0; i < scaling->rows; i++) {
        h[i] = ldexp(data->h[i], -scaling->group_scale[scaling->group[i]]);
    }
    scaling->c_scale = scale_whole(c, scaling->variables);
    scaling->h_scale = scale_whole(h, scaling->rows);
}

void brdffit_scaling_undo(const struct scaling *scaling, const double *scaled_x, const double *scaled_z, double *x, double *z)
{
    size_t i;

    for (i = 0; i < scaling->variables; i++) {
        x[i] = ldexp(scaled_x[i], scaling->h_scale - scaling->column_scale[i]);
    }
    for (i = 0; i < scaling->rows; i++) {
        z[i] = ldexp(scaled_z[i], scaling->c_scale - scaling->group_scale[scaling->group[i]]);
    }
}
