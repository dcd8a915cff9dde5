/*
 * brdffit: certified globally optimal fits of analytic BRDF models.
 *
 * Model (Yu, Seo and Lee, "Global Optimization for Estimating a BRDF with
 * Multiple Specular Lobes", eq. 1-4). Sample i, channel k, P lobes:
 *
 *     I_ik  ~  a_i x_k + sum_p y_kp g_i(sigma_p),      x_k >= 0, y_kp >= 0
 *
 *     a = (n.l)/pi                                  diffuse
 *     g(sigma) = b lambda(s) exp(-c s), s = 1/sigma^2     specular
 *     Beckmann: b = G / (pi (n.v) cos^4 alpha), c = tan^2 alpha, lambda = s;
 *     the other distributions: see brdffit_distribution
 *
 * I is radiance under unit irradiance at normal incidence, that is
 * f_r (n.l); alpha is the angle between the normal n and the half vector of
 * light l and view v. Every channel shares the roughness sigma_p of a lobe.
 * brdffit finds the sigma, x, y that minimise
 *
 *     E^2 = sum_ik w_i (I_ik - model_ik)^2 / scale_k^2
 *
 * and proves a lower bound on the smallest E^2 that any choice could reach.
 *
 * Five calls make a program: brdffit_samples_init(), brdffit_options_init(),
 * brdffit_fit_new(), brdffit_eval() and brdffit_result_free(). What follows
 * them in this header is for who needs more: memory without malloc, whole maps,
 * samples that are not kept, a bound proven again, counters.
 *
 * The interface grows without breaking a program. A structure that the caller
 * fills in begins with its size, which its _init macro sets to what the caller
 * was compiled with; the library reads no further than that, takes defaults for
 * the rest, and refuses (BRDFFIT_ERR_ARGUMENT) a longer one of a later version
 * when what it does not know of it is not zero. What the library fills in is
 * handed out by pointer, and later versions may append to it; brdffit_error
 * alone is the caller's and stays as it is.
 *
 * But for brdffit_fit_new() the library never allocates, and it never prints,
 * reads a clock or keeps global state: the caller owns all memory and every
 * call is thread-safe as long as two threads do not share a workspace. It computes in the default floating-point
 * environment (nearest, subnormals, no traps) whatever the caller has set;
 * the progress callback runs in that one too, and the caller's is back on
 * return. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_H
#define BRDFFIT_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32) || !defined(__GNUC__)
#define BRDFFIT_API
#else
#define BRDFFIT_API __attribute__((visibility("default")))
#endif

#define BRDFFIT_VERSION_MAJOR 0
#define BRDFFIT_VERSION_MINOR 2
#define BRDFFIT_VERSION_PATCH 0
#define BRDFFIT_VERSION_STRING "0.2.0"

/* Most lobes a fit can have. */
#define BRDFFIT_MAX_LOBES 3

/* "Does not apply" in brdffit_error. */
#define BRDFFIT_NONE ((size_t)-1)

/* Version of the library that is linked, as "major.minor.patch". */
BRDFFIT_API const char *brdffit_version(void);

/* ---- Did the call fail ------------------------------------------------ */

typedef enum brdffit_status {
    BRDFFIT_OK = 0,
    BRDFFIT_ERR_ARGUMENT,    /* a NULL pointer, or a struct that asks for what is not known */
    BRDFFIT_ERR_OPTION,      /* an option out of its range */
    BRDFFIT_ERR_UNSUPPORTED, /* a combination that this build cannot fit */
    BRDFFIT_ERR_WORKSPACE,   /* the workspace is too small */
    BRDFFIT_ERR_VALUE,       /* NaN, infinite or out-of-range sample data */
    BRDFFIT_ERR_NO_SAMPLES,  /* nothing is left to fit */
    BRDFFIT_ERR_MEMORY,      /* allocation failed (brdffit_fit_new, file readers) */
    BRDFFIT_ERR_OPEN,        /* a file cannot be opened (brdffit_io.h) */
    BRDFFIT_ERR_READ,        /* reading failed, or a damaged .gz stream */
    BRDFFIT_ERR_FORMAT,      /* the file is not what its name or header says */
    BRDFFIT_STATUS_COUNT
} brdffit_status;

/* Where and why a call failed. `message` is a constant string (never NULL
 * after a failure, never to be freed). Fields that do not apply hold
 * BRDFFIT_NONE, and `value` holds 0. Filled in by a call that fails and only then; any call takes NULL for it. */
typedef struct brdffit_error {
    brdffit_status status;
    const char *message;
    size_t sample;  /* index of the sample, from 0 */
    size_t channel; /* index of the channel, from 0 */
    size_t line;    /* line of the text file, from 1 */
    size_t column;  /* column (field) of that line, from 1 */
    double value;   /* the offending value */
} brdffit_error;

/* Constant description of a status, e.g. "no samples are left to fit". */
BRDFFIT_API const char *brdffit_status_string(brdffit_status status);

/* ---- Samples ---------------------------------------------------------- */

typedef enum brdffit_form {
    BRDFFIT_FORM_DIRECTIONS = 0, /* light, view, optionally normal */
    BRDFFIT_FORM_ANGLES,         /* cosines and tan^2 alpha: tables in half/difference angles */
    BRDFFIT_FORM_COEFFICIENTS    /* a, b, c of the model, already computed */
} brdffit_form;

typedef enum brdffit_quantity {
    BRDFFIT_QUANTITY_BRDF = 0, /* f_r in 1/sr; multiplied by n.l before the fit */
    BRDFFIT_QUANTITY_RADIANCE  /* f_r (n.l): what the model predicts, fitted as it is */
} brdffit_quantity;

/*
 * Measured samples; all arrays belong to the caller and are only read.
 * Call brdffit_samples_init() first: it sets struct_size and zeroes the rest. It takes NULL, and does nothing.
 *
 * DIRECTIONS:   light, view: count x 3, row-major, towards the light and
 *               towards the viewer; any finite length but zero (they are
 *               normalised). normal: count x 3, or NULL for +z. Directions are
 *               taken to be known to 1e-15 radians: what is proven holds for
 *               the doubles and for any others that close, such as those of
 *               the degrees that they were made from. Half-vector angles that
 *               close are one angle, so that mirror images merge. LAFORTUNE:
 *               where the sign of r.v is not known so, a sample has no lobe.
 * ANGLES:       cos_light = n.l and cos_view = n.v in [-1, 1],
 *               tan2_half = tan^2 alpha in [0, 1e100], cos_difference = v.h in (0, 1].
 *               Samples with equal tan2_half (to the bit) merge exactly.
 * COEFFICIENTS: a, b, c >= 0, c <= 1e100, of the distribution that is fitted; lobes of several share them.
 *               The quantity must be RADIANCE.
 */
typedef struct brdffit_samples {
    size_t struct_size;
    size_t count;    /* N samples */
    size_t channels; /* K >= 1 */
    brdffit_form form;
    brdffit_quantity quantity;
    const double *light;
    const double *view;
    const double *normal;
    const double *cos_light;
    const double *cos_view;
    const double *tan2_half;
    const double *cos_difference;
    const double *a;
    const double *b;
    const double *c;
    const double *values;  /* count x channels, row-major; finite, may be negative (noise) */
    const double *weights; /* count, finite and >= 0, multiplies squared residuals; NULL: all 1.
                              A sample of weight 0 is skipped and its values are not looked at. */
    const double *tangent; /* DIRECTIONS: N x 3, the tangent of the surface at each sample, which anisotropic lobes are
                              turned from; any length, what is along the normal does not count. NULL: +x, and with
                              normals that are not +z anisotropic lobes need it */
} brdffit_samples;

#define brdffit_samples_init(samples) brdffit_samples_init_sized((samples), sizeof(brdffit_samples))
BRDFFIT_API void brdffit_samples_init_sized(brdffit_samples *samples, size_t struct_size);

/* ---- Weights of samples ------------------------------------------------ */

