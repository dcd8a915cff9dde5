/*
 * Sums of samples against the samples: the reduction in long double, the rows of Cholesky within their claim, chunks in
 * any order, fits judged by verify.c, limits and misuse. Tables: test_sums_table.c. SPDX-License-Identifier: MIT
 */
#include "reduce_case.h"

#include "data/sums.h"
#include "verify.h"

/* The problem's samples as sums, given in `chunks` parts. */
static brdffit_sums *sums_of(const struct problem *p, size_t groups, size_t chunks, void **memory)
{
    size_t size = brdffit_sums_size(p->channels, groups), i;
    brdffit_sums *sums = NULL;
    brdffit_error error;

    *memory = malloc(size);
    assert_non_null(*memory);
    assert_int_equal(brdffit_sums_init(*memory, size, p->channels, groups, NULL, &sums, &error), BRDFFIT_OK);
    for (i = 0; i < chunks; i++) {
        size_t begin = p->count * i / chunks, end = p->count * (i + 1) / chunks;
        brdffit_samples part = p->samples;

        part.count = end - begin;
        part.a += begin;
        part.b += begin;
        part.c += begin;
        part.values += begin * p->channels;
        part.weights = part.weights ? part.weights + begin : NULL;
        assert_int_equal(brdffit_sums_add(sums, &part, &error), BRDFFIT_OK);
    }
    return sums;
}

static void reduce_sums(struct outcome *o, const brdffit_sums *sums)
{
    struct arena arena;
    brdffit_options options;
    struct model model;

    brdffit_options_init(&options);
    brdffit_model_make(&model, &options);
    brdffit_arena_init(&arena, NULL, 0);
    brdffit_reduce_layout(&o->r, &arena, brdffit_sums_rows(sums), sums->channels, &model);
    o->block = malloc(arena.used);
    assert_non_null(o->block);
    brdffit_arena_init(&arena, o->block, arena.used);
    brdffit_reduce_layout(&o->r, &arena, brdffit_sums_rows(sums), sums->channels, &model);
    assert_false(arena.failed);
    assert_int_equal(brdffit_sums_reduce(sums, &options, &o->r, NULL), BRDFFIT_OK);
}

/* |a x + b Y_c - I|^2 over rows is that over samples within TOL_GRAM u (|a x| + |b Y| + |I|)^2, for random x and Y. */
static void check_gram(const struct problem *p, const struct reduced *r, uint64_t seed)
{
    struct brdffit_test_random random = {seed};
    double *y = calloc(r->distinct, sizeof *y);
    size_t i, j, k;

    assert_non_null(y);
    for (k = 0; k < p->channels; k++) {
        double x = brdffit_test_uniform(&random, 0.0, 2.0);
        long double exact = 0.0L, got = 0.0L, ax = 0.0L, by = 0.0L, ii = 0.0L, scale;

        for (j = 0; j < r->distinct; j++) {
            y[j] = brdffit_test_uniform(&random, -2.0, 2.0);
        }
        for (i = 0; i < p->count; i++) {
            long double a = p->a[i] / r->scale_a[0], b = p->b[i] / r->table[0].scale_b, v = value(p, r, i, k),
                        along = 0.0L;

            for (j = 0; j < r->distinct; j++) {
                along = p->c[i] - r->table[0].c_min == r->table[0].c[j] ? y[j] : along;
            }
            exact += weight(p, r, i) * powl(a * x + b * along - v, 2.0L);
            ax += weight(p, r, i) * powl(a * x, 2.0L);
            by += weight(p, r, i) * powl(b * along, 2.0L);
            ii += weight(p, r, i) * v * v;
        }
        for (i = 0; i < r->rows; i++) {
            assert_true(r->row_c[i] < r->distinct);
            got += powl((long double)r->row_a[i] * x + (long double)r->table[0].row_b[i] * y[r->row_c[i]] -
                            r->row_value[k * r->used + i],
                        2.0L);
        }
        scale = sqrtl(ax) + sqrtl(by) + sqrtl(ii);
        within("residual of rows", (double)got, exact, TOL_GRAM * TOL_UNIT * scale * scale + 1e-15L * exact);
    }
    free(y);
}

