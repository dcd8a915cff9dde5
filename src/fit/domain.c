/*
 * The domain of a search: theta = ln s over the options' range, cut where nothing changes any more (theory 4.1) and
 * where no finite coefficient exists. SPDX-License-Identifier: MIT
 *
 * y = z |I| / (|g| factor(s)) with factor = lambda(s) phi(s, c_min), which underflows for a lobe so narrow that no
 * sample sees it. Models whose y no double can hold are not models that a caller could be given, so they are outside
 * of the domain (brdffit.h says so); where no lobe of the range has a finite y, the diffuse term is all there is.
 */
#include <math.h>

#include "fit/fit.h"
#include "base/exp.h"
#include "base/log.h"
#include "base/tolerance.h"

/* ln of the largest y / (sqrt(H) factor(s)) of any channel: |I| over the scale of b. */
static double data_exponent(const struct reduced *data)
{
    double largest = -INFINITY;
    size_t k;

    for (k = 0; k < data->channels; k++) {
        if (data->ii[k] > 0.0) {
            largest = fmax(largest, kernel_log(data->channel_scale[k]) + 0.5 * kernel_log(data->ii[k]));
        }
    }
    return largest - kernel_log(data->scale_b);
}

/* Whether every y of a lobe at theta is a finite double. */
static int finite_y(struct fit *f, double theta, double exponent)
{
    const struct reduced *data = &f->data;
    double u[3], h = 0.0;
    size_t j;

    f->kind->variable(data->c_min, theta, u);
    f->kind->shape(f->varpro.kernels, data->c, data->stride, u[0], f->varpro.phi);
    for (j = 0; j < data->distinct; j++) {
        h += data->bb[j] * (f->varpro.phi[j] * f->varpro.phi[j]);
    }
    return exponent - 0.5 * kernel_log(h) + f->kind->exponent(data->c_min, kernel_exp(theta)) <= LIMIT_EXPONENT;
}

/* Largest theta of the range with finite y, by bisection; below theta_low when there is none. */
static double largest_finite(struct fit *f)
{
    double exponent = data_exponent(&f->data), low = f->theta_low, high = f->theta_tail;
    int i;

    if (finite_y(f, high, exponent)) {
        return high;
    }
    if (!finite_y(f, low, exponent)) {
        return -INFINITY;
    }
    for (i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);

        if (finite_y(f, middle, exponent)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* No lobe can be used: its columns and sums vanish, and every theta is the same. */
static void drop_lobes(struct fit *f)
{
    struct reduced *data = &f->data;
    size_t j;

    for (j = 0; j < data->stride; j++) {
        data->bb[j] = 0.0;
    }
    for (j = 0; j < data->stride * data->functionals; j++) {
        data->linear[j] = 0.0;
    }
    for (j = 0; j < data->rows; j++) {
        data->row_b[j] = 0.0;
    }
    f->theta_high = f->theta_low; /* and theta_flat stays below: there is no lobe */
}

void brdffit_fit_prepare(struct fit *f, const brdffit_options *o)
{
    struct reduced *data = &f->data;

    f->kind = brdffit_lobe_kind_of(o->distribution);
    f->norm = o->norm;
    f->varpro.kernels = brdffit_kernels(o->isa);
    f->theta_low = f->kind->by_exponent ? kernel_log(o->exponent_min) : -2.0 * kernel_log(o->sigma_max);
    f->theta_tail = f->kind->by_exponent ? kernel_log(o->exponent_max) : -2.0 * kernel_log(o->sigma_min);
    f->theta_flat = f->theta_tail;
    f->theta_high = f->theta_low;
    if (data->bb[0] > 0.0) {
        double tail = f->kind->tail(data->c, data->bb, data->distinct, data->c_min);

        f->theta_flat = largest_finite(f);
        if (f->theta_flat < f->theta_low) {
            drop_lobes(f);
        } else if (tail > 0.0) {
            f->theta_high = fmax(f->theta_low, fmin(f->theta_flat, isfinite(tail) ? kernel_log(tail) : INFINITY));
        }
    }
    f->varpro.data = data;
    f->varpro.kind = f->kind;
    f->varpro.theta_low = f->theta_low;
    f->varpro.theta_high = f->theta_high;
}