/*
 * What samples count for. A weight multiplies the squared residual of radiance, f_r (n.l), whatever the quantity of the
 * values; 1 / (n.l)^2 times as much would weigh residuals of f_r. One weight a sample, the same for its channels.
 *
 * NONE         1.
 * COLUMN       those that the samples have: brdffit_samples.weights.
 * COSINE       n.l: residuals over the projected solid angle of the light.
 * SOLID_ANGLE  the share of all pairs of directions of light and view, above the horizon and by solid angle, that a
 *              sample stands for, times the number of samples: 1 on average. Turns about the normal and mirror images
 *              make no difference, as to the models. A fit then means the same wherever the samples lie: where most
 *              were taken no longer decides. The shares are those of the pieces of a k-d tree, one for each pair of
 *              directions (src/weight/cells.c); equal ones share a piece. What lies beyond the outermost samples belongs to them:
 *              samples in one plane of incidence stand for half a turn of azimuth each.
 * RELATIVE     1 / max(m, floor)^2, m the root mean square over channels of radiance by the channel's largest
 *              magnitude: relative errors, but for samples darker than `floor` of the brightest.
 *
 * Throughout, a sample whose weight is 0 keeps it, and one below the horizon, which no fit uses, has 1.
 */
typedef enum brdffit_weighting {
    BRDFFIT_WEIGHTING_NONE = 0,
    BRDFFIT_WEIGHTING_COLUMN,
    BRDFFIT_WEIGHTING_COSINE,
    BRDFFIT_WEIGHTING_SOLID_ANGLE,
    BRDFFIT_WEIGHTING_RELATIVE,
    BRDFFIT_WEIGHTING_COUNT
} brdffit_weighting;

/* What RELATIVE takes for a floor when nobody says, and the least that it takes. */
#define BRDFFIT_WEIGHT_FLOOR 0.01
#define BRDFFIT_WEIGHT_FLOOR_MIN 1e-6

/* Constant name: "none", "column", "cosine", "solid-angle", "relative". */
BRDFFIT_API const char *brdffit_weighting_string(brdffit_weighting weighting);

/* Bytes of workspace that brdffit_weights() needs, and brdffit_weights_crowded() what RELATIVE does; 0 when it needs none,
 * or for sizes that it refuses. */
BRDFFIT_API size_t brdffit_weights_size(size_t count, size_t channels, brdffit_weighting weighting);

/*
 * Weights of the samples into out[count], finite and >= 0, in O(N log N); put them into samples->weights to fit with
 * them. out may not be samples->weights. `floor` in [1e-6, 1] is of RELATIVE alone, which is also the only one that looks at
 * values. The workspace (any alignment) is of use during the call; NULL where none is needed.
 *
 * BRDFFIT_ERR_ARGUMENT for COLUMN of samples without weights; BRDFFIT_ERR_UNSUPPORTED for COSINE and SOLID_ANGLE of
 * form COEFFICIENTS, which has no directions, and for more than 2^32 - 1 samples; BRDFFIT_ERR_VALUE for samples that
 * cannot be fitted either; BRDFFIT_ERR_WORKSPACE. out is in an undefined state then.
 */
BRDFFIT_API brdffit_status brdffit_weights(const brdffit_samples *samples, brdffit_weighting weighting, double floor,
                                           void *workspace, size_t workspace_size, double *out, brdffit_error *error);

/* Kish's effective sample size as a share of count: (sum w)^2 / (count sum w^2), in (0, 1]; 0 when no weight is above
 * 0. Of solid angles it tells how evenly samples lie: about 0.7 where they are drawn uniformly. */
BRDFFIT_API double brdffit_weights_effective(const double *weights, size_t count);

/*
 * 1 when samples crowd where the material is bright, as those of an instrument that follows the lobe do, so that a fit without
 * weights is a fit to that part of the directions; else 0, also for what cannot be told. With their weights of
 * SOLID_ANGLE w: the effective sample size is less than 0.25 of count, and the mean of what RELATIVE calls m more than
 * 3 times its mean with weights w. Grids of angles, which do not follow the lobe, are rarely beyond 2.
 */
BRDFFIT_API int brdffit_weights_crowded(const brdffit_samples *samples, const double *solid_angles, void *workspace,
                                        size_t workspace_size);

/* ---- Options ---------------------------------------------------------- */

/*
 * What a lobe is: g = b lambda(s) exp(-c s) (GGX: b s (1 + c s)^-2), b times n.l as for radiance.
 *
 *                      s          lambda(s)         c                 b
 * BECKMANN             1/sigma^2  s                 tan^2 alpha       G / (pi (n.v) cos^4 alpha)
 * GGX                  1/sigma^2  s                 tan^2 alpha       the same
 * TORRANCE_SPARROW     1/sigma^2  1                 alpha^2           G / (pi (n.v))
 * WARD                 1/sigma^2  s                 tan^2 alpha       sqrt((n.l) / (n.v)) / (4 pi)
 * BLINN_PHONG          n          (n + 2) / (2 pi)  -ln cos alpha     n.l
 * ASHIKHMIN_SHIRLEY    n          (n + 1) / (8 pi)  -ln cos alpha     (n.l) / ((v.h) max(n.l, n.v))
 * LAFORTUNE            n          (n + 2) / (2 pi)  -ln(r.v)          n.l; 0 where r.v <= 0
 * RETRO                1/sigma^2  s / pi            |l - v|^2         n.l
 *
 * with G = min{1, 2 (n.h)(n.v) / (v.h), 2 (n.h)(n.l) / (v.h)} and r the mirrored light, 2 (n.l) n - l; so
 * exp(-c n) is cos^n alpha or (r.v)^n. n is any positive number. Sources: Cook and Torrance 1982 with Beckmann, as
 * the paper's eq. 1-4 write it; Walter et al. 2007 (GGX); Torrance and Sparrow 1967, the paper's section 6; Ward
 * 1992, isotropic; Blinn 1977 with today's factor (n + 2) / (2 pi); Ashikhmin and Shirley 2000 with n_u = n_v and
 * without its Fresnel factor; Lafortune et al. 1997 with one mirror lobe, -C_x = -C_y = C_z.
 */
typedef enum brdffit_distribution {
    BRDFFIT_BECKMANN = 0,
    BRDFFIT_GGX,
    BRDFFIT_TORRANCE_SPARROW,
    BRDFFIT_WARD,
    BRDFFIT_BLINN_PHONG,
    BRDFFIT_ASHIKHMIN_SHIRLEY,
    BRDFFIT_LAFORTUNE,
    BRDFFIT_RETRO,
    BRDFFIT_DISTRIBUTION_COUNT
} brdffit_distribution;

/* Constant name: "beckmann", "ggx", "torrance-sparrow", "ward", "blinn-phong", "ashikhmin-shirley", "lafortune",
 * "retro". */
BRDFFIT_API const char *brdffit_distribution_string(brdffit_distribution distribution);

/* Constant name as it stands in a sentence: "Beckmann", "GGX", ..., "Ashikhmin-Shirley", "Lafortune",
 * "retro". */
BRDFFIT_API const char *brdffit_distribution_title(brdffit_distribution distribution);

/* Constant name of the parameter that the distribution is known by: "sigma" where s = 1/sigma^2, "exponent" where
 * s = n; "unknown" for no distribution of ours. */
BRDFFIT_API const char *brdffit_parameter_string(brdffit_distribution distribution);

/*
 * What a lobe's reflectance does with the angle between light and half vector (theory 7.2 of docs/theory.md).
 *
 * NONE      nothing: y is all there is (the paper's model)
 * SCHLICK   y is multiplied by F = F0 + (1 - F0) w, w = (1 - v.h)^5 (Schlick 1994), with an F0 in [0, 1] of each lobe
 *           and channel, found and certified with the rest: linear in y F0 and y (1 - F0). w below 1e-100 counts as 0.
 */
typedef enum brdffit_fresnel {
    BRDFFIT_FRESNEL_NONE = 0,
    BRDFFIT_FRESNEL_SCHLICK,
    BRDFFIT_FRESNEL_COUNT
} brdffit_fresnel;

/* Constant name: "none", "schlick"; "unknown" for none of ours. */
BRDFFIT_API const char *brdffit_fresnel_string(brdffit_fresnel fresnel);

/*
 * Masking and shadowing G of microfacets, of BECKMANN and GGX lobes only.
 *
 * V_CAVITY         min{1, 2 (n.h)(n.v) / (v.h), 2 (n.h)(n.l) / (v.h)}, which does not know sigma (the paper's)
 * SMITH            Smith's, height-correlated: 1 / (1 + Lambda(l) + Lambda(v)) (Heitz 2014, Walter et al. 2007), exact
 * SMITH_SEPARABLE  Smith's, 1 / ((1 + Lambda(l)) (1 + Lambda(v)))
 * NONE             1
 */
