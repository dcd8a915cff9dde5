/*
 * Samples to rows (a, b, c, weight, radiance), exactly as brdffit.h says them. SPDX-License-Identifier: MIT
 *
 * Products of two doubles are exact in 113 bits, so dot and cross products of given vectors lose nothing but the last
 * rounding of quad_sum(). The sign of r.v, on which b of Lafortune's lobe hangs, is that of
 * 2 (n.l)(n.v) - (n.n)(l.v), a sum of products of four doubles; each is taken with its remainder.
 */
#include "quad.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sides of a limit that double arithmetic may mistake. */
#define DOUBT 4e-15

quad quad_sum(quad *term, int n)
{
    quad sum = 0;
    int pass, i;

    for (pass = 0; pass < 4; pass++) { /* error-free vector transformations: the sum stays the same */
        for (i = 1; i < n; i++) {
            quad x = term[i] + term[i - 1], z = x - term[i];

            term[i - 1] = (term[i] - (x - z)) + (term[i - 1] - z);
            term[i] = x;
        }
    }
    for (i = 0; i < n; i++) {
        sum += term[i];
    }
    return sum;
}

static quad dot(const quad *u, const quad *v)
{
    quad term[3] = {u[0] * v[0], u[1] * v[1], u[2] * v[2]};

    return quad_sum(term, 3);
}

static void cross(const quad *u, const quad *v, quad *out)
{
    int j;

    for (j = 0; j < 3; j++) {
        int k = (j + 1) % 3, m = (j + 2) % 3;
        quad term[2] = {u[k] * v[m], -u[m] * v[k]};

        out[j] = quad_sum(term, 2);
    }
}

/* x y exactly, as two terms. */
static void two_product(quad x, quad y, quad *term)
{
    term[0] = x * y;
    term[1] = fmaq(x, y, -term[0]);
}

/* 2 (n.l)(n.v) - (n.n)(l.v). */
static quad mirror_numerator(const quad *n, const quad *l, const quad *v)
{
    quad term[36];
    int i, j, used = 0;

    for (i = 0; i < 3; i++) {
        for (j = 0; j < 3; j++) {
            two_product(2 * n[i] * l[i], n[j] * v[j], term + used);
            two_product(-n[i] * n[i], l[j] * v[j], term + used + 18);
            used += 2;
        }
    }
    return quad_sum(term, 36);
}

static void from_directions(const brdffit_samples *s, size_t i, struct quad_angles *at)
{
    quad l[3], v[3], n[3] = {0, 0, 1}, nxl[3], nxv[3], lxv[3], length_l, length_v, length_n, square = 0, half = 0, nh;
    int j;

    for (j = 0; j < 3; j++) {
        l[j] = s->light[3 * i + (size_t)j];
        v[j] = s->view[3 * i + (size_t)j];
        n[j] = s->normal ? (quad)s->normal[3 * i + (size_t)j] : n[j];
    }
    length_l = sqrtq(dot(l, l));
    length_v = sqrtq(dot(v, v));
    length_n = sqrtq(dot(n, n));
    at->nl = dot(n, l) / (length_n * length_l);
    at->nv = dot(n, v) / (length_n * length_v);
    cross(n, l, nxl);
    cross(n, v, nxv);
    for (j = 0; j < 3; j++) {
        quad tangential = (nxl[j] * length_v + nxv[j] * length_l) / (length_n * length_l * length_v);
        quad h = l[j] / length_l + v[j] / length_v;

        square += tangential * tangential;
        half += h * h;
    }
    nh = at->nl + at->nv;
    at->tan2 = square / (nh * nh);
    at->vh = sqrtq(half) / 2;
    at->lv = dot(l, v) / (length_l * length_v);
    at->tan2_light = dot(nxl, nxl) / (length_n * length_n * length_l * length_l * at->nl * at->nl);
    at->tan2_view = dot(nxv, nxv) / (length_n * length_n * length_v * length_v * at->nv * at->nv);
    cross(l, v, lxv);
    at->versine = at->lv > 0 ? dot(lxv, lxv) / (4 * at->vh * at->vh * (1 + at->vh) * dot(l, l) * dot(v, v))
                             : (1 - at->lv) / (2 * (1 + at->vh));
    at->off = ((at->nl - at->nv) * (at->nl - at->nv) + square) / 2;
    at->rv = mirror_numerator(n, l, v) / (length_n * length_n * length_l * length_v);
}

