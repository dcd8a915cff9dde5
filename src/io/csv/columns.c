/*
 * Columns of a text table: see columns.h. SPDX-License-Identifier: MIT
 */
#include "io/csv/columns.h"

#include "io/bytes/memory.h"
#include "io/fail.h"

int brdffit_io_csv_has(const struct csv_layout *layout, enum csv_role role)
{
    return layout->column[role] != BRDFFIT_NONE;
}

void brdffit_io_layout_free(struct csv_layout *layout)
{
    brdffit_io_release(layout->meaning);
    brdffit_io_release(layout->names);
    brdffit_io_release(layout->fields);
    layout->meaning = NULL;
    layout->names = layout->fields = NULL;
    layout->columns = layout->channels = 0;
}

void brdffit_io_fault(const brdffit_io_options *options, const struct io_field *field)
{
    if (options->fault && options->fault_size > 8) {
        (void)brdffit_io_quote(field->text, field->length, options->fault, options->fault_size);
    }
}

const char *brdffit_io_column_name(const struct csv_layout *layout, size_t column, char out[IO_QUOTED])
{
    return brdffit_io_quote(layout->names[column].text, layout->names[column].length, out, IO_QUOTED);
}

brdffit_status brdffit_io_layout_fail(const struct csv_layout *layout, size_t column, const char *message,
                                      brdffit_error *error)
{
    struct io_place place = IO_NOWHERE;

    place.line = layout->line;
    place.column = column == BRDFFIT_NONE ? column : column + 1;
    if (column != BRDFFIT_NONE && layout->names && column < layout->columns) {
        brdffit_io_fault(layout->options, &layout->names[column]);
    }
    return brdffit_io_fail_at(error, BRDFFIT_ERR_FORMAT, message, &place, 0.0);
}

int brdffit_io_layout_any(const struct csv_layout *layout, enum csv_role first, enum csv_role last)
{
    size_t j;

    for (j = 0; j < layout->columns; j++) {
        if (layout->meaning[j].role >= first && layout->meaning[j].role <= last) {
            return 1;
        }
    }
    return 0;
}

size_t brdffit_io_layout_score(const struct csv_layout *layout)
{
    size_t j, score = 0;

    for (j = 0; j < layout->columns; j++) {
        score += layout->meaning[j].role <= CSV_C || layout->meaning[j].role == CSV_DIRECTION;
    }
    return score;
}