typedef enum brdffit_masking {
    BRDFFIT_MASKING_V_CAVITY = 0,
    BRDFFIT_MASKING_SMITH,
    BRDFFIT_MASKING_SMITH_SEPARABLE,
    BRDFFIT_MASKING_NONE,
    BRDFFIT_MASKING_COUNT
} brdffit_masking;

/* Constant name: "v-cavity", "smith", "smith-separable", "none"; "unknown" for none of ours. */
BRDFFIT_API const char *brdffit_masking_string(brdffit_masking masking);

/*
 * The diffuse term: non-negative columns a_f of radiance, each with a coefficient x_f of each channel. l = n.l, v = n.v,
 * d = v.h, F(t) = (1 - t)^5.
 *
 * LAMBERT     l / pi
 * NONE        no column
 * OREN_NAYAR  l / pi; and l / pi max(0, cos(difference of azimuths)) sin(a) tan(b), a the larger and b the smaller
 *             polar angle (Oren and Nayar 1994, its qualitative model, whose two terms are A and B of its roughness). The
 *             product of cosine, sine and tangent counts as 0 below 1e-12
 * BURLEY      l / pi (1 - F(l) / 2) (1 - F(v) / 2); l / pi 2 d^2 (F(l) + F(v) - F(l) F(v)); l / pi 4 d^4 F(l) F(v).
 *             With coefficients x, x r, x r^2 these are the diffuse term of Burley 2012 with roughness r, x its
 *             colour; here the three are free and not negative. F(t) below 1e-100 counts as 0.
 */
typedef enum brdffit_diffuse {
    BRDFFIT_DIFFUSE_LAMBERT = 0,
    BRDFFIT_DIFFUSE_NONE,
    BRDFFIT_DIFFUSE_OREN_NAYAR,
    BRDFFIT_DIFFUSE_BURLEY,
    BRDFFIT_DIFFUSE_COUNT
} brdffit_diffuse;

/* Constant name: "lambert", "none", "oren-nayar", "burley"; "unknown" for none of ours. */
BRDFFIT_API const char *brdffit_diffuse_string(brdffit_diffuse diffuse);

/* Columns of a diffuse term: 1, 1 (which is zero), 2, 3; 0 for none of ours. */
BRDFFIT_API int brdffit_diffuse_columns(brdffit_diffuse diffuse);

typedef enum brdffit_norm {
    BRDFFIT_NORM_L2 = 0, /* sum_ik w_i r_ik^2 */
    BRDFFIT_NORM_L1, /* sum_ik w_i |r_ik|: indifferent to how far an outlier is out */
    BRDFFIT_NORM_LINF, /* largest |r_ik| over samples with w_i > 0 */
    BRDFFIT_NORM_COUNT
} brdffit_norm;

/*
 * What is minimised, with residuals r in the units that were minimised. L1 and LINF are solved and proven by linear
 * programs (ECOS allocates a solver per fit; BRDFFIT_ERR_UNSUPPORTED in a build without it) whatever
 * brdffit_options.engine says; time and memory grow with the number of samples, which do not collapse as for L2.
 */
BRDFFIT_API const char *brdffit_norm_string(brdffit_norm norm);

/* How boxes of roughness are discarded; both prove the same thing. */
typedef enum brdffit_engine {
    BRDFFIT_ENGINE_MOMENT = 0, /* second-order bounds from convexity in moment space: fast, never allocates */
    BRDFFIT_ENGINE_SOCP, /* the paper's feasibility problem by ECOS with certificates checked by us; allocates
                                  a solver per fit; BRDFFIT_ERR_UNSUPPORTED in a build without ECOS */
    BRDFFIT_ENGINE_COUNT
} brdffit_engine;

/* Constant name: "moment", "socp". */
BRDFFIT_API const char *brdffit_engine_string(brdffit_engine engine);

/* Instruction sets that inner loops are compiled for; the results have the same bits with each. */
typedef enum brdffit_isa {
    BRDFFIT_ISA_AUTO = 0, /* the best that the build and this processor have */
    BRDFFIT_ISA_BASE, /* what the build targets: SSE2 on x86-64, NEON on AArch64 */
    BRDFFIT_ISA_AVX2,
    BRDFFIT_ISA_AVX512, /* F, DQ, VL */
    BRDFFIT_ISA_COUNT
} brdffit_isa;

/* Constant name: "auto", "base", "avx2", "avx512". */
BRDFFIT_API const char *brdffit_isa_string(brdffit_isa isa);

/* 1 when this build on this processor can run `isa`, else 0. AUTO and BASE always can. */
BRDFFIT_API int brdffit_isa_supported(brdffit_isa isa);

typedef enum brdffit_normalise {
    BRDFFIT_NORMALISE_MAX = 0, /* divide each channel by its largest used radiance (the paper's) */
    BRDFFIT_NORMALISE_NONE /* minimise in the data's own units */
} brdffit_normalise;

/* Return non-zero to stop the search (the result is still valid). Called in the thread of the fit: once after the
 * reduction, then every 256 boxes. */
struct brdffit_progress;
typedef int (*brdffit_progress_fn)(void *user, const struct brdffit_progress *progress);

/*
 * Called in the thread of the fit once for each box that was bounded: result.boxes times. Boxes that were split are
 * followed by the boxes that they were split into; the others cover the domain. The box and its arrays are the
 * library's: they are there until the callback returns.
 */
struct brdffit_box;
typedef void (*brdffit_box_fn)(void *user, const struct brdffit_box *box);

typedef struct brdffit_options {
    size_t struct_size;
    int lobes; /* P: 1, 2 or 3. Default 1 */
    brdffit_distribution distribution;
    brdffit_norm norm;
    brdffit_normalise normalise;
    brdffit_engine engine; /* of norm L2; the others have their own. Default moment */
    int socp_every_box; /* engine socp, norms L1 and LINF: 1 sends every box to ECOS as the paper does; 0
                                (default) decides the ones that it can without */
    double sigma_min; /* > 0, >= 1e-12. Default 1e-12 */
    double sigma_max; /* >= sigma_min, <= 1e3. Default 6 */
    double exponent_min; /* these two instead for distributions whose parameter is the exponent n: */
    double exponent_max; /* 1e-6 <= exponent_min <= exponent_max <= 1e24. Default 0.1 and 1e7 */
    double relative_gap; /* stop when E^2 <= (1 + gap) lower bound; > 0. Default 1e-3 */
    double absolute_gap; /* or when E^2 - lower bound <= this fraction of the data's sum of
                                squares; >= 0. Default 1e-12 */
    double sigma_resolution; /* boxes narrower than this in every sigma (1/sqrt(n)) are not split;
                                >= 0. Default 0: off */
    size_t box_budget; /* most boxes to bound; >= 1. Default 1000000. A small one shrinks the workspace */
    double max_incidence; /* degrees, (0, 90]; 90 or more uses all above the horizon. Default 60 */
    brdffit_isa isa; /* Default AUTO. One that cannot run here is BRDFFIT_ERR_UNSUPPORTED */
    brdffit_progress_fn progress; /* or NULL */
    void *progress_user;
    brdffit_box_fn box; /* or NULL */
    void *box_user;
    const brdffit_distribution *distributions; /* P entries, or NULL (default): `distribution` for every lobe. Lobes
                                                  come out with those of a distribution together, in the order of their
                                                  first mention: of GGX, WARD, GGX a result has GGX, GGX, WARD */
    brdffit_fresnel fresnel; /* of every lobe. Default NONE */
    brdffit_diffuse diffuse; /* Default LAMBERT. All columns together, those of `diffuse` and one a lobe (two with
                                SCHLICK), are at most 7: more is BRDFFIT_ERR_UNSUPPORTED. Neither other than the default
                                goes with samples in COEFFICIENTS or with sums */
    brdffit_masking masking; /* Default V_CAVITY. Of every lobe, which then must be BECKMANN or GGX: another is
                                BRDFFIT_ERR_UNSUPPORTED with any but the default; so are samples in COEFFICIENTS and sums */
    int physical; /* 1: models that reflect no more than they receive, and no others: in each channel the sum of
                                all diffuse x and of the reflectance of each lobe is at most 1, and so is each of them. That
                                is 4 y of BECKMANN and GGX (y = F / 4, and so F0 <= 1), y of WARD, BLINN_PHONG,
                                ASHIKHMIN_SHIRLEY, LAFORTUNE and RETRO; with Fresnel the y that F multiplies. Values have to be
                                absolute: of data in units of their own it means nothing. Norm L2 and engine moment only,
                                no sums, no TORRANCE_SPARROW lobes, which are not normalised: else BRDFFIT_ERR_UNSUPPORTED.
                                Where the fit without it obeys, that is the result, to the bit; where not, a second search
                                follows (theory 7.9) with a budget of its own; boxes, nodes and calls of `box` are those of
                                both. Default 0 */
    int anisotropic; /* 1: the first lobe has two roughnesses, sigma_x along the tangent and sigma_y across it (theory
                                7.4), both searched and proven in [sigma_min, sigma_max] (n_x, n_y in the exponent's range).
                                It must be BECKMANN, GGX, WARD or ASHIKHMIN_SHIRLEY, with at most one other lobe. Samples in
                                DIRECTIONS, norm L2, engine moment, masking V_CAVITY or NONE, no physical bounds: else
                                BRDFFIT_ERR_UNSUPPORTED. Default 0 */
    double anisotropy; /* with `anisotropic`, sigma_x / sigma_y where it is known, in [1e-6, 1e6]: what is proven is
                                proven of models with that. 0 (default): searched */
    double tangent_angle; /* degrees that the lobe's own tangent is turned from the samples' towards their bitangent
                                n x t. Default 0 */
    size_t memory; /* 0 (default): the workspace is what nearly every search wants. Otherwise so many bytes at most, as
                      brdffit_workspace_size() counts them, and the search makes the best of them: where it runs out
                      of nodes or places for boxes it goes on depth first, which costs boxes. The same bits on every
                      processor. Below the least that the samples need, workspace_size() says what that is. Norm L2
                      and engine moment; others, and two roughnesses that are searched, take what they need */
} brdffit_options;

