/*
 * How good a fit is, and whether the model describes the data at all. SPDX-License-Identifier: MIT
 *
 * With residuals r = I - F of radiance, weights w and every channel in units of its largest |I|:
 *
 *     R^2 = 1 - sum w r^2 / sum w (I - mean I)^2        relative = sqrt(sum w r^2 / sum w I^2)
 *
 * A model that describes the data leaves noise, which one sample cannot foretell of another. What it misses is smooth: the
 * residual of a sample is near those of its neighbours. So each residual is foretold by the mean of those of its four
 * nearest samples, weighted by 1 / distance, in the coordinates that isotropic models see (sin of both polar angles, that
 * of the view turned by the azimuth between the two), and
 *
 *     foreseen = 1 - sum (r - foretold)^2 / sum r^2
 *
 * of noise is about -0.4 and of a smooth miss near 1. The thresholds stand in base/tolerance.h.
 *
 * Limits: what is sampled too coarsely to foretell itself is never found PATTERNED. Of more than 512 samples every n-th is
 * looked at. Samples given as a, b, c have no neighbours.
 */
#include <math.h>

#include "base/error.h"
#include "base/tolerance.h"
#include "fit/fit.h"
#include "model/geometry.h"

#define NEIGHBOURS 4
#define LOOKED_AT 512

/* Channels that are added up in one pass over the samples. */
#define BLOCK ((size_t)16)

struct spot {
    size_t sample;
    double x, y, z; /* of a unit cube twice as wide */
    double factor;  /* value to radiance */
    size_t near[NEIGHBOURS];
    double weight[NEIGHBOURS];
};

struct judge {
    const brdffit_samples *samples;
    const double *fitted;
    brdffit_distribution lead;
    double min_cosine;
    size_t used;
    double residual, spread, square; /* over all channels, in units of their largest */
    int poor;                        /* some channel is */
    double missed, looked;           /* sums of (r - foretold)^2 and r^2 of the places */
};

/* 1 when sample i is used; its geometry in *g. Bad samples were found by brdffit_inspect_run(). */
static int is_used(const struct judge *j, size_t i, struct geometry *g)
{
    brdffit_status status = BRDFFIT_OK;

    *g = (struct geometry){.cos_light = 1.0};
    return brdffit_geometry_sample(j->samples, j->lead, j->min_cosine, i, g, &status, NULL) == BRDFFIT_SKIP_COUNT;
}

static double to_radiance(const struct judge *j, const struct geometry *g)
{
    return j->samples->quantity == BRDFFIT_QUANTITY_BRDF ? g->cos_light : 1.0;
}

static double weight_of(const struct judge *j, size_t i)
{
    return j->samples->weights ? j->samples->weights[i] : 1.0;
}

/* Of one channel, values in units of `unit`, their largest size, so that no square overflows. */
struct channel {
    double unit, first; /* the first value, which is taken off before squares are added up */
    double weights, sum, shifted, square, residual, largest;
};

/* Over all samples, used or not: no geometry is needed for that. */
static double largest_value(const struct judge *j, size_t k)
{
    const size_t channels = j->samples->channels;
    double largest = 0.0;
    size_t i;

    for (i = 0; i < j->samples->count; i++) {
        largest = fmax(largest, fabs(j->samples->values[i * channels + k]));
    }
    return largest > 0.0 && isfinite(largest) ? largest : 1.0;
}

static void add_value(struct channel *c, double value, double residual, double w)
{
    c->first = c->weights > 0.0 ? c->first : value;
    c->weights += w;
    c->sum += w * (value - c->first);
    c->shifted += w * (value - c->first) * (value - c->first);
    c->square += w * value * value;
    c->residual += w * residual * residual;
    c->largest = fmax(c->largest, fabs(value));
}

