/*
 * A description made ready for shading. No guard: once for float, once for double. SPDX-License-Identifier: MIT
 *
 * Albedos are the mean of column / density over BRDFFIT_SHADE_POINTS draws (u1, u2) of a component's own, which follow narrow
 * lobes wherever they are: a Fibonacci lattice. Draws below the surface count as 0.
 */
#ifndef BRDFFIT_SHADE_POINTS
#define BRDFFIT_SHADE_POINTS 1597 /* a Fibonacci number, */
#define BRDFFIT_SHADE_STRIDE 987  /* and the one before */
#endif

/* Coefficients and kinds; 0 when the description is of no model. */
static inline int FN(copy)(struct SHADE_MODEL *m, const struct brdffit_shade_description *d)
{
    int p, k, f, more = FN(diffuse_columns)(d->diffuse) - 1, good = 1;

    if (!(d->lobes >= 1 && d->lobes <= BRDFFIT_SHADE_LOBES && d->channels >= 1 &&
          d->channels <= BRDFFIT_SHADE_CHANNELS && d->masking >= 0 && d->masking < BRDFFIT_SHADE_MASKINGS &&
          d->diffuse >= 0 && d->diffuse < BRDFFIT_SHADE_DIFFUSES && d->sigma && d->x && d->y &&
          (d->f0 || !d->schlick) && (d->x_more || more == 0))) {
        return 0;
    }
    m->lobes = d->lobes;
    m->channels = d->channels;
    m->diffuse = d->diffuse;
    m->schlick = d->schlick != 0;
    for (k = 0; k < d->channels; k++) {
        m->x[0][k] = (REAL)d->x[k];
        for (f = 0; f < more; f++) {
            m->x[f + 1][k] = (REAL)d->x_more[k * more + f];
        }
    }
    for (p = 0; p < d->lobes; p++) {
        struct FN(lobe) *lobe = &m->lobe[p];

        good = good && d->distribution[p] >= 0 && d->distribution[p] < BRDFFIT_SHADE_DISTRIBUTIONS && d->sigma[p] > 0.0;
        lobe->distribution = d->distribution[p];
        lobe->masking = d->masking;
        lobe->s = (REAL)(1.0 / (d->sigma[p] * d->sigma[p]));
        for (k = 0; k < d->channels; k++) {
            double y = d->y[k * d->lobes + p], f0 = d->schlick ? d->f0[k * d->lobes + p] : 1.0;

            lobe->plain[k] = (REAL)(y * f0);
            lobe->grazing[k] = (REAL)(y * (1.0 - f0));
        }
    }
    return good;
}

/* Albedos of the columns of component p (the diffuse term is the last) for one viewer; of a lobe also the share of its draws
 * that are above the surface. */
static inline void FN(integrate)(const struct SHADE_MODEL *m, int p, struct FN(direction) v, REAL sum[3])
{
    int i, n = BRDFFIT_SHADE_POINTS, f;
    REAL step = LIT(1.0) / (REAL)n;

    sum[0] = sum[1] = sum[2] = LIT(0.0);
    for (i = 0; i < n; i++) {
        REAL u1 = ((REAL)i + LIT(0.5)) * step, u2 = ((REAL)(i * BRDFFIT_SHADE_STRIDE % n) + LIT(0.5)) * step;
        struct FN(direction) l = p < m->lobes ? FN(lobe_sample)(m->lobe[p].distribution, m->lobe[p].s, v, u1, u2)
                                              : FN(sample_diffuse)(u1, u2);
        struct FN(angles) a = FN(angles_of)(l, v);
        REAL density, g;

        if (!(a.nl > LIT(0.0))) {
            continue;
        }
        if (p == m->lobes) {
            for (f = 0; f < FN(diffuse_columns)(m->diffuse); f++) {
                sum[f] += FN(diffuse_at)(m->diffuse, f, a) / FN(lambert)(a) / (REAL)n;
            }
            continue;
        }
        sum[2] += step;
        density = FN(lobe_pdf)(m->lobe[p].distribution, m->lobe[p].s, a);
        g = density > LIT(0.0)
                ? FN(lobe_at)(m->lobe[p].distribution, m->lobe[p].masking, m->lobe[p].s, a) / density / (REAL)n
                : LIT(0.0);
        sum[0] += g;
        sum[1] += g * FN(fifth)(a.versine);
    }
}

/*
 * What each component reflects to a viewer, summed over channels, is its share of the draws; of lobes that lose draws below the
 * surface less of it, for such draws are what makes estimates vary. The square is near the best power: of GGX lobes beside
 * Lambert's term it is within a tenth of the least variance up to sigma 0.3, and better than the albedo alone beyond.
 */
static inline void FN(divide)(struct SHADE_MODEL *m, int node, const REAL above[])
{
    REAL part[BRDFFIT_SHADE_LOBES + 1], all = LIT(0.0);
    int p, k, f;

    for (p = 0; p <= m->lobes; p++) {
        part[p] = LIT(0.0);
        for (k = 0; k < m->channels && p < m->lobes; k++) {
            part[p] += m->lobe[p].plain[k] * m->albedo[3 + 2 * p][node] +
                       m->lobe[p].grazing[k] * m->albedo[4 + 2 * p][node];
        }
        for (k = 0; k < m->channels && p == m->lobes; k++) {
            for (f = 0; f < FN(diffuse_columns)(m->diffuse); f++) {
                part[p] += m->x[f][k] * m->albedo[f][node];
            }
        }
        part[p] *= above[p] * above[p];
        all += part[p];
    }
    for (p = 0; p <= m->lobes; p++) {
        m->share[p][node] = all > LIT(0.0) ? part[p] / all : (REAL)(p == m->lobes);
    }
}

/* 0 when the description is of no model, or has more channels than BRDFFIT_SHADE_CHANNELS. */
static inline int FN(make)(struct SHADE_MODEL *m, const struct brdffit_shade_description *description)
{
    int node, p;

    memset(m, 0, sizeof *m);
    if (!FN(copy)(m, description)) {
        return 0;
    }
    for (node = 0; node < BRDFFIT_SHADE_NODES; node++) {
        REAL root = (REAL)node / (REAL)(BRDFFIT_SHADE_NODES - 1), cosine = LIT(1.0) - root * root, sum[3];
        REAL above[BRDFFIT_SHADE_LOBES + 1];
        struct FN(direction) v;

        cosine = cosine > LIT(0.002) ? cosine : LIT(0.002);
        v = FN(direction_of)(SQRT(LIT(1.0) - cosine * cosine), LIT(0.0), cosine);

        for (p = 0; p <= m->lobes; p++) {
            FN(integrate)(m, p, v, sum);
            m->albedo[p < m->lobes ? 3 + 2 * p : 0][node] = sum[0];
            m->albedo[p < m->lobes ? 4 + 2 * p : 1][node] = sum[1];
            if (p == m->lobes) {
                m->albedo[2][node] = sum[2];
            }
            above[p] = p < m->lobes ? sum[2] : LIT(1.0);
        }
        FN(divide)(m, node, above);
    }
    return 1;
}
