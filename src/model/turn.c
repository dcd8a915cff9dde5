/*
 * Where half vectors lie about the normal: see turn.h. SPDX-License-Identifier: MIT
 *
 * With b = n x t, of unit vectors up to a common factor, h.t = (n x h).b and h.b = -(n x h).t; for n = +z and t = +x these are
 * h_x and h_y themselves. Sums l + v of unit vectors have an absolute error of some u, so that phi_h has one of that over
 * tan alpha; it counts times c ~ tan^2 alpha only. Where the half vector is the normal, phi_h is anything and means nothing.
 */
#include "model/turn.h"

#include <math.h>

#include "base/degrees.h"
#include "base/tolerance.h"
#include "base/vector.h"
#include "model/lobe.h"

struct stretch brdffit_stretch_of(double anisotropy, double tangent_angle)
{
    struct stretch out = {1.0 / anisotropy, 1.0, 0.0};

    degrees_sincos(tangent_angle, &out.sine, &out.cosine);
    return out;
}

static void cross3(const double *u, const double *v, double *out)
{
    int j;

    for (j = 0; j < 3; j++) {
        int k = (j + 1) % 3, m = (j + 2) % 3;

        out[j] = u[k] * v[m] - u[m] * v[k];
    }
}

/* Components of h along the tangent and the bitangent of sample i, up to a factor. */
static int components(const brdffit_samples *s, size_t i, const double h[3], double out[2])
{
    double n[3] = {0.0, 0.0, 1.0}, t[3] = {1.0, 0.0, 0.0}, b[3], length, product[3];

    if (s->normal && !brdffit_geometry_unit(s->normal + 3 * i, n)) {
        return 0;
    }
    if (!s->tangent) {
        out[0] = h[0];
        out[1] = h[1];
        return n[0] == 0.0 && n[1] == 0.0 && n[2] > 0.0;
    }
    if (!brdffit_geometry_unit(s->tangent + 3 * i, t)) {
        return 0;
    }
    cross3(n, t, b);
    length = sqrt(dot3(b, b));
    if (!(length > 1e-6)) {
        return 0;
    }
    cross3(n, h, product);
    out[0] = dot3(product, b) / length;
    out[1] = dot3(h, b) / length;
    return 1;
}

int brdffit_turn_of(const brdffit_samples *s, size_t i, double turn[2])
{
    double l[3], v[3], h[3], length;
    int j;

    if (s->form != BRDFFIT_FORM_DIRECTIONS || !brdffit_geometry_unit(s->light + 3 * i, l) ||
        !brdffit_geometry_unit(s->view + 3 * i, v)) {
        return 0;
    }
    for (j = 0; j < 3; j++) {
        h[j] = l[j] + v[j];
    }
    if (!components(s, i, h, turn)) {
        return 0;
    }
    length = sqrt(turn[0] * turn[0] + turn[1] * turn[1]);
    if (!(length > 0.0)) {
        turn[0] = 1.0;
        turn[1] = 0.0;
        return 1;
    }
    turn[0] /= length;
    turn[1] /= length;
    return 1;
}

/* cos^2 and sin^2 of phi_h from the lobe's own tangent. */
static void shares(const struct stretch *stretch, const double turn[2], double share[2])
{
    double along = turn[0] * stretch->cosine + turn[1] * stretch->sine;
    double across = turn[1] * stretch->cosine - turn[0] * stretch->sine;

    share[0] = along * along;
    share[1] = across * across;
}

/* Absolute error of c times a share. */
static double share_error(const struct geometry *g)
{
    double tangent = sqrt(g->angles.tan2_half);
    double turned = tangent > 0.0 ? smaller(1.0, (g->angles.tangent_error + 8.0 * TOL_UNIT) / tangent) : 0.0;

    return g->c_error + (4.0 * turned + 16.0 * TOL_UNIT) * g->c;
}

void brdffit_turn_stretch(const struct stretch *stretch, const double turn[2], struct geometry *g)
{
    double share[2], error = share_error(g);

    shares(stretch, turn, share);
    g->c_error = larger(stretch->ratio, 1.0 / stretch->ratio) * error;
    g->c *= share[0] * stretch->ratio + share[1] / stretch->ratio;
}

void brdffit_turn_split(const struct stretch *stretch, const double turn[2], struct geometry *g, double c[2])
{
    double share[2];
    int d;

    g->c_error = 2.0 * share_error(g);
    shares(stretch, turn, share);
    for (d = 0; d < 2; d++) {
        c[d] = g->c * share[d];
    }
}

void brdffit_turned_shape(const struct kernels *kernels, const struct lobe_kind *kind, const struct lobe_sight *sight,
                          size_t n, const double s[2], double *exponent, double *phi)
{
    size_t j;

    for (j = 0; j < n; j++) {
        exponent[j] = sight->light[j] * s[0] + sight->view[j] * s[1];
    }
    if (kind->exponential) {
        kernels->exponential_shape(exponent, n, 1.0, phi);
    } else {
        kernels->ggx_shape(exponent, n, 1.0, phi);
    }
}

double brdffit_turn_lambda(const struct lobe_kind *kind, double ratio, double s)
{
    return kind->by_exponent ? sqrt((s * ratio + 1.0) * (s / ratio + 1.0)) / (s + 1.0) : 1.0;
}

int brdffit_turn_known(brdffit_distribution distribution)
{
    return distribution == BRDFFIT_BECKMANN || distribution == BRDFFIT_GGX || distribution == BRDFFIT_WARD ||
           distribution == BRDFFIT_ASHIKHMIN_SHIRLEY;
}
