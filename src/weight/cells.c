/*
 * Solid angles by a k-d tree: see cells.h. SPDX-License-Identifier: MIT
 *
 * A model of ours is isotropic and sees no difference between mirror images, so a pair of directions above the horizon
 * is a point of the box n.l, n.v, |azimuth between them| / pi in [0, 1]^3, in which dw_l dw_v is the uniform measure.
 * The box is cut in two between two samples, as near to the median as samples that differ allow, and so on until each
 * piece holds one place. A piece is a box, so its share is a product; all of them together are 1, whatever rounds. The
 * samples of one place share its piece equally. Lights that are few and exact, a scan of views each, are told apart by
 * the first cuts between them, and what is left is a partition of the views of each.
 *
 * Cuts go across the longest side of what the samples of a piece span, as chords of the sphere measure it: of sqrt(1 -
 * cos), which is one over sqrt 2, and of azimuth times the sine of the view's. Known limits: beyond the outermost samples
 * a piece reaches to the horizon, so what lies at the edge of what was measured stands for what was not; samples in one
 * plane stand for the half turns of azimuth on either side.
 */
#include <math.h>

#include "base/atan.h"
#include "base/constants.h"
#include "base/vector.h"
#include "weight/cells.h"

/* Places closer than this are one: half of the digits of 1 - cos are left near the normal. */
#define SAME_PLACE 1e-8

/* Each cut leaves the larger part for later, so that there are never more than the digits of a count. */
#define MOST_PENDING 34

struct cell {
    size_t first, count; /* in each of the lists */
    double low[PLACE_COUNT], high[PLACE_COUNT];
};

void brdffit_cells_take(struct cells *cells, size_t count, struct arena *arena)
{
    int d;

    for (d = 0; d < PLACE_COUNT; d++) {
        cells->at[d] = ARENA_DOUBLES(arena, count);
        cells->order[d] = brdffit_arena_take(arena, count, sizeof *cells->order[d]);
    }
    cells->spare = brdffit_arena_take(arena, count, sizeof *cells->spare);
    cells->above = brdffit_arena_take(arena, count, 1);
    cells->placed = 0;
}

/* Of [0, pi], in units of pi: 2 atan sqrt((1 - cos) / (1 + cos)). */
static double turn_of(double cosine)
{
    if (!(cosine > -1.0)) {
        return 1.0;
    }
    return cosine < 1.0 ? 2.0 / PI * kernel_atan(sqrt((1.0 - cosine) / (1.0 + cosine))) : 0.0;
}

void brdffit_cells_place(struct cells *cells, size_t i, double cos_light, double cos_view, double cos_difference)
{
    double l = smaller(cos_light, 1.0), v = smaller(cos_view, 1.0);
    double sines = sqrt((1.0 - l) * (1.0 + l) * ((1.0 - v) * (1.0 + v)));
    double across = 2.0 * cos_difference * cos_difference - 1.0 - l * v; /* sines times the cosine of the azimuth */

    cells->at[PLACE_LIGHT][i] = sqrt(1.0 - l);
    cells->at[PLACE_VIEW][i] = sqrt(1.0 - v);
    cells->at[PLACE_TURN][i] = smaller(sines > 0.0 ? turn_of(across / sines) : 0.0, 1.0);
    cells->order[0][cells->placed++] = (uint32_t)i;
}

static double key(const struct cells *cells, int d, size_t position)
{
    return cells->at[d][cells->order[d][position]];
}

/* What the samples of a cell span, in chords. */
static double extent(const struct cells *cells, const struct cell *cell, int d)
{
    size_t first = cell->first, last = first + cell->count - 1;
    double span = key(cells, d, last) - key(cells, d, first);

    return d == PLACE_TURN ? 0.5 * PI * span * (key(cells, PLACE_VIEW, first) + key(cells, PLACE_VIEW, last)) : span;
}

