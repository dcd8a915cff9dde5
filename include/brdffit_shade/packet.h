/*
 * Packets of directions: the functions of model.h over arrays, one coordinate an array. No guard: once for float, once for double.
 * SPDX-License-Identifier: MIT
 *
 * Angles of BRDFFIT_SHADE_PACKET directions lie in one array a number, which the first level of the cache holds; each lobe is
 * then one loop over them whose kind is a constant, without branches, for the compiler to vectorise.
 */

struct FN(packet) {
    REAL nl[BRDFFIT_SHADE_PACKET], nv[BRDFFIT_SHADE_PACKET], sin2_l[BRDFFIT_SHADE_PACKET], sin2_v[BRDFFIT_SHADE_PACKET];
    REAL tan2_half[BRDFFIT_SHADE_PACKET], cos_half[BRDFFIT_SHADE_PACKET], vh[BRDFFIT_SHADE_PACKET];
    REAL versine[BRDFFIT_SHADE_PACKET], lv[BRDFFIT_SHADE_PACKET];
    REAL g[BRDFFIT_SHADE_PACKET];
};

/* Light and viewer, one coordinate an array. */
struct FN(pairs) {
    const REAL *lx, *ly, *lz, *vx, *vy, *vz;
};

SHADE_INLINE void FN(packet_angles)(struct FN(packet) * packet, const struct FN(pairs) * at, size_t from, int n)
{
    const REAL *lx = at->lx + from, *ly = at->ly + from, *lz = at->lz + from;
    const REAL *vx = at->vx + from, *vy = at->vy + from, *vz = at->vz + from;
    int i;

    for (i = 0; i < n; i++) {
        struct FN(angles)
            a = FN(angles_of)(FN(direction_of)(lx[i], ly[i], lz[i]), FN(direction_of)(vx[i], vy[i], vz[i]));

        packet->nl[i] = a.nl;
        packet->nv[i] = a.nv;
        packet->sin2_l[i] = a.sin2_l;
        packet->sin2_v[i] = a.sin2_v;
        packet->tan2_half[i] = a.tan2_half;
        packet->cos_half[i] = a.cos_half;
        packet->vh[i] = a.vh;
        packet->versine[i] = a.versine;
        packet->lv[i] = a.lv;
    }
}

SHADE_INLINE struct FN(angles) FN(packet_at)(const struct FN(packet) * packet, int i)
{
    struct FN(angles) a;

    a.nl = packet->nl[i];
    a.nv = packet->nv[i];
    a.sin2_l = packet->sin2_l[i];
    a.sin2_v = packet->sin2_v[i];
    a.tan2_half = packet->tan2_half[i];
    a.cos_half = packet->cos_half[i];
    a.vh = packet->vh[i];
    a.versine = packet->versine[i];
    a.lv = packet->lv[i];
    return a;
}

/* A loop with a constant kind. */
#define SHADE_LOOP(value)                                                                                              \
    for (i = 0; i < n; i++) {                                                                                          \
        struct FN(angles) a = FN(packet_at)(packet, i);                                                                \
                                                                                                                       \
        packet->g[i] = value;                                                                                          \
    }                                                                                                                  \
    break
#define SHADE_MASKED(distribution)                                                                                     \
    switch (lobe->masking) {                                                                                           \
    case BRDFFIT_SHADE_V_CAVITY: SHADE_LOOP(FN(lobe_at)(distribution, BRDFFIT_SHADE_V_CAVITY, s, a));                  \
    case BRDFFIT_SHADE_SMITH: SHADE_LOOP(FN(lobe_at)(distribution, BRDFFIT_SHADE_SMITH, s, a));                        \
    case BRDFFIT_SHADE_SMITH_SEPARABLE: SHADE_LOOP(FN(lobe_at)(distribution, BRDFFIT_SHADE_SMITH_SEPARABLE, s, a));    \
    default: SHADE_LOOP(FN(lobe_at)(distribution, BRDFFIT_SHADE_UNMASKED, s, a));                                      \
    }                                                                                                                  \
    break

SHADE_INLINE void FN(packet_lobe)(struct FN(packet) * packet, const struct FN(lobe) * lobe, int n)
{
    const REAL s = lobe->s;
    int i;

    switch (lobe->distribution) {
    case BRDFFIT_SHADE_BECKMANN: SHADE_MASKED(BRDFFIT_SHADE_BECKMANN);
    case BRDFFIT_SHADE_GGX: SHADE_MASKED(BRDFFIT_SHADE_GGX);
    case BRDFFIT_SHADE_TORRANCE_SPARROW: SHADE_LOOP(FN(torrance_sparrow)(a, s));
    case BRDFFIT_SHADE_WARD: SHADE_LOOP(FN(ward)(a, s));
    case BRDFFIT_SHADE_BLINN_PHONG: SHADE_LOOP(FN(blinn_phong)(a, s));
    case BRDFFIT_SHADE_ASHIKHMIN_SHIRLEY: SHADE_LOOP(FN(ashikhmin_shirley)(a, s));
    case BRDFFIT_SHADE_LAFORTUNE: SHADE_LOOP(FN(lafortune)(a, s));
    default: SHADE_LOOP(FN(retro)(a, s));
    }
}

