/*
 * Directions drawn from lobes, and their densities. Written as lobes.h is, for the same languages.
 * SPDX-License-Identifier: MIT
 *
 * Every density is per solid angle of the light, given the viewer. What a draw makes of two numbers u1, u2 in [0, 1) may lie
 * below the surface, where nothing is reflected: a density integrates to 1 less the share of those.
 *
 * GGX, Beckmann        visible normals of Smith's masking (Heitz and d'Eon 2014; GGX as Heitz 2018 draws them), whatever the
 *                      masking is: D G1(v) / (4 n.v)
 * Torrance-Sparrow     half vectors by s (alpha / sin alpha) exp(-s alpha^2) / (pi Z), Z = 1 - exp(-s pi^2 / 4)
 * Ward                 half vectors by D (n.h) of Beckmann
 * Blinn-Phong, A.-S.   half vectors by (n + 1) / (2 pi) cos^n
 * Lafortune            (n + 1) / (2 pi) (r.l)^n about the mirrored viewer
 * retro                s / (pi Z) exp(-s |l - v|^2) about the viewer, Z = 1 - exp(-4 s)
 * diffuse              n.l / pi
 */

SHADE_INLINE struct FN(direction) FN(direction_of)(REAL x, REAL y, REAL z)
{
    struct FN(direction) d;

    d.x = x;
    d.y = y;
    d.z = z;
    return d;
}

SHADE_INLINE struct FN(direction) FN(normalise)(REAL x, REAL y, REAL z)
{
    REAL norm = SQRT(x * x + y * y + z * z);

    return FN(direction_of)(x / norm, y / norm, z / norm);
}

/* 1 - cosine and azimuth about an axis of unit norm (Duff et al. 2017). */
SHADE_INLINE struct FN(direction) FN(about)(struct FN(direction) axis, REAL versine, REAL phi)
{
    REAL sine = SQRT(versine * (versine < LIT(2.0) ? LIT(2.0) - versine : LIT(0.0))), cosine = LIT(1.0) - versine;
    REAL pole = axis.z < LIT(0.0) ? LIT(-1.0) : LIT(1.0), p = LIT(-1.0) / (pole + axis.z), q = axis.x * axis.y * p;
    REAL x = sine * COS(phi), y = sine * SIN(phi);

    return FN(direction_of)(x * (LIT(1.0) + pole * axis.x * axis.x * p) + y * q + cosine * axis.x,
                            x * pole * q + y * (pole + axis.y * axis.y * p) + cosine * axis.y,
                            -(x * pole * axis.x) - y * axis.y + cosine * axis.z);
}

/* The viewer mirrored by a half vector. */
SHADE_INLINE struct FN(direction) FN(mirrored)(struct FN(direction) v, struct FN(direction) h)
{
    REAL twice = LIT(2.0) * (v.x * h.x + v.y * h.y + v.z * h.z);

    return FN(direction_of)(twice * h.x - v.x, twice * h.y - v.y, twice * h.z - v.z);
}

/* A half vector of this tan^2. */
SHADE_INLINE struct FN(direction) FN(half_of)(REAL tan2, REAL u2)
{
    REAL cosine = LIT(1.0) / SQRT(LIT(1.0) + tan2), sine = SQRT(tan2) * cosine, phi = LIT(6.283185307179586) * u2;

    return FN(direction_of)(sine * COS(phi), sine * SIN(phi), cosine);
}

/* ---- Visible normals ----------------------------------------------------- */

SHADE_INLINE REAL FN(pdf_visible)(REAL normals, REAL nv, REAL side_v)
{
    return LIT(0.5) * normals / (nv + side_v);
}

