/*
 * Columns of an anisotropic lobe with their derivatives: see varpro.h and model/turn.h. SPDX-License-Identifier: MIT
 */
#include "base/exp.h"
#include "solve/varpro.h"

/*
 * Column c by theta, phi = f(E), E = c_x s_x + c_y s_y: with q_d = c_d s_d and E = sum q_d,
 *
 *     d phi / d theta_d = phi L q_d,     d^2 phi / d theta_d d theta_e = phi [M q_d q_e + (d = e) L q_d]
 *
 * L = -1 and M = 1 of exp(-E); L = -2 / (1 + E) and M = 6 / (1 + E)^2 of (1 + E)^-2.
 */
static void differentiate_turned(struct varpro *v, int c, const double s[2])
{
    const struct reduced *data = v->data;
    const struct table *t = varpro_table(v, c);
    int exponential = model_column_kind(v->model, c)->exponential;
    double **first = v->first + 2 * c, **second = v->second + 3 * c;
    size_t r;

    for (r = 0; r < data->rows; r++) {
        uint32_t j = data->row_c[r];
        double value = t->row_b[r] * v->phi[j], x = t->light[j] * s[0], y = t->view[j] * s[1];
        double w = 1.0 / (1.0 + v->exponent[j]), by = exponential ? -1.0 : -2.0 * w,
               twice = exponential ? 1.0 : 6.0 * (w * w);

        v->column[c][r] = value;
        first[0][r] = value * (by * x);
        first[1][r] = value * (by * y);
        second[0][r] = value * (x * (twice * x + by));
        second[1][r] = value * (twice * (x * y));
        second[2][r] = value * (y * (twice * y + by));
    }
}

void brdffit_varpro_turned(struct varpro *v, const double theta[2], int derivatives)
{
    double s[2] = {kernel_exp(theta[0]), kernel_exp(theta[1])};
    size_t r;
    int c;

    brdffit_turned_shape(v->kernels, model_kind(v->model, 0), &varpro_table(v, 0)->sight, v->data->stride, s,
                         v->exponent, v->phi);
    for (c = 0; c < v->model->each; c++) {
        const double *row_b = varpro_table(v, c)->row_b;

        if (derivatives) {
            differentiate_turned(v, c, s);
        }
        for (r = 0; r < v->data->rows && !derivatives; r++) {
            v->column[c][r] = row_b[r] * v->phi[v->data->row_c[r]];
        }
    }
}
