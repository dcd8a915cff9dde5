/*
 * The judge itself: it accepts right results and finds every single claim that was made false.
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "ref/ref_exact.h"
#include "support.h"
#include "verify.h"

#define CHANNELS 3

/* A result with arrays of its own, to be spoilt. */
struct copy {
    struct brdffit_test_result result;
    double x[CHANNELS], y[2 * CHANNELS], scale[CHANNELS], rms[CHANNELS];
    brdffit_distribution distributions[2];
};

struct fixture {
    struct brdffit_test_data data;
    brdffit_options options;
    struct copy right;
};

static void copy_from(struct copy *to, const struct brdffit_test_result *from)
{
    size_t lobes = (size_t)from->model.lobes;

    to->result = *from;
    memcpy(to->distributions, from->model.distributions, lobes * sizeof to->distributions[0]);
    memcpy(to->x, from->model.x, sizeof to->x);
    memcpy(to->y, from->model.y, lobes * CHANNELS * sizeof(double));
    memcpy(to->scale, from->channel_scale, sizeof to->scale);
    memcpy(to->rms, from->rms, sizeof to->rms);
    to->result.model.distributions = to->distributions;
    to->result.model.x = to->x;
    to->result.model.y = to->y;
    to->result.channel_scale = to->scale;
    to->result.rms = to->rms;
}

static void fixture_new(struct fixture *f, double noise)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_fit fit;

    spec.noise = noise;
    brdffit_test_data_new(&spec, &f->data);
    brdffit_options_init(&f->options);
    f->options.lobes = 2;
    brdffit_test_fit(&f->data.samples, &f->options, &fit);
    copy_from(&f->right, &fit.result);
    brdffit_test_fit_free(&fit);
}

static int accepted(const struct fixture *f, const struct copy *copy)
{
    char why[512];
    int answer = brdffit_test_verify(&f->data.samples, &f->options, &copy->result, why, sizeof why);

    assert_int_equal(answer == 0, why[0] == '\0');
    return answer == 0;
}

