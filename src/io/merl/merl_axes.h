/*
 * The axes of a MERL table. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_MERL_AXES_H
#define BRDFFIT_IO_MERL_AXES_H

#include "brdffit_io.h"

/* Sines and cosines of one axis; of phi_d only the cosines are used. */
struct merl_axis {
    double *sine, *cosine;
};

/* theta_h, theta_d, phi_d. 0: no memory. Release either way. */
int brdffit_io_merl_axes_new(struct merl_axis axis[3], const size_t dims[3], brdffit_io_merl_bins bins);
void brdffit_io_merl_axes_free(struct merl_axis axis[3]);

#endif
