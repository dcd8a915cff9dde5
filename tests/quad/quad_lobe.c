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
    case BRDFFIT_RETRO:
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

/* F = (1 - t)^5 of Schlick; below 1e-100 it counts as 0 (brdffit.h). */
static quad schlick(quad versine)
{
    return versine < 1e-20 ? 0 : powq(versine, 5);
}

void quad_coefficients(brdffit_distribution distribution, brdffit_masking masking, const struct quad_angles *at,
                       struct quad_row *row)
{
    quad pi = quad_pi(), angle, over_cos2 = 1 + at->tan2;
    quad shared = masking == BRDFFIT_MASKING_V_CAVITY ? shadowing(at) : 1;

    row->light = at->tan2_light;
    row->view = at->tan2_view;
    row->w = schlick(at->versine);
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
    case BRDFFIT_RETRO:
        row->b = at->nl;
        row->c = 4 * at->versine * (1 + at->vh);
        return;
    case BRDFFIT_BECKMANN:
    case BRDFFIT_GGX:
        row->b = shared / (pi * at->nv) * over_cos2 * over_cos2;
        row->c = at->tan2;
        return;
    case BRDFFIT_DISTRIBUTION_COUNT: break;
    }
    row->b = row->c = nanq("");
}

void quad_diffuse(brdffit_diffuse diffuse, const struct quad_angles *at, quad *column)
{
    quad a = at->nl / quad_pi(), cosine, sines, larger, light, view, d2;

    column[0] = diffuse == BRDFFIT_DIFFUSE_NONE ? 0 : a;
    if (diffuse == BRDFFIT_DIFFUSE_OREN_NAYAR) {
        /* cos(difference of azimuths) sin(a) tan(b): the projections' product over the larger cosine. */
        sines = at->lv - at->nl * at->nv;
        larger = fmaxq(at->nl, at->nv);
        cosine = sines / larger;
        column[1] = cosine < 1e-12 ? 0 : a * cosine; /* brdffit.h */
    } else if (diffuse == BRDFFIT_DIFFUSE_BURLEY) {
        light = schlick(at->tan2_light * at->nl * at->nl / (1 + at->nl)); /* 1 - cos = sin^2 / (1 + cos) */
        view = schlick(at->tan2_view * at->nv * at->nv / (1 + at->nv));
        d2 = at->vh * at->vh;
        column[0] = a * (1 - light / 2) * (1 - view / 2);
        column[1] = a * 2 * d2 * (light + view - light * view);
        column[2] = a * 4 * d2 * d2 * light * view;
    }
}

/* Lambda of Smith's masking, tan^2 of the angle: Walter et al. 2007 (Beckmann's with erf), Heitz 2014. */
static quad lambda_of_angle(brdffit_distribution distribution, quad s, quad tan2)
{
    quad root_pi = sqrtq(quad_pi()), a;

    if (!(tan2 > 0)) {
        return 0;
    }
    if (distribution == BRDFFIT_GGX) {
        return (sqrtq(1 + tan2 / s) - 1) / 2;
    }
    a = sqrtq(s / tan2); /* 1 / (sigma tan) */
    return (expq(-a * a) / (a * root_pi) - erfcq(a)) / 2;
}

quad quad_lobe_shape(const struct quad_lobe *lobe, quad s, size_t i)
{
    quad shape = quad_shape(lobe->distribution, s, lobe->c[i], lobe->c_min), light, view;

    if (lobe->masking != BRDFFIT_MASKING_SMITH && lobe->masking != BRDFFIT_MASKING_SMITH_SEPARABLE) {
        return shape;
    }
    light = lambda_of_angle(lobe->distribution, s, lobe->light[i]);
    view = lambda_of_angle(lobe->distribution, s, lobe->view[i]);
    return lobe->masking == BRDFFIT_MASKING_SMITH ? shape / (1 + light + view) : shape / ((1 + light) * (1 + view));
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
    case BRDFFIT_RETRO: return s / pi;
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
    case BRDFFIT_LAFORTUNE:
    case BRDFFIT_RETRO: return expq(-(c - c_min) * s);
    case BRDFFIT_DISTRIBUTION_COUNT: break;
    }
    return nanq("");
}
