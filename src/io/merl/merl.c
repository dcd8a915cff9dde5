/*
 * MERL .binary tables: header, sizes, values. SPDX-License-Identifier: MIT
 *
 * Nothing that a header says is believed before it was compared with the true size of the file.
 */
#include "io/merl/merl.h"

#include "io/fail.h"
#include "io/limits.h"
#include "io/options.h"

static int32_t load_i32(const unsigned char *p)
{
    uint32_t bits = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
    int32_t value;

    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Bytes of the table, or 0 when that is more than any file can have. */
static uint64_t table_size(const int32_t dims[3])
{
    const uint64_t most = (UINT64_MAX - MERL_HEADER) / (MERL_CHANNELS * sizeof(double));
    uint64_t cells = (uint64_t)dims[0] * (uint64_t)dims[1];

    if (cells > most / (uint64_t)dims[2]) {
        return 0;
    }
    return MERL_HEADER + cells * (uint64_t)dims[2] * MERL_CHANNELS * sizeof(double);
}

uint64_t brdffit_io_merl_bytes(const unsigned char *data)
{
    const int32_t dims[3] = {load_i32(data), load_i32(data + 4), load_i32(data + 8)};

    return dims[0] > 0 && dims[1] > 0 && dims[2] > 0 ? table_size(dims) : 0;
}

int brdffit_io_merl_plausible(const unsigned char *data)
{
    return brdffit_io_merl_bytes(data) > 0;
}

static brdffit_status size_wrong(brdffit_error *error, const char *message, double value)
{
    return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT, message, value);
}

/* Entries looked at for the order of their bytes. */
#define ORDER_PROBES ((size_t)64)

/* Of a reflectance, or of the -1 that marks a cell without one: an exponent between those of 2^-100 and 2^100. */
static int is_ordinary(uint64_t bits)
{
    const unsigned exponent = (unsigned)(bits >> 52 & 0x7ff);

    return exponent > 1023 - 100 && exponent < 1023 + 100;
}

static uint64_t reversed(uint64_t bits)
{
    uint64_t out = 0;
    int i;

    for (i = 0; i < 8; i++, bits >>= 8) {
        out = out << 8 | (bits & 0xff);
    }
    return out;
}

/* Of the entries looked at few make sense as they stand (one in ten of any bytes does), and every one does the other way
 * round; zeros say nothing. */
static int is_big_endian(const struct merl *merl)
{
    const size_t total = MERL_CHANNELS * merl->cells, step = total / ORDER_PROBES + 1;
    size_t i, looked = 0, ordinary = 0;

    for (i = 0; i < total; i += step) {
        const uint64_t bits = brdffit_io_merl_bits(merl->plane + 8 * i);

        if (bits == 0) {
            continue;
        }
        if (!is_ordinary(reversed(bits))) {
            return 0;
        }
        ordinary += (size_t)is_ordinary(bits);
        looked++;
    }
    return looked >= 8 && 3 * ordinary < looked;
}

brdffit_status brdffit_io_merl_open(const unsigned char *data, size_t size, struct merl *merl, brdffit_error *error)
{
    int32_t dims[3];
    uint64_t expected;
    int i;

    if (size < MERL_HEADER) {
        return size_wrong(error, "the file is shorter than the 12-byte header of a MERL table (value: its bytes)",
                          (double)size);
    }
    for (i = 0; i < 3; i++) {
        dims[i] = load_i32(data + 4 * i);
        if (dims[i] <= 0) {
            return size_wrong(error, "MERL header: a dimension is not positive", (double)dims[i]);
        }
        merl->dims[i] = (size_t)dims[i];
    }
    expected = table_size(dims);
    if (expected == 0) {
        return size_wrong(error, "MERL header: the product of the dimensions overflows (value: cells)",
                          (double)dims[0] * (double)dims[1] * (double)dims[2]);
    }
    if (size != expected) {
        return size_wrong(error,
                          size < expected ? "the MERL file is shorter than its header says (value: bytes expected)"
                                          : "the MERL file is longer than its header says (value: bytes expected)",
                          (double)expected);
    }
    merl->cells = merl->dims[0] * merl->dims[1] * merl->dims[2];
    merl->plane = data + MERL_HEADER;
    if (is_big_endian(merl)) {
        return brdffit_io_fail(
            error, BRDFFIT_ERR_FORMAT,
            "the doubles of the table are big-endian, and MERL's are little-endian: turn their bytes round");
    }
    return BRDFFIT_OK;
}

