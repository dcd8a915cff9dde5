/*
 * Fits of models with Fresnel, diffuse terms and masking as a caller sees them: truths found again, engines that agree, bounds
 * below a grid, edges, the same bits for every instruction set, and plain models as they were. The objective is that of
 * columns_case.h, which shares no code with the library. SPDX-License-Identifier: MIT
 */
#include "columns_case.h"
#include "columns_golden.h"

static struct columns_case m;

/* ---- The judge ------------------------------------------------------------------------------------------------ */

/* Units of a result, for cc_objective(). */
static void take_units(const brdffit_result *r)
{
    const brdffit_samples *s = &m.samples;
    size_t i, k, used = 0;

    for (i = 0; i < s->count; i++) {
        struct columns_angles at;
        double w = s->weights ? s->weights[i] : 1.0;

        cc_sample(s, i, &at);
        if (!(w > 0.0) || !(at.angles.nl > 0.0L) || !(at.angles.nv > 0.0L)) {
            continue;
        }
        m.at[used] = at;
        m.root[used] = sqrtl((long double)w);
        for (k = 0; k < m.channels; k++) {
            m.value[k][used] = m.root[used] * s->values[i * m.channels + k] / r->channel_scale[k];
        }
        used++;
    }
    assert_int_equal(r->samples_used, used);
    m.count = used;
    memset(m.last, 0, sizeof m.last);
}

/* No point of a grid over the domain, its ends and the result's own sigma is below the bound. */
static void judge(const brdffit_result *r)
{
    const brdffit_options *o = &m.options;
    int lobes = o->lobes, points = lobes == 1 ? 60 : lobes == 2 ? 12 : 6, all = 1, n, p;
    long double own = 0.0L, total = r->sum_of_squares;

    assert_true(r->stop != BRDFFIT_STOP_CONTRADICTION);
    assert_true(r->lower_bound >= 0.0 && r->lower_bound <= r->e2 && r->e2 < INFINITY);
    take_units(r);
    for (p = 0; p < lobes; p++) {
        m.fit.model.distribution[p] = r->model->distributions[p];
        all *= points;
    }
    for (n = -1; n < all; n++) {
        double theta[CC_LOBES] = {0.0};
        long double value;
        int rest = n;

        for (p = 0; p < lobes; p++, rest /= points) {
            int exponent = verify_by_exponent(r->model->distributions[p]);
            double low = exponent ? log(o->exponent_min) : -2.0 * log(o->sigma_max), floor = -2.0 * log(r->sigma_floor);
            double high = fmin(exponent ? log(o->exponent_max) : -2.0 * log(o->sigma_min), floor);

            if (!(low <= high)) {
                return; /* no lobe has a finite coefficient */
            }
            theta[p] = n < 0 ? -2.0 * log(r->model->sigma[p]) : low + (high - low) * (rest % points) / (points - 1);
        }
        value = cc_objective(&m, theta);
        own = n < 0 ? value : own;
        if (!((long double)r->lower_bound <= value * (1.0L + 1e-12L) + 1e-16L * total)) {
            brdffit_test_print(&m.samples, o);
            fail_msg("lower bound %.17g above %.17Lg at theta %g %g %g", r->lower_bound, value, theta[0], theta[1],
                     theta[2]);
        }
    }
    /* x, y and F0 are the best of their sigma; e2 says what they reach. */
    if (!(r->e2 <= own * (1.0L + 1e-9L) + r->e2_error + 1e-13L * total)) {
        brdffit_test_print(&m.samples, o);
        fail_msg("e2 %.17g, the least of its sigma is %.17Lg (total %Lg)", r->e2, own, total);
    }
    for (n = 0; r->model->f0 && n < (int)m.channels * lobes; n++) {
        assert_true(r->model->f0[n] >= 0.0 && r->model->f0[n] <= 1.0);
    }
}

/* ---- Truths ----------------------------------------------------------------------------------------------------- */

#define SCENE 60
static double scene_light[3 * SCENE], scene_view[3 * SCENE], scene_values[SCENE];

static brdffit_samples scene(void)
{
    brdffit_samples s;
    int i;

    for (i = 0; i < SCENE; i++) {
        double theta = 0.1 + 1.25 * (i % 10) / 9.0, off = 0.15 * (i / 10),
               turn = i % 3 ? 3.14159265358979 : 3.0 - 0.3 * (i % 7);

        cc_direction(theta, 0.3 * i, scene_light + 3 * i);
        cc_direction(fabs(theta - off) + 0.01 * (i % 4), 0.3 * i + turn, scene_view + 3 * i);
    }
    brdffit_samples_init(&s);
    s.count = SCENE;
    s.channels = 1;
    s.quantity = BRDFFIT_QUANTITY_RADIANCE;
    s.light = scene_light;
    s.view = scene_view;
    s.values = scene_values;
    return s;
}