/* Set struct_size and every default. NULL is fine: nothing happens. */
#define brdffit_options_init(options) brdffit_options_init_sized((options), sizeof(brdffit_options))
BRDFFIT_API void brdffit_options_init_sized(brdffit_options *options, size_t struct_size);

/* ---- Model and result ------------------------------------------------- */

/* A model that can be evaluated: pointers belong to whoever filled it in, after brdffit_model_init(). */
typedef struct brdffit_model {
    size_t struct_size;
    brdffit_distribution distribution;
    int lobes; /* P */
    size_t channels; /* K */
    const double *sigma; /* P roughnesses, in a result ascending among lobes of one distribution; 1/sqrt(n)
                            where the parameter is n */
    const double *x; /* K diffuse coefficients, in the data's units */
    const double *y; /* K x P row-major specular coefficients, in the data's units;
                            y multiplies lambda(s) exp(-c s) b: the paper's scaling */
    const brdffit_distribution *distributions; /* P entries (always in a result), or NULL: `distribution`
                                                  for every lobe */
    brdffit_fresnel fresnel;
    brdffit_diffuse diffuse;
    const double *f0; /* K x P row-major, in [0, 1]: reflectance at normal incidence, a factor of y (SCHLICK). Of a
                             lobe with y = 0 it is 0. NULL without Fresnel */
    const double *x_more; /* K x (columns - 1) row-major: x of the diffuse term's further columns; NULL where
                             there is one */
    brdffit_masking masking;
    const double
        *anisotropy; /* P entries, sigma_x / sigma_y of each lobe, whose sigma is then sqrt(sigma_x sigma_y); or
                             NULL: 1. Another than 1 needs samples in DIRECTIONS, with a tangent where there are normals */
    const double *tangent_angle; /* P entries, degrees that each lobe's tangent is turned by, or NULL: 0 */
} brdffit_model;

/* Set struct_size, one lobe, and zero or NULL elsewhere. NULL is fine: nothing happens. */
#define brdffit_model_init(model) brdffit_model_init_sized((model), sizeof(brdffit_model))
BRDFFIT_API void brdffit_model_init_sized(brdffit_model *model, size_t struct_size);

/* Bits of brdffit_lobe.warnings. */
#define BRDFFIT_WARN_UNRESOLVED 1u /* fewer than 3 effective samples: the directions do not resolve it */
#define BRDFFIT_WARN_FLAT 2u /* the data cannot tell sigma inside [sigma_low, sigma_high] */
#define BRDFFIT_WARN_UNUSED 4u /* its coefficient is zero in every channel */
#define BRDFFIT_WARN_AT_LIMIT 8u /* sigma (the exponent) sits on an end of its range: widen the range */

typedef struct brdffit_lobe {
    double sigma; /* of the optimum; the largest where E^2 is flat */
    double sigma_low; /* E^2 is the optimum's to rounding on [sigma_low, sigma_high]; */
    double sigma_high; /* both equal sigma when the data do identify it */
    double exponent; /* n of the optimum, the smallest where E^2 is flat; sigma = 1/sqrt(n). */
    double exponent_low; /* The same interval in terms of n: from sigma_high */
    double exponent_high; /* to sigma_low. All three 0 where the parameter is sigma */
    double weight; /* w_p: this lobe's share of the sum of all y; 0 if all are zero */
    double effective_samples; /* N_eff = (sum g^2)^2 / sum g^4, at most the samples used */
    unsigned warnings; /* BRDFFIT_WARN_* */
    double sigma_floor; /* what is proven is proven for this lobe's sigma from here to sigma_max, n from exponent_min
                                 to 1 / sigma_floor^2, ends included: see brdffit_result.sigma_floor, the largest. Of an
                                 anisotropic lobe that is said of both its roughnesses; narrower ones, of whose peak no sample
                                 but in the mirror direction sees 1e-7, are not searched */
    double sigma_x; /* along and across the tangent of an anisotropic lobe: sigma = sqrt(sigma_x sigma_y). */
    double sigma_y; /* Of others sigma. Near the optimum, sigma_low and sigma_high go with their ratio */
    double tangent_angle; /* degrees that sigma_x's direction is turned from the samples' tangent; 0 of others */
} brdffit_lobe;

/* Why the search stopped. */
typedef enum brdffit_stop {
    BRDFFIT_STOP_RELATIVE_GAP = 0, /* proven to relative_gap */
    BRDFFIT_STOP_ABSOLUTE_GAP, /* proven to absolute_gap: E^2 is at rounding level */
    BRDFFIT_STOP_RESOLUTION, /* every box left is narrower than sigma_resolution */
    BRDFFIT_STOP_ROUNDING, /* boxes cannot be split further in floating point, or the gap is closed but for
                                      e2_error */
    BRDFFIT_STOP_BUDGET, /* box_budget is used up */
    BRDFFIT_STOP_MEMORY, /* no room even to go on depth first: not with brdffit_workspace_size() bytes */
    BRDFFIT_STOP_CANCELLED, /* the progress callback said so */
    BRDFFIT_STOP_CONTRADICTION, /* the bound came out above e2 by more than e2_error: an error of this library;
                                      nothing is proven, lower_bound is 0 */
    BRDFFIT_STOP_COUNT
} brdffit_stop;

/* Constant snake_case name: "relative_gap", ... */
BRDFFIT_API const char *brdffit_stop_string(brdffit_stop stop);

/*
 * Result of a fit. It and all that it points to lie in the workspace (or in
 * the block of brdffit_fit_new) and live as long as that is not used again.
 * "Units that were minimised" are the data's divided by channel_scale. "E^2"
 * of e2, lower_bound, gap and sum_of_squares is what the norm minimises: for
 * L1 the sum of w |r|, for LINF the largest |r|, not squared.
 */
