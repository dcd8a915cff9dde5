/*
 * Options: defaults and ranges. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "fit/fit.h"
#include "base/error.h"
#include "model/geometry.h"
#include "base/intake.h"
#include "base/isa.h"
#include "base/tolerance.h"

void brdffit_options_init_sized(brdffit_options *options, size_t struct_size)
{
    static const brdffit_options defaults = {
        .lobes = 1,
        .distribution = BRDFFIT_BECKMANN,
        .norm = BRDFFIT_NORM_L2,
        .engine = BRDFFIT_ENGINE_MOMENT,
        .normalise = BRDFFIT_NORMALISE_MAX,
        .sigma_min = 1e-12,
        .sigma_max = 6.0,
        .exponent_min = 0.1,
        .exponent_max = 1e7,
        .relative_gap = 1e-3,
        .absolute_gap = 1e-12,
        .sigma_resolution = 0.0,
        .box_budget = 1000000,
        .max_incidence = 60.0,
    };

    intake_init(options, struct_size, &defaults, sizeof defaults);
}

static brdffit_status bad(brdffit_error *error, const char *message, double value)
{
    (void)brdffit_fail(error, BRDFFIT_ERR_OPTION, message);
    if (error) {
        error->value = value;
    }
    return BRDFFIT_ERR_OPTION;
}

/* What a copy of the library may be without (tools/amalgamate). */
static brdffit_status check_parts(const brdffit_options *o, brdffit_error *error)
{
    int p;

    for (p = 0; p < o->lobes; p++) {
        if (!brdffit_lobe_kind_of(brdffit_model_asked(o, p))) {
            return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED,
                                "this copy of the library is without that distribution");
        }
    }
#ifdef BRDFFIT_WITHOUT_ANISOTROPIC
    if (o->anisotropic) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "this copy of the library is without anisotropic lobes");
    }
#endif
    if (o->anisotropic && o->lobes <= 2 && o->lobes + 1 > SIDES_MOST) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED,
                            "this copy of the library has no room for that many roughnesses");
    }
    if (brdffit_diffuse_columns(o->diffuse) > FIXED_MOST || (o->fresnel ? 2 : 1) > EACH_MOST) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED,
                            "this copy of the library is without Fresnel, or without that diffuse term");
    }
    return BRDFFIT_OK;
}

static brdffit_status check_choices(const brdffit_options *o, brdffit_error *error)
{
    int p;

    if (!(o->lobes >= 1 && o->lobes <= BRDFFIT_MAX_LOBES)) {
        return bad(error,
                   BRDFFIT_MAX_LOBES > 2   ? "lobes must be 1, 2 or 3"
                   : BRDFFIT_MAX_LOBES > 1 ? "lobes must be 1 or 2"
                                           : "lobes must be 1",
                   o->lobes);
    }
    for (p = 0; p < o->lobes; p++) {
        brdffit_distribution distribution = brdffit_model_asked(o, p);

        if (!((unsigned)distribution < BRDFFIT_DISTRIBUTION_COUNT)) {
            return bad(error, "unknown distribution", (double)distribution);
        }
    }
    if (!((unsigned)o->engine < BRDFFIT_ENGINE_COUNT)) {
        return bad(error, "unknown engine", (double)o->engine);
    }
    if (!((unsigned)o->norm < BRDFFIT_NORM_COUNT)) {
        return bad(error, "unknown norm", (double)o->norm);
    }
    if (!((unsigned)o->fresnel < BRDFFIT_FRESNEL_COUNT)) {
        return bad(error, "unknown Fresnel term", (double)o->fresnel);
    }
    if (!((unsigned)o->diffuse < BRDFFIT_DIFFUSE_COUNT)) {
        return bad(error, "unknown diffuse term", (double)o->diffuse);
    }
    if (!((unsigned)o->masking < BRDFFIT_MASKING_COUNT)) {
        return bad(error, "unknown masking", (double)o->masking);
    }
    if (check_parts(o, error) != BRDFFIT_OK) {
        return BRDFFIT_ERR_UNSUPPORTED;
    }
    for (p = 0; p < o->lobes; p++) {
        if (!brdffit_lobe_kind_masked(brdffit_model_asked(o, p), o->masking)) {
            return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "masking is that of Beckmann and GGX lobes only");
        }
    }
    if (brdffit_diffuse_columns(o->diffuse) + o->lobes * (o->fresnel ? 2 : 1) > COLUMNS_MOST) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "lobes, Fresnel and diffuse terms: more than 7 columns");
    }
    if (o->normalise != BRDFFIT_NORMALISE_MAX && o->normalise != BRDFFIT_NORMALISE_NONE) {
        return bad(error, "unknown channel normalisation", (double)o->normalise);
    }
    if (!((unsigned)o->isa < BRDFFIT_ISA_COUNT)) {
        return bad(error, "unknown instruction set", (double)o->isa);
    }
    if (!brdffit_isa_supported(o->isa)) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "this build or processor has no such instruction set");
    }
    if (ieee_contracts() || brdffit_kernels(o->isa)->contracts()) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED,
                            "the library was compiled with multiply-adds: compile it with -ffp-contract=off");
    }
    return BRDFFIT_OK;
}

