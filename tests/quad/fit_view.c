/*
 * See fit_view.h. SPDX-License-Identifier: MIT
 */
#include "fit_view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count ? count : 1, size);

    if (!memory) {
        abort();
    }
    return memory;
}

void fit_question_init(struct fit_question *q, const brdffit_samples *samples, int lobes,
                       brdffit_distribution distribution)
{
    int j;

    memset(q, 0, sizeof *q);
    brdffit_options_init(&q->options);
    q->samples = samples;
    q->lobes = lobes;
    for (j = 0; j < QUAD_LOBES; j++) {
        q->distribution[j] = distribution;
    }
}

int fit_question_options(const struct fit_question *q, brdffit_options *options)
{
    *options = q->options;
    options->lobes = q->lobes;
    options->distribution = q->distribution[0];
    options->distributions = q->distribution;
    return q->lobes <= BRDFFIT_MAX_LOBES;
}

static void fail(struct fit_view *view, brdffit_status status, const char *message)
{
    memset(view, 0, sizeof *view);
    view->status = status;
    view->message = message ? message : "no message";
}

static void copy(double *to, const double *from, size_t count, int *nans)
{
    size_t i;

    for (i = 0; i < count; i++) {
        to[i] = from[i];
        *nans += isnan(from[i]) != 0;
    }
}

static void allocate_view(struct fit_view *view, int lobes, size_t channels, int fixed)
{
    memset(view, 0, sizeof *view);
    view->lobes = lobes;
    view->channels = channels;
    view->fixed = fixed;
    view->x = allocate(channels * (size_t)(1 + fixed + 2 * lobes), sizeof(double));
    view->y = view->x + channels * (size_t)fixed;
    view->scale = view->y + channels * (size_t)lobes;
}

static int lobe_nans(const brdffit_lobe *lobe)
{
    double numbers[8] = {lobe->sigma,        lobe->sigma_low,     lobe->sigma_high, lobe->exponent,
                         lobe->exponent_low, lobe->exponent_high, lobe->weight,     lobe->effective_samples};
    int i, nans = 0;

    for (i = 0; i < 8; i++) {
        nans += isnan(numbers[i]) != 0;
    }
    return nans;
}

static void take(struct fit_view *view, const brdffit_result *r)
{
    double ignored[2], more[2] = {r->rms_total, r->kkt_residual};
    int fixed = r->model->x_more ? r->model->diffuse == BRDFFIT_DIFFUSE_BURLEY ? 3 : 2 : 1;
    size_t k, wide = (size_t)fixed;
    int j;

    allocate_view(view, r->model->lobes, r->model->channels, fixed);
    copy(view->sigma, r->model->sigma, (size_t)view->lobes, &view->nans);
    for (k = 0; k < view->channels; k++) {
        copy(view->x + k * wide, r->model->x + k, 1, &view->nans);
        copy(view->x + k * wide + 1, r->model->x_more + k * (wide - 1), wide - 1, &view->nans);
    }
    if (r->model->f0) {
        view->f0 = view->scale + view->channels;
        copy(view->f0, r->model->f0, view->channels * (size_t)view->lobes, &view->nans);
    }
    copy(view->y, r->model->y, view->channels * (size_t)view->lobes, &view->nans);
    copy(view->scale, r->channel_scale, view->channels, &view->nans);
    copy(&view->e2, &r->e2, 1, &view->nans);
    copy(&view->e2_error, &r->e2_error, 1, &view->nans);
    copy(&view->lower_bound, &r->lower_bound, 1, &view->nans);
    copy(&view->gap, &r->gap, 1, &view->nans);
    copy(&view->sum_of_squares, &r->sum_of_squares, 1, &view->nans);
    copy(&view->sigma_floor, &r->sigma_floor, 1, &view->nans);
    copy(ignored, more, 2, &view->nans);
    for (k = 0; k < view->channels; k++) {
        copy(ignored, r->rms + k, 1, &view->nans);
    }
    for (j = 0; j < view->lobes; j++) {
        view->nans += lobe_nans(r->lobe[j]);
    }
    view->certified = r->certified;
    view->stop = r->stop;
    view->boxes = r->boxes;
    view->used = r->samples_used;
}

void fit_view_new(struct fit_view *view, const struct fit_question *q)
{
    brdffit_options options;
    const brdffit_result *result;
    brdffit_error error;
    brdffit_status status;

    if (!fit_question_options(q, &options)) {
        fail(view, BRDFFIT_ERR_UNSUPPORTED, "this build has no such lobes");
        return;
    }
    status = brdffit_fit_new(q->samples, &options, &result, &error);
    if (status != BRDFFIT_OK) {
        fail(view, status, error.message);
        return;
    }
    take(view, result);
    brdffit_result_free(result);
}

