/*
 * What kind of file is it. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_DETECT_H
#define BRDFFIT_IO_DETECT_H

#include "brdffit_io.h"

/*
 * CSV or MERL, from unpacked content. Fails when it can be neither. A damaged MERL table counts as MERL, so
 * that its reader can say what is wrong with it.
 */
brdffit_status brdffit_io_detect(const unsigned char *data, size_t size, brdffit_io_format *format,
                                 brdffit_error *error);

#endif