/* The sign bit of the result is set for NaN and infinities: the exponent's eleven ones carry into it. */
static uint64_t overflow_of(const unsigned char *entry)
{
    const uint64_t exponent = (uint64_t)0x7ff << 52, one = (uint64_t)1 << 52;

    return (brdffit_io_merl_bits(entry) & exponent) + one;
}

/* The whole table must be finite, whatever part of it will be used. */
brdffit_status brdffit_io_merl_finite(const struct merl *merl, brdffit_error *error)
{
    struct io_place place = IO_NOWHERE;
    size_t i, total = MERL_CHANNELS * merl->cells;
    uint64_t seen = 0;

    for (i = 0; i < total; i++) {
        seen |= overflow_of(merl->plane + 8 * i);
    }
    if (!(seen >> 63)) {
        return BRDFFIT_OK;
    }
    for (i = 0; !(overflow_of(merl->plane + 8 * i) >> 63); i++) {
    }
    place.sample = i % merl->cells;
    place.channel = i / merl->cells;
    return brdffit_io_fail_at(error, BRDFFIT_ERR_VALUE,
                              "the MERL table holds NaN or an infinity (sample: index of the cell)", &place,
                              brdffit_io_merl_entry(merl, place.channel, place.sample));
}

static int name_channels(struct io_table *table)
{
    return brdffit_io_table_channels(table, MERL_CHANNELS) && brdffit_io_table_name(table, 0, "r", 1) &&
           brdffit_io_table_name(table, 1, "g", 1) && brdffit_io_table_name(table, 2, "b", 1);
}

int brdffit_io_merl_describe(const struct merl *merl, const brdffit_io_options *options, struct io_table *table)
{
    table->open.format = BRDFFIT_IO_FORMAT_MERL;
    memcpy(table->open.dims, merl->dims, sizeof merl->dims);
    table->open.rows = merl->cells;
    table->open.merl_bins = options->merl_bins;
    table->open.merl_sampling = options->merl_sampling;
    table->samples.quantity = options->quantity_set ? options->quantity : BRDFFIT_QUANTITY_BRDF;
    return name_channels(table);
}

brdffit_status brdffit_io_merl_empty(brdffit_error *error)
{
    return brdffit_io_fail(error, BRDFFIT_ERR_NO_SAMPLES,
                           "every entry asked for is masked (negative) or below the horizon");
}

static brdffit_status sample(const struct merl *merl, const brdffit_io_options *options, struct io_table *table,
                             brdffit_error *error)
{
    double light[84 * 3], view[84 * 3];
    brdffit_samples at;

    switch (options->merl_sampling) {
    case BRDFFIT_IO_MERL_TABLE: return brdffit_io_merl_all(merl, options->merl_bins, table, error);
    case BRDFFIT_IO_MERL_DIRECTIONS:
        (void)brdffit_io_directions(options, &at); /* checked with the options */
        return brdffit_io_merl_at(merl, &at, table, error);
    case BRDFFIT_IO_MERL_PROTOCOL84: break;
    }
    brdffit_io_protocol84(light, view);
    brdffit_samples_init(&at);
    at.count = 84;
    at.light = light;
    at.view = view;
    return brdffit_io_merl_at(merl, &at, table, error);
}

brdffit_status brdffit_io_merl_read(const unsigned char *data, size_t size, const brdffit_io_options *options,
                                    struct io_table *table, brdffit_error *error)
{
    struct merl merl;
    brdffit_status status = brdffit_io_merl_open(data, size, &merl, error);

    if (status == BRDFFIT_OK) {
        status = brdffit_io_merl_finite(&merl, error);
    }
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (!brdffit_io_merl_describe(&merl, options, table)) {
        return brdffit_io_no_memory(error);
    }
    status = sample(&merl, options, table, error);
    if (status == BRDFFIT_OK && table->samples.count == 0) {
        return brdffit_io_merl_empty(error);
    }
    if (status == BRDFFIT_OK) {
        brdffit_io_table_publish(table);
    }
    return status;
}
