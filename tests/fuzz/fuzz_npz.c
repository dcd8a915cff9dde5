/*
 * Fuzz target: .npz, stored and deflated. SPDX-License-Identifier: MIT
 */
#include <zlib.h>

#include "fuzz/array_claims.h"
#include "fuzz/standalone.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    claim_array(data, size, NULL);
    claim_array(data, size, "b");
    return 0;
}

#if !defined(BRDFFIT_LIBFUZZER)

#define SEED_COUNT 3

struct seed_sink {
    unsigned char *at;
};

static int seed_write(void *user, const void *data, size_t size)
{
    struct seed_sink *sink = user;

    memcpy(sink->at, data, size);
    sink->at += size;
    return 0;
}

/* Two members, a and b. */
static size_t seed_stored(unsigned char *out)
{
    static unsigned char npy[1024];
    size_t size = seed_npy(npy, "<f4", "False", 4);
    struct seed_sink sink = {out};
    brdffit_io_zip *zip = brdffit_io_zip_new(seed_write, &sink);

    CLAIM(brdffit_io_zip_begin(zip, "a.npy", size, brdffit_io_crc32(0, npy, size)) == BRDFFIT_OK);
    CLAIM(brdffit_io_zip_write(zip, npy, size) == BRDFFIT_OK);
    CLAIM(brdffit_io_zip_begin(zip, "b.npy", size, brdffit_io_crc32(0, npy, size)) == BRDFFIT_OK);
    CLAIM(brdffit_io_zip_write(zip, npy, size) == BRDFFIT_OK);
    CLAIM(brdffit_io_zip_finish(zip, 0) == BRDFFIT_OK);
    return (size_t)(sink.at - out);
}

static void seed_put(unsigned char **at, int bytes, unsigned long value)
{
    for (; bytes > 0; bytes--, value >>= 8) {
        *(*at)++ = (unsigned char)(value & 255);
    }
}

/* One deflated member named `b`, byte by byte; with `wide`, sizes and place in zip64's extra field. */
static size_t seed_deflated(unsigned char *out, int wide)
{
    unsigned char npy[1024], packed[1024], *at = out, *directory;
    unsigned long size = (unsigned long)seed_npy(npy, ">f8", "True", 8), length, crc = brdffit_io_crc32(0, npy, size);
    z_stream z;
    int part;

    memset(&z, 0, sizeof z);
    CLAIM(deflateInit2(&z, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) == Z_OK);
    z.next_in = npy;
    z.avail_in = (uInt)size;
    z.next_out = packed;
    z.avail_out = sizeof packed;
    CLAIM(deflate(&z, Z_FINISH) == Z_STREAM_END);
    length = sizeof packed - z.avail_out;
    (void)deflateEnd(&z);
    directory = at;
    for (part = 0; part < 2; part++) { /* local header, data, directory */
        directory = at;
        seed_put(&at, 4, part ? 0x02014b50 : 0x04034b50);
        seed_put(&at, part ? 4 : 2, 20);
        seed_put(&at, 2, 0);
        seed_put(&at, 2, 8);
        seed_put(&at, 4, 0);
        seed_put(&at, 4, crc);
        seed_put(&at, 4, part && wide ? 0xffffffff : length);
        seed_put(&at, 4, part && wide ? 0xffffffff : size);
        seed_put(&at, 2, 5);
        seed_put(&at, 2, part && wide ? 20 : 0);
        seed_put(&at, part ? 14 : 0, 0);
        memcpy(at, "b.npy", 5);
        at += 5;
        if (part && wide) {
            seed_put(&at, 4, 16 << 16 | 1);
            seed_put(&at, 8, size);
            seed_put(&at, 8, length);
        } else if (!part) {
            memcpy(at, packed, length);
            at += length;
        }
    }
    length = (unsigned long)(at - directory);
    seed_put(&at, 8, 0x06054b50);
    seed_put(&at, 4, 1 << 16 | 1);
    seed_put(&at, 4, length);
    seed_put(&at, 6, (unsigned long)(directory - out));
    return (size_t)(at - out);
}

/* Static storage: filled by the first call. */
static const struct fuzz_seed *make_seeds(void)
{
    static unsigned char data[SEED_COUNT][4096];
    static struct fuzz_seed seeds[SEED_COUNT];
    int i;

    seeds[0].size = seed_stored(data[0]);
    seeds[1].size = seed_deflated(data[1], 0);
    seeds[2].size = seed_deflated(data[2], 1);
    for (i = 0; i < SEED_COUNT; i++) {
        seeds[i].data = data[i];
    }
    return seeds;
}

FUZZ_MAIN(make_seeds(), SEED_COUNT)
#endif