/* ---- Sums ------------------------------------------------------------------------------------------------------- */

/* Some samples in the order that they have. */
static brdffit_samples slice(const brdffit_samples *s, size_t first, size_t count)
{
    brdffit_samples part = *s;

#define FROM(array, width) part.array = s->array ? s->array + first * (width) : NULL
    FROM(light, 3);
    FROM(view, 3);
    FROM(normal, 3);
    FROM(cos_light, 1);
    FROM(cos_view, 1);
    FROM(tan2_half, 1);
    FROM(cos_difference, 1);
    FROM(a, 1);
    FROM(b, 1);
    FROM(c, 1);
    FROM(weights, 1);
    FROM(values, s->channels);
#undef FROM
    part.count = count;
    return part;
}

static brdffit_status add_halves(brdffit_sums *sums, const brdffit_samples *s, brdffit_error *error)
{
    brdffit_samples first = slice(s, 0, s->count / 2), second = slice(s, s->count / 2, s->count - s->count / 2);
    brdffit_status status = first.count ? brdffit_sums_add(sums, &first, error) : BRDFFIT_OK;

    return status == BRDFFIT_OK ? brdffit_sums_add(sums, &second, error) : status;
}

void fit_view_sums(struct fit_view *view, const struct fit_question *q, size_t groups, int bits)
{
    size_t size, work = 0;
    void *memory, *workspace = NULL;
    brdffit_sums *sums;
    brdffit_options options;
    const brdffit_result *result;
    brdffit_error error = {0};
    brdffit_status status;

    if (!fit_question_options(q, &options)) {
        fail(view, BRDFFIT_ERR_UNSUPPORTED, "this build has no such lobes");
        return;
    }
    size = brdffit_sums_size(q->samples->channels, groups);
    memory = allocate(size, 1);
    status = brdffit_sums_init(memory, size, q->samples->channels, groups, &options, &sums, &error);
    if (status == BRDFFIT_OK && bits) {
        status = brdffit_sums_bins(sums, bits, &error);
    }
    if (status == BRDFFIT_OK) {
        status = add_halves(sums, q->samples, &error);
    }
    if (status == BRDFFIT_OK) {
        work = brdffit_sums_workspace_size(sums, &options);
        workspace = allocate(work, 1);
        status = brdffit_fit_sums(sums, &options, workspace, work, &result, &error);
    }
    if (status == BRDFFIT_OK) {
        take(view, result);
        view->binned = bits > 0;
    } else {
        fail(view, status, error.message);
    }
    free(workspace);
    free(memory);
}

/* ---- Batches ---------------------------------------------------------------------------------------------------- */

static void take_texel(struct fit_view *view, const brdffit_texel_results *r, size_t t, const struct fit_question *q)
{
    size_t channels = q->samples->channels, lobes = (size_t)q->lobes;
    struct fit_view own;
    brdffit_texel_status status = (brdffit_texel_status)r->status[t];

    if (status != BRDFFIT_TEXEL_CERTIFIED && status != BRDFFIT_TEXEL_OPEN && status != BRDFFIT_TEXEL_NO_SIGNAL) {
        fail(view, BRDFFIT_ERR_VALUE, brdffit_texel_status_string(status));
        return;
    }
    fit_view_new(&own, q);
    allocate_view(view, q->lobes, channels, 1);
    copy(view->sigma, r->sigma + t * lobes, lobes, &view->nans);
    copy(view->x, r->x + t * channels, channels, &view->nans);
    copy(view->y, r->y + t * channels * lobes, channels * lobes, &view->nans);
    copy(view->scale, r->channel_scale + t * channels, channels, &view->nans);
    copy(&view->e2, r->e2 + t, 1, &view->nans);
    copy(&view->lower_bound, r->lower_bound + t, 1, &view->nans);
    copy(&view->sum_of_squares, r->sum_of_squares + t, 1, &view->nans);
    view->gap = view->e2 - view->lower_bound;
    view->certified = status != BRDFFIT_TEXEL_OPEN;
    view->stop = status == BRDFFIT_TEXEL_NO_SIGNAL ? BRDFFIT_STOP_ABSOLUTE_GAP : (brdffit_stop)r->stop[t];
    view->boxes = r->boxes[t];
    view->used = own.status == BRDFFIT_OK ? own.used : 0;
    view->sigma_floor = own.status == BRDFFIT_OK ? own.sigma_floor : NAN; /* a batch does not tell */
    fit_view_free(&own);
}

