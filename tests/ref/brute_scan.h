/*
 * Slow reference, part 3 of 3: every grid point, sigma = k 2^-m in (0, 6].
 *
 * One lobe: each point in long double (ref_exact.h).
 *
 * Two lobes: each pair in double first, from Gram matrices. Deflate a from the unit lobes,
 *     u_i = (g_i - kappa_i a) / sqrt(1 - kappa_i^2),   rho_ki = I_k.u_i,   nu = u_i.u_j,
 * then without the signs' constraint the explained squares of channel k are
 *     omega_k^2 + (rho_ki^2 + rho_kj^2 - 2 nu rho_ki rho_kj) / (1 - nu^2),
 * and constraints can only lower them: a pair whose unconstrained sum is below the best pairs kept so far is
 * done. The others get their supports enumerated. Near-collinear pairs (1 - nu^2 < 1e-7), where Gram matrices
 * lose digits, are screened by the difference u_j - u_i and then done in long double. The best pairs of all are
 * evaluated again from the samples' residuals.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRUTE_SCAN_H
#define BRUTE_SCAN_H

#include "brute_problem.h"

#define BRUTE_KEEP 512     /* grid points that are evaluated again */
#define BRUTE_BLOCK 64     /* second nodes done together */
#define BRUTE_NARROW 1e-7  /* smallest 1 - cosine^2 that Gram matrices in double are trusted with */
#define BRUTE_NARROWER 1e-12 /* the same for differences of unit vectors */
#define BRUTE_MAX_CHANNELS 64

/* The best points so far: a heap with the worst of them on top. */
struct brute_best {
    size_t count;
    double explained[BRUTE_KEEP];
    size_t index[BRUTE_KEEP][2];
};

static void brute_best_swap(struct brute_best *best, size_t i, size_t j)
{
    double explained = best->explained[i];
    size_t first = best->index[i][0], second = best->index[i][1];

    best->explained[i] = best->explained[j];
    best->index[i][0] = best->index[j][0];
    best->index[i][1] = best->index[j][1];
    best->explained[j] = explained;
    best->index[j][0] = first;
    best->index[j][1] = second;
}

static void brute_best_sink(struct brute_best *best)
{
    size_t i = 0, child;

    while ((child = 2 * i + 1) < best->count) {
        child += child + 1 < best->count && best->explained[child + 1] < best->explained[child];
        if (best->explained[i] <= best->explained[child]) {
            return;
        }
        brute_best_swap(best, i, child);
        i = child;
    }
}

static double brute_best_threshold(const struct brute_best *best)
{
    return best->count < BRUTE_KEEP ? -1.0 : best->explained[0];
}

static void brute_best_add(struct brute_best *best, double explained, size_t first, size_t second)
{
    size_t i = best->count;

    if (!(explained > brute_best_threshold(best))) {
        return;
    }
    if (best->count == BRUTE_KEEP) {
        i = 0;
    } else {
        best->count++;
    }
    best->explained[i] = explained;
    best->index[i][0] = first;
    best->index[i][1] = second;
    if (i == 0) {
        brute_best_sink(best);
    }
    for (; i > 0 && best->explained[i] < best->explained[(i - 1) / 2]; i = (i - 1) / 2) {
        brute_best_swap(best, i, (i - 1) / 2);
    }
}

/* Everything that depends on one sigma. Arrays of `stride` nodes, a multiple of BRUTE_BLOCK. */
struct brute_grid {
    const struct ref_rows *rows;
    size_t count, stride;
    long double step;
    long double *lobe;   /* count x rows: unit lobes */
    long double *unit_a; /* rows */
    double *deflated;    /* rows x stride: u */
    double *kappa, *root; /* a.g and sqrt(1 - kappa^2) */
    double *rho, *tau;    /* channels x stride: I.u and I.g */
    double *single;       /* channels x stride: explained by a and this lobe */
    double *squares;      /* stride: sum of rho^2 over channels */
    double *data;         /* channels x rows */
    double omega[BRUTE_MAX_CHANNELS], omega_squares;
    long double total;
    long double *scratch;
};