/* Spoil one claim of a copy; the judge must notice, and accept the original. */
#define REFUSE(statement)                                                                                              \
    do {                                                                                                               \
        struct copy wrong;                                                                                             \
        copy_from(&wrong, &f.right.result);                                                                            \
        statement;                                                                                                     \
        if (accepted(&f, &wrong)) {                                                                                    \
            fail_msg("accepted with: %s", #statement);                                                                 \
        }                                                                                                              \
    } while (0)

static void test_wrong_numbers(void **state)
{
    struct fixture f;

    (void)state;
    fixture_new(&f, 0.01);
    assert_true(accepted(&f, &f.right));
    REFUSE(wrong.result.e2 *= 1.0 + 1e-11);
    REFUSE(wrong.result.e2 *= 1.0 - 1e-11);
    REFUSE(wrong.result.e2 = NAN);
    REFUSE(wrong.result.gap *= 1.0 + 1e-9);
    REFUSE(wrong.result.lower_bound = wrong.result.e2 * (1.0 + 1e-9));
    REFUSE(wrong.result.lower_bound = -1e-300);
    REFUSE(wrong.result.lower_bound = NAN);
    REFUSE(wrong.result.sum_of_squares *= 1.0 + 1e-10);
    REFUSE(wrong.result.rms_total *= 1.0 + 1e-10);
    REFUSE(wrong.result.kkt_residual = 1e-6);
    REFUSE(wrong.result.kkt_residual = NAN);
    REFUSE(wrong.x[1] *= 1.0 + 1e-9);
    REFUSE(wrong.x[1] = -wrong.x[1]);
    REFUSE(wrong.x[1] = NAN);
    REFUSE(wrong.y[3] *= 1.0 - 1e-9);
    REFUSE(wrong.y[3] = INFINITY);
    REFUSE(wrong.scale[2] *= 1.0 + 1e-12);
    REFUSE(wrong.rms[0] *= 1.0 + 1e-11);
    REFUSE(wrong.result.model.sigma[0] *= 1.0 + 1e-6; wrong.result.lobe[0].sigma = wrong.result.model.sigma[0]);
    REFUSE(wrong.result.model.sigma[0] *= 1.0 + 1e-15);
    REFUSE(wrong.result.model.sigma[1] = 7.0; wrong.result.lobe[1].sigma = 7.0);
    brdffit_test_data_free(&f.data);
}

static void test_wrong_words(void **state)
{
    struct fixture f;

    (void)state;
    fixture_new(&f, 0.01);
    REFUSE(wrong.result.samples_used--);
    REFUSE(wrong.result.samples_skipped[BRDFFIT_SKIP_INCIDENCE]++);
    REFUSE(wrong.result.distinct_c = 0);
    REFUSE(wrong.result.distinct_c = wrong.result.samples_used + 1);
    REFUSE(wrong.result.certified = 0);
    REFUSE(wrong.result.stop = BRDFFIT_STOP_BUDGET);
    REFUSE(wrong.result.stop = BRDFFIT_STOP_ABSOLUTE_GAP);
    REFUSE(wrong.result.stop = BRDFFIT_STOP_COUNT);
    REFUSE(wrong.result.boxes = f.options.box_budget + 1);
    REFUSE(wrong.result.model.distribution = BRDFFIT_GGX);
    REFUSE(wrong.result.model.lobes = 1);
    REFUSE(wrong.result.model.channels = 2);
    REFUSE(wrong.result.lobe[0].weight += 1e-12);
    REFUSE(wrong.result.lobe[0].effective_samples *= 1.0 + 1e-6);
    REFUSE(wrong.result.lobe[0].warnings ^= BRDFFIT_WARN_UNRESOLVED);
    REFUSE(wrong.result.lobe[1].warnings ^= BRDFFIT_WARN_UNUSED);
    REFUSE(wrong.result.lobe[1].warnings ^= BRDFFIT_WARN_AT_LIMIT);
    REFUSE(wrong.result.lobe[0].sigma_low *= 0.999);
    REFUSE(wrong.result.lobe[0].sigma_low *= 0.999; wrong.result.lobe[0].warnings |= BRDFFIT_WARN_FLAT);
    REFUSE(wrong.result.lobe[0].sigma_high *= 1.001);
    brdffit_test_data_free(&f.data);
}

/* A result that is right in every detail but claims another optimum's certificate. */
static void test_wrong_certificate(void **state)
{
    struct brdffit_test_fit one;
    struct brdffit_test_data data;
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    brdffit_options narrow, wide;
    struct brdffit_test_result result;
    char why[512];

    (void)state;
    spec.noise = 0.01;
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init(&narrow);
    narrow.lobes = 2;
    narrow.sigma_max = 0.35; /* leaves the optimum out */
    wide = narrow;
    wide.sigma_max = 6.0;
    brdffit_test_fit(&data.samples, &narrow, &one);
    result = one.result;
    result.lobe[0].warnings &= ~BRDFFIT_WARN_AT_LIMIT;
    result.lobe[1].warnings &= ~BRDFFIT_WARN_AT_LIMIT;
    assert_int_equal(brdffit_test_verify(&data.samples, &wide, &result, why, sizeof why), 1);
    assert_non_null(strstr(why, "lower_bound"));
    brdffit_test_fit_free(&one);
    brdffit_test_data_free(&data);
}

/* The optimum of a domain of one point, 1e-4 beside the true roughness, passed off as that of the whole domain. */
static void test_bound_is_attacked(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    struct brdffit_test_fit best, beside;
    brdffit_options whole, point;
    char why[512];

    (void)state;
    spec.noise = 0.01;
    brdffit_test_data_new(&spec, &data);
    brdffit_options_init(&whole);
    brdffit_test_fit(&data.samples, &whole, &best);
    point = whole;
    point.sigma_min = point.sigma_max = best.result.model.sigma[0] * (1.0 + 1e-4);
    brdffit_test_fit(&data.samples, &point, &beside);
    assert_true(beside.result.lower_bound > best.result.e2);
    assert_true(beside.result.e2 < best.result.e2 * (1.0 + 1e-6));
    beside.result.lobe[0].warnings = best.result.lobe[0].warnings;
    beside.result.sigma_floor = best.result.sigma_floor;
    assert_int_equal(brdffit_test_verify(&data.samples, &whole, &beside.result, why, sizeof why), 1);
    assert_non_null(strstr(why, "lower_bound"));
    brdffit_test_fit_free(&best);
    brdffit_test_fit_free(&beside);
    brdffit_test_data_free(&data);
}

/* The enumeration of supports against the KKT conditions, on random small problems with ties and dependence. */
static void test_exact_reference(void **state)
{
    struct brdffit_test_random random = {5};
    int round;

    (void)state;
    for (round = 0; round < 2000; round++) {
        enum { ROWS = 7 };
        struct ref_rows rows = ref_rows_new(ROWS, 1);
        long double column[3][ROWS], z[3], room[64], e2, check = 0.0L;
        const long double *columns[3] = {column[0], column[1], column[2]};
        size_t i;
        int j;

        for (i = 0; i < ROWS; i++) {
            rows.data[i] = brdffit_test_uniform(&random, -1.0, 1.0);
            for (j = 0; j < 3; j++) {
                column[j][i] = brdffit_test_uniform(&random, 0.0, 1.0);
            }
            if (round % 4 == 0) {
                column[1][i] = column[0][i] * (1.0L + (round % 8 ? 1e-12L * (long double)i : 0.0L));
            }
        }
        e2 = ref_exact(&rows, columns, 3, room, z);
        for (i = 0; i < ROWS; i++) {
            long double residual = rows.data[i] - z[0] * column[0][i] - z[1] * column[1][i] - z[2] * column[2][i];

            room[i] = residual;
            check += residual * residual;
        }
        assert_true(fabsl(check - e2) <= 1e-16L * (1.0L + e2));
        for (j = 0; j < 3; j++) {
            long double gradient = ref_dot(room, column[j], ROWS);

            assert_true(z[j] >= 0.0L && (z[j] > 0.0L ? fabsl(gradient) : gradient) <= 1e-15L);
        }
        ref_rows_free(&rows);
    }
}

/* E^2 in the reduced basis is E^2 of the rows, whatever the groups of equal c. */
static void test_basis(void **state)
{
    struct brdffit_test_random random = {6};
    int round;

    (void)state;
    for (round = 0; round < 300; round++) {
        enum { ROWS = 24 };
        struct ref_rows rows = ref_rows_new(ROWS, 2);
        struct ref_basis basis;
        long double lobe[2][ROWS + 1], room[256], sigma[2], whole, reduced;
        const long double *columns[3] = {rows.a, lobe[0], lobe[1]};
        size_t i, distinct = 1 + brdffit_test_below(&random, ROWS);

        for (i = 0; i < ROWS; i++) {
            rows.a[i] = round % 5 ? brdffit_test_uniform(&random, 0.0, 1.0) : 0.0;
            rows.b[i] = brdffit_test_below(&random, 6) ? brdffit_test_uniform(&random, 0.0, 1.0) : 0.0;
            rows.c[i] = 0.05L * (long double)brdffit_test_below(&random, distinct);
            rows.data[i] = brdffit_test_uniform(&random, -0.2, 1.0);
            rows.data[ROWS + i] = brdffit_test_uniform(&random, -0.2, 1.0);
        }
        sigma[0] = brdffit_test_log_uniform(&random, 1e-3, 6.0);
        sigma[1] = brdffit_test_log_uniform(&random, 1e-3, 6.0);
        for (i = 0; i < 2; i++) {
            ref_lobe(&rows, round & 1, sigma[i], lobe[i]);
        }
        whole = ref_exact(&rows, columns, 3, room, NULL);
        basis = ref_basis_new(&rows);
        columns[0] = basis.rows.a;
        for (i = 0; i < 2; i++) {
            ref_lobe(&basis.rows, round & 1, sigma[i], lobe[i]);
        }
        reduced = basis.unreachable + ref_exact(&basis.rows, columns, 3, room, NULL);
        assert_true(fabsl(reduced - whole) <= 1e-15L * (1.0L + whole));
        ref_rows_free(&basis.rows);
        ref_rows_free(&rows);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact_reference),   cmocka_unit_test(test_basis),
        cmocka_unit_test(test_wrong_numbers),     cmocka_unit_test(test_wrong_words),
        cmocka_unit_test(test_wrong_certificate), cmocka_unit_test(test_bound_is_attacked),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
