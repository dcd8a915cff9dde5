/*
 * The paper's 84 directions. SPDX-License-Identifier: MIT
 */
#include "io/csv/angle.h"
#include "brdffit_io.h"
#include "base/environment.h"

ENVIRONMENT_APART static void directions(double light[84 * 3], double view[84 * 3])
{
    int at_view, at_light, azimuth, i = 0;

    for (at_view = 0; at_view <= 60; at_view += 20) {
        for (at_light = 0; at_light <= 60; at_light += 10) {
            for (azimuth = 0; azimuth <= 180; azimuth += 90, i++) {
                brdffit_io_direction(at_light, azimuth, light + 3 * i);
                brdffit_io_direction(at_view, 0, view + 3 * i);
            }
        }
    }
}

void brdffit_io_protocol84(double light[84 * 3], double view[84 * 3])
{
    struct environment callers;

    brdffit_environment_enter(&callers);
    directions(light, view);
    brdffit_environment_leave(&callers);
}
