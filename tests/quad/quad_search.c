/*
 * Good points of a domain: a grid in ln s, its ends, and descents. Nothing here claims to be the least E^2; every point
 * is inside of the domain, whose ends are taken exactly. SPDX-License-Identifier: MIT
 */
#include "quad.h"

#include <math.h>
#include <string.h>

/* Differences in ln s: derivatives to 1e-16 of E^2's own scale. */
#define DIFFERENCE 1e-9
#define NEWTON_STEPS 24
#define PATTERN_END 1e-9
#define STARTS 3

int quad_domain_of(const struct quad_problem *p, const brdffit_options *options, double sigma_floor,
                   struct quad_domain *domain)
{
    int j;

    for (j = 0; j < p->lobes; j++) {
        quad floor_s = quad_s(sigma_floor);

        if (quad_by_exponent(p->lobe[j].distribution)) {
            domain->low[j] = options->exponent_min;
            domain->high[j] = options->exponent_max;
            /* The floor is 1/sqrt(exponent_max), rounded, where there is no other. */
            floor_s = floor_s >= domain->high[j] * (1 - (quad)1e-15) ? domain->high[j] : floor_s;
        } else {
            domain->low[j] = quad_s(options->sigma_max);
            domain->high[j] = quad_s(options->sigma_min);
        }
        domain->high[j] = fminq(domain->high[j], floor_s);
        if (!(domain->low[j] <= domain->high[j])) {
            return 0;
        }
    }
    return 1;
}

void quad_search_begin(struct quad_search *search, const struct quad_problem *p, const struct quad_domain *domain,
                       size_t limit)
{
    memset(search, 0, sizeof *search);
    search->problem = p;
    search->domain = *domain;
    search->limit = limit;
    search->best = strtoflt128("inf", NULL);
}

quad quad_try(struct quad_search *search, const quad *s)
{
    int j, lobes = search->problem->lobes;
    quad inside[QUAD_LOBES], e2;

    for (j = 0; j < lobes; j++) {
        inside[j] = fmaxq(search->domain.low[j], fminq(s[j], search->domain.high[j]));
    }
    search->evaluations++;
    e2 = quad_at(search->problem, inside);
    if (e2 < search->best) {
        search->best = e2;
        memcpy(search->s, inside, (size_t)lobes * sizeof *inside);
    }
    return e2;
}

/* ---- Newton ----------------------------------------------------------------------------------------------------- */

struct slope {
    quad value, gradient[QUAD_LOBES], hessian[QUAD_LOBES][QUAD_LOBES];
};

/* E^2 beside s, also outside of the domain, where it is not kept. */
static quad beside(struct quad_search *search, const quad *s, int i, double up, int j, double right)
{
    quad moved[QUAD_LOBES];

    memcpy(moved, s, sizeof moved);
    moved[i] *= expq((quad)up);
    moved[j] *= expq((quad)right);
    search->evaluations++;
    return quad_at(search->problem, moved);
}

static void differentiate(struct quad_search *search, const quad *s, struct slope *at)
{
    quad h = DIFFERENCE, up[QUAD_LOBES];
    int i, j;

    for (i = 0; i < search->problem->lobes; i++) {
        quad down = beside(search, s, i, -DIFFERENCE, i, 0.0);

        up[i] = beside(search, s, i, DIFFERENCE, i, 0.0);
        at->gradient[i] = (up[i] - down) / (2 * h);
        at->hessian[i][i] = ((up[i] - at->value) - (at->value - down)) / (h * h);
        for (j = 0; j < i; j++) {
            quad both = beside(search, s, i, DIFFERENCE, j, DIFFERENCE);

            at->hessian[i][j] = at->hessian[j][i] = ((both - up[i]) - (up[j] - at->value)) / (h * h);
        }
    }
}

