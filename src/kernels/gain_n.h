/*
 * The gain R(t, M) of any number of columns in lanes (theory 2, 7.5); gain.h has the closed forms for two and three.
 * SPDX-License-Identifier: MIT
 *
 * Let every leading block of M be definite, which L D L' of the whole tells (all d > 0). Then 2 t.z - z'M z is concave,
 * and any z >= 0 with r = t - M z gives
 *
 *     R  <=  2 t.z - z'M z  +  2 sum_j max(r_j, 0) max(t_j, 0)  +  2 sum_j max(-r_j, 0) z_j,
 *
 * since no maximum has w_j > t_j (M >= 0 with a unit diagonal). At the optimum on its own support both sums are zero to
 * rounding, so a support whose z is > 0 and whose multipliers M z - t are >= 0 elsewhere is the answer, whatever way it
 * was found. Supports are tried by block pivoting, all lanes at a time: start with every column; then those that came
 * out negative go, and those whose multiplier is negative come. Lanes that do not settle, and those whose M is not
 * definite, are settled by trying every support, which is exact for any M (gain.h).
 *
 * Rounding: L D L' is backward stable, with an error of n^2 u in M at most, and z <= |t|.
 */
#ifndef BRDFFIT_GAIN_N_H
#define BRDFFIT_GAIN_N_H

#include "kernels/gain.h"

/* Most columns. */
#define GAIN_COLUMNS 7

/* Rounds of block pivoting. */
#define GAIN_ROUNDS 6

/* A multiplier above minus this part of the largest |t| counts as >= 0: it costs 2 of it at most. */
#define GAIN_LEAST (8.0 * TOL_UNIT)

struct gram_n {
    vec cosine[GAIN_COLUMNS][GAIN_COLUMNS]; /* [i][j], i < j */
    vec lower[GAIN_COLUMNS][GAIN_COLUMNS];  /* L: [i][j], i > j */
    vec d[GAIN_COLUMNS];                    /* D; 1 where it is not definite */
    vec_mask definite;
};

/* L D L' of the unit matrix with the off-diagonals whose two columns are both `in`. */
LANES_INLINE void gain_n_factor(struct gram_n *g, const vec_mask *in, const unsigned n)
{
    const vec zero = vec_set(0.0), one = vec_set(1.0);
    unsigned i, j, k;

    g->definite = zero == zero;
#pragma GCC unroll 7
    for (j = 0; j < n; j++) {
        vec d = one, inverse;

#pragma GCC unroll 7
        for (k = 0; k < j; k++) {
            d -= g->lower[j][k] * g->lower[j][k] * g->d[k];
        }
        g->definite &= d > zero;
        g->d[j] = vec_select(d > zero, d, one);
        inverse = one / g->d[j];
#pragma GCC unroll 7
        for (i = j + 1; i < n; i++) {
            vec v = in ? (vec)((vec_mask)g->cosine[j][i] & in[i] & in[j]) : g->cosine[j][i];

#pragma GCC unroll 7
            for (k = 0; k < j; k++) {
                v -= g->lower[i][k] * g->lower[j][k] * g->d[k];
            }
            g->lower[i][j] = v * inverse;
        }
    }
}

/* Off-diagonals in the order 01, 02, .., 12, ..; clipped from above. */
LANES_INLINE void gram_n_make(struct gram_n *g, const vec *cosine, const unsigned n)
{
    unsigned i, j, e = 0;

#pragma GCC unroll 7
    for (i = 0; i < n; i++) {
#pragma GCC unroll 7
        for (j = i + 1; j < n; j++) {
            g->cosine[i][j] = gain_clip(cosine[e++]);
        }
    }
    gain_n_factor(g, NULL, n);
}

/* z = M^-1 t by the factorisation. */
LANES_INLINE void gain_n_solve(const struct gram_n *g, const vec *t, vec *z, const unsigned n)
{
    unsigned i, k;

#pragma GCC unroll 7
    for (i = 0; i < n; i++) {
        z[i] = t[i];
#pragma GCC unroll 7
        for (k = 0; k < i; k++) {
            z[i] -= g->lower[i][k] * z[k];
        }
    }
#pragma GCC unroll 7
    for (i = n; i-- > 0;) {
        z[i] = z[i] / g->d[i];
#pragma GCC unroll 7
        for (k = i + 1; k < n; k++) {
            z[i] -= g->lower[k][i] * z[k];
        }
    }
}

/* 2 t.z - z'M z: an error of z enters only squared. */
LANES_INLINE vec gain_n_value(const struct gram_n *g, const vec *t, const vec *z, const unsigned n)
{
    vec value = vec_set(0.0);
    unsigned i, k;

#pragma GCC unroll 7
    for (i = 0; i < n; i++) {
        vec row = 2.0 * t[i] - z[i];

#pragma GCC unroll 7
        for (k = i + 1; k < n; k++) {
            row -= 2.0 * g->cosine[i][k] * z[k];
        }
        value += z[i] * row;
    }
    return value;
}

/* (M z - t)_j */
LANES_INLINE vec gain_n_multiplier(const struct gram_n *g, const vec *t, const vec *z, unsigned j, const unsigned n)
{
    vec sum = z[j] - t[j];
    unsigned i;

#pragma GCC unroll 7
    for (i = 0; i < n; i++) {
        if (i != j) {
            sum += (i < j ? g->cosine[i][j] : g->cosine[j][i]) * z[i];
        }
    }
    return sum;
}