static void expect_near(double got, double wanted, double tolerance, const char *what, const brdffit_options *o)
{
    if (!(fabs(got - wanted) <= tolerance * fabs(wanted))) {
        fail_msg("%s is %.17g, was %.17g (lobe %s, fresnel %s, diffuse %s, masking %s)", what, got, wanted,
                 brdffit_distribution_string(o->distribution), brdffit_fresnel_string(o->fresnel),
                 brdffit_diffuse_string(o->diffuse), brdffit_masking_string(o->masking));
    }
}

/* One lobe, F0 = 0.04 with Fresnel, every diffuse column there. */
static void find_again(const brdffit_options *o)
{
    static const double x[COLUMNS_FIXED] = {0.5, 0.3, 0.2};
    int fixed = cc_fixed(o->diffuse), f, i;
    const double sigma = 0.21, y = 0.35, f0 = 0.04;
    brdffit_samples s = scene();
    const brdffit_result *r;

    for (i = 0; i < SCENE; i++) {
        long double sum, column[COLUMNS_FIXED];
        struct columns_angles at;

        cc_directions(scene_light + 3 * i, scene_view + 3 * i, &at);
        columns_diffuse(o->diffuse, &at, column);
        sum = y * expl(columns_log_lobe(o->distribution, o->masking, 1.0L / ((long double)sigma * sigma), &at));
        sum *= o->fresnel ? f0 + (1.0L - f0) * columns_fifth(at.versine) : 1.0L;
        for (f = 0; f < fixed; f++) {
            sum += x[f] * column[f];
        }
        scene_values[i] = (double)sum;
    }
    assert_int_equal(brdffit_fit_new(&s, o, &r, NULL), BRDFFIT_OK);
    assert_int_equal(r->samples_used, SCENE);
    expect_near(r->model->sigma[0], sigma, 1e-9, "sigma", o);
    expect_near(r->model->y[0], y, 1e-9, "y", o);
    if (o->fresnel) {
        expect_near(r->model->f0[0], f0, 1e-9, "F0", o);
    }
    if (o->diffuse != BRDFFIT_DIFFUSE_NONE) {
        expect_near(r->model->x[0], x[0], 1e-9, "x", o);
    }
    for (f = 1; f < fixed; f++) {
        expect_near(r->model->x_more[f - 1], x[f], 1e-8, "a further x", o);
    }
    brdffit_result_free(r);
}

static void test_truths_are_found(void **state)
{
    int model;

    (void)state;
    for (model = 0; model < 64; model++) {
        brdffit_options o;

        brdffit_options_init(&o);
        o.distribution = (brdffit_distribution)(model % 2);
        o.fresnel = (brdffit_fresnel)(model / 2 % 2);
        o.diffuse = (brdffit_diffuse)(model / 4 % 4);
        o.masking = (brdffit_masking)(model / 16);
        o.max_incidence = 90.0;
        o.absolute_gap = 1e-10;
        find_again(&o);
    }
}

/* ---- Engines ------------------------------------------------------------------------------------------------------ */

static void check_proof(const brdffit_options *o, const brdffit_result *r)
{
    const brdffit_verification *proof;
    size_t size;
    brdffit_options socp = *o;
    void *workspace;

    socp.engine = BRDFFIT_ENGINE_SOCP;
    socp.box_budget = 20000;
    size = brdffit_workspace_size(m.samples.count, m.samples.channels, &socp);
    workspace = malloc(size);
    assert_non_null(workspace);
    assert_int_equal(brdffit_verify(&m.samples, &socp, 0.7 * r->lower_bound, workspace, size, &proof, NULL),
                     BRDFFIT_OK);
    assert_true(proof->proven || proof->stop == BRDFFIT_STOP_BUDGET);
    assert_int_equal(brdffit_verify(&m.samples, &socp, 1.05 * r->e2, workspace, size, &proof, NULL), BRDFFIT_OK);
    assert_int_equal(proof->proven, 0);
    free(workspace);
}

