/*
 * An example of firmware: fit while a goniometer measures, and stop when the fit is certified and settled.
 * SPDX-License-Identifier: MIT
 *
 * Measurements come through a queue. After each a lobe is fitted to all there are; the scan ends when the fit is certified
 * and three more samples have moved the roughness by less than 1 % together. To compare, the scan is completed then, and one
 * lobe and two are fitted to all of it.
 * All memory is the arrays below; nothing is allocated.
 *
 * Lines are the same on every processor, to the bit, but for those that begin with '#': what it took here.
 */
#include "brdffit.h"
#include "goniometer.h"
#include "platform.h"

#define FEWEST 12u /* samples before the first fit */

static double light[3 * SCAN], view[3 * SCAN], value[CHANNELS * SCAN];
static unsigned char workspace[WORKSPACE]; /* bytes: the builder's choice; a fit of one lobe keeps to 48 KB of them */
static struct goniometer goniometer;

static void print_number(uint64_t n)
{
    char text[24], *at = text + sizeof text - 1;

    *at = '\0';
    do {
        *--at = (char)('0' + n % 10u);
        n /= 10u;
    } while (n);
    platform_print(at);
}

static void print_bits(const char *before, double v)
{
    static const char digit[] = "0123456789abcdef";
    union {
        double number;
        uint64_t bits;
    } u = {v};
    char text[17];
    int i;

    for (i = 0; i < 16; i++) {
        text[i] = digit[u.bits >> (60 - 4 * i) & 15u];
    }
    text[16] = '\0';
    platform_print(before);
    platform_print(text);
}

static void print_labelled(const char *label, uint64_t n)
{
    platform_print(label);
    print_number(n);
}

static void report(uint32_t samples, const brdffit_result *r)
{
    int p;

    print_labelled("", samples);
    print_labelled(" samples, ", (uint64_t)r->model->lobes);
    print_labelled(r->model->lobes > 1 ? " lobes: " : " lobe: ", r->boxes);
    platform_print(r->certified ? " boxes, certified;" : " boxes, open;");
    for (p = 0; p < r->model->lobes; p++) {
        print_bits(" sigma ", r->model->sigma[p]);
    }
    print_bits(" E2 ", r->e2);
    print_bits(" bound ", r->lower_bound);
    platform_print("\n");
}

/* What a fit took: instructions here, and bytes of the workspace that it wrote. */
static void report_cost(int lobes, uint64_t instructions, size_t size)
{
    size_t touched = size;

    while (touched > 0 && workspace[touched - 1] == 0xa5) {
        touched--;
    }
    print_labelled("# ", (uint64_t)lobes);
    print_labelled("-lobe instructions ", instructions);
    print_labelled("\n# ", (uint64_t)lobes);
    print_labelled("-lobe workspace ", touched);
    platform_print("\n");
}

static const brdffit_result *fit(uint32_t samples, int lobes, uint64_t *instructions)
{
    static const brdffit_result *result;
    brdffit_samples s;
    brdffit_options options;
    brdffit_error error;
    size_t size, i;
    uint64_t before;

    brdffit_samples_init(&s);
    s.count = samples;
    s.channels = CHANNELS;
    s.light = light;
    s.view = view;
    s.values = value;
    brdffit_options_init(&options);
    options.lobes = lobes;
    options.memory = lobes == 1 && sizeof workspace > 49152 ? 49152 : sizeof workspace;
    size = brdffit_workspace_size(samples, CHANNELS, &options);
    if (size == 0 || size > sizeof workspace) {
        platform_print("the workspace is too small\n");
        return NULL;
    }
    for (i = 0; i < sizeof workspace; i++) {
        workspace[i] = 0xa5;
    }
    before = platform_instructions();
    if (brdffit_fit(&s, &options, workspace, sizeof workspace, &result, &error) != BRDFFIT_OK) {
        platform_print(error.message);
        platform_print("\n");
        return NULL;
    }
    *instructions = platform_instructions() - before;
    return result;
}

static void keep(uint32_t i, const struct measurement *m)
{
    int k;

    for (k = 0; k < 3; k++) {
        light[3 * i + (uint32_t)k] = m->light[k];
        view[3 * i + (uint32_t)k] = m->view[k];
    }
    for (k = 0; k < CHANNELS; k++) {
        value[CHANNELS * i + (uint32_t)k] = m->value[k];
    }
}

/* Whether the last four roughnesses are within 1 %. */
static int settled(const double sigma[4])
{
    double low = sigma[0], high = sigma[0];
    int i;

    for (i = 1; i < 4; i++) {
        low = sigma[i] < low ? sigma[i] : low;
        high = sigma[i] > high ? sigma[i] : high;
    }
    return low > 0.0 && high < 1.01 * low;
}

/* One more sample; 0 when there is none. */
static int measure(uint32_t *samples)
{
    struct measurement next;

    if (*samples == SCAN || !goniometer_measure(&goniometer) || !goniometer_take(&goniometer, &next)) {
        return 0;
    }
    keep((*samples)++, &next);
    return 1;
}

/* Measure and fit until that is enough; the number of samples, 0 after a failure. */
static uint32_t scan(void)
{
    double sigma[4] = {0.0};
    uint32_t samples = 0;

    goniometer_start(&goniometer, 1);
    while (measure(&samples)) {
        const brdffit_result *r;
        uint64_t instructions;

        if (samples < FEWEST) {
            continue;
        }
        r = fit(samples, 1, &instructions);
        if (!r) {
            return 0;
        }
        report(samples, r);
        sigma[samples % 4] = r->model->sigma[0];
        if (r->certified && settled(sigma)) {
            break;
        }
    }
    return samples;
}

int firmware_main(void)
{
    uint32_t samples = scan();
    int lobes;

    if (!samples) {
        return 1;
    }
    while (measure(&samples)) {
    }
    for (lobes = 1; lobes <= (BRDFFIT_MAX_LOBES > 1 ? 2 : 1); lobes++) {
        uint64_t instructions;
        const brdffit_result *r = fit(samples, lobes, &instructions);

        if (!r) {
            return 1;
        }
        report(samples, r);
        report_cost(lobes, instructions, sizeof workspace);
    }
    print_labelled("# stack ", platform_stack());
    platform_print("\n");
    return 0;
}
