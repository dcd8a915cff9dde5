/*
 * Directions looked up in MERL tables. SPDX-License-Identifier: MIT
 *
 * The reference turns vectors by the definition (Rusinkiewicz: about z by -phi_h, about y by -theta_h) in long
 * double and searches every bin; it shares nothing with the reader.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include "io_support.h"

#define PI_L 3.14159265358979323846264338327950288L

struct list {
    double light[3 * 4000], view[3 * 4000], normal[3 * 4000], weights[4000];
    size_t count;
};

static uint64_t seed = 88172645463325252u;

static double uniform(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (double)(seed >> 11) / 9007199254740992.0;
}

static brdffit_table *look_up(const struct io_merl *merl, const brdffit_samples *directions)
{
    brdffit_io_options options;
    brdffit_table *table = NULL;
    brdffit_error error;

    memset(&error, 0, sizeof error);
    brdffit_io_options_init(&options);
    options.merl_sampling = directions ? BRDFFIT_IO_MERL_DIRECTIONS : BRDFFIT_IO_MERL_PROTOCOL84;
    options.directions = directions;
    if (brdffit_io_read_memory(merl->data, merl->size, &options, &table, &error) != BRDFFIT_OK) {
        print_error("refused: %s\n", error.message);
        fail();
    }
    return table;
}

static brdffit_samples samples_of(const struct list *list)
{
    brdffit_samples samples;

    brdffit_samples_init(&samples);
    samples.count = list->count;
    samples.light = list->light;
    samples.view = list->view;
    return samples;
}

/* The cell that a value of the table's first channel came from (io_merl_new). */
static size_t cell_of(double red)
{
    return (size_t)llrint(red * 1500.0) - 1;
}

static void turn(long double angle, long double *x, long double *y)
{
    long double c = cosl(angle), s = sinl(angle), before = *x;

    *x = c * before - s * *y;
    *y = s * before + c * *y;
}

/* theta_h, theta_d, phi_d in [0, pi) of doubles taken as exact. */
static void exact_angles(const double *light, const double *view, long double out[3])
{
    long double l[3], v[3], h[3], nl = 0, nv = 0, phi_h;
    int i;

    for (i = 0; i < 3; i++) {
        nl += (long double)light[i] * light[i];
        nv += (long double)view[i] * view[i];
    }
    for (i = 0; i < 3; i++) {
        l[i] = light[i] / sqrtl(nl);
        v[i] = view[i] / sqrtl(nv);
        h[i] = l[i] + v[i];
    }
    out[0] = atan2l(hypotl(h[0], h[1]), h[2]);
    phi_h = out[0] > 1e-15L ? atan2l(h[1], h[0]) : 0;
    turn(-phi_h, &l[0], &l[1]);
    turn(-out[0], &l[2], &l[0]); /* about y: z towards x */
    out[1] = atan2l(hypotl(l[0], l[1]), l[2]);
    out[2] = out[1] > 1e-15L ? atan2l(l[1], l[0]) : 0;
    out[2] += out[2] < 0 ? PI_L : 0;
}

static long double edge(int axis, size_t i, size_t bins)
{
    long double part = (long double)i / (long double)bins;

    return axis == 0 ? PI_L / 2 * part * part : axis == 1 ? PI_L / 2 * part : PI_L * part;
}

/* 0 when the directions are too near an edge for a reference to decide. */
static int exact_cell(const int32_t dims[3], const double *light, const double *view, size_t *cell)
{
    long double angle[3];
    size_t bin[3], i;
    int axis;

    exact_angles(light, view, angle);
    for (axis = 0; axis < 3; axis++) {
        size_t bins = (size_t)dims[axis];

        for (i = 0; i <= bins; i++) {
            if (i > 0 && fabsl(edge(axis, i, bins) - angle[axis]) < 1e-10L) {
                return 0;
            }
        }
        for (bin[axis] = 0; bin[axis] + 1 < bins && angle[axis] >= edge(axis, bin[axis] + 1, bins); bin[axis]++) {
        }
    }
    *cell = bin[2] + (size_t)dims[2] * (bin[1] + (size_t)dims[1] * bin[0]);
    return 1;
}

