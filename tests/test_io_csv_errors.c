/*
 * Text tables that must be refused, and where the error says the fault is. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include "io_support.h"

#define NOWHERE BRDFFIT_NONE
#define ANGLES "theta_i,phi_i,theta_o,phi_o,r,g,b\n"

struct refusal {
    const char *text;
    brdffit_status status;
    const char *message; /* a part of it */
    size_t line, column, sample, channel;
    double value;
};

static void refuse_all(const struct refusal *refusal, size_t count)
{
    size_t i;

    for (i = 0; i < count; i++) {
        const struct refusal *r = &refusal[i];
        brdffit_table *table = (brdffit_table *)&table;
        brdffit_error error;
        brdffit_status status;

        memset(&error, 0x5a, sizeof error);
        status = io_text(r->text, NULL, &table, &error);
        if (status != r->status || status == BRDFFIT_OK || !strstr(error.message, r->message) ||
            error.line != r->line || error.column != r->column || error.sample != r->sample ||
            error.channel != r->channel) {
            error.message = status == BRDFFIT_OK ? "read" : error.message;
            print_error("'%s'\n-> %d '%s' line %zd column %zd sample %zd channel %zd value %g\n", r->text, (int)status,
                        error.message, (ssize_t)error.line, (ssize_t)error.column, (ssize_t)error.sample,
                        (ssize_t)error.channel, error.value);
            fail();
        }
        assert_int_equal(error.status, status);
        assert_same(error.value, r->value);
        assert_int_equal(io_text(r->text, NULL, &table, NULL), status); /* error may be NULL */
        assert_null(table);
    }
}

#define REFUSE(list) refuse_all((list), sizeof(list) / sizeof *(list))

