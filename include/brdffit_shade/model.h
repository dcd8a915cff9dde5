/*
 * A fitted model, made ready for shading: evaluation, densities, draws, albedos. No guard: once for float, once for double.
 * SPDX-License-Identifier: MIT
 *
 * f_r (n.l) is a sum of columns with non-negative coefficients (docs/theory.md 7.2): those of the diffuse term, and of each lobe
 * g and g (1 - v.h)^5. Their albedos at BRDFFIT_SHADE_NODES cosines of the viewer, (1 / N) sum column / density over
 * draws (make.h), are all that a material has beside its numbers.
 */

struct FN(lobe) {
    int distribution, masking;
    REAL s; /* 1 / sigma^2, or n */
    REAL plain[BRDFFIT_SHADE_CHANNELS], grazing[BRDFFIT_SHADE_CHANNELS]; /* y F0 and y (1 - F0); y and 0 */
};

/* The structure that users hold. */
struct SHADE_MODEL {
    int lobes, channels, diffuse, schlick;
    struct FN(lobe) lobe[BRDFFIT_SHADE_LOBES];
    REAL x[3][BRDFFIT_SHADE_CHANNELS];
    REAL albedo[BRDFFIT_SHADE_COLUMNS][BRDFFIT_SHADE_NODES];
    REAL share[BRDFFIT_SHADE_LOBES + 1][BRDFFIT_SHADE_NODES]; /* of draws: each lobe, and the diffuse term */
};

/* ---- A lobe of any kind ------------------------------------------------ */

/* Folds to one formula where the kind is a constant. */
SHADE_INLINE REAL FN(lobe_at)(int distribution, int masking, REAL s, struct FN(angles) a)
{
    REAL normals;

    switch (distribution) {
    case BRDFFIT_SHADE_TORRANCE_SPARROW: return FN(torrance_sparrow)(a, s);
    case BRDFFIT_SHADE_WARD: return FN(ward)(a, s);
    case BRDFFIT_SHADE_BLINN_PHONG: return FN(blinn_phong)(a, s);
    case BRDFFIT_SHADE_ASHIKHMIN_SHIRLEY: return FN(ashikhmin_shirley)(a, s);
    case BRDFFIT_SHADE_LAFORTUNE: return FN(lafortune)(a, s);
    case BRDFFIT_SHADE_RETRO: return FN(retro)(a, s);
    default: break;
    }
    normals = distribution == BRDFFIT_SHADE_GGX ? FN(ggx)(a, s) : FN(beckmann)(a, s);
    if (masking == BRDFFIT_SHADE_SMITH || masking == BRDFFIT_SHADE_SMITH_SEPARABLE) {
        int ggx = distribution == BRDFFIT_SHADE_GGX;
        REAL l = ggx ? FN(side_ggx)(a.nl, a.sin2_l, s) : FN(side_beckmann)(a.nl, a.sin2_l, s);
        REAL v = ggx ? FN(side_ggx)(a.nv, a.sin2_v, s) : FN(side_beckmann)(a.nv, a.sin2_v, s);

        return normals * (masking == BRDFFIT_SHADE_SMITH ? FN(smith)(a, l, v) : FN(smith_separable)(a, l, v));
    }
    return normals * (masking == BRDFFIT_SHADE_V_CAVITY ? FN(v_cavity)(a) : LIT(1.0) / a.nv);
}

/* Density of its draws. */
SHADE_INLINE REAL FN(lobe_pdf)(int distribution, REAL s, struct FN(angles) a)
{
    switch (distribution) {
    case BRDFFIT_SHADE_TORRANCE_SPARROW: return FN(pdf_torrance_sparrow)(a, s);
    case BRDFFIT_SHADE_WARD: return FN(pdf_ward)(a, s);
    case BRDFFIT_SHADE_BLINN_PHONG:
    case BRDFFIT_SHADE_ASHIKHMIN_SHIRLEY: return FN(pdf_cos_power)(a, s);
    case BRDFFIT_SHADE_LAFORTUNE: return FN(pdf_lafortune)(a, s);
    case BRDFFIT_SHADE_RETRO: return FN(pdf_retro)(a, s);
    case BRDFFIT_SHADE_GGX: return FN(pdf_visible)(FN(ggx)(a, s), a.nv, FN(side_ggx)(a.nv, a.sin2_v, s));
    default: return FN(pdf_visible)(FN(beckmann)(a, s), a.nv, FN(side_beckmann)(a.nv, a.sin2_v, s));
    }
}

SHADE_INLINE struct FN(direction) FN(lobe_sample)(int distribution, REAL s, struct FN(direction) v, REAL u1, REAL u2)
{
    switch (distribution) {
    case BRDFFIT_SHADE_TORRANCE_SPARROW: return FN(mirrored)(v, FN(half_torrance_sparrow)(s, u1, u2));
    case BRDFFIT_SHADE_WARD: return FN(mirrored)(v, FN(half_ward)(s, u1, u2));
    case BRDFFIT_SHADE_BLINN_PHONG:
    case BRDFFIT_SHADE_ASHIKHMIN_SHIRLEY: return FN(mirrored)(v, FN(half_cos_power)(s, u1, u2));
    case BRDFFIT_SHADE_LAFORTUNE: return FN(sample_lafortune)(v, s, u1, u2);
    case BRDFFIT_SHADE_RETRO: return FN(sample_retro)(v, s, u1, u2);
    case BRDFFIT_SHADE_GGX: return FN(mirrored)(v, FN(visible_ggx)(v, s, u1, u2));
    default: return FN(mirrored)(v, FN(visible_beckmann)(v, s, u1, u2));
    }
}

