/*
 * E^2 at given roughnesses from the residuals of the samples, coefficients by the tests' slow reference in long double.
 * Every answer that is a roughness is judged by it, outside of the timing. SPDX-License-Identifier: MIT
 */
#include "curves_reduced.h"

#include "../../tests/ref/ref_exact.h"

static struct ref_rows rows_of(const struct peers_problem *p)
{
    struct ref_rows rows = ref_rows_new(p->samples, p->channels);
    size_t i, k;

    for (i = 0; i < p->samples; i++) {
        rows.a[i] = p->a[i];
        rows.b[i] = p->b[i];
        rows.c[i] = p->c[i];
        for (k = 0; k < p->channels; k++) {
            rows.data[k * p->samples + i] = p->value[i * p->channels + k];
        }
    }
    return rows;
}

double curves_judge(const struct peers_problem *p, int lobes, const double *u)
{
    struct ref_rows rows = rows_of(p);
    size_t n = p->samples;
    long double *room = ref_allocate(2 * n + ref_exact_room(&rows), sizeof *room), e2;
    const long double *column[REF_COLUMNS] = {rows.a, room, room + n};
    int j;

    for (j = 0; j < lobes; j++) {
        ref_lobe(&rows, 0, expl((long double)u[j]), room + (size_t)j * n);
    }
    e2 = ref_exact(&rows, column, 1 + lobes, room + 2 * n, NULL);
    free(room);
    ref_rows_free(&rows);
    return (double)e2;
}