static void test_fields(void **state)
{
    static const struct refusal list[] = {
        {ANGLES "0,0,0,0,1.2abc,2,3\n", BRDFFIT_ERR_VALUE, "not a number", 2, 5, 0, 0, 0},
        {ANGLES "0,0,0,0,1,2,3\n0,0,x,0,1,2,3\n", BRDFFIT_ERR_VALUE, "not a number", 3, 3, 1, NOWHERE, 0},
        {ANGLES "0,0,0,0,1,nan,3\n", BRDFFIT_ERR_NO_SAMPLES, "no value", NOWHERE, NOWHERE, NOWHERE, NOWHERE, 0},
        {ANGLES "5,nan,0,0,1,2,3\n", BRDFFIT_ERR_VALUE, "no value", 2, 2, 0, NOWHERE, 0},
        {ANGLES "0,0,0,0,1,2,-inf\n", BRDFFIT_ERR_VALUE, "infinite", 2, 7, 0, 2, -INFINITY},
        {ANGLES "#\n\n0,0,0,0,1e999,2,3\n", BRDFFIT_ERR_VALUE, "too large", 4, 5, 0, 0, INFINITY},
        {ANGLES "0,0,0,0,0x1p3,2,3\n", BRDFFIT_ERR_VALUE, "hexadecimal", 2, 5, 0, 0, 0},
        {ANGLES ",0,0,0,1,2,3\n", BRDFFIT_ERR_VALUE, "empty", 2, 1, 0, NOWHERE, 0},
        {ANGLES "0,0,5,  ,1,2,3\n", BRDFFIT_ERR_VALUE, "empty", 2, 4, 0, NOWHERE, 0},
        {ANGLES "0,0,0,0,,2,3\n0,0,0,0,,2,x\n", BRDFFIT_ERR_VALUE, "not a number", 3, 7, 0, 2, 0},
        {ANGLES "0,0,0,0,1 2,2,3\n", BRDFFIT_ERR_VALUE, "not a number", 2, 5, 0, 0, 0},
        {ANGLES "0,0,0,0,\"1,5\",2.5,3\n", BRDFFIT_ERR_VALUE, "decimal commas and", 2, 6, 0, 1, 0},
        {"theta_i;theta_o;r\n10;0;1,234\n", BRDFFIT_ERR_VALUE, "thousands", 2, 3, NOWHERE, NOWHERE, 0},
        {"theta_i\ttheta_o\tr\n10\t0\t1,234.5\n", BRDFFIT_ERR_VALUE, "thousands", 2, 3, 0, 0, 0},
        {"theta_i;theta_o;r\n10;0;12 345\n", BRDFFIT_ERR_VALUE, "thousands", 2, 3, 0, 0, 0},
        {ANGLES "-181,0,0,0,1,2,3\n", BRDFFIT_ERR_VALUE, "theta_i is not in [-180, 180]", 2, 1, 0, NOWHERE, -181},
        {ANGLES "0,0,180.5,0,1,2,3\n", BRDFFIT_ERR_VALUE, "theta_o is not in [-180, 180]", 2, 3, 0, NOWHERE, 180.5},
        {"r,theta_o,theta_i\n1,2,3\n1,2,-300\n", BRDFFIT_ERR_VALUE, "theta_i", 3, 3, 1, NOWHERE, -300},
        {ANGLES "0,-999,0,0,1,2,3\n", BRDFFIT_ERR_VALUE, "two turns", 2, 2, 0, NOWHERE, -999},
        {"theta_i,theta_o,w,r\n1,1,-2,1\n", BRDFFIT_ERR_VALUE, "weight is negative", 2, 3, 0, NOWHERE, -2},
        {"theta_i,theta_o,w,r\n1,1,nan,1\n", BRDFFIT_ERR_VALUE, "no value", 2, 3, 0, NOWHERE, 0},
        {"theta_i,theta_o,w,r\n1,1,,1\n", BRDFFIT_ERR_VALUE, "empty", 2, 3, 0, NOWHERE, 0},
        {"lx,ly,lz,vx,vy,vz,r\n0,0,1,0,0,1,1\n0,-0,0,0,0,1,1\n", BRDFFIT_ERR_VALUE, "lx, ly, lz has no length", 3, 1, 1,
         NOWHERE, 0},
        {"lx,ly,lz,r,vz,vy,vx\n0,0,1,1,0,0,0\n", BRDFFIT_ERR_VALUE, "vx, vy, vz has no length", 2, 7, 0, NOWHERE, 0},
        {"lx,ly,lz,vx,vy,vz,nx,ny,nz,r\n0,0,1,0,0,1,0,0,0,1\n", BRDFFIT_ERR_VALUE, "nx, ny, nz has no length", 2, 7, 0,
         NOWHERE, 0},
        {"a,b,c,r\n-1,0,0,1\n", BRDFFIT_ERR_VALUE, "a is negative", 2, 1, 0, NOWHERE, -1},
        {"a,b,c,r\n0,-2,0,1\n", BRDFFIT_ERR_VALUE, "b is negative", 2, 2, 0, NOWHERE, -2},
        {"a,b,c,r\n0,0,0,1\n0,0,-3,1\n", BRDFFIT_ERR_VALUE, "c is negative", 3, 3, 1, NOWHERE, -3},
        {"a,b,c,r\n0,0,inf,1\n", BRDFFIT_ERR_VALUE, "infinite", 2, 3, 0, NOWHERE, INFINITY},
    };

    (void)state;
    REFUSE(list);
}