static void test_random_directions(void **state)
{
    static const int32_t dims[][3] = {{90, 90, 180}, {4, 3, 6}, {1, 1, 1}, {20, 7, 33}};
    static struct list list;
    size_t t, i, k, decided;

    (void)state;
    for (t = 0; t < sizeof dims / sizeof *dims; t++) {
        struct io_merl merl = io_merl_new(dims[t][0], dims[t][1], dims[t][2]);
        brdffit_samples samples;
        brdffit_table *table;

        list.count = 4000;
        for (i = 0; i < 3 * list.count; i++) {
            k = i % 3;
            list.light[i] = k == 2 ? uniform() + 1e-3 : 4 * uniform() - 2; /* of any length */
            list.view[i] = k == 2 ? uniform() + 1e-3 : 4 * uniform() - 2;
            if (i / 3 % 4 == 1) { /* near the mirror direction: narrow theta_h */
                list.view[i] = k == 2 ? list.light[i] : -list.light[i] * (1 + 1e-4 * uniform());
            }
        }
        samples = samples_of(&list);
        table = look_up(&merl, &samples);
        assert_int_equal(table->samples->count, list.count);
        for (i = 0, decided = 0; i < list.count; i++) {
            size_t cell;

            if (exact_cell(dims[t], list.light + 3 * i, list.view + 3 * i, &cell)) {
                assert_int_equal(cell_of(table->samples->values[3 * i]), cell);
                assert_same(table->samples->values[3 * i + 1], (double)(10001 + cell) * (1.15 / 1500.0));
                assert_same(table->samples->values[3 * i + 2], (double)(20001 + cell) * (1.66 / 1500.0));
                decided++;
            }
        }
        assert_true(decided > list.count - 20);
        assert_memory_equal(table->samples->light, list.light, 3 * list.count * sizeof(double)); /* as requested */
        assert_memory_equal(table->samples->view, list.view, 3 * list.count * sizeof(double));
        assert_null(table->samples->normal);
        assert_int_equal(table->merl_sampling, BRDFFIT_IO_MERL_DIRECTIONS);
        assert_int_equal(table->rows, merl.cells);
        brdffit_io_free(table);
        free(merl.data);
    }
}

/* Directions built in long double from the lower edges of a cell must find that cell, in any azimuth. */
static void test_aimed_at_edges(void **state)
{
    const int32_t dims[3] = {90, 90, 180};
    struct io_merl merl = io_merl_new(dims[0], dims[1], dims[2]);
    static struct list list;
    static size_t wanted[4000];
    brdffit_samples samples;
    brdffit_table *table;
    size_t i;

    (void)state;
    list.count = 0;
    while (list.count < 4000) {
        size_t h = 1 + (size_t)(uniform() * 89), d = 1 + (size_t)(uniform() * 89), p = (size_t)(uniform() * 180);
        long double th = edge(0, h, 90), td = edge(1, d, 90), pd = edge(2, p, 180);
        long double light[3] = {sinl(td) * cosl(pd), sinl(td) * sinl(pd), cosl(td)};
        long double view[3] = {-light[0], -light[1], light[2]}, phi_h = uniform() * 6;
        int k;

        turn(th, &light[2], &light[0]);
        turn(th, &view[2], &view[0]);
        turn(phi_h, &light[0], &light[1]);
        turn(phi_h, &view[0], &view[1]);
        if (light[2] < 1e-3L || view[2] < 1e-3L) {
            continue;
        }
        for (k = 0; k < 3; k++) {
            list.light[3 * list.count + (size_t)k] = (double)light[k];
            list.view[3 * list.count + (size_t)k] = (double)view[k];
        }
        wanted[list.count++] = p + 180 * (d + 90 * h);
    }
    samples = samples_of(&list);
    table = look_up(&merl, &samples);
    for (i = 0; i < list.count; i++) {
        assert_int_equal(cell_of(table->samples->values[3 * i]), wanted[i]);
    }
    brdffit_io_free(table);
    free(merl.data);
}

/* Mirror directions in any azimuth are theta_h = 0 and phi_d the light's azimuth, not that of what rounding left of
 * the half vector; equal directions are theta_d = 0 and phi_d = 0, also when their lengths differ. */
static void test_degenerate_angles(void **state)
{
    struct io_merl merl = io_merl_new(90, 90, 180);
    static struct list list;
    brdffit_samples samples;
    brdffit_table *table;
    size_t i;

    (void)state;
    list.count = 2000;
    for (i = 0; i < list.count; i++) {
        double theta = 1.5 * uniform(), phi = 7 * uniform(), *l = list.light + 3 * i, *v = list.view + 3 * i;

        l[0] = sin(theta) * cos(phi);
        l[1] = sin(theta) * sin(phi);
        l[2] = cos(theta);
        v[0] = 3 * (i % 2 ? l[0] : -l[0]);
        v[1] = 3 * (i % 2 ? l[1] : -l[1]);
        v[2] = 3 * l[2];
    }
    samples = samples_of(&list);
    table = look_up(&merl, &samples);
    assert_int_equal(table->samples->count, list.count);
    for (i = 0; i < list.count; i++) {
        size_t cell = cell_of(table->samples->values[3 * i]);

        if (i % 2) {
            assert_int_equal(cell % (90 * 180), 0);
        } else {
            double degrees = fmod(atan2(list.light[3 * i + 1], list.light[3 * i]) * 57.29577951308232 + 360, 180);

            assert_int_equal(cell / (90 * 180), 0);
            if (fabs(degrees - rint(degrees)) > 1e-6) {
                assert_int_equal(cell % 180, (size_t)degrees);
            }
        }
    }
    brdffit_io_free(table);
    free(merl.data);
}

