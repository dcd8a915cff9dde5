/*
 * Supports one by one: a part of gain_n.h, which includes it twice. Where GAIN_UNROLL unrolls the loops over columns and
 * supports, n is a constant, and which members a support has is known to the compiler. SPDX-License-Identifier: MIT
 */
/* The row of support s, whose last column is j; m[i]: cosines of the columns i < j with j. */
LANES_INLINE void GAIN_NAME(row)(struct gram_n *g, unsigned s, unsigned j, const vec *m, const unsigned n)
{
    const vec zero = vec_set(0.0), one = vec_set(1.0);
    vec w[GAIN_COLUMNS] = {{0.0}}, d = one, definite = one;
    unsigned i, k;

    GAIN_UNROLL
    for (i = 0; i < n; i++) {
        unsigned own = gain_up_to(s, i);
        vec v;

        if (i >= j || !(s >> i & 1)) {
            continue;
        }
        v = m[i];
        GAIN_UNROLL
        for (k = 0; k < n; k++) {
            if (k < i && s >> k & 1) {
                v -= g->lower[own][k] * w[k];
            }
        }
        w[i] = v;
        v *= g->inverse[own];
        d -= w[i] * v;
        g->lower[s][i] = v;
        definite = g->inverse[own]; /* of the last of them: the support without j */
    }
    g->inverse[s] = (vec)(((d > zero) & (definite > zero)) & (vec_mask)(one / d));
}

/* Off-diagonals in the order 01, 02, .., 12, ..; clipped from above. */
LANES_INLINE void GAIN_NAME(rows)(struct gram_n *g, const vec *cosine, const unsigned n)
{
    vec column[GAIN_COLUMNS][GAIN_COLUMNS]; /* [j][i], i < j */
    unsigned i, j, s, e = 0;

    GAIN_UNROLL
    for (i = 0; i < n; i++) {
        GAIN_UNROLL
        for (j = i + 1; j < n; j++) {
            column[j][i] = gain_clip(cosine[e++]);
        }
    }
    GAIN_UNROLL
    for (s = 1; s < 1u << n; s++) {
        GAIN_NAME(row)(g, s, gain_last(s), column[gain_last(s)], n);
    }
}

/* Whether z = M_s^-1 t is > 0, from y of every support. */
LANES_INLINE vec_mask GAIN_NAME(feasible)(const struct gram_n *g, const vec *y, unsigned s, const unsigned n)
{
    const vec zero = vec_set(0.0);
    vec_mask positive = zero == zero;
    vec z[GAIN_COLUMNS] = {{0.0}};
    unsigned at, k;

    GAIN_UNROLL
    for (at = 0; at < n; at++) {
        unsigned i = n - 1 - at, own = gain_up_to(s, i);
        vec v;

        if (!(s >> i & 1)) {
            continue;
        }
        v = y[own] * g->inverse[own];
        GAIN_UNROLL
        for (k = 0; k < n; k++) {
            if (k > i && s >> k & 1) {
                v -= g->lower[gain_up_to(s, k)][i] * z[k];
            }
        }
        z[i] = v;
        positive &= v > zero;
    }
    return positive;
}

/* y of support s and its stationary value, from those of its rest. */
LANES_INLINE void GAIN_NAME(step)(const struct gram_n *g, const vec *t, unsigned s, vec *y, vec *value,
                                  const unsigned n)
{
    unsigned j = gain_last(s), i;
    vec v = t[j];

    GAIN_UNROLL
    for (i = 0; i < n; i++) {
        if (i < j && s >> i & 1) {
            v -= g->lower[s][i] * y[gain_up_to(s, i)];
        }
    }
    y[s] = v;
    value[s] = value[s & ~(1u << j)] + v * v * g->inverse[s];
}

/* R for n columns: all of them first, which is the answer where their z > 0, and needs the supports of the first 1, 2, .. */
LANES_INLINE vec GAIN_NAME(best)(const struct gram_n *g, const vec *t, const unsigned n)
{
    const unsigned full = (1u << n) - 1;
    vec y[GAIN_SUPPORTS], value[GAIN_SUPPORTS], best = vec_set(0.0);
    vec_mask open;
    unsigned s, i;

    value[0] = best;
    GAIN_UNROLL
    for (i = 0; i < n; i++) {
        GAIN_NAME(step)(g, t, (2u << i) - 1, y, value, n);
    }
    open = ~(GAIN_NAME(feasible)(g, y, full, n) & (g->inverse[full] > best));
    best = vec_select(open, best, value[full]);
    if (!vec_any(open)) {
        return best;
    }
    GAIN_UNROLL
    for (s = 1; s < full; s++) {
        if (s & (s + 1)) {
            GAIN_NAME(step)(g, t, s, y, value, n);
        }
    }
    GAIN_UNROLL
    for (i = 1; i < full; i++) {
        vec_mask better;

        s = full - i;
        better = open & (value[s] > best) & (g->inverse[s] > vec_set(0.0));
        if (vec_any(better)) {
            best = vec_select(better & GAIN_NAME(feasible)(g, y, s, n), value[s], best);
        }
    }
    return best;
}

#undef GAIN_NAME
#undef GAIN_UNROLL