static void test_lines(void **state)
{
    static const struct refusal list[] = {
        {ANGLES "0,0,0,0,1,2\n", BRDFFIT_ERR_FORMAT, "fewer fields than the header", 2, NOWHERE, 0, NOWHERE, 6},
        {ANGLES "0,0,0,0,1,2,3\n0,0,0,0,1,2,3,4\n", BRDFFIT_ERR_FORMAT, "more fields than the header", 3, NOWHERE, 1,
         NOWHERE, 8},
        {ANGLES "0,0,0,0,1,2,3\n0\n", BRDFFIT_ERR_FORMAT, "fewer", 3, NOWHERE, 1, NOWHERE, 1},
        {ANGLES "0,0,0,0,1,2,x,4\n", BRDFFIT_ERR_FORMAT, "more", 2, NOWHERE, 0, NOWHERE, 8},
        {ANGLES "0,0,0,0,1,\"2,3\n", BRDFFIT_ERR_FORMAT, "quote is not closed", 2, 6, 0, NOWHERE, 0},
        {ANGLES "0,0,\"0\"0,0,1,2,3\n", BRDFFIT_ERR_FORMAT, "follows a closing quote", 2, 3, 0, NOWHERE, 0},
        {ANGLES, BRDFFIT_ERR_NO_SAMPLES, "no data lines", NOWHERE, NOWHERE, NOWHERE, NOWHERE, 0},
        {ANGLES "\n# nothing\n", BRDFFIT_ERR_NO_SAMPLES, "no data lines", NOWHERE, NOWHERE, NOWHERE, NOWHERE, 0},
        {ANGLES "0,0,0,0,1,2,\n0,0,0,0,,,\n", BRDFFIT_ERR_NO_SAMPLES, "empty channel", NOWHERE, NOWHERE, NOWHERE,
         NOWHERE, 0},
    };

    (void)state;
    REFUSE(list);
}