static void test_engines_agree(void **state)
{
    static const brdffit_norm norms[] = {BRDFFIT_NORM_L2, BRDFFIT_NORM_L1, BRDFFIT_NORM_LINF};
    long agreed = 0, seen = 0;
    uint64_t seed;

    (void)state;
    for (seed = 0; seed < 96; seed++) {
        const brdffit_result *a = NULL, *b = NULL;
        brdffit_options o;

        if (cc_open(&m, seed) && m.options.lobes == 1) {
            m.options.relative_gap = 0.02;
            m.options.box_budget = 3000;
            o = m.options;
            assert_int_equal(brdffit_fit_new(&m.samples, &o, &a, NULL), BRDFFIT_OK);
            judge(a);
            o.engine = BRDFFIT_ENGINE_SOCP;
            if (brdffit_fit_new(&m.samples, &o, &b, NULL) == BRDFFIT_OK) { /* there is an ECOS */
                judge(b);
                assert_true(a->lower_bound <= b->e2 + b->e2_error && b->lower_bound <= a->e2 + a->e2_error);
                agreed += a->certified && b->certified;
                if (a->lower_bound > 1e-6 * a->sum_of_squares && a->e2 > 0.0) {
                    check_proof(&m.options, a);
                }
                brdffit_result_free(b);
                o.norm = norms[1 + seed % 2]; /* bounded by e2 of l2's model: only what any norm says of itself */
                o.box_budget = 40;
                assert_int_equal(brdffit_fit_new(&m.samples, &o, &b, NULL), BRDFFIT_OK);
                assert_true(b->lower_bound >= 0.0 && b->lower_bound <= b->e2 && b->stop != BRDFFIT_STOP_CONTRADICTION);
                brdffit_result_free(b);
            }
            brdffit_result_free(a);
            seen++;
        }
        cc_close(&m);
    }
    print_message("%ld problems, %ld certified by both engines\n", seen, agreed);
    assert_true(seen > 15);
}

/* ---- Edges -------------------------------------------------------------------------------------------------------- */

/* Changes a problem of cc_open(); the fit has to be sound, whatever it can say. */
static void edge(int kind)
{
    size_t i, n = m.samples.count * m.samples.channels;

    for (i = 0; i < m.samples.count; i++) {
        double *l = m.light + 3 * i, *v = m.view + 3 * i;

        switch (kind) {
        case 0: memcpy(v, l, 3 * sizeof *l), m.cosine[3][i] = 1.0; break;      /* no second column at all */
        case 1: m.cosine[3][i] = 0.75; break;                                   /* parallel columns */
        case 2:
            cc_direction(89.9999 / 57.29577951308232, 0.4 * (double)i, l); /* tan^2 3e11 */
            m.cosine[0][i] = 1.745e-6;
            break;
        case 3: cc_direction(0.0, 0.0, l), m.cosine[0][i] = 1.0; break;
        case 4: cc_direction(0.0, 0.0, l), cc_direction(0.0, 0.0, v), m.cosine[0][i] = m.cosine[1][i] = 1.0; break;
        case 5:
            memcpy(l, m.light, 3 * sizeof *l), memcpy(v, m.view, 3 * sizeof *v);
            m.cosine[0][i] = m.cosine[0][0], m.cosine[1][i] = m.cosine[1][0];
            m.cosine[2][i] = m.cosine[2][0], m.cosine[3][i] = m.cosine[3][0];
            break;
        case 6: v[0] = -l[0], v[1] = -l[1], v[2] = l[2], m.cosine[2][i] = 0.0, m.cosine[1][i] = m.cosine[0][i]; break;
        case 7: m.weights[i] = pow(10.0, i % 2 ? 300.0 : -300.0), m.samples.weights = m.weights; break;
        default: break;
        }
    }
    for (i = 0; i < n; i++) {
        m.values[i] = kind == 8 ? 0.0 : kind == 9 ? -fabs(m.values[i]) : m.values[i];
        m.values[i] *= kind == 10 ? 1e-290 : kind == 11 ? 1e290 : 1.0;
    }
    m.samples.count = kind == 12 ? 1 : m.samples.count;
    if (kind == 13) {
        m.options.sigma_min = m.options.sigma_max = 0.3;
        m.options.exponent_min = m.options.exponent_max = 20.0;
    } else if (kind == 14) {
        m.options.sigma_min = 1e-12;
        m.options.sigma_max = 1e-3;
    }
}

#define EDGES 15

