/*
 * Angles of directions that cancel. SPDX-License-Identifier: MIT
 *
 * With L = |l|, V = |v|, N = |n| of the vectors as they are given (a power of two apart), every quantity is a quotient
 * whose numerator is a sum of products of doubles and of L and V, so that only those two roots are rounded before it:
 *
 *     n.l = (n.l) / (N L)            |n x h| = |(n x l) V + (n x v) L| / (N L V)      r.v = [2 (n.l)(n.v) - N^2 (l.v)] / (N^2 L V)
 *     n.h = [(n.l) V + (n.v) L] / (N L V)       1 - r.v = |r - v|^2 / 2 = [(n.l - n.v)^2 + |n x h|^2] / 2
 *
 * Dot products are exact but for their last bit (twofold_total), so that n.l and n.v have a relative error of 2^-100
 * however they cancel; the others have an absolute one of about 2^-98 (rounding.h says 1e-28).
 */
#include "base/twofold.h"
#include "base/vector.h"
#include "model/geometry.h"

/* The vector at about unit size, exactly: dividing by a power of two loses only what is 2^-1000 of the largest. */
static void at_unit_size(const double *v, double out[3])
{
    double largest = vector_largest(v, 3);
    int exponent = 0, j;

    (void)frexp(largest, &exponent);
    for (j = 0; j < 3; j++) {
        out[j] = ldexp(v[j], -exponent);
    }
}

static struct twofold dot(const double *u, const double *v)
{
    double term[6];
    int j;

    for (j = 0; j < 3; j++) {
        struct twofold product = twofold_of_product(u[j], v[j]);

        term[2 * j] = product.low;
        term[2 * j + 1] = product.high;
    }
    return twofold_total(term, 6);
}

/* Component j of u x v. */
static struct twofold cross(const double *u, const double *v, int j)
{
    int k = (j + 1) % 3, m = (j + 2) % 3;
    struct twofold plus = twofold_of_product(u[k], v[m]), minus = twofold_of_product(u[m], v[k]);
    double term[4] = {plus.low, -minus.low, plus.high, -minus.high};

    return twofold_total(term, 4);
}

static struct twofold square(struct twofold x)
{
    return twofold_multiply(x, x);
}

/* Mirror images about +z to the last bit, as the samples of a regular grid are: alpha = 0, and the cosines are fine. */
static int is_mirror_pair(const double *l, const double *v)
{
    return l[0] == -v[0] && l[1] == -v[1] && l[2] == v[2];
}

void brdffit_geometry_accurate(const double *light, const double *view, const double *normal,
                               struct geometry_angles *out)
{
    const struct twofold half = {0.5, 0.0}, two = {2.0, 0.0}, one = {1.0, 0.0};
    struct twofold L, V, N, nl, nv, all, light_part, view_part, tangential = {0.0, 0.0}, h2 = {0.0, 0.0}, root, off;
    double l[3], v[3], n[3] = {0.0, 0.0, 1.0};
    int j;

    out->accurate = 1;
    if (!normal && is_mirror_pair(light, view)) {
        out->tan2_half = out->off_mirror = 0.0;
        out->mirror = 1.0;
        return;
    }
    at_unit_size(light, l);
    at_unit_size(view, v);
    if (normal) {
        at_unit_size(normal, n);
    }
    L = twofold_root(dot(l, l));
    V = twofold_root(dot(v, v));
    N = normal ? twofold_root(dot(n, n)) : one;
    nl = dot(n, l);
    nv = dot(n, v);
    light_part = twofold_multiply(nl, V);
    view_part = twofold_multiply(nv, L);
    for (j = 0; j < 3; j++) {
        struct twofold x = twofold_multiply(cross(n, l, j), V), y = twofold_multiply(cross(n, v, j), L);
        struct twofold lj = {l[j], 0.0}, vj = {v[j], 0.0};

        tangential = twofold_add(tangential, square(twofold_add(x, y)));
        h2 = twofold_add(h2, square(twofold_add(twofold_multiply(lj, V), twofold_multiply(vj, L))));
    }
    all = twofold_multiply(twofold_multiply(N, L), V);
    out->cos_light = twofold_divide(nl, twofold_multiply(N, L)).high;
    out->cos_view = twofold_divide(nv, twofold_multiply(N, V)).high;
    root = twofold_divide(twofold_root(tangential), twofold_add(light_part, view_part));
    out->tan2_half = square(root).high;
    out->cos_difference = twofold_multiply(half, twofold_divide(twofold_root(h2), twofold_multiply(L, V))).high;
    off = twofold_add(square(twofold_subtract(light_part, view_part)), tangential);
    out->off_mirror = twofold_multiply(half, twofold_divide(off, square(all))).high;
    off = twofold_subtract(twofold_multiply(two, twofold_multiply(nl, nv)), twofold_multiply(square(N), dot(l, v)));
    out->mirror = twofold_divide(twofold_divide(off, twofold_multiply(square(N), L)), V).high;
}
