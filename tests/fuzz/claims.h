/*
 * What must hold after any reading, whatever was read; aborts when it does not. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_FUZZ_CLAIMS_H
#define BRDFFIT_FUZZ_CLAIMS_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "brdffit_io.h"

#define CLAIM(what) ((what) ? (void)0 : claim_broken(#what, __LINE__))

static inline void claim_broken(const char *what, int line)
{
    printf("broken, line %d: %s\n", line, what); /* standard error has the parsers' messages, and may be closed */
    fflush(stdout);
    abort();
}

static inline void claim_finite(const double *values, size_t count, double least, double most)
{
    size_t i;

    for (i = 0; values && i < count; i++) {
        CLAIM(values[i] >= least && values[i] <= most);
    }
}

static inline void claim_vectors(const double *v, size_t count)
{
    size_t i;

    claim_finite(v, 3 * count, -1.7976931348623157e308, 1.7976931348623157e308);
    for (i = 0; v && i < count; i++) {
        CLAIM(v[3 * i] != 0.0 || v[3 * i + 1] != 0.0 || v[3 * i + 2] != 0.0);
    }
}

static inline void claim_failure(const brdffit_table *table, brdffit_status status, const brdffit_error *error)
{
    CLAIM(!table);
    CLAIM(error->status == status);
    CLAIM(status > BRDFFIT_OK && status < BRDFFIT_STATUS_COUNT);
    CLAIM(status != BRDFFIT_ERR_ARGUMENT && status != BRDFFIT_ERR_WORKSPACE && status != BRDFFIT_ERR_OPEN);
    CLAIM(error->message && error->message[0]);
    CLAIM(error->line != 0 && error->column != 0); /* both count from 1 */
}

static inline void claim_form(const brdffit_samples *s)
{
    size_t n = s->count;

    CLAIM((s->form == BRDFFIT_FORM_DIRECTIONS) == (s->light && s->view));
    CLAIM((s->form == BRDFFIT_FORM_ANGLES) == (s->cos_light && s->cos_view && s->tan2_half && s->cos_difference));
    CLAIM((s->form == BRDFFIT_FORM_COEFFICIENTS) == (s->a && s->b && s->c));
    CLAIM(s->form != BRDFFIT_FORM_COEFFICIENTS || s->quantity == BRDFFIT_QUANTITY_RADIANCE);
    claim_vectors(s->light, n);
    claim_vectors(s->view, n);
    claim_vectors(s->normal, n);
    claim_finite(s->cos_light, n, 1e-300, 1.0);
    claim_finite(s->cos_view, n, 1e-300, 1.0);
    claim_finite(s->tan2_half, n, 0.0, 1.7976931348623157e308);
    claim_finite(s->cos_difference, n, 1e-300, 1.0);
    claim_finite(s->a, n, 0.0, 1.7976931348623157e308);
    claim_finite(s->b, n, 0.0, 1.7976931348623157e308);
    claim_finite(s->c, n, 0.0, 1.7976931348623157e308);
    claim_finite(s->weights, n, 0.0, 1.7976931348623157e308);
}

static inline void claim_counts(const brdffit_table *table)
{
    const brdffit_samples *s = table->samples;
    size_t i, negative = 0, dropped = 0;

    for (i = 0; i < BRDFFIT_IO_DROP_COUNT; i++) {
        dropped += table->dropped[i];
    }
    if (table->format == BRDFFIT_IO_FORMAT_CSV || table->merl_sampling == BRDFFIT_IO_MERL_TABLE) {
        CLAIM(s->count + dropped == table->rows);
    }
    for (i = 0; i < s->count; i++) {
        size_t k, below = 0;

        for (k = 0; k < s->channels; k++) {
            below += s->values[i * s->channels + k] < 0.0;
        }
        negative += below > 0;
        if (table->lines) {
            CLAIM(table->lines[i] > (i ? table->lines[i - 1] : 1));
        }
    }
    CLAIM(negative == table->negative);
}

/* `status`, `table` and `error` as a reading left them. Frees the table. */
static inline void claim_all(brdffit_status status, brdffit_table *table, const brdffit_error *error)
{
    const brdffit_samples *s;
    size_t k;

    if (status != BRDFFIT_OK) {
        claim_failure(table, status, error);
        return;
    }
    CLAIM(table);
    s = table->samples;
    CLAIM(s->struct_size > 0 && s->struct_size <= sizeof *s && s->count > 0 && s->channels > 0 && s->values);
    CLAIM(table->format == BRDFFIT_IO_FORMAT_CSV || table->format == BRDFFIT_IO_FORMAT_MERL);
    CLAIM((table->format == BRDFFIT_IO_FORMAT_CSV) == (table->lines != NULL));
    for (k = 0; k < s->channels; k++) {
        CLAIM(table->channel_names[k] && table->channel_names[k][0]);
    }
    claim_finite(s->values, s->count * s->channels, -1.7976931348623157e308, 1.7976931348623157e308);
    claim_form(s);
    claim_counts(table);
    brdffit_io_free(table);
}

#endif
