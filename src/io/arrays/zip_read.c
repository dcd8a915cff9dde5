/*
 * The zip around the arrays of a .npz: see zip_read.h. SPDX-License-Identifier: MIT
 *
 * The end record is the last thing in the file but for a comment; the zip64 one, when there is, stands before it.
 * The directory that they point to is believed as far as its numbers lie inside the file, and each member's own
 * header has to agree with it in name and method. Names, sizes and places come from the directory alone.
 */
#define ZLIB_CONST
#include "io/arrays/zip_read.h"

#include <string.h>
#include <zlib.h>

#include "io/fail.h"
#include "io/limits.h"
#include "io/bytes/memory.h"
#include "io/bytes/zlib_memory.h"

#define END 22
#define LOCATOR 20
#define END64 56
#define ENTRY 46
#define LOCAL 30
#define CHUNK ((size_t)1 << 30)

struct entry {
    const unsigned char *name;
    size_t name_length;
    unsigned flags, method;
    uint32_t crc;
    uint64_t packed, size, local;
};

struct directory {
    unsigned char *bytes;
    size_t size;
    uint64_t offset, entries;
};

static uint64_t number(const unsigned char *at, int bytes)
{
    uint64_t value = 0;

    while (bytes-- > 0) {
        value = value << 8 | at[bytes];
    }
    return value;
}

static brdffit_status damaged(brdffit_error *error, const char *message, uint64_t at)
{
    return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT, message, (double)at);
}

/* The end record's place: the last signature whose comment reaches exactly to the end of the file. */
static brdffit_status find_end(const struct io_store *store, unsigned char end[END], uint64_t *at, brdffit_error *error)
{
    size_t tail = store->size < END + 65535 ? (size_t)store->size : END + 65535, i;
    unsigned char *bytes = brdffit_io_alloc(tail, 1);
    brdffit_status status;

    if (!bytes) {
        return brdffit_io_no_memory(error);
    }
    status = brdffit_io_store_read(store, store->size - tail, bytes, tail, error);
    for (i = tail >= END ? tail - END + 1 : 0; status == BRDFFIT_OK && i-- > 0;) {
        if (memcmp(bytes + i, "PK\5\6", 4) == 0 && number(bytes + i + 20, 2) == tail - i - END) {
            memcpy(end, bytes + i, END);
            *at = store->size - tail + i;
            brdffit_io_release(bytes);
            return BRDFFIT_OK;
        }
    }
    brdffit_io_release(bytes);
    return status != BRDFFIT_OK
               ? status
               : damaged(error, "the .npz has no end record: it is truncated (value: bytes found)", store->size);
}

