/*
 * Single-precision functions that compilers vectorise: no calls, no tables, no branches. Double precision takes those of
 * math.h. SPDX-License-Identifier: MIT
 *
 * Largest errors, over all of what shading asks for (tests/test_shade.c): exp 1.2e-7 relative where the result is a normal
 * number (0 below exp(-87)), log 1.2e-7 relative, atan 3e-7 relative, erf 7e-7 absolute (Abramowitz and Stegun 7.1.26;
 * Smith's masking adds it to at least 1).
 */
#ifndef BRDFFIT_SHADE_MATH_H
#define BRDFFIT_SHADE_MATH_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* A call that is left in a loop keeps the loop from being vectorised. */
#if defined(__GNUC__)
#define BRDFFIT_SHADE_INLINE static inline __attribute__((always_inline))
#else
#define BRDFFIT_SHADE_INLINE static inline
#endif

BRDFFIT_SHADE_INLINE float brdffit_shade_float_of_bits(int32_t bits)
{
    float x;

    memcpy(&x, &bits, sizeof x);
    return x;
}

BRDFFIT_SHADE_INLINE int32_t brdffit_shade_bits_of_float(float x)
{
    int32_t bits;

    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* x <= 88. 2^n e^r, |r| <= ln 2 / 2: a polynomial of degree 6, and n put into the exponent. From exp(-87) on bits are masked
 * away: a choice between a value and a constant becomes a branch. */
BRDFFIT_SHADE_INLINE float brdffit_shade_expf(float x)
{
    int32_t normal = -(int32_t)(x > -87.0f);
    float inside = brdffit_shade_float_of_bits(brdffit_shade_bits_of_float(x) & normal);
    int32_t n = (int32_t)(inside * 1.44269504f + 1024.5f) - 1024;
    float k = (float)n, r = inside - k * 0.693359375f + k * 2.12194440e-4f, p;

    p = 1.9875691500e-4f;
    p = p * r + 1.3981999507e-3f;
    p = p * r + 8.3334519073e-3f;
    p = p * r + 4.1665795894e-2f;
    p = p * r + 1.6666665459e-1f;
    p = p * r + 5.0000001201e-1f;
    p = p * (r * r) + r + 1.0f;
    return p * brdffit_shade_float_of_bits(((n + 127) << 23) & normal);
}

/* x = 2^n (1 + f), 1 + f in [sqrt(1/2), sqrt 2). x must be a positive normal number. */
BRDFFIT_SHADE_INLINE float brdffit_shade_logf(float x)
{
    int32_t bits = brdffit_shade_bits_of_float(x), n = (bits - 0x3f3504f3) >> 23;
    float f = brdffit_shade_float_of_bits(bits - (int32_t)((uint32_t)n << 23)) - 1.0f, k = (float)n, z = f * f, p;

    p = 7.0376836292e-2f;
    p = p * f - 1.1514610310e-1f;
    p = p * f + 1.1676998740e-1f;
    p = p * f - 1.2420140846e-1f;
    p = p * f + 1.4249322787e-1f;
    p = p * f - 1.6668057665e-1f;
    p = p * f + 2.0000714765e-1f;
    p = p * f - 2.4999993993e-1f;
    p = p * f + 3.3333331174e-1f;
    p = p * f * z - k * 2.12194440e-4f - 0.5f * z;
    return f + p + k * 0.693359375f;
}

/* x >= 0: of y, the smaller of x and 1 / x; above tan(pi / 8) of (y - 1) / (1 + y). */
BRDFFIT_SHADE_INLINE float brdffit_shade_atanf(float x)
{
    float steep = (float)(x > 1.0f), inverse = 1.0f / (x + 1e-30f), y = x < inverse ? x : inverse;
    float far = (float)(y > 0.4142135624f), r = (y - far) / (1.0f + far * y), z = r * r, p;

    p = 8.05374449538e-2f;
    p = p * z - 1.38776856032e-1f;
    p = p * z + 1.99777106478e-1f;
    p = p * z - 3.33329491539e-1f;
    p = far * 0.7853981634f + (p * z * r + r);
    return steep * 1.5707963268f + (1.0f - 2.0f * steep) * p;
}

BRDFFIT_SHADE_INLINE float brdffit_shade_erff(float x)
{
    float size = fabsf(x), t = 1.0f / (1.0f + 0.3275911f * size), p;

    p = 1.061405429f;
    p = p * t - 1.453152027f;
    p = p * t + 1.421413741f;
    p = p * t - 0.284496736f;
    p = p * t + 0.254829592f;
    return copysignf(1.0f - p * t * brdffit_shade_expf(-(size * size)), x);
}

#endif
