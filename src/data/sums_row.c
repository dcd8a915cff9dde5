/*
 * Rows of tables to sums: see brdffit_row of brdffit.h, and table_row.h. SPDX-License-Identifier: MIT
 *
 * A row is one group. Its totals run in lanes over all of its strips, and join the group at the end with the factors
 * that they share: a = l / pi, b = factor x the strip's b (model/geometry.h).
 */
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "model/geometry.h"
#include "model/lobe.h"
#include "data/sums.h"
#include "base/tolerance.h"

#define PI 3.14159265358979323846

static int in_order(double low, double x, double high)
{
    return x >= low && x <= high;
}

static brdffit_status check_row(const struct brdffit_sums *s, const brdffit_row *row, brdffit_error *error)
{
    size_t i, most = (size_t)-1 / sizeof(double);
    int fine = 1;

    if (!s || !row->sin_difference || !row->cos_difference || !row->cos_azimuth || !row->entries || !row->scale) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "row: sums or something in it is NULL");
    }
    if (row->differences == 0 || row->azimuths == 0 || row->differences > most / row->azimuths) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "row: no cells, or more than can be addressed");
    }
    fine = in_order(0.0, row->sin_half, 1.0) && in_order(0.0, row->cos_half, 1.0) && in_order(0.0, row->horizon, 1.0);
    for (i = 0; i < row->differences; i++) {
        fine = fine && in_order(0.0, row->sin_difference[i], 1.0) && in_order(0.0, row->cos_difference[i], 1.0);
    }
    for (i = 0; i < row->azimuths; i++) {
        fine = fine && in_order(-1.0, row->cos_azimuth[i], 1.0);
    }
    for (i = 0; i < s->channels; i++) {
        fine = fine && row->entries[i] && row->scale[i] > 0.0 && isfinite(row->scale[i]);
    }
    return fine ? BRDFFIT_OK
                : brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "row: a sine, cosine or scale is out of range");
}

/* The azimuths of one strip after another, up to TABLE_ROW_CELLS at a time. */
struct columns {
    size_t first, cells;
    double cosine[TABLE_ROW_CELLS], low[TABLE_ROW_BLOCKS], high[TABLE_ROW_BLOCKS];
};

static void open_columns(struct columns *c, const brdffit_row *row, size_t first)
{
    size_t p, block;

    c->first = first;
    c->cells = row->azimuths - first < TABLE_ROW_CELLS ? row->azimuths - first : TABLE_ROW_CELLS;
    for (p = 0; p < PADDED(c->cells); p++) {
        block = p / LANES;
        c->cosine[p] = p < c->cells ? row->cos_azimuth[first + p] : (double)NAN;
        if (p % LANES == 0) {
            c->low[block] = c->high[block] = c->cosine[p];
        } else if (p < c->cells) {
            c->low[block] = fmin(c->low[block], c->cosine[p]);
            c->high[block] = fmax(c->high[block], c->cosine[p]);
        }
    }
}

static void add_strips(struct brdffit_sums *s, const brdffit_row *row, const struct geometry_table_row *shared,
                       const struct columns *c)
{
    struct strip strip;
    size_t d;

    strip.kind = shared->kind;
    strip.horizon = row->horizon > LIMIT_GRAZING ? row->horizon : LIMIT_GRAZING;
    strip.min_cosine = s->min_cosine;
    strip.cells = c->cells;
    strip.cosine = c->cosine;
    strip.low = c->low;
    strip.high = c->high;
    strip.channels = s->channels;
    strip.plane = (const unsigned char *const *)row->entries;
    strip.scale = row->scale;
    for (d = 0; d < row->differences; d++) {
        strip.first = d * row->azimuths + c->first;
        strip.readable = row->differences * row->azimuths - strip.first;
        strip.upright = row->cos_half * row->cos_difference[d];
        strip.across = row->sin_half * row->sin_difference[d];
        strip.shared = row->cos_difference[d] > 0.0 ? shared->shared / row->cos_difference[d] : 0.0;
        s->kernels->add(&strip, &s->totals);
    }
}

/* The first entry that is not finite, for the message. */
static brdffit_status find_bad(const struct brdffit_sums *s, const brdffit_row *row, brdffit_error *error)
{
    size_t i, k, cells = row->differences * row->azimuths;

    for (k = 0; k < s->channels; k++) {
        for (i = 0; i < cells; i++) {
            double entry;

            memcpy(&entry, (const unsigned char *)row->entries[k] + i * sizeof entry, sizeof entry);
            if (!isfinite(entry)) {
                return brdffit_fail_at(error, "an entry of the row is not finite", i, k, entry);
            }
        }
    }
    return BRDFFIT_OK; /* only their sum was beyond a double */
}

static double lane_largest(const double *lane)
{
    double largest = 0.0;
    size_t i;

    for (i = 0; i < LANES; i++) {
        largest = lane[i] > largest ? lane[i] : largest;
    }
    return largest;
}

static brdffit_status check_totals(const struct brdffit_sums *s, const brdffit_row *row, brdffit_error *error)
{
    const struct table_row_totals *t = &s->totals;
    brdffit_status status = BRDFFIT_OK;
    size_t k;

    if (!isfinite(lanes_total_of(t->seen))) {
        status = find_bad(s, row, error);
    }
    for (k = 0; k < s->channels && status == BRDFFIT_OK; k++) {
        double largest = lane_largest(t->largest + k * LANES);

        if (!(largest <= LIMIT_SUMS_VALUE)) {
            status = brdffit_fail_at(error, "a value of sums must be within 1e100", BRDFFIT_NONE, k, largest);
        }
    }
    return status;
}

