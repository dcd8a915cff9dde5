/* random.c: splitmix64 (Steele, Lea and Flood 2014) and Box-Muller.
 * SPDX-License-Identifier: MIT */
#include "random.h"

#include <math.h>

static uint64_t next(struct gonio_random *random)
{
    uint64_t z = random->state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

struct gonio_random brdffit_gonio_random(uint64_t seed, uint64_t stream)
{
    struct gonio_random first = {seed}, second = {stream ^ UINT64_C(0xD1B54A32D192ED03)};
    const struct gonio_random mixed = {next(&first) ^ (next(&second) << 1)};
    return mixed;
}

double brdffit_gonio_uniform(struct gonio_random *random)
{
    return ((double)(next(random) >> 12) + 0.5) * 0x1p-52;
}

double brdffit_gonio_normal(struct gonio_random *random)
{
    /* The second number of the pair is dropped: simpler, and nothing here is
     * in a hurry. */
    const double radius = sqrt(-2 * log(brdffit_gonio_uniform(random)));
    return radius * cos(2 * 3.14159265358979323846 * brdffit_gonio_uniform(random));
}

size_t brdffit_gonio_below(struct gonio_random *random, size_t count)
{
    return (size_t)(brdffit_gonio_uniform(random) * (double)count);
}
