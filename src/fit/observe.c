/*
 * Boxes of the search as the caller sees them: sides in sigma, bounds in the data's units.
 * SPDX-License-Identifier: MIT
 */
#include "fit/fit.h"

/* Halvings of an interval since the first partition. Its sides are rounded, but far finer than a factor of 3/4. */
static int halvings(const struct fit *f, uint32_t interval)
{
    const struct axis *axis = &f->axis;
    const struct axis_interval *i = &axis->interval[interval];
    double width = axis->coordinate[i->high] - axis->coordinate[i->low];
    double whole = (f->theta_high - f->theta_low) / axis->first;
    int level = 0;

    while (width > 0.0 && width < 0.75 * whole) {
        whole *= 0.5;
        level++;
    }
    return level;
}

/* Side of one lobe; sigma falls with theta, and beyond theta_high nothing changes up to theta_flat. */
static void side(const struct observer *v, uint32_t interval, double *low, double *high)
{
    const struct fit *f = v->fit;
    const struct axis_interval *i = &f->axis.interval[interval];
    double end = f->axis.coordinate[i->high];

    *low = brdffit_fit_sigma(f, end < f->theta_high || f->theta_flat < end ? end : f->theta_flat, v->options);
    *high = brdffit_fit_sigma(f, f->axis.coordinate[i->low], v->options);
}

static void show(void *self, const struct box *box)
{
    const struct observer *v = self;
    int lobes = v->options->lobes, p;
    brdffit_box shown = {{0.0, 0.0}, {0.0, 0.0}, box->bound * v->scale, 0};

    for (p = 0; p < lobes; p++) {
        uint32_t interval = box->interval[lobes - 1 - p]; /* ascending theta there, ascending sigma here */

        side(v, interval, &shown.sigma_low[p], &shown.sigma_high[p]);
        shown.level += halvings(v->fit, interval);
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