/* Column f of a diffuse term. */
SHADE_INLINE REAL FN(diffuse_at)(int diffuse, int f, struct FN(angles) a)
{
    if (diffuse == BRDFFIT_SHADE_BURLEY) {
        return f == 0 ? FN(burley_0)(a) : f == 1 ? FN(burley_1)(a) : FN(burley_2)(a);
    }
    return diffuse == BRDFFIT_SHADE_NO_DIFFUSE ? LIT(0.0) : f == 0 ? FN(lambert)(a) : FN(oren_nayar)(a);
}

SHADE_INLINE int FN(diffuse_columns)(int diffuse)
{
    return diffuse == BRDFFIT_SHADE_BURLEY ? 3 : diffuse == BRDFFIT_SHADE_OREN_NAYAR ? 2 : 1;
}

/* ---- Evaluate ------------------------------------------------------------ */

/* out[k] = f_r (n.l). */
static inline void FN(eval)(const struct SHADE_MODEL *m, const REAL light[3], const REAL view[3], REAL *out)
{
    struct FN(direction) l = FN(direction_of)(light[0], light[1], light[2]);
    struct FN(direction) v = FN(direction_of)(view[0], view[1], view[2]);
    struct FN(angles) a = FN(angles_of)(l, v);
    REAL w = FN(fifth)(a.versine);
    int k, p, f;

    for (k = 0; k < m->channels; k++) {
        out[k] = LIT(0.0);
    }
    if (!(a.nl > LIT(0.0) && a.nv > LIT(0.0))) {
        return;
    }
    for (f = 0; f < FN(diffuse_columns)(m->diffuse); f++) {
        REAL column = FN(diffuse_at)(m->diffuse, f, a);

        for (k = 0; k < m->channels; k++) {
            out[k] += m->x[f][k] * column;
        }
    }
    for (p = 0; p < m->lobes; p++) {
        const struct FN(lobe) *lobe = &m->lobe[p];
        REAL g = FN(lobe_at)(lobe->distribution, lobe->masking, lobe->s, a);

        for (k = 0; k < m->channels; k++) {
            out[k] += (lobe->plain[k] + lobe->grazing[k] * w) * g;
        }
    }
}

/* Linear between nodes i of 1 - cosine = (i / (NODES - 1))^2: in the sine near the normal, where some columns are. */
SHADE_INLINE REAL FN(between)(const REAL *table, REAL cosine)
{
    REAL versine = cosine < LIT(1.0) ? LIT(1.0) - cosine : LIT(0.0), last = (REAL)(BRDFFIT_SHADE_NODES - 1), part;
    REAL inside = versine < LIT(1.0) ? SQRT(versine) * last : last;
    int i = (int)inside;

    i = i < BRDFFIT_SHADE_NODES - 2 ? i : BRDFFIT_SHADE_NODES - 2;
    part = inside - (REAL)i;
    return table[i] + part * (table[i + 1] - table[i]);
}

/* Density of draws. */
SHADE_INLINE REAL FN(density)(const struct SHADE_MODEL *m, struct FN(angles) a)
{
    REAL sum = FN(between)(m->share[m->lobes], a.nv) * a.nl * LIT(0.31830988618379067);
    int p;

    for (p = 0; p < m->lobes; p++) {
        sum += FN(between)(m->share[p], a.nv) * FN(lobe_pdf)(m->lobe[p].distribution, m->lobe[p].s, a);
    }
    return sum;
}

static inline REAL FN(pdf)(const struct SHADE_MODEL *m, const REAL light[3], const REAL view[3])
{
    struct FN(direction) l = FN(direction_of)(light[0], light[1], light[2]);
    struct FN(direction) v = FN(direction_of)(view[0], view[1], view[2]);

    return l.z > LIT(0.0) && v.z > LIT(0.0) ? FN(density)(m, FN(angles_of)(l, v)) : LIT(0.0);
}

/* A direction of light from three numbers in [0, 1), and its density. 0: below the surface. */
static inline REAL FN(sample)(const struct SHADE_MODEL *m, const REAL view[3], const REAL u[3], REAL light[3])
{
    struct FN(direction) v = FN(direction_of)(view[0], view[1], view[2]), l;
    REAL left = u[0];
    int p = 0;

    light[0] = light[1] = light[2] = LIT(0.0);
    if (!(v.z > LIT(0.0))) {
        return LIT(0.0);
    }
    while (p < m->lobes && left >= FN(between)(m->share[p], v.z)) {
        left -= FN(between)(m->share[p++], v.z);
    }
    l = p < m->lobes ? FN(lobe_sample)(m->lobe[p].distribution, m->lobe[p].s, v, u[1], u[2])
                     : FN(sample_diffuse)(u[1], u[2]);
    light[0] = l.x;
    light[1] = l.y;
    light[2] = l.z;
    return FN(pdf)(m, light, view);
}

/* Share of the light from everywhere that goes to the viewer, and by reciprocity of that from him. */
static inline void FN(albedo)(const struct SHADE_MODEL *m, const REAL view[3], REAL *out)
{
    int k, p, f;

    for (k = 0; k < m->channels; k++) {
        out[k] = LIT(0.0);
        for (f = 0; view[2] > LIT(0.0) && f < FN(diffuse_columns)(m->diffuse); f++) {
            out[k] += m->x[f][k] * FN(between)(m->albedo[f], view[2]);
        }
        for (p = 0; view[2] > LIT(0.0) && p < m->lobes; p++) {
            out[k] += m->lobe[p].plain[k] * FN(between)(m->albedo[3 + 2 * p], view[2]) +
                      m->lobe[p].grazing[k] * FN(between)(m->albedo[4 + 2 * p], view[2]);
        }
    }
}
