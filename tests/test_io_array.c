/*
 * Arrays: elements of every type, blocks in every order, headers that lie, and writing. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <unistd.h>

#include "io_support.h"

/* A .npy in memory: version 1, this dictionary, `size` bytes behind it. */
struct npy {
    unsigned char bytes[2048];
    size_t size;
};

static struct npy npy_of(const char *dictionary, const void *data, size_t size)
{
    struct npy npy;
    size_t length = strlen(dictionary);

    memcpy(npy.bytes, "\x93NUMPY\1\0", 8);
    npy.bytes[8] = (unsigned char)(length & 255);
    npy.bytes[9] = (unsigned char)(length >> 8);
    memcpy(npy.bytes + 10, dictionary, length);
    memcpy(npy.bytes + 10 + length, data, size);
    npy.size = 10 + length + size;
    return npy;
}

static brdffit_array *good(const struct npy *npy)
{
    brdffit_array *array = NULL;
    brdffit_error error;

    memset(&error, 0, sizeof error);
    if (brdffit_io_array_open_memory(npy->bytes, npy->size, NULL, &array, &error) != BRDFFIT_OK) {
        print_error("refused: %s (%g)\n", error.message, error.value);
        fail();
    }
    return array;
}

static double only(const char *type, const void *data, size_t size)
{
    char dictionary[128];
    struct npy npy;
    brdffit_array *array;
    double value = -1.0;

    snprintf(dictionary, sizeof dictionary, "{'descr': '%s', 'fortran_order': False, 'shape': (), }", type);
    npy = npy_of(dictionary, data, size);
    array = good(&npy);
    assert_int_equal(array->dims, 0);
    assert_int_equal(array->count, 1);
    assert_int_equal(brdffit_io_array_read(array, NULL, NULL, &value, NULL), BRDFFIT_OK);
    brdffit_io_array_close(array);
    return value;
}

static void test_elements(void **state)
{
    (void)state;
    assert_same(only("|b1", "\1", 1), 1.0);
    assert_same(only("|b1", "\7", 1), 1.0);
    assert_same(only("|i1", "\x80", 1), -128.0);
    assert_same(only("|u1", "\x80", 1), 128.0);
    assert_same(only("<i2", "\xff\xff", 2), -1.0);
    assert_same(only(">i2", "\x80\x00", 2), -32768.0);
    assert_same(only(">u2", "\x12\x34", 2), 0x1234);
    assert_same(only("<i8", "\0\0\0\0\0\0\0\x80", 8), -9223372036854775808.0);
    assert_same(only("<u8", "\xff\xff\xff\xff\xff\xff\xff\xff", 8), 18446744073709551616.0);
    assert_same(only("<f2", "\x00\x3c", 2), 1.0);
    assert_same(only("<f2", "\x01\x00", 2), ldexp(1.0, -24));
    assert_same(only("<f2", "\xff\x03", 2), ldexp(1023.0, -24));
    assert_same(only("<f2", "\xff\x7b", 2), 65504.0);
    assert_same(only(">f2", "\xfc\x00", 2), -INFINITY);
    assert_true(isnan(only("<f2", "\x01\x7c", 2)));
    assert_same(only(">f4", "\xc0\x49\x0f\xdb", 4), (double)-3.14159274f);
    assert_same(only("<f8", "\1\0\0\0\0\0\0\0", 8), ldexp(1.0, -1074));
    assert_same(only("|u1", "\5", 1), only("<u1", "\5", 1));
}

