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

/* What is one lobe's own: its geometry. */
struct verify_view {
    brdffit_distribution distribution;
    int first; /* lobe of this distribution */
    int ggx;
    double low, high;             /* the options' range of sigma */
    long double floor;            /* below, it has no finite y: see verify_floors() */
    long double c_min;
    struct verify_sample *sample; /* of each row */
    struct ref_rows rows, basis;  /* a and data are the problem's */
};

struct verify_problem {
    const brdffit_samples *samples;
    const brdffit_options *options;
    size_t used, skipped[BRDFFIT_SKIP_COUNT];
    size_t *index;                /* sample of each row */
    struct verify_sample *sample; /* of each row, as the first lobe sees it */
    long double *root;            /* of each row: root of its weight */
    long double weight_sum, total;
    long double floor; /* result.sigma_floor: narrower lobes are outside of the model */
    int lobes;
    struct verify_view lobe[BRDFFIT_MAX_LOBES];
    struct ref_rows rows;
    struct ref_basis basis; /* that of one geometry; with several, the rows themselves */
    long double *column[BRDFFIT_MAX_LOBES]; /* room for a lobe each */
    long double *room;                      /* of ref_exact() for rows */
    long double *z;                         /* channels x columns */
};

static inline brdffit_distribution verify_asked(const brdffit_options *o, int lobe)
{
    return o->distributions ? o->distributions[lobe] : o->distribution;
}

/* The distribution of each lobe of a result: like ones together, in the order of their first mention. */
static inline void verify_order(struct verify_problem *p)
{
    const brdffit_options *o = p->options;
    int i, j, first;

    p->lobes = 0;
    for (i = 0; i < o->lobes; i++) {
        for (j = 0; j < i && verify_asked(o, j) != verify_asked(o, i); j++) {
        }
        first = p->lobes;
        for (; j >= i && j < o->lobes; j++) {
            if (verify_asked(o, j) == verify_asked(o, i)) {
                struct verify_view *view = &p->lobe[p->lobes++];

                view->distribution = verify_asked(o, i);
                view->first = first;
                view->ggx = view->distribution == BRDFFIT_GGX;
                view->low = verify_lowest(o, view->distribution);
                view->high = verify_highest(o, view->distribution);
            }
        }
    }
}

