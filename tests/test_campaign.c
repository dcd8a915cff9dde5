/*
 * 20,000 random problems against quad precision, of few boxes each; `build/tests/campaign` is the long one.
 * To see more of them: test_campaign SEED COUNT. SPDX-License-Identifier: MIT
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "fewer.h"
#include "quad/campaign_run.h"

static uint64_t seed = 1;
/* Some problems are refused (more of them without ECOS), some are of several texels. */
#define PROBLEMS FEWER(18750ul, 937ul)
#define JUDGED FEWER(20000ul, 900ul)
static unsigned long count = PROBLEMS;

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
    c.effort = 60;
    c.budget = 500;
    faulty = campaign_run(&c, row);
    campaign_table(row, stdout);
    for (f = 0; f < draw_family_count; f++) {
        fits += row[f].fits - row[f].refused;
        /* A family that is refused tries nothing. Without ECOS norms l1 and linf are refused, too. */
        assert_true(4 * row[f].refused < 3 * row[f].fits || row[f].fits < 20);
    }
    print_message("%lu fits judged\n", fits);
    assert_int_equal(faulty, 0);
    assert_true(fits >= JUDGED || count < PROBLEMS);
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
