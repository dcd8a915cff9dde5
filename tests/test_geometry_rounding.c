/*
 * The stated errors of geometry (src/model/rounding.h), judged in 113 bits: random and adversarial directions, taken at their
 * word and moved by what directions are known to. What they cost a proof: test_geometry_charge.c. LDFLAGS: -lquadmath
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/tolerance.h"
#include "fewer.h"
#include "model/geometry.h"
#include "model/rounding.h"
#include "rounding_scene.h"

#define DIRECTIONS FEWER(200000, 20000)

/* Doubles are converted to quad: their products with errors do not round. */
static int within(quad truth, double value, quad error)
{
    return fabsq(truth - value) <= error;
}

static void check_row(const struct scene *s, brdffit_distribution d, const struct oracle_angles *truth,
                      const struct geometry *got, const char *reading)
{
    struct oracle_row row = oracle_row(d, truth);
    int fine = within(row.a, got->a, (quad)got->light_error * got->a) &&
               within(truth->light, got->cos_light, (quad)got->light_error * got->cos_light);

    if (got->b > 0.0) {
        fine = fine && within(row.b, got->b, (quad)got->b_error * got->b) && within(row.c, got->c, got->c_error);
    } else {
        fine = fine && d == BRDFFIT_LAFORTUNE && (row.b == 0 || (row.b <= got->b_hidden && row.c >= got->c_hidden));
    }
    if (!fine) {
        fail_msg(
            "%s, %s: a %.17g b %.17g c %.17g, errors %g %g %g, truth off by %g %g (relative) %g; hidden %g %g; light "
            "%a,%a,%a view %a,%a,%a normal %a,%a,%a",
            brdffit_distribution_string(d), reading, got->a, got->b, got->c, got->light_error, got->b_error,
            got->c_error, (double)(row.a / got->a - 1), (double)(row.b / got->b - 1), (double)(row.c - got->c),
            got->b_hidden, got->c_hidden, s->light[0], s->light[1], s->light[2], s->view[0], s->view[1], s->view[2],
            s->normal[0], s->normal[1], s->normal[2]);
    }
}

/* Whether the other reading is allowed for: not near the horizon, nor for exact mirror images (rounding.h), whose tan^2 is
 * the rounding of both sides, 1e-28 squared. */
static int may_move(const struct oracle_angles *at)
{
    return at->light > 2 * GRAZE && at->view > 2 * GRAZE && at->tan2 > 1e-55;
}

static void test_stated_errors(void **state)
{
    struct brdffit_test_random random = {7};
    size_t i, counted = 0, hidden = 0, moves = 0;
    struct scene s;

    (void)state;
    for (i = 0; i < DIRECTIONS; i++) {
        struct oracle_angles at[2];
        struct geometry got;
        brdffit_samples samples;
        brdffit_status status;
        int d, move;

        make_scene(&random, &s);
        samples_of(&s, &samples);
        at[0] = truth_of(&random, &s, 0);
        move = may_move(&at[0]);
        if (move) {
            at[1] = truth_of(&random, &s, TOL_ANGLE);
        }
        for (d = 0; d < BRDFFIT_DISTRIBUTION_COUNT; d++) {
            brdffit_skip skip = brdffit_geometry_sample(&samples, (brdffit_distribution)d, 0.0, 0, &got, &status, NULL);

            assert_int_equal(status, BRDFFIT_OK);
            assert_true((skip == BRDFFIT_SKIP_COUNT) == (at[0].light > LIMIT_GRAZING && at[0].view > LIMIT_GRAZING));
            if (skip == BRDFFIT_SKIP_COUNT) {
                check_row(&s, (brdffit_distribution)d, &at[0], &got, "as doubles");
                if (move) {
                    check_row(&s, (brdffit_distribution)d, &at[1], &got, "moved");
                }
                counted++;
                moves += (size_t)move;
                hidden += got.b_hidden > 0.0;
            }
        }
    }
    assert_true(counted > 5 * DIRECTIONS && moves > 4 * DIRECTIONS && hidden > DIRECTIONS / 200);
}

