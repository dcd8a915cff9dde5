/*
 * gzip streams in memory: see gzip.h. SPDX-License-Identifier: MIT
 *
 * inflate() rather than gzread(): it works on memory as on files, tells a truncated stream from a damaged one,
 * and does not let bytes after the last member pass unseen. The length that a member claims in its trailer is
 * never used to allocate: the buffer grows with what was really unpacked.
 */
#define ZLIB_CONST
#include "io/bytes/gzip.h"

#include <string.h>
#include <zlib.h>

#include "io/fail.h"
#include "io/limits.h"
#include "io/bytes/memory.h"
#include "io/bytes/zlib_memory.h"

/* Fits zlib's uInt. */
#define CHUNK ((size_t)1 << 30)

int brdffit_io_is_gzip(const unsigned char *data, size_t size)
{
    return size >= 2 && data[0] == 0x1f && data[1] == 0x8b;
}

static brdffit_status damaged(const z_stream *stream, brdffit_error *error)
{
    const char *said = stream->msg ? stream->msg : "";

    if (strcmp(said, "incorrect data check") == 0) {
        return brdffit_io_fail(error, BRDFFIT_ERR_READ, "the gzip checksum does not match: the file is damaged");
    }
    if (strcmp(said, "incorrect length check") == 0) {
        return brdffit_io_fail(error, BRDFFIT_ERR_READ, "the gzip length does not match: the file is damaged");
    }
    if (strcmp(said, "unknown compression method") == 0) {
        return brdffit_io_fail(error, BRDFFIT_ERR_READ, "the gzip header names an unknown compression method");
    }
    return brdffit_io_fail(error, BRDFFIT_ERR_READ, "the gzip data are damaged");
}

/* One member. *used becomes the bytes of input that it took. */
static brdffit_status member(z_stream *stream, const unsigned char *data, size_t size,
                             const struct io_gzip_limit *limit, struct io_bytes *out, size_t *used,
                             brdffit_error *error)
{
    size_t taken = 0;

    for (;;) {
        size_t left = size - taken, room;
        int code;

        if (!brdffit_io_bytes_grow(out, limit->bytes + 1)) {
            return brdffit_io_no_memory(error);
        }
        room = out->capacity - out->size;
        stream->next_in = data + taken;
        stream->avail_in = (uInt)(left < CHUNK ? left : CHUNK);
        stream->next_out = out->data + out->size;
        stream->avail_out = (uInt)(room < CHUNK ? room : CHUNK);
        code = inflate(stream, Z_NO_FLUSH);
        taken = (size_t)(stream->next_in - data);
        out->size = (size_t)(stream->next_out - out->data);
        *used = taken;
        if (out->size > limit->bytes) {
            return limit->message
                       ? brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT, limit->message, (double)limit->bytes)
                       : BRDFFIT_OK;
        }
        if (code == Z_STREAM_END) {
            return BRDFFIT_OK;
        }
        if (code == Z_MEM_ERROR) {
            return brdffit_io_no_memory(error);
        }
        if (code == Z_BUF_ERROR) { /* no progress although there was room: the input has run out */
            return brdffit_io_fail(error, BRDFFIT_ERR_READ, "the gzip stream ends early: the file is truncated");
        }
        if (code != Z_OK) {
            return damaged(stream, error);
        }
    }
}

static brdffit_status members(z_stream *stream, const unsigned char *data, size_t size,
                              const struct io_gzip_limit *limit, struct io_bytes *out, brdffit_error *error)
{
    size_t at = 0;

    while (at < size && out->size <= limit->bytes) {
        size_t used = 0;
        brdffit_status status;

        if (!brdffit_io_is_gzip(data + at, size - at)) {
            return brdffit_io_fail_value(error, BRDFFIT_ERR_READ,
                                         "bytes follow the end of the gzip stream that are not gzip",
                                         (double)(size - at));
        }
        if (at > 0 && inflateReset(stream) != Z_OK) {
            return brdffit_io_fail(error, BRDFFIT_ERR_READ, "zlib does not work");
        }
        status = member(stream, data + at, size - at, limit, out, &used, error);
        if (status != BRDFFIT_OK) {
            return status;
        }
        at += used;
    }
    return BRDFFIT_OK;
}

brdffit_status brdffit_io_gunzip(const unsigned char *data, size_t size, const struct io_gzip_limit *limit,
                                 struct io_bytes *out, brdffit_error *error)
{
    z_stream stream;
    brdffit_status status;
    size_t guess = size < limit->bytes / 4 ? 4 * size : limit->bytes;
    int code;

    brdffit_io_zlib_start(&stream);
    code = inflateInit2(&stream, 16 + MAX_WBITS); /* 16: gzip headers, checksums verified */
    if (code != Z_OK) {
        return code == Z_MEM_ERROR ? brdffit_io_no_memory(error)
                                   : brdffit_io_fail(error, BRDFFIT_ERR_READ, "zlib does not work");
    }
    if (!brdffit_io_bytes_reserve(out, guess < IO_FIRST_BUFFER ? IO_FIRST_BUFFER : guess)) {
        status = brdffit_io_no_memory(error);
    } else {
        status = members(&stream, data, size, limit, out, error);
    }
    (void)inflateEnd(&stream);
    return status;
}