static void test_protocol(void **state)
{
    const int32_t dims[3] = {90, 90, 180};
    struct io_merl merl = io_merl_new(dims[0], dims[1], dims[2]);
    brdffit_table *table = look_up(&merl, NULL);
    double light[84 * 3], view[84 * 3];
    size_t i, cell, decided = 0;

    (void)state;
    brdffit_io_protocol84(light, view);
    assert_int_equal(table->samples->count, 84);
    assert_int_equal(table->samples->form, BRDFFIT_FORM_DIRECTIONS);
    assert_int_equal(table->merl_sampling, BRDFFIT_IO_MERL_PROTOCOL84);
    assert_memory_equal(table->samples->light, light, sizeof light);
    assert_memory_equal(table->samples->view, view, sizeof view);
    for (i = 0; i < 84; i++) {
        long double at = PI_L / 180 * 20 * (long double)(i / 21), from = PI_L / 180 * 10 * (long double)(i / 3 % 7);
        long double azimuth = PI_L / 2 * (long double)(i % 3);

        io_assert_near(light[3 * i], sinl(from) * cosl(azimuth), 2e-16);
        io_assert_near(light[3 * i + 1], sinl(from) * sinl(azimuth), 2e-16);
        io_assert_near(light[3 * i + 2], cosl(from), 2e-16);
        io_assert_near(view[3 * i], sinl(at), 2e-16);
        assert_same(view[3 * i + 1], 0);
        io_assert_near(view[3 * i + 2], cosl(at), 2e-16);
        if (exact_cell(dims, light + 3 * i, view + 3 * i, &cell)) {
            assert_int_equal(cell_of(table->samples->values[3 * i]), cell);
            decided++;
        }
    }
    assert_true(decided > 10);
    /* By hand: light 20, view 20, azimuth 0: theta_h 20 -> floor(90 sqrt(2/9)) = 42, theta_d 0. */
    assert_int_equal(cell_of(table->samples->values[3 * (21 + 6)]), 42 * 90 * 180);
    /* Opposite, azimuth 180: theta_h 0, theta_d 20, phi_d 180 = 0. */
    assert_int_equal(cell_of(table->samples->values[3 * (21 + 8)]), 20 * 180);
    /* Light 60, view 0, azimuth 0: theta_h 30 -> floor(51.96), theta_d 30, phi_d 0; azimuth 180: phi_d 0 as well. */
    assert_int_equal(cell_of(table->samples->values[3 * 18]), 180 * (30 + 90 * 51));
    assert_int_equal(cell_of(table->samples->values[3 * 20]), 180 * (30 + 90 * 51));
    brdffit_io_free(table);
    free(merl.data);
}

/* The table is isotropic: turning light, view and normal together changes nothing. */
static void test_normals(void **state)
{
    const int32_t dims[3] = {20, 15, 30};
    struct io_merl merl = io_merl_new(dims[0], dims[1], dims[2]);
    static struct list flat, turned;
    brdffit_samples samples, other;
    brdffit_table *table, *same;
    size_t i, cell, decided = 0;

    (void)state;
    flat.count = turned.count = 2000;
    for (i = 0; i < flat.count; i++) {
        long double a = 7 * uniform(), b = 7 * uniform(), length = 0.1L + uniform();
        long double v[3][3] = {{0, 0, length}};
        int j, k;

        for (k = 0; k < 3; k++) {
            v[1][k] = flat.light[3 * i + (size_t)k] = k == 2 ? uniform() + 1e-3 : 2 * uniform() - 1;
            v[2][k] = flat.view[3 * i + (size_t)k] = k == 2 ? uniform() + 1e-3 : 2 * uniform() - 1;
        }
        for (j = 0; j < 3; j++) {
            turn(a, &v[j][0], &v[j][2]);
            turn(b, &v[j][1], &v[j][2]);
            for (k = 0; k < 3; k++) {
                (j == 0 ? turned.normal : j == 1 ? turned.light : turned.view)[3 * i + (size_t)k] = (double)v[j][k];
            }
        }
        turned.weights[i] = uniform();
    }
    samples = samples_of(&flat);
    other = samples_of(&turned);
    other.normal = turned.normal;
    other.weights = turned.weights;
    table = look_up(&merl, &samples);
    same = look_up(&merl, &other);
    assert_int_equal(same->samples->count, flat.count);
    for (i = 0; i < flat.count; i++) {
        if (exact_cell(dims, flat.light + 3 * i, flat.view + 3 * i, &cell)) {
            assert_same(table->samples->values[3 * i], same->samples->values[3 * i]);
            assert_int_equal(cell_of(same->samples->values[3 * i]), cell);
            decided++;
        }
    }
    assert_true(decided > flat.count - 20);
    assert_memory_equal(same->samples->normal, turned.normal, 3 * flat.count * sizeof(double));
    assert_memory_equal(same->samples->weights, turned.weights, flat.count * sizeof(double));
    brdffit_io_free(table);
    brdffit_io_free(same);
    free(merl.data);
}

