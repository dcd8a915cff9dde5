/*
 * The domain of a search: theta = ln s over the options' range, cut where nothing changes any more (theory 4.1) and
 * where no finite coefficient exists. SPDX-License-Identifier: MIT
 *
 * y = z |I| / (|g| factor(s)) with factor = lambda(s) phi(s, c_min), which vanishes for a lobe so narrow that no
 * sample sees it. Models whose y no double can hold are not models that a caller could be given, so they are outside
 * of the domain (brdffit.h says so); where no lobe of the range has a finite y, the diffuse term is all there is.
 *
 * What is claimed is about sigma (the exponent) in a closed range of doubles, and theta is their rounded logarithm: so
 * the range of theta is wider on each side than what rounding can do to either (TOL_END). A point of the search may be
 * outside of the claim by as much; the sigma that is published is not, and the result's e2 is that of the latter.
 */
#include <math.h>

#include "fit/fit.h"
#include "fit/published.h"
#include "base/exp.h"
#include "base/log.h"
#include "base/tolerance.h"

/* What of one kind decides: its functions, the sums of its geometry. */
struct view {
    struct fit *fit;
    int index;
    const struct lobe_kind *kind;
    struct table *table;
};

/* ln of the largest y / (sqrt(H) factor(s)) of any channel: |I| over the scale of b. */
static double data_exponent(const struct view *v)
{
    const struct reduced *data = &v->fit->data;
    double largest = -INFINITY;
    size_t k;

    for (k = 0; k < data->channels; k++) {
        if (data->ii[k] > 0.0) {
            largest = fmax(largest, kernel_log(data->channel_scale[k]) + 0.5 * kernel_log(data->ii[k]));
        }
    }
    return largest + kernel_log(data->value_scale) - kernel_log(v->table->scale_b);
}

/* Whether every y of a lobe at theta is a finite double, and sums of the column are ordinary numbers; `exponent` from
 * data_exponent(). */
static int finite_y(const struct view *v, double theta, double exponent)
{
    const struct reduced *data = &v->fit->data;
    double u[3], h = 0.0, s = kernel_exp(theta), *phi = v->fit->varpro.phi;
    size_t j;

    v->kind->variable(&v->table->sight, theta, u);
    v->kind->shape(v->fit->varpro.kernels, &v->table->sight, data->stride, u[0], phi);
    for (j = 0; j < data->distinct; j++) {
        h += v->table->bb[j] * (phi[j] * phi[j]);
    }
    exponent += v->kind->exponent(v->table->c_min, s) - 0.5 * kernel_log(h) - kernel_log(v->kind->lambda(s));
    exponent -= v->kind->conversion ? kernel_log(v->kind->conversion(&v->table->sight, s)) : 0.0;
    return h > (v->table->c_low > 0.0 ? LIMIT_SECOND_NORM : 0.0) && exponent <= LIMIT_EXPONENT;
}

