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

/* Terms of u.v, exactly, and their sum; `passes` of twofold_total: 1 for squares, where nothing cancels. */
static struct twofold dot(const double *u, const double *v, int passes)
{
    double term[6];
    int j;

    for (j = 0; j < 3; j++) {
        struct twofold product = twofold_of_product(u[j], v[j]);

        term[2 * j] = product.low;
        term[2 * j + 1] = product.high;
    }
    return twofold_total(term, 6, passes);
}

/* Component j of u x v: absolute errors of 2^-104 are fine. */
static struct twofold cross(const double *u, const double *v, int j)
{
    int k = (j + 1) % 3, m = (j + 2) % 3;
    struct twofold plus = twofold_of_product(u[k], v[m]), minus = twofold_of_product(u[m], v[k]);

    return twofold_subtract(plus, minus);
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

/* The vectors and what is made of them. */
struct trio {
    double l[3], v[3], n[3];
    int general; /* n is not +z */
    struct twofold L, V, N, nl, nv;
};

static void open_trio(struct trio *t, const double *light, const double *view, const double *normal)
{
    static const struct twofold one = {1.0, 0.0};

    at_unit_size(light, t->l);
    at_unit_size(view, t->v);
    t->L = twofold_root(dot(t->l, t->l, 1));
    t->V = twofold_root(dot(t->v, t->v, 1));
    t->N = one;
    t->n[0] = t->n[1] = t->nl.low = t->nv.low = 0.0;
    t->n[2] = 1.0;
    t->nl.high = t->l[2];
    t->nv.high = t->v[2];
    t->general = normal != NULL;
    if (normal) {
        at_unit_size(normal, t->n);
        t->N = twofold_root(dot(t->n, t->n, 1));
        t->nl = dot(t->n, t->l, 4);
        t->nv = dot(t->n, t->v, 4);
    }
}

/* Component j of n x w. */
static struct twofold across(const struct trio *t, const double *w, int j)
{
    const struct twofold upright = {j == 0 ? -w[1] : j == 1 ? w[0] : 0.0, 0.0};

    return t->general ? cross(t->n, w, j) : upright;
}

static void mirror_of(const struct trio *t, struct twofold difference, struct twofold tangential,
                      struct geometry_angles *out)
{
    struct twofold off = twofold_add(square(difference), tangential), N2 = square(t->N), value;
    struct twofold all = twofold_multiply(twofold_multiply(t->N, t->L), t->V), product = twofold_multiply(t->nl, t->nv);

    out->off_mirror = 0.5 * twofold_divide(off, square(all)).high;
    product.high *= 2.0;
    product.low *= 2.0;
    value = twofold_subtract(product, twofold_multiply(N2, dot(t->l, t->v, 2)));
    out->mirror = twofold_divide(twofold_divide(value, twofold_multiply(N2, t->L)), t->V).high;
}

void brdffit_geometry_accurate(const double *light, const double *view, const double *normal, int mirrored,
                               struct geometry_angles *out)
{
    struct twofold light_part, view_part, tangential = {0.0, 0.0}, h2 = {0.0, 0.0}, root;
    struct trio t;
    int j;

    out->accurate = 1;
    out->off_mirror = 0.0;
    out->mirror = 1.0;
    if (!normal && is_mirror_pair(light, view)) {
        out->tan2_half = 0.0;
        return;
    }
    open_trio(&t, light, view, normal);
    light_part = twofold_multiply(t.nl, t.V);
    view_part = twofold_multiply(t.nv, t.L);
    for (j = 0; j < 3; j++) {
        struct twofold x = twofold_multiply(across(&t, t.l, j), t.V), y = twofold_multiply(across(&t, t.v, j), t.L);
        struct twofold lj = {t.l[j], 0.0}, vj = {t.v[j], 0.0};

        tangential = twofold_add(tangential, square(twofold_add(x, y)));
        h2 = twofold_add(h2, square(twofold_add(twofold_multiply(lj, t.V), twofold_multiply(vj, t.L))));
    }
    out->cos_light = twofold_divide(t.nl, twofold_multiply(t.N, t.L)).high;
    out->cos_view = twofold_divide(t.nv, twofold_multiply(t.N, t.V)).high;
    root = twofold_divide(twofold_root(tangential), twofold_add(light_part, view_part));
    out->tan2_half = square(root).high;
    out->cos_difference = 0.5 * twofold_divide(twofold_root(h2), twofold_multiply(t.L, t.V)).high;
    if (mirrored) {
        mirror_of(&t, twofold_subtract(light_part, view_part), tangential, out);
    }
}
