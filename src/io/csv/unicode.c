/*
 * Plain text out of what spreadsheets save: see unicode.h. SPDX-License-Identifier: MIT
 */
#include "io/csv/unicode.h"

#include <string.h>

#define PROBE ((size_t)256)

static const struct {
    const char *from;
    char to; /* 0: nothing */
} signs[] = {
    {"\xe2\x88\x92", '-'}, {"\xe2\x80\x92", '-'}, {"\xe2\x80\x93", '-'}, {"\xe2\x80\x94", '-'},
    {"\xef\xbc\x8d", '-'}, {"\xc2\xa0", ' '},     {"\xe2\x80\xaf", ' '}, {"\xe2\x80\x87", ' '},
    {"\xe2\x80\x89", ' '}, {"\xe2\x80\x82", ' '}, {"\xe2\x80\x83", ' '}, {"\xe3\x80\x80", ' '},
    {"\xef\xbb\xbf", 0},   {"\xe2\x80\x8b", 0},   {"\xe2\x80\x8e", 0},   {"\xe2\x80\x8f", 0},
};

enum io_utf16 brdffit_io_utf16(const unsigned char *data, size_t size)
{
    size_t zeros[2] = {0, 0}, i;

    if (size >= 2 && data[0] == 0xff && data[1] == 0xfe) {
        return IO_UTF16_LITTLE;
    }
    if (size >= 2 && data[0] == 0xfe && data[1] == 0xff) {
        return IO_UTF16_BIG;
    }
    size = size < PROBE ? size & ~(size_t)1 : PROBE;
    for (i = 0; i < size; i++) {
        zeros[i & 1] += data[i] == 0;
    }
    if (size < 16 || zeros[0] + zeros[1] < 2 * size / 5 || (zeros[0] > 0 && zeros[1] > 0)) {
        return IO_UTF16_NOT;
    }
    return zeros[1] > 0 ? IO_UTF16_LITTLE : IO_UTF16_BIG;
}

/* Bytes of a code point in UTF-8. */
static size_t encode(unsigned long c, unsigned char *out)
{
    static const unsigned char first[5] = {0, 0, 0xc0, 0xe0, 0xf0};
    const size_t length = c < 0x80 ? 1 : c < 0x800 ? 2 : c < 0x10000 ? 3 : 4;
    size_t i;

    for (i = length; i-- > 1; c >>= 6) {
        out[i] = (unsigned char)(0x80 | (c & 0x3f));
    }
    out[0] = (unsigned char)(first[length] | c);
    return length;
}

static unsigned long unit(const unsigned char *at, enum io_utf16 order)
{
    return order == IO_UTF16_LITTLE ? (unsigned long)at[0] | (unsigned long)at[1] << 8
                                    : (unsigned long)at[1] | (unsigned long)at[0] << 8;
}

/* Half of a pair without the other becomes U+FFFD. */
static int decode(const unsigned char *data, size_t size, enum io_utf16 order, struct io_bytes *out)
{
    size_t i;

    if (!brdffit_io_bytes_reserve(out, size / 2 * 3 + 4)) {
        return 0;
    }
    for (i = 0; i + 1 < size; i += 2) {
        unsigned long c = unit(data + i, order);

        if (c >= 0xd800 && c < 0xdc00 && i + 3 < size && (unit(data + i + 2, order) & 0xfc00) == 0xdc00) {
            c = 0x10000 + ((c & 0x3ff) << 10) + (unit(data + i + 2, order) & 0x3ff);
            i += 2;
        } else if (c >= 0xd800 && c < 0xe000) {
            c = 0xfffd;
        }
        out->size += encode(c, out->data + out->size);
    }
    return 1;
}

/* Which of the signs is at `at`, or their number. */
static size_t sign_at(const unsigned char *at, const unsigned char *end)
{
    size_t i;

    for (i = 0; i < sizeof signs / sizeof *signs; i++) {
        const size_t n = strlen(signs[i].from);

        if ((size_t)(end - at) >= n && memcmp(at, signs[i].from, n) == 0) {
            break;
        }
    }
    return i;
}

static int has_sign(const unsigned char *at, const unsigned char *end)
{
    for (; at < end; at++) {
        if (*at >= 0x80 && sign_at(at, end) < sizeof signs / sizeof *signs) {
            return 1;
        }
    }
    return 0;
}

/* `to` may be the very text: it never gets longer. */
static size_t replace(const unsigned char *at, const unsigned char *end, unsigned char *to, struct io_plain *done)
{
    unsigned char *const start = to;

    while (at < end) {
        const size_t which = *at >= 0x80 ? sign_at(at, end) : sizeof signs / sizeof *signs;

        if (which == sizeof signs / sizeof *signs) {
            *to++ = *at++;
            continue;
        }
        at += strlen(signs[which].from);
        done->minus += signs[which].to == '-';
        done->blanks += signs[which].to != '-';
        if (signs[which].to) {
            *to++ = (unsigned char)signs[which].to;
        }
    }
    return (size_t)(to - start);
}

int brdffit_io_plain(const unsigned char *data, size_t size, struct io_bytes *out, struct io_plain *done)
{
    const size_t mark = size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;

    memset(done, 0, sizeof *done);
    done->utf16 = brdffit_io_utf16(data, size);
    if (done->utf16 != IO_UTF16_NOT) {
        const size_t skip = data[0] >= 0xfe ? 2 : 0;

        if (!decode(data + skip, size - skip, done->utf16, out)) {
            return 0;
        }
        out->size = replace(out->data, out->data + out->size, out->data, done);
        return 1;
    }
    if (!has_sign(data + mark, data + size)) {
        return 1;
    }
    if (!brdffit_io_bytes_reserve(out, size)) {
        return 0;
    }
    out->size = replace(data + mark, data + size, out->data, done);
    return 1;
}
