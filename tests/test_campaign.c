/*
 * A short campaign of random problems against quad precision; `build/tests/campaign` is the long one.
 * To see more of them: test_campaign SEED COUNT. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "quad/campaign_run.h"

static uint64_t seed = 1;
/* The judge is slow under the sanitizers, and a build without ECOS repeats what that with it has judged. */
#if defined(__SANITIZE_ADDRESS__) || defined(BRDFFIT_NO_ECOS)
static unsigned long count = 300;
#else
static unsigned long count = 3000;
#endif

static void test_campaign(void **state)
{
    struct campaign_row row[CAMPAIGN_FAMILIES];
    struct campaign c;
    unsigned long faulty, fits = 0;
    int f;

    (void)state;
    campaign_defaults(&c);
    c.seed = seed;
    c.count = count;
    c.effort = 120;
    faulty = campaign_run(&c, row);
    campaign_table(row, stdout);
    for (f = 0; f < draw_family_count; f++) {
        fits += row[f].fits - row[f].refused;
        assert_true(2 * row[f].refused < row[f].fits || row[f].fits < 20); /* a family that is refused tries nothing */
    }
    print_message("%lu fits judged\n", fits);
    assert_int_equal(faulty, 0);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_campaign),
    };

    if (argc == 3) {
        seed = strtoull(argv[1], NULL, 10);
        count = strtoul(argv[2], NULL, 10);
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
