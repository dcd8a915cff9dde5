/*
 * The judge of every fit: see verify.h. Part 4 of 4, the claims one by one. SPDX-License-Identifier: MIT
 *
 * Each check returns 0, or writes what is wrong and returns 1.
 */
#include "verify.h"

#include "verify_lobes.h"

static int check_samples(struct verdict *v)
{
    const struct verify_problem *p = &v->problem;
    int j;

    if (v->result->samples_used != p->used) {
        return wrong(v, "samples_used is %zu, should be %zu", v->result->samples_used, p->used);
    }
    for (j = 0; j < BRDFFIT_SKIP_COUNT; j++) {
        if (v->result->samples_skipped[j] != p->skipped[j]) {
            return wrong(v, "samples_skipped[%s] is %zu, should be %zu", brdffit_skip_string((brdffit_skip)j),
                         v->result->samples_skipped[j], p->skipped[j]);
        }
    }
    if (!(v->result->distinct_c >= 1 && v->result->distinct_c <= p->used)) {
        return wrong(v, "distinct_c is %zu of %zu samples", v->result->distinct_c, p->used);
    }
    return 0;
}

static int check_model(struct verdict *v)
{
    const struct brdffit_test_model *model = &v->result->model;
    const brdffit_options *o = v->problem.options;
    const struct verify_view *view = v->problem.lobe;
    size_t j, lobes = (size_t)o->lobes;

    if (model->distribution != view[0].distribution || model->lobes != o->lobes ||
        model->channels != v->problem.samples->channels) {
        return wrong(v, "the model's distribution, lobes or channels are not what was asked for");
    }
    for (j = 0; j < lobes; j++) {
        if (!(model->sigma[j] >= view[j].low && model->sigma[j] <= view[j].high)) {
            return wrong(v, "sigma[%zu] = %.17g is not in [%g, %g]", j, model->sigma[j], view[j].low, view[j].high);
        }
        if (model->sigma[j] != v->result->lobe[j].sigma) {
            return wrong(v, "model.sigma[%zu] is not lobe[%zu].sigma", j, j);
        }
    }
    for (j = 0; j < lobes; j++) {
        if (!model->distributions || model->distributions[j] != view[j].distribution) {
            return wrong(v, "lobe %zu is not of the distribution that was asked for", j);
        }
    }
    for (j = 1; j < lobes; j++) { /* like lobes ascend */
        if ((size_t)view[j].first < j && !(model->sigma[j - 1] <= model->sigma[j])) {
            return wrong(v, "sigma is not sorted: %.17g, %.17g", model->sigma[j - 1], model->sigma[j]);
        }
    }
    for (j = 0; j < model->channels; j++) {
        if (!(model->x[j] >= 0.0 && model->x[j] < INFINITY)) {
            return wrong(v, "x[%zu] = %g", j, model->x[j]);
        }
    }
    for (j = 0; j < model->channels * lobes; j++) {
        if (!(model->y[j] >= 0.0 && model->y[j] < INFINITY)) {
            return wrong(v, "y[%zu] = %g", j, model->y[j]);
        }
    }
    return 0;
}

static int check_channel_scale(struct verdict *v)
{
    const struct verify_problem *p = &v->problem;
    size_t i, k;

    for (k = 0; k < p->samples->channels; k++) {
        long double largest = 0.0L;
        double scale = v->result->channel_scale[k];

        for (i = 0; i < p->used; i++) {
            largest = fmaxl(largest, verify_radiance(p, i, k));
        }
        if (!(scale > 0.0 && scale < INFINITY)) {
            return wrong(v, "channel_scale[%zu] = %g", k, scale);
        }
        if (p->options->normalise == BRDFFIT_NORMALISE_NONE || !(largest > 0.0L)) {
            largest = 1.0L;
        }
        if (!near(scale, largest, 64.0L * VERIFY_UNIT)) {
            return wrong(v, "channel_scale[%zu] = %.17g, should be %.17Lg", k, scale, largest);
        }
    }
    return 0;
}

/* Columns and coefficients as claimed, squared residuals, and the length of the differences. */
static void evaluate(struct verdict *v)
{
    struct verify_problem *p = &v->problem;
    size_t i, k, lobes = (size_t)p->lobes, channels = p->rows.channels, j;
    long double delta2 = 0.0L;

    v->column[0] = p->rows.a;
    for (j = 0; j < lobes; j++) {
        v->sigma[j] = v->result->model.sigma[j];
        v->column[1 + j] = v->raw[j];
        for (i = 0; i < p->used; i++) {
            v->raw[j][i] = p->lobe[j].rows.b[i] *
                           verify_lobe(p->lobe[j].distribution, p->lobe[j].rows.c[i], v->sigma[j]);
        }
    }
    for (k = 0; k < channels; k++) {
        long double *z = v->claimed + k * (1 + lobes), scale = v->result->channel_scale[k];

        z[0] = v->result->model.x[k] / scale;
        for (j = 0; j < lobes; j++) {
            z[1 + j] = v->result->model.y[k * lobes + j] / scale;
        }
        for (i = 0; i < p->used; i++) {
            long double residual = p->rows.data[k * p->used + i];

            for (j = 0; j <= lobes; j++) {
                residual -= z[j] * v->column[j][i];
            }
            v->rss[k] += residual * residual;
        }
        v->delta[k] = verify_delta2(p, v->sigma, v->column, z, k);
        v->e2 += v->rss[k];
        delta2 += v->delta[k];
        v->delta[k] = sqrtl(v->delta[k]);
    }
    v->allowance = 2.0L * sqrtl(v->e2 * delta2) + delta2;
}

