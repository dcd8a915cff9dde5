/*
 * Channels that need no bounds of their own. SPDX-License-Identifier: MIT
 *
 * A channel without signal gains nothing whatever the lobe. Channels with the same sums, to the bit, gain the same: the
 * gain is a square in the data, so m of them are one whose sums are sqrt(m) times theirs. What bounds use (`linear`,
 * bound_*) is compressed accordingly, in place; rows, ai and ii keep every channel.
 */
#include <math.h>
#include <string.h>

#include "data/reduce_parts.h"

static int same_row(const double *p, const double *q, size_t n)
{
    return memcmp(p, q, n * sizeof *p) == 0;
}

/* `negative`: their negative parts are there. */
static int same_sums(const struct reduced *r, size_t k, size_t l, int negative)
{
    size_t n = r->stride, K = r->channels;
    int f, g, same = r->ii[k] == r->ii[l] && !(r->apart && r->channel_scale[k] != r->channel_scale[l]);

    for (f = 0; f < r->fixed && same; f++) {
        same = r->ai[(size_t)f * K + k] == r->ai[(size_t)f * K + l];
    }

    for (g = 0; g < r->geometries && same; g++) {
        const double *linear = r->table[g].linear + (size_t)r->fixed * r->stride;

        same = same_row(linear + k * n, linear + l * n, n) &&
               (!negative || same_row(linear + (K + k) * n, linear + (K + l) * n, n));
    }
    return same;
}

int brdffit_reduce_same_channels(const struct reduced *r, size_t k, size_t l)
{
    return same_sums(r, k, l, r->functionals > (size_t)r->fixed + r->channels);
}

/* Place of channel k's twin among those kept, or their number. */
static size_t twin(const struct reduced *r, size_t k, int negative)
{
    size_t i = 0;

    while (i < r->bounded && !same_sums(r, r->bound_channel[i], k, negative)) {
        i++;
    }
    return i;
}

static void move_row(struct reduced *r, size_t from, size_t to, double factor)
{
    size_t j;
    int g;

    for (g = 0; g < r->geometries; g++) {
        double *linear = r->table[g].linear;

        for (j = 0; j < r->stride; j++) {
            linear[to * r->stride + j] = factor * linear[from * r->stride + j];
        }
    }
}

void brdffit_reduce_every_channel(struct reduced *r)
{
    r->channels_zero = r->channels_identical = 0;
    r->apart = 0;
    for (r->bounded = 0; r->bounded < r->channels; r->bounded++) {
        r->bound_channel[r->bounded] = r->bounded;
        r->bound_root[r->bounded] = 1.0;
    }
}

void brdffit_reduce_channels(struct reduced *r)
{
    size_t k, i, K = r->channels, F = (size_t)r->fixed;
    int negative = r->functionals > F + K;

    r->bounded = 0;
    for (k = 0; k < K; k++) {
        if (!(r->ii[k] > 0.0)) {
            r->channels_zero++;
            continue;
        }
        i = twin(r, k, negative);
        if (i < r->bounded) {
            r->bound_root[i] += 1.0;
            r->channels_identical++;
            continue;
        }
        r->bound_channel[r->bounded] = k;
        r->bound_root[r->bounded++] = 1.0;
    }
    /* Rows move towards the front only, in ascending order. */
    for (i = 0; i < r->bounded; i++) {
        r->bound_root[i] = sqrt(r->bound_root[i]);
        move_row(r, F + r->bound_channel[i], F + i, r->bound_root[i]);
    }
    for (i = 0; negative && i < r->bounded; i++) {
        move_row(r, F + K + r->bound_channel[i], F + r->bounded + i, r->bound_root[i]);
    }
    r->functionals = F + (negative ? 2 : 1) * r->bounded;
}