static void brute_fill_node(struct brute_grid *grid, size_t i)
{
    const struct ref_rows *rows = grid->rows;
    const long double *lobe = grid->lobe + i * rows->count;
    long double kappa = ref_dot(grid->unit_a, lobe, rows->count), root = 0.0L, *u = grid->scratch;
    size_t d, k;

    for (d = 0; d < rows->count; d++) {
        u[d] = lobe[d] - kappa * grid->unit_a[d];
        root += u[d] * u[d];
    }
    root = sqrtl(root);
    grid->kappa[i] = (double)kappa;
    grid->root[i] = (double)root;
    for (d = 0; d < rows->count; d++) {
        u[d] = root > 0.0L ? u[d] / root : 0.0L;
        grid->deflated[d * grid->stride + i] = (double)u[d];
    }
    for (k = 0; k < rows->channels; k++) {
        const long double *data = rows->data + k * rows->count;
        long double rho = ref_dot(data, u, rows->count), tau = ref_dot(data, lobe, rows->count);
        double omega = grid->omega[k], weight = (double)(rho / root), best = omega > 0.0 ? omega * omega : 0.0;

        if (tau > 0.0L) {
            best = fmax(best, (double)(tau * tau));
        }
        if (root > 0.0L && weight >= 0.0 && omega - grid->kappa[i] * weight >= 0.0) {
            best = fmax(best, omega * omega + (double)(rho * rho));
        }
        grid->rho[k * grid->stride + i] = (double)rho;
        grid->tau[k * grid->stride + i] = (double)tau;
        grid->single[k * grid->stride + i] = best;
        grid->squares[i] += (double)(rho * rho);
    }
}

static void brute_grid_new(struct brute_grid *grid, const struct brute_problem *p, int step_log2)
{
    const struct ref_rows *rows = &p->basis.rows;
    size_t i, k, channels = rows->channels, stride;
    long double norm = sqrtl(ref_dot(rows->a, rows->a, rows->count));

    memset(grid, 0, sizeof *grid);
    grid->rows = rows;
    grid->count = (size_t)6 << step_log2;
    grid->stride = stride = (grid->count + BRUTE_BLOCK - 1) / BRUTE_BLOCK * BRUTE_BLOCK;
    grid->step = ldexpl(1.0L, -step_log2);
    grid->lobe = ref_allocate(grid->count * rows->count, sizeof *grid->lobe);
    grid->unit_a = ref_allocate(rows->count, sizeof *grid->unit_a);
    grid->scratch = ref_allocate(ref_exact_room(rows), sizeof *grid->scratch);
    grid->deflated = ref_allocate(rows->count * stride, sizeof(double));
    grid->kappa = ref_allocate(stride, sizeof(double));
    grid->root = ref_allocate(stride, sizeof(double));
    grid->squares = ref_allocate(stride, sizeof(double));
    grid->rho = ref_allocate(channels * stride, sizeof(double));
    grid->tau = ref_allocate(channels * stride, sizeof(double));
    grid->single = ref_allocate(channels * stride, sizeof(double));
    grid->data = ref_allocate(channels * rows->count, sizeof(double));
    for (i = 0; i < channels * rows->count; i++) {
        grid->data[i] = (double)rows->data[i];
    }
    for (i = 0; norm > 0.0L && i < rows->count; i++) {
        grid->unit_a[i] = rows->a[i] / norm;
    }
    for (k = 0; k < channels; k++) {
        const long double *data = rows->data + k * rows->count;

        grid->omega[k] = (double)ref_dot(data, grid->unit_a, rows->count);
        grid->omega_squares += grid->omega[k] * grid->omega[k];
        grid->total += ref_dot(data, data, rows->count);
    }
    for (i = 0; i < grid->count; i++) {
        ref_lobe(rows, p->ggx, grid->step * (long double)(i + 1), grid->lobe + i * rows->count);
        brute_fill_node(grid, i);
    }
}

static void brute_grid_free(struct brute_grid *grid)
{
    free(grid->lobe);
    free(grid->unit_a);
    free(grid->scratch);
    free(grid->deflated);
    free(grid->kappa);
    free(grid->root);
    free(grid->squares);
    free(grid->data);
    free(grid->rho);
    free(grid->tau);
    free(grid->single);
}

/* Explained squares of nodes i and j (i == j: of one lobe), in long double. */
static double brute_explained_exact(struct brute_grid *grid, size_t i, size_t j)
{
    size_t count = grid->rows->count;
    const long double *column[REF_COLUMNS] = {grid->unit_a, grid->lobe + i * count, grid->lobe + j * count};

    return (double)(grid->total - ref_exact(grid->rows, column, i == j ? 2 : 3, grid->scratch, NULL));
}

