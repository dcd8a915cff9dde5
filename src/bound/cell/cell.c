/*
 * Enclosures over cells: see cell.h. SPDX-License-Identifier: MIT
 *
 * With x_d = -d ln phi / d s_d, slope_d = d^2 ln phi / d s_d^2 and means under p = bb phi^2 / H, a functional
 * W~ = sum W phi / sqrt(H), W >= 0, has along coordinate d (theory 4.2, 7.5; the other coordinates only stand there)
 *
 *     W~'' = sum W [(x - mean)^2 + slope] g^  -  [E slope + 2 Var x] W~
 *
 * On a cell x_d and slope_d fall with every coordinate: each is between its values at the highest corner and at the lowest.
 * So does phi, but unit columns do not care for a scalar, and phi times exp(m.s), or (1 + m.s)^2 of GGX, with m the mean of x
 * in the middle, hardly changes where the lobe is: along each coordinate that is monotone in any case (log-linear, or the square
 * of a linear fraction), so that its range is that of its values at the corners. From it follows that of H. A mean does not fall
 * with other coordinates than its own: it is enclosed from a number m in the middle,
 *
 *     mean - m = sum p (x - m),    p between bb phi_inf^2 / H_sup and bb phi_sup^2 / H_inf,
 *
 * each term at the end that is worse. What follows from ranges of x, of slope and of the mean are the sums of interval_family.c.
 */
#include "bound/cell/cell.h"

#include <math.h>

#include "base/exp.h"
#include "base/tolerance.h"
#include "base/vector.h"

#define UP (1.0 + TOL_CURVATURE)
#define DOWN (1.0 - TOL_CURVATURE)
/* Norms below it are of squares near the smallest double. */
#define LEAST_ROOT 1e-140

/* A cell being filled: its corners, the lowest and the highest first of all, and x and slope at those by coordinate d. */
struct work {
    struct bound_cell *engine;
    const struct cell_lobe *lobe;
    struct cell *cell;
    const struct cell_node *low, *high, *corner[CORNERS_MOST];
    struct local at;
    double *sup[EACH_MOST], *inf[EACH_MOST]; /* functionals: ranges of W~ */
};

static double square(double x)
{
    return x * x;
}

/* What phi at corner is multiplied by: 1 at the lowest one. m: means of x there and here, in the middle of them all. */
static double scalar_at(const struct work *w, unsigned corner, const double *m)
{
    double exponent = 0.0, base = 0.0;
    int d;

    for (d = 0; d < w->lobe->shapes; d++) {
        base += m[d] * w->low->s[d];
        exponent += m[d] * (w->corner[corner]->s[d] - w->low->s[d]);
    }
    return w->lobe->kind->exponential ? kernel_exp(smaller(exponent, 700.0)) : square(1.0 + exponent / (1.0 + base));
}

/* The c that the lobe has in the middle of the cell: the mean of x, which of GGX is 2 c / (1 + E). */
static void middle_of(const struct work *w, double *m)
{
    unsigned corner, corners = 1u << w->lobe->shapes;
    int d;

    for (d = 0; d < w->lobe->shapes; d++) {
        m[d] = 0.0;
        for (corner = 0; corner < corners; corner++) {
            m[d] += w->corner[corner]->mean[0][d] / corners;
        }
    }
    if (!w->lobe->kind->exponential) {
        double x = 0.0;

        for (d = 0; d < w->lobe->shapes; d++) {
            x += 0.25 * m[d] * (w->low->s[d] + w->high->s[d]); /* = E / (1 + E) about there */
        }
        for (d = 0; d < w->lobe->shapes; d++) {
            m[d] = 0.5 * m[d] / (1.0 - smaller(x, 0.999));
        }
    }
}

/*
 * The range of the norm of column j of an exponential lobe: ln H of phi exp(m.s) is convex, so that it is largest at a corner,
 * and nowhere below its tangent plane at any, whose slopes are -2 (mean - m).
 */
static void exponential_norms(const struct work *w, int j, const double *m)
{
    unsigned corner, corners = 1u << w->lobe->shapes;
    double most = 0.0, least = 0.0;
    int d;

    for (corner = 0; corner < corners; corner++) {
        double root = w->corner[corner]->root[j] * scalar_at(w, corner, m), fall = 0.0;

        for (d = 0; d < w->lobe->shapes; d++) {
            double width = w->high->s[d] - w->low->s[d], step = corner >> d & 1u ? -width : width;

            fall += larger(0.0, (w->corner[corner]->mean[j][d] - m[d]) * step);
        }
        most = larger(most, root);
        least = larger(least, root * kernel_exp(-smaller(fall, 700.0)));
    }
    w->cell->root_sup[j] = smaller(w->cell->root_sup[j], UP * most);
    w->cell->root_inf[j] = larger(w->cell->root_inf[j], DOWN * least);
}

