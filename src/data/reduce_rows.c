/*
 * Rows of the vector form. SPDX-License-Identifier: MIT
 *
 * Samples of one c all have g_i = b_i phi(s, c), so their residual norm is |B (x, Y, -1)| with the n x (2 + K)
 * matrix B = [a b I_1 .. I_K] and Y = sum_p y_p phi(s_p, c) (with several geometries a b and a Y of each, and so with several
 * a). Where n exceeds 2 + K by far, the triangle of B's QR
 * factorisation gives the same norm for every x and Y in 2 + K rows: a table of a million cells becomes a few
 * hundred rows, backward stably (Householder, REDUCE_BLOCK samples at a time). Rows made this way may be
 * negative; the vector form does not care. Other norms are not invariant under rotation: theirs are the samples.
 */
#include "data/reduce_parts.h"

#include <math.h>

#include "base/vector.h"

/* A triangle costs about as much as a dozen evaluations of the rows that it saves: only large groups pay it back. */
#define WORTHWHILE 4

static void raw_row(struct reduced *r, const brdffit_samples *samples, uint32_t j, uint32_t group)
{
    size_t k, f, row = r->rows++;
    int g;

    for (f = 0; f < (size_t)r->fixed; f++) {
        r->row_a[f * r->used + row] = r->sample_a[f * r->room + j];
    }
    for (g = 0; g < r->geometries; g++) {
        r->table[g].row_b[row] = r->table[g].sample_b[j];
    }
    r->row_c[row] = group;
    r->row_square[row] = 1.0;
    for (k = 0; k < r->channels; k++) {
        r->row_value[k * r->used + row] = brdffit_reduce_value(r, samples, j, k);
    }
}

/* w r^2 over the square of what norm l1 (w r) or linf (r) has in its row; kept finite. */
static double square_of(const struct reduced *r, const brdffit_samples *samples, uint32_t j, brdffit_norm norm)
{
    double w = samples->weights ? samples->weights[r->sample[j]] / r->scale_w : 1.0;

    return norm == BRDFFIT_NORM_LINF ? w : 1.0 / larger(w, 1e-300);
}

static void sample_rows(struct reduced *r, const brdffit_samples *samples, size_t begin, size_t end, uint32_t group,
                        brdffit_norm norm)
{
    size_t place;

    for (place = begin; place < end; place++) {
        raw_row(r, samples, r->order[place], group);
        r->row_square[r->rows - 1] = square_of(r, samples, r->order[place], norm);
    }
}

static double total_of(const struct reduced *r, brdffit_norm norm)
{
    double total = 0.0;
    size_t i, k;

    for (k = 0; k < r->channels; k++) {
        for (i = 0; i < r->rows; i++) {
            double value = fabs(r->row_value[k * r->used + i]);

            total = norm == BRDFFIT_NORM_L1 ? total + value : larger(total, value);
        }
    }
    return total;
}

/* Householder step: reflect column `at` of rows at .. rows - 1 onto row `at`, and apply to later columns. */
static void reflect(double *m, size_t rows, size_t width, size_t at)
{
    double largest = 0.0, norm2 = 0.0, head, alpha, beta;
    size_t i, k;

    for (i = at; i < rows; i++) {
        largest = larger(largest, fabs(m[i * width + at]));
    }
    if (!(largest > 0.0)) {
        return;
    }
    for (i = at; i < rows; i++) {
        double x = m[i * width + at] / largest;

        norm2 += x * x;
    }
    head = m[at * width + at] / largest;
    alpha = head > 0.0 ? -sqrt(norm2) : sqrt(norm2);
    beta = 1.0 / (norm2 - head * alpha); /* 2 / |v|^2 with v = x - alpha e */
    m[at * width + at] = (head - alpha) * largest;
    for (k = at + 1; k < width; k++) {
        double part = 0.0;

        for (i = at; i < rows; i++) {
            part += (m[i * width + at] / largest) * m[i * width + k];
        }
        part *= beta;
        for (i = at; i < rows; i++) {
            m[i * width + k] -= part * (m[i * width + at] / largest);
        }
    }
    m[at * width + at] = alpha * largest;
    for (i = at + 1; i < rows; i++) {
        m[i * width + at] = 0.0;
    }
}

/* Columns of B. */
static size_t row_width(const struct reduced *r)
{
    return r->channels + (size_t)(r->fixed + r->geometries);
}

/* The top `width` rows of r->block hold the triangle so far; append places begin .. end - 1 and triangularise. */
static void fold(struct reduced *r, const brdffit_samples *samples, size_t begin, size_t end)
{
    size_t width = row_width(r), rows = width + (end - begin), place, k, f;
    int g;

    for (place = begin; place < end; place++) {
        uint32_t j = r->order[place];
        double *row = r->block + (width + place - begin) * width;

        for (f = 0; f < (size_t)r->fixed; f++) {
            *row++ = r->sample_a[f * r->room + j];
        }
        for (g = 0; g < r->geometries; g++) {
            *row++ = r->table[g].sample_b[j];
        }
        for (k = 0; k < r->channels; k++) {
            *row++ = brdffit_reduce_value(r, samples, j, k);
        }
    }
    for (k = 0; k < width; k++) {
        reflect(r->block, rows, width, k);
    }
}

static void triangle_rows(struct reduced *r, const brdffit_samples *samples, size_t begin, size_t end, uint32_t group)
{
    size_t width = row_width(r), place, i, k, f;
    int g;

    for (i = 0; i < width * width; i++) {
        r->block[i] = 0.0;
    }
    for (place = begin; place < end; place += REDUCE_BLOCK) {
        fold(r, samples, place, end - place > REDUCE_BLOCK ? place + REDUCE_BLOCK : end);
    }
    for (i = 0; i < width; i++) {
        size_t row = r->rows++;
        const double *from = r->block + i * width;

        for (f = 0; f < (size_t)r->fixed; f++) {
            r->row_a[f * r->used + row] = *from++;
        }
        for (g = 0; g < r->geometries; g++) {
            r->table[g].row_b[row] = *from++;
        }
        r->row_c[row] = group;
        r->row_square[row] = 1.0;
        for (k = 0; k < r->channels; k++) {
            r->row_value[k * r->used + row] = from[k];
        }
    }
}

void brdffit_reduce_rows(struct reduced *r, const brdffit_samples *samples, brdffit_norm norm)
{
    size_t group, place;

    r->rows = 0;
    for (group = 0; group < r->groups; group++) {
        size_t begin = r->begin[group], end = r->begin[group + 1];
        /* Samples without a lobe: their b is 0, so any group does. */
        uint32_t index = group < r->distinct ? (uint32_t)group : 0;

        if (norm != BRDFFIT_NORM_L2) {
            sample_rows(r, samples, begin, end, index, norm);
        } else if (end - begin > WORTHWHILE * row_width(r)) {
            triangle_rows(r, samples, begin, end, index);
        } else {
            for (place = begin; place < end; place++) {
                raw_row(r, samples, r->order[place], index);
            }
        }
    }
    if (norm != BRDFFIT_NORM_L2) {
        r->total = total_of(r, norm);
    }
}
