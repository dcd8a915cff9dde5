/* merl.c: a table in MERL's layout.
 *
 * Three little-endian int32 (half, difference, azimuth bins), then a plane of
 * float64 a channel, index p + n_p (d + n_d h). Entry (h, d, p) stands for
 *
 *     theta_h = 90 (h / n_h)^2,   theta_d = 90 d / n_d,   phi_d = 180 p / n_p
 *
 * degrees: the lower edges of its bin. Values are divided by MERL's factors
 * 1/1500, 1.15/1500, 1.66/1500. Negative: not measured.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "instrument.h"
#include "random.h"

#define PI 3.14159265358979323846

/* One cell in fifty was not measured, and no cell at the last row of
 * difference angles, as close to grazing as real tables fail. */
#define MASKED_FRACTION 0.02

static const double factors[GONIO_CHANNELS] = {1 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

static void put_int32(struct gonio_file *file, uint32_t value)
{
    unsigned char bytes[4];
    for (int i = 0; i < 4; i++) {
        bytes[i] = (unsigned char)(value >> (8 * i));
    }
    brdffit_gonio_add(file, bytes, sizeof bytes);
}

static void put_float64(struct gonio_file *file, double value)
{
    uint64_t bits;
    unsigned char bytes[8];
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 8; i++) {
        bytes[i] = (unsigned char)(bits >> (8 * i));
    }
    brdffit_gonio_add(file, bytes, sizeof bytes);
}

/* Rusinkiewicz 1998 backwards: the difference vector, turned by theta_h about
 * the y axis, is the light; the view is its mirror image about h. */
static void directions(int h, int d, int p, double light[3], double view[3])
{
    const double ratio = (double)h / GONIO_HALF_BINS;
    const double half_angle = PI / 2 * ratio * ratio;
    const double difference = PI / 2 * d / GONIO_DIFFERENCE_BINS;
    const double azimuth = PI * p / GONIO_AZIMUTH_BINS;
    const double around = sin(difference) * cos(azimuth);
    const double along = cos(difference);
    const double half[3] = {sin(half_angle), 0, cos(half_angle)};
    const double side[3] = {cos(half_angle), 0, -sin(half_angle)};
    for (int i = 0; i < 3; i++) {
        const double across = i == 1 ? sin(difference) * sin(azimuth) : 0;
        light[i] = around * side[i] + across + along * half[i];
        view[i] = 2 * along * half[i] - light[i];
    }
}

static double cell(const struct gonio_material *material, int channel, int h, int d, int p)
{
    double light[3], view[3];
    directions(h, d, p, light, view);
    if (d == GONIO_DIFFERENCE_BINS - 1 || !(light[2] > 1e-12) || !(view[2] > 1e-12)) {
        return -1;
    }
    return brdffit_gonio_brdf(material, channel, light, view) / factors[channel];
}

void brdffit_gonio_merl(struct gonio_file *file, const struct gonio_material *material, uint64_t seed, uint64_t stream)
{
    put_int32(file, GONIO_HALF_BINS);
    put_int32(file, GONIO_DIFFERENCE_BINS);
    put_int32(file, GONIO_AZIMUTH_BINS);
    for (int k = 0; k < GONIO_CHANNELS; k++) {
        /* The same stream for every channel: a cell is masked in all. */
        struct gonio_random random = brdffit_gonio_random(seed, stream);
        for (int h = 0; h < GONIO_HALF_BINS; h++) {
            for (int d = 0; d < GONIO_DIFFERENCE_BINS; d++) {
                for (int p = 0; p < GONIO_AZIMUTH_BINS; p++) {
                    const int masked = brdffit_gonio_uniform(&random) < MASKED_FRACTION;
                    put_float64(file, masked ? -1 : cell(material, k, h, d, p));
                }
            }
        }
    }
}