/* Ranges of phi by group, and of the norms. */
static void fill_shape(struct work *w)
{
    const struct moments *m = &w->engine->moments;
    unsigned corner, corners = 1u << w->lobe->shapes;
    double *sup = w->cell->sup, *inf = w->cell->inf, middle[SHAPES_MOST], first;
    size_t i, n = m->data->stride;
    int j;

    middle_of(w, middle);
    for (i = 0; i < n; i++) {
        sup[i] = inf[i] = w->low->phi[i];
    }
    for (corner = 1; corner < corners; corner++) {
        const double *phi = w->corner[corner]->phi;
        double scalar = scalar_at(w, corner, middle);

        for (i = 0; i < n; i++) {
            double value = phi[i] * scalar;

            sup[i] = value > sup[i] ? value : sup[i];
            inf[i] = value < inf[i] ? value : inf[i];
        }
    }
    for (j = 0; j < w->engine->model->each; j++) {
        const double *bb = w->lobe->table[j]->bb;

        w->cell->root_sup[j] = UP * sqrt(m->kernels->weigh(bb, sup, sup, n, &first));
        w->cell->root_inf[j] = DOWN * sqrt(m->kernels->weigh(bb, inf, inf, n, &first));
        if (w->lobe->kind->exponential) {
            exponential_norms(w, j, middle);
        }
    }
}

static void open_slopes(struct work *w, int d)
{
    double *scratch = w->engine->scratch + w->engine->moments.data->stride;
    size_t n = w->engine->moments.data->stride;

    w->at.x_low = brdffit_cell_slopes(w->engine, w->cell->lobe, w->low, d, scratch, &w->at.slope_low);
    w->at.x_high = brdffit_cell_slopes(w->engine, w->cell->lobe, w->high, d, scratch + 2 * n, &w->at.slope_high);
}

/* [inf, sup] of the mean of x_d under column j. */
static void enclose_mean(const struct work *w, int j, int d, double range[2])
{
    const double *bb = w->lobe->table[j]->bb, *sup = w->cell->sup, *inf = w->cell->inf;
    double most = w->low->mean[j][d], least = w->high->mean[j][d], m = 0.0, above = 0.0, below = 0.0;
    double larger_p = 1.0 / square(w->cell->root_inf[j]), smaller_p = 1.0 / square(w->cell->root_sup[j]);
    unsigned corner, corners = 1u << w->lobe->shapes;
    size_t i, n = w->engine->moments.data->stride;

    if (corners > 2) {
        for (corner = 0; corner < corners; corner++) {
            m += w->corner[corner]->mean[j][d] / corners;
        }
        for (i = 0; i < n; i++) {
            double up = w->at.x_low[i] - m, down = w->at.x_high[i] - m;
            double p = bb[i] * square(sup[i]) * larger_p, q = bb[i] * square(inf[i]) * smaller_p;

            above += up > 0.0 ? p * up : q * up;
            below += down < 0.0 ? p * down : q * down;
        }
        most = m + above;
        least = m + below;
    }
    range[1] = most + TOL_CURVATURE * fabs(most);
    range[0] = larger(0.0, least - TOL_CURVATURE * fabs(least));
}

/* W~'' of functional f of column j: its supremum, and its infimum in *low. */
static double functional(const struct work *w, int j, size_t f, const double curvature[2], double *low)
{
    const struct moments *m = &w->engine->moments;
    double sum[2];

    m->kernels->functional_curvature(w->lobe->table[j]->linear + f * m->data->stride, w->cell->sup, w->cell->inf,
                                     &w->at, m->data->stride, sum);
    *low = DOWN * sum[0] / w->cell->root_sup[j] - UP * curvature[1] * w->sup[j][f];
    return UP * sum[1] / w->cell->root_inf[j] - DOWN * curvature[0] * w->inf[j][f];
}

