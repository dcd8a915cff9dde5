/*
 * A .npz to be written: stored members, zip64 where sizes ask for it. SPDX-License-Identifier: MIT
 */
#include <stdint.h>
#include <string.h>
#include <zlib.h>

#include "brdffit_io.h"
#include "io/limits.h"
#include "io/bytes/memory.h"

#define LOCAL 30
#define ENTRY 46
#define WIDE 0xffffffffu

struct brdffit_io_zip {
    brdffit_io_write_fn write;
    void *user;
    uint64_t offset;          /* bytes written */
    unsigned char *directory; /* so far */
    size_t directory_size, entries;
    uint64_t left;            /* bytes that the member still owes */
    unsigned long crc, claimed;
};

unsigned long brdffit_io_crc32(unsigned long crc, const void *data, size_t size)
{
    return crc32_z(crc, data, size);
}

static unsigned char *put(unsigned char *at, int bytes, uint64_t value)
{
    for (; bytes > 0; bytes--, value >>= 8) {
        *at++ = (unsigned char)(value & 255);
    }
    return at;
}

static brdffit_status emit(brdffit_io_zip *zip, const void *data, size_t size)
{
    if (zip->write(zip->user, data, size) != 0) {
        return BRDFFIT_ERR_READ;
    }
    zip->offset += size;
    return BRDFFIT_OK;
}

brdffit_io_zip *brdffit_io_zip_new(brdffit_io_write_fn write, void *user)
{
    brdffit_io_zip *zip = write ? brdffit_io_alloc_zero(1, sizeof *zip) : NULL;

    if (zip) {
        zip->write = write;
        zip->user = user;
    }
    return zip;
}

/* Needed version, no flags, stored, 1 January 1980 (there is nothing before), checksum, sizes, length of the name. */
static unsigned char *put_common(unsigned char *at, int wide, unsigned long crc, uint64_t size, size_t name)
{
    at = put(at, 2, wide ? 45 : 20);
    at = put(at, 8, UINT64_C(0x0021000000000000));
    at = put(at, 4, crc);
    at = put(at, 4, wide ? WIDE : size);
    at = put(at, 4, wide ? WIDE : size);
    return put(at, 2, name);
}

brdffit_status brdffit_io_zip_begin(brdffit_io_zip *zip, const char *name, unsigned long long size, unsigned long crc)
{
    size_t length = name ? strlen(name) : 0;
    unsigned char local[LOCAL + IO_LIMIT_ZIP_NAME + 20], *at = local, *entry;
    int wide = size >= WIDE || (zip && zip->offset >= WIDE);

    if (!zip || length == 0 || length > IO_LIMIT_ZIP_NAME || zip->left > 0 || zip->crc != zip->claimed) {
        return BRDFFIT_ERR_ARGUMENT;
    }
    entry = brdffit_io_resize(zip->directory, zip->directory_size + ENTRY + length + 28, 1);
    if (!entry) {
        return BRDFFIT_ERR_MEMORY;
    }
    zip->directory = entry;
    entry += zip->directory_size;
    entry = put(entry, 4, 0x02014b50);
    entry = put_common(put(entry, 2, 45), wide, crc, size, length);
    entry = put(entry, 2, wide ? 28 : 0);
    entry = put(entry, 8, 0); /* comment, disk, attributes */
    entry = put(entry, 2, 0);
    entry = put(entry, 4, wide ? WIDE : zip->offset);
    memcpy(entry, name, length);
    entry += length;
    if (wide) {
        entry = put(put(put(put(put(entry, 2, 1), 2, 24), 8, size), 8, size), 8, zip->offset);
    }
    zip->directory_size = (size_t)(entry - zip->directory);
    zip->entries++;
    at = put_common(put(at, 4, 0x04034b50), wide, crc, size, length);
    at = put(at, 2, wide ? 20 : 0);
    memcpy(at, name, length);
    at += length;
    if (wide) {
        at = put(put(put(put(at, 2, 1), 2, 16), 8, size), 8, size);
    }
    zip->left = size;
    zip->crc = 0;
    zip->claimed = crc;
    return emit(zip, local, (size_t)(at - local));
}

brdffit_status brdffit_io_zip_write(brdffit_io_zip *zip, const void *data, size_t size)
{
    if (!zip || size > zip->left) {
        return BRDFFIT_ERR_ARGUMENT;
    }
    zip->crc = brdffit_io_crc32(zip->crc, data, size);
    zip->left -= size;
    return emit(zip, data, size);
}

static brdffit_status end(brdffit_io_zip *zip)
{
    unsigned char record[56 + 20 + 22], *at = record;
    uint64_t directory = zip->offset;
    brdffit_status status = emit(zip, zip->directory, zip->directory_size);
    int wide = directory >= WIDE || zip->entries >= 0xffff;

    if (wide) {
        at = put(put(put(put(put(at, 4, 0x06064b50), 8, 44), 2, 45), 2, 45), 8, 0);
        at = put(put(put(put(at, 8, zip->entries), 8, zip->entries), 8, zip->directory_size), 8, directory);
        at = put(put(put(put(at, 4, 0x07064b50), 4, 0), 8, zip->offset), 4, 1);
    }
    at = put(put(at, 4, 0x06054b50), 4, 0);
    at = put(put(at, 2, wide ? 0xffff : zip->entries), 2, wide ? 0xffff : zip->entries);
    at = put(put(put(at, 4, zip->directory_size), 4, wide ? WIDE : directory), 2, 0);
    return status != BRDFFIT_OK ? status : emit(zip, record, (size_t)(at - record));
}

brdffit_status brdffit_io_zip_finish(brdffit_io_zip *zip, int abandon)
{
    brdffit_status status = BRDFFIT_OK;

    if (!zip) {
        return BRDFFIT_ERR_MEMORY;
    }
    if (!abandon) {
        status = zip->left > 0 || zip->crc != zip->claimed ? BRDFFIT_ERR_ARGUMENT : end(zip);
    }
    brdffit_io_release(zip->directory);
    brdffit_io_release(zip);
    return status;
}