SHADE_INLINE struct FN(direction) FN(visible_ggx)(struct FN(direction) v, REAL s, REAL u1, REAL u2)
{
    REAL sigma = LIT(1.0) / SQRT(s);
    struct FN(direction) w = FN(normalise)(sigma * v.x, sigma * v.y, v.z);
    REAL across = w.x * w.x + w.y * w.y, root = across > LIT(0.0) ? SQRT(across) : LIT(1.0);
    REAL ax = across > LIT(0.0) ? -w.y / root : LIT(1.0), ay = across > LIT(0.0) ? w.x / root : LIT(0.0);
    REAL bx = -(w.z * ay), by = w.z * ax, bz = w.x * ay - w.y * ax;
    REAL r = SQRT(u1), phi = LIT(6.283185307179586) * u2, half_z = LIT(0.5) * (LIT(1.0) + w.z);
    REAL p = r * COS(phi), rest = LIT(1.0) - p * p;
    REAL q = (LIT(1.0) - half_z) * SQRT(rest > LIT(0.0) ? rest : LIT(0.0)) + half_z * (r * SIN(phi));
    REAL last = rest - q * q, t = SQRT(last > LIT(0.0) ? last : LIT(0.0));
    REAL z = q * bz + t * w.z;

    return FN(normalise)(sigma * (p * ax + q * bx + t * w.x), sigma * (p * ay + q * by + t * w.y),
                         z > LIT(1e-12) ? z : LIT(1e-12));
}

/* The inverse of erf, within about 1e-7 (Giles 2012): a start for what needs more. */
SHADE_INLINE REAL FN(erf_inverse)(REAL x)
{
    REAL w = -LOG((LIT(1.0) - x) * (LIT(1.0) + x)), p;

    if (w < LIT(5.0)) {
        w = w - LIT(2.5);
        p = LIT(2.81022636e-08);
        p = LIT(3.43273939e-07) + p * w;
        p = LIT(-3.5233877e-06) + p * w;
        p = LIT(-4.39150654e-06) + p * w;
        p = LIT(0.00021858087) + p * w;
        p = LIT(-0.00125372503) + p * w;
        p = LIT(-0.00417768164) + p * w;
        p = LIT(0.246640727) + p * w;
        p = LIT(1.50140941) + p * w;
    } else {
        w = SQRT(w) - LIT(3.0);
        p = LIT(-0.000200214257);
        p = LIT(0.000100950558) + p * w;
        p = LIT(0.00134934322) + p * w;
        p = LIT(-0.00367342844) + p * w;
        p = LIT(0.00573950773) + p * w;
        p = LIT(-0.0076224613) + p * w;
        p = LIT(0.00943887047) + p * w;
        p = LIT(1.00167406) + p * w;
        p = LIT(2.83297682) + p * w;
    }
    return p * x;
}

/*
 * Slope towards a viewer with this cotangent, of normals with unit roughness: its distribution function is
 * C(x) / C(cot), C(x) = 1 + erf(x) + tan exp(-x^2) / sqrt(pi), x <= cot; C' = 2 / sqrt(pi) exp(-x^2) (1 - x tan). Newton, and
 * halves where that leaves the bracket.
 */
SHADE_FUNCTION REAL FN(visible_slope)(REAL cotangent, REAL u)
{
    REAL tangent = LIT(1.0) / cotangent, low = LIT(-6.0), high = cotangent < LIT(6.0) ? cotangent : LIT(6.0), x, goal;
    int i, done;

    goal = u * (LIT(1.0) + ERF(high) + tangent * EXP(-(high * high)) * LIT(0.5641895835477563));
    x = LIT(0.5) * (low + high);
    for (i = 0; i < 60; i++) {
        REAL e = EXP(-(x * x)) * LIT(0.5641895835477563), value = LIT(1.0) + ERF(x) + tangent * e - goal, next;

        low = value < LIT(0.0) ? x : low;
        high = value < LIT(0.0) ? high : x;
        next = x - value / (LIT(2.0) * e * (LIT(1.0) - x * tangent) + LIT(1e-30));
        next = next > low && next < high ? next : LIT(0.5) * (low + high);
        done = high - low < LIT(1e-7) || (next - x < LIT(1e-7) && x - next < LIT(1e-7)) ? 1 : 0;
        x = next;
        if (done == 1) {
            break;
        }
    }
    return x;
}

