/*
 * gzip: looked through when sound, named exactly when not. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include "io/bytes/gzip.h"
#include "io/unpack.h"
#include "io_support.h"

static const char text[] = "theta_i,theta_o,r\n0,0,1\n30,60,2\n";

static void refuse(const unsigned char *data, size_t size, brdffit_status expected, const char *message)
{
    brdffit_table *table;
    brdffit_error error;
    brdffit_status status = brdffit_io_read_memory(data, size, NULL, &table, &error);

    io_assert_failed(status, table, &error, expected, message);
}

/* Two pieces one after the other. Release with free(). */
static unsigned char *join(const void *a, size_t a_size, const void *b, size_t b_size)
{
    unsigned char *both = malloc(a_size + b_size + 1);

    assert_non_null(both);
    memcpy(both, a, a_size);
    memcpy(both + a_size, b, b_size);
    return both;
}

static void test_round_trip(void **state)
{
    struct io_merl merl = io_merl_new(20, 20, 40);
    brdffit_table *plain, *packed;
    brdffit_error error;
    brdffit_io_options options;
    unsigned char *gz;
    size_t size;

    (void)state;
    gz = io_gzip(merl.data, merl.size, &size);
    assert_int_equal(brdffit_io_read_memory(merl.data, merl.size, NULL, &plain, &error), BRDFFIT_OK);
    assert_int_equal(brdffit_io_read_memory(gz, size, NULL, &packed, &error), BRDFFIT_OK);
    assert_int_equal(plain->compressed, 0);
    assert_int_equal(packed->compressed, 1);
    assert_int_equal(packed->samples->count, plain->samples->count);
    assert_memory_equal(packed->samples->values, plain->samples->values, 24 * plain->samples->count);
    assert_memory_equal(packed->samples->tan2_half, plain->samples->tan2_half, 8 * plain->samples->count);
    brdffit_io_free(packed);
    brdffit_io_options_init(&options);
    options.format = BRDFFIT_IO_FORMAT_MERL;
    assert_int_equal(brdffit_io_read_memory(gz, size, &options, &packed, &error), BRDFFIT_OK);
    brdffit_io_free(packed);
    brdffit_io_free(plain);
    free(gz);
    free(merl.data);
    gz = io_gzip(text, sizeof text - 1, &size);
    assert_int_equal(brdffit_io_read_memory(gz, size, NULL, &packed, &error), BRDFFIT_OK);
    assert_int_equal(packed->format, BRDFFIT_IO_FORMAT_CSV);
    assert_int_equal(packed->compressed, 1);
    assert_int_equal(packed->lines[1], 3);
    brdffit_io_free(packed);
    free(gz);
}

/* Cut anywhere, a stream is truncated; nothing else is said of it. */
static void test_truncated(void **state)
{
    unsigned char *gz;
    size_t size, cut;

    (void)state;
    gz = io_gzip(text, sizeof text - 1, &size);
    for (cut = 2; cut < size; cut++) {
        refuse(gz, cut, BRDFFIT_ERR_READ, "truncated");
    }
    free(gz);
}

/* A truncated table inside a sound stream is a short table. */
static void test_short_table_inside(void **state)
{
    struct io_merl merl = io_merl_new(4, 3, 6);
    unsigned char *gz;
    size_t size;

    (void)state;
    gz = io_gzip(merl.data, merl.size - 1, &size);
    refuse(gz, size, BRDFFIT_ERR_FORMAT, "shorter than its header says");
    free(gz);
    gz = io_gzip("", 0, &size);
    refuse(gz, size, BRDFFIT_ERR_FORMAT, "empty");
    free(gz);
    free(merl.data);
}

static void test_members(void **state)
{
    unsigned char *first, *second, *both;
    size_t a, b;
    brdffit_table *table;
    brdffit_error error;

    (void)state;
    first = io_gzip(text, 20, &a);
    second = io_gzip(text + 20, sizeof text - 1 - 20, &b);
    both = join(first, a, second, b);
    assert_int_equal(brdffit_io_read_memory(both, a + b, NULL, &table, &error), BRDFFIT_OK);
    assert_int_equal(table->samples->count, 2);
    brdffit_io_free(table);
    refuse(both, a + b - 1, BRDFFIT_ERR_READ, "truncated");
    refuse(both, a + 5, BRDFFIT_ERR_READ, "truncated");
    free(both);
    both = join(first, a, "garbage", 7);
    refuse(both, a + 7, BRDFFIT_ERR_READ, "bytes follow");
    free(both);
    both = join(second, b, "", 1);
    refuse(both, b + 1, BRDFFIT_ERR_READ, "bytes follow");
    free(both);
    free(first);
    free(second);
}

static void test_damaged(void **state)
{
    unsigned char *gz;
    size_t size, i;

    (void)state;
    gz = io_gzip(text, sizeof text - 1, &size);
    gz[size - 8] ^= 1;
    refuse(gz, size, BRDFFIT_ERR_READ, "checksum does not match");
    gz[size - 8] ^= 1;
    gz[size - 4] ^= 1;
    refuse(gz, size, BRDFFIT_ERR_READ, "length does not match");
    gz[size - 4] ^= 1;
    gz[2] = 7;
    refuse(gz, size, BRDFFIT_ERR_READ, "compression method");
    gz[2] = 8;
    gz[10] |= 6; /* a block of the reserved type */
    refuse(gz, size, BRDFFIT_ERR_READ, "damaged");
    free(gz);
    /* Any single bit behind the header is noticed, but for the few that pad the last byte of the data. */
    for (i = 80; i < 8 * size; i++) {
        brdffit_table *table;
        brdffit_error error;
        brdffit_status status;

        gz = io_gzip(text, sizeof text - 1, &size);
        gz[i / 8] = (unsigned char)(gz[i / 8] ^ 1 << i % 8);
        status = brdffit_io_read_memory(gz, size, NULL, &table, &error);
        if (status == BRDFFIT_OK) {
            assert_int_equal(i / 8, size - 9);
            assert_int_equal(table->samples->count, 2);
            assert_same(table->samples->values[1], 2);
        } else {
            assert_int_equal(status, BRDFFIT_ERR_READ);
            assert_null(table);
        }
        brdffit_io_free(table);
        free(gz);
    }
}