static void test_reduction(void **state)
{
    static const size_t count[] = {1, 2, 5, 63, 130, 700}, channels[] = {1, 3, 31}, groups[] = {1, 2, 9, 200};
    size_t i, j, k;
    uint64_t v;

    (void)state;
    for (i = 0; i < sizeof count / sizeof count[0]; i++) {
        for (j = 0; j < 3; j++) {
            for (k = 0; k < 4; k++) {
                struct problem p;
                struct outcome o;

                problem_new(&p, count[i], channels[j]);
                for (v = 0; v < 8; v += count[i] > 200 ? 7 : 1) {
                    void *memory;
                    brdffit_sums *sums;

                    problem_fill(&p, groups[k], v & 1, (v >> 1) & 1, (v >> 2) & 1, v + 10 * i + 100 * k);
                    sums = sums_of(&p, 201, 1 + v, &memory);
                    reduce_sums(&o, sums);
                    check_sums(&p, &o.r);
                    check_gram(&p, &o.r, v);
                    free(o.block);
                    free(memory);
                }
                free(p.a);
            }
        }
    }
}

/* a and b parallel, data in their span but for a little: the Gram matrix is singular to rounding. */
static void test_parallel(void **state)
{
    static const double off[] = {0.0, 1e-17, 1e-16, 1e-12, 1e-9, 1e-8, 1e-7, 1e-4};
    struct brdffit_test_random random = {77};
    size_t i, j, k, seed;

    (void)state;
    for (j = 0; j < sizeof off / sizeof *off; j++) {
        for (k = 0; k < sizeof off / sizeof *off; k++) {
            for (seed = 0; seed < 6; seed++) {
                struct problem p;
                struct outcome o;
                void *memory;

                problem_new(&p, 40, 2);
                problem_fill(&p, 1 + seed % 3, 0, 0, 0, seed);
                for (i = 0; i < p.count; i++) {
                    p.b[i] = p.a[i] * (3.0 + off[j] * brdffit_test_normal(&random)) + 1e-9;
                    p.values[2 * i] = fmax(0.0, p.b[i] * (2.0 + off[k] * brdffit_test_normal(&random)));
                    p.values[2 * i + 1] = fmax(0.0, p.a[i] + off[k] * brdffit_test_normal(&random));
                }
                reduce_sums(&o, sums_of(&p, 3, 1, &memory));
                check_gram(&p, &o.r, seed);
                free(o.block);
                free(memory);
                free(p.a);
            }
        }
    }
}

/* A fit of sums makes claims about the samples that hold for them. */
static void test_fits(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    size_t form, i;

    (void)state;
    for (i = 0; i < 24; i++) {
        struct brdffit_test_data data;
        brdffit_options options;
        struct brdffit_test_result result;
        brdffit_error error;
        brdffit_sums *sums = NULL;
        size_t size, room;
        void *memory, *workspace;
        char why[512];

        form = i % 3;
        spec.form = (brdffit_form)form;
        spec.seed = i;
        spec.noise = 0.02;
        spec.weighted = (i / 3) & 1;
        spec.layout = i % 4 == 3 ? BRDFFIT_TEST_RANDOM : BRDFFIT_TEST_GRID;
        spec.count = i % 4 == 3 ? 150 : 84;
        brdffit_options_init(&options);
        options.lobes = 1 + (int)(i & 1);
        options.distribution = i >= 12 ? BRDFFIT_GGX : BRDFFIT_BECKMANN;
        options.normalise = i & 4 ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
        brdffit_test_data_new(&spec, &data);
        size = brdffit_sums_size(data.samples.channels, data.samples.count);
        memory = malloc(size);
        assert_int_equal(
            brdffit_sums_init(memory, size, data.samples.channels, data.samples.count, &options, &sums, &error),
            BRDFFIT_OK);
        assert_int_equal(brdffit_sums_add(sums, &data.samples, &error), BRDFFIT_OK);
        room = brdffit_sums_workspace_size(sums, &options);
        workspace = malloc(room);
        assert_int_equal(brdffit_test_run_sums(sums, &options, workspace, room, &result, &error), BRDFFIT_OK);
        assert_true(result.e2_error > 0.0 && result.e2_error <= 1e-12 * result.sum_of_squares);
        if (brdffit_test_verify(&data.samples, &options, &result, why, sizeof why)) {
            brdffit_test_print(&data.samples, &options);
            fail_msg("fit %zu: %s", i, why);
        }
        free(workspace);
        free(memory);
        brdffit_test_data_free(&data);
    }
}