static void from_angles(const brdffit_samples *s, size_t i, struct quad_angles *at)
{
    quad sum, difference;

    at->nl = s->cos_light[i];
    at->nv = s->cos_view[i];
    at->tan2 = s->tan2_half[i];
    at->vh = s->cos_difference[i];
    sum = at->nl + at->nv;
    difference = at->nl - at->nv;
    at->off = (difference * difference + at->tan2 * sum * sum) / 2; /* r - v along n and across it */
    at->rv = 1 - at->off;
    at->lv = 2 * at->vh * at->vh - 1;
    at->versine = 1 - at->vh;
    at->tan2_light = (1 - at->nl * at->nl) / (at->nl * at->nl);
    at->tan2_view = (1 - at->nv * at->nv) / (at->nv * at->nv);
}

static int near(quad x, quad limit, double by)
{
    return fabsq(x - limit) < by;
}

/* BRDFFIT_SKIP_COUNT when the sample counts. */
static brdffit_skip classify(const brdffit_samples *s, const struct quad_angles *at, double max_incidence,
                             int *doubtful)
{
    quad limit = max_incidence < 90.0 ? cosq((quad)max_incidence * (4 * atanq(1)) / 180) : -2;

    if (s->form == BRDFFIT_FORM_DIRECTIONS && s->normal && (near(at->nl, 0, DOUBT) || near(at->nv, 0, DOUBT))) {
        ++*doubtful;
    }
    *doubtful += near(at->nl, limit, 2e-12); /* the limit has an allowance of 1e-12 */
    return !(at->nl > 0)                  ? BRDFFIT_SKIP_LIGHT_BELOW_HORIZON
           : !(at->nv > 0)                ? BRDFFIT_SKIP_VIEW_BELOW_HORIZON
           : at->nl < limit - (quad)1e-12 ? BRDFFIT_SKIP_INCIDENCE
                                          : BRDFFIT_SKIP_COUNT;
}

int quad_row(const brdffit_samples *s, size_t i, brdffit_distribution distribution, const brdffit_options *o,
             struct quad_row *row, brdffit_skip *why, int *doubtful)
{
    struct quad_angles at;

    memset(row, 0, sizeof *row);
    *why = BRDFFIT_SKIP_COUNT;
    row->to_radiance = 1;
    if (s->weights && s->weights[i] == 0.0) {
        *why = BRDFFIT_SKIP_ZERO_WEIGHT;
        return 0;
    }
    if (s->form == BRDFFIT_FORM_COEFFICIENTS) {
        row->a[0] = s->a[i];
        row->b = s->b[i];
        row->c = s->c[i];
        return 1;
    }
    if (s->form == BRDFFIT_FORM_DIRECTIONS) {
        from_directions(s, i, &at);
    } else {
        from_angles(s, i, &at);
    }
    *why = classify(s, &at, o->max_incidence, doubtful);
    if (*why != BRDFFIT_SKIP_COUNT) {
        return 0;
    }
    quad_coefficients(distribution, o->masking, &at, row);
    quad_diffuse(o->diffuse, &at, row->a);
    row->to_radiance = s->quantity == BRDFFIT_QUANTITY_BRDF ? at.nl : 1;
    return 1;
}

static int allocate(struct quad_problem *p, size_t n)
{
    size_t numbers = n * (size_t)(2 + QUAD_FIXED + 5 * QUAD_LOBES + 2 * QUAD_COLUMNS) + 2 * n * p->channels +
                     p->channels;
    quad *next = p->block = calloc(numbers ? numbers : 1, sizeof *p->block);
    int j;

    p->work = quad_work_new(p->channels);
    if (!next || !p->work) {
        quad_problem_free(p);
        return 1;
    }
    for (j = 0; j < QUAD_FIXED; j++, next += n) {
        p->a[j] = next;
    }
    p->weight = next;
    p->to_radiance = next += n;
    next += n;
    for (j = 0; j < QUAD_LOBES; j++, next += 5 * n) {
        p->lobe[j].b = next;
        p->lobe[j].c = next + n;
        p->lobe[j].light = next + 2 * n;
        p->lobe[j].view = next + 3 * n;
        p->lobe[j].w = next + 4 * n;
    }
    p->column = next;
    p->radiance = next += 2 * n * QUAD_COLUMNS;
    p->data = next += n * p->channels;
    p->scale = next + n * p->channels;
    return 0;
}