/* A step downhill, at most `most` long in each coordinate; 0 when there is none. */
static int newton_step(const struct quad_search *search, const quad *s, const struct slope *at, quad damping, quad most,
                       quad *step)
{
    quad matrix[(QUAD_COLUMNS + 1) * (QUAD_COLUMNS + 1)], right[QUAD_COLUMNS + 1], slope = 0, longest = 0;
    int free[QUAD_LOBES], n = 0, i, j;

    for (i = 0; i < search->problem->lobes; i++) {
        int stuck = (s[i] <= search->domain.low[i] && at->gradient[i] >= 0) ||
                    (s[i] >= search->domain.high[i] && at->gradient[i] <= 0);

        step[i] = 0;
        if (!stuck && fabsq(at->hessian[i][i]) > 0) {
            free[n++] = i;
        }
    }
    for (i = 0; i < n; i++) {
        right[i] = -at->gradient[free[i]];
        for (j = 0; j < n; j++) {
            matrix[i * (QUAD_COLUMNS + 1) + j] = at->hessian[free[i]][free[j]];
        }
        matrix[i * (QUAD_COLUMNS + 1) + i] += damping * fabsq(at->hessian[free[i]][free[i]]);
    }
    if (!n || !quad_solve(matrix, right, n)) {
        return 0;
    }
    for (i = 0; i < n; i++) {
        step[free[i]] = right[i];
        slope += right[i] * at->gradient[free[i]];
        longest = fmaxq(longest, fabsq(right[i]));
    }
    for (i = 0; i < n && longest > most; i++) {
        step[free[i]] *= most / longest;
    }
    return slope < 0;
}

static void move(const struct quad_search *search, const quad *s, const quad *step, quad factor, quad *to)
{
    int j;

    for (j = 0; j < search->problem->lobes; j++) {
        to[j] = s[j] * expq(step[j] * factor);
        to[j] = fmaxq(search->domain.low[j], fminq(to[j], search->domain.high[j]));
    }
}

/* Shorter and shorter along the step until E^2 falls; the fall, or 0. */
static quad line_search(struct quad_search *search, quad *s, struct slope *at, const quad *step)
{
    quad factor = 1, to[QUAD_LOBES];
    int tries;

    for (tries = 0; tries < 8; tries++, factor /= 4) {
        quad e2, fall;

        move(search, s, step, factor, to);
        e2 = quad_try(search, to);
        fall = at->value - e2;
        if (fall > 0) {
            memcpy(s, to, (size_t)search->problem->lobes * sizeof *s);
            at->value = e2;
            return fall;
        }
    }
    return 0;
}

static void descend_smooth(struct quad_search *search, const quad *from)
{
    quad s[QUAD_LOBES] = {1, 1, 1}, step[QUAD_LOBES] = {0}, fall;
    struct slope at;
    int i;

    move(search, from, step, 1, s);
    at.value = quad_try(search, s);
    for (i = 0; i < NEWTON_STEPS && search->evaluations < search->limit && finiteq(at.value); i++) {
        quad damping = 0;

        differentiate(search, s, &at);
        while (!newton_step(search, s, &at, damping, 1, step)) {
            if (damping > 100) {
                return;
            }
            damping = 4 * damping + 1.25;
        }
        fall = line_search(search, s, &at, step);
        if (!(fall > 1e-28 * at.value)) {
            return;
        }
    }
}

/* ---- Pattern search --------------------------------------------------------------------------------------------- */

/* Direction d of 3^lobes, as steps of -1, 0, 1. */
static void compass(int d, int lobes, quad length, quad *step)
{
    int j;

    for (j = 0; j < lobes; j++, d /= 3) {
        step[j] = length * (d % 3 - 1);
    }
}

static void descend_rough(struct quad_search *search, const quad *from)
{
    quad s[QUAD_LOBES] = {1, 1, 1}, step[QUAD_LOBES] = {0}, to[QUAD_LOBES], e2, length = 0.25;
    int lobes = search->problem->lobes, directions = lobes == 1 ? 3 : lobes == 2 ? 9 : 27;

    move(search, from, step, 1, s);
    e2 = quad_try(search, s);
    while (length > PATTERN_END && search->evaluations < search->limit) {
        int d, better = 0;

        for (d = 0; d < directions && !better; d++) {
            quad here;

            if (d == directions / 2) {
                continue;
            }
            compass(d, lobes, length, step);
            move(search, s, step, 1, to);
            here = quad_try(search, to);
            if (here < e2) {
                e2 = here;
                memcpy(s, to, sizeof s);
                better = 1;
            }
        }
        length *= better ? 1.5 : 0.3;
    }
}

void quad_descend(struct quad_search *search, const quad *s)
{
    if (search->problem->norm == BRDFFIT_NORM_L2) {
        descend_smooth(search, s);
    } else {
        descend_rough(search, s);
    }
}

/* ---- The whole domain ------------------------------------------------------------------------------------------- */

