/*
 * Random starts for the peers: see peers_start.h. SPDX-License-Identifier: MIT
 */
#include "peers_start.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COLUMNS (1 + PEERS_MOST_LOBES)
/* The square-root chart has no gradient where a coefficient is 0: it starts this far (relative) above. */
#define LIFT 1e-3

/* ---- Random numbers: splitmix64 ------------------------------------------------------------------------- */

static uint64_t scramble(uint64_t z)
{
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

/* In (0, 1). */
static double draw(uint64_t *state)
{
    *state += UINT64_C(0x9e3779b97f4a7c15);
    return ((double)(scramble(*state) >> 11) + 0.5) * 0x1p-53;
}

/* ---- Restricted problem --------------------------------------------------------------------------------- */

/* Solve the equations of the columns in `support` (bits) by elimination; 0 when they are near-dependent. */
static int solve(int columns, double gram[COLUMNS][COLUMNS], const double *target, unsigned support, double *z)
{
    double m[COLUMNS][COLUMNS], r[COLUMNS];
    int index[COLUMNS], n = 0, i, j, k;

    for (j = 0; j < columns; j++) {
        z[j] = 0.0;
        if (support >> j & 1u) {
            index[n++] = j;
        }
    }
    for (i = 0; i < n; i++) {
        r[i] = target[index[i]];
        for (j = 0; j < n; j++) {
            m[i][j] = gram[index[i]][index[j]];
        }
    }
    for (i = 0; i < n; i++) {
        if (!(m[i][i] > 1e-14)) {
            return 0;
        }
        for (j = i + 1; j < n; j++) {
            double factor = m[j][i] / m[i][i];

            for (k = i; k < n; k++) {
                m[j][k] -= factor * m[i][k];
            }
            r[j] -= factor * r[i];
        }
    }
    for (i = n - 1; i >= 0; i--) {
        for (k = i + 1; k < n; k++) {
            r[i] -= m[i][k] * r[k];
        }
        r[i] /= m[i][i];
        z[index[i]] = r[i];
    }
    return 1;
}

/* min |value - sum z_j column_j| with z >= 0: unit columns, supports enumerated. */
static void nnls(int columns, double gram[COLUMNS][COLUMNS], const double *target, double *best)
{
    double z[COLUMNS], gain, most = 0.0;
    unsigned support;
    int j;

    memset(best, 0, (size_t)columns * sizeof *best);
    for (support = 1; support < 1u << columns; support++) {
        int good = solve(columns, gram, target, support, z);

        for (j = 0, gain = 0.0; j < columns; j++) {
            good = good && z[j] >= 0.0;
            gain += z[j] * target[j];
        }
        if (good && gain > most) {
            most = gain;
            memcpy(best, z, (size_t)columns * sizeof *best);
        }
    }
}

/* Columns a, g_1 ... made unit; norms of zero columns are 1. */
static void unit_columns(const struct peers_problem *p, const double *parameter, double *column, double *norm)
{
    int j;
    size_t i;

    for (j = 0; j <= p->lobes; j++) {
        double *to = column + (size_t)j * p->samples, sum = 0.0;

        if (j == 0) {
            memcpy(to, p->a, p->samples * sizeof *to);
        } else {
            peers_column(p, parameter[j - 1], to, NULL);
        }
        for (i = 0; i < p->samples; i++) {
            sum = hypot(sum, to[i]);
        }
        norm[j] = sum > 0.0 && sum < INFINITY ? sum : 1.0;
        for (i = 0; i < p->samples; i++) {
            to[i] /= norm[j];
        }
    }
}

static void nnls_coefficients(const struct peers_problem *p, double *parameter)
{
    double gram[COLUMNS][COLUMNS], norm[COLUMNS], target[COLUMNS], z[COLUMNS];
    size_t n = p->samples, lobes = (size_t)p->lobes, i, k;
    double *column = malloc(n * COLUMNS * sizeof *column), *x = parameter + lobes, *y = x + p->channels;
    int j, l, columns = 1 + p->lobes;

    if (!column) {
        abort();
    }
    unit_columns(p, parameter, column, norm);
    for (j = 0; j < columns; j++) {
        for (l = 0; l < columns; l++) {
            for (i = 0, gram[j][l] = 0.0; i < n; i++) {
                gram[j][l] += column[(size_t)j * n + i] * column[(size_t)l * n + i];
            }
        }
    }
    for (k = 0; k < p->channels; k++) {
        for (j = 0; j < columns; j++) {
            for (i = 0, target[j] = 0.0; i < n; i++) {
                target[j] += column[(size_t)j * n + i] * p->value[i * p->channels + k];
            }
        }
        nnls(columns, gram, target, z);
        x[k] = z[0] / norm[0];
        for (j = 1; j < columns; j++) {
            y[k * lobes + (size_t)j - 1] = z[j] / norm[j];
        }
    }
    free(column);
}

/* ---- Starts --------------------------------------------------------------------------------------------- */

static void to_squares(const struct peers_problem *p, double *parameter)
{
    size_t j, lobes = (size_t)p->lobes;

    for (j = lobes; j < peers_parameters(p); j++) {
        double height = 1.0 / (j < lobes + p->channels ? p->a_max : p->b_max);

        parameter[j] = sqrt(fmax(parameter[j], LIFT * height));
    }
}

static void random_coefficients(const struct peers_problem *p, uint64_t *state, double *parameter)
{
    size_t i, k, lobe, lobes = (size_t)p->lobes;

    for (k = 0; k < p->channels; k++) {
        parameter[lobes + k] = draw(state) / p->a_max;
    }
    for (lobe = 0; lobe < lobes; lobe++) {
        double most = 0.0;

        peers_column(p, parameter[lobe], p->column, NULL);
        for (i = 0; i < p->samples; i++) {
            most = fmax(most, p->column[i]);
        }
        for (k = 0; k < p->channels; k++) {
            parameter[lobes + p->channels + k * lobes + lobe] = most > 0.0 ? draw(state) / most : draw(state);
        }
    }
}

/* Roughnesses of start `index`, in the problem's chart; returns the state that more numbers are drawn from. */
static uint64_t draw_roughnesses(const struct peers_problem *problem, const struct peers_start *start, uint64_t index,
                                 double *parameter)
{
    uint64_t state = scramble(start->seed ^ scramble(problem->digest ^ scramble(2 * index + (uint64_t)problem->lobes)));
    int lobe;

    for (lobe = 0; lobe < problem->lobes; lobe++) {
        double u = draw(&state);
        double sigma = start->log_uniform ? PEERS_LOG_UNIFORM_MIN * pow(PEERS_SIGMA_MAX / PEERS_LOG_UNIFORM_MIN, u)
                                          : PEERS_SIGMA_MIN + u * (PEERS_SIGMA_MAX - PEERS_SIGMA_MIN);

        parameter[lobe] = peers_sigma_to_chart(problem, sigma);
    }
    return state;
}

void peers_start_roughness(const struct peers_problem *problem, const struct peers_start *start, uint64_t index,
                           double *parameter)
{
    draw_roughnesses(problem, start, index, parameter);
}

void peers_start_draw(const struct peers_problem *problem, const struct peers_start *start, uint64_t index,
                      double *parameter)
{
    uint64_t state = draw_roughnesses(problem, start, index, parameter);

    if (start->nnls) {
        nnls_coefficients(problem, parameter);
    } else {
        random_coefficients(problem, &state, parameter);
    }
    if (problem->chart == PEERS_SQUARES) {
        to_squares(problem, parameter);
    }
}

void peers_start_at(const struct peers_problem *problem, const double *sigma, double *parameter)
{
    int lobe;

    for (lobe = 0; lobe < problem->lobes; lobe++) {
        parameter[lobe] = peers_sigma_to_chart(problem, sigma[lobe]);
    }
    nnls_coefficients(problem, parameter);
    if (problem->chart == PEERS_SQUARES) {
        to_squares(problem, parameter);
    }
}