typedef struct brdffit_result {
    const brdffit_model *model;
    const brdffit_lobe *const *lobe; /* P pointers, in the order of model->sigma */
    const double *channel_scale; /* K divisors, > 0 */
    const double *rms; /* K root mean square (weighted) radiance residuals, data's units */
    double rms_total; /* sqrt(sum w r^2 / (K sum w)) over all channels, whatever the norm; units that were
                                    minimised */
    double e2; /* E^2 of `model` as it is published, sigma, x and y in doubles, on the samples */
    double e2_error; /* how far e2 may be from that, proven: by rounding (some 1e-14 sqrt(e2
                                    sum_of_squares)), by Lafortune lobes where r.v may be 0,
                                    and by what brdffit_fit_sums() does not know */
    double lower_bound; /* proven: no model of this form has a smaller E^2; >= 0 */
    double gap; /* e2 - lower_bound, >= 0 */
    double sum_of_squares; /* E^2 of the zero model */
    double sigma_floor; /* what is proven is proven for sigma in [sigma_floor, sigma_max], ends included, and
                                    the exponent from exponent_min to 1 / sigma_floor^2: sigma_min (exponent_max),
                                    unless no sample is near the mirror direction; then narrower lobes have
                                    coefficients y beyond any double (c_min / sigma^2 above about 710) and are outside
                                    of the model; with SCHLICK, when a second column is below 1e-135 of its largest b (c
                                    of the first sample with w > 0 over sigma^2 above about 310), too. Of several kinds
                                    of lobes, the largest. INFINITY when no lobe of some kind is left */
    double sigma_tail; /* roughness below which the data see no change, so that nothing is searched there
                                    (engine moment and socp, and the norms alike); sigma_min when there is no such
                                    tail */
    double kkt_residual; /* of the coefficients given sigma, relative to the data's norm; L1 and LINF:
                                    largest duality gap of a channel's linear program, proven, relative to its zero
                                    model */
    brdffit_stop stop;
    int certified; /* 1 when stop is a gap, which even e2 + e2_error meets; 0: incumbent and bound are
                                    valid, gap is open (but for BRDFFIT_STOP_CONTRADICTION) */
    size_t boxes; /* bounded by the search */
    size_t nodes; /* one-dimensional evaluations; engine socp, norms L1 and LINF: restricted
                                    problems */
    size_t programs_solved; /* cone programs (L1 and LINF: linear programs) solved by ECOS */
    size_t programs_refused; /* of these, without a certificate that holds: the box was kept */
    size_t programs_decided; /* boxes that needed no program */
    size_t distinct_c; /* samples were merged into this many distinct c */
    size_t channels_zero; /* channels without signal, and channels whose data equal another's: bounds (L2,
                                    engine */
    size_t channels_identical; /* moment) did without them */
    size_t samples_used;
    const size_t *samples_skipped; /* BRDFFIT_SKIP_COUNT counts, by brdffit_skip */
    double e2_free; /* options.physical: e2 of the fit without physical bounds where that breaks them; else e2 */
    size_t channels_at_limit; /* and channels where the bounds hold the coefficients down; else 0 */
    const int *at_limit; /* K: 1 for each of these; NULL without options.physical */
} brdffit_result;

/* ---- Fit and evaluate ------------------------------------------------- */

/*
 * Fit, with malloc: *result is allocated together with its workspace, and is released by brdffit_result_free() (NULL is
 * fine, and so is a result of brdffit_fit(), of which nothing is released). The only functions of the core that
 * allocate. `options` may be NULL (defaults), `error` may be NULL. On failure returns the code, fills *error, and
 * *result is NULL. An early stop of the search is not a failure: see result->stop. Same input, same bits, on every
 * platform.
 */
BRDFFIT_API brdffit_status brdffit_fit_new(const brdffit_samples *samples, const brdffit_options *options,
                                           const brdffit_result **result, brdffit_error *error);
BRDFFIT_API void brdffit_result_free(const brdffit_result *result);

/*
 * Evaluate a model at the directions of `at` (values and weights are not
 * read; at->channels is ignored): out is at->count x model->channels,
 * row-major, f_r or radiance as at->quantity says. Directions on or below
 * the horizon give 0. NaN or infinite input fails with BRDFFIT_ERR_VALUE and
 * nothing useful in out. COEFFICIENTS are those of the model's distribution,
 * and of every lobe; GGX and Beckmann share theirs.
 */
BRDFFIT_API brdffit_status brdffit_eval(const brdffit_model *model, const brdffit_samples *at, double *out,
                                        brdffit_error *error);

/*
 * How well samples tell the F0 of a model with SCHLICK, `model` being that of a fit of these samples with these options
 * (NULL: defaults; max_incidence and absolute_gap are obeyed, the norm must be L2): low and high are K x P row-major, ends
 * of the interval around model->f0 in [0, 1] within which F0 of that lobe and channel alone can be moved, with all
 * coefficients chosen anew and sigma kept, before the channel's E^2 grows by more than 4 E^2 / (N - n), which is two
 * standard errors when residuals are independent noise (N samples used, n columns), or by absolute_gap of its sum of
 * squares where that is more. F0 with wide intervals (beyond 0.5, say) is not told by the directions: v.h hardly varies,
 * and the lobe's two columns are nearly parallel. An estimate, no proof: a sigma that moved along would widen it. Of a
 * lobe with y = 0 the interval is [0, 1]. Fails as brdffit_inspect() for samples; BRDFFIT_ERR_UNSUPPORTED without
 * Fresnel, or for another norm. Takes some microseconds a sample.
 */
BRDFFIT_API brdffit_status brdffit_f0_interval(const brdffit_samples *samples, const brdffit_options *options,
                                               const brdffit_model *model, double *low, double *high,
                                               brdffit_error *error);

/* Bits of brdffit_quality(): the model does not describe these data. */
#define BRDFFIT_MISFIT_POOR 1u /* a channel has R^2 < 0.5, residuals > 0.1 of the data (L2, LINF) */
#define BRDFFIT_MISFIT_PATTERNED 2u /* residuals > 0.02, neighbours foretell > 0.77 of their squares */

/*
 * How good a fit is. fitted: N x K, what brdffit_eval() makes of these samples, in their quantity; options: those of the fit
 * (NULL: defaults; max_incidence and norm are obeyed). With residuals r of radiance I, weights w: r2 (K) holds
 * 1 - sum w r^2 / sum w (I - mean I)^2 of each channel, -INFINITY where I does not vary. total holds, over all channels in
 * units of their largest |I|: the same; sqrt(sum w r^2 / sum w I^2); and the share of squared residuals that those of the
 * four nearest samples foretell, 0 where there are too few (of noise about -0.4, and near 1 of what a model misses).
 * *misfit: 0, or BRDFFIT_MISFIT_POOR | ... Fails as brdffit_inspect(). Some 100 ns a sample and channel, and a millisecond.
 */
BRDFFIT_API brdffit_status brdffit_quality(const brdffit_samples *samples, const brdffit_options *options,
                                           const double *fitted, double *r2, double total[3], unsigned *misfit,
                                           brdffit_error *error);

/*
 * Whether the samples vary with the azimuth of the half vector, as an isotropic model cannot: *share, in [0, 1], is the part
 * of E^2 (norm L2) that a slight stretch of the best suited lobe would take off, to first order and beyond what any two numbers
 * take off as many residuals (theory 7.4). From about a
 * quarter on a fit with options.anisotropic is worth it. 0 of lobes that have no anisotropic form. samples, options and model
 * are those of a fit, the samples in DIRECTIONS; channel_scale is the result's, or NULL. No memory is allocated. Errors:
 * BRDFFIT_ERR_ARGUMENT for NULL, other forms of samples and other channels than the model's, and those of brdffit_inspect().
 */
BRDFFIT_API brdffit_status brdffit_azimuth_share(const brdffit_samples *samples, const brdffit_options *options,
                                                 const brdffit_model *model, const double *channel_scale, double *share,
                                                 brdffit_error *error);

/* ---- Fits in memory of the caller ------------------------------------- */

/*
 * Bytes of workspace that brdffit_fit() needs for `count` samples of
 * `channels` channels. 0 when the options are invalid or the size overflows.
 * Grows linearly with count and with min(box_budget, its internal caps): a
 * search that has filled those goes on depth first, which needs no more, to
 * the end of its budget. Pages that a fit does not need are never touched.
 */
BRDFFIT_API size_t brdffit_workspace_size(size_t count, size_t channels, const brdffit_options *options);

/*
 * Fit. `options` may be NULL (defaults), `error` may be NULL. `workspace` may
 * have any alignment. On success *result points into it. On failure returns
 * the code, fills *error and leaves *result untouched. An early stop of the
 * search is not a failure: see result->stop. Same input, same bits, on every
 * platform.
 */