/* 4 x 3 x 2 in either order: every block there is, against the definition. */
static void check_blocks(int fortran)
{
    static const size_t shape[3] = {4, 3, 2};
    unsigned char data[24];
    struct npy npy;
    brdffit_array *array;
    size_t i, s[3], n[3], at[3], blocks = 0;

    for (i = 0; i < 24; i++) {
        data[i] = (unsigned char)i;
    }
    npy = npy_of(fortran ? "{'descr': '|u1', 'fortran_order': True, 'shape': (4, 3, 2), }"
                         : "{'descr': '|u1', 'fortran_order': False, 'shape': (4, 3, 2), }",
                 data, 24);
    array = good(&npy);
    for (i = 0; i < 4 * 3 * 2 * 4 * 3 * 2; i++) {
        double out[24];
        size_t k = 0, code = i;
        int d, inside = 1;

        for (d = 0; d < 3; d++) {
            s[d] = code % shape[d];
            code /= shape[d];
            n[d] = 1 + code % shape[d];
            code /= shape[d];
            inside &= s[d] + n[d] <= shape[d];
        }
        assert_int_equal(brdffit_io_array_read(array, s, n, out, NULL), inside ? BRDFFIT_OK : BRDFFIT_ERR_ARGUMENT);
        for (at[0] = s[0]; inside && at[0] < s[0] + n[0]; at[0]++) {
            for (at[1] = s[1]; at[1] < s[1] + n[1]; at[1]++) {
                for (at[2] = s[2]; at[2] < s[2] + n[2]; at[2]++) {
                    assert_same(out[k++],
                                (double)(fortran ? at[0] + 4 * (at[1] + 3 * at[2]) : at[2] + 2 * (at[1] + 3 * at[0])));
                }
            }
        }
        blocks += (size_t)inside;
    }
    assert_int_equal(blocks, 10 * 6 * 3);
    brdffit_io_array_close(array);
}

static void test_blocks(void **state)
{
    (void)state;
    check_blocks(0);
    check_blocks(1);
}

static void refuse(const void *data, size_t size, const char *member, brdffit_status expected, const char *says,
                   double value)
{
    brdffit_array *array = (brdffit_array *)&array;
    brdffit_error error;
    brdffit_status status;

    memset(&error, 0, sizeof error);
    status = brdffit_io_array_open_memory(data, size, member, &array, &error);
    io_assert_failed(status, (brdffit_table *)array, &error, expected, says);
    assert_same(error.value, value);
}

static void refuse_header(const char *dictionary, const char *says, double value)
{
    struct npy npy = npy_of(dictionary, "12345678", 8);

    refuse(npy.bytes, npy.size, NULL, BRDFFIT_ERR_FORMAT, says, value);
}

static void test_headers(void **state)
{
    struct npy npy = npy_of("{\"shape\" : ( 2 ,4L,),'fortran_order':False , \n 'descr':\"|u1\"}", "12345678", 8);
    brdffit_array *array = good(&npy);

    (void)state;
    assert_int_equal(array->shape[0], 2);
    assert_int_equal(array->shape[1], 4);
    brdffit_io_array_close(array);
    refuse_header("['descr']", "not a dictionary", 10);
    refuse_header("{'descr': '|u1', 'fortran_order': False}", "lacks descr, fortran_order or shape", 50);
    refuse_header("{'descr': '|u1', 'descr': '|u1'}", "unknown key, or one twice", 28);
    refuse_header("{'colour': 'red'}", "unknown key", 12);
    refuse_header("{'descr': [('r', '<f4')]}", "of records", 20);
    refuse_header("{'descr': '|O'}", "of a type", 21);
    refuse_header("{'descr': '<c8'}", "of a type", 21);
    refuse_header("{'descr': '<U3'}", "of a type", 21);
    refuse_header("{'descr': '<f3'}", "of a type", 21);
    refuse_header("{'descr': '|u2'}", "byte order", 21);
    refuse_header("{'descr': '<u2}", "without its end", 25);
    refuse_header("{'shape': (8)}", "not a tuple", 22);
    refuse_header("{'shape': (-8,)}", "not a tuple", 21);
    refuse_header("{'shape': (1,1,1,1,1,1,1,1,8)}", "more than 8 dimensions", 37);
    refuse_header("{'shape': (99999999999999999999,)}", "beyond all memory", 40);
    refuse_header("{'fortran_order': 0}", "neither True nor False", 28);
    refuse_header("{'descr': '|u1', 'fortran_order': False, 'shape': (8,)} x", "goes on behind", 66);
    refuse_header("{'descr': '|u1', 'fortran_order': False, 'shape': (0, 5)}", "no elements", 0);
    refuse_header("{'descr': '|u1', 'fortran_order': False, 'shape': (9,)}", "shorter than", 1);
    refuse_header("{'descr': '|u1', 'fortran_order': False, 'shape': (7,)}", "longer than", 1);
    refuse_header("{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296, 4294967296)}", "can be addressed", 0);
    refuse("\x93NUMPY\1\0\1", 9, NULL, BRDFFIT_ERR_FORMAT, "too short for NPY", 9);
    refuse("\x93NUMPY\2\0\xff\xff\xff\xff{}", 14, NULL, BRDFFIT_ERR_FORMAT, "claims more bytes", 4294967295.0);
    refuse("\x93NUMPY\4\0\1\0\0\0{}", 14, NULL, BRDFFIT_ERR_FORMAT, "unknown version", 4);
    refuse("\x93NUMPY\1\0\1\0\0\0{}", 14, "x", BRDFFIT_ERR_FORMAT, "no .npz", 0);
    refuse("no array", 8, NULL, BRDFFIT_ERR_FORMAT, "neither NPY, NPZ nor PFM", 0);
    refuse("PF\n2 x\n-1\n", 10, NULL, BRDFFIT_ERR_FORMAT, "PFM header is damaged", 5);
    refuse("PF\n2 1\n0.0\n", 11, NULL, BRDFFIT_ERR_FORMAT, "PFM header is damaged", 10);
    refuse("Pf\n2 1\n-1\n1234", 14, NULL, BRDFFIT_ERR_FORMAT, "shorter", 4);
}

