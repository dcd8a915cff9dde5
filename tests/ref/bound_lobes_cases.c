/*
 * Writes random boxes of lists of one to three lobes with the bound that engine `moment` proves for them, and points
 * inside, for ball arithmetic to judge (tests/test_oracles.py). One JSON object a line; numbers as hexadecimal strings, so
 * that nothing is rounded. Usage: bound_lobes_cases BOXES > FILE. SPDX-License-Identifier: MIT
 */
#include "lobes_case.h"

#define POINTS 3

static void write_numbers(const char *name, const double *v, size_t n)
{
    size_t i;

    printf("\"%s\": [", name);
    for (i = 0; i < n; i++) {
        printf("%s\"%a\"", i ? ", " : "", v[i]);
    }
    printf("], ");
}

static void write_lobe(const struct lobes_case *m, int p)
{
    const struct model *model = &m->fit.model;
    double b[LC_SAMPLES], c[LC_SAMPLES];
    size_t i;

    for (i = 0; i < m->count; i++) {
        struct geometry g;

        lc_geometry(m, i, model->distribution[p], &g);
        b[i] = m->vanished[p] ? 0.0 : g.b;
        c[i] = g.c;
    }
    printf("%s{", p ? ", " : "");
    write_numbers("b", b, m->count);
    write_numbers("c", c, m->count);
    printf("\"ggx\": %d}", m->ggx[p]);
}

static void write_box(struct lobes_case *m, struct lc_box *b, uint64_t *s)
{
    struct fit *f = &m->fit;
    double a[LC_SAMPLES], theta[POINTS * LC_LOBES], scale[LC_CHANNELS];
    struct point met;
    size_t i;
    int p, point;

    b->box.bound = INFINITY; /* unreachable: every bound is tried */
    brdffit_bound_moment_start(&f->moment, &f->data, &f->model, f->varpro.kernels, f->axis);
    (void)brdffit_bound_moment(&f->moment, &b->box, &met);
    for (i = 0; i < m->count; i++) {
        struct geometry g;

        lc_geometry(m, i, f->model.distribution[0], &g);
        a[i] = g.a;
    }
    for (i = 0; i < m->channels; i++) {
        scale[i] = f->data.channel_scale[i];
    }
    for (point = 0; point < POINTS; point++) {
        lc_draw_point(m, b, point ? 27 : 13, theta + point * m->lobes, s); /* the middle, then anywhere */
    }
    printf("{\"channels\": %zu, \"lobes\": [", m->channels);
    for (p = 0; p < m->lobes; p++) {
        write_lobe(m, p);
    }
    printf("], ");
    write_numbers("a", a, m->count);
    write_numbers("weights", m->weights, m->samples.weights ? m->count : 0);
    write_numbers("values", m->values, m->count * m->channels);
    write_numbers("scale", scale, m->channels);
    write_numbers("theta", theta, (size_t)(POINTS * m->lobes));
    printf("\"weight_scale\": \"%a\", \"value_scale\": \"%a\", \"bound\": \"%a\"}\n", f->data.scale_w,
           f->data.value_scale, b->box.bound);
}

int main(int argc, char **argv)
{
    static struct lobes_case m;
    long boxes = argc > 1 ? strtol(argv[1], NULL, 10) : 200, done = 0;
    uint64_t seed;
    int i;

    for (seed = 70001; done < boxes; seed++) {
        uint64_t s = seed;

        if (lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT) && m.lobes > 1) {
            struct point optimum = lc_optimum(&m, &s);

            for (i = 0; i < 2 && done < boxes; i++, done++) {
                struct lc_box b;

                lc_draw_box(&m, &optimum, &b, &s);
                write_box(&m, &b, &s);
            }
        }
        lc_close(&m);
    }
    return ferror(stdout) || fflush(stdout) ? 1 : 0;
}
