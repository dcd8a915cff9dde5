/*
 * verify.c, part 2 of 4: the least-squares problem that a result is about, in long double, and attacks on its
 * lower bound. SPDX-License-Identifier: MIT
 *
 * Rows are in the units that were minimised: multiplied by the root of the weight, divided by channel_scale.
 *
 * The library sees slightly different coefficients (verify_samples.h). With delta the length of the vector of
 * those differences at a model, | E_here - E_there | <= delta, so E^2 differs by at most 2 E delta + delta^2.
 * That is the only allowance that a lower bound gets.
 */
#ifndef BRDFFIT_TESTS_VERIFY_PROBLEM_H
#define BRDFFIT_TESTS_VERIFY_PROBLEM_H

#include "ref/ref_exact.h"
#include "verify_samples.h"

/* sigma_floor may leave out narrower lobes only if their y could pass exp(this): 1e260. */
#define VERIFY_LEAST_EXPONENT 600.0L

struct verify_problem {
    const brdffit_samples *samples;
    const brdffit_options *options;
    size_t used, skipped[BRDFFIT_SKIP_COUNT];
    size_t *index;                /* sample of each row */
    struct verify_sample *sample; /* of each row */
    long double *root;            /* of each row: root of its weight */
    long double weight_sum, total, c_min;
    long double floor; /* result.sigma_floor: narrower lobes are outside of the model */
    int ggx, lobes;
    struct ref_rows rows;
    struct ref_basis basis;
    long double *column[2]; /* room for a lobe each */
    long double *room;      /* of ref_exact() for rows */
    long double *z;         /* channels x 3 */
};

static inline void verify_classify(struct verify_problem *p)
{
    size_t i;

    p->index = ref_allocate(p->samples->count, sizeof *p->index);
    p->sample = ref_allocate(p->samples->count, sizeof *p->sample);
    p->root = ref_allocate(p->samples->count, sizeof *p->root);
    p->c_min = INFINITY;
    for (i = 0; i < p->samples->count; i++) {
        struct verify_sample *sample = p->sample + p->used;
        brdffit_skip skip = verify_sample_of(p->options->distribution, p->samples, p->options->max_incidence, i,
                                             sample);
        long double weight = p->samples->weights ? (long double)p->samples->weights[i] : 1.0L;

        if (skip != BRDFFIT_SKIP_COUNT) {
            p->skipped[skip]++;
            continue;
        }
        if (sample->b > 0.0L) {
            p->c_min = fminl(p->c_min, sample->c);
        }
        p->weight_sum += weight;
        p->root[p->used] = sqrtl(weight);
        p->index[p->used++] = i;
    }
}

static inline long double verify_radiance(const struct verify_problem *p, size_t row, size_t channel)
{
    return p->samples->values[p->index[row] * p->samples->channels + channel] * p->sample[row].to_radiance;
}

static inline void verify_rows(struct verify_problem *p, const double *channel_scale)
{
    size_t i, k, channels = p->samples->channels;

    p->rows = ref_rows_new(p->used, channels);
    for (i = 0; i < p->used; i++) {
        p->rows.a[i] = p->sample[i].a * p->root[i];
        p->rows.b[i] = p->sample[i].b * p->root[i];
        p->rows.c[i] = p->sample[i].c;
        for (k = 0; k < channels; k++) {
            p->rows.data[k * p->used + i] = verify_radiance(p, i, k) * p->root[i] / channel_scale[k];
        }
    }
    for (k = 0; k < channels; k++) {
        p->total += ref_dot(p->rows.data + k * p->used, p->rows.data + k * p->used, p->used);
    }
    p->basis = ref_basis_new(&p->rows);
    p->column[0] = ref_allocate(2 * (p->used + 1), sizeof *p->room);
    p->column[1] = p->column[0] + p->used + 1;
    p->room = ref_allocate(ref_exact_room(&p->rows) + REF_COLUMNS + 1, sizeof *p->room);
    p->z = ref_allocate(channels * REF_COLUMNS, sizeof *p->z);
}

