/*
 * Deterministic mutations, for machines without a fuzzer and for the tests. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_FUZZ_MUTATE_H
#define BRDFFIT_FUZZ_MUTATE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

struct fuzz_seed {
    const unsigned char *data;
    size_t size;
};

/* xorshift64*: the same sequence everywhere. */
static inline size_t mutate_random(uint64_t *state, size_t below)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return (size_t)((*state * 2685821657736338717u) >> 33) % (below ? below : 1);
}

static inline size_t mutate_remove(unsigned char *data, size_t size, size_t at, size_t length)
{
    length = length < size - at ? length : size - at;
    memmove(data + at, data + at + length, size - at - length);
    return size - length;
}

static inline size_t mutate_insert(unsigned char *data, size_t size, size_t capacity, size_t at, const void *what,
                                   size_t length)
{
    if (length > capacity - size) {
        return size;
    }
    memmove(data + at + length, data + at, size - at);
    memcpy(data + at, what, length);
    return size + length;
}

/* Pieces that parsers trip over. */
static inline size_t mutate_token(uint64_t *state, unsigned char *data, size_t size, size_t capacity, size_t at)
{
    /* clang-format off */
    static const char *const token[] = {
        ",", ";", "\t", "\n", "\r", "\r\n", "\"", "\"\"", "#", " ", "-", "+", ".", "e", "E-9", "1e999", "-1e-999",
        "nan", "inf", "0x1p-3", "1,5", "180", "180.0001", "-0", "theta_i", "theta_o", "phi_i", "phi_o", "lx", "ly",
        "lz", "vx", "vy", "vz", "nx", "ny", "nz", "a", "b", "c", "w", "weight", "_deg", "\xef\xbb\xbf", "\xff\xfe",
        "\x1f\x8b\x08",
        "%", "|", "//", "sep=;\n", "NA", "-999", "99999", "1.5D-3", "1.234,5", "phi", "theta_h", "wavelength", "valid",
        "sigma", "(rad)", "[deg]", "\xc2\xb0", "\xe2\x88\x92", "\xc2\xa0", "\xce\xb8", "dB", "elevation", "#3",
        "{", "}", "[", "]", ":", "null", "true", "\\u0000", "\\", "file", "sigma", "--tile", "IDAT", "PLTE", "IHDR", " x ",
        "00000000000000000000000000000000000000", "9007199254740993", "\x7f",
    };
    /* clang-format on */
    static const unsigned char binary[][8] = {
        {0},          {0xff, 0xff, 0xff, 0x7f},       {0xff, 0xff, 0xff, 0xff},       {0, 0, 0, 0x80},
        {1, 0, 0, 0}, {0, 0, 0, 0, 0, 0, 0xf0, 0x7f}, {0, 0, 0, 0, 0, 0, 0xf8, 0x7f}, {0, 0, 0, 0, 0, 0, 0xf0, 0xbf},
    };
    size_t pick = mutate_random(state, sizeof token / sizeof *token + sizeof binary / sizeof *binary);

    if (pick < sizeof token / sizeof *token) {
        return mutate_insert(data, size, capacity, at, token[pick], strlen(token[pick]));
    }
    pick -= sizeof token / sizeof *token;
    if (mutate_random(state, 2) && size - at >= 8) { /* in place, so that sizes stay right */
        memcpy(data + at, binary[pick], mutate_random(state, 2) ? 8 : 4);
        return size;
    }
    return mutate_insert(data, size, capacity, at, binary[pick], mutate_random(state, 2) ? 8 : 4);
}

/* Change data[0 .. size) in up to four places; returns the new size, at most `capacity`. */
static inline size_t mutate(uint64_t *state, unsigned char *data, size_t size, size_t capacity)
{
    size_t changes = 1 + mutate_random(state, 4);

    while (changes--) {
        /* Half of the changes near the start, where headers are. */
        size_t at = mutate_random(state, mutate_random(state, 2) ? size : size < 64 ? size : 64);

        if (size == 0) {
            return mutate_token(state, data, 0, capacity, 0);
        }
        switch (mutate_random(state, 6)) {
        case 0: data[at] = (unsigned char)(data[at] ^ 1u << mutate_random(state, 8)); break;
        case 1: data[at] = (unsigned char)mutate_random(state, 256); break;
        case 2: size = mutate_remove(data, size, at, 1 + mutate_random(state, 9)); break;
        case 3: size = mutate_random(state, 8) ? size : at; break; /* cut the end off, now and then */
        case 4: {
            unsigned char piece[32];
            size_t length = 1 + mutate_random(state, sizeof piece);

            length = length < size - at ? length : size - at;
            memcpy(piece, data + at, length);
            size = mutate_insert(data, size, capacity, mutate_random(state, size), piece, length);
            break;
        }
        default: size = mutate_token(state, data, size, capacity, at); break;
        }
    }
    return size;
}

#endif
