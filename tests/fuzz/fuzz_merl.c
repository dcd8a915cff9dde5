/*
 * Fuzz target: MERL .binary tables, every sampling, also through gzip and by detection. SPDX-License-Identifier: MIT
 */
#include <zlib.h>

#include "fuzz/claims.h"
#include "fuzz/standalone.h"

static void read_as(const uint8_t *data, size_t size, const brdffit_io_options *options)
{
    brdffit_table *table = NULL;
    brdffit_error error;
    brdffit_status status;

    memset(&error, 0, sizeof error);
    status = brdffit_io_read_memory(data, size, options, &table, &error);
    if (status == BRDFFIT_OK && table->format == BRDFFIT_IO_FORMAT_MERL) {
        CLAIM(table->negative == 0 && table->rows == table->dims[0] * table->dims[1] * table->dims[2]);
        CLAIM(size < 12 || table->compressed || size == 12 + 24 * table->rows);
    }
    claim_all(status, table, &error);
}

/* As sums: the same table and counts, or the same refusal; and the same samples after all. */
static void sum_as(const uint8_t *data, size_t size, const brdffit_io_options *options)
{
    brdffit_table *table = NULL, *sums = NULL;
    brdffit_error error, other;
    brdffit_status status;
    int i;

    memset(&error, 0, sizeof error);
    memset(&other, 0, sizeof other);
    status = brdffit_io_read_memory(data, size, options, &table, &error);
    CLAIM(brdffit_io_read_sums_memory(data, size, options, NULL, &sums, &other) == status);
    if (status != BRDFFIT_OK) {
        CLAIM(strcmp(error.message, other.message) == 0 && error.sample == other.sample &&
              error.channel == other.channel && error.line == other.line);
        claim_all(status, sums, &other);
        return;
    }
    CLAIM(sums->samples->count == table->samples->count && sums->compressed == table->compressed);
    for (i = 0; i < BRDFFIT_IO_DROP_COUNT; i++) {
        CLAIM(sums->dropped[i] == table->dropped[i]);
    }
    CLAIM(brdffit_io_samples(sums, &other) == BRDFFIT_OK && !sums->sums);
    CLAIM(memcmp(sums->samples->values, table->samples->values,
                 sums->samples->count * sums->samples->channels * sizeof(double)) == 0);
    brdffit_io_free(table);
    claim_all(status, sums, &other);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const double light[] = {0, 0, 1, 1, 0, 1, -1, 2, 0.5, 0, 1, -1};
    static const double view[] = {0, 0, 1, -1, 0, 1, 3, 1, 0.1, 0, 0, 1};
    brdffit_samples at;
    brdffit_io_options options;
    int sampling;

    brdffit_samples_init(&at);
    at.count = sizeof light / sizeof *light / 3;
    at.light = light;
    at.view = view;
    brdffit_io_options_init(&options);
    options.directions = &at;
    sum_as(data, size, &options);
    read_as(data, size, &options);
    options.format = BRDFFIT_IO_FORMAT_MERL;
    for (sampling = BRDFFIT_IO_MERL_TABLE; sampling <= BRDFFIT_IO_MERL_DIRECTIONS; sampling++) {
        options.merl_sampling = (brdffit_io_merl_sampling)sampling;
        options.merl_bins = (brdffit_io_merl_bins)(sampling & 1);
        read_as(data, size, &options);
    }
    options.merl_sampling = BRDFFIT_IO_MERL_TABLE;
    options.merl_bins = BRDFFIT_IO_MERL_CENTRE;
    read_as(data, size, &options);
    sum_as(data, size, &options);
    return 0;
}

#if !defined(BRDFFIT_LIBFUZZER)

/* A table of n_h x n_d x n_p cells counted up; returns its size. */
static size_t seed_table(unsigned char *out, unsigned char n_h, unsigned char n_d, unsigned char n_p)
{
    size_t i, cells = (size_t)n_h * n_d * n_p;
    int k;

    memset(out, 0, 12 + 24 * cells);
    out[0] = n_h;
    out[4] = n_d;
    out[8] = n_p;
    for (i = 0; i < 3 * cells; i++) {
        double value = i % 11 == 5 ? -1.0 : (double)i;
        uint64_t bits;

        memcpy(&bits, &value, sizeof bits);
        for (k = 0; k < 8; k++) {
            out[12 + 8 * i + (size_t)k] = (unsigned char)(bits >> 8 * k);
        }
    }
    return 12 + 24 * cells;
}

static size_t seed_gzip(unsigned char *out, size_t room, const unsigned char *data, size_t size)
{
    z_stream stream;

    memset(&stream, 0, sizeof stream);
    CLAIM(deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) == Z_OK);
    stream.next_in = (Bytef *)(uintptr_t)data;
    stream.avail_in = (uInt)size;
    stream.next_out = out;
    stream.avail_out = (uInt)room;
    CLAIM(deflate(&stream, Z_FINISH) == Z_STREAM_END);
    room -= stream.avail_out;
    (void)deflateEnd(&stream);
    return room;
}

#define SEED_COUNT 4

/* Static storage: filled by the first call. */
static const struct fuzz_seed *make_seeds(void)
{
    static unsigned char data[SEED_COUNT][4096];
    static struct fuzz_seed seeds[SEED_COUNT];

    seeds[0].size = seed_table(data[0], 4, 3, 6);
    seeds[1].size = seed_table(data[1], 2, 2, 2);
    seeds[2].size = seed_table(data[2], 1, 1, 1);
    seeds[3].size = seed_gzip(data[3], sizeof data[3], data[1], seeds[1].size);
    seeds[0].data = data[0];
    seeds[1].data = data[1];
    seeds[2].data = data[2];
    seeds[3].data = data[3];
    return seeds;
}

FUZZ_MAIN(make_seeds(), SEED_COUNT)
#endif
