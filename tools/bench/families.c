/*
 * Hard problems with known truth, the same bytes from the same seed:
 *
 *     families OUTDIR [--seed N] [--members M]
 *
 *     OUTDIR/narrow/NN.csv   a wide lobe and one far narrower than the sampling (sigma 0.002 to 0.02, directions 5
 *                            degrees of half angle apart); 1 % noise
 *     OUTDIR/near/NN.csv     two lobes whose roughnesses differ by 5 to 30 %, mixed differently in each channel;
 *                            0.1 % noise
 *     OUTDIR/single/NN.csv   one lobe; a second can fit nothing but the 1 % noise
 *
 * The directions are the paper's 84, three channels. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "../goniometer/random.h"
#include "brdffit.h"

#define SAMPLES 84
#define CHANNELS 3

enum family { NARROW, NEAR, SINGLE, FAMILIES };

static const char *const names[FAMILIES] = {"narrow", "near", "single"};

struct member {
    double sigma[2], x[CHANNELS], y[CHANNELS * 2]; /* y: channels x 2 */
    double noise;                                  /* relative */
};

static double between(struct gonio_random *random, double low, double high)
{
    return low + (high - low) * brdffit_gonio_uniform(random);
}

static double log_between(struct gonio_random *random, double low, double high)
{
    return exp(between(random, log(low), log(high)));
}

/* y is chosen by the height y / sigma^2 of its lobe, beside a diffuse term of about 1. */
static struct member draw(enum family family, struct gonio_random *random)
{
    struct member m = {{0.0, 0.0}, {0.0}, {0.0}, family == NEAR ? 0.001 : 0.01};
    double height;
    int k;

    m.sigma[1] = log_between(random, 0.1, 0.5);
    m.sigma[0] = family == NARROW ? log_between(random, 0.002, 0.02)
                                  : m.sigma[1] / (1.0 + log_between(random, 0.05, 0.3));
    height = log_between(random, 1.0, 30.0);
    for (k = 0; k < CHANNELS; k++) {
        double share = between(random, 0.2, 0.8);

        m.x[k] = between(random, 0.05, 1.0);
        if (family == NARROW) {
            m.y[2 * k] = height * between(random, 0.2, 4.0) * m.sigma[0] * m.sigma[0];
            m.y[2 * k + 1] = height * share * m.sigma[1] * m.sigma[1];
        } else {
            m.y[2 * k] = family == NEAR ? height * (1.0 - share) * m.sigma[0] * m.sigma[0] : 0.0;
            m.y[2 * k + 1] = height * share * m.sigma[1] * m.sigma[1];
        }
    }
    return m;
}

/* 21 lights for each of 4 views; degrees: theta_i, phi_i, theta_o, phi_o. */
static void directions(double angle[SAMPLES][4], double light[SAMPLES][3], double view[SAMPLES][3])
{
    static const double theta_o[4] = {0.0, 20.0, 40.0, 60.0};
    const double degree = 3.14159265358979323846 / 180.0;
    int i;

    for (i = 0; i < SAMPLES; i++) {
        double theta = 10.0 * (i / 3 % 7), phi = 90.0 * (i % 3), out = theta_o[i / 21];

        angle[i][0] = theta;
        angle[i][1] = phi;
        angle[i][2] = out;
        angle[i][3] = 0.0;
        light[i][0] = sin(theta * degree) * cos(phi * degree);
        light[i][1] = sin(theta * degree) * sin(phi * degree);
        light[i][2] = cos(theta * degree);
        view[i][0] = sin(out * degree);
        view[i][1] = 0.0;
        view[i][2] = cos(out * degree);
    }
}

static int write_member(const char *path, const struct member *m, struct gonio_random *random)
{
    static double angle[SAMPLES][4], light[SAMPLES][3], view[SAMPLES][3], value[SAMPLES][CHANNELS];
    brdffit_model model;
    brdffit_samples at;
    FILE *file = fopen(path, "w");
    int i, k;

    if (!file) {
        return 0;
    }
    directions(angle, light, view);
    brdffit_samples_init(&at);
    at.count = SAMPLES;
    at.channels = CHANNELS;
    at.light = light[0];
    at.view = view[0];
    brdffit_model_init(&model);
    model.lobes = 2;
    model.channels = CHANNELS;
    model.sigma = m->sigma;
    model.x = m->x;
    model.y = m->y;
    if (brdffit_eval(&model, &at, value[0], NULL) != BRDFFIT_OK) {
        fclose(file);
        return 0;
    }
    fprintf(file, "theta_i,phi_i,theta_o,phi_o,r,g,b\n");
    for (i = 0; i < SAMPLES; i++) {
        fprintf(file, "%g,%g,%g,%g", angle[i][0], angle[i][1], angle[i][2], angle[i][3]);
        for (k = 0; k < CHANNELS; k++) {
            fprintf(file, ",%.9g", value[i][k] * (1.0 + m->noise * brdffit_gonio_normal(random)));
        }
        fprintf(file, "\n");
    }
    return fclose(file) == 0;
}

static int make_folder(const char *path)
{
    return mkdir(path, 0777) == 0 || errno == EEXIST;
}

static int write_all(const char *folder, unsigned long long seed, int members)
{
    char path[4096];
    int f, i, good = make_folder(folder);

    for (f = 0; f < FAMILIES && good; f++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[f]);
        good = make_folder(path);
        for (i = 0; i < members && good; i++) {
            struct gonio_random random = brdffit_gonio_random(seed, (uint64_t)(1000 * f + i));
            struct member member = draw((enum family)f, &random);

            snprintf(path, sizeof path, "%s/%s/%02d.csv", folder, names[f], i + 1);
            good = write_member(path, &member, &random);
        }
    }
    if (!good) {
        fprintf(stderr, "families: cannot write to %s\n", folder);
    }
    return good;
}

int main(int argc, char **argv)
{
    unsigned long long seed = 1;
    int members = 20, i = 2;
    char end;

    for (; argc >= 2 && i + 1 < argc; i += 2) {
        int good = strcmp(argv[i], "--seed") == 0      ? sscanf(argv[i + 1], "%llu%c", &seed, &end) == 1
                   : strcmp(argv[i], "--members") == 0 ? sscanf(argv[i + 1], "%d%c", &members, &end) == 1
                                                       : 0;

        if (!good || members < 1 || members > 99) {
            break;
        }
    }
    if (argc < 2 || i != argc) {
        fprintf(stderr, "usage: families OUTDIR [--seed N] [--members 1-99]\n");
        return 2;
    }
    return write_all(argv[1], seed, members) ? 0 : 1;
}