/* Every support of one lane's problem; exact to rounding for any M with off-diagonals in [0, 1). */
static double gain_n_enumerate(double cosine[GAIN_COLUMNS][GAIN_COLUMNS], const double *t, unsigned n)
{
    double best = 0.0;
    unsigned bits, i, j, k;

    for (bits = 1; bits < 1u << n; bits++) {
        double lower[GAIN_COLUMNS][GAIN_COLUMNS], d[GAIN_COLUMNS], z[GAIN_COLUMNS], value = 0.0;
        unsigned index[GAIN_COLUMNS], m = 0;
        int feasible = 1;

        for (j = 0; j < n; j++) {
            if (bits >> j & 1) {
                index[m++] = j;
            }
        }
        for (j = 0; j < m && feasible; j++) {
            d[j] = 1.0;
            for (k = 0; k < j; k++) {
                d[j] -= lower[j][k] * lower[j][k] * d[k];
            }
            feasible = d[j] > 0.0;
            for (i = j + 1; i < m && feasible; i++) {
                lower[i][j] = cosine[index[j]][index[i]];
                for (k = 0; k < j; k++) {
                    lower[i][j] -= lower[i][k] * lower[j][k] * d[k];
                }
                lower[i][j] /= d[j];
            }
            z[j] = t[index[j]];
            for (k = 0; k < j && feasible; k++) {
                z[j] -= lower[j][k] * z[k];
            }
        }
        for (j = m; j-- > 0 && feasible;) {
            z[j] /= d[j];
            for (k = j + 1; k < m; k++) {
                z[j] -= lower[k][j] * z[k];
            }
            feasible = z[j] > 0.0;
        }
        for (i = 0; i < m && feasible; i++) {
            double row = 2.0 * t[index[i]] - z[i];

            for (k = i + 1; k < m; k++) {
                row -= 2.0 * cosine[index[i]][index[k]] * z[k];
            }
            value += z[i] * row;
        }
        best = feasible && value > best ? value : best;
    }
    return best;
}

/* Lanes of `open` by enumeration; the others keep `value`. */
LANES_INLINE vec gain_n_exactly(const struct gram_n *g, const vec *t, vec value, vec_mask open, const unsigned n)
{
    double out[VEC];
    size_t lane;

    vec_store(out, value);
    for (lane = 0; lane < VEC; lane++) {
        double cosine[GAIN_COLUMNS][GAIN_COLUMNS], one[GAIN_COLUMNS];
        unsigned i, j;

        if (!open[lane]) {
            continue;
        }
        for (i = 0; i < n; i++) {
            one[i] = t[i][lane];
            for (j = i + 1; j < n; j++) {
                cosine[i][j] = g->cosine[i][j][lane];
            }
        }
        out[lane] = gain_n_enumerate(cosine, one, n);
    }
    return vec_load(out);
}

LANES_INLINE int vec_any(vec_mask mask)
{
    int64_t any = 0;
    size_t lane;

    for (lane = 0; lane < VEC; lane++) {
        any |= mask[lane];
    }
    return any != 0;
}

/* Block pivoting of the lanes in `open`, from the supports `in`. */
LANES_INLINE vec gain_n_pivot(const struct gram_n *g, const vec *t, vec value, vec_mask open, vec_mask *in,
                              const unsigned n)
{
    const vec zero = vec_set(0.0);
    vec least = zero;
    unsigned round, j;

    for (j = 0; j < n; j++) {
        least = vec_max(vec_abs(t[j]), least);
    }
    least *= -GAIN_LEAST;
    for (round = 0; round < GAIN_ROUNDS && vec_any(open); round++) {
        struct gram_n some = *g;
        vec inside[GAIN_COLUMNS], z[GAIN_COLUMNS];
        vec_mask wrong = zero != zero;

        gain_n_factor(&some, in, n);
        wrong |= ~some.definite; /* to rounding: M is, but not this part of it, and z means nothing */
        for (j = 0; j < n; j++) {
            inside[j] = (vec)((vec_mask)t[j] & in[j]);
        }
        gain_n_solve(&some, inside, z, n);
        for (j = 0; j < n; j++) {
            z[j] = (vec)((vec_mask)z[j] & in[j]);
        }
        for (j = 0; j < n; j++) {
            vec_mask out = in[j] & ~(z[j] > zero), come = ~in[j] & (gain_n_multiplier(g, t, z, j, n) < least);

            in[j] = (in[j] & ~out) | come;
            wrong |= out | come;
        }
        value = vec_select(open & ~wrong, gain_n_value(g, t, z, n), value);
        open &= wrong;
    }
    return vec_any(open) ? gain_n_exactly(g, t, value, open, n) : value;
}

/* R for n columns. */
LANES_INLINE vec gain_n_vec(const struct gram_n *g, const vec *t, const unsigned n)
{
    const vec zero = vec_set(0.0);
    vec z[GAIN_COLUMNS], value;
    vec_mask in[GAIN_COLUMNS], open = ~g->definite;
    unsigned j;

    gain_n_solve(g, t, z, n);
    for (j = 0; j < n; j++) {
        in[j] = z[j] > zero;
        open |= ~in[j];
    }
    value = gain_n_value(g, t, z, n);
    if (!vec_any(open)) {
        return value;
    }
    if (vec_any(open & ~g->definite)) {
        value = gain_n_exactly(g, t, value, open & ~g->definite, n);
        open &= g->definite;
    }
    return gain_n_pivot(g, t, value, open, in, n);
}

#endif