static void test_headers(void **state)
{
    static const struct refusal list[] = {
        {"", BRDFFIT_ERR_FORMAT, "empty", NOWHERE, NOWHERE, NOWHERE, NOWHERE, 0},
        {"\n\n# only comments\n", BRDFFIT_ERR_FORMAT, "no header", NOWHERE, NOWHERE, NOWHERE, NOWHERE, 0},
        {"\xef\xbb\xbf", BRDFFIT_ERR_FORMAT, "no header", NOWHERE, NOWHERE, NOWHERE, NOWHERE, 0},
        {"hello\n", BRDFFIT_ERR_FORMAT, "one column", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"# x\n1,2,3\n4,5,6\n", BRDFFIT_ERR_FORMAT, "holds numbers", 2, NOWHERE, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,r,r\n", BRDFFIT_ERR_FORMAT, "twice", 1, 4, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,r,g,x,g,r\n", BRDFFIT_ERR_FORMAT, "twice", 1, 6, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_i_deg,theta_o,r\n", BRDFFIT_ERR_FORMAT, "twice", 1, 2, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,w,r,weight\n", BRDFFIT_ERR_FORMAT, "twice", 1, 5, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,a,b,c,b\n", BRDFFIT_ERR_FORMAT, "twice", 1, 6, NOWHERE, NOWHERE, 0},
        {"a,b,c,r,g,b\n", BRDFFIT_ERR_FORMAT, "twice", 1, 6, NOWHERE, NOWHERE, 0},
        {"theta_i,phi_i,r\n", BRDFFIT_ERR_FORMAT, "both theta_i and theta_o", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"phi_i,phi_o,r\n", BRDFFIT_ERR_FORMAT, "both theta_i and theta_o", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"theta_i,phi_i,theta_o,r\n", BRDFFIT_ERR_FORMAT, "both phi_i and phi_o", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,lx,r\n", BRDFFIT_ERR_FORMAT, "mixes", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,nx,ny,nz,r\n", BRDFFIT_ERR_FORMAT, "mixes", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"lx,ly,lz,vx,vy,r\n", BRDFFIT_ERR_FORMAT, "lx, ly, lz, vx, vy, vz", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"lx,ly,lz,vx,vy,vz,nx,nz,r\n", BRDFFIT_ERR_FORMAT, "nx, ny, nz", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"nx,ny,nz,r\n", BRDFFIT_ERR_FORMAT, "lx, ly, lz, vx, vy, vz", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"a,c,r,g\n", BRDFFIT_ERR_FORMAT, "names no directions", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"r,g,b\n1,2,3\n", BRDFFIT_ERR_FORMAT, "names no directions", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o\n1,2\n", BRDFFIT_ERR_FORMAT, "no channel", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"a,b,c,w\n", BRDFFIT_ERR_FORMAT, "no channel", 1, NOWHERE, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,,r\n", BRDFFIT_ERR_FORMAT, "no name", 1, 3, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,r,\n", BRDFFIT_ERR_FORMAT, "no name", 1, 4, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,\"\",r\n", BRDFFIT_ERR_FORMAT, "no name", 1, 3, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,\"r\n", BRDFFIT_ERR_FORMAT, "not closed", 1, 3, NOWHERE, NOWHERE, 0},
        {"theta_i,\"theta_o\"x,r\n", BRDFFIT_ERR_FORMAT, "follows a closing quote", 1, 2, NOWHERE, NOWHERE, 0},
        {"theta_i,theta_o,r\001g\n", BRDFFIT_ERR_FORMAT, "control characters", 1, NOWHERE, NOWHERE, NOWHERE, 0},
    };

    (void)state;
    REFUSE(list);
}

/* UTF-16 is read, and what is wrong in it said. */
static void test_utf16(void **state)
{
    static const unsigned char text[] = {0xff, 0xfe, 'a', 0, ',', 0, 'b', 0, ',', 0, 'c', 0, '\n', 0};
    brdffit_table *table;
    brdffit_error error;
    brdffit_status status = brdffit_io_read_memory(text, sizeof text, NULL, &table, &error);

    (void)state;
    io_assert_failed(status, table, &error, BRDFFIT_ERR_FORMAT, "no channel");
}

/* A zero byte in the middle of good text: still text, and the line gets named. */
static void test_zero_byte(void **state)
{
    static const char text[] = "theta_i,theta_o,r\n1,2,3\n1,\0,3\n";
    brdffit_table *table;
    brdffit_error error;
    brdffit_status status = brdffit_io_read_memory(text, sizeof text - 1, NULL, &table, &error);

    (void)state;
    io_assert_failed(status, table, &error, BRDFFIT_ERR_VALUE, "not a number");
    assert_int_equal(error.line, 3);
    assert_int_equal(error.column, 2);
}

/* Hostile sizes: linear time, not quadratic. (A quadratic pass over these would take minutes.) */
static void test_hostile_shapes(void **state)
{
    const size_t size = 8000000;
    char *text = malloc(size + 1);
    brdffit_table *table;
    brdffit_error error;
    brdffit_status status;
    size_t i;

    (void)state;
    assert_non_null(text);
    memset(text, '\r', size);
    text[size] = '\0';
    status = io_text(text, NULL, &table, &error);
    io_assert_failed(status, table, &error, BRDFFIT_ERR_FORMAT, "no header");
    for (i = 0; i + 8 <= size; i += 8) { /* a million distinct names, the last twice */
        memcpy(text + i, "       ,", 8);
        (void)snprintf(text + i, 8, "%zu", i / 8 < size / 8 - 1 ? 1000000 + i / 8 : 1000000);
        text[i + 7] = i + 8 < size ? ',' : '\n';
    }
    text[0] = 'x';
    memcpy(text + size - 8, "x000000", 7);
    status = io_text(text, NULL, &table, &error);
    io_assert_failed(status, table, &error, BRDFFIT_ERR_FORMAT, "twice");
    assert_int_equal(error.column, 1000000);
    memset(text, '"', size);
    status = io_text(text, NULL, &table, &error);
    io_assert_failed(status, table, &error, BRDFFIT_ERR_FORMAT, "one column");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fields), cmocka_unit_test(test_lines),     cmocka_unit_test(test_headers),
        cmocka_unit_test(test_utf16),  cmocka_unit_test(test_zero_byte), cmocka_unit_test(test_hostile_shapes),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
