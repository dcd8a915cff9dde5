/*
 * The table of distributions of brdffit.h, row by row. SPDX-License-Identifier: MIT
 */
#include "quad.h"

/* The sum of three doubles: no literal of this type is ISO C. */
static quad quad_pi(void)
{
    return (quad)0x1.921fb54442d18p+1 + (quad)0x1.1a62633145c07p-53 + (quad)-0x1.f1976b7ed8fbcp-109;
}

int quad_by_exponent(brdffit_distribution distribution)
{
    switch (distribution) { /* no default: the compiler names a distribution that is missing */
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX:
    case BRDFFIT_TORRANCE_SPARROW:
    case BRDFFIT_WARD:
    case BRDFFIT_DISTRIBUTION_COUNT: return 0;
    case BRDFFIT_BLINN_PHONG:
    case BRDFFIT_ASHIKHMIN_SHIRLEY:
    case BRDFFIT_LAFORTUNE: return 1;
    }
    return 0;
}

quad quad_s(double sigma)
{
    return 1 / ((quad)sigma * sigma);
}

/* G: (n.h) is cos alpha. */
static quad shadowing(const struct quad_angles *at)
{
    quad shared = 2 / (sqrtq(1 + at->tan2) * at->vh);

    return fminq(1, fminq(shared * at->nv, shared * at->nl));
}

void quad_coefficients(brdffit_distribution distribution, const struct quad_angles *at, struct quad_row *row)
{
    quad pi = quad_pi(), angle, over_cos2 = 1 + at->tan2;

    row->a = at->nl / pi;
    switch (distribution) {
    case BRDFFIT_TORRANCE_SPARROW:
        angle = atanq(sqrtq(at->tan2));
        row->b = shadowing(at) / (pi * at->nv);
        row->c = angle * angle;
        return;
    case BRDFFIT_WARD:
        row->b = sqrtq(at->nl / at->nv) / (4 * pi);
        row->c = at->tan2;
        return;
    case BRDFFIT_BLINN_PHONG:
        row->b = at->nl;
        row->c = log1pq(at->tan2) / 2;
        return;
    case BRDFFIT_ASHIKHMIN_SHIRLEY:
        row->b = at->nl / (at->vh * fmaxq(at->nl, at->nv));
        row->c = log1pq(at->tan2) / 2;
        return;
    case BRDFFIT_LAFORTUNE:
        row->b = at->rv > 0 ? at->nl : 0;
        row->c = !(at->rv > 0) ? 0 : at->off < 0.5 ? -log1pq(-at->off) : -logq(at->rv);
        return;
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX:
        row->b = shadowing(at) / (pi * at->nv) * over_cos2 * over_cos2;
        row->c = at->tan2;
        return;
    case BRDFFIT_DISTRIBUTION_COUNT: break;
    }
    row->b = row->c = nanq("");
}

quad quad_lambda(brdffit_distribution distribution, quad s)
{
    const quad pi = quad_pi();

    switch (distribution) {
    case BRDFFIT_TORRANCE_SPARROW: return 1;
    case BRDFFIT_BLINN_PHONG:
    case BRDFFIT_LAFORTUNE: return (s + 2) / (2 * pi);
    case BRDFFIT_ASHIKHMIN_SHIRLEY: return (s + 1) / (8 * pi);
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX:
    case BRDFFIT_WARD: return s;
    case BRDFFIT_DISTRIBUTION_COUNT: break;
    }
    return nanq("");
}

quad quad_shape(brdffit_distribution distribution, quad s, quad c, quad c_min)
{
    quad ratio;

    switch (distribution) {
    case BRDFFIT_GGX: ratio = (1 + c_min * s) / (1 + c * s); return ratio * ratio;
    case BRDFFIT_BECKMANN:
    case BRDFFIT_TORRANCE_SPARROW:
    case BRDFFIT_WARD:
    case BRDFFIT_BLINN_PHONG:
    case BRDFFIT_ASHIKHMIN_SHIRLEY:
    case BRDFFIT_LAFORTUNE: return expq(-(c - c_min) * s);
    case BRDFFIT_DISTRIBUTION_COUNT: break;
    }
    return nanq("");
}
