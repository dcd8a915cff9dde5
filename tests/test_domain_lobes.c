/*
 * Domain and ranges of lists of lobes: beyond the end of a kind's domain its lobe is the same to rounding, whatever
 * geometry comes first; a kind without a finite coefficient takes no other with it; cosines of unlike lobes stay above
 * what bounds say. SPDX-License-Identifier: MIT
 */
#include "lobes_case.h"

/* |g^(theta) - g^(other)| of lobe p. */
static long double distance(const struct lobes_case *m, int p, double theta, double other)
{
    long double one[LC_SAMPLES], two[LC_SAMPLES], norm[2], sum = 0.0L;
    size_t i;

    lc_column(m, p, theta, one);
    lc_column(m, p, other, two);
    norm[0] = sqrtl(lc_dot(one, one, m->count));
    norm[1] = sqrtl(lc_dot(two, two, m->count));
    for (i = 0; i < m->count && norm[0] + norm[1] > 0.0L; i++) { /* no sample may have this lobe */
        long double d = one[i] / norm[0] - two[i] / norm[1];

        sum += d * d;
    }
    return sqrtl(sum);
}

/* Both are within exp(-40) = 4.2e-18 of the limit; columns in long double are good to 1e-18 or so. */
#define TAIL_DISTANCE 1.2e-17L

static void test_tail(void **state)
{
    static struct lobes_case m;
    long cut = 0, cut_mixed = 0;
    uint64_t seed;
    int p, i;

    (void)state;
    for (seed = 1; seed <= 6000; seed++) {
        uint64_t s = seed;

        if (lc_open(&m, seed, BRDFFIT_NORM_L2, BRDFFIT_ENGINE_MOMENT)) {
            for (p = 0; p < m.lobes; p++) {
                const struct domain *d = fit_domain(&m.fit, p);

                for (i = 0; i < 6 && d->high < d->flat && !m.vanished[p]; i++) {
                    double r = case_uniform(&s), theta = i ? d->high + r * r * r * (d->flat - d->high) : d->flat;
                    long double off = distance(&m, p, theta, d->high);

                    if (!(off <= TAIL_DISTANCE)) {
                        brdffit_test_print(&m.samples, &m.options);
                        fail_msg("seed %u, lobe %d (%s): theta %g differs from the end %g of the domain by %Lg",
                                 (unsigned)seed, p, brdffit_distribution_string(m.fit.model.distribution[p]), theta,
                                 d->high, off);
                    }
                    cut++;
                    cut_mixed += m.fit.model.geometry[m.fit.model.lobe[p].kind] > 0;
                }
            }
        }
        lc_close(&m);
    }
    assert_true(cut > 3000 && cut_mixed > 300);
}

/*
 * c_min so large that no exponential lobe of the range has a finite coefficient, while GGX has: Beckmann and GGX share
 * their sums, but not that fate. A list is never worse than one of its lobes alone.
 */
static void test_vanished_kind(void **state)
{
    static const brdffit_distribution list[2][2] = {{BRDFFIT_BECKMANN, BRDFFIT_GGX}, {BRDFFIT_GGX, BRDFFIT_BECKMANN}};
    static double a[12], b[12], c[12], values[12];
    brdffit_samples samples = brdffit_test_coefficients(12, 1, a, b, c, values);
    const brdffit_result *alone, *both;
    brdffit_options options;
    size_t i;
    int order;

    (void)state;
    for (i = 0; i < 12; i++) {
        a[i] = 0.1 + 0.01 * (double)i;
        b[i] = 1.0 + 0.3 * (double)(i % 5);
        c[i] = 1e6 * (1.0 + (double)i);
        values[i] = 0.2 * a[i] + b[i] * pow(1.0 + 0.1 * c[i], -2.0) * 1e11;
    }
    brdffit_options_init(&options);
    options.distribution = BRDFFIT_GGX;
    assert_int_equal(brdffit_fit_new(&samples, &options, &alone, NULL), BRDFFIT_OK);
    options.lobes = 2;
    for (order = 0; order < 2; order++) {
        options.distributions = list[order];
        assert_int_equal(brdffit_fit_new(&samples, &options, &both, NULL), BRDFFIT_OK);
        if (!(both->lower_bound <= alone->e2 * (1.0 + 1e-9) + 1e-20 * alone->sum_of_squares)) {
            fail_msg("lower bound %g, but GGX alone has %g (sum of squares %g)", both->lower_bound, alone->e2,
                     alone->sum_of_squares);
        }
        brdffit_result_free(both);
    }
    brdffit_result_free(alone);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tail),
        cmocka_unit_test(test_vanished_kind),
    };

    return cmocka_run_group_tests_name("domain_lobes", tests, NULL, NULL);
}
