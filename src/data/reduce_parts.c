/*
 * What every step of the reduction asks: see reduce_parts.h. SPDX-License-Identifier: MIT
 */
#include "data/reduce_parts.h"

/* Whether samples p and q agree in the c of every geometry beyond the first. */
static int alike_beyond(const struct reduced *r, uint32_t p, uint32_t q)
{
    const struct table *first = &r->table[0];
    int g, same = !first->masked ||
                  (first->sample_light[p] == first->sample_light[q] && first->sample_view[p] == first->sample_view[q]);

    for (g = 1; g < r->geometries; g++) {
        same = same && r->table[g].sample_c[p] == r->table[g].sample_c[q];
    }
    return same;
}

/* Whether a sample has a lobe in some geometry. */
static int has_lobe(const struct reduced *r, uint32_t j)
{
    int g, any = 0;

    for (g = 0; g < r->geometries; g++) {
        any = any || isfinite(r->table[g].sample_c[j]);
    }
    return any;
}

void brdffit_reduce_group(struct reduced *r)
{
    const double *c = r->table[0].sample_c;
    uint32_t before = 0;
    size_t place;

    r->groups = r->distinct = 0;
    for (place = 0; place < r->used; place++) {
        uint32_t here = r->order[place];

        if (place == 0 || c[before] != c[here] || !alike_beyond(r, before, here)) {
            r->begin[r->groups++] = (uint32_t)place;
            r->distinct += (size_t)has_lobe(r, here);
        }
        before = here;
    }
    r->begin[r->groups] = (uint32_t)r->used;
}