/* How many samples lie below the cut that is nearest to the median, 0: no two are apart. */
static size_t find_cut(const struct cells *cells, const struct cell *cell, int d)
{
    size_t half = cell->count / 2, step;

    for (step = 0; step <= half; step++) {
        size_t below = half - step, above = half + step, end = cell->count, at = cell->first;

        if (below > 0 && key(cells, d, at + below) - key(cells, d, at + below - 1) > SAME_PLACE) {
            return below;
        }
        if (above > 0 && above < end && key(cells, d, at + above) - key(cells, d, at + above - 1) > SAME_PLACE) {
            return above;
        }
    }
    return 0;
}

/* The longest side that can be cut; 0 when none can. */
static size_t choose_cut(const struct cells *cells, const struct cell *cell, int *side)
{
    double length[PLACE_COUNT];
    int d, tried;

    for (d = 0; d < PLACE_COUNT; d++) {
        length[d] = extent(cells, cell, d);
    }
    for (tried = 0; tried < PLACE_COUNT; tried++) {
        size_t below;

        *side = length[1] > length[0] ? 1 : 0;
        *side = length[2] > length[*side] ? 2 : *side;
        below = find_cut(cells, cell, *side);
        if (below) {
            return below;
        }
        length[*side] = -1.0;
    }
    return 0;
}

/* Those below the cut first, each part in its order. */
static void divide_list(const struct cells *cells, uint32_t *list, size_t count)
{
    size_t i, below = 0, above = 0;

    for (i = 0; i < count; i++) {
        if (cells->above[list[i]]) {
            cells->spare[above++] = list[i];
        } else {
            list[below++] = list[i];
        }
    }
    for (i = 0; i < above; i++) {
        list[below + i] = cells->spare[i];
    }
}

/* *cell becomes its part below the cut, *rest the other one. */
static void divide(const struct cells *cells, struct cell *cell, struct cell *rest, int side, size_t below)
{
    size_t first = cell->first, i;
    int d;

    *rest = *cell;
    cell->high[side] = rest->low[side] = 0.5 * (key(cells, side, first + below - 1) + key(cells, side, first + below));
    for (i = 0; i < cell->count; i++) {
        cells->above[cells->order[side][first + i]] = i >= below;
    }
    for (d = 0; d < PLACE_COUNT; d++) {
        if (d != side) {
            divide_list(cells, cells->order[d] + first, cell->count);
        }
    }
    rest->first += below;
    rest->count -= below;
    cell->count = below;
}

/* (1 - cos) is the square of the coordinate. */
static double volume(const struct cell *cell)
{
    double product = cell->high[PLACE_TURN] - cell->low[PLACE_TURN];
    int d;

    for (d = PLACE_LIGHT; d <= PLACE_VIEW; d++) {
        product *= (cell->high[d] - cell->low[d]) * (cell->high[d] + cell->low[d]);
    }
    return product;
}

static void share_out(const struct cells *cells, const struct cell *cell, double *share)
{
    double each = volume(cell) / (double)cell->count;
    size_t i;

    for (i = 0; i < cell->count; i++) {
        share[cells->order[0][cell->first + i]] = each;
    }
}

static void put_in_order(struct cells *cells)
{
    size_t i;
    int d;

    for (d = 1; d < PLACE_COUNT; d++) {
        for (i = 0; i < cells->placed; i++) {
            cells->order[d][i] = cells->order[0][i];
        }
    }
    for (d = 0; d < PLACE_COUNT; d++) {
        uint32_t *sorted = brdffit_weight_sort(cells->at[d], cells->order[d], cells->spare, cells->placed);

        cells->spare = sorted == cells->spare ? cells->order[d] : cells->spare;
        cells->order[d] = sorted;
    }
}

void brdffit_cells_share(struct cells *cells, double *share)
{
    struct cell pending[MOST_PENDING], cell = {0, cells->placed, {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};
    size_t waiting = 0, below;
    int side;

    if (cells->placed == 0) {
        return;
    }
    put_in_order(cells);
    pending[waiting++] = cell;
    while (waiting > 0) {
        cell = pending[--waiting];
        while ((below = choose_cut(cells, &cell, &side)) > 0) {
            struct cell rest;

            divide(cells, &cell, &rest, side, below);
            pending[waiting++] = cell.count < rest.count ? rest : cell;
            cell = cell.count < rest.count ? cell : rest;
        }
        share_out(cells, &cell, share);
    }
}