static inline void verify_classify(struct verify_problem *p)
{
    size_t i;
    int j;

    verify_order(p);
    p->index = ref_allocate(p->samples->count, sizeof *p->index);
    p->root = ref_allocate(p->samples->count, sizeof *p->root);
    for (j = 0; j < p->lobes; j++) {
        p->lobe[j].sample = ref_allocate(p->samples->count, sizeof *p->sample);
        p->lobe[j].c_min = INFINITY;
    }
    p->sample = p->lobe[0].sample;
    for (i = 0; i < p->samples->count; i++) {
        brdffit_skip skip = BRDFFIT_SKIP_COUNT;
        long double weight = p->samples->weights ? (long double)p->samples->weights[i] : 1.0L;

        for (j = 0; j < p->lobes; j++) {
            struct verify_sample *sample = p->lobe[j].sample + p->used;

            skip = verify_sample_of(p->lobe[j].distribution, p->samples, p->options->max_incidence, i, sample);
            if (skip == BRDFFIT_SKIP_COUNT && sample->b > 0.0L) {
                p->lobe[j].c_min = fminl(p->lobe[j].c_min, sample->c);
            }
        }
        if (skip != BRDFFIT_SKIP_COUNT) {
            p->skipped[skip]++;
            continue;
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

/* b and c of every lobe, and the basis where they have them in common. */
static inline void verify_views(struct verify_problem *p)
{
    int j, one = 1;
    size_t i;

    for (j = 0; j < p->lobes; j++) {
        struct verify_view *view = &p->lobe[j];

        view->rows = p->rows;
        view->rows.b = ref_allocate(2 * p->used, sizeof *view->rows.b);
        view->rows.c = view->rows.b + p->used;
        for (i = 0; i < p->used; i++) {
            view->rows.b[i] = view->sample[i].b * p->root[i];
            view->rows.c[i] = view->sample[i].c;
            one = one && view->rows.b[i] == p->rows.b[i] && view->rows.c[i] == p->rows.c[i];
        }
    }
    if (one) {
        p->basis = ref_basis_new(&p->rows);
    } else {
        p->basis.rows = ref_rows_new(p->used, p->rows.channels);
        memcpy(p->basis.rows.a, p->rows.a, p->used * sizeof *p->rows.a);
        memcpy(p->basis.rows.data, p->rows.data, p->used * p->rows.channels * sizeof *p->rows.data);
    }
    for (j = 0; j < p->lobes; j++) {
        p->lobe[j].basis = one ? p->basis.rows : p->lobe[j].rows;
    }
}

static inline void verify_rows(struct verify_problem *p, const double *channel_scale)
{
    size_t i, k, channels = p->samples->channels;
    int j;

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
    verify_views(p);
    p->column[0] = ref_allocate(BRDFFIT_MAX_LOBES * (p->used + 1), sizeof *p->room);
    for (j = 1; j < BRDFFIT_MAX_LOBES; j++) {
        p->column[j] = p->column[j - 1] + p->used + 1;
    }
    p->room = ref_allocate(ref_exact_room(&p->rows) + REF_COLUMNS + 1, sizeof *p->room);
    p->z = ref_allocate(channels * REF_COLUMNS, sizeof *p->z);
}

static inline void verify_problem_free(struct verify_problem *p)
{
    int j;

    for (j = 0; j < p->lobes; j++) {
        free(p->lobe[j].sample);
        free(p->lobe[j].rows.b);
    }
    free(p->index);
    free(p->root);
    free(p->column[0]);
    free(p->room);
    free(p->z);
    ref_rows_free(&p->rows);
    ref_rows_free(&p->basis.rows);
}

/* Whether some y could be beyond doubles just below the floor: |I| / |g|, with the largest |I| of a channel. */
static inline int verify_floor_is_due_to(const struct verify_problem *p, const struct verify_view *view)
{
    long double s = 1.0L / (p->floor * p->floor), sum = 0.0L, largest = 0.0L;
    size_t i, k;

    for (i = 0; i < p->used; i++) {
        sum += powl(view->sample[i].b * p->root[i] * expl(view->ggx ? 0.0L : -(view->sample[i].c - view->c_min) * s),
                    2.0L);
    }
    for (k = 0; k < p->samples->channels; k++) {
        long double norm = 0.0L;

        for (i = 0; i < p->used; i++) {
            norm += powl(verify_radiance(p, i, k) * p->root[i], 2.0L);
        }
        largest = fmaxl(largest, norm);
    }
    return sum > 0.0L && 0.5L * logl(largest / sum) + (view->ggx ? 2.0L * log1pl(view->c_min * s) : view->c_min * s) >=
                             VERIFY_LEAST_EXPONENT;
}

static inline int verify_floor_is_due(const struct verify_problem *p)
{
    int j, due = 0;

    for (j = 0; j < p->lobes; j++) {
        due = due || verify_floor_is_due_to(p, &p->lobe[j]);
    }
    return due;
}

/*
 * Smallest roughness of each lobe: sigma_floor, which is one number for all of them. Lobes of other distributions than the
 * one that it is due to may be narrower.
 */
static inline void verify_floors(struct verify_problem *p)
{
    int j, one = 1;

    for (j = 0; j < p->lobes; j++) {
        one = one && p->lobe[j].distribution == p->lobe[0].distribution;
    }
    for (j = 0; j < p->lobes; j++) {
        struct verify_problem at = *p;

        at.floor = fminl(p->floor, p->lobe[j].high);
        p->lobe[j].floor = one || verify_floor_is_due_to(&at, &p->lobe[j]) ? p->floor : p->lobe[j].low;
    }
}

/* Unit lobes on some rows; zero where the lobe has no finite y. */
static inline void verify_lobes(struct verify_problem *p, int in_basis, const long double *sigma)
{
    int j;

    for (j = 0; j < p->lobes; j++) {
        const struct ref_rows *rows = in_basis ? &p->lobe[j].basis : &p->lobe[j].rows;

        if (sigma[j] >= p->lobe[j].floor) {
            ref_lobe(rows, p->lobe[j].ggx, sigma[j], p->column[j]);
        } else {
            memset(p->column[j], 0, rows->count * sizeof *p->column[j]);
        }
    }
}

/* Smallest E^2 at given roughnesses. */
static inline long double verify_optimum(struct verify_problem *p, const long double *sigma)
{
    const long double *column[REF_COLUMNS] = {p->basis.rows.a, p->column[0], p->column[1], p->column[2]};

    verify_lobes(p, 1, sigma);
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
        long double delta = fabsl(p->rows.data[k * p->used + i]) * p->sample[i].error_radiance;

        delta += z[0] * column[0][i] * p->sample[i].error_a;
        for (j = 0; j < p->lobes; j++) {
            const struct verify_sample *sample = p->lobe[j].sample + i;

            delta += z[1 + j] * column[1 + j][i] *
                     (sample->error_b + verify_lobe_error(p->lobe[j].ggx, sample->c, sample->error_c, sigma[j]));
        }
        sum += delta * delta;
    }
    return sum;
}

/* How far E^2 of the best model at these roughnesses can be from what the library sees. */
static inline long double verify_allowance(struct verify_problem *p, const long double *sigma)
{
    const long double *column[REF_COLUMNS] = {p->rows.a, p->column[0], p->column[1], p->column[2]};
    long double e2, delta2 = 0.0L;
    size_t k;

    verify_lobes(p, 0, sigma);
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
    long double low[BRDFFIT_MAX_LOBES], high[BRDFFIT_MAX_LOBES], bound;
    long double best, sigma[BRDFFIT_MAX_LOBES]; /* smallest E^2 met */
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
        memcpy(attack->sigma, sigma, (size_t)p->lobes * sizeof *sigma);
        attack->broken = e2 < attack->bound && !(e2 + verify_allowance(p, sigma) >= attack->bound);
    }
    return e2;
}

/* A roughness from all over the domain, in four ways, or from near `optimum`. */
static inline long double verify_random_sigma(struct verify_attack *attack, int lobe, long double optimum)
{
    long double low = attack->low[lobe], high = attack->high[lobe], u = verify_random(attack), sigma;

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

/* Steps in ln sigma: both ways along each lobe, then the diagonals of each pair. Returns how many. */
#define VERIFY_WAYS 18
static inline int verify_ways(int lobes, int way[VERIFY_WAYS][BRDFFIT_MAX_LOBES])
{
    int count = 0, p, q, sign;

    memset(way, 0, VERIFY_WAYS * sizeof *way);
    for (p = 0; p < lobes; p++) {
        for (sign = -1; sign <= 1; sign += 2) {
            way[count++][p] = sign;
            for (q = 0; q < p; q++) {
                way[count][p] = way[count][q] = sign;
                count++;
                way[count][p] = sign;
                way[count][q] = -sign;
                count++;
            }
        }
    }
    return count;
}

/* Pattern search in ln sigma from a point. */
static inline void verify_descend(struct verify_attack *attack, const long double *from)
{
    int lobes = attack->problem->lobes, way[VERIFY_WAYS][BRDFFIT_MAX_LOBES], ways = verify_ways(lobes, way);
    long double here[BRDFFIT_MAX_LOBES], e2, step = 0.3L;
    int tries = 0, j, p;

    memcpy(here, from, sizeof here);
    e2 = verify_try(attack, here);
    while (step > 1e-6L && tries < 150 * lobes && !attack->broken) {
        int better = 0;

        for (j = 0; j < ways && !better; j++, tries++) {
            long double there[BRDFFIT_MAX_LOBES], value;

            for (p = 0; p < lobes; p++) {
                there[p] = fminl(fmaxl(here[p] * expl(step * way[j][p]), attack->low[p]), attack->high[p]);
            }
            value = verify_try(attack, there);
            if (value < e2) {
                e2 = value;
                memcpy(here, there, (size_t)lobes * sizeof *here);
                better = 1;
            }
        }
        step *= better ? 1.0L : 0.5L;
    }
}

static inline void verify_random_point(struct verify_attack *attack, const double *optimum, long double *sigma)
{
    int p;

    for (p = 0; p < BRDFFIT_MAX_LOBES; p++) {
        sigma[p] = p < attack->problem->lobes ? verify_random_sigma(attack, p, optimum[p]) : 0.0L;
    }
}

/* Points of the whole domain, then descents from the best of them and from random ones. */
static inline void verify_attack_bound(struct verify_attack *attack, const double *optimum, size_t attacks)
{
    long double sigma[BRDFFIT_MAX_LOBES];
    size_t i;

    attack->best = INFINITY;
    for (i = 0; i < attacks && !attack->broken; i++) {
        verify_random_point(attack, optimum, sigma);
        (void)verify_try(attack, sigma);
    }
    memcpy(sigma, attack->sigma, sizeof sigma);
    for (i = 0; i < 1 + attacks / 500 && !attack->broken; i++) {
        verify_descend(attack, sigma);
        verify_random_point(attack, optimum, sigma);
    }
}

#endif