static void expect(const brdffit_sums *sums, struct problem *p, double *what, double bad, brdffit_status status,
                   const char *message)
{
    double kept = *what;
    brdffit_error error;

    *what = bad;
    error.message = "";
    assert_int_equal(brdffit_sums_add((brdffit_sums *)(uintptr_t)sums, &p->samples, &error), status);
    if (!strstr(error.message, message) || error.sample != 3) {
        fail_msg("'%s' at %zu", error.message, error.sample);
    }
    *what = kept;
}

static void test_refusals(void **state)
{
    struct problem p;
    void *memory;
    brdffit_sums *sums, *other = NULL;
    brdffit_options options;
    struct brdffit_test_result result;
    brdffit_error error;
    size_t used, skipped[BRDFFIT_SKIP_COUNT], size = brdffit_sums_size(2, 4);
    char workspace[64];

    (void)state;
    problem_new(&p, 9, 2);
    problem_fill(&p, 2, 0, 0, 0, 5);
    p.samples.weights = p.weights;
    p.weights[3] = 2.0;
    sums = sums_of(&p, 4, 3, &memory);
    brdffit_sums_count(sums, &used, skipped, BRDFFIT_SKIP_COUNT);
    assert_int_equal(used + skipped[BRDFFIT_SKIP_ZERO_WEIGHT], 9);
    expect(sums, &p, &p.values[7], (double)NAN, BRDFFIT_ERR_VALUE, "not finite");
    expect(sums, &p, &p.values[7], -1e101, BRDFFIT_ERR_VALUE, "1e100");
    expect(sums, &p, &p.b[3], 1e51, BRDFFIT_ERR_VALUE, "1e50");
    expect(sums, &p, &p.b[3], 1e-51, BRDFFIT_ERR_VALUE, "1e50");
    expect(sums, &p, &p.a[3], 1e101, BRDFFIT_ERR_VALUE, "1e100");
    expect(sums, &p, &p.weights[3], 1e51, BRDFFIT_ERR_VALUE, "1e50");
    expect(sums, &p, &p.weights[3], -1.0, BRDFFIT_ERR_VALUE, "weight");
    p.c[1] = 7.0;
    p.c[2] = 8.0;
    expect(sums, &p, &p.c[3], 9.0, BRDFFIT_ERR_WORKSPACE, "distinct c");
    brdffit_options_init(&options);
    assert_int_equal(brdffit_test_run_sums(sums, &options, workspace, sizeof workspace, &result, &error),
                     BRDFFIT_ERR_WORKSPACE);
    options.engine = BRDFFIT_ENGINE_SOCP;
    assert_int_equal(brdffit_test_run_sums(sums, &options, workspace, sizeof workspace, &result, &error),
                     BRDFFIT_ERR_UNSUPPORTED);
    brdffit_options_init(&options);
    options.max_incidence = 50.0;
    assert_int_equal(brdffit_test_run_sums(sums, &options, workspace, sizeof workspace, &result, &error),
                     BRDFFIT_ERR_OPTION);
    assert_int_equal(brdffit_test_run_sums(NULL, NULL, workspace, sizeof workspace, &result, &error),
                     BRDFFIT_ERR_ARGUMENT);
    assert_int_equal(brdffit_sums_init(memory, size - 1, 2, 4, NULL, &other, &error), BRDFFIT_ERR_WORKSPACE);
    assert_int_equal(brdffit_sums_init(NULL, size, 2, 4, NULL, &other, &error), BRDFFIT_ERR_ARGUMENT);
    options.norm = BRDFFIT_NORM_L1;
    assert_int_equal(brdffit_sums_init(memory, size, 2, 4, &options, &other, &error), BRDFFIT_ERR_UNSUPPORTED);
    assert_int_equal(brdffit_sums_size(0, 4), 0);
    assert_int_equal(brdffit_sums_size(3, 0), 0);
    assert_int_equal(brdffit_sums_size((size_t)-1, (size_t)-1), 0);
    free(memory);
    free(p.a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reduction),
        cmocka_unit_test(test_parallel),
        cmocka_unit_test(test_fits),
        cmocka_unit_test(test_refusals),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
