/*
 * Angles, lobes and diffuse terms for shading, and how directions are drawn from them. SPDX-License-Identifier: MIT
 *
 * No guard: brdffit_shade.h includes this once for float and once for double. It is written in what C99, C++17, GLSL, HLSL
 * and OSL have in common: scalars and small structures by value, no pointers, every literal a LIT(). `brdffit export
 * --to glsl|hlsl|osl` takes the functions that a fit needs from this very text, renaming REAL, FN() and LIT() only.
 *
 * Directions are unit vectors in the frame of the surface (normal +z), light and viewer above it. A lobe is
 *
 *     g = (normals at s) * (masking / n.v)          Beckmann, GGX
 *     g = all of it                                 the others
 *
 * as docs/theory.md 1 and 7.3 has them: f_r (n.l) for y = 1. Near the mirror direction everything hangs on tan^2 of the half
 * vector's angle, from the sum of the two directions as it is; n.v never divides what goes to 0 as fast.
 */

struct FN(direction) {
    REAL x, y, z;
};

struct FN(angles) {
    REAL nl, nv;         /* n.l, n.v */
    REAL sin2_l, sin2_v; /* sin^2 of the angles with the normal */
    REAL tan2_half;      /* tan^2 of the half vector's angle */
    REAL cos_half;       /* its cosine */
    REAL vh;             /* v.h */
    REAL versine;        /* 1 - v.h */
    REAL lv;             /* |l - v|^2 */
};

SHADE_INLINE struct FN(angles) FN(angles_of)(struct FN(direction) l, struct FN(direction) v)
{
    struct FN(angles) a;
    REAL hx = l.x + v.x, hy = l.y + v.y, hz = l.z + v.z;
    REAL dx = l.x - v.x, dy = l.y - v.y, dz = l.z - v.z;
    REAL across = hx * hx + hy * hy, norm = SQRT(across + hz * hz);

    a.nl = l.z;
    a.nv = v.z;
    a.sin2_l = l.x * l.x + l.y * l.y;
    a.sin2_v = v.x * v.x + v.y * v.y;
    a.tan2_half = across / (hz * hz);
    a.cos_half = hz / norm;
    a.vh = LIT(0.5) * norm;
    a.lv = dx * dx + dy * dy + dz * dz;
    a.versine = LIT(0.25) * a.lv / (LIT(1.0) + a.vh);
    return a;
}

/* ---- Small functions --------------------------------------------------- */

/* ln(1 + x), x > -1, to a relative error: the rounding of 1 + x is undone (Kahan). */
SHADE_INLINE REAL FN(log1p)(REAL x)
{
    REAL u = LIT(1.0) + x, off = u - LIT(1.0);
    REAL exact = LOG(u) * (x / (off == LIT(0.0) ? LIT(1.0) : off));

    return off == LIT(0.0) ? x : exact;
}

/* exp(x) - 1 for x <= 0, likewise. */
SHADE_INLINE REAL FN(expm1)(REAL x)
{
    REAL e = EXP(x), off = e - LIT(1.0);

    return off == LIT(0.0) ? x : (e < LIT(0.5) ? off : off * (x / LOG(e)));
}

/* Schlick's weight (1 - v.h)^5, and that of Burley's term. */
SHADE_INLINE REAL FN(fifth)(REAL versine)
{
    REAL square = versine * versine;

    return square * square * versine;
}

/* ---- Lobes ------------------------------------------------------------- */

/* Normals per solid angle, times what s makes of them: D. s = 1 / sigma^2. */
SHADE_INLINE REAL FN(ggx)(struct FN(angles) a, REAL s)
{
    REAL secant2 = LIT(1.0) + a.tan2_half, r = secant2 / (LIT(1.0) + a.tan2_half * s);

    return s * r * r * LIT(0.31830988618379067);
}

SHADE_INLINE REAL FN(beckmann)(struct FN(angles) a, REAL s)
{
    REAL secant2 = LIT(1.0) + a.tan2_half;

    return s * EXP(-(a.tan2_half * s)) * (secant2 * secant2) * LIT(0.31830988618379067);
}

/* n.t d of an angle with the normal, d = (1 + 2 Lambda) (docs/theory.md 7.3), 0 nowhere but at cosine 0 with sine 0. */
SHADE_INLINE REAL FN(side_ggx)(REAL cosine, REAL sin2, REAL s)
{
    return SQRT(cosine * cosine + sin2 / s);
}

SHADE_INLINE REAL FN(side_beckmann)(REAL cosine, REAL sin2, REAL s)
{
    REAL width = SQRT(sin2 / s), y = cosine / (width > cosine * LIT(0.05) ? width : cosine * LIT(0.05));

    return cosine * ERF(y) + width * EXP(-(y * y)) * LIT(0.5641895835477563);
}

