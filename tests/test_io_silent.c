/*
 * No damage to a text changes a number in silence: 10,000 mutations of a good table are refused, or told, or every sample
 * that is read is what its own line says, as a plain reading of it by strtod() has it. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include "fuzz/mutate.h"
#include "io_support.h"

#define MUTATIONS 10000
#define COLUMNS 7

static const char text[] = "theta_i,phi_i,theta_o,phi_o,r,g,b\n"
                           "0,0,10,180,0.125942,0.113563,0.102717\n"
                           "0,0,25,150,0.078105,0.0661094,0.0565316\n"
                           "15,0,0,180,0.114342,0.101223,0.0918017\n"
                           "15,0,45,150,0.0701211,0.0574302,0.0479043\n"
                           "30,0,20,180,0.13001,0.118212,0.108611\n"
                           "30,0,60,180,0.0912375,0.0781234,0.0692001\n"
                           "45,0,35,180,0.151234,0.139001,0.128777\n"
                           "45,0,50,150,0.0812003,0.0699102,0.0599213\n"
                           "45,0,70,180,0.1123,0.0998,0.0901\n";

/* Numbers of line `wanted` (from 1), each between commas: how many, 0 when one is no plain number. */
static size_t plain_line(const char *data, size_t size, size_t wanted, double *out, size_t most)
{
    const char *at = data, *end = data + size;
    char line[400];
    size_t n = 0, length = 0, number = 1;

    for (; at < end && number < wanted; at++) {
        number += *at == '\n' || (*at == '\r' && !(end - at > 1 && at[1] == '\n'));
    }
    while (at < end && *at != '\n' && *at != '\r' && length + 1 < sizeof line) {
        line[length] = *at == '"' ? ' ' : *at; /* quotes around numbers are fine */
        line[length] = strchr("dDqQ", line[length]) && line[length] ? 'e' : line[length];
        length++;
        at++;
    }
    line[length] = '\0';
    for (char *field = line; n < most; field++) {
        char *stop;

        out[n++] = strtod(field, &stop);
        stop += strspn(stop, " \t");
        if (stop == field || (*stop && *stop != ',')) {
            return 0;
        }
        field = stop;
        if (!*stop) {
            return n;
        }
    }
    return n;
}

static int is_direction(const double *found, double theta, double phi)
{
    const double degree = acos(-1.0) / 180.0;

    return fabs(found[0] - sin(theta * degree) * cos(phi * degree)) < 1e-12 &&
           fabs(found[1] - sin(theta * degree) * sin(phi * degree)) < 1e-12 &&
           fabs(found[2] - cos(theta * degree)) < 1e-12;
}

static int is_told(const brdffit_table *table)
{
    size_t i, dropped = 0;

    for (i = 0; i < BRDFFIT_IO_DROP_COUNT; i++) {
        dropped += table->dropped[i];
    }
    return table->note_count > 0 || dropped > 0;
}

/* Whether each sample says what its line does; the names of channels are the header's own, and seen. */
static int is_literal(const brdffit_table *table, const char *data, size_t size)
{
    const brdffit_samples *s = table->samples;
    size_t i, k;

    if (s->form != BRDFFIT_FORM_DIRECTIONS || s->channels != 3) {
        return s->channels != 3; /* of another header, whose channels are other names: seen */
    }
    for (i = 0; i < s->count; i++) {
        double number[COLUMNS + 1];

        if (plain_line(data, size, table->lines[i], number, COLUMNS + 1) != COLUMNS ||
            !is_direction(s->light + 3 * i, number[0], number[1]) ||
            !is_direction(s->view + 3 * i, number[2], number[3])) {
            return 0;
        }
        for (k = 0; k < 3; k++) {
            if (s->values[3 * i + k] != number[4 + k]) {
                return 0;
            }
        }
    }
    return 1;
}

/* Weights would not be seen either. */
static int is_silent_change(const brdffit_table *table, const char *data, size_t size)
{
    return !is_told(table) && (table->samples->weights || !is_literal(table, data, size));
}

static void test_silent_changes(void **state)
{
    uint64_t random = 7;
    size_t read = 0, told = 0, refused = 0, n;

    (void)state;
    for (n = 0; n < MUTATIONS; n++) {
        unsigned char data[2 * sizeof text];
        size_t size = sizeof text - 1;
        brdffit_table *table;
        brdffit_error error;

        memcpy(data, text, size);
        size = mutate(&random, data, size, sizeof data);
        if (brdffit_io_read_memory(data, size, NULL, &table, &error) != BRDFFIT_OK) {
            refused++;
            continue;
        }
        if (is_silent_change(table, (const char *)data, size)) {
            print_error("mutation %zu changes numbers in silence:\n%.*s\n", n, (int)size, (const char *)data);
            fail();
        }
        told += (size_t)is_told(table);
        read++;
        brdffit_io_free(table);
    }
    print_message("%zu read, of which %zu with a note; %zu refused\n", read, told, refused);
    assert_true(read > MUTATIONS / 20 && refused > MUTATIONS / 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_silent_changes)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