static inline void verify_problem_free(struct verify_problem *p)
{
    free(p->index);
    free(p->sample);
    free(p->root);
    free(p->column[0]);
    free(p->room);
    free(p->z);
    ref_rows_free(&p->rows);
    ref_rows_free(&p->basis.rows);
}

/* Whether some y could be beyond doubles just below the floor: |I| / |g|, with the largest |I| of a channel. */
static inline int verify_floor_is_due(const struct verify_problem *p)
{
    long double s = 1.0L / (p->floor * p->floor), sum = 0.0L, largest = 0.0L;
    size_t i, k;

    for (i = 0; i < p->used; i++) {
        sum += powl(p->sample[i].b * p->root[i] * expl(p->ggx ? 0.0L : -(p->sample[i].c - p->c_min) * s), 2.0L);
    }
    for (k = 0; k < p->samples->channels; k++) {
        long double norm = 0.0L;

        for (i = 0; i < p->used; i++) {
            norm += powl(verify_radiance(p, i, k) * p->root[i], 2.0L);
        }
        largest = fmaxl(largest, norm);
    }
    return sum > 0.0L &&
           0.5L * logl(largest / sum) + (p->ggx ? 2.0L * log1pl(p->c_min * s) : p->c_min * s) >= VERIFY_LEAST_EXPONENT;
}

/* Smallest roughness of the model. */
static inline long double verify_smallest_sigma(const struct verify_problem *p)
{
    return p->floor;
}

/* Unit lobes on some rows; zero where the lobe has no finite y. */
static inline void verify_lobes(struct verify_problem *p, const struct ref_rows *rows, const long double *sigma)
{
    int j;

    for (j = 0; j < p->lobes; j++) {
        if (sigma[j] >= verify_smallest_sigma(p)) {
            ref_lobe(rows, p->ggx, sigma[j], p->column[j]);
        } else {
            memset(p->column[j], 0, rows->count * sizeof *p->column[j]);
        }
    }
}

/* Smallest E^2 at given roughnesses. */
static inline long double verify_optimum(struct verify_problem *p, const long double *sigma)
{
    const long double *column[REF_COLUMNS] = {p->basis.rows.a, p->column[0], p->column[1]};

    verify_lobes(p, &p->basis.rows, sigma);
    return p->basis.unreachable + ref_exact(&p->basis.rows, column, 1 + p->lobes, p->room, NULL);
}

/* Squared length of the differences that roundings of the library's coefficients make in channel k (see top). */
static inline long double verify_delta2(const struct verify_problem *p, const long double *sigma,
                                        const long double *const *column, const long double *z, size_t k)
{
    long double sum = 0.0L;
    size_t i;
    int j;

    for (i = 0; i < p->used; i++) {
        const struct verify_sample *sample = p->sample + i;
        long double delta = fabsl(p->rows.data[k * p->used + i]) * sample->error_radiance;

        delta += z[0] * column[0][i] * sample->error_a;
        for (j = 0; j < p->lobes; j++) {
            delta += z[1 + j] * column[1 + j][i] *
                     (sample->error_b + verify_lobe_error(p->ggx, sample->c, sample->error_c, sigma[j]));
        }
        sum += delta * delta;
    }
    return sum;
}

/* How far E^2 of the best model at these roughnesses can be from what the library sees. */
static inline long double verify_allowance(struct verify_problem *p, const long double *sigma)
{
    const long double *column[REF_COLUMNS] = {p->rows.a, p->column[0], p->column[1]};
    long double e2, delta2 = 0.0L;
    size_t k;

    verify_lobes(p, &p->rows, sigma);
    e2 = ref_exact(&p->rows, column, 1 + p->lobes, p->room, p->z);
    for (k = 0; k < p->rows.channels; k++) {
        delta2 += verify_delta2(p, sigma, column, p->z + k * (size_t)(1 + p->lobes), k);
    }
    return 2.0L * sqrtl(e2 * delta2) + delta2;
}