/* Channels first to first + count - 1, in one pass over the samples. */
static void add_block(struct judge *j, size_t first, size_t count, double weight_unit, struct channel *c)
{
    struct geometry g;
    size_t i, k;

    for (k = 0; k < count; k++) {
        c[k] = (struct channel){.unit = largest_value(j, first + k)};
    }
    j->used = 0;
    for (i = 0; i < j->samples->count; i++) {
        const size_t at = i * j->samples->channels + first;

        if (!is_used(j, i, &g)) {
            continue;
        }
        j->used++;
        for (k = 0; k < count; k++) {
            const double factor = to_radiance(j, &g), value = j->samples->values[at + k] / c[k].unit * factor;

            add_value(&c[k], value, value - j->fitted[at + k] / c[k].unit * factor, weight_of(j, i) / weight_unit);
        }
    }
}

/* R^2 of a channel, whose sums are added to all in units of its largest radiance. */
static double add_channel(struct judge *j, const struct channel *c)
{
    const double spread = fmax(0.0, c->shifted - c->sum * c->sum / c->weights);
    const double scale = c->largest > 0.0 ? 1.0 / (c->weights * c->largest * c->largest) : 1.0 / c->weights;

    j->residual += c->residual * scale;
    j->spread += spread * scale;
    j->square += c->square * scale;
    j->poor |= spread * (1.0 - TOL_POOR_R2) < c->residual &&
               c->residual > TOL_POOR_RELATIVE * TOL_POOR_RELATIVE * c->square;
    return spread > 0.0 ? 1.0 - c->residual / spread : c->residual > 0.0 ? -INFINITY : 1.0;
}

static double largest_weight(const brdffit_samples *s)
{
    double largest = 0.0;
    size_t i;

    for (i = 0; s->weights && i < s->count; i++) {
        largest = fmax(largest, s->weights[i]);
    }
    return largest > 0.0 ? largest : 1.0;
}

/* ---- Neighbours ---------------------------------------------------------- */

/* cos of the azimuth between light and viewer from l.v = n.l n.v + sin sin cos. */
static void place_sample(const struct judge *j, const struct geometry *g, size_t i, struct spot *p)
{
    const double cl = g->angles.cos_light, cv = g->angles.cos_view, d = g->angles.cos_difference;
    const double sl = sqrt(fmax(0.0, 1.0 - cl * cl)), sv = sqrt(fmax(0.0, 1.0 - cv * cv));
    const double between = 2.0 * d * d - 1.0 - cl * cv;
    const double cosine = sl * sv > 0.0 ? fmax(-1.0, fmin(1.0, between / (sl * sv))) : 1.0;

    p->sample = i;
    p->factor = to_radiance(j, g);
    p->x = sl;
    p->y = sv * cosine;
    p->z = sv * sqrt(1.0 - cosine * cosine);
}

static size_t take_places(const struct judge *j, struct spot *places)
{
    const size_t step = (j->used + LOOKED_AT - 1) / LOOKED_AT;
    struct geometry g;
    size_t i, seen = 0, taken = 0;

    for (i = 0; i < j->samples->count && taken < LOOKED_AT; i++) {
        if (is_used(j, i, &g) && seen++ % step == 0) {
            place_sample(j, &g, i, &places[taken++]);
        }
    }
    return taken;
}

/* Put q among the nearest of p, nearest first; ties go to the earlier sample. */
static void offer(struct spot *p, double distance2[NEIGHBOURS], size_t q, double d2)
{
    int at = NEIGHBOURS;

    while (at > 0 && d2 < distance2[at - 1]) {
        at--;
        if (at + 1 < NEIGHBOURS) {
            distance2[at + 1] = distance2[at];
            p->near[at + 1] = p->near[at];
        }
    }
    if (at < NEIGHBOURS) {
        distance2[at] = d2;
        p->near[at] = q;
    }
}

static void find_neighbours(struct spot *places, size_t count, size_t at)
{
    struct spot *p = &places[at];
    double distance2[NEIGHBOURS] = {INFINITY, INFINITY, INFINITY, INFINITY}, sum = 0.0;
    size_t q;
    int n;

    for (q = 0; q < count; q++) {
        const double x = places[q].x - p->x, y = places[q].y - p->y, z = places[q].z - p->z;

        if (q != at) {
            offer(p, distance2, q, x * x + y * y + z * z);
        }
    }
    for (n = 0; n < NEIGHBOURS; n++) {
        p->weight[n] = 1.0 / sqrt(distance2[n] + TOL_NEIGHBOUR);
        sum += p->weight[n];
    }
    for (n = 0; n < NEIGHBOURS; n++) {
        p->weight[n] /= sum;
    }
}

