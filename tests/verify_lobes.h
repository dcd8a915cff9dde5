/*
 * verify.c, part 3 of 4: the verdict, and what a result says of each lobe. SPDX-License-Identifier: MIT
 *
 * Each check returns 0, or writes what is wrong and returns 1.
 */
#ifndef BRDFFIT_TESTS_VERIFY_LOBES_H
#define BRDFFIT_TESTS_VERIFY_LOBES_H

#include <stdarg.h>
#include <stdio.h>

#include "verify_problem.h"

/* KKT residuals relative to the data's norm, beyond what roundings of the coefficients explain. */
#define KKT_TOLERANCE 1e-11L
/* E^2 is evaluated in double: relative error of its sums. */
#define E2_TOLERANCE 1e-13L
/* The same for what is flat "to rounding", and what restricted optima may miss of a minimum. */
#define FLAT_TOLERANCE 1e-11L
#define FLAT_ABSOLUTE 1e-27L

struct verdict {
    const struct brdffit_test_result *result;
    struct verify_problem problem;
    long double *claimed;              /* channels x (1 + lobes): coefficients, units that were minimised */
    long double *raw[BRDFFIT_MAX_LOBES]; /* columns that the claimed y multiply */
    const long double *column[REF_COLUMNS];
    long double sigma[BRDFFIT_MAX_LOBES];
    long double *rss, *delta;          /* per channel: squared residual, length of the differences */
    long double e2, allowance;
    char *why;
    size_t why_size;
};

__attribute__((format(printf, 2, 3))) static inline int wrong(struct verdict *v, const char *format, ...)
{
    va_list arguments;

    if (v->why && v->why_size) {
        va_start(arguments, format);
        vsnprintf(v->why, v->why_size, format, arguments);
        va_end(arguments);
    }
    return 1;
}

static inline int near(long double x, long double y, long double relative)
{
    return fabsl(x - y) <= relative * fmaxl(fabsl(x), fabsl(y));
}

/* Effective samples, and how far roundings can move them, relatively. */
static inline long double effective_samples(struct verdict *v, int lobe, long double *error)
{
    struct verify_problem *p = &v->problem;
    const long double *g = p->column[lobe];
    long double sum = 0.0L, sum2 = 0.0L;
    size_t i;

    verify_lobes(p, 0, v->sigma);
    *error = 0.0L;
    for (i = 0; i < p->used; i++) {
        long double g2 = g[i] * g[i];

        sum += g2;
        sum2 += g2 * g2;
        const struct verify_sample *sample = p->lobe[lobe].sample + i;

        *error += 8.0L * g2 * sample->error_b;
        *error += 8.0L * g2 * verify_lobe_error(p->lobe[lobe].ggx, sample->c, sample->error_c, v->sigma[lobe]);
    }
    *error += 1e-12L;
    return sum > 0.0L ? sum * sum / sum2 : 0.0L;
}

/* The exponent says what sigma says, and nothing where the parameter is sigma. */
static inline int check_exponent(struct verdict *v, int j)
{
    const brdffit_options *o = v->problem.options;
    const brdffit_lobe *lobe = &v->result->lobe[j];
    int right = lobe->exponent == 0.0 && lobe->exponent_low == 0.0 && lobe->exponent_high == 0.0;

    if (verify_by_exponent(v->problem.lobe[j].distribution)) {
        right = lobe->exponent == lobe->exponent_low && lobe->exponent_low <= lobe->exponent_high &&
                lobe->exponent_low >= o->exponent_min && lobe->exponent_high <= o->exponent_max &&
                near(lobe->exponent * (long double)lobe->sigma * lobe->sigma, 1.0L, 8.0L * VERIFY_UNIT) &&
                near(lobe->exponent_high * (long double)lobe->sigma_low * lobe->sigma_low, 1.0L, 8.0L * VERIFY_UNIT);
    }
    return right
               ? 0
               : wrong(v, "lobe %d: exponent %.17g in [%.17g, %.17g], sigma %.17g in [%.17g, %.17g]", j, lobe->exponent,
                       lobe->exponent_low, lobe->exponent_high, lobe->sigma, lobe->sigma_low, lobe->sigma_high);
}