/* Largest theta of the range with finite y, by bisection; minus infinity when there is none. */
static double largest_finite(const struct view *v, double low, double high)
{
    double exponent = data_exponent(v);
    int i;

    if (finite_y(v, high, exponent)) {
        return high;
    }
    if (!finite_y(v, low, exponent)) {
        return -INFINITY;
    }
    for (i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);

        if (finite_y(v, middle, exponent)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static void no_shape(const struct kernels *kernels, const struct lobe_sight *sight, size_t n, double u, double *phi)
{
    size_t j;

    (void)kernels;
    (void)sight;
    (void)u;
    for (j = 0; j < n; j++) {
        phi[j] = 0.0;
    }
}

/* No lobe of this kind can be used: its columns vanish, and every theta is the same. Another kind may share its sums. */
static void drop_lobes(const struct view *v)
{
    struct lobe_kind *vanished = &v->fit->vanished[v->index];

    *vanished = *v->kind;
    vanished->shape = no_shape;
    v->fit->model.kind[v->index] = vanished;
}

double brdffit_fit_outwards(double theta, double steps)
{
    return theta + steps * TOL_END * TOL_UNIT * (1.0 + fabs(theta));
}

/* The range that the options ask of a kind, both ends outwards. */
static void asked_range(const struct lobe_kind *kind, const brdffit_options *o, struct domain *d)
{
    double low = kind->by_exponent ? kernel_log(o->exponent_min) : -2.0 * kernel_log(o->sigma_max);
    double high = kind->by_exponent ? kernel_log(o->exponent_max) : -2.0 * kernel_log(o->sigma_min);

    d->parameter_low = kind->by_exponent ? o->exponent_min : o->sigma_max;
    d->parameter_tail = kind->by_exponent ? o->exponent_max : o->sigma_min;
    d->low = brdffit_fit_outwards(low, -1.0);
    d->tail = brdffit_fit_outwards(high, 1.0);
    d->flat = d->tail;
    d->high = d->low;
}

/* Of an anisotropic lobe whose ratio is given both roughnesses stay in the range: theta +- ln ratio. */
static void narrow_range(const struct model *model, struct domain *d)
{
    double ratio = fmax(model->stretch.ratio, 1.0 / model->stretch.ratio), apart = kernel_log(ratio);
    double middle = 0.5 * (d->low + d->tail);
    int exponent = model->kind[0]->by_exponent;

    d->low = fmin(d->low + apart, middle);
    d->tail = fmax(d->tail - apart, middle);
    d->flat = d->tail;
    d->high = d->low;
    d->parameter_low = exponent ? d->parameter_low * ratio : d->parameter_low / sqrt(ratio);
    d->parameter_tail = exponent ? d->parameter_tail / ratio : d->parameter_tail * sqrt(ratio);
}

static int any_lobe(const struct view *v)
{
    size_t j = 0;

    while (j < v->fit->data.distinct && !(v->table->bb[j] > 0.0)) {
        j++;
    }
    return j < v->fit->data.distinct;
}

/* One kind of column narrows the domain of its axis: where y is finite, and `tail`, from where nothing changes. */
static void look_at(const struct view *v, struct domain *d, double *tail)
{
    if (!any_lobe(v)) {
        return;
    }
    *tail = fmax(*tail, v->kind->tail(&v->table->sight, v->table->bb, v->fit->data.distinct));
    d->flat = fmin(d->flat, largest_finite(v, d->low, d->tail));
}

static struct view view_of(struct fit *f, int kind)
{
    const struct view v = {f, kind, f->model.kind[kind], &f->data.table[f->model.geometry[kind]]};

    return v;
}

static void prepare_axis(struct fit *f, int axis, const brdffit_options *o, struct domain *d)
{
    double tail = 0.0;
    int kind;

    asked_range(f->model.kind[axis], o, d);
    if (f->model.turned && axis == 0) {
        narrow_range(&f->model, d);
    }
    for (kind = axis; kind < f->model.kinds; kind += f->model.axes) {
        const struct view v = view_of(f, kind);

        look_at(&v, d, &tail);
    }
    for (kind = axis; kind < f->model.kinds && d->flat < d->low; kind += f->model.axes) {
        const struct view v = view_of(f, kind);

        drop_lobes(&v); /* and d->flat stays below: there is no lobe */
    }
    tail = f->physical ? INFINITY : tail; /* what y counts for changes up to the end */
    if (d->flat >= d->low && tail > 0.0) {
        double end = d->flat < d->tail ? brdffit_fit_outwards(d->flat, 1.0) : d->tail;

        d->high = fmax(d->low, fmin(end, isfinite(tail) ? kernel_log(tail) : INFINITY));
    }
}

void brdffit_fit_prepare(struct fit *f, const brdffit_options *o)
{
    int kind, p;

    f->norm = o->norm;
    f->varpro.kernels = brdffit_kernels(o->isa);
    f->varpro.data = &f->data;
    f->varpro.physical = f->physical;
    f->triangle_error = o->norm == BRDFFIT_NORM_L2 && f->rows_error == 0.0 ? brdffit_fit_triangle_error(&f->data) : 0.0;
    for (kind = 0; kind < f->model.axes; kind++) {
        prepare_axis(f, kind, o, &f->domain[kind]);
    }
    for (p = 0; p < f->model.lobes && f->model.shapes == 1; p++) {
        f->varpro.theta_low[p] = fit_domain(f, p)->low;
        f->varpro.theta_high[p] = fit_domain(f, p)->high;
    }
    brdffit_fit_layout_search(f, o);
}