static int check_objective(struct verdict *v)
{
    const struct verify_problem *p = &v->problem;
    const struct brdffit_test_result *r = v->result;
    long double scale, minimised;
    size_t k;

    if (!near(r->sum_of_squares, p->total, 1e-12L)) {
        return wrong(v, "sum_of_squares is %.17g, should be %.17Lg", r->sum_of_squares, p->total);
    }
    if (!(fabsl(r->e2 - v->e2) <= E2_TOLERANCE * v->e2 + v->allowance)) {
        return wrong(v, "e2 is %.17g, the residuals say %.17Lg (allowance %.3Lg)", r->e2, v->e2, v->allowance);
    }
    minimised = sqrtl(r->e2 / ((long double)p->rows.channels * p->weight_sum));
    if (!near(r->rms_total, minimised, 1e-12L)) {
        return wrong(v, "rms_total is %.17g, e2 says %.17Lg", r->rms_total, minimised);
    }
    for (k = 0; k < p->rows.channels; k++) {
        scale = r->channel_scale[k] / sqrtl(p->weight_sum);
        if (!(fabsl(r->rms[k] - sqrtl(v->rss[k]) * scale) <= (1e-13L * sqrtl(v->rss[k]) + v->delta[k]) * scale)) {
            return wrong(v, "rms[%zu] is %.17g, should be %.17Lg", k, r->rms[k], sqrtl(v->rss[k]) * scale);
        }
    }
    return 0;
}

/* z >= 0 was checked; the gradient is 0 on the support and does not ask for more elsewhere. */
static int check_kkt(struct verdict *v)
{
    struct verify_problem *p = &v->problem;
    size_t i, k, j, columns = 1 + (size_t)p->lobes;
    long double optimum;

    for (k = 0; k < p->rows.channels; k++) {
        const long double *data = p->rows.data + k * p->used, *z = v->claimed + k * columns;
        long double norm = sqrtl(ref_dot(data, data, p->used)), allowed = KKT_TOLERANCE * norm + 4.0L * v->delta[k];

        for (j = 0; j < columns; j++) {
            long double gradient = 0.0L, length = sqrtl(ref_dot(v->column[j], v->column[j], p->used));

            for (i = 0; i < p->used; i++) {
                long double residual = data[i];
                size_t column;

                for (column = 0; column < columns; column++) {
                    residual -= z[column] * v->column[column][i];
                }
                gradient += residual * v->column[j][i];
            }
            if (j > 0 && v->sigma[j - 1] < p->lobe[j - 1].floor) {
                continue;
            }
            if (length > 0.0L && !((z[j] > 0.0L ? fabsl(gradient) : gradient) <= allowed * length)) {
                return wrong(v, "KKT: channel %zu column %zu (coefficient %.17Lg): gradient %.3Lg of the data's norm",
                             k, j, z[j], gradient / length / norm);
            }
        }
    }
    if (!(v->result->kkt_residual >= 0.0 && v->result->kkt_residual <= 1e-9)) {
        return wrong(v, "kkt_residual = %g", v->result->kkt_residual);
    }
    optimum = verify_optimum(p, v->sigma);
    if (!(v->e2 <= optimum * (1.0L + FLAT_TOLERANCE) + v->allowance)) {
        return wrong(v, "E^2 %.17Lg is not the least of its roughnesses, %.17Lg", v->e2, optimum);
    }
    return 0;
}

static int check_certificate(struct verdict *v)
{
    const struct brdffit_test_result *r = v->result;
    const brdffit_options *o = v->problem.options;
    long double e2 = r->e2 * (1.0L - 1e-12L) - FLAT_ABSOLUTE * r->sum_of_squares; /* taken again after the stop */

    if (!(r->lower_bound >= 0.0 && r->lower_bound <= r->e2 && r->e2 < INFINITY)) {
        return wrong(v, "lower_bound %.17g, e2 %.17g", r->lower_bound, r->e2);
    }
    if (r->gap != r->e2 - r->lower_bound) {
        return wrong(v, "gap %.17g is not e2 - lower_bound = %.17g", r->gap, r->e2 - r->lower_bound);
    }
    if (!((unsigned)r->stop < BRDFFIT_STOP_COUNT) ||
        r->certified != (r->stop == BRDFFIT_STOP_RELATIVE_GAP || r->stop == BRDFFIT_STOP_ABSOLUTE_GAP)) {
        return wrong(v, "stop %d and certified %d do not agree", (int)r->stop, r->certified);
    }
    if (r->stop == BRDFFIT_STOP_RELATIVE_GAP && !(e2 <= (1.0 + o->relative_gap) * r->lower_bound)) {
        return wrong(v, "not certified to %g: e2 %.17g, lower_bound %.17g", o->relative_gap, r->e2, r->lower_bound);
    }
    if (r->stop == BRDFFIT_STOP_ABSOLUTE_GAP && !(e2 - r->lower_bound <= o->absolute_gap * r->sum_of_squares)) {
        return wrong(v, "not certified to %g of %g: e2 %.17g, lower_bound %.17g", o->absolute_gap, r->sum_of_squares,
                     r->e2, r->lower_bound);
    }
    if (!(r->boxes <= o->box_budget)) {
        return wrong(v, "%zu boxes, budget %zu", r->boxes, o->box_budget);
    }
    return 0;
}