/* How far kappa may fall below its chord along d, and tau rise above it. */
static void fill_shifts(const struct work *w, int j, int d, const double curvature[2])
{
    const struct moments *m = &w->engine->moments;
    size_t k, f, K = m->data->bounded, F = (size_t)m->data->fixed;
    struct cell *cell = w->cell;
    double low, curved;

    for (f = 0; f < F; f++) {
        double above = functional(w, j, f, curvature, &low);

        cell->kappa_shift[j][(size_t)d * F + f] = cell->eighth[d] * (above * m->inverse_a[f]);
    }
    for (k = 0; k < K; k++) {
        (void)functional(w, j, F + k, curvature, &low);
        curved = -low;
        if (m->data->functionals > F + K) {
            curved += functional(w, j, F + K + k, curvature, &low);
        }
        cell->tau_shift[j][d][k] = cell->eighth[d] * curved;
    }
}

static void fill_coordinate(struct work *w, int d)
{
    const struct moments *m = &w->engine->moments;
    struct cell *cell = w->cell;
    double sum[2], curvature[2];
    int j;

    open_slopes(w, d);
    for (j = 0; j < w->engine->model->each; j++) {
        enclose_mean(w, j, d, cell->mean[j][d]);
        w->at.mean_low = cell->mean[j][d][1];
        w->at.mean_high = cell->mean[j][d][0];
        m->kernels->curvature(w->lobe->table[j]->bb, cell->sup, cell->inf, &w->at, m->data->stride, sum);
        curvature[0] = DOWN * sum[0] / square(cell->root_sup[j]);
        curvature[1] = UP * sum[1] / square(cell->root_inf[j]);
        cell->curvature[j][d] = curvature[0];
        fill_shifts(w, j, d, curvature);
    }
}

/* The cosine of the lobe's two columns: see fill_beside() of interval.c. */
static void fill_beside(struct work *w)
{
    const struct moments *m = &w->engine->moments;
    struct cell *cell = w->cell;
    double narrow = cell->root_inf[0] * cell->root_inf[1], wide = cell->root_sup[0] * cell->root_sup[1], sum[2], first;
    int d, g = w->engine->model->geometry[model_kind_of(w->engine->model, cell->lobe * w->engine->model->each)];
    const double *cross = reduced_cross(m->data, m->data->bases + g, g);

    sum[0] = m->kernels->weigh(cross, cell->inf, cell->inf, m->data->stride, &first);
    cell->beside_least = larger(0.0, DOWN * sum[0] / wide - 4.0 * cell->epsilon);
    for (d = 0; d < w->lobe->shapes; d++) {
        open_slopes(w, d);
        w->at.mean_low = 0.5 * (cell->mean[0][d][1] + cell->mean[1][d][1]);
        w->at.mean_high = 0.5 * (cell->mean[0][d][0] + cell->mean[1][d][0]);
        m->kernels->curvature(cross, cell->sup, cell->inf, &w->at, m->data->stride, sum);
        cell->beside_shift[d] = cell->eighth[d] *
                                (UP * (2.0 * sum[1] / narrow) -
                                 DOWN * ((cell->curvature[0][d] + cell->curvature[1][d]) * cell->beside_least));
    }
}

/* Ranges of the functionals of column j, and what they say of kappa and tau. */
static void fill_ranges(const struct work *w, int j)
{
    const struct moments *m = &w->engine->moments;
    const double *linear = w->lobe->table[j]->linear;
    size_t k, f, n = m->data->stride, K = m->data->bounded, F = (size_t)m->data->fixed;

    for (f = 0; f < m->data->functionals; f++) {
        w->sup[j][f] = UP * m->kernels->dot(linear + f * n, w->cell->sup, n) / w->cell->root_inf[j];
        w->inf[j][f] = DOWN * m->kernels->dot(linear + f * n, w->cell->inf, n) / w->cell->root_sup[j];
    }
    for (f = 0; f < F; f++) {
        w->cell->kappa_inf[j][f] = larger(0.0, w->inf[j][f] * m->inverse_a[f] - 2.0 * w->cell->epsilon);
    }
    for (k = 0; k < K; k++) {
        double sup = w->sup[j][F + k] - (m->data->functionals > F + K ? w->inf[j][F + K + k] : 0.0);

        w->cell->tau_sup[j][k] = smaller(sup, m->norm[k]) + 2.0 * w->cell->epsilon * m->norm[k];
    }
}

/*
 * The norm of what errors e_i of the exponents make of unit column j: |d g^| <= sqrt(sum bb phi^2 (e_i s d ln phi / dE)^2 / H) to
 * first order, s the larger of the two; half as much again for what is beyond.
 */