/* Vectors whose squares overflow or vanish, and a normal straight down. */
static void test_odd_lengths(void **state)
{
    static const double light[] = {0, 0, 1e300, 3e-320, 0, 4e-320, 0, 1e-200, -1e-200};
    static const double view[] = {0, 0, 1e-300, -3e300, 0, 4e300, 0, -5, -5}, normal[] = {0, 0, 1, 0, 0, 1, 0, 0, -2};
    struct io_merl merl = io_merl_new(90, 90, 180);
    brdffit_samples samples;
    brdffit_table *table;

    (void)state;
    brdffit_samples_init(&samples);
    samples.count = 3;
    samples.light = light;
    samples.view = view;
    samples.normal = normal;
    table = look_up(&merl, &samples);
    assert_int_equal(table->samples->count, 3);
    assert_int_equal(cell_of(table->samples->values[0]), 0);
    assert_int_equal(cell_of(table->samples->values[3]) / 180, 36); /* theta_h 0, theta_d 36.87 */
    assert_int_equal(cell_of(table->samples->values[6]) / 180, 45);
    brdffit_io_free(table);
    free(merl.data);
}

static void test_dropped(void **state)
{
    /* light below, view below, light on the horizon (as cos(pi/2) says), masked, good */
    static const double light[] = {0, 0, -1, 0, 0, 1, 1, 0, 6.1e-17, 0, 0, 1, 0.1, 0, 1};
    static const double view[] = {0, 0, 1, 1, 0, -1e-3, 0, 0, 1, 0, 0, 1, 0.1, 0, 1};
    struct io_merl merl = io_merl_new(4, 3, 6);
    brdffit_samples samples;
    brdffit_table *table;
    brdffit_io_options options;
    brdffit_error error;
    brdffit_status status;
    size_t k;

    (void)state;
    io_put(&merl, 1, 0, -1.0);
    brdffit_samples_init(&samples);
    samples.count = 5;
    samples.light = light;
    samples.view = view;
    brdffit_io_options_init(&options);
    options.merl_sampling = BRDFFIT_IO_MERL_DIRECTIONS;
    options.directions = &samples;
    table = look_up(&merl, &samples);
    assert_int_equal(table->samples->count, 1);
    assert_int_equal(table->dropped[BRDFFIT_IO_DROP_BELOW_HORIZON], 3);
    assert_int_equal(table->dropped[BRDFFIT_IO_DROP_MASKED], 1);
    assert_memory_equal(table->samples->light, light + 12, 3 * sizeof(double));
    brdffit_io_free(table);
    for (k = 0; k < 3; k++) { /* a negative entry in any one channel masks */
        io_put(&merl, 1, 0, 1.0);
        io_put(&merl, k, 0, -1e-9);
        table = look_up(&merl, &samples);
        assert_int_equal(table->dropped[BRDFFIT_IO_DROP_MASKED], 1);
        brdffit_io_free(table);
        io_put(&merl, k, 0, -1.0);
        samples.count = 4;
        status = brdffit_io_read_memory(merl.data, merl.size, &options, &table, &error);
        io_assert_failed(status, table, &error, BRDFFIT_ERR_NO_SAMPLES, "masked");
        samples.count = 5;
        io_put(&merl, k, 0, 1.0);
    }
    free(merl.data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_directions), cmocka_unit_test(test_aimed_at_edges),
        cmocka_unit_test(test_degenerate_angles), cmocka_unit_test(test_protocol),
        cmocka_unit_test(test_normals),           cmocka_unit_test(test_odd_lengths),
        cmocka_unit_test(test_dropped),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