/* G / n.v: V-cavities, and Smith's of the two sides n.l d and n.v d: correlated and separable. */
SHADE_INLINE REAL FN(v_cavity)(struct FN(angles) a)
{
    REAL least = a.nl < a.nv ? a.nl : a.nv, g = LIT(2.0) * a.cos_half * least / a.vh;

    return (g < LIT(1.0) ? g : LIT(1.0)) / a.nv;
}

SHADE_INLINE REAL FN(smith)(struct FN(angles) a, REAL side_l, REAL side_v)
{
    return LIT(2.0) * a.nl / (a.nv * side_l + a.nl * side_v);
}

SHADE_INLINE REAL FN(smith_separable)(struct FN(angles) a, REAL side_l, REAL side_v)
{
    return LIT(4.0) * a.nl / ((a.nl + side_l) * (a.nv + side_v));
}

SHADE_INLINE REAL FN(torrance_sparrow)(struct FN(angles) a, REAL s)
{
    REAL alpha = ATAN(SQRT(a.tan2_half));

    return FN(v_cavity)(a) * EXP(-(alpha * alpha * s)) * LIT(0.31830988618379067);
}

SHADE_INLINE REAL FN(ward)(struct FN(angles) a, REAL s)
{
    return s * SQRT(a.nl / a.nv) * EXP(-(a.tan2_half * s)) * LIT(0.07957747154594767);
}

/* cos^n of the half vector's angle. */
SHADE_INLINE REAL FN(cos_power)(struct FN(angles) a, REAL n)
{
    return EXP(LIT(-0.5) * n * FN(log1p)(a.tan2_half));
}

SHADE_INLINE REAL FN(blinn_phong)(struct FN(angles) a, REAL n)
{
    return a.nl * (n + LIT(2.0)) * FN(cos_power)(a, n) * LIT(0.15915494309189535);
}

SHADE_INLINE REAL FN(ashikhmin_shirley)(struct FN(angles) a, REAL n)
{
    REAL most = a.nl > a.nv ? a.nl : a.nv;

    return a.nl * (n + LIT(1.0)) * FN(cos_power)(a, n) * LIT(0.039788735772973836) / (a.vh * most);
}

/* (r.v)^n, r the mirrored light: 0 from 90 degrees off it. */
SHADE_INLINE REAL FN(mirror_power)(struct FN(angles) a, REAL n)
{
    REAL difference = a.nl - a.nv, sum = a.nl + a.nv;
    REAL off = LIT(0.5) * (difference * difference + a.tan2_half * (sum * sum));
    REAL power = EXP(n * FN(log1p)(-(off < LIT(1.0) ? off : LIT(0.5))));

    return off < LIT(1.0) ? power : LIT(0.0);
}

SHADE_INLINE REAL FN(lafortune)(struct FN(angles) a, REAL n)
{
    return a.nl * (n + LIT(2.0)) * FN(mirror_power)(a, n) * LIT(0.15915494309189535);
}

SHADE_INLINE REAL FN(retro)(struct FN(angles) a, REAL s)
{
    return a.nl * s * EXP(-(s * a.lv)) * LIT(0.31830988618379067);
}

/* ---- Diffuse terms: radiance for a coefficient of 1 ---------------------- */

SHADE_INLINE REAL FN(lambert)(struct FN(angles) a)
{
    return a.nl * LIT(0.31830988618379067);
}

/* Oren and Nayar's B: max(0, cos of azimuths) sin tan. */
SHADE_INLINE REAL FN(oren_nayar)(struct FN(angles) a)
{
    REAL most = a.nl > a.nv ? a.nl : a.nv;
    REAL part = (LIT(1.0) - LIT(0.5) * a.lv - a.nl * a.nv) / most;

    return FN(lambert)(a) * (part > LIT(1e-12) ? part : LIT(0.0));
}

/* F(l) and F(v) of Burley's term. */
SHADE_INLINE REAL FN(burley_side)(REAL cosine, REAL sin2)
{
    return FN(fifth)(sin2 / (LIT(1.0) + cosine));
}

SHADE_INLINE REAL FN(burley_0)(struct FN(angles) a)
{
    return FN(lambert)(a) * (LIT(1.0) - LIT(0.5) * FN(burley_side)(a.nl, a.sin2_l)) *
           (LIT(1.0) - LIT(0.5) * FN(burley_side)(a.nv, a.sin2_v));
}

SHADE_INLINE REAL FN(burley_1)(struct FN(angles) a)
{
    REAL l = FN(burley_side)(a.nl, a.sin2_l), v = FN(burley_side)(a.nv, a.sin2_v);

    return FN(lambert)(a) * LIT(2.0) * a.vh * a.vh * (l + v - l * v);
}

SHADE_INLINE REAL FN(burley_2)(struct FN(angles) a)
{
    REAL d2 = a.vh * a.vh;

    return FN(lambert)(a) * LIT(4.0) * (d2 * d2) * FN(burley_side)(a.nl, a.sin2_l) * FN(burley_side)(a.nv, a.sin2_v);
}