/* Lanes of sum `which`, times the factor it shares, to the pair. */
static void collect(const struct table_row_totals *t, size_t which, double factor, struct sums_pair *pair)
{
    struct sums_pair sum = {0.0, 0.0};
    size_t i;

    for (i = 0; i < LANES; i++) {
        sums_add(&sum, t->high[which * LANES + i]);
        sum.low += t->low[which * LANES + i];
    }
    sums_add(pair, sum.high * factor);
    pair->low += sum.low * factor;
}

/* No table is so fine that a cell above its horizon has n.l or n.v below this. */
#define ROW_GRAZE 1e-8

/*
 * Errors of a row's cells, its sines and cosines taken as exact: n.l and n.v are off by 5 u at most, four roundings of
 * numbers below 1. Where the light is above min_cosine, b of V-cavities has n.v below n.l cancelled, or n.v above
 * (v.h) / (2 n.h); Ward's has not. c is within 16 u, and all cells share its error.
 */
static void note_row_errors(struct brdffit_sums *s, size_t group, const struct geometry_table_row *shared)
{
    double off = 5.0 * TOL_UNIT / fmax(s->min_cosine, ROW_GRAZE);
    struct sums_errors errors = {16.0 * off, 16.0 * TOL_UNIT * shared->c, 0.0};

    if (shared->kind == TABLE_ROW_ROOT) {
        errors.b = 5.0 * TOL_UNIT / ROW_GRAZE;
    }
    if (s->errors[group].spread > 0.0) {
        errors.spread = errors.c;
    }
    s->light_error = fmax(s->light_error, off + 2.0 * TOL_UNIT);
    sums_note_errors(&s->errors[group], &errors);
}

static void join(struct brdffit_sums *s, size_t group, double factor)
{
    struct sums_pair *product = sums_group(s, group);
    const struct table_row_totals *t = &s->totals;
    size_t k;

    collect(t, 0, 1.0 / (PI * PI), &product[SUMS_AA]);
    collect(t, 1, factor / PI, &product[SUMS_AB]);
    collect(t, 2, factor * factor, &product[SUMS_BB]);
    collect(t, 3, (factor * factor) * (factor * factor), &product[SUMS_B4]);
    for (k = 0; k < s->channels; k++) {
        struct sums_pair *channel = product + SUMS_CHANNEL + SUMS_PER_CHANNEL * k;

        collect(t, 4 + 3 * k, 1.0 / PI, &channel[SUMS_AI]);
        collect(t, 5 + 3 * k, factor, &channel[SUMS_POSITIVE]);
        collect(t, 6 + 3 * k, 1.0, &channel[SUMS_II]);
        s->largest[k] = fmax(s->largest[k], lane_largest(t->largest + k * LANES));
        s->magnitude[k] = fmax(s->magnitude[k], s->largest[k]);
    }
    sums_add(&s->weight, (double)t->used);
    s->largest_weight = fmax(s->largest_weight, 1.0);
    s->used += (size_t)t->used;
}

static void sweep(struct brdffit_sums *s, const brdffit_row *row, const struct geometry_table_row *shared)
{
    struct columns columns;
    size_t first;

    memset(s->totals_memory, 0, TABLE_ROW_TOTALS_DOUBLES(s->channels) * sizeof(double));
    s->totals.used = s->totals.below = s->totals.absent = 0;
    for (first = 0; first < row->azimuths; first += columns.cells) {
        open_columns(&columns, row, first);
        add_strips(s, row, shared, &columns);
    }
}

brdffit_status brdffit_sums_add_row_run(brdffit_sums *s, const brdffit_row *row, size_t cells[BRDFFIT_CELL_COUNT],
                                        brdffit_error *error)
{
    brdffit_status status = check_row(s, row, error);
    struct geometry_table_row shared;
    double tangent;
    size_t group, all, samples;

    if (status != BRDFFIT_OK) {
        return status;
    }
    if (s->bits) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "rows share their c and need no bins");
    }
    tangent = row->sin_half / row->cos_half;
    if (!(tangent * tangent <= LIMIT_C)) {
        return brdffit_fail_at(error, "tan^2 alpha of a row must be at most 1e100", BRDFFIT_NONE, BRDFFIT_NONE,
                               tangent);
    }
    if (!brdffit_geometry_table_row(s->distribution, tangent * tangent, &shared)) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "rows of this distribution have no c of their own");
    }
    if (!(shared.factor <= LIMIT_SUMS_RANGE * fmax(row->horizon, LIMIT_GRAZING))) {
        return brdffit_fail_at(error, "b of sums must be at most 1e50", BRDFFIT_NONE, BRDFFIT_NONE, shared.factor);
    }
    sweep(s, row, &shared);
    status = check_totals(s, row, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (s->totals.used > 0) {
        group = brdffit_sums_find(s, shared.c);
        if (group == s->capacity) {
            return brdffit_fail(error, BRDFFIT_ERR_WORKSPACE,
                                "the rows have more distinct c than the sums have groups");
        }
        join(s, group, shared.factor);
        note_row_errors(s, group, &shared);
    }
    all = row->differences * row->azimuths;
    samples = all - (size_t)(s->totals.below + s->totals.absent);
    s->skipped[BRDFFIT_SKIP_INCIDENCE] += samples - (size_t)s->totals.used;
    if (cells) {
        cells[BRDFFIT_CELL_SAMPLE] += samples;
        cells[BRDFFIT_CELL_BELOW_HORIZON] += (size_t)s->totals.below;
        cells[BRDFFIT_CELL_ABSENT] += (size_t)s->totals.absent;
    }
    return BRDFFIT_OK;
}