BRDFFIT_API brdffit_status brdffit_fit(const brdffit_samples *samples, const brdffit_options *options, void *workspace,
                                       size_t workspace_size, const brdffit_result **result, brdffit_error *error);

/* ---- Watching a search ------------------------------------------------ */

/* Phases, in order, as seen by the progress callback. */
typedef enum brdffit_phase {
    BRDFFIT_PHASE_REDUCED = 0, /* samples are reduced to moments; the search starts */
    BRDFFIT_PHASE_SEARCH /* a step of the search is done */
} brdffit_phase;

/* What the progress callback is shown. */
typedef struct brdffit_progress {
    brdffit_phase phase;
    size_t boxes; /* bounded so far */
    double e2; /* best objective so far */
    double lower_bound; /* proven so far */
} brdffit_progress;

/*
 * A box of the search and what was proven of it. Lobes in the order of the result. A box with the same sides for lobes
 * of one distribution stands for its part where their sigma ascend. Where the lobe no longer changes towards small sigma,
 * the box at the end reaches down to the result's sigma_floor.
 */
typedef struct brdffit_box {
    int lobes; /* P */
    int level; /* times that its sides were halved (in ln sigma) since the first partition, sum over
                                 lobes */
    const double *sigma_low; /* P sides each; 1/sqrt(n) where the parameter is the exponent n */
    const double *sigma_high;
    double lower_bound; /* proven: no model with its roughness in the box has a smaller E^2 (units of
                                 result->e2). Once this closes the box, it is made no tighter */
} brdffit_box;

/* ---- Many fits of one geometry: whole maps ---------------------------- */

/*
 * All that depends on the geometry (lights, views, weights) and the options but not on the values: made once, in
 * the caller's memory, by brdffit_plan_init(); never changed afterwards, so any number of threads may share one.
 * It points into itself: it must stay where it was made.
 */
typedef struct brdffit_plan brdffit_plan;

/*
 * Bytes that brdffit_plan_init() needs; 0 when the arguments are invalid or the size overflows. `geometry` is a
 * brdffit_samples whose `values` are not looked at (NULL is fine); weights are obeyed. `options` may be NULL
 * (defaults); its progress callback is not called by brdffit_fit_many().
 */
BRDFFIT_API size_t brdffit_plan_size(const brdffit_samples *geometry, const brdffit_options *options);

/*
 * Make a plan at the start of `memory` (any alignment). Keeps copies: the arrays of `geometry` may go afterwards.
 * Fails as brdffit_fit() would, but for values: BRDFFIT_ERR_NO_SAMPLES, BRDFFIT_ERR_VALUE (with the sample) ...
 * *plan points into `memory` on success and is untouched on failure.
 */
BRDFFIT_API brdffit_status brdffit_plan_init(const brdffit_samples *geometry, const brdffit_options *options,
                                             void *memory, size_t size, const brdffit_plan **plan,
                                             brdffit_error *error);

/* Bytes of workspace that brdffit_fit_many() needs, for each thread; the same for any number of texels. */
BRDFFIT_API size_t brdffit_many_workspace_size(const brdffit_plan *plan);

/* Element type of brdffit_texels.values, in the machine's byte order, aligned as the type asks for. */
typedef enum brdffit_type {
    BRDFFIT_TYPE_DOUBLE = 0,
    BRDFFIT_TYPE_FLOAT, /* 32 bits */
    BRDFFIT_TYPE_UINT16,
    BRDFFIT_TYPE_COUNT
} brdffit_type;

/*
 * Measured values of many texels; all arrays belong to the caller and are only read. Element
 * texel * texel_stride + sample * sample_stride + channel * channel_stride of `values`, times `scale`, is what
 * brdffit_samples.values would hold. So an image stack (sample, y, x, channel) has strides channels,
 * height * width * channels and 1, and an array (texel, sample, channel) has samples * channels, channels and 1.
 * brdffit_texels_init() sets the latter for a plan, scale 1, doubles and no mask.
 */
typedef struct brdffit_texels {
    size_t struct_size;
    size_t count;
    const void *values;
    brdffit_type type;
    double scale; /* finite and > 0 */
    ptrdiff_t texel_stride; /* these three in elements; any sign */
    ptrdiff_t sample_stride;
    ptrdiff_t channel_stride;
    const unsigned char *mask; /* count; 0: skip this texel and do not look at its values. NULL: use all */
} brdffit_texels;

/* As said above; zero strides when `plan` is NULL. NULL for `texels` is fine: nothing happens. */
#define brdffit_texels_init(texels, plan) brdffit_texels_init_sized((texels), sizeof(brdffit_texels), (plan))
BRDFFIT_API void brdffit_texels_init_sized(brdffit_texels *texels, size_t struct_size, const brdffit_plan *plan);

/* What became of a texel. */
typedef enum brdffit_texel_status {
    BRDFFIT_TEXEL_CERTIFIED = 0, /* E^2 and bound within relative_gap or absolute_gap */
    BRDFFIT_TEXEL_OPEN, /* the search stopped early (`stop` says why): incumbent and bound are valid */
    BRDFFIT_TEXEL_NO_SIGNAL, /* every used value is zero: so is the model, and that is certified */
    BRDFFIT_TEXEL_MASKED, /* not looked at */
    BRDFFIT_TEXEL_BAD_VALUE, /* a used value is NaN or infinite: `where` says which */
    BRDFFIT_TEXEL_REFUSED, /* values that brdffit_fit() would refuse otherwise, e.g. all below 1e-304 */
    BRDFFIT_TEXEL_STATUS_COUNT
} brdffit_texel_status;

/* Constant snake_case name: "certified", "open", "no_signal", "masked", "bad_value", "refused". */
BRDFFIT_API const char *brdffit_texel_status_string(brdffit_texel_status status);

/*
 * Results, texel by texel in the order of the input; K channels, P lobes. Arrays belong to the caller; NULL: not
 * wanted. A texel that was not fitted (masked, bad value, refused) gets NaN in every floating-point array; one
 * without signal gets zero coefficients and the largest sigma. Units and meaning are those of brdffit_result, with
 * the texel's own channel_scale.
 */
typedef struct brdffit_texel_results {
    size_t struct_size;
    double *sigma; /* count x P, in the order of a result's */
    double *x; /* count x K */
    double *y; /* count x K x P */
    double *channel_scale; /* count x K */
    double *e2; /* count */
    double *lower_bound; /* count; proven */
    double *sum_of_squares; /* count; E^2 of the zero model */
    unsigned char *status; /* count; brdffit_texel_status */
    unsigned char *stop; /* count; brdffit_stop, of texels that are CERTIFIED or OPEN; else >= BRDFFIT_STOP_COUNT */
    size_t *where; /* count; BAD_VALUE: sample * K + channel; else BRDFFIT_NONE */
    size_t *boxes; /* count; bounded by the search */
    double *sigma_floor; /* count; of what lower_bound is proven for, as in brdffit_result or lower */
    double *f0; /* count x K x P; zeros without Fresnel */
    double *x_more; /* count x K x (columns - 1), of the diffuse term's further columns; of no width where it has one */
} brdffit_texel_results;

/* Zero: every array NULL. NULL is fine: nothing happens. */
#define brdffit_texel_results_init(results) brdffit_texel_results_init_sized((results), sizeof(brdffit_texel_results))
BRDFFIT_API void brdffit_texel_results_init_sized(brdffit_texel_results *results, size_t struct_size);

/*
 * Certified fits of many texels that share the plan's geometry. Each texel is a fit of its own, as brdffit_fit()
 * would make it: same objective, same gaps, its own proof. Norm L2 with engine moment and one lobe of any
 * distribution, masking and Fresnel, beside Lambert's term, runs several texels at a time and takes what only depends on the
 * geometry from the plan; all else, and texels that resist, take the path of brdffit_fit(). A bad texel never stops the batch.
 *
 * A texel's result depends on its own data and the plan alone: not on its neighbours, the order, the size of the
 * batch, the thread or the instruction set; the bits are the same. No allocation (but for ECOS, where the options
 * ask for it), no threads: split the texels among your own, each with a workspace. On failure, which only comes
 * from arguments, results are untouched. `stats` (see Counters) and `error` may be NULL.
 */