static void test_edges(void **state)
{
    long fits[EDGES] = {0}, refused[EDGES] = {0}, certified[EDGES] = {0};
    uint64_t seed;
    int kind;

    (void)state;
    for (seed = 0; seed < 96; seed++) {
        for (kind = (int)((seed + seed / 4 + seed / 16) % 4); kind < EDGES;
             kind += 4) { /* each model meets a quarter of them */
            const brdffit_result *r = NULL;
            brdffit_error error;
            brdffit_status status;

            (void)cc_open(&m, seed);
            m.options.relative_gap = 1e-2;
            m.options.box_budget = 300;
            edge(kind);
            status = brdffit_fit_new(&m.samples, &m.options, &r, &error);
            if (status == BRDFFIT_OK) {
                judge(r);
                fits[kind]++;
                certified[kind] += r->certified;
                brdffit_result_free(r);
            } else { /* b that spans too much, values out of range */
                assert_true(status == BRDFFIT_ERR_VALUE || status == BRDFFIT_ERR_NO_SAMPLES);
                refused[kind]++;
            }
            cc_close(&m);
        }
    }
    for (kind = 0; kind < EDGES; kind++) {
        print_message("edge %d: %ld fits, %ld certified, %ld refused\n", kind, fits[kind], certified[kind],
                      refused[kind]);
        assert_true(fits[kind] > 0);
    }
}

/* The vanished second column is no help: the plain model's E^2, whatever the diffuse term. */
static void test_a_second_column_that_vanishes(void **state)
{
    const brdffit_result *plain, *schlick;
    brdffit_samples s = scene();
    brdffit_options o;
    int i;

    (void)state;
    memcpy(scene_view, scene_light, sizeof scene_view);
    for (i = 0; i < SCENE; i++) {
        scene_values[i] = 0.3 + 0.01 * (i % 7) + 1.0 / (1 + i % 10);
    }
    brdffit_options_init(&o);
    o.max_incidence = 90.0;
    o.relative_gap = 1e-6;
    assert_int_equal(brdffit_fit_new(&s, &o, &plain, NULL), BRDFFIT_OK);
    o.fresnel = BRDFFIT_FRESNEL_SCHLICK;
    assert_int_equal(brdffit_fit_new(&s, &o, &schlick, NULL), BRDFFIT_OK);
    assert_true(plain->certified && schlick->certified);
    assert_true(fabs(plain->e2 - schlick->e2) <= 2e-6 * plain->e2);
    brdffit_result_free(plain);
    brdffit_result_free(schlick);
}

/* Burley's columns at small angles are tiny, but as well known as others: the gap closes. */
static void test_burley_near_the_normal(void **state)
{
    const brdffit_result *r;
    brdffit_samples s = scene();
    brdffit_options o;
    int i;

    (void)state;
    for (i = 0; i < SCENE; i++) {
        cc_direction(0.02 + 0.2 * (i % 10) / 9.0, 0.3 * i, scene_light + 3 * i);
        cc_direction(0.03 + 0.15 * (i / 10) / 5.0, 0.3 * i + 3.0, scene_view + 3 * i);
        scene_values[i] = 0.3 + 0.01 * (i % 7) + 1.0 / (1 + i % 10);
    }
    brdffit_options_init(&o);
    o.diffuse = BRDFFIT_DIFFUSE_BURLEY;
    o.relative_gap = 1e-4;
    assert_int_equal(brdffit_fit_new(&s, &o, &r, NULL), BRDFFIT_OK);
    if (!r->certified) {
        fail_msg("open: e2 %g, bound %g, %s", r->e2, r->lower_bound, brdffit_stop_string(r->stop));
    }
    brdffit_result_free(r);
}

static void test_ten_thousand_channels(void **state)
{
    enum { CHANNELS = 10000, SAMPLES = 8 };
    double *values = malloc(SAMPLES * CHANNELS * sizeof *values);
    brdffit_samples s = scene();
    const brdffit_result *r;
    brdffit_options o;
    size_t i;

    (void)state;
    assert_non_null(values);
    for (i = 0; i < SAMPLES * CHANNELS; i++) {
        values[i] = 0.1 + (double)(i * 7919 % 101) / 101.0;
    }
    s.count = SAMPLES;
    s.channels = CHANNELS;
    s.values = values;
    brdffit_options_init(&o);
    o.max_incidence = 90.0;
    o.fresnel = BRDFFIT_FRESNEL_SCHLICK;
    o.diffuse = BRDFFIT_DIFFUSE_BURLEY;
    o.masking = BRDFFIT_MASKING_SMITH;
    o.relative_gap = 0.05;
    o.box_budget = 60;
    assert_int_equal(brdffit_fit_new(&s, &o, &r, NULL), BRDFFIT_OK);
    assert_true(r->lower_bound >= 0.0 && r->lower_bound <= r->e2 && r->stop != BRDFFIT_STOP_CONTRADICTION);
    for (i = 0; i < CHANNELS; i++) {
        assert_true(r->model->f0[i] >= 0.0 && r->model->f0[i] <= 1.0 && r->model->x[i] >= 0.0);
    }
    brdffit_result_free(r);
    free(values);
}

