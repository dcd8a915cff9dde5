/*
 * Engine `cell`: engine moment for models with a lobe of two shape coordinates (theory 7.4 to 7.6). A lobe's part of a box is
 * a cell, a product of intervals of its coordinates; phi falls with each of them and is log-convex in each, so that what
 * engine moment knows of an interval from its two ends holds of a cell from its lowest and its highest corner, coordinate by
 * coordinate (cell.c). Only pure second derivatives matter along a side, so gains.h bounds boxes as ever (bound.c).
 *
 * Nodes (corners) and cells are kept in two small tables as long as nobody else needs the place; what a box is bounded by does
 * not depend on what is there. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_BOUND_CELL_H
#define BRDFFIT_BOUND_CELL_H

#include "data/moments.h"
#include "search/axis.h"
#include "search/heap.h"

/* Most shape coordinates of a lobe, and corners of its cell. */
#define SHAPES_MOST 2
#define CORNERS_MOST (1u << SHAPES_MOST)

/* A node of a lobe: one value of each coordinate. Arrays by column of the lobe. */
struct cell_node {
    int lobe; /* -1: the place is free */
    uint32_t at[SHAPES_MOST];
    uint64_t used; /* by which box, last */
    double s[SHAPES_MOST]; /* of a lobe with one coordinate: u, as lobe.h has it */
    double h[EACH_MOST], root[EACH_MOST];
    double mean[EACH_MOST][SHAPES_MOST]; /* of x_d = -d ln phi / d s_d under p = bb phi^2 / H */
    double epsilon[EACH_MOST];           /* rounding of sums over the unit column, relative to |I| */
    double beside;                       /* cosine of the two columns, lowered by their rounding */
    double *tau[EACH_MOST];              /* B */
    double *kappa[EACH_MOST];            /* F */
    double *sum[EACH_MOST];              /* functionals: sum W phi */
    double *phi, *exponent;              /* stride */
};

/* A cell of a lobe. Shifts are signed, in units of what they are added to; 0 where a coordinate has no extent. */
struct cell {
    int lobe;
    uint32_t interval[SHAPES_MOST];
    uint64_t used;
    int usable;
    double eighth[SHAPES_MOST];                /* width^2 / 8 of s_d */
    double curvature[EACH_MOST][SHAPES_MOST];  /* inf of E slope + 2 Var x */
    double mean[EACH_MOST][SHAPES_MOST][2];    /* [inf, sup] of the mean of x_d */
    double *sup, *inf;                         /* stride: range of phi, but for a scalar (cell.c) */
    double root_sup[EACH_MOST], root_inf[EACH_MOST]; /* and of the columns' norms */
    double epsilon, error; /* largest of its corners; of its columns together, by geometry's rounding */
    double beside_shift[SHAPES_MOST], beside_least;
    double *tau_shift[EACH_MOST][SHAPES_MOST]; /* B */
    double *tau_sup[EACH_MOST]; /* B */
    double *kappa_shift[EACH_MOST]; /* shapes x F */
    double *kappa_inf[EACH_MOST]; /* F */
};

/* A lobe of the model: what its phi is made of. */
struct cell_lobe {
    const struct lobe_kind *kind;
    int shapes, side, turned;
    const struct table *table[EACH_MOST];
    const double *c[SHAPES_MOST]; /* coordinate d's part of the exponent: stride */
    double *weighted[EACH_MOST]; /* stride: bb times the square of the error of c */
};

struct bound_cell {
    const struct model *model;
    struct axis *axis; /* one a side */
    struct moments moments; /* fixed columns, slack; of nodes it has none */
    struct cell_lobe lobe[BRDFFIT_MAX_LOBES];
    struct cell_node *node;
    struct cell *cell;
    size_t nodes, cells;
    uint64_t box; /* bounded so far: what it uses stays in its place */
    double *scratch; /* 8 x stride */
    double *range; /* each x 2 x functionals: of a cell being filled */
    double *list, *gain; /* of bound.c: cosines and data of each gain, and the gains */
    size_t evaluated; /* nodes computed */
};

void brdffit_bound_cell_layout(struct bound_cell *engine, struct arena *arena, size_t count, size_t channels,
                               const struct model *model);

void brdffit_bound_cell_start(struct bound_cell *engine, const struct reduced *data, const struct model *model,
                              const struct kernels *kernels, struct axis *axis);

/* bound() of struct engine; self is a struct bound_cell. */
double brdffit_bound_cell(struct bound_cell *engine, struct box *box, struct point *met);

/* Nodes and intervals have become others: everything is forgotten. */
void brdffit_bound_cell_forget(struct bound_cell *engine);

/* ---- parts (node.c, cell.c) ---- */

/* The node of a lobe at these nodes of its axes. It stays in its place while engine->box does not change. */
const struct cell_node *brdffit_cell_node(struct bound_cell *engine, int lobe, const uint32_t *at);

/* What is known of a lobe over these intervals of its axes; likewise. */
const struct cell *brdffit_cell_of(struct bound_cell *engine, int lobe, const uint32_t *interval);

/* Corner of a cell: bit d of `corner` is the high end of coordinate d. */
const struct cell_node *brdffit_cell_corner(struct bound_cell *engine, int lobe, const uint32_t *interval,
                                            unsigned corner);

/* x_d and its slope at a node, by group: into x and slope (stride each) or, where phi is exponential, none: *slope NULL. */
const double *brdffit_cell_slopes(const struct bound_cell *engine, int lobe, const struct cell_node *node, int d,
                                  double *x, const double **slope);

/* Where a cell of a lobe is highest in phi: sums over products of two lobes (bound.c). Cosine of column c of one with column
 * d of another, lowered by its rounding. */
double brdffit_cell_cosine(struct bound_cell *engine, const struct cell_node *one, int c, const struct cell_node *two,
                           int d);

#endif
