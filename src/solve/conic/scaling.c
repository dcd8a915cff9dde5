/*
 * Scaling of conic programs: see scaling.h.
 *
 * Geometric: every group and every column in turn is divided by the middle of the range of its exponents,
 * which converges within a few passes on programs of our shapes; a last pass brings the tops to [1, 2).
 * h takes part as one more column and c as one more row: without them, parts of a program that G does not
 * connect would keep whatever relative scale they came with.
 * SPDX-License-Identifier: MIT
 */
#include "solve/conic/scaling.h"

#include <limits.h>
#include <math.h>

#define PASSES 8
#define IS_ZERO INT_MIN
/* A range wider than 2^100 has no useful middle: its top decides. */
#define WIDE 100

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
    scaling->h_exponent = brdffit_arena_take(arena, scaling->rows, sizeof *scaling->h_exponent);
    scaling->c_exponent = brdffit_arena_take(arena, scaling->variables, sizeof *scaling->c_exponent);
    scaling->group_scale = brdffit_arena_take(arena, scaling->groups, sizeof *scaling->group_scale);
    scaling->column_scale = brdffit_arena_take(arena, scaling->variables, sizeof *scaling->column_scale);
    scaling->range = brdffit_arena_take(arena, scaling->groups, sizeof *scaling->range);
}

void brdffit_scaling_start(struct scaling *scaling, const struct conic_shape *shape)
{
    size_t row = shape->linear;
    size_t i, j;

    scaling->trusted = 0;
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
    if (range.low > range.high) {
        return 0;
    }
    return to_top || range.low < range.high - WIDE ? range.high : (range.low + range.high) / 2;
}

static int exponent_of(double value)
{
    return value != 0.0 ? ilogb(value) : IS_ZERO;
}

/* What is left of an exponent after a scale of its row and one of its column, added to a range. */
static void see(struct scaling_range *range, int exponent, int row_scale, int column_scale)
{
    if (exponent != IS_ZERO) {
        widen(range, exponent - row_scale - column_scale);
    }
}

static void balance_groups(struct scaling *scaling, int to_top)
{
    size_t i, j, k;

    for (i = 0; i < scaling->groups; i++) {
        scaling->range[i] = NOTHING;
    }
    for (i = 0; i < scaling->rows; i++) {
        size_t p = scaling->group[i];

        see(&scaling->range[p], scaling->h_exponent[i], scaling->group_scale[p], scaling->h_scale);
    }
    for (j = 0; j < scaling->variables; j++) {
        for (k = scaling->column[j]; k < scaling->column[j + 1]; k++) {
            size_t p = scaling->group[scaling->row[k]];

            see(&scaling->range[p], scaling->exponent[k], scaling->group_scale[p], scaling->column_scale[j]);
        }
    }
    for (i = 0; i < scaling->groups; i++) {
        scaling->group_scale[i] += excess(scaling->range[i], to_top);
    }
}

static void balance_columns(struct scaling *scaling, int to_top)
{
    size_t j, k;

    for (j = 0; j < scaling->variables; j++) {
        struct scaling_range range = NOTHING;

        see(&range, scaling->c_exponent[j], scaling->c_scale, scaling->column_scale[j]);
        for (k = scaling->column[j]; k < scaling->column[j + 1]; k++) {
            see(&range, scaling->exponent[k], scaling->group_scale[scaling->group[scaling->row[k]]],
                scaling->column_scale[j]);
        }
        scaling->column_scale[j] += excess(range, to_top);
    }
}

static void balance_vectors(struct scaling *scaling)
{
    struct scaling_range h = NOTHING, c = NOTHING;
    size_t i;

    for (i = 0; i < scaling->rows; i++) {
        see(&h, scaling->h_exponent[i], scaling->group_scale[scaling->group[i]], scaling->h_scale);
    }
    for (i = 0; i < scaling->variables; i++) {
        see(&c, scaling->c_exponent[i], scaling->c_scale, scaling->column_scale[i]);
    }
    scaling->h_scale += excess(h, 0);
    scaling->c_scale += excess(c, 0);
}

static void find_scales(struct scaling *scaling, const struct conic_data *data)
{
    size_t i;
    int pass;

    for (i = 0; i < scaling->entries; i++) {
        scaling->exponent[i] = exponent_of(data->g[i]);
    }
    for (i = 0; i < scaling->rows; i++) {
        scaling->h_exponent[i] = exponent_of(data->h[i]);
    }
    for (i = 0; i < scaling->groups; i++) {
        scaling->group_scale[i] = 0;
    }
    for (i = 0; i < scaling->variables; i++) {
        scaling->c_exponent[i] = exponent_of(data->c[i]);
        scaling->column_scale[i] = 0;
    }
    scaling->h_scale = scaling->c_scale = 0;
    for (pass = 1; pass <= PASSES && !scaling->trusted; pass++) {
        balance_vectors(scaling);
        balance_groups(scaling, pass == PASSES);
        balance_columns(scaling, pass == PASSES);
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

    find_scales(scaling, data);
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

void brdffit_scaling_undo(const struct scaling *scaling, const double *scaled_x, const double *scaled_z, double *x,
                          double *z)
{
    size_t i;

    for (i = 0; i < scaling->variables; i++) {
        x[i] = ldexp(scaled_x[i], scaling->h_scale - scaling->column_scale[i]);
    }
    for (i = 0; i < scaling->rows; i++) {
        z[i] = ldexp(scaled_z[i], scaling->c_scale - scaling->group_scale[scaling->group[i]]);
    }
}