static double rounding(const struct work *w, int j)
{
    const struct moments *m = &w->engine->moments;
    double *slope = w->engine->scratch, first, sum, s = w->high->s[0];
    size_t i, n = m->data->stride;
    int exponential = w->lobe->kind->exponential;

    s = w->lobe->shapes > 1 ? larger(s, w->high->s[1]) : s;
    for (i = 0; i < n; i++) {
        slope[i] = w->cell->sup[i] * (exponential ? 1.0 : 2.0 / (1.0 + w->low->exponent[i]));
    }
    sum = m->kernels->weigh(w->lobe->weighted[j], slope, slope, n, &first);
    return 1.5 * s * sqrt(sum) / w->cell->root_inf[j];
}

static int usable(const struct work *w)
{
    const struct moments *m = &w->engine->moments;
    const struct cell *cell = w->cell;
    size_t k, f, F = (size_t)m->data->fixed;
    int j, d, fine = 1;

    for (j = 0; j < w->engine->model->each; j++) {
        for (d = 0; d < w->lobe->shapes; d++) {
            for (k = 0; k < m->data->bounded; k++) {
                fine = fine && fabs(cell->tau_shift[j][d][k]) <= LIMIT_SHIFT * m->norm[k];
            }
            for (f = 0; f < F; f++) {
                fine = fine && fabs(cell->kappa_shift[j][(size_t)d * F + f]) <= LIMIT_SHIFT;
            }
            fine = fine && (j == 0 || fabs(cell->beside_shift[d]) <= LIMIT_SHIFT);
        }
    }
    return fine;
}

static void fill_cell(struct bound_cell *e, struct cell *cell)
{
    const int each = e->model->each;
    const size_t functionals = e->moments.data->functionals;
    struct work w = {.engine = e, .lobe = &e->lobe[cell->lobe], .cell = cell};
    unsigned corner, corners = 1u << w.lobe->shapes;
    int j, d, alive = 1;

    cell->epsilon = cell->error = 0.0;
    for (corner = 0; corner < corners; corner++) {
        w.corner[corner] = brdffit_cell_corner(e, cell->lobe, cell->interval, corner);
        for (j = 0; j < each; j++) {
            cell->epsilon = larger(cell->epsilon, w.corner[corner]->epsilon[j]);
            alive = alive && w.corner[corner]->h[j] > LEAST_ROOT * LEAST_ROOT;
        }
    }
    w.low = w.corner[0];
    w.high = w.corner[corners - 1];
    cell->usable = 0;
    if (alive) {
        fill_shape(&w);
    }
    for (j = 0; j < each; j++) {
        alive = alive && isfinite(cell->root_sup[j]) && cell->root_inf[j] > LEAST_ROOT;
        w.sup[j] = e->range + (size_t)(2 * j) * functionals;
        w.inf[j] = w.sup[j] + functionals;
    }
    if (!alive) {
        cell->error = INFINITY; /* sums underflow, or range too far: nothing is known */
        return;
    }
    for (j = 0; j < each; j++) {
        fill_ranges(&w, j);
    }
    for (d = 0; d < w.lobe->shapes; d++) {
        double width = w.high->s[d] - w.low->s[d];

        cell->eighth[d] = UP * (width * width / 8.0);
        fill_coordinate(&w, d);
    }
    for (j = 0; j < each; j++) {
        cell->error += w.lobe->table[j]->charge.relative + rounding(&w, j);
    }
    if (each > 1) {
        fill_beside(&w);
    }
    cell->usable = usable(&w);
}

static int is_of(const struct cell *cell, int lobe, const uint32_t *interval, int shapes)
{
    return cell->lobe == lobe && cell->interval[0] == interval[0] && (shapes < 2 || cell->interval[1] == interval[1]);
}

const struct cell *brdffit_cell_of(struct bound_cell *e, int p, const uint32_t *interval)
{
    int shapes = e->lobe[p].shapes, d;
    uint32_t hash = (uint32_t)p * 40503u + interval[0] * 2654435761u + (shapes > 1 ? interval[1] * 2246822519u : 0u);
    size_t place = (hash ^ hash >> 15) % e->cells;
    struct cell *cell = &e->cell[place];

    while (cell->used == e->box && !is_of(cell, p, interval, shapes)) {
        place = place + 1 < e->cells ? place + 1 : 0;
        cell = &e->cell[place];
    }
    cell->used = e->box;
    if (!is_of(cell, p, interval, shapes)) {
        cell->lobe = p;
        for (d = 0; d < shapes; d++) {
            cell->interval[d] = interval[d];
        }
        fill_cell(e, cell);
    }
    return cell;
}