/* Replace numbers that did not fit by those of the zip64 end record before `at`. */
static brdffit_status read_end64(const struct io_store *store, uint64_t *at, struct directory *dir, uint64_t *size,
                                 brdffit_error *error)
{
    unsigned char locator[LOCATOR], end[END64];
    brdffit_status status;
    uint64_t place;

    if (*at < LOCATOR) {
        return BRDFFIT_OK;
    }
    status = brdffit_io_store_read(store, *at - LOCATOR, locator, sizeof locator, error);
    if (status != BRDFFIT_OK || memcmp(locator, "PK\6\7", 4) != 0) {
        return status;
    }
    place = number(locator + 8, 8);
    if (*at < LOCATOR + END64 || place > *at - LOCATOR - END64) {
        return damaged(error, "the .npz has a zip64 end record outside of the file (value: at byte)", place);
    }
    status = brdffit_io_store_read(store, place, end, sizeof end, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (memcmp(end, "PK\6\6", 4) != 0) {
        return damaged(error, "the .npz has a damaged zip64 end record (value: at byte)", place);
    }
    dir->entries = number(end + 32, 8);
    *size = number(end + 40, 8);
    dir->offset = number(end + 48, 8);
    *at = place;
    return BRDFFIT_OK;
}

static brdffit_status open_directory(const struct io_store *store, struct directory *dir, brdffit_error *error)
{
    unsigned char end[END];
    uint64_t at = 0, size;
    brdffit_status status = find_end(store, end, &at, error);

    if (status != BRDFFIT_OK) {
        return status;
    }
    dir->entries = number(end + 10, 2);
    size = number(end + 12, 4);
    dir->offset = number(end + 16, 4);
    status = read_end64(store, &at, dir, &size, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (size > at || dir->offset > at - size || size > IO_LIMIT_ZIP_DIRECTORY) {
        return damaged(error, "the .npz has its directory outside of the file, or too large (value: at byte)",
                       dir->offset);
    }
    dir->size = (size_t)size;
    dir->bytes = brdffit_io_alloc(dir->size, 1);
    return dir->bytes ? brdffit_io_store_read(store, dir->offset, dir->bytes, dir->size, error)
                      : brdffit_io_no_memory(error);
}

/* Sizes and place that did not fit 32 bits, from extra field 1. */
static int read_extra(const unsigned char *extra, size_t length, struct entry *e)
{
    uint64_t *const wide[] = {&e->size, &e->packed, &e->local};
    size_t used = 0, i;

    while (length >= 4) {
        size_t field = (size_t)number(extra + 2, 2);

        if (field > length - 4) {
            return 0;
        }
        for (i = 0; number(extra, 2) == 1 && i < 3; i++) {
            if (*wide[i] != 0xffffffff) {
                continue;
            }
            if (field - used < 8) {
                return 0;
            }
            *wide[i] = number(extra + 4 + used, 8);
            used += 8;
        }
        used = 0;
        extra += 4 + field;
        length -= 4 + field;
    }
    return 1;
}

/* The entry at *at, which moves behind it. */
static brdffit_status read_entry(const struct directory *dir, size_t *at, struct entry *e, brdffit_error *error)
{
    const unsigned char *p = dir->bytes + *at;
    size_t left = dir->size - *at, extra, comment;

    if (left < ENTRY || memcmp(p, "PK\1\2", 4) != 0) {
        return damaged(error, "the .npz has a damaged directory (value: at byte)", dir->offset + *at);
    }
    e->flags = (unsigned)number(p + 8, 2);
    e->method = (unsigned)number(p + 10, 2);
    e->crc = (uint32_t)number(p + 16, 4);
    e->packed = number(p + 20, 4);
    e->size = number(p + 24, 4);
    e->name = p + ENTRY;
    e->name_length = (size_t)number(p + 28, 2);
    extra = (size_t)number(p + 30, 2);
    comment = (size_t)number(p + 32, 2);
    e->local = number(p + 42, 4);
    if (e->name_length + extra + comment > left - ENTRY || e->name_length > IO_LIMIT_ZIP_NAME ||
        !read_extra(p + ENTRY + e->name_length, extra, e)) {
        return damaged(error, "the .npz has a damaged directory (value: at byte)", dir->offset + *at);
    }
    *at += ENTRY + e->name_length + extra + comment;
    return BRDFFIT_OK;
}

static int is_named(const struct entry *e, const char *member)
{
    size_t length = member ? strlen(member) : 0;

    if (e->name_length < 4 || memcmp(e->name + e->name_length - 4, ".npy", 4) != 0) {
        return 0;
    }
    return !member || (e->name_length - 4 == length && memcmp(e->name, member, length) == 0);
}

static brdffit_status find(const struct directory *dir, const char *member, struct entry *found, brdffit_error *error)
{
    size_t at = 0;
    uint64_t i, hits = 0;

    for (i = 0; i < dir->entries; i++) {
        struct entry e;
        brdffit_status status = read_entry(dir, &at, &e, error);

        if (status != BRDFFIT_OK) {
            return status;
        }
        if (is_named(&e, member)) {
            *found = e;
            hits++;
        }
    }
    if (hits == 0) {
        return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT,
                               member ? "the .npz has no array of that name" : "the .npz holds no array");
    }
    if (hits > 1) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_FORMAT,
                                     member ? "the .npz has the array twice (value: times)"
                                            : "the .npz holds several arrays: name one (value: arrays)",
                                     (double)hits);
    }
    return BRDFFIT_OK;
}