/* Of channel k at a place, in units of `largest`. */
static double residual_at(const struct judge *j, const struct spot *p, size_t k, double largest)
{
    const size_t at = p->sample * j->samples->channels + k;

    return (j->samples->values[at] / largest - j->fitted[at] / largest) * p->factor;
}

static void foretell(struct judge *j, const struct spot *places, size_t count, size_t k, double largest)
{
    size_t i;
    int n;

    for (i = 0; i < count; i++) {
        const double r = residual_at(j, &places[i], k, largest);
        double foretold = 0.0;

        for (n = 0; n < NEIGHBOURS; n++) {
            foretold += places[i].weight[n] * residual_at(j, &places[places[i].near[n]], k, largest);
        }
        j->looked += r * r;
        j->missed += (r - foretold) * (r - foretold);
    }
}

/* The places and their neighbours; 0 where there are too few. */
static size_t look_around(const struct judge *j, struct spot *places)
{
    const int any = j->samples->form != BRDFFIT_FORM_COEFFICIENTS && j->used > NEIGHBOURS;
    const size_t count = any ? take_places(j, places) : 0;
    size_t i;

    for (i = 0; i < count; i++) {
        find_neighbours(places, count, i);
    }
    return count;
}

/* ---- The whole ----------------------------------------------------------- */

static unsigned verdict(const struct judge *j, const brdffit_options *options, const double total[3])
{
    unsigned found = 0;

    if (j->poor && options->norm != BRDFFIT_NORM_L1) {
        found |= BRDFFIT_MISFIT_POOR;
    }
    if (j->used >= TOL_PATTERN_SAMPLES && total[1] > TOL_PATTERN_RELATIVE && total[2] > TOL_PATTERN_FORESEEN) {
        found |= BRDFFIT_MISFIT_PATTERNED;
    }
    return found;
}

brdffit_status brdffit_quality_run(const brdffit_samples *samples, const brdffit_options *options, const double *fitted,
                                   double *r2, double total[3], unsigned *misfit, brdffit_error *error)
{
    struct judge j = {samples,
                      fitted,
                      brdffit_model_asked(options, 0),
                      brdffit_geometry_min_cosine(options->max_incidence),
                      0,
                      0.0,
                      0.0,
                      0.0,
                      0,
                      0.0,
                      0.0};
    struct spot places[LOOKED_AT];
    size_t used, count = 0, i, k;
    brdffit_status status = brdffit_inspect_run(samples, options, &used, NULL, 0, error);

    if (status != BRDFFIT_OK) {
        return status;
    }
    if (!fitted || !r2 || !total || !misfit) {
        return brdffit_fail(error, BRDFFIT_ERR_ARGUMENT, "fitted values and room for the answer are needed");
    }
    for (k = 0; k < samples->channels; k += BLOCK) {
        const size_t left = samples->channels - k, block = left < BLOCK ? left : BLOCK;
        struct channel c[BLOCK];

        add_block(&j, k, block, largest_weight(samples), c);
        count = k > 0 ? count : look_around(&j, places);
        for (i = 0; i < block; i++) {
            r2[k + i] = add_channel(&j, &c[i]);
            foretell(&j, places, count, k + i, (c[i].largest > 0.0 ? c[i].largest : 1.0) * c[i].unit);
        }
    }
    total[0] = j.spread > 0.0 ? 1.0 - j.residual / j.spread : j.residual > 0.0 ? -INFINITY : 1.0;
    total[1] = j.square > 0.0 ? sqrt(j.residual / j.square) : 0.0;
    total[2] = j.looked > 0.0 ? 1.0 - j.missed / j.looked : 0.0;
    *misfit = verdict(&j, options, total);
    return BRDFFIT_OK;
}
