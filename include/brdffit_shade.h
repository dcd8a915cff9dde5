/*
 * brdffit_shade: fitted BRDFs in a renderer. SPDX-License-Identifier: MIT
 *
 * Header-only, C99 and C++17, float and double, and nothing but the standard library's math.h. Evaluates every model that
 * brdffit fits, draws directions from it, and tells their density and the directional albedo:
 *
 *     struct brdffit_shade_f material;                      _f: float, _d: double
 *     brdffit_shade_make_f(&material, &description);        once a material; some tens of milliseconds
 *     brdffit_shade_eval_f(&material, light, view, out);    out[k] = f_r (n.l), K values
 *     brdffit_shade_sample_f(&material, view, u, light);    returns the density; 0: nothing is reflected there
 *     brdffit_shade_pdf_f(&material, light, view);
 *     brdffit_shade_albedo_f(&material, view, out);
 *     brdffit_shade_eval_many_f(...)                        packets; likewise pdf_many, sample_many
 *
 * Directions are unit vectors, away from the surface, in its frame: the normal is +z. Below the horizon everything is 0.
 * f_r itself is eval / (n.l).
 *
 * Accuracy (tests/test_shade.c). Double: brdffit_eval() to rounding. Float: 4e-6 of a value and 2e-7 times its lobe's exponent
 * (c s of docs/theory.md 1, which exp magnifies); lobes below exp(-87) of their peak are 0. Albedos are interpolated between 32
 * directions: to 0.005 of 1, and 0.01 for n.v below 0.25. They decide which lobe a direction is drawn from, and nothing else
 * hangs on them. Every model is reciprocal; not every one conserves energy: brdffit_shade_albedo tells.
 *
 * Packets are vectorised by the compiler: -O3, -fno-math-errno (or the square root stays a call), and the processor's -m
 * option. docs/export.md has the figures, tools/bench/bench_shade.c takes them.
 *
 * BRDFFIT_SHADE_CHANNELS may be defined before, for other than 3 channels at most.
 */
#ifndef BRDFFIT_SHADE_H
#define BRDFFIT_SHADE_H

#include <stddef.h>

#include "brdffit_shade/math.h"

#ifndef BRDFFIT_SHADE_CHANNELS
#define BRDFFIT_SHADE_CHANNELS 3
#endif

#define BRDFFIT_SHADE_LOBES 3
#define BRDFFIT_SHADE_NODES 32   /* directions that albedos are known at */
#define BRDFFIT_SHADE_COLUMNS 9  /* 3 of the diffuse term, 2 a lobe */
#define BRDFFIT_SHADE_PACKET 256 /* directions that a loop is run over at a time */

/* The values of brdffit.h. */
enum brdffit_shade_distribution {
    BRDFFIT_SHADE_BECKMANN,
    BRDFFIT_SHADE_GGX,
    BRDFFIT_SHADE_TORRANCE_SPARROW,
    BRDFFIT_SHADE_WARD,
    BRDFFIT_SHADE_BLINN_PHONG,
    BRDFFIT_SHADE_ASHIKHMIN_SHIRLEY,
    BRDFFIT_SHADE_LAFORTUNE,
    BRDFFIT_SHADE_RETRO,
    BRDFFIT_SHADE_DISTRIBUTIONS
};
enum brdffit_shade_masking {
    BRDFFIT_SHADE_V_CAVITY,
    BRDFFIT_SHADE_SMITH,
    BRDFFIT_SHADE_SMITH_SEPARABLE,
    BRDFFIT_SHADE_UNMASKED,
    BRDFFIT_SHADE_MASKINGS
};
enum brdffit_shade_diffuse {
    BRDFFIT_SHADE_LAMBERT,
    BRDFFIT_SHADE_NO_DIFFUSE,
    BRDFFIT_SHADE_OREN_NAYAR,
    BRDFFIT_SHADE_BURLEY,
    BRDFFIT_SHADE_DIFFUSES
};