/* The top row comes first, in either byte order. */
static void test_pfm(void **state)
{
    static const unsigned char big[] = "Pf 2 2\t1e3\n\x40\x00\x00\x00\x40\x40\x00\x00\x3f\x80\x00\x00\x00\x00\x00\x00";
    static const size_t start[2] = {0, 0}, bottom[2] = {1, 0}, all[2] = {2, 2}, row[2] = {1, 2};
    unsigned char head[BRDFFIT_IO_HEADER_MAX];
    brdffit_array *array;
    double out[4];

    (void)state;
    assert_int_equal(brdffit_io_array_open_memory(big, sizeof big - 1, NULL, &array, NULL), BRDFFIT_OK);
    assert_int_equal(array->dims, 2);
    assert_int_equal(brdffit_io_array_read(array, start, all, out, NULL), BRDFFIT_OK);
    assert_same(out[0], 1.0);
    assert_same(out[1], 0.0);
    assert_same(out[2], 2.0);
    assert_same(out[3], 3.0);
    assert_int_equal(brdffit_io_array_read(array, bottom, row, out, NULL), BRDFFIT_OK);
    assert_same(out[1], 3.0);
    brdffit_io_array_close(array);
    assert_int_equal(brdffit_io_pfm_header(5, 4, 3, head), strlen("PF\n5 4\n-1.0\n"));
    assert_int_equal(brdffit_io_pfm_header(5, 4, 2, head), 0);
}

struct sink {
    unsigned char bytes[4096];
    size_t size, limit;
};

static int to_sink(void *user, const void *data, size_t size)
{
    struct sink *sink = user;

    if (size > sink->limit - sink->size) {
        return -1;
    }
    memcpy(sink->bytes + sink->size, data, size);
    sink->size += size;
    return 0;
}

static brdffit_status write_zip(struct sink *sink)
{
    static const size_t shape[2] = {2, 3};
    unsigned char npy[BRDFFIT_IO_HEADER_MAX + 6];
    size_t size = brdffit_io_npy_header('u', 1, 2, shape, npy);
    brdffit_io_zip *zip = brdffit_io_zip_new(to_sink, sink);
    brdffit_status status;

    assert_int_equal(size % 64, 0);
    memcpy(npy + size, "\1\2\3\4\5\6", 6);
    size += 6;
    status = brdffit_io_zip_begin(zip, "first.npy", size, brdffit_io_crc32(0, npy, size));
    if (status == BRDFFIT_OK) {
        status = brdffit_io_zip_write(zip, npy, size);
    }
    if (status == BRDFFIT_OK) {
        assert_int_equal(brdffit_io_zip_write(zip, npy, 1), BRDFFIT_ERR_ARGUMENT); /* more than was announced */
    }
    if (status != BRDFFIT_OK) {
        (void)brdffit_io_zip_finish(zip, 1);
        return status;
    }
    return brdffit_io_zip_finish(zip, 0);
}

