/*
 * Slow reference, part 1 of 3: a table of numbers from a text file.
 *
 * Reads what the development data use and nothing more: comma separated, one header line,
 * theta_i,phi_i,theta_o,phi_o or a,b,c first, then channels. Shares no code with the library, whose reader it
 * helps to judge. SPDX-License-Identifier: MIT
 */
#ifndef BRUTE_READ_H
#define BRUTE_READ_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct brute_table {
    size_t rows, fields;
    int directions;    /* 1: four angles in degrees, then f_r; 0: a, b, c, then radiance */
    long double *cell; /* rows x fields */
};

static size_t brute_count_fields(const char *line)
{
    size_t fields = 1;

    for (; *line; line++) {
        fields += *line == ',';
    }
    return fields;
}

/* One line of exactly `fields` numbers; 0 when it is anything else. */
static int brute_read_row(const char *line, size_t fields, long double *cell)
{
    size_t j;

    for (j = 0; j < fields; j++) {
        char *end;

        cell[j] = strtold(line, &end);
        if (end == line || !(cell[j] >= -1e300L && cell[j] <= 1e300L)) {
            return 0;
        }
        line = end;
        if (j + 1 < fields && *line++ != ',') {
            return 0;
        }
    }
    return strspn(line, " \r\n") == strlen(line);
}

static int brute_read_header(const char *line, struct brute_table *table)
{
    table->fields = brute_count_fields(line);
    table->directions = strncmp(line, "theta_i,phi_i,theta_o,phi_o,", 28) == 0;
    return table->directions || strncmp(line, "a,b,c,", 6) == 0;
}

/* 0 when the file cannot be read; a message is printed. */
static int brute_read(const char *path, struct brute_table *table)
{
    FILE *file = fopen(path, "r");
    char *line = NULL;
    size_t line_size = 0, room = 0, number = 0;
    int good = 1;

    memset(table, 0, sizeof *table);
    if (!file) {
        fprintf(stderr, "brute: cannot open %s\n", path);
        return 0;
    }
    while (good && getline(&line, &line_size, file) > 0) {
        number++;
        if (line[0] == '#' || line[strspn(line, " \r\n")] == '\0') {
            continue;
        }
        if (!table->fields) {
            good = brute_read_header(line, table);
            continue;
        }
        if (table->rows == room) {
            room = room ? 2 * room : 128;
            table->cell = realloc(table->cell, room * table->fields * sizeof *table->cell);
            if (!table->cell) {
                exit(1);
            }
        }
        good = brute_read_row(line, table->fields, table->cell + table->rows * table->fields);
        table->rows += (size_t)good;
    }
    free(line);
    fclose(file);
    if (!good || !table->rows) {
        fprintf(stderr, "brute: %s: line %zu is not what this program reads\n", path, number);
        free(table->cell);
        return 0;
    }
    return 1;
}

#endif
