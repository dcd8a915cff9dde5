/*
 * Rows of geometry: see geometry_rows.h; theory section 1's table, its column b, and brdffit.h for the sources.
 * Layer 2. SPDX-License-Identifier: MIT
 *
 * Near the mirror direction c ~ alpha^2 decides about narrow lobes, and every digit of it counts. So each c comes
 * from tan^2 alpha, which geometry.c has to full relative accuracy there, and never from a cosine near 1:
 *
 *     alpha^2        = atan(sqrt(tan^2 alpha))^2
 *     -ln cos alpha  = ln(1 + tan^2 alpha) / 2
 *     1 - r.v        = [ (n.l - n.v)^2 + tan^2 alpha (n.l + n.v)^2 ] / 2
 *
 * The last, with r = 2 (n.l) n - l the mirrored light: r.v = 2 (n.l)(n.v) - l.v, and with h = l + v
 * 1 + l.v = |h|^2 / 2 = [ (n.h)^2 + |n x h|^2 ] / 2, n.h = n.l + n.v, |n x h|^2 = tan^2 alpha (n.h)^2.
 */
#include "geometry_rows.h"

#include <math.h>

#include "kernel_atan.h"
#include "kernel_log1p.h"
#include "tolerance.h"
#include "vector.h"

#define PI 3.14159265358979323846

static double cos2_half(const struct geometry_angles *g)
{
    return 1.0 / (1.0 + g->tan2_half);
}

/* G = min{1, 2 (n.h)(n.v) / (v.h), 2 (n.h)(n.l) / (v.h)} */
static double shadowing(const struct geometry_angles *g)
{
    double shared = 2.0 * sqrt(cos2_half(g)) / g->cos_difference;

    return smaller(1.0, shared * smaller(g->cos_view, g->cos_light));
}

/* Beckmann, and GGX in the same geometry (theory 4.4). */
static void cook_torrance(const struct geometry_angles *g, struct geometry *out)
{
    double cos2 = cos2_half(g);

    out->b = shadowing(g) / (PI * g->cos_view * cos2 * cos2);
    out->c = g->tan2_half;
}

static void torrance_sparrow(const struct geometry_angles *g, struct geometry *out)
{
    double alpha = kernel_atan(sqrt(g->tan2_half));

    out->b = shadowing(g) / (PI * g->cos_view);
    out->c = alpha * alpha;
}

static void ward(const struct geometry_angles *g, struct geometry *out)
{
    out->b = sqrt(g->cos_light / g->cos_view) / (4.0 * PI);
    out->c = g->tan2_half;
}

static void blinn_phong(const struct geometry_angles *g, struct geometry *out)
{
    out->b = g->cos_light;
    out->c = 0.5 * kernel_log1p(g->tan2_half);
}

static void ashikhmin_shirley(const struct geometry_angles *g, struct geometry *out)
{
    out->b = g->cos_light / (g->cos_difference * larger(g->cos_light, g->cos_view));
    out->c = 0.5 * kernel_log1p(g->tan2_half);
}

/* Viewers more than 90 degrees off the mirror direction see no lobe. */
static void lafortune(const struct geometry_angles *g, struct geometry *out)
{
    double difference = g->cos_light - g->cos_view, sum = g->cos_light + g->cos_view, q;

    if (fabs(difference) <= TOL_ANGLE) {
        difference = 0.0; /* roundings of the two cosines; a mirror pair is one, and c = 0 there */
    }
    q = 0.5 * (difference * difference + g->tan2_half * (sum * sum));
    out->b = q < 1.0 ? g->cos_light : 0.0;
    out->c = q < 1.0 ? -kernel_log1p(-q) : 0.0;
}

void brdffit_geometry_row(brdffit_distribution distribution, const struct geometry_angles *angles, struct geometry *out)
{
    static void (*const row[BRDFFIT_DISTRIBUTION_COUNT])(const struct geometry_angles *, struct geometry *) = {
        [BRDFFIT_BECKMANN] = cook_torrance,
        [BRDFFIT_GGX] = cook_torrance,
        [BRDFFIT_TORRANCE_SPARROW] = torrance_sparrow,
        [BRDFFIT_WARD] = ward,
        [BRDFFIT_BLINN_PHONG] = blinn_phong,
        [BRDFFIT_ASHIKHMIN_SHIRLEY] = ashikhmin_shirley,
        [BRDFFIT_LAFORTUNE] = lafortune,
    };

    out->a = angles->cos_light / PI;
    out->cos_light = angles->cos_light;
    row[distribution](angles, out);
}

int brdffit_geometry_strip(brdffit_distribution distribution, double tan2_half, struct geometry_strip *out)
{
    struct geometry_angles angles = {1.0, 1.0, tan2_half, 1.0};
    struct geometry row;
    double cos2 = cos2_half(&angles);

    brdffit_geometry_row(distribution, &angles, &row);
    out->c = row.c;
    out->kind = STRIP_SHADOWED;
    out->shared = 2.0 * sqrt(cos2);
    switch (distribution) {
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX: out->factor = 1.0 / (PI * (cos2 * cos2)); return 1;
    case BRDFFIT_TORRANCE_SPARROW: out->factor = 1.0 / PI; return 1;
    case BRDFFIT_WARD:
        out->kind = STRIP_ROOT;
        out->factor = 1.0 / (4.0 * PI);
        return 1;
    case BRDFFIT_BLINN_PHONG:
        out->kind = STRIP_LIGHT;
        out->factor = 1.0;
        return 1;
    case BRDFFIT_ASHIKHMIN_SHIRLEY:
        out->kind = STRIP_SIDE;
        out->factor = 1.0;
        out->shared = 1.0;
        return 1;
    default: return 0;
    }
}