/* Where lobe j changes at all: from c s ~ 1e-18 to where only the smallest c is left. */
static void live_range(const struct quad_search *search, int j, quad *low, quad *high)
{
    const struct quad_lobe *lobe = &search->problem->lobe[j];
    int smith = lobe->masking == BRDFFIT_MASKING_SMITH || lobe->masking == BRDFFIT_MASKING_SMITH_SEPARABLE;
    quad largest = 0, least = 0, widest = 0, reach = lobe->distribution == BRDFFIT_GGX ? 1e10 : 60, end;
    size_t i;

    for (i = 0; i < search->problem->count; i++) {
        quad above = lobe->b[i] > 0 ? lobe->c[i] - lobe->c_min : 0;

        widest = lobe->b[i] > 0 && smith ? fmaxq(widest, fmaxq(lobe->light[i], lobe->view[i])) : widest;
        largest = fmaxq(largest, above);
        least = above > 0 && (!(least > 0) || above < least) ? above : least;
    }
    *low = logq(search->domain.low[j]);
    *high = logq(search->domain.high[j]);
    if (largest > 0 || widest > 0) { /* Smith's G changes up to a few tan^2, too */
        end = fmaxq(least > 0 ? reach / least : 0, 4 * widest);
        *high = fmaxq(*low, fminq(*high, logq(end)));
        *low = smith ? *low : fminq(*high, fmaxq(*low, logq(1e-18 / largest)));
    }
}

struct start {
    quad e2, s[QUAD_LOBES];
};

/* Lobes of one distribution are exchangeable: one order of them is enough. */
static int repeated(const struct quad_problem *p, const quad *s)
{
    int j;

    for (j = 1; j < p->lobes; j++) {
        if (p->lobe[j].distribution == p->lobe[j - 1].distribution && s[j] > s[j - 1]) {
            return 1;
        }
    }
    return 0;
}

/* Keep the best few that are no neighbours of a better one. */
static void keep(struct start *list, const quad *s, quad e2, int lobes, const quad *spacing)
{
    struct start new;
    int i, j, n;

    new.e2 = e2;
    memcpy(new.s, s, sizeof new.s);
    for (i = 0; i < STARTS; i++) {
        int close = finiteq(list[i].e2);

        for (j = 0; j < lobes && close; j++) {
            close = fabsq(logq(list[i].s[j] / s[j])) < 1.5 * spacing[j];
        }
        if (close && list[i].e2 <= e2) {
            return;
        }
        if (e2 < list[i].e2) {
            for (n = close ? i : STARTS - 1; n > i; n--) {
                list[n] = list[n - 1];
            }
            list[i] = new;
            return;
        }
    }
}

static int common_divisor(int a, int b)
{
    return b ? common_divisor(b, a % b) : a;
}

/* A stride that visits each of n places, far apart from one to the next: a scan that is cut short was everywhere. */
static int stride_of(int n)
{
    int stride = (int)(0.618 * n);

    while (common_divisor(n, stride) != 1) {
        stride++;
    }
    return stride;
}

void quad_scan(struct quad_search *search, int points)
{
    quad low[QUAD_LOBES], high[QUAD_LOBES], spacing[QUAD_LOBES], s[QUAD_LOBES] = {1, 1, 1};
    struct start list[STARTS];
    int lobes = search->problem->lobes, all = 1, stride, n, j, i;

    for (j = 0; j < STARTS; j++) {
        list[j].e2 = strtoflt128("inf", NULL);
    }
    for (j = 0; j < lobes; j++) {
        live_range(search, j, &low[j], &high[j]);
        spacing[j] = (high[j] - low[j]) / (points - 1);
        all *= points + 2;
    }
    stride = stride_of(all);
    for (n = 0; n < all && search->evaluations < search->limit; n++) {
        int rest = (int)((long)n * stride % all);

        for (j = 0; j < lobes; j++, rest /= points + 2) {
            i = rest % (points + 2);
            s[j] = i == points       ? search->domain.low[j]
                   : i == points + 1 ? search->domain.high[j]
                                     : expq(low[j] + spacing[j] * i);
        }
        if (!repeated(search->problem, s)) {
            keep(list, s, quad_try(search, s), lobes, spacing);
        }
    }
    for (j = 0; j < STARTS && finiteq(list[j].e2); j++) {
        search->limit += search->limit / STARTS;
        quad_descend(search, list[j].s);
    }
}
