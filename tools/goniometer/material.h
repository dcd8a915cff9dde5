/* material.h: materials whose reflectance is known exactly.
 *
 * The formulas are written out from the literature and share nothing with
 * the library, so that a fit of these files tests it. f_r is in 1/sr.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_GONIO_MATERIAL_H
#define BRDFFIT_GONIO_MATERIAL_H

#define GONIO_CHANNELS 3

enum gonio_model {
    GONIO_TWO_BECKMANN, /* the model of brdffit.h with two lobes */
    GONIO_GGX_FRESNEL,  /* GGX, Smith shadowing, Schlick's Fresnel: no sum of lobes fits it */
    GONIO_ROUGH_MATTE   /* Oren and Nayar's qualitative model */
};

struct gonio_material {
    enum gonio_model model;
    const char *description;
    double sigma[2];             /* TWO_BECKMANN: roughness; GGX: alpha; MATTE: sigma in radians */
    double x[GONIO_CHANNELS];    /* diffuse coefficient, or albedo */
    double y[GONIO_CHANNELS][2]; /* TWO_BECKMANN: specular; GGX: y[k][0] is F0 */
};

extern const struct gonio_material brdffit_gonio_satin;
extern const struct gonio_material brdffit_gonio_metal;
extern const struct gonio_material brdffit_gonio_matte;

/* f_r of one channel for unit vectors above the horizon, normal +z. */
double brdffit_gonio_brdf(const struct gonio_material *material, int channel, const double light[3],
                          const double view[3]);

#endif
