/*
 * The model that is fitted (theory 7.1): P lobes, each of its own kind, their S shape coordinates ("sides" of a box) and
 * n columns. Made once from the options; below the options nobody counts lobes or names a distribution.
 *
 *     I_i ~ sum_f x_f a_if + sum_p y_p b_ip phi_p(s_p)
 *
 * Columns are the fixed ones first (one today, the diffuse term), then those of the lobes in order. Lobes of one kind
 * stand together and are exchangeable: a search keeps their sides ascending. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_MODEL_H
#define BRDFFIT_MODEL_H

#include "base/point.h"
#include "model/lobe.h"

/* Columns without a shape, and all of them at most. */
#define COLUMNS_FIXED 1
#define COLUMNS_MOST (COLUMNS_FIXED + BRDFFIT_MAX_LOBES)

/* Most kinds, and most geometries (rows of b and c) among them. */
#define KINDS_MOST BRDFFIT_MAX_LOBES

struct model_lobe {
    int kind;   /* index into model.kind */
    int side;   /* of its shape coordinate */
    int column; /* of its coefficient */
    int first;  /* the first lobe of its kind */
};

struct model {
    int lobes, sides, columns, kinds, geometries;
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

static inline const struct lobe_kind *model_kind(const struct model *model, int lobe)
{
    return model->kind[model->lobe[lobe].kind];
}

/* Whether every lobe is of one kind, and that an exponential one. */
static inline int model_exponential(const struct model *model)
{
    return model->kinds == 1 && model->kind[0]->exponential;
}

#endif