SHADE_FUNCTION struct FN(direction) FN(visible_beckmann)(struct FN(direction) v, REAL s, REAL u1, REAL u2)
{
    REAL sigma = LIT(1.0) / SQRT(s), sine = sigma * SQRT(v.x * v.x + v.y * v.y);
    REAL least = LIT(1e-4) * v.z, cotangent = v.z / (sine > least ? sine : least);
    REAL along = FN(visible_slope)(cotangent, u1);
    REAL beside = FN(erf_inverse)(LIT(2.0) * (u2 > LIT(1e-7) ? u2 : LIT(1e-7)) - LIT(1.0));
    REAL root = SQRT(v.x * v.x + v.y * v.y), c = root > LIT(0.0) ? v.x / root : LIT(1.0);
    REAL d = root > LIT(0.0) ? v.y / root : LIT(0.0);

    return FN(normalise)(-(sigma * (c * along - d * beside)), -(sigma * (d * along + c * beside)), LIT(1.0));
}

/* ---- Half vectors ---------------------------------------------------------- */

SHADE_INLINE REAL FN(pdf_torrance_sparrow)(struct FN(angles) a, REAL s)
{
    REAL tangent = SQRT(a.tan2_half), alpha = ATAN(tangent), sine = tangent * a.cos_half;
    REAL ratio = sine > LIT(1e-15) ? alpha / sine : LIT(1.0);

    return s * ratio * EXP(-(s * alpha * alpha)) /
           (LIT(12.566370614359172) * -FN(expm1)(LIT(-2.4674011002723395) * s) * a.vh);
}

SHADE_INLINE struct FN(direction) FN(half_torrance_sparrow)(REAL s, REAL u1, REAL u2)
{
    REAL alpha = SQRT(-FN(log1p)(u1 * FN(expm1)(LIT(-2.4674011002723395) * s)) / s), phi = LIT(6.283185307179586) * u2;

    return FN(direction_of)(SIN(alpha) * COS(phi), SIN(alpha) * SIN(phi), COS(alpha));
}

SHADE_INLINE REAL FN(pdf_ward)(struct FN(angles) a, REAL s)
{
    REAL secant2 = LIT(1.0) + a.tan2_half;

    return s * EXP(-(s * a.tan2_half)) * secant2 * SQRT(secant2) / (LIT(12.566370614359172) * a.vh);
}

SHADE_INLINE struct FN(direction) FN(half_ward)(REAL s, REAL u1, REAL u2)
{
    return FN(half_of)(-FN(log1p)(-u1) / s, u2);
}

SHADE_INLINE REAL FN(pdf_cos_power)(struct FN(angles) a, REAL n)
{
    return (n + LIT(1.0)) * FN(cos_power)(a, n) / (LIT(25.132741228718345) * a.vh);
}

SHADE_INLINE struct FN(direction) FN(half_cos_power)(REAL n, REAL u1, REAL u2)
{
    REAL exponent = LIT(2.0) * FN(log1p)(-u1) / (n + LIT(1.0));

    return FN(half_of)(-FN(expm1)(exponent) / EXP(exponent), u2);
}

/* ---- Directions ------------------------------------------------------------ */

SHADE_INLINE REAL FN(pdf_lafortune)(struct FN(angles) a, REAL n)
{
    return (n + LIT(1.0)) * FN(mirror_power)(a, n) * LIT(0.15915494309189535);
}

SHADE_INLINE struct FN(direction) FN(sample_lafortune)(struct FN(direction) v, REAL n, REAL u1, REAL u2)
{
    REAL versine = -FN(expm1)(FN(log1p)(-u1) / (n + LIT(1.0)));

    return FN(about)(FN(direction_of)(-v.x, -v.y, v.z), versine, LIT(6.283185307179586) * u2);
}

SHADE_INLINE REAL FN(pdf_retro)(struct FN(angles) a, REAL s)
{
    return s * EXP(-(s * a.lv)) / (LIT(-3.141592653589793) * FN(expm1)(LIT(-4.0) * s));
}

SHADE_INLINE struct FN(direction) FN(sample_retro)(struct FN(direction) v, REAL s, REAL u1, REAL u2)
{
    REAL versine = LIT(-0.5) * FN(log1p)(u1 * FN(expm1)(LIT(-4.0) * s)) / s;

    return FN(about)(v, versine, LIT(6.283185307179586) * u2);
}

SHADE_INLINE struct FN(direction) FN(sample_diffuse)(REAL u1, REAL u2)
{
    REAL r = SQRT(u1), phi = LIT(6.283185307179586) * u2;

    return FN(direction_of)(r * COS(phi), r * SIN(phi), SQRT(LIT(1.0) - u1));
}
