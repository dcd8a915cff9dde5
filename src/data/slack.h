/*
 * What sums over the channels are off by, relative to the data's sum of squares T. SPDX-License-Identifier: MIT
 *
 * A bound is T - J: T is the sum of K squares, J that of K gains, none above its square, and both are added plainly, one
 * after the other: the error of each is at most (K - 1) u T, and nothing says that they cancel. A few units more are
 * for the roots of channels that stand for several.
 */
#ifndef BRDFFIT_SLACK_H
#define BRDFFIT_SLACK_H

#include <stddef.h>

#include "base/tolerance.h"

static inline double slack_of_channels(size_t channels)
{
    return 2.0 * TOL_UNIT * ((double)channels + 4.0);
}

#endif