SHADE_INLINE void FN(packet_density)(struct FN(packet) * packet, const struct FN(lobe) * lobe, int n)
{
    const REAL s = lobe->s;
    int i;

    switch (lobe->distribution) {
    case BRDFFIT_SHADE_BECKMANN: SHADE_LOOP(FN(lobe_pdf)(BRDFFIT_SHADE_BECKMANN, s, a));
    case BRDFFIT_SHADE_GGX: SHADE_LOOP(FN(lobe_pdf)(BRDFFIT_SHADE_GGX, s, a));
    case BRDFFIT_SHADE_TORRANCE_SPARROW: SHADE_LOOP(FN(pdf_torrance_sparrow)(a, s));
    case BRDFFIT_SHADE_WARD: SHADE_LOOP(FN(pdf_ward)(a, s));
    case BRDFFIT_SHADE_BLINN_PHONG:
    case BRDFFIT_SHADE_ASHIKHMIN_SHIRLEY: SHADE_LOOP(FN(pdf_cos_power)(a, s));
    case BRDFFIT_SHADE_LAFORTUNE: SHADE_LOOP(FN(pdf_lafortune)(a, s));
    default: SHADE_LOOP(FN(pdf_retro)(a, s));
    }
}

SHADE_INLINE void FN(packet_diffuse)(struct FN(packet) * packet, int diffuse, int f, int n)
{
    int i;

    switch (diffuse == BRDFFIT_SHADE_BURLEY ? 2 + f : f) {
    case 0: SHADE_LOOP(FN(lambert)(a));
    case 1: SHADE_LOOP(FN(oren_nayar)(a));
    case 2: SHADE_LOOP(FN(burley_0)(a));
    case 3: SHADE_LOOP(FN(burley_1)(a));
    default: SHADE_LOOP(FN(burley_2)(a));
    }
}

#undef SHADE_LOOP
#undef SHADE_MASKED

/* to[i] += (plain + grazing w) g. */
SHADE_INLINE void FN(packet_add)(const struct FN(packet) * packet, REAL plain, REAL grazing, REAL *to, int n)
{
    int i;

    for (i = 0; i < n && grazing > LIT(0.0); i++) {
        to[i] += (plain + grazing * FN(fifth)(packet->versine[i])) * packet->g[i];
    }
    for (i = 0; i < n && !(grazing > LIT(0.0)); i++) {
        to[i] += plain * packet->g[i];
    }
}

/* What is below the horizon, either way, reflects nothing, whatever the formulas say there. */
SHADE_INLINE void FN(packet_horizon)(const struct FN(packet) * packet, REAL *to, int n)
{
    int i;

    for (i = 0; i < n; i++) {
        REAL least = packet->nl[i] < packet->nv[i] ? packet->nl[i] : packet->nv[i];

        to[i] = least > LIT(0.0) ? to[i] : LIT(0.0);
    }
}

/* out[k][i] = f_r (n.l) of channel k at pair i. */
static inline void FN(eval_many)(const struct SHADE_MODEL *m, size_t count, const struct FN(pairs) * at,
                                 REAL *const *out)
{
    struct FN(packet) packet;
    size_t from;
    int k, p, f;

    for (from = 0; from < count; from += BRDFFIT_SHADE_PACKET) {
        int n = count - from < BRDFFIT_SHADE_PACKET ? (int)(count - from) : BRDFFIT_SHADE_PACKET;

        FN(packet_angles)(&packet, at, from, n);
        for (k = 0; k < m->channels; k++) {
            memset(out[k] + from, 0, (size_t)n * sizeof(REAL));
        }
        for (f = 0; m->diffuse != BRDFFIT_SHADE_NO_DIFFUSE && f < FN(diffuse_columns)(m->diffuse); f++) {
            FN(packet_diffuse)(&packet, m->diffuse, f, n);
            for (k = 0; k < m->channels; k++) {
                FN(packet_add)(&packet, m->x[f][k], LIT(0.0), out[k] + from, n);
            }
        }
        for (p = 0; p < m->lobes; p++) {
            FN(packet_lobe)(&packet, &m->lobe[p], n);
            for (k = 0; k < m->channels; k++) {
                FN(packet_add)(&packet, m->lobe[p].plain[k], m->lobe[p].grazing[k], out[k] + from, n);
            }
        }
        for (k = 0; k < m->channels; k++) {
            FN(packet_horizon)(&packet, out[k] + from, n);
        }
    }
}

/* Densities. */
static inline void FN(pdf_many)(const struct SHADE_MODEL *m, size_t count, const struct FN(pairs) * at, REAL *out)
{
    struct FN(packet) packet;
    size_t from;
    int p, i;

    for (from = 0; from < count; from += BRDFFIT_SHADE_PACKET) {
        int n = count - from < BRDFFIT_SHADE_PACKET ? (int)(count - from) : BRDFFIT_SHADE_PACKET;

        FN(packet_angles)(&packet, at, from, n);
        for (i = 0; i < n; i++) {
            out[from + (size_t)i] = FN(between)(m->share[m->lobes], packet.nv[i]) * packet.nl[i] *
                                    LIT(0.31830988618379067);
        }
        for (p = 0; p < m->lobes; p++) {
            FN(packet_density)(&packet, &m->lobe[p], n);
            for (i = 0; i < n; i++) {
                out[from + (size_t)i] += FN(between)(m->share[p], packet.nv[i]) * packet.g[i];
            }
        }
        FN(packet_horizon)(&packet, out + from, n);
    }
}

/* view: count x 3, u: count x 3 -> light: count x 3, and densities. */
static inline void FN(sample_many)(const struct SHADE_MODEL *m, size_t count, const REAL *view, const REAL *u,
                                   REAL *light, REAL *pdf)
{
    size_t i;

    for (i = 0; i < count; i++) {
        pdf[i] = FN(sample)(m, view + 3 * i, u + 3 * i, light + 3 * i);
    }
}