static int check_bound(struct verdict *v, size_t attacks, unsigned long long seed)
{
    struct verify_attack attack = {.problem = &v->problem, .state = seed, .bound = v->result->lower_bound};
    int j;

    for (j = 0; j < v->problem.lobes; j++) {
        attack.sigma[j] = 1.0L;
        attack.high[j] = v->problem.lobe[j].high;
        attack.low[j] = fmaxl(v->problem.lobe[j].low, v->problem.floor);
        if (!(attack.low[j] <= attack.high[j])) { /* no lobe has a finite y: only the diffuse term is left */
            attack.low[j] = attack.high[j];
        }
    }
    verify_attack_bound(&attack, v->result->model.sigma, attacks);
    if (attack.broken) {
        return wrong(v, "lower_bound %.17g is above E^2 = %.17Lg at sigma %.17Lg, %.17Lg, %.17Lg",
                     v->result->lower_bound, attack.best, attack.sigma[0], attack.sigma[1], attack.sigma[2]);
    }
    return 0;
}

/* The bound is for sigma >= sigma_floor: the options' own lower end, but where narrower lobes have no finite y. */
static int check_floor(struct verdict *v)
{
    const struct verify_problem *p = &v->problem;
    double low = 0.0, high = 0.0, floor = v->result->sigma_floor;
    int j;

    for (j = 0; j < p->lobes; j++) { /* every lobe's range reaches down to the largest of their ends */
        low = fmax(low, p->lobe[j].low);
        high = fmax(high, p->lobe[j].high);
    }
    if (floor == INFINITY) {
        struct verify_problem all = *p;

        all.floor = high;
        return verify_floor_is_due(&all) ? 0 : wrong(v, "sigma_floor leaves out every lobe without need");
    }
    if (!(floor >= low && floor <= high)) {
        return wrong(v, "sigma_floor %.17g is not in the range from %.17g", floor, low);
    }
    if (floor > low && !verify_floor_is_due(p)) {
        return wrong(v, "sigma_floor %.17g leaves out lobes with finite coefficients", floor);
    }
    return 0;
}

static int check_all(struct verdict *v, size_t attacks, unsigned long long seed)
{
    struct verify_problem *p = &v->problem;
    size_t channels = p->samples->channels, lobes = (size_t)p->options->lobes;
    int failed, j;

    p->floor = v->result->sigma_floor;
    verify_classify(p);
    if (check_samples(v) || check_model(v) || check_channel_scale(v)) {
        verify_problem_free(p);
        return 1;
    }
    verify_rows(p, v->result->channel_scale);
    verify_floors(p);
    v->claimed = ref_allocate(channels * (3 + lobes) + BRDFFIT_MAX_LOBES * p->used, sizeof *v->claimed);
    v->rss = v->claimed + channels * (1 + lobes);
    v->delta = v->rss + channels;
    v->raw[0] = v->delta + channels;
    for (j = 1; j < BRDFFIT_MAX_LOBES; j++) {
        v->raw[j] = v->raw[j - 1] + p->used;
    }
    evaluate(v);
    if (!attacks) {
        attacks = 160000 / (p->basis.rows.count + 10);
        attacks = attacks > 2000 ? 2000 : attacks < 100 ? 100 : attacks;
    }
    failed = check_floor(v) || check_objective(v) || check_kkt(v) || check_certificate(v) || check_lobes(v) ||
             check_bound(v, attacks, seed);
    free(v->claimed);
    verify_problem_free(p);
    return failed;
}

int brdffit_test_verify_deep(const brdffit_samples *samples, const brdffit_options *options,
                             const struct brdffit_test_result *result, size_t attacks, unsigned long long seed,
                             char *why, size_t why_size)
{
    brdffit_options defaults;
    struct verdict v;

    memset(&v, 0, sizeof v);
    if (!options) {
        brdffit_options_init(&defaults);
        options = &defaults;
    }
    if (why && why_size) {
        why[0] = '\0';
    }
    v.result = result;
    v.why = why;
    v.why_size = why_size;
    v.problem.samples = samples;
    v.problem.options = options;
    return check_all(&v, attacks, seed);
}

int brdffit_test_verify(const brdffit_samples *samples, const brdffit_options *options,
                        const struct brdffit_test_result *result, char *why, size_t why_size)
{
    return brdffit_test_verify_deep(samples, options, result, 0, 1, why, why_size);
}
