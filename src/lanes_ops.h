/*
 * Operations on one vector type: included by lanes.h, once for each of its two. No include guard. Layer 0.
 * SPDX-License-Identifier: MIT
 */
typedef double OPS_TYPE __attribute__((vector_size(8 * OPS_COUNT)));
typedef int64_t OPS_MASK __attribute__((vector_size(8 * OPS_COUNT)));
typedef double OPS_MEMORY __attribute__((vector_size(8 * OPS_COUNT), aligned(8), may_alias));
typedef int64_t OPS(mask_memory) __attribute__((vector_size(8 * OPS_COUNT), aligned(8), may_alias));

LANES_INLINE OPS_TYPE OPS(load)(const double *p)
{
    return *(const OPS_MEMORY *)p;
}

LANES_INLINE OPS_MASK OPS(load_mask)(const int64_t *p)
{
    return *(const OPS(mask_memory) *)p;
}

LANES_INLINE void OPS(store)(double *p, OPS_TYPE v)
{
    *(OPS_MEMORY *)p = v;
}

LANES_INLINE OPS_TYPE OPS(set)(double x)
{
    return x - (OPS_TYPE){0.0};
}

/* mask ? yes : no; a mask comes from a comparison. */
LANES_INLINE OPS_TYPE OPS(select)(OPS_MASK mask, OPS_TYPE yes, OPS_TYPE no)
{
    return (OPS_TYPE)((mask & (OPS_MASK)yes) | (~mask & (OPS_MASK)no));
}

/* x > y ? x : y, so a NaN in x gives y. */
LANES_INLINE OPS_TYPE OPS(max)(OPS_TYPE x, OPS_TYPE y)
{
    return OPS(select)(x > y, x, y);
}

LANES_INLINE OPS_TYPE OPS(min)(OPS_TYPE x, OPS_TYPE y)
{
    return OPS(select)(x < y, x, y);
}

LANES_INLINE OPS_TYPE OPS(abs)(OPS_TYPE x)
{
    return (OPS_TYPE)((OPS_MASK)x & INT64_MAX);
}

/* Correctly rounded, as each instruction set has it. */
LANES_INLINE OPS_TYPE OPS(sqrt)(OPS_TYPE x)
{
    double v[OPS_COUNT];

    OPS(store)(v, x);
    lanes_sqrt_array(v, OPS_COUNT);
    return OPS(load)(v);
}

/* kernel_exp() in each lane, bit for bit (kernel_exp.h has the argument). */
LANES_INLINE OPS_TYPE OPS(exp)(OPS_TYPE x)
{
    const OPS_TYPE shift = OPS(set)(6755399441055744.0);
    OPS_MASK low = x < OPS(set)(-708.0);
    OPS_TYPE clipped = OPS(select)(low, OPS(set)(0.0), x); /* any number: -708 itself would underflow on its way */
    OPS_TYPE t = clipped * 1.4426950408889634 + shift;
    OPS_TYPE k = t - shift;
    OPS_TYPE r = (clipped - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
    OPS_TYPE p = OPS(set)(1.0 / 6227020800.0), two_k;

    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = (p * r) * r + r;
    two_k = (OPS_TYPE)(((OPS_MASK)t + 1023) << 52); /* the low bits of t hold k */
    return (OPS_TYPE)(~low & (OPS_MASK)(two_k + two_k * p));
}

#undef OPS_TYPE
#undef OPS_MASK
#undef OPS_MEMORY
#undef OPS_COUNT
#undef OPS
