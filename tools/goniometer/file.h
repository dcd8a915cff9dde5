/* file.h: a file built in memory and written whole or not at all.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_GONIO_FILE_H
#define BRDFFIT_GONIO_FILE_H

#include <stddef.h>

/* Zero-initialise. After memory has run out `failed` stays 1. */
struct gonio_file {
    char *data;
    size_t size;
    size_t capacity;
    int failed;
};

void brdffit_gonio_add(struct gonio_file *file, const void *bytes, size_t size);

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void brdffit_gonio_printf(struct gonio_file *file, const char *format, ...);

/* Write to FOLDER/NAME, by way of a temporary file and a rename, and release
 * the content. 0 on success; otherwise the reason is on standard error. */
int brdffit_gonio_write(struct gonio_file *file, const char *folder, const char *name);

#endif