/* A model as brdffit.h's brdffit_model and the JSON of a fit have it; arrays are the caller's, and not kept. */
struct brdffit_shade_description {
    int lobes, channels;
    int distribution[BRDFFIT_SHADE_LOBES];
    int masking, diffuse;
    int schlick;          /* f0 is there */
    const double *sigma;  /* P; 1 / sqrt(n) where the parameter is n */
    const double *x;      /* K */
    const double *y;      /* K x P */
    const double *f0;     /* K x P, or NULL */
    const double *x_more; /* K x 1 (Oren-Nayar) or 2 (Burley), or NULL */
};

#ifdef BRDFFIT_H
/* Of a result's model, whose arrays it points to; brdffit.h has to be included before this. Anisotropic lobes are not here yet:
 * a description of one has no lobes, and brdffit_shade_make refuses it. */
static inline struct brdffit_shade_description brdffit_shade_of_model(const brdffit_model *model)
{
    struct brdffit_shade_description d;
    int p;

    d.lobes = model->lobes;
    d.channels = (int)model->channels;
    for (p = 0; p < BRDFFIT_SHADE_LOBES; p++) {
        d.distribution[p] = (int)(model->distributions && p < model->lobes ? model->distributions[p]
                                                                           : model->distribution);
    }
    for (p = 0; model->anisotropy && p < model->lobes; p++) {
        d.lobes = model->anisotropy[p] == 1.0 ? d.lobes : 0;
    }
    d.masking = (int)model->masking;
    d.diffuse = (int)model->diffuse;
    d.schlick = model->fresnel == BRDFFIT_FRESNEL_SCHLICK;
    d.sigma = model->sigma;
    d.x = model->x;
    d.y = model->y;
    d.f0 = model->f0;
    d.x_more = model->x_more;
    return d;
}
#endif

#define SHADE_INLINE BRDFFIT_SHADE_INLINE
#define SHADE_FUNCTION static inline
#define SHADE_JOIN2(name, end) brdffit_shade_##name##_##end
#define SHADE_JOIN(name, end) SHADE_JOIN2(name, end)
#define FN(name) SHADE_JOIN(name, SHADE_END)
#define SHADE_MODEL2(end) brdffit_shade_##end
#define SHADE_MODEL1(end) SHADE_MODEL2(end)
#define SHADE_MODEL SHADE_MODEL1(SHADE_END)
#define LIT(number) ((REAL)number)

#define REAL float
#define SHADE_END f
#define SQRT sqrtf
#define EXP brdffit_shade_expf
#define LOG brdffit_shade_logf
#define ATAN brdffit_shade_atanf
#define ERF brdffit_shade_erff
#define SIN sinf
#define COS cosf
#include "brdffit_shade/lobes.h"
#include "brdffit_shade/sample.h"
#include "brdffit_shade/model.h"
#include "brdffit_shade/make.h"
#include "brdffit_shade/packet.h"
#undef REAL
#undef SHADE_END
#undef SQRT
#undef EXP
#undef LOG
#undef ATAN
#undef ERF
#undef SIN
#undef COS

#define REAL double
#define SHADE_END d
#define SQRT sqrt
#define EXP exp
#define LOG log
#define ATAN atan
#define ERF erf
#define SIN sin
#define COS cos
#include "brdffit_shade/lobes.h"
#include "brdffit_shade/sample.h"
#include "brdffit_shade/model.h"
#include "brdffit_shade/make.h"
#include "brdffit_shade/packet.h"
#undef REAL
#undef SHADE_END
#undef SQRT
#undef EXP
#undef LOG
#undef ATAN
#undef ERF
#undef SIN
#undef COS

#undef SHADE_INLINE
#undef SHADE_FUNCTION
#undef SHADE_JOIN2
#undef SHADE_JOIN
#undef FN
#undef SHADE_MODEL2
#undef SHADE_MODEL1
#undef SHADE_MODEL
#undef LIT

#endif