static void test_twice(void **state)
{
    unsigned char *once, *twice;
    size_t size, both;

    (void)state;
    once = io_gzip(text, sizeof text - 1, &size);
    twice = io_gzip(once, size, &both);
    refuse(twice, both, BRDFFIT_ERR_FORMAT, "twice");
    free(once);
    free(twice);
}

/* The trailer's length is not believed, and the limit holds for what really comes out. */
static void test_bomb(void **state)
{
    const size_t large = (size_t)64 << 20;
    unsigned char *zeros = calloc(large, 1), *gz;
    struct io_bytes out = {NULL, 0, 0};
    brdffit_error error;
    size_t size;

    (void)state;
    assert_non_null(zeros);
    gz = io_gzip(zeros, large, &size);
    assert_int_equal(brdffit_io_gunzip(gz, size, &(struct io_gzip_limit){large, "too much"}, &out, &error), BRDFFIT_OK);
    assert_int_equal(out.size, large);
    brdffit_io_bytes_free(&out);
    assert_int_equal(brdffit_io_gunzip(gz, size, &(struct io_gzip_limit){large - 1, "too much"}, &out, &error),
                     BRDFFIT_ERR_FORMAT);
    assert_string_equal(error.message, "too much");
    assert_same(error.value, (double)(large - 1));
    assert_true(out.capacity <= large);
    brdffit_io_bytes_free(&out);
    refuse(gz, size, BRDFFIT_ERR_FORMAT, "neither a text table nor a MERL");
    free(gz);
    gz = io_gzip(zeros, 10, &size);
    memset(gz + size - 4, 0x7f, 4); /* claims 2 GiB */
    assert_int_equal(brdffit_io_gunzip(gz, size, &(struct io_gzip_limit){large, "too much"}, &out, &error),
                     BRDFFIT_ERR_READ);
    assert_true(out.capacity <= 65536);
    brdffit_io_bytes_free(&out);
    free(gz);
    free(zeros);
}

/* A table says how long it is: no more is unpacked, whatever the stream goes on to say. */
static void test_promise(void **state)
{
    const size_t large = (size_t)64 << 20;
    unsigned char *table = calloc(large, 1), *gz;
    struct io_bytes out = {NULL, 0, 0};
    brdffit_io_options options;
    brdffit_error error;
    size_t size;

    (void)state;
    assert_non_null(table);
    table[0] = 90;
    table[4] = 90;
    table[8] = 18; /* 3,499,212 bytes */
    gz = io_gzip(table, large, &size);
    brdffit_io_options_init(&options);
    assert_int_equal(brdffit_io_unpack(gz, size, &options, &out, &error), BRDFFIT_ERR_FORMAT);
    assert_non_null(strstr(error.message, "longer than its header says"));
    assert_same(error.value, 3499212.0);
    assert_in_range(out.capacity, 1, 3499213);
    brdffit_io_bytes_free(&out);
    options.max_bytes = 1000000;
    assert_int_equal(brdffit_io_unpack(gz, size, &options, &out, &error), BRDFFIT_ERR_FORMAT);
    assert_non_null(strstr(error.message, "max_bytes"));
    assert_in_range(out.capacity, 1, 1000001);
    brdffit_io_bytes_free(&out);
    free(gz);
    free(table);
}

/* A text does not: the options say how much is enough. */
static void test_limit(void **state)
{
    static const char head[] = "theta_i,theta_o,r\n", row[] = "1,2,3\n";
    const size_t rows = 100000;
    char *lines = malloc(sizeof head + rows * sizeof row);
    unsigned char *gz;
    brdffit_table *table = NULL;
    brdffit_io_options options;
    brdffit_error error;
    size_t size, i, length = sizeof head - 1;

    (void)state;
    assert_non_null(lines);
    memcpy(lines, head, length);
    for (i = 0; i < rows; i++, length += sizeof row - 1) {
        memcpy(lines + length, row, sizeof row);
    }
    gz = io_gzip(lines, length, &size);
    brdffit_io_options_init(&options);
    options.max_bytes = length;
    assert_int_equal(brdffit_io_read_memory(gz, size, &options, &table, &error), BRDFFIT_OK);
    brdffit_io_free(table);
    options.max_bytes = length - 1;
    assert_int_equal(brdffit_io_read_memory(gz, size, &options, &table, &error), BRDFFIT_ERR_FORMAT);
    assert_non_null(strstr(error.message, "max_bytes"));
    options.max_bytes = size - 1;
    assert_int_equal(brdffit_io_read_memory(gz, size, &options, &table, &error), BRDFFIT_ERR_FORMAT);
    assert_non_null(strstr(error.message, "max_bytes"));
    free(gz);
    free(lines);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip), cmocka_unit_test(test_truncated), cmocka_unit_test(test_short_table_inside),
        cmocka_unit_test(test_members),    cmocka_unit_test(test_damaged),   cmocka_unit_test(test_twice),
        cmocka_unit_test(test_bomb),       cmocka_unit_test(test_promise),   cmocka_unit_test(test_limit),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