/* ---- Bits --------------------------------------------------------------------------------------------------------- */

static void expect_same(const double *a, const double *b, size_t n)
{
    assert_true(!a == !b);
    if (a) {
        assert_memory_equal(a, b, n * sizeof *a);
    }
}

static void test_same_bits(void **state)
{
    uint64_t seed;
    int isa;

    (void)state;
    for (seed = 0; seed < 96; seed++) {
        const brdffit_result *base, *other;
        brdffit_options o;

        if (cc_open(&m, seed)) {
            o = m.options;
            o.isa = BRDFFIT_ISA_BASE;
            assert_int_equal(brdffit_fit_new(&m.samples, &o, &base, NULL), BRDFFIT_OK);
            for (isa = BRDFFIT_ISA_AVX2; isa < BRDFFIT_ISA_COUNT; isa++) {
                size_t K = m.channels, lobes = (size_t)o.lobes;

                o.isa = (brdffit_isa)isa;
                if (!brdffit_isa_supported(o.isa)) {
                    continue;
                }
                assert_int_equal(brdffit_fit_new(&m.samples, &o, &other, NULL), BRDFFIT_OK);
                expect_same(base->model->sigma, other->model->sigma, lobes);
                expect_same(base->model->x, other->model->x, K);
                expect_same(base->model->y, other->model->y, K * lobes);
                expect_same(base->model->f0, other->model->f0, K * lobes);
                expect_same(base->model->x_more, other->model->x_more, K * (size_t)(cc_fixed(o.diffuse) - 1));
                expect_same(&base->e2, &other->e2, 1);
                expect_same(&base->lower_bound, &other->lower_bound, 1);
                assert_int_equal(base->boxes, other->boxes);
                brdffit_result_free(other);
            }
            brdffit_result_free(base);
        }
        cc_close(&m);
    }
}

/* What a workspace holds before a fit is no part of its result. */
static void test_contents_of_the_workspace(void **state)
{
    uint64_t seed;

    (void)state;
    for (seed = 0; seed < 96; seed++) {
        (void)cc_open(&m, seed);
        {
            size_t size = brdffit_workspace_size(m.samples.count, m.channels, &m.options), boxes[2] = {0}, i;
            unsigned char *workspace = malloc(size);
            double said[2][2] = {{0.0}};

            assert_non_null(workspace);
            for (i = 0; i < 2; i++) {
                const brdffit_result *r;

                memset(workspace, i ? 0x7e : 0, size); /* doubles of 1e300 */
                if (brdffit_fit(&m.samples, &m.options, workspace, size, &r, NULL) == BRDFFIT_OK) {
                    said[i][0] = r->e2;
                    said[i][1] = r->lower_bound;
                    boxes[i] = r->boxes;
                }
            }
            expect_same(said[0], said[1], 2);
            assert_int_equal(boxes[0], boxes[1]);
            free(workspace);
        }
        cc_close(&m);
    }
}

/* E^2, bound and boxes to the bit; sigma to a few of the last ones, in which the Newton steps are summed. */
static void test_plain_models_are_what_they_were(void **state)
{
    size_t i;

    (void)state;
    for (i = 0; i < sizeof golden_fits / sizeof golden_fits[0]; i++) {
        const struct golden_fit *g = &golden_fits[i];
        struct golden_data data;
        const brdffit_result *r = golden_result(g, &data);

        assert_non_null(r);
        expect_same(&r->e2, &g->e2, 1);
        expect_same(&r->lower_bound, &g->lower_bound, 1);
        assert_int_equal(r->boxes, g->boxes);
        assert_true(fabs(r->model->sigma[g->lobes - 1] / g->sigma - 1.0) < 1e-13);
        brdffit_result_free(r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_truths_are_found),
        cmocka_unit_test(test_engines_agree),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_a_second_column_that_vanishes),
        cmocka_unit_test(test_burley_near_the_normal),
        cmocka_unit_test(test_ten_thousand_channels),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_contents_of_the_workspace),
        cmocka_unit_test(test_plain_models_are_what_they_were),
    };

    return cmocka_run_group_tests_name("columns_fit", tests, NULL, NULL);
}
