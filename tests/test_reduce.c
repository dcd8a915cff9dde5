/*
 * The reduction against the samples: sums in long double, and rows that give the same residual norm for every
 * model; weights and order. SPDX-License-Identifier: MIT
 */
#include "reduce_case.h"

/* Groups larger and smaller than 2 + K, more and fewer than a block of the reduction; K up to 31. */
static void test_sums_and_rows(void **state)
{
    static const size_t count[] = {1, 2, 5, 63, 64, 65, 130, 700, 2000}, channels[] = {1, 3, 31};
    static const size_t groups[] = {1, 2, 9, 200};
    size_t i, j, k;
    uint64_t variant;

    (void)state;
    for (i = 0; i < sizeof count / sizeof count[0]; i++) {
        for (j = 0; j < 3; j++) {
            for (k = 0; k < 4; k++) {
                struct problem p;
                struct outcome o;

                problem_new(&p, count[i], channels[j]);
                for (variant = 0; variant < (count[i] > 200 ? 2u : 8u); variant++) {
                    uint64_t v = count[i] > 200 ? 7 * variant : variant;

                    problem_fill(&p, groups[k], v & 1, (v >> 1) & 1, (v >> 2) & 1, v + 10 * i + 100 * k);
                    reduce(&o, &p.samples);
                    check_sums(&p, &o.r);
                    check_rows(&p, &o.r, v);
                    free(o.block);
                }
                free(p.a);
            }
        }
    }
}

/* A table of many cells of few c shrinks to 2 + K rows for each. */
static void test_rows_of_large_groups(void **state)
{
    struct problem p;
    struct outcome o;

    (void)state;
    problem_new(&p, 2000, 3);
    problem_fill(&p, 9, 0, 0, 0, 1);
    reduce(&o, &p.samples);
    assert_int_equal(o.r.distinct, 9);
    assert_int_equal(o.r.rows, 9 * 5);
    free(o.block);
    free(p.a);
}

/* Samples of weight 2 beside the same samples twice. */
static void test_weight_is_repetition(void **state)
{
    struct problem once, twice;
    struct outcome one, two;
    double a, b, v, w;
    size_t i, j, k;

    (void)state;
    problem_new(&once, 50, 3);
    problem_new(&twice, 100, 3);
    problem_fill(&once, 12, 1, 1, 1, 3);
    for (i = 0; i < 100; i++) {
        once.weights[i / 2] = 2.0;
        twice.weights[i] = 1.0;
        twice.a[i] = once.a[i / 2];
        twice.b[i] = once.b[i / 2];
        twice.c[i] = once.c[i / 2];
        memcpy(twice.values + 3 * i, once.values + 3 * (i / 2), 3 * sizeof(double));
    }
    reduce(&one, &once.samples);
    reduce(&two, &twice.samples);
    assert_int_equal(one.r.distinct, two.r.distinct);
    /* To the units of the other, by powers of two. */
    w = one.r.scale_w;
    a = one.r.scale_a[0] / two.r.scale_a[0];
    b = one.r.table[0].scale_b / two.r.table[0].scale_b;
    v = one.r.value_scale / two.r.value_scale;
    within("aa", one.r.aa[0][0] * w * a * a, two.r.aa[0][0], SUM_ERROR * two.r.aa[0][0]);
    for (k = 0; k < 3; k++) {
        assert_true(one.r.channel_scale[k] == two.r.channel_scale[k]);
        within("ii", one.r.ii[k] * w * v * v, two.r.ii[k], SUM_ERROR * two.r.ii[k]);
    }
    for (j = 0; j < one.r.distinct; j++) {
        assert_true(one.r.table[0].c[j] == two.r.table[0].c[j]);
        within("bb", one.r.table[0].bb[j] * w * b * b, two.r.table[0].bb[j], SUM_ERROR * two.r.table[0].bb[j]);
        within("concentration", 0.5 * one.r.table[0].concentration[j], two.r.table[0].concentration[j], SUM_ERROR);
    }
    free(one.block);
    free(two.block);
    free(once.a);
    free(twice.a);
}

/* The other way round and shuffled: the same groups, the same sums to rounding. */
static void test_order_of_samples(void **state)
{
    struct brdffit_test_random random = {9};
    struct problem p, q;
    struct outcome first, second;
    size_t i, j, round;

    (void)state;
    problem_new(&p, 333, 3);
    problem_new(&q, 333, 3);
    problem_fill(&p, 20, 1, 1, 0, 4);
    reduce(&first, &p.samples);
    for (round = 0; round < 10; round++) {
        memcpy(q.a, p.a, 7 * 333 * sizeof(double));
        for (i = 332; i > 0; i--) {
            size_t other = round ? brdffit_test_below(&random, i + 1) : (i > 166 ? 332 - i : i);
            double keep[6];

            keep[0] = q.a[i];
            keep[1] = q.b[i];
            keep[2] = q.c[i];
            memcpy(keep + 3, q.values + 3 * i, 3 * sizeof(double));
            q.a[i] = q.a[other];
            q.b[i] = q.b[other];
            q.c[i] = q.c[other];
            memmove(q.values + 3 * i, q.values + 3 * other, 3 * sizeof(double));
            q.a[other] = keep[0];
            q.b[other] = keep[1];
            q.c[other] = keep[2];
            memcpy(q.values + 3 * other, keep + 3, 3 * sizeof(double));
        }
        reduce(&second, &q.samples);
        check_sums(&q, &second.r);
        check_rows(&q, &second.r, round);
        assert_int_equal(second.r.distinct, first.r.distinct);
        assert_int_equal(second.r.rows, first.r.rows);
        assert_int_equal(second.r.functionals, first.r.functionals);
        for (j = 0; j < first.r.distinct; j++) {
            assert_true(second.r.table[0].c[j] == first.r.table[0].c[j]);
        }
        free(second.block);
    }
    free(first.block);
    free(p.a);
    free(q.a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sums_and_rows),
        cmocka_unit_test(test_rows_of_large_groups),
        cmocka_unit_test(test_weight_is_repetition),
        cmocka_unit_test(test_order_of_samples),
    };

    return cmocka_run_group_tests_name("reduce", tests, NULL, NULL);
}
