/*
 * Writes random boxes with the bound that engine `moment` proves for them, and points inside, for ball arithmetic to
 * judge (tests/test_oracles.py). One JSON object a line; numbers as hexadecimal strings, so that nothing is
 * rounded. Usage: bound_cases BOXES > FILE. SPDX-License-Identifier: MIT
 */
#include <stdlib.h>
#include <string.h>

#include "bound_case.h"
#include "fit/fit.h"

#define POINTS 5

static void write_numbers(const char *name, const double *v, size_t n)
{
    size_t i;

    printf("\"%s\": [", name);
    for (i = 0; i < n; i++) {
        printf("%s\"%a\"", i ? ", " : "", v[i]);
    }
    printf("], ");
}

/* A box near the optimum or anywhere; disjoint sides. */
static void draw_box(const struct fit *f, const double *near, uint64_t *s, double range[4])
{
    double low = f->domain[0].low, high = f->domain[0].high;
    int p;

    for (p = 0; p < 2; p++) {
        double width = (high - low) * pow(10.0, -8.0 * case_uniform(s));
        double centre = case_next(s) % 4 ? near[p] : low + (high - low) * case_uniform(s);

        range[2 * p] = fmin(fmax(centre - width * case_uniform(s), low), high);
        range[2 * p + 1] = fmin(fmax(centre + width * case_uniform(s), range[2 * p]), high);
    }
    if (range[0] > range[2]) {
        double swap[2] = {range[0], range[1]};

        memcpy(range, range + 2, sizeof swap);
        memcpy(range + 2, swap, sizeof swap);
    }
    range[1] = fmin(range[1], range[2]);
}

static double bound_of(struct fit *f, int lobes, const double range[4])
{
    struct box box = {0.0, 0, 0, {0, 1}};
    struct point met;
    int i;

    for (i = 0; i < 2; i++) {
        f->axis[0].interval[i].low = (uint32_t)(2 * i);
        f->axis[0].interval[i].high = (uint32_t)(2 * i + 1);
        f->axis[0].interval[i].child = 0;
    }
    for (i = 0; i < 4; i++) {
        f->axis[0].coordinate[i] = range[i];
    }
    f->axis[0].intervals = 2;
    f->axis[0].nodes = 4;
    box.bound = INFINITY; /* unreachable: every bound is tried */
    box.interval[1] = lobes > 1 ? 1 : 0;
    brdffit_bound_moment_start(&f->moment, &f->data, &f->model, f->varpro.kernels, f->axis);
    (void)brdffit_bound_moment(&f->moment, &box, &met);
    return box.bound;
}

static void write_box(const struct bound_case *c, struct fit *f, const double range[4], uint64_t *s)
{
    double bound = bound_of(f, c->lobes, range), theta[2 * POINTS], scale[CASE_CHANNELS];
    int i, p;

    for (i = 0; i < POINTS; i++) {
        for (p = 0; p < 2; p++) {
            double t = range[2 * p] + case_uniform(s) * (range[2 * p + 1] - range[2 * p]);

            theta[2 * i + p] = fmin(fmax(t, range[2 * p]), range[2 * p + 1]);
        }
    }
    for (i = 0; i < (int)c->channels; i++) {
        scale[i] = f->data.channel_scale[i] * f->data.value_scale;
    }
    printf("{\"lobes\": %d, \"ggx\": %d, \"channels\": %zu, ", c->lobes, c->distribution == BRDFFIT_GGX, c->channels);
    write_numbers("a", c->a, c->count);
    write_numbers("b", c->b, c->count);
    write_numbers("c", c->c, c->count);
    write_numbers("values", c->values, c->count * c->channels);
    write_numbers("scale", scale, c->channels);
    write_numbers("box", range, 4);
    write_numbers("theta", theta, 2 * POINTS);
    printf("\"bound\": \"%a\"}\n", bound);
}

static void write_problem(uint64_t seed, int boxes)
{
    struct bound_case c;
    brdffit_options options;
    brdffit_samples samples;
    const brdffit_result *result;
    struct arena arena;
    struct fit fit;
    uint64_t s = seed;
    double near[2];
    size_t size;
    void *workspace;

    bound_case_make(&c, seed, &samples, &options);
    size = brdffit_workspace_size(c.count, c.channels, &options);
    workspace = malloc(size);
    if (!workspace || brdffit_fit(&samples, &options, workspace, size, &result, NULL) != BRDFFIT_OK) {
        exit(1);
    }
    near[0] = -2.0 * log(result->model->sigma[c.lobes - 1]);
    near[1] = -2.0 * log(result->model->sigma[0]);
    brdffit_arena_init(&arena, workspace, size);
    brdffit_fit_layout(&fit, &arena, c.count, c.channels, &options);
    if (brdffit_reduce(&fit.data, &samples, &fit.model, &options, NULL) != BRDFFIT_OK) {
        exit(1);
    }
    bound_case_rescale(&c, &fit.data);
    brdffit_fit_prepare(&fit, &options);
    while (boxes-- > 0) {
        double range[4];

        draw_box(&fit, near, &s, range);
        write_box(&c, &fit, range, &s);
    }
    free(workspace);
}

int main(int argc, char **argv)
{
    long boxes = argc > 1 ? strtol(argv[1], NULL, 10) : 200, done;

    for (done = 0; done < boxes; done += 4) {
        write_problem(5000 + (uint64_t)done, boxes - done < 4 ? (int)(boxes - done) : 4);
    }
    return ferror(stdout) || fflush(stdout) ? 1 : 0;
}
