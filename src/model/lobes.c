/*
 * The table of distributions, and what follows from it for all of them. SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "model/lobe.h"
#include "model/masking.h"

static const struct lobe_kind *const table[BRDFFIT_DISTRIBUTION_COUNT] = {
    [BRDFFIT_BECKMANN] = &brdffit_lobe_beckmann,
    [BRDFFIT_GGX] = &brdffit_lobe_ggx,
    [BRDFFIT_TORRANCE_SPARROW] = &brdffit_lobe_torrance_sparrow,
    [BRDFFIT_WARD] = &brdffit_lobe_ward,
    [BRDFFIT_BLINN_PHONG] = &brdffit_lobe_blinn_phong,
    [BRDFFIT_ASHIKHMIN_SHIRLEY] = &brdffit_lobe_ashikhmin_shirley,
    [BRDFFIT_LAFORTUNE] = &brdffit_lobe_lafortune,
    [BRDFFIT_RETRO] = &brdffit_lobe_retro,
};

const struct lobe_kind *brdffit_lobe_kind_of(brdffit_distribution distribution)
{
    return table[distribution];
}

const struct lobe_kind *brdffit_lobe_kind_masked(brdffit_distribution distribution, brdffit_masking masking)
{
    return masking == BRDFFIT_MASKING_V_CAVITY ? table[distribution]
                                               : brdffit_lobe_kind_other_masking(distribution, masking);
}

struct wide brdffit_lobe_factor(const struct lobe_kind *kind, struct twofold s, double c)
{
    return wide_times(wide_of(kind->lambda(s.high)), kind->phi(s, c));
}

struct wide brdffit_lobe_at(const struct lobe_kind *kind, struct twofold s, const struct geometry *g)
{
    struct wide out = brdffit_lobe_factor(kind, s, g->c);

    return kind->masking ? wide_times(out, wide_of(kind->masking(s.high, g->tan2_light, g->tan2_view))) : out;
}

struct wide brdffit_lobe_divisor(const struct lobe_kind *kind, struct twofold s, const struct lobe_sight *sight)
{
    struct wide out = brdffit_lobe_factor(kind, s, sight->c_min);

    return kind->conversion ? wide_times(out, wide_of(kind->conversion(sight, s.high))) : out;
}

static int is_ours(brdffit_distribution distribution)
{
    return (unsigned)distribution < BRDFFIT_DISTRIBUTION_COUNT && table[distribution];
}

const char *brdffit_distribution_string(brdffit_distribution distribution)
{
    return is_ours(distribution) ? table[distribution]->name : "unknown";
}

const char *brdffit_distribution_title(brdffit_distribution distribution)
{
    return is_ours(distribution) ? table[distribution]->title : "unknown";
}

const char *brdffit_parameter_string(brdffit_distribution distribution)
{
    return !is_ours(distribution) ? "unknown" : table[distribution]->by_exponent ? "exponent" : "sigma";
}

int brdffit_geometry_table_row(brdffit_distribution distribution, double tan2_half, struct geometry_table_row *out)
{
    const struct lobe_kind *kind = brdffit_lobe_kind_of(distribution);
    struct geometry_angles angles = {.cos_light = 1.0, .cos_view = 1.0, .tan2_half = tan2_half, .cos_difference = 1.0};
    double cos2 = cos2_half(&angles);
    struct geometry row;

    if (kind->table_kind == TABLE_ROW_NONE) {
        return 0;
    }
    kind->row(&angles, &row);
    out->c = row.c;
    out->kind = kind->table_kind;
    out->shared = kind->table_kind == TABLE_ROW_SIDE ? 1.0 : 2.0 * sqrt(cos2);
    out->factor = kind->table_factor ? kind->table_factor(cos2) : 1.0;
    return 1;
}
