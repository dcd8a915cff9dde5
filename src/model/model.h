/*
 * The model that is fitted (theory 7.1): P lobes, each of its own kind, their S shape coordinates ("sides" of a box) and
 * n columns. Made once from the options; below the options nobody counts lobes or names a distribution.
 *
 *     I_i ~ sum_f x_f a_if + sum_p sum_j y_pj b_ipj phi_p(s_p)
 *
 * Columns are the fixed ones first (diffuse terms), then those of the lobes in order, `each` to a lobe: b itself, and with
 * Schlick's Fresnel b w (theory 7.2). Lobes of one kind stand together and are exchangeable: a search keeps their sides
 * ascending.
 *
 * A kind is what a column of a lobe is made of: kinds 0 .. axes - 1 are those of the lobes' first columns, and own the axes
 * that are searched; kind i + axes is that of the second column of kind i, with the same phi and another b. So are
 * geometries (rows of b and c): g + bases belongs to second columns and has the c of g. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_MODEL_H
#define BRDFFIT_MODEL_H

#include "base/point.h"
#include "model/lobe.h"
#include "model/turn.h"

/* Most kinds, and most geometries (rows of b and c) among them. */
#define KINDS_MOST (EACH_MOST * BRDFFIT_MAX_LOBES)

struct model_lobe {
    int kind;   /* of its first column: index into model.kind, and of the axis that is searched */
    int side;   /* of its first shape coordinate */
    int column; /* of its first coefficient */
    int first;  /* the first lobe of its kind */
};

struct model {
    int lobes, sides, columns, kinds, geometries;
    int fixed, each;  /* columns without a shape; columns of a lobe */
    int axes, bases;  /* kinds and geometries of first columns */
    brdffit_diffuse diffuse;
    brdffit_masking masking;
    int turned; /* the first lobe is anisotropic: its kind and geometry are its own, and they are kind 0 and geometry 0 */
    int shapes; /* of it: how many shape coordinates are searched; 1 where their ratio is given */
    struct stretch stretch; /* of its geometry, where it is */
    int lead; /* the geometry that samples are looked at with: one that asks for the mirror direction, where there is one */
    const struct lobe_kind *kind[KINDS_MOST];
    int geometry[KINDS_MOST]; /* of each kind: index of its row of b and c */
    int shown_by[KINDS_MOST]; /* of each geometry: a kind that has it */
    brdffit_distribution distribution[BRDFFIT_MAX_LOBES]; /* of each lobe */
    struct model_lobe lobe[BRDFFIT_MAX_LOBES];
};

/* From checked options. Lobes are ordered by kind, kinds by their first mention. */
void brdffit_model_make(struct model *model, const brdffit_options *options);

/* A distribution of the leading geometry. */
brdffit_distribution brdffit_model_lead(const struct model *model);

/* The distribution of lobe p as the options name it. */
brdffit_distribution brdffit_model_asked(const brdffit_options *options, int p);

/* Column c of the lobes (0: the first after the fixed ones): its lobe, and its kind. */
static inline int model_lobe_of(const struct model *model, int c)
{
    return c / model->each;
}

static inline int model_kind_of(const struct model *model, int c)
{
    return model->lobe[c / model->each].kind + c % model->each * model->axes;
}

static inline const struct lobe_kind *model_column_kind(const struct model *model, int c)
{
    return model->kind[model_kind_of(model, c)];
}

/* How many sides lobe p has. */
static inline int model_shapes(const struct model *model, int p)
{
    return p == 0 ? model->shapes : 1;
}

/* The axis of a kind. */
static inline int model_axis(const struct model *model, int kind)
{
    return kind % model->axes;
}

static inline const struct lobe_kind *model_kind(const struct model *model, int lobe)
{
    return model->kind[model->lobe[lobe].kind];
}

/* Whether every lobe is of one exponential kind, and nothing else is special: the paper's model and its like. */
static inline int model_exponential(const struct model *model)
{
    return model->kinds == 1 && model->kind[0]->exponential && model->fixed == 1;
}

#endif