/* Sample i as the next row. */
static void add(struct quad_problem *p, const brdffit_samples *s, size_t i, const brdffit_options *o)
{
    size_t k, row = p->count;
    struct quad_row r;
    brdffit_skip why;
    int j, ignored = 0;

    for (j = 0; j < p->lobes; j++) {
        if (!quad_row(s, i, p->lobe[j].distribution, o, &r, &why, j ? &ignored : &p->doubtful)) {
            p->skipped[why]++;
            return;
        }
        p->lobe[j].b[row] = r.b;
        p->lobe[j].c[row] = r.c;
        p->lobe[j].light[row] = r.light;
        p->lobe[j].view[row] = r.view;
        p->lobe[j].w[row] = r.w;
    }
    for (j = 0; j < QUAD_FIXED; j++) {
        p->a[j][row] = r.a[j];
    }
    p->weight[row] = s->weights ? (quad)s->weights[i] : 1;
    p->to_radiance[row] = r.to_radiance;
    for (k = 0; k < p->channels; k++) { /* strides of all samples until they are counted */
        p->radiance[k * s->count + row] = s->values[i * p->channels + k] * r.to_radiance;
    }
    p->count++;
}

int quad_problem_new(struct quad_problem *p, const brdffit_samples *s, const brdffit_options *options, int lobes,
                     const brdffit_distribution *distribution)
{
    static const int diffuse_columns[BRDFFIT_DIFFUSE_COUNT] = {1, 1, 2, 3};
    size_t i, k;
    int j;

    memset(p, 0, sizeof *p);
    p->channels = s->channels;
    p->lobes = lobes;
    p->norm = options->norm;
    p->diffuse = options->diffuse;
    p->fixed = diffuse_columns[options->diffuse];
    p->each = options->fresnel == BRDFFIT_FRESNEL_SCHLICK ? 2 : 1;
    p->columns = p->fixed + lobes * p->each;
    if (allocate(p, s->count)) {
        return 1;
    }
    for (j = 0; j < lobes; j++) {
        p->lobe[j].distribution = distribution[j];
        p->lobe[j].masking = options->masking;
    }
    for (i = 0; i < s->count; i++) {
        add(p, s, i, options);
    }
    for (k = 0; k < p->channels; k++) {
        memmove(p->radiance + k * p->count, p->radiance + k * s->count, p->count * sizeof *p->radiance);
        p->scale[k] = 1;
    }
    for (j = 0; j < lobes; j++) {
        struct quad_lobe *lobe = &p->lobe[j];
        int any = 0;

        for (i = 0; i < p->count; i++) {
            if (lobe->b[i] > 0 && (!any || lobe->c[i] < lobe->c_min)) {
                lobe->c_min = lobe->c[i];
                any = 1;
            }
        }
    }
    quad_scale(p, NULL);
    return 0;
}

void quad_problem_free(struct quad_problem *p)
{
    free(p->block);
    free(p->work);
    memset(p, 0, sizeof *p);
}

quad quad_largest(const struct quad_problem *p, size_t channel)
{
    quad largest = 0;
    size_t i;

    for (i = 0; i < p->count; i++) {
        largest = fmaxq(largest, p->radiance[channel * p->count + i]);
    }
    return largest;
}

void quad_scale(struct quad_problem *p, const double *channel_scale)
{
    quad zero[QUAD_COLUMNS] = {0};
    size_t i, k;

    p->total = 0;
    for (k = 0; k < p->channels; k++) {
        quad part;

        p->scale[k] = channel_scale ? (quad)channel_scale[k] : p->scale[k];
        for (i = 0; i < p->count; i++) {
            p->data[k * p->count + i] = p->radiance[k * p->count + i] / p->scale[k];
        }
        part = quad_residual(p, p->column, k, zero);
        p->total = p->norm == BRDFFIT_NORM_LINF ? fmaxq(p->total, part) : p->total + part;
    }
}