/* An anisotropic lobe, where it is asked for. */
static brdffit_status check_anisotropic(const brdffit_options *o, brdffit_error *error)
{
    if (!(o->anisotropic == 0 || o->anisotropic == 1)) {
        return bad(error, "anisotropic must be 0 or 1", o->anisotropic);
    }
    if (!(o->anisotropy == 0.0 || (o->anisotropy >= 1.0 / ANISOTROPY_MOST && o->anisotropy <= ANISOTROPY_MOST))) {
        return bad(error, "anisotropy must be 0 or in [1e-6, 1e6]", o->anisotropy);
    }
    if (!(fabs(o->tangent_angle) <= 360.0)) {
        return bad(error, "tangent_angle must be in [-360, 360] degrees", o->tangent_angle);
    }
    if (!o->anisotropic) {
        return BRDFFIT_OK;
    }
    if (!brdffit_turn_known(brdffit_model_asked(o, 0)) || o->lobes > 2) {
        return brdffit_fail(
            error, BRDFFIT_ERR_UNSUPPORTED,
            "an anisotropic lobe is Beckmann, GGX, Ward or Ashikhmin-Shirley, beside one other at most");
    }
    if (o->norm != BRDFFIT_NORM_L2 || o->engine != BRDFFIT_ENGINE_MOMENT || o->physical ||
        !(o->masking == BRDFFIT_MASKING_V_CAVITY || o->masking == BRDFFIT_MASKING_NONE)) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED,
                            "an anisotropic lobe goes with norm l2, engine moment, masking v-cavity or none, and "
                            "without physical bounds");
    }
    return BRDFFIT_OK;
}

/* Physical bounds, where they are asked for. */
static brdffit_status check_physical(const brdffit_options *o, brdffit_error *error)
{
    int p;

    if (!(o->physical == 0 || o->physical == 1)) {
        return bad(error, "physical must be 0 or 1", o->physical);
    }
    if (o->physical && (o->norm != BRDFFIT_NORM_L2 || o->engine != BRDFFIT_ENGINE_MOMENT)) {
        return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED, "physical bounds are those of norm l2 and engine moment");
    }
    for (p = 0; p < o->lobes && o->physical; p++) {
        if (!(brdffit_lobe_kind_of(brdffit_model_asked(o, p))->reflectance > 0.0)) {
            return brdffit_fail(error, BRDFFIT_ERR_UNSUPPORTED,
                                "Torrance-Sparrow lobes are not normalised: they have no physical bounds");
        }
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_options_check(const brdffit_options *o, brdffit_error *error)
{
    brdffit_status status = check_choices(o, error);

    if (status == BRDFFIT_OK) {
        status = check_physical(o, error);
    }
    if (status == BRDFFIT_OK) {
        status = check_anisotropic(o, error);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (!(o->sigma_min >= LIMIT_SIGMA_MIN && o->sigma_min <= LIMIT_SIGMA_MAX)) {
        return bad(error, "sigma_min must be in [1e-12, 1e3]", o->sigma_min);
    }
    if (!(o->sigma_max >= o->sigma_min && o->sigma_max <= LIMIT_SIGMA_MAX)) {
        return bad(error, "sigma_max must be in [sigma_min, 1e3]", o->sigma_max);
    }
    if (!(o->exponent_min >= LIMIT_EXPONENT_MIN && o->exponent_min <= LIMIT_EXPONENT_MAX)) {
        return bad(error, "exponent_min must be in [1e-6, 1e24]", o->exponent_min);
    }
    if (!(o->exponent_max >= o->exponent_min && o->exponent_max <= LIMIT_EXPONENT_MAX)) {
        return bad(error, "exponent_max must be in [exponent_min, 1e24]", o->exponent_max);
    }
    if (!(o->relative_gap > 0.0 && isfinite(o->relative_gap))) {
        return bad(error, "relative_gap must be positive and finite", o->relative_gap);
    }
    if (!(o->absolute_gap >= 0.0 && isfinite(o->absolute_gap))) {
        return bad(error, "absolute_gap must be finite and not negative", o->absolute_gap);
    }
    if (!(o->sigma_resolution >= 0.0 && isfinite(o->sigma_resolution))) {
        return bad(error, "sigma_resolution must be finite and not negative", o->sigma_resolution);
    }
    if (!(o->box_budget >= 1)) {
        return bad(error, "box_budget must be at least 1", (double)o->box_budget);
    }
    if (!(o->max_incidence > 0.0)) {
        return bad(error, "max_incidence must be positive degrees", o->max_incidence);
    }
    return BRDFFIT_OK;
}