struct brdffit_many_stats;
BRDFFIT_API brdffit_status brdffit_fit_many(const brdffit_plan *plan, const brdffit_texels *texels,
                                            const brdffit_texel_results *results, void *workspace,
                                            size_t workspace_size, struct brdffit_many_stats *stats,
                                            brdffit_error *error);

/* ---- Sums: samples that are not kept ---------------------------------- */

/*
 * All that a least-squares fit needs to know of any number of samples, added up as they come: a goniometer that
 * streams, a table that is larger than memory. Lives in the caller's memory, of a size that does not depend on the
 * number of samples; no two threads may share one. Belongs to the distribution, max_incidence and isa of the options
 * that it was made with; norm must be L2. Samples of equal c share a group, and there is room for so many groups.
 *
 * Sums have a smaller range than samples: weights and b, where not 0, must be in [1e-50, 1e50], values and a at most
 * 1e100 (BRDFFIT_ERR_VALUE names the one that is not). brdffit_fit() has no such limits.
 */
typedef struct brdffit_sums brdffit_sums;

/* Bytes of memory for `groups` distinct c, 0 when that overflows or an argument is 0. */
BRDFFIT_API size_t brdffit_sums_size(size_t channels, size_t groups);

/*
 * Start with no samples, in `memory` of that size and any alignment. `options` may be NULL (defaults), `error` may be
 * NULL. *sums points into the memory, which must not move, and needs no release.
 */
BRDFFIT_API brdffit_status brdffit_sums_init(void *memory, size_t size, size_t channels, size_t groups,
                                             const brdffit_options *options, brdffit_sums **sums, brdffit_error *error);

/*
 * From here on, put samples into bins of c instead of one group per distinct c: for millions of distinct c. To be
 * called before any sample is added; exponential lobes only (all but GGX: BRDFFIT_ERR_UNSUPPORTED). The smallest
 * BRDFFIT_SUMS_EXACT distinct c (an eighth of the groups, if fewer) keep groups of their own; each other sample is
 * shared between the two nodes around its c, 2^bits nodes an octave, 1 <= bits <= 20. Groups that this takes: those,
 * and up to 2^bits for each octave from there to the largest c, however many samples there are.
 *
 * What brdffit_fit_sums() then claims is about the samples: lower_bound is proven for them, and their own E^2 at the
 * model is within e2_error of e2. `certified` says that even e2 + e2_error meets the gap; when only the bins are too
 * coarse for that, stop is BRDFFIT_STOP_ROUNDING. The errors fall like 4^-bits. Progress, the lobes' flat intervals and
 * effective_samples are those of the binned samples; options.box must be NULL; rows are refused (they need no bins).
 */
#define BRDFFIT_SUMS_EXACT 256
BRDFFIT_API brdffit_status brdffit_sums_bins(brdffit_sums *sums, int bits, brdffit_error *error);

/*
 * Add samples of any form and quantity, checked and skipped as by brdffit_fit(). When one is at fault, error->sample is
 * its index in `samples`, and those before it have been added. BRDFFIT_ERR_WORKSPACE: more distinct c than groups.
 */
BRDFFIT_API brdffit_status brdffit_sums_add(brdffit_sums *sums, const brdffit_samples *samples, brdffit_error *error);

/*
 * The cells of a table in half/difference angles that share theta_h: f_r at differences x azimuths cells, cell (d, p)
 * at index p + azimuths d, with
 *
 *     n.l, n.v = cos_half cos_difference[d] -+ sin_half sin_difference[d] cos_azimuth[p]      v.h = cos_difference[d]
 *
 * A cell with n.l or n.v <= horizon is not looked at but for NaN; one with a negative entry in any channel is absent,
 * that is, not measured.
 */
typedef struct brdffit_row {
    size_t struct_size;
    size_t differences, azimuths;
    double sin_half, cos_half; /* >= 0; tan^2 alpha is (sin_half / cos_half)^2 */
    double horizon; /* >= 0 */
    const double *sin_difference, *cos_difference; /* differences each, in [0, 1] */
    const double *cos_azimuth; /* azimuths, in [-1, 1] */
    const void *const *entries; /* per channel, differences x azimuths doubles of any alignment (a mapped file) */
    const double *scale; /* per channel: f_r = entry * scale; > 0 */
} brdffit_row;

/* Set struct_size, and zero elsewhere. NULL is fine: nothing happens. */
#define brdffit_row_init(row) brdffit_row_init_sized((row), sizeof(brdffit_row))
BRDFFIT_API void brdffit_row_init_sized(brdffit_row *row, size_t struct_size);

/* What became of the cells of a row. There will be no more of these. */
typedef enum brdffit_cell {
    BRDFFIT_CELL_SAMPLE = 0, /* a sample, which the sums use or skip (incidence) */
    BRDFFIT_CELL_BELOW_HORIZON,
    BRDFFIT_CELL_ABSENT,
    BRDFFIT_CELL_COUNT
} brdffit_cell;

/*
 * Add a row in one sweep, as fast as memory delivers it. `cells` (may be NULL) is incremented. On failure nothing of
 * the row is added: BRDFFIT_ERR_VALUE with error->sample and channel for an entry that is not finite (of any cell) or
 * beyond the range of sums; BRDFFIT_ERR_UNSUPPORTED for LAFORTUNE, whose c differs from cell to cell;
 * BRDFFIT_ERR_WORKSPACE as above.
 */
BRDFFIT_API brdffit_status brdffit_sums_add_row(brdffit_sums *sums, const brdffit_row *row,
                                                size_t cells[BRDFFIT_CELL_COUNT], brdffit_error *error);

/* Largest used radiance of a channel so far, 0 when none is positive. */
BRDFFIT_API double brdffit_sums_largest(const brdffit_sums *sums, size_t channel);

/* As brdffit_workspace_size(), for the groups that there are by now: it grows with them, up to all. */
BRDFFIT_API size_t brdffit_sums_workspace_size(const brdffit_sums *sums, const brdffit_options *options);

/*
 * Fit what was added, as brdffit_fit() would (engine moment only; its other ways need the samples:
 * BRDFFIT_ERR_UNSUPPORTED). The sums are only read: more can be added, and they can be fitted again with other lobes,
 * ranges and gaps. e2 is known to within e2_error of the result, a few 1e-13 of sum_of_squares: when that is too much,
 * the model fits to rounding, and only brdffit_fit() can tell how well.
 */
BRDFFIT_API brdffit_status brdffit_fit_sums(const brdffit_sums *sums, const brdffit_options *options, void *workspace,
                                            size_t workspace_size, const brdffit_result **result, brdffit_error *error);

/* ---- A bound verified ------------------------------------------------- */

/* What brdffit_verify() found. */
typedef struct brdffit_verification {
    double level; /* of E^2, as asked for */
    int proven; /* 1: every leaf of a covering of the domain is discarded, so no model has a smaller E^2 */
    brdffit_stop stop; /* when not proven, why it ended: budget, memory, cancelled, resolution or rounding */
    size_t boxes; /* bounded */
    size_t leaves; /* of these, discarded with a proof: disjoint, and all of the domain when proven */
    size_t solved; /* cone programs solved by ECOS */
    size_t refused; /* of these, without a certificate that holds: the box was split instead */
    size_t decided; /* boxes that needed no cone program */
    double unproven; /* share of the domain (by ln s, each pair of lobes once) that is not discarded; 0 if
                          proven */
} brdffit_verification;

/*
 * Verify, by engine socp alone, that no model of this form has an E^2 below `level` (finite, > 0): the domain is split
 * into boxes until ECOS's dual certificates, checked by our own arithmetic, discard each of them at that fixed level.
 * No optimum is looked for and nothing is taken over from an earlier search. Meant for the lower_bound of a fit with
 * engine moment, times 1 - margin: bounds of first order need boxes of a width that falls with the distance between
 * level and optimum: about margin^-1/2 of them with one lobe, and at least margin^-1 with two (84 samples: a few
 * thousand at 10 %, 25 times as many at 1 %). What is proven is the level in *verification and no more. A level above
 * the true optimum is never proven.
 *
 * Options are those of the fit; engine is ignored, box_budget, sigma_resolution, socp_every_box and progress (whose e2
 * is the level) are obeyed; the gaps are not used. norm must be L2. The workspace is of brdffit_workspace_size() with
 * options.engine = BRDFFIT_ENGINE_SOCP, and not the one that a result still lies in; on success *verification points
 * into it, and on failure it is untouched: BRDFFIT_ERR_VALUE for the level, BRDFFIT_ERR_UNSUPPORTED without ECOS.
 * Ending unproven is not a failure.
 */