/* Where the member's bytes begin, from its own header. */
static brdffit_status locate(const struct io_store *store, const struct directory *dir, const struct entry *e,
                             uint64_t *data, brdffit_error *error)
{
    unsigned char local[LOCAL + IO_LIMIT_ZIP_NAME];
    size_t size = LOCAL + e->name_length;
    brdffit_status status;

    if (e->flags & 1) {
        return brdffit_io_fail(error, BRDFFIT_ERR_FORMAT, "the member of the .npz is encrypted");
    }
    if (e->method != 0 && e->method != 8) {
        return damaged(error, "the member of the .npz is neither stored nor deflated (value: method)", e->method);
    }
    if (e->local > dir->offset || size > dir->offset - e->local) {
        return damaged(error, "the .npz has a member outside of the file (value: at byte)", e->local);
    }
    status = brdffit_io_store_read(store, e->local, local, size, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    if (memcmp(local, "PK\3\4", 4) != 0 || number(local + 8, 2) != e->method ||
        number(local + 26, 2) != e->name_length || memcmp(local + LOCAL, e->name, e->name_length) != 0) {
        return damaged(error, "the .npz has a member that its directory does not describe (value: at byte)", e->local);
    }
    *data = e->local + size + number(local + 28, 2);
    if (*data > dir->offset || e->packed > dir->offset - *data || (e->method == 0 && e->packed != e->size)) {
        return damaged(error, "the .npz has a member that is longer than the file (value: at byte)", e->local);
    }
    return BRDFFIT_OK;
}

/* Where the unpacking of a member stands. */
struct inflation {
    const struct io_store *store;
    uint64_t from, left; /* packed bytes */
    unsigned char packed[65536];
    z_stream z;
};

/* Up to `room` bytes into `out`; *got tells how many there were. Z_OK: there are more. */
static brdffit_status inflate_some(struct inflation *at, unsigned char *out, uint64_t room, uint64_t *got, int *code,
                                   brdffit_error *error)
{
    uint64_t left = room;

    at->z.next_out = out;
    at->z.avail_out = 0;
    *code = Z_OK;
    while (*code == Z_OK && (left > 0 || at->z.avail_out > 0)) {
        if (at->z.avail_in == 0 && at->left > 0) {
            size_t n = at->left < sizeof at->packed ? (size_t)at->left : sizeof at->packed;
            brdffit_status status = brdffit_io_store_read(at->store, at->from, at->packed, n, error);

            if (status != BRDFFIT_OK) {
                return status;
            }
            at->z.next_in = at->packed;
            at->z.avail_in = (uInt)n;
            at->from += n;
            at->left -= n;
        }
        if (at->z.avail_out == 0) {
            at->z.avail_out = (uInt)(left < CHUNK ? left : CHUNK);
            left -= at->z.avail_out;
        }
        *code = inflate(&at->z, Z_NO_FLUSH);
    }
    *got = room - left - at->z.avail_out;
    return *code == Z_MEM_ERROR ? brdffit_io_no_memory(error) : BRDFFIT_OK;
}

static brdffit_status start_inflation(struct inflation *at, const struct io_store *store, uint64_t data,
                                      const struct entry *e, brdffit_error *error)
{
    at->store = store;
    at->from = data;
    at->left = e->packed;
    brdffit_io_zlib_start(&at->z);
    return inflateInit2(&at->z, -MAX_WBITS) == Z_OK ? BRDFFIT_OK : brdffit_io_no_memory(error);
}

/* The room is that of the claimed size, which the packed one and the array's header bound. */
static brdffit_status inflate_all(const struct io_store *store, uint64_t data, const struct entry *e,
                                  unsigned char *out, brdffit_error *error)
{
    struct inflation at;
    uint64_t got = 0;
    int code = Z_OK;
    brdffit_status status = start_inflation(&at, store, data, e, error);

    if (status != BRDFFIT_OK) {
        return status;
    }
    status = inflate_some(&at, out, e->size, &got, &code, error);
    if (status == BRDFFIT_OK && code == Z_OK && got == e->size) { /* full: only the end may come */
        unsigned char more;
        uint64_t beyond = 0;

        status = inflate_some(&at, &more, 1, &beyond, &code, error);
        code = beyond > 0 ? Z_DATA_ERROR : code;
    }
    (void)inflateEnd(&at.z);
    if (status == BRDFFIT_OK && (code != Z_STREAM_END || at.left > 0 || at.z.avail_in > 0 || got < e->size)) {
        return brdffit_io_fail_value(error, BRDFFIT_ERR_READ,
                                     "the deflated member of the .npz is damaged (value: after unpacked bytes)",
                                     (double)got);
    }
    return status;
}

/* What the array's header says of its size, before the rest is unpacked: a hostile member costs no more than this. */
static brdffit_status check_header(const struct io_array *array, uint64_t data, const struct entry *e,
                                   brdffit_error *error)
{
    const uint64_t most = 12 + IO_LIMIT_NPY_HEADER, size = e->size < most ? e->size : most;
    struct io_array header;
    struct inflation at;
    uint64_t got = 0;
    int code = Z_OK;
    unsigned char *start = brdffit_io_alloc_zero((size_t)size, 1); /* what is damaged will be found damaged */
    brdffit_status status = start ? start_inflation(&at, &array->store, data, e, error) : brdffit_io_no_memory(error);

    if (status == BRDFFIT_OK) {
        status = inflate_some(&at, start, size, &got, &code, error);
        (void)inflateEnd(&at.z);
    }
    if (status == BRDFFIT_OK && got == size) {
        memset(&header, 0, sizeof header);
        brdffit_io_store_memory(start, (size_t)size, &header.store);
        header.end = e->size;
        status = brdffit_io_npy_open(&header, error);
    }
    brdffit_io_release(start);
    return status;
}

static brdffit_status unpack(struct io_array *array, uint64_t data, const struct entry *e, brdffit_error *error)
{
    unsigned char *out;
    brdffit_status status;

    if (e->size > IO_LIMIT_BYTES || e->size / 1040 > e->packed) {
        return damaged(error, "the .npz has a member that claims to unpack to too much (value: bytes)", e->size);
    }
    status = check_header(array, data, e, error);
    if (status != BRDFFIT_OK) {
        return status;
    }
    out = brdffit_io_alloc((size_t)e->size, 1);
    if (!out) {
        return brdffit_io_no_memory(error);
    }
    status = inflate_all(&array->store, data, e, out, error);
    if (status == BRDFFIT_OK && brdffit_io_crc32(0, out, (size_t)e->size) != e->crc) {
        status = brdffit_io_fail(error, BRDFFIT_ERR_READ,
                                 "the checksum of the member of the .npz does not match: the file is damaged");
    }
    brdffit_io_store_close(&array->store);
    brdffit_io_store_memory(out, (size_t)e->size, &array->store);
    array->store.owned = out;
    array->open.compressed = 1;
    array->data = 0;
    array->end = e->size;
    return status;
}

brdffit_status brdffit_io_zip_select(struct io_array *array, const char *member, brdffit_error *error)
{
    struct directory dir = {NULL, 0, 0, 0};
    struct entry e;
    uint64_t data = 0;
    brdffit_status status = open_directory(&array->store, &dir, error);

    if (status == BRDFFIT_OK) {
        status = find(&dir, member, &e, error);
    }
    if (status == BRDFFIT_OK) {
        status = locate(&array->store, &dir, &e, &data, error);
    }
    if (status == BRDFFIT_OK && e.method == 8) {
        status = unpack(array, data, &e, error);
    } else if (status == BRDFFIT_OK) {
        array->data = data;
        array->end = data + e.size;
    }
    brdffit_io_release(dir.bytes);
    return status;
}