/* c is worth something where it counts: relative to 1e-14 at alpha >= 1e-12, whatever the lengths and the normal. */
static void test_small_angles_keep_their_digits(void **state)
{
    struct brdffit_test_random random = {8};
    struct scene s;
    int i, general, seen = 0, count = FEWER(20000, 4000);

    (void)state;
    for (i = 0; i < count; i++) {
        struct oracle_angles at;
        struct geometry got;
        brdffit_samples samples;
        brdffit_status status;

        make_upright(&random, 1, &s);
        general = i % 2;
        s.general = 0;
        if (general) {
            turn(&random, &s);
        }
        samples_of(&s, &samples);
        s.normal[0] = general ? s.normal[0] : 0.0;
        at = truth_of(&random, &s, 0);
        if (brdffit_geometry_sample(&samples, BRDFFIT_BECKMANN, 0.0, 0, &got, &status, NULL) == BRDFFIT_SKIP_COUNT &&
            at.tan2 < 1e-9 && at.tan2 > 1e-24) {
            assert_true(within(at.tan2, got.c, (quad)1e-14 * at.tan2));
            seen++;
        }
    }
    assert_true(seen > count / 4);
}

/* eval is the model, within what the errors of its geometry make of it and a few units of its own. */
static void test_eval(void **state)
{
    struct brdffit_test_random random = {9};
    struct scene s;
    size_t i;

    (void)state;
    for (i = 0; i < FEWER(30000, 5000); i++) {
        brdffit_distribution d = (brdffit_distribution)brdffit_test_below(&random, BRDFFIT_DISTRIBUTION_COUNT);
        double x = brdffit_test_uniform(&random, 0.0, 1.0), y = brdffit_test_uniform(&random, 0.0, 1.0), out;
        double sigma = !oracle_by_exponent(d) || i % 2 ? power(&random, -3.0, 0.5) : power(&random, -1.0, 1.0);
        brdffit_model model;
        brdffit_status status;
        brdffit_samples samples;
        struct geometry g;
        struct oracle_angles at;
        struct oracle_row row;
        quad lobe, most, change, exponent, concentration = 1 / ((quad)sigma * sigma);

        brdffit_model_init(&model);
        model.distribution = d;
        model.lobes = 1;
        model.channels = 1;
        model.sigma = &sigma;
        model.x = &x;
        model.y = &y;
        make_scene(&random, &s);
        samples_of(&s, &samples);
        assert_int_equal(brdffit_eval(&model, &samples, &out, NULL), BRDFFIT_OK);
        if (brdffit_geometry_sample(&samples, d, 0.0, 0, &g, &status, NULL) != BRDFFIT_SKIP_COUNT) {
            assert_true(out == 0.0);
            continue;
        }
        at = truth_of(&random, &s, 0);
        row = oracle_row(d, &at);
        lobe = y * row.b * oracle_lambda(d, concentration) * oracle_shape(d, concentration, row.c, 0);
        if (g.b > 0.0) {
            exponent = fminq(row.c, 1e4) * concentration; /* error of c s, and its own rounding */
            change = g.c_error * concentration + 8 * TOL_UNIT * (2 + (d == BRDFFIT_GGX ? 0 : exponent));
            most = lobe * (2 * g.b_error + expm1q(fminq(2 * change, 10000)));
        } else {
            most = y * (quad)g.b_hidden * oracle_lambda(d, concentration) *
                   oracle_shape(d, concentration, g.c_hidden, 0);
        }
        most += x * row.a * g.light_error + 8 * TOL_UNIT * (x * row.a + lobe) + 1e-290;
        if (!within(x * row.a + lobe, out, most)) {
            fail_msg("%s sigma %.17g: %.17g, not %.17g, allowed %g", brdffit_distribution_string(d), sigma, out,
                     (double)(x * row.a + lobe), (double)most);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stated_errors),
        cmocka_unit_test(test_small_angles_keep_their_digits),
        cmocka_unit_test(test_eval),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
