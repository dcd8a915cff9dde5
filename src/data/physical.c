/*
 * Physical bounds, in the units of reduced data: see physical.h. SPDX-License-Identifier: MIT
 */
#include "data/physical.h"

static const struct wide infinite = {INFINITY, 0};

/* reflectance / divisor; a divisor that vanishes to any double lets no coefficient be. */
static struct wide per(double reflectance, struct wide divisor, double scale)
{
    divisor = wide_times(divisor, wide_of(scale));
    return divisor.value > 0.0 ? wide_over(wide_of(reflectance), divisor) : infinite;
}

struct wide brdffit_physical_fixed(const struct reduced *data, int column)
{
    return per(1.0, wide_of(1.0), data->scale_a[column]);
}

static struct twofold exact(double s)
{
    const struct twofold both = {s, 0.0};

    return both;
}

struct wide brdffit_physical_lobe(const struct lobe_kind *kind, const struct table *table, double theta)
{
    return per(kind->reflectance, brdffit_lobe_divisor(kind, exact(kernel_exp(theta)), &table->sight), table->scale_b);
}

struct wide brdffit_physical_least(const struct lobe_kind *kind, const struct table *table, double low, double high)
{
    double s = kernel_exp(high);
    struct wide most = wide_times(wide_of(kind->lambda(s)), kind->phi(exact(kernel_exp(low)), table->sight.c_min));

    if (kind->conversion) {
        most = wide_times(most, wide_of(kind->conversion(&table->sight, s)));
    }
    return per(kind->reflectance, most, table->scale_b);
}

double brdffit_physical_unit(const struct reduced *data, struct wide counts, double norm, size_t k)
{
    struct wide unit = wide_times(wide_of(data->channel_scale[k]), wide_of(data->value_scale));

    if (!(norm > 0.0)) {
        return 0.0;
    }
    return counts.value < 1.0 ? wide_value(wide_over(wide_times(counts, unit), wide_of(norm))) : INFINITY;
}