static void test_zip(void **state)
{
    struct sink sink = {{0}, 0, sizeof sink.bytes};
    static const size_t start[2] = {1, 1}, count[2] = {1, 2};
    double out[2];
    brdffit_array *array;
    brdffit_io_zip *zip;
    size_t full;

    (void)state;
    assert_int_equal(write_zip(&sink), BRDFFIT_OK);
    full = sink.size;
    assert_int_equal(brdffit_io_array_open_memory(sink.bytes, full, "first", &array, NULL), BRDFFIT_OK);
    assert_int_equal(array->container, BRDFFIT_IO_NPZ);
    assert_int_equal(brdffit_io_array_read(array, start, count, out, NULL), BRDFFIT_OK);
    assert_same(out[0], 5.0);
    assert_same(out[1], 6.0);
    brdffit_io_array_close(array);
    for (sink.limit = 0; sink.limit < full; sink.limit += 10) { /* a full disk, wherever it fills up */
        sink.size = 0;
        assert_int_equal(write_zip(&sink), BRDFFIT_ERR_READ);
    }
    sink.limit = sizeof sink.bytes;
    sink.size = 0;
    zip = brdffit_io_zip_new(to_sink, &sink);
    assert_int_equal(brdffit_io_zip_begin(zip, "a.npy", 3, 0), BRDFFIT_OK);
    assert_int_equal(brdffit_io_zip_begin(zip, "b.npy", 3, 0), BRDFFIT_ERR_ARGUMENT); /* the first is not done */
    assert_int_equal(brdffit_io_zip_write(zip, "abc", 3), BRDFFIT_OK);
    assert_int_equal(brdffit_io_zip_finish(zip, 0), BRDFFIT_ERR_ARGUMENT); /* the checksum was another's */
}

/* A file that shrinks between opening and reading is an error, not a signal. */
static void test_shrinking(void **state)
{
    char path[] = "/tmp/brdffit-array-XXXXXX";
    static const size_t start[1] = {0}, count[1] = {8};
    struct npy npy = npy_of("{'descr': '|u1', 'fortran_order': False, 'shape': (8,)}", "12345678", 8);
    int descriptor = mkstemp(path);
    brdffit_array *array;
    brdffit_error error;
    double out[8];

    (void)state;
    assert_true(descriptor >= 0);
    assert_int_equal(write(descriptor, npy.bytes, npy.size), npy.size);
    assert_int_equal(brdffit_io_array_open(path, NULL, &array, &error), BRDFFIT_OK);
    assert_int_equal(brdffit_io_array_read(array, start, count, out, &error), BRDFFIT_OK);
    assert_same(out[7], '8');
    assert_int_equal(ftruncate(descriptor, (off_t)npy.size - 3), 0);
    assert_int_equal(brdffit_io_array_read(array, start, count, out, &error), BRDFFIT_ERR_READ);
    assert_non_null(strstr(error.message, "became shorter"));
    brdffit_io_array_close(array);
    brdffit_io_array_close(NULL);
    close(descriptor);
    unlink(path);
    assert_int_equal(brdffit_io_array_open(path, NULL, &array, &error), BRDFFIT_ERR_OPEN);
    assert_null(array);
    assert_int_equal(brdffit_io_array_open("/dev/null", NULL, &array, &error), BRDFFIT_ERR_OPEN);
    assert_int_equal(brdffit_io_array_open("/tmp", NULL, &array, &error), BRDFFIT_ERR_OPEN);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_elements), cmocka_unit_test(test_blocks), cmocka_unit_test(test_headers),
        cmocka_unit_test(test_pfm),      cmocka_unit_test(test_zip),    cmocka_unit_test(test_shrinking),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