static brdffit_status fit_all(brdffit_texel_results *r, size_t texels, const double *values,
                              const struct fit_question *q, const brdffit_options *options, brdffit_error *error)
{
    size_t size = brdffit_plan_size(q->samples, options), work;
    void *memory = allocate(size, 1), *workspace;
    const brdffit_plan *plan;
    brdffit_texels in;
    brdffit_status status = brdffit_plan_init(q->samples, options, memory, size, &plan, error);

    if (status == BRDFFIT_OK) {
        work = brdffit_many_workspace_size(plan);
        workspace = allocate(work, 1);
        brdffit_texels_init(&in, plan);
        in.count = texels;
        in.values = values;
        status = brdffit_fit_many(plan, &in, r, workspace, work, NULL, error);
        free(workspace);
    }
    free(memory);
    return status;
}

void fit_view_many(struct fit_view *views, size_t texels, const double *values, const struct fit_question *q)
{
    size_t channels = q->samples->channels, lobes = (size_t)q->lobes, t;
    double *block = allocate(texels * (lobes + channels * (2 + lobes) + 3), sizeof *block), *next = block;
    unsigned char *bytes = allocate(texels, 2);
    size_t *boxes = allocate(texels, sizeof *boxes);
    brdffit_samples own = *q->samples;
    struct fit_question one = *q;
    brdffit_texel_results r;
    brdffit_options options;
    brdffit_error error = {0};
    brdffit_status status = BRDFFIT_ERR_UNSUPPORTED;

    brdffit_texel_results_init(&r);
    r.sigma = next;
    r.x = next += texels * lobes;
    r.y = next += texels * channels;
    r.channel_scale = next += texels * channels * lobes;
    r.e2 = next += texels * channels;
    r.lower_bound = next += texels;
    r.sum_of_squares = next + texels;
    r.status = bytes;
    r.stop = bytes + texels;
    r.boxes = boxes;
    if (fit_question_options(q, &options)) {
        status = fit_all(&r, texels, values, q, &options, &error);
    }
    one.samples = &own;
    for (t = 0; t < texels; t++) {
        own.values = values + t * own.count * channels;
        if (status == BRDFFIT_OK) {
            take_texel(&views[t], &r, t, &one);
        } else {
            fail(&views[t], status, error.message);
        }
    }
    free(boxes);
    free(bytes);
    free(block);
}

/* ---- Boxes, proofs ---------------------------------------------------------------------------------------------- */

struct collection {
    struct fit_box *boxes;
    size_t most, kept, seen;
    unsigned long long state;
    int lobes;
};

static void collect(void *user, const brdffit_box *box)
{
    struct collection *c = user;
    size_t place;
    int j;

    c->state = c->state * 6364136223846793005ull + 1442695040888963407ull;
    place = c->seen++ < c->most ? c->kept++ : (size_t)((c->state >> 33) % c->seen);
    for (j = 0; j < c->lobes && place < c->most; j++) {
        c->boxes[place].sigma_low[j] = box->sigma_low[j];
        c->boxes[place].sigma_high[j] = box->sigma_high[j];
        c->boxes[place].lower_bound = box->lower_bound;
    }
}

size_t fit_view_boxes(const struct fit_question *q, struct fit_box *boxes, size_t most, unsigned long long seed)
{
    struct collection c = {boxes, most, 0, 0, seed, q->lobes};
    struct fit_question asked = *q;
    struct fit_view view;

    asked.options.box = collect;
    asked.options.box_user = &c;
    fit_view_new(&view, &asked);
    fit_view_free(&view);
    return c.kept;
}

int fit_view_proves(const struct fit_question *q, double level)
{
    const brdffit_verification *proof = NULL;
    int proven;
    brdffit_options options;
    brdffit_status status;
    size_t size;
    void *workspace;

    if (!fit_question_options(q, &options)) {
        return 0;
    }
    options.engine = BRDFFIT_ENGINE_SOCP;
    size = brdffit_workspace_size(q->samples->count, q->samples->channels, &options);
    workspace = allocate(size, 1);
    status = brdffit_verify(q->samples, &options, level, workspace, size, &proof, NULL);
    proven = status == BRDFFIT_OK && proof->proven;
    free(workspace);
    return proven;
}

void fit_view_free(struct fit_view *view)
{
    free(view->x);
    memset(view, 0, sizeof *view);
}
