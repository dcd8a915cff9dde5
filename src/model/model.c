/*
 * The model of a fit: see model.h. SPDX-License-Identifier: MIT
 */
#include "model/model.h"

brdffit_distribution brdffit_model_asked(const brdffit_options *o, int p)
{
    return o->distributions ? o->distributions[p] : o->distribution;
}

/* Index of the kind of lobe p among those that the model has so far, or their number. */
static int place_of(const struct model *m, const struct lobe_kind *kind)
{
    int i = m->turned && m->kinds > 0; /* an anisotropic lobe's is its own */

    while (i < m->kinds && m->kind[i] != kind) {
        i++;
    }
    return i;
}

/* Index of the geometry of a kind among those so far, or their number. */
static int geometry_of(const struct model *m, const struct lobe_kind *kind)
{
    int i = m->turned && m->kinds > 0;

    while (i < m->geometries && m->kind[m->shown_by[i]]->row != kind->row) {
        i++;
    }
    return i;
}

static void add_kind(struct model *m, const struct lobe_kind *kind)
{
    int geometry = geometry_of(m, kind);

    m->kind[m->kinds] = kind;
    m->geometry[m->kinds] = geometry;
    if (geometry == m->geometries) {
        m->shown_by[m->geometries++] = m->kinds;
        m->lead = kind->mirrored ? geometry : m->lead;
    }
    m->kinds++;
}

static void add_lobe(struct model *m, int kind, brdffit_distribution distribution)
{
    int p = m->lobes++;

    m->distribution[p] = distribution;
    m->lobe[p].kind = kind;
    m->lobe[p].side = m->sides;
    m->sides += m->turned && p == 0 ? m->shapes : 1;
    m->lobe[p].column = m->columns;
    m->columns += m->each;
    m->lobe[p].first = p > 0 && m->lobe[p - 1].kind == kind ? m->lobe[p - 1].first : p;
}

/* Kinds and geometries of second columns, as many as of first ones, and in their order. */
static void add_second_columns(struct model *m)
{
    int i;

    m->axes = m->kinds;
    m->bases = m->geometries;
    for (i = 0; m->each > 1 && i < m->bases; i++) {
        m->shown_by[m->geometries++] = m->shown_by[i];
    }
    for (i = 0; m->each > 1 && i < m->axes; i++) {
        m->kind[m->kinds] = m->kind[i];
        m->geometry[m->kinds++] = m->geometry[i] + m->bases;
    }
}

void brdffit_model_make(struct model *m, const brdffit_options *o)
{
    int kind, p, own[BRDFFIT_MAX_LOBES];

    m->lobes = m->sides = m->kinds = m->geometries = m->lead = 0;
    m->diffuse = o->diffuse;
    m->masking = o->masking;
    m->fixed = brdffit_diffuse_columns(o->diffuse);
    m->each = o->fresnel == BRDFFIT_FRESNEL_SCHLICK ? 2 : 1;
    m->columns = m->fixed;
    m->turned = o->anisotropic;
    m->shapes = o->anisotropic && !(o->anisotropy > 0.0) ? 2 : 1;
    m->stretch = brdffit_stretch_of(o->anisotropy > 0.0 ? o->anisotropy : 1.0, o->tangent_angle);
    for (p = 0; p < o->lobes; p++) {
        const struct lobe_kind *wanted = brdffit_lobe_kind_masked(brdffit_model_asked(o, p), o->masking);

        own[p] = place_of(m, wanted);
        if (own[p] == m->kinds) {
            add_kind(m, wanted);
        }
    }
    for (kind = 0; kind < m->kinds; kind++) {
        for (p = 0; p < o->lobes; p++) {
            if (own[p] == kind) {
                add_lobe(m, kind, brdffit_model_asked(o, p));
            }
        }
    }
    add_second_columns(m);
}

brdffit_distribution brdffit_model_lead(const struct model *m)
{
    int p = 0;

    while (m->geometry[m->lobe[p].kind] != m->lead) {
        p++;
    }
    return m->distribution[p];
}