/* ---- Attacks ----------------------------------------------------------------------------------------- */

struct verify_attack {
    struct verify_problem *problem;
    unsigned long long state;
    long double low, high, bound;
    long double best, sigma[2]; /* smallest E^2 met */
    int broken;
};

/* splitmix64, in (0, 1). */
static inline long double verify_random(struct verify_attack *attack)
{
    unsigned long long x = attack->state += 0x9e3779b97f4a7c15ull;

    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    x ^= x >> 31;
    return ((long double)(x >> 11) + 0.5L) / 9007199254740992.0L;
}

/* E^2 at a point of the domain; `broken` when it is below the bound by more than roundings explain. */
static inline long double verify_try(struct verify_attack *attack, const long double *sigma)
{
    struct verify_problem *p = attack->problem;
    long double e2 = verify_optimum(p, sigma);

    if (e2 < attack->best) {
        attack->best = e2;
        attack->sigma[0] = sigma[0];
        attack->sigma[1] = sigma[1];
        attack->broken = e2 < attack->bound && !(e2 + verify_allowance(p, sigma) >= attack->bound);
    }
    return e2;
}

/* A roughness from all over the domain, in four ways, or from near `optimum`. */
static inline long double verify_random_sigma(struct verify_attack *attack, long double optimum)
{
    long double low = attack->low, high = attack->high, u = verify_random(attack), sigma;

    switch ((int)(5.0L * verify_random(attack))) {
    case 0: return low + (high - low) * u;
    case 1: return low * powl(high / low, u);
    case 2: low = fmaxl(low, 1e-3L * high); return low * powl(high / low, u);
    case 3: return u < 0.5L ? low : high;
    default:
        sigma = optimum * expl((u - 0.5L) * powl(10.0L, -8.0L * verify_random(attack)));
        return fminl(fmaxl(sigma, low), high);
    }
}

/* Pattern search in ln sigma from a point. */
static inline void verify_descend(struct verify_attack *attack, const long double *from)
{
    static const int direction[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
    long double here[2] = {from[0], from[1]}, e2 = verify_try(attack, here), step = 0.3L;
    int tries = 0, j;

    while (step > 1e-6L && tries < 300 && !attack->broken) {
        int better = 0;

        for (j = 0; j < (attack->problem->lobes == 2 ? 8 : 2) && !better; j++, tries++) {
            long double there[2], value;

            there[0] = fminl(fmaxl(here[0] * expl(step * direction[j][0]), attack->low), attack->high);
            there[1] = fminl(fmaxl(here[1] * expl(step * direction[j][1]), attack->low), attack->high);
            value = verify_try(attack, there);
            if (value < e2) {
                e2 = value;
                here[0] = there[0];
                here[1] = there[1];
                better = 1;
            }
        }
        step *= better ? 1.0L : 0.5L;
    }
}

/* Points of the whole domain, then descents from the best of them and from random ones. */
static inline void verify_attack_bound(struct verify_attack *attack, const double *optimum, size_t attacks)
{
    long double start[2];
    size_t i;

    attack->best = INFINITY;
    for (i = 0; i < attacks && !attack->broken; i++) {
        long double sigma[2];

        sigma[0] = verify_random_sigma(attack, optimum[0]);
        sigma[1] = verify_random_sigma(attack, optimum[1]);
        (void)verify_try(attack, sigma);
    }
    start[0] = attack->sigma[0];
    start[1] = attack->sigma[1];
    for (i = 0; i < 1 + attacks / 500 && !attack->broken; i++) {
        verify_descend(attack, start);
        start[0] = verify_random_sigma(attack, optimum[0]);
        start[1] = verify_random_sigma(attack, optimum[1]);
    }
}

#endif