/* The same in double from the Gram matrix: supports enumerated, channel by channel. */
static double brute_explained(struct brute_grid *grid, size_t i, size_t j, double nu)
{
    double ri = grid->root[i], rj = grid->root[j], ki = grid->kappa[i], kj = grid->kappa[j];
    double rest = 1.0 - nu * nu, mu = nu * ri * rj + ki * kj, plain = 1.0 - mu * mu, sum = 0.0;
    size_t k;

    if (!(rest >= BRUTE_NARROW && plain >= BRUTE_NARROW && ri * ri >= BRUTE_NARROW && rj * rj >= BRUTE_NARROW)) {
        return brute_explained_exact(grid, i, j);
    }
    for (k = 0; k < grid->rows->channels; k++) {
        size_t at = k * grid->stride;
        double omega = grid->omega[k], pi = grid->rho[at + i], pj = grid->rho[at + j];
        double zi = (pi - nu * pj) / rest, zj = (pj - nu * pi) / rest;
        double ti = grid->tau[at + i], tj = grid->tau[at + j], best;

        if (zi >= 0.0 && zj >= 0.0 && omega - ki * zi / ri - kj * zj / rj >= 0.0) {
            sum += omega * omega + pi * zi + pj * zj;
            continue;
        }
        best = fmax(grid->single[at + i], grid->single[at + j]);
        zi = (ti - mu * tj) / plain;
        zj = (tj - mu * ti) / plain;
        if (zi >= 0.0 && zj >= 0.0) {
            best = fmax(best, ti * zi + tj * zj);
        }
        sum += best;
    }
    return sum;
}

/* nu[t] = u_i.u_(first + t) and cross[t] = sum over channels of rho_i rho_(first + t). */
static void brute_block_products(const struct brute_grid *grid, size_t i, size_t first, double *nu, double *cross)
{
    size_t d, k, t;

    for (t = 0; t < BRUTE_BLOCK; t++) {
        nu[t] = cross[t] = 0.0;
    }
    for (d = 0; d < grid->rows->count; d++) {
        const double *row = grid->deflated + d * grid->stride;
        double mine = row[i];

        for (t = 0; t < BRUTE_BLOCK; t++) {
            nu[t] += mine * row[first + t];
        }
    }
    for (k = 0; k < grid->rows->channels; k++) {
        const double *row = grid->rho + k * grid->stride;
        double mine = row[i];

        for (t = 0; t < BRUTE_BLOCK; t++) {
            cross[t] += mine * row[first + t];
        }
    }
}

/*
 * Can a near-collinear pair be left out? With d = u_j - u_i and q = |d|^2, 1 - nu = q / 2, the unconstrained
 * sum is omega^2 + rho_i^2 + (rho_j - nu rho_i)^2 / (1 - nu^2) and the last numerator's root is I.d + q/2 rho_i.
 */
static int brute_narrow_hopeless(const struct brute_grid *grid, size_t i, size_t j, double threshold)
{
    double q = 0.0, sum = 0.0;
    size_t d, k;

    for (d = 0; d < grid->rows->count; d++) {
        double difference = grid->deflated[d * grid->stride + j] - grid->deflated[d * grid->stride + i];

        q += difference * difference;
    }
    for (k = 0; k < grid->rows->channels; k++) {
        const double *data = grid->data + k * grid->rows->count;
        double new = 0.5 * q * grid->rho[k * grid->stride + i];

        for (d = 0; d < grid->rows->count; d++) {
            const double *row = grid->deflated + d * grid->stride;

            new += data[d] * (row[j] - row[i]);
        }
        sum += new *new / (q * (1.0 - 0.25 * q));
    }
    sum += grid->omega_squares + grid->squares[i] + 1e-7 * (double)grid->total;
    return q >= BRUTE_NARROWER && sum <= threshold;
}

static void brute_scan_block(struct brute_grid *grid, size_t i, size_t first, struct brute_best *best)
{
    double nu[BRUTE_BLOCK], cross[BRUTE_BLOCK], upper[BRUTE_BLOCK], rest[BRUTE_BLOCK];
    double threshold, base = grid->omega_squares + 1e-9 * (double)grid->total;
    size_t t;

    brute_block_products(grid, i, first, nu, cross);
    for (t = 0; t < BRUTE_BLOCK; t++) {
        rest[t] = 1.0 - nu[t] * nu[t];
        upper[t] = base + (grid->squares[i] + grid->squares[first + t] - 2.0 * nu[t] * cross[t]) / rest[t];
    }
    threshold = brute_best_threshold(best);
    for (t = 0; t < BRUTE_BLOCK; t++) {
        size_t j = first + t;

        if (j <= i || j >= grid->count ||
            (rest[t] >= BRUTE_NARROW ? upper[t] <= threshold : brute_narrow_hopeless(grid, i, j, threshold))) {
            continue;
        }
        brute_best_add(best, brute_explained(grid, i, j, nu[t]), i, j);
        threshold = brute_best_threshold(best);
    }
}

static void brute_scan(struct brute_grid *grid, int lobes, struct brute_best *best)
{
    size_t i, first;

    best->count = 0;
    for (i = 0; i < grid->count; i++) {
        brute_best_add(best, brute_explained_exact(grid, i, i), i, i);
    }
    for (i = 0; lobes == 2 && i < grid->count; i++) {
        for (first = i / BRUTE_BLOCK * BRUTE_BLOCK; first < grid->count; first += BRUTE_BLOCK) {
            brute_scan_block(grid, i, first, best);
        }
    }
}

#endif
