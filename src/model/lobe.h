/*
 * What a lobe is (theory 1, 4.4, 7.1): one row of functions and names for each distribution, in a file of its own;
 * lobes.c holds the table of them. Everything else asks this table and knows no distribution by name.
 *
 * A lobe is g(s) = b factor(s) phi(u(s), c') with c' = c - c_min >= 0, where phi(0, c') = 1, phi decreases in u and in
 * c', and is log-convex in u, so that every moment of phi is a decreasing function whose range on an interval is its
 * two end values. The scalar factor only rescales y.
 *
 *   exponential: phi = exp(-c' u), u = s, factor = lambda(s) exp(-c_min s); the distributions differ in lambda
 *   GGX:         phi = (1 + c' u)^-2, u = s / (1 + c_min s), factor = s (1 + c_min s)^-2
 *                (dividing (1 + c s)^-2 by its value at c_min gives the same function of c' and u)
 *
 * The search runs over theta = ln s; derivatives of phi are with respect to u: ell = d ln phi / du,
 * slope = d ell / du. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_LOBE_H
#define BRDFFIT_LOBE_H

#include <stddef.h>

#include "base/wide.h"
#include "brdffit.h"
#include "kernels/kernels.h"
#include "model/geometry.h"

/* What b is made of in a row of a table in half/difference angles, given l = n.l and v = n.v (data/table_row.h). */
enum table_row_kind {
    TABLE_ROW_NONE,     /* c is not the row's alone, or nobody said otherwise: no rows of it */
    TABLE_ROW_SHADOWED, /* min(1, shared min(l, v)) / v, shared = 2 (n.h) / (v.h) */
    TABLE_ROW_ROOT,     /* sqrt(l / v) */
    TABLE_ROW_LIGHT,    /* l */
    TABLE_ROW_SIDE      /* shared l / max(l, v), shared = 1 / (v.h) */
};

/* What a kind sees of the samples' groups: c - c_min and, with Smith's masking only, tan^2 of the angles of light and
 * viewer, the smaller first, and a number above all of them. */
struct lobe_sight {
    double c_min;
    const double *c, *light, *view;
    double tan2_most;
};

struct lobe_kind {
    const char *name;  /* as an option takes it */
    const char *title; /* as a sentence has it */
    int by_exponent; /* the user's parameter is the exponent n = s, and not sigma = 1 / sqrt(s) */
    int exponential; /* the fast case: ell = -c' whatever u is, and slope = 0 */
    int mirrored;    /* b and c are made of r.v, and not of alpha */
    int steep;       /* phi has a factor exp(-c' s), alone (exponential) or beside masking */
    double
        reflectance; /* y times this is one: F0 or an albedo, at most 1 of what there is; 0: g has no normalisation */
    int smith; /* masking by Smith: phi depends on more than c, it may be above 1, and mu does not fall with distance */

    /* ---- geometry ---- */

    /* out->b and out->c with their errors; both cosines are above LIMIT_GRAZING. Distributions with the same function share
     * their sums. */
    void (*row)(const struct geometry_angles *angles, struct geometry *out);

    /* b of a table's row is table_factor(cos^2 alpha) times what table_kind says; NULL: 1. */
    enum table_row_kind table_kind;
    double (*table_factor)(double cos2_half);

    /* ---- phi ---- */

    /* u and its first and second derivative by theta. */
    void (*variable)(const struct lobe_sight *sight, double theta, double u[3]);

    /* u at s itself: variable() is that of kernel_exp(theta). */
    double (*argument)(const struct lobe_sight *sight, double s);

    /* phi(u, c_j) for n (a multiple of LANES) values. */
    void (*shape)(const struct kernels *kernels, const struct lobe_sight *sight, size_t n, double u, double *phi);

    /* -ell and slope at each c; NULL for exponential ones. */
    void (*slopes)(const struct kernels *kernels, const struct lobe_sight *sight, size_t n, double u, double *minus_ell,
                   double *slope);

    /* ell and slope at one c. */
    void (*slope)(double c, double u, double *ell, double *slope);

    /* ---- the scalar factor ---- */

    /* lambda(s). */
    double (*lambda)(double s);

    /* phi(s, c), however small; of tan^2 of light and viewer what masking makes of them is a factor. */
    struct wide (*phi)(struct twofold s, double c);
    double (*masking)(double s, double light, double view); /* NULL: 1, or in b */

    /* A part of the factor in (0, 1] that depends on the samples; NULL: 1. */
    double (*conversion)(const struct lobe_sight *sight, double s);

    /* ln(1 / phi(s, c_min)): how far the factor falls, but for lambda and conversion. */
    double (*exponent)(double c_min, double s);

    /*
     * An s beyond which phi(u(s), c_j) sqrt(bb_j / bb_0) is within exp(-TAIL_EXPONENT) of its limit for
     * every c_j > 0 (in any order; bb_0 of c = 0), so that nothing changes to rounding. 0 when nothing ever changes.
     */
    double (*tail)(const struct lobe_sight *sight, const double *bb, size_t m);

    /* -d ln g / dc at (s, c): what an error of c does to g. Does not rise with c. */
    double (*sensitivity)(double s, double c);
};

extern const struct lobe_kind brdffit_lobe_beckmann, brdffit_lobe_ggx, brdffit_lobe_torrance_sparrow, brdffit_lobe_ward,
    brdffit_lobe_blinn_phong, brdffit_lobe_ashikhmin_shirley, brdffit_lobe_lafortune, brdffit_lobe_retro;

/* GGX without masking. */
extern const struct lobe_kind brdffit_lobe_ggx_bare;

/* The distribution must be one of the enumeration; NULL where a copy of the library is without it (tools/amalgamate). */
const struct lobe_kind *brdffit_lobe_kind_of(brdffit_distribution distribution);

/* The same with a masking; NULL where the distribution has it not. The second: of any but that by V cavities (masked.c). */
const struct lobe_kind *brdffit_lobe_kind_masked(brdffit_distribution distribution, brdffit_masking masking);
const struct lobe_kind *brdffit_lobe_kind_other_masking(brdffit_distribution distribution, brdffit_masking masking);

/* lambda(s) phi(s, c): g / b, and what y is divided by at c_min; within a dozen u, however small. */
struct wide brdffit_lobe_factor(const struct lobe_kind *kind, struct twofold s, double c);

/* g / b at a sample: the same, and masking. */
struct wide brdffit_lobe_at(const struct lobe_kind *kind, struct twofold s, const struct geometry *g);

/* What y is divided by: lambda(s) phi(s, c_min) and the conversion. */
struct wide brdffit_lobe_divisor(const struct lobe_kind *kind, struct twofold s, const struct lobe_sight *sight);

/* What the cells of one theta_h share: b is `factor` times the table row's b, a is n.l / pi. */
struct geometry_table_row {
    enum table_row_kind kind;
    double factor;
    double shared; /* of table_row.h, but for 1 / (v.h) */
    double c;
};

/* 0 when c is not the row's alone (Lafortune). */
int brdffit_geometry_table_row(brdffit_distribution distribution, double tan2_half, struct geometry_table_row *out);

#endif