BRDFFIT_API brdffit_status brdffit_verify(const brdffit_samples *samples, const brdffit_options *options, double level,
                                          void *workspace, size_t workspace_size,
                                          const brdffit_verification **verification, brdffit_error *error);

/* ---- Counters --------------------------------------------------------- */

/* Why samples were not used; each sample is counted under the first that holds. There may come more. */
typedef enum brdffit_skip {
    BRDFFIT_SKIP_ZERO_WEIGHT = 0,
    BRDFFIT_SKIP_LIGHT_BELOW_HORIZON, /* n.l <= 0 */
    BRDFFIT_SKIP_VIEW_BELOW_HORIZON, /* n.v <= 0 */
    BRDFFIT_SKIP_INCIDENCE, /* light further from the normal than max_incidence */
    BRDFFIT_SKIP_COUNT
} brdffit_skip;

/* Constant snake_case name: "zero_weight", "light_below_horizon", ... */
BRDFFIT_API const char *brdffit_skip_string(brdffit_skip reason);

/*
 * What brdffit_fit() would use: validates options and each sample like it (limits on the data as a whole, such as how
 * far b may span, are left to the fit), counts used samples and those skipped under each reason. `skipped` has room for
 * `reasons` counts (BRDFFIT_SKIP_COUNT); both it and `used` may be NULL. Having no samples left is
 * BRDFFIT_ERR_NO_SAMPLES here too, with the counts filled in.
 */
BRDFFIT_API brdffit_status brdffit_inspect(const brdffit_samples *samples, const brdffit_options *options, size_t *used,
                                           size_t *skipped, size_t reasons, brdffit_error *error);

/* Samples seen so far: `used` and `skipped`, with room for `reasons` counts, as of brdffit_inspect(). */
BRDFFIT_API void brdffit_sums_count(const brdffit_sums *sums, size_t *used, size_t *skipped, size_t reasons);

/* What brdffit_fit_many() did, and did not need to. Counts are added to what the struct holds; init zeroes them. */
typedef struct brdffit_many_stats {
    size_t struct_size;
    size_t texels; /* the sum of the next three lines */
    size_t certified, open;
    size_t masked, no_signal, bad_value, refused;
    size_t equal; /* data equal those of the texel before, bit for bit: its result was copied */
    size_t general; /* certified or open texels that took the path of brdffit_fit() */
    size_t zero_channels; /* channels without signal of texels that have some */
    size_t equal_channels; /* channels that repeat an earlier one of their texel, bit for bit */
    size_t boxes; /* bounded */
    size_t nodes; /* evaluations of the restricted problem, or of its sums, at one roughness */
    size_t one_lobe_enough; /* two lobes fitted, and the best single lobe is within the gap of their bound
                                already */
} brdffit_many_stats;

/* Zero. NULL is fine: nothing happens. */
#define brdffit_many_stats_init(stats) brdffit_many_stats_init_sized((stats), sizeof(brdffit_many_stats))
BRDFFIT_API void brdffit_many_stats_init_sized(brdffit_many_stats *stats, size_t struct_size);

/* ---- How sure: intervals of every parameter ---------------------------- */

/* What brdffit_intervals() is asked for. Zero stands for the default of each. */
typedef struct brdffit_interval_options {
    size_t struct_size;
    double level; /* of likelihood intervals, in (0, 1 - 1e-9]. Default 0.95 */
    double noise; /* > 0: standard deviation of the noise of a sample of weight 1, in the units that were minimised
                     (the data's divided by channel_scale). 0: estimated from e2 */
    double eta; /* > 0: all models with E^2 <= (1 + eta) e2 instead; level and noise are not used */
    double tolerance; /* an end is proven to this share of its distance from the fitted value, where the budget allows;
                         in (0, 1]. Default 0.02 */
    size_t box_budget; /* most boxes for each end. Default 20000 */
} brdffit_interval_options;

/* Zero but for struct_size. NULL is fine: nothing happens. */
#define brdffit_interval_options_init(options)                                                                         \
    brdffit_interval_options_init_sized((options), sizeof(brdffit_interval_options))
BRDFFIT_API void brdffit_interval_options_init_sized(brdffit_interval_options *options, size_t struct_size);

/* Bits of brdffit_range.flags. */
#define BRDFFIT_INTERVAL_LOW_END 1u /* reaches the low end of what the model allows: the data set no limit there */
#define BRDFFIT_INTERVAL_HIGH_END 2u /* the high end likewise; INFINITY where a coefficient has none */
/* The budget (or memory) ended before an end was proven to the tolerance: still proven, but wider than it need be. */
#define BRDFFIT_INTERVAL_OPEN 4u

/* One parameter's interval, proven, and what was found inside of it. */
typedef struct brdffit_range {
    double low; /* proven: no model with E^2 <= threshold has the parameter outside of [low, high] */
    double high;
    double inner_low; /* some model with E^2 <= threshold, to rounding, has this; low <= inner_low */
    double inner_high; /* likewise; inner_high <= high */
    size_t flags; /* BRDFFIT_INTERVAL_* */
} brdffit_range;

/* Lies in the workspace. K channels, P lobes in the order of a result, F columns of the diffuse term. */
typedef struct brdffit_interval_result {
    double threshold; /* of E^2, in the units of e2 */
    double e2; /* as it was given */
    double level; /* as it was used; 0 with eta */
    double noise; /* likewise: given, or sqrt(e2 / degrees); 0 with eta */
    double degrees; /* effective samples times channels less parameters; 0 unless noise was estimated */
    const brdffit_range *sigma; /* P; reaches from sigma_floor to sigma_max at most */
    const brdffit_range *exponent; /* P; zero where the parameter is sigma */
    const brdffit_range *x; /* K x F row-major, in the data's units */
    const brdffit_range *y; /* K x P row-major, likewise */
    const brdffit_range *f0; /* K x P row-major; NULL without Fresnel. [0, 1], both flags: the data cannot tell */
    size_t boxes; /* bounded in all */
    int lobes;
    int diffuse_columns;
    size_t channels;
    int complete; /* 1 when no interval is OPEN */
    int stopped; /* 1 when the progress callback said so; what was not done yet reaches to its ends */
} brdffit_interval_result;

/* Bytes of workspace; 0 as of brdffit_workspace_size(). */
BRDFFIT_API size_t brdffit_intervals_workspace_size(size_t count, size_t channels, const brdffit_options *options);

/*
 * Intervals of every parameter over the models that are nearly as good as the best one: {E^2 <= threshold}, with all other
 * parameters free. `model` and `e2` are those of a fit of the same samples with the same options (brdffit_result.model and
 * e2), and threshold is
 *
 *     (1 + eta) e2                     where eta is given, or
 *     e2 + q(level) noise^2            with q the quantile of chi-squared of one degree of freedom (3.84 for 0.95).
 *
 * The intervals are exact statements about the data and this threshold, whatever the noise is like. That a threshold of
 * the second kind makes a profile-likelihood interval of that level is the usual approximation for independent Gaussian
 * noise of equal variance (over weight). The noise is estimated as e2 / (N_eff K - parameters), N_eff = (sum w)^2 / sum w^2
 * over used samples; with no more data than parameters that is BRDFFIT_ERR_VALUE, and noise or eta has to be given.
 *
 * Each end is a search of its own over roughness, with the bounds of engine moment (theory 7.10). Lobes of one distribution
 * can be exchanged: intervals are those of the ordered ones. Norm L2 and engine moment only: others are BRDFFIT_ERR_UNSUPPORTED.
 * The workspace is not the one that the model lies in. Of the options' callbacks only progress is called: e2 as given, lower_bound the
 * threshold. `interval_options` may be NULL. On failure *result is untouched.
 */
BRDFFIT_API brdffit_status brdffit_intervals(const brdffit_samples *samples, const brdffit_options *options,
                                             const brdffit_model *model, double e2,
                                             const brdffit_interval_options *interval_options, void *workspace,
                                             size_t workspace_size, const brdffit_interval_result **result,
                                             brdffit_error *error);

#ifdef __cplusplus
}
#endif
#endif
