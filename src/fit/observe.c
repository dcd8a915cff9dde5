/*
 * Boxes of the search as the caller sees them: sides in sigma, bounds in the data's units.
 * SPDX-License-Identifier: MIT
 */
#include "fit/fit.h"

/* Halvings of an interval since the first partition. Its sides are rounded, but far finer than a factor of 3/4. */
static int halvings(const struct fit *f, int kind, uint32_t interval)
{
    const struct axis *axis = &f->axis[kind];
    const struct axis_interval *i = &axis->interval[interval];
    double width = axis->coordinate[i->high] - axis->coordinate[i->low];
    double whole = (f->domain[kind].high - f->domain[kind].low) / axis->first;
    int level = 0;

    while (width > 0.0 && width < 0.75 * whole) {
        whole *= 0.5;
        level++;
    }
    return level;
}

/* Side of one lobe; sigma falls with theta, and beyond the domain's high end nothing changes up to its flat one. */
static void side(const struct observer *v, int kind, uint32_t interval, double *low, double *high)
{
    const struct axis *axis = &v->fit->axis[kind];
    const struct domain *domain = &v->fit->domain[kind];
    const struct axis_interval *i = &axis->interval[interval];
    double end = axis->coordinate[i->high];

    *low = brdffit_fit_sigma(v->fit, kind, end < domain->high || domain->flat < end ? end : domain->flat);
    *high = brdffit_fit_sigma(v->fit, kind, axis->coordinate[i->low]);
}

/* The lobe shown in place p: like lobes are in ascending theta in a box, and in ascending sigma here. */
static int shown_lobe(const struct model *model, int p)
{
    int first = model->lobe[p].first, last = p;

    while (last + 1 < model->lobes && model->lobe[last + 1].first == first) {
        last++;
    }
    return first + last - p;
}

static void show(void *self, const struct box *box)
{
    const struct observer *v = self;
    const struct model *model = &v->fit->model;
    double low[BRDFFIT_MAX_LOBES], high[BRDFFIT_MAX_LOBES];
    brdffit_box shown = {
        .lobes = model->lobes, .sigma_low = low, .sigma_high = high, .lower_bound = box->bound * v->scale};
    int p;

    for (p = 0; p < model->lobes; p++) {
        uint32_t interval = box->interval[shown_lobe(model, p)];
        int kind = model->lobe[p].kind;

        side(v, kind, interval, &low[p], &high[p]);
        shown.level += halvings(v->fit, kind, interval);
    }
    v->options->box(v->options->box_user, &shown);
}

void brdffit_fit_observe(struct fit *f, const brdffit_options *o, struct search_rules *rules)
{
    f->observer.fit = f;
    f->observer.options = o;
    f->observer.scale = brdffit_fit_scale(&f->data, o);
    rules->observe = o->box ? show : 0;
    rules->observe_self = &f->observer;
}