static inline int check_warnings(struct verdict *v, int j, int used)
{
    const brdffit_lobe *lobe = &v->result->lobe[j];
    int flat = lobe->sigma_low < lobe->sigma_high, at_limit = (lobe->warnings & BRDFFIT_WARN_AT_LIMIT) != 0;
    double low = v->problem.lobe[j].low, high = v->problem.lobe[j].high;
    int on_limit = lobe->sigma == low || lobe->sigma == high;

    if (!(lobe->warnings & BRDFFIT_WARN_UNRESOLVED) != !(lobe->effective_samples < 3.0)) {
        return wrong(v, "lobe %d: %.17g effective samples, warnings %#x", j, lobe->effective_samples, lobe->warnings);
    }
    if (!(lobe->warnings & BRDFFIT_WARN_UNUSED) != !!used) {
        return wrong(v, "lobe %d is %sused, warnings %#x", j, used ? "" : "un", lobe->warnings);
    }
    if (!(lobe->sigma_low <= lobe->sigma && lobe->sigma == lobe->sigma_high && lobe->sigma_low >= low)) {
        return wrong(v, "lobe %d: sigma %.17g in [%.17g, %.17g]", j, lobe->sigma, lobe->sigma_low, lobe->sigma_high);
    }
    if (flat && !(lobe->warnings & BRDFFIT_WARN_FLAT)) {
        return wrong(v, "lobe %d: flat on [%.17g, %.17g] without a warning", j, lobe->sigma_low, lobe->sigma_high);
    }
    if ((at_limit && !on_limit) || (on_limit && !(lobe->warnings & (BRDFFIT_WARN_AT_LIMIT | BRDFFIT_WARN_FLAT)))) {
        return wrong(v, "lobe %d: sigma %.17g in [%g, %g], warnings %#x", j, lobe->sigma, low, high, lobe->warnings);
    }
    return 0;
}

/* E^2 all over the interval that is said to be flat. */
static inline int check_flat(struct verdict *v, int j)
{
    const brdffit_lobe *lobe = &v->result->lobe[j];
    long double low = lobe->sigma_low, ratio = lobe->sigma_high / low, sigma[BRDFFIT_MAX_LOBES];
    int i;

    memcpy(sigma, v->sigma, sizeof sigma);
    for (i = 0; lobe->sigma_low < lobe->sigma_high && i <= 16; i++) {
        long double e2, allowed;

        sigma[j] = fminl(low * powl(ratio, i / 16.0L), lobe->sigma_high);
        e2 = verify_optimum(&v->problem, sigma);
        allowed = FLAT_TOLERANCE * v->e2 + FLAT_ABSOLUTE * v->problem.total + v->allowance;
        if (!(fabsl(e2 - v->e2) <= allowed + verify_allowance(&v->problem, sigma))) {
            return wrong(v, "lobe %d is not flat on [%.17g, %.17g]: E^2 %.17Lg at %.17Lg, but %.17Lg at %.17Lg", j,
                         lobe->sigma_low, lobe->sigma_high, e2, sigma[j], v->e2, v->sigma[j]);
        }
    }
    return 0;
}

static inline int check_lobes(struct verdict *v)
{
    const struct brdffit_test_model *model = &v->result->model;
    size_t k, lobes = (size_t)model->lobes, n;
    long double sum[BRDFFIT_MAX_LOBES] = {0.0L}, all = 0.0L;
    int j;

    for (n = 0; n < model->channels * lobes; n++) {
        sum[n % lobes] += model->y[n];
        all += model->y[n];
    }
    for (j = 0; j < model->lobes; j++) {
        const brdffit_lobe *lobe = &v->result->lobe[j];
        long double error, effective = effective_samples(v, j, &error), weight = all > 0.0L ? sum[j] / all : 0.0L;
        int used = 0;

        for (k = 0; k < model->channels; k++) {
            used |= model->y[k * lobes + (size_t)j] > 0.0;
        }
        if (!(fabsl(lobe->weight - weight) <= 1e-14L)) {
            return wrong(v, "lobe %d: weight %.17g, should be %.17Lg", j, lobe->weight, weight);
        }
        if (v->sigma[j] >= v->problem.lobe[j].floor && !near(lobe->effective_samples, effective, error)) {
            return wrong(v, "lobe %d: %.17g effective samples, should be %.17Lg", j, lobe->effective_samples,
                         effective);
        }
        if (check_exponent(v, j) || check_warnings(v, j, used) || check_flat(v, j)) {
            return 1;
        }
    }
    return 0;
}

#endif
