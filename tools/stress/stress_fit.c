/*
 * stress_fit LOBES DISTRIBUTION[,DISTRIBUTION...] NORMALISE FILE...: fit each file and print one JSON object a line, 17 digits, with
 * what the command line does not print (sigma_floor). Every fit is run again in other floating-point environments
 * (rounding modes, FTZ, DAZ), and "same_bits" says whether each of them gave the same bits and came back as it was.
 * SPDX-License-Identifier: MIT
 */
#include <fenv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "brdffit.h"
#include "brdffit_io.h"
#include "bench/lobes.h"

#if defined(__SSE2__)
/* Down, up, towards zero, FTZ, DAZ, both, and both with each rounding mode. */
static const unsigned modes[] = {0x3f80, 0x5f80, 0x7f80, 0x9f80, 0x1fc0, 0x9fc0, 0xbfc0, 0xdfc0, 0xffc0};

static unsigned mode_now(void)
{
    return __builtin_ia32_stmxcsr();
}

static void set_mode(unsigned mode)
{
    __builtin_ia32_ldmxcsr(mode);
}
#else
static const unsigned modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};

static unsigned mode_now(void)
{
    return (unsigned)fegetround();
}

static void set_mode(unsigned mode)
{
    (void)fesetround((int)mode);
}
#endif

/* A result that outlives its workspace: without pointers, and what they pointed to. */
struct copy {
    brdffit_result result;
    brdffit_lobe lobe[BRDFFIT_MAX_LOBES];
    double sigma[BRDFFIT_MAX_LOBES];
    size_t channels, lobes;
    double *arrays; /* x, y, channel_scale, rms */
    size_t doubles;
};

static struct copy copy_of(const brdffit_result *result)
{
    const brdffit_model *model = result->model;
    size_t channels = model->channels, lobes = (size_t)model->lobes, p;
    struct copy copy;

    memset(&copy, 0, sizeof copy);
    memcpy(&copy.result, result, sizeof copy.result);
    copy.channels = channels;
    copy.lobes = lobes;
    copy.doubles = channels * (3 + lobes);
    copy.arrays = calloc(copy.doubles, sizeof(double));
    if (!copy.arrays) {
        exit(1);
    }
    memcpy(copy.arrays, model->x, channels * sizeof(double));
    memcpy(copy.arrays + channels, model->y, channels * lobes * sizeof(double));
    memcpy(copy.arrays + channels * (1 + lobes), result->channel_scale, channels * sizeof(double));
    memcpy(copy.arrays + channels * (2 + lobes), result->rms, channels * sizeof(double));
    for (p = 0; p < lobes; p++) {
        memcpy(&copy.lobe[p], result->lobe[p], sizeof copy.lobe[p]);
        copy.sigma[p] = model->sigma[p];
    }
    copy.result.model = NULL;
    copy.result.lobe = NULL;
    copy.result.samples_skipped = NULL;
    copy.result.channel_scale = copy.result.rms = NULL;
    return copy;
}

static int same_bits(const struct copy *one, const brdffit_result *result)
{
    struct copy other = copy_of(result);
    int same = one->doubles == other.doubles && !memcmp(&one->result, &other.result, sizeof one->result) &&
               !memcmp(one->lobe, other.lobe, sizeof one->lobe) &&
               !memcmp(one->sigma, other.sigma, sizeof one->sigma) &&
               !memcmp(one->arrays, other.arrays, one->doubles * sizeof(double));

    free(other.arrays);
    return same;
}

static int survives_environments(const brdffit_samples *samples, const brdffit_options *options, void *workspace,
                                 size_t size, const struct copy *first)
{
    size_t i;

    for (i = 0; i < sizeof modes / sizeof modes[0]; i++) {
        unsigned callers = mode_now(), after;
        const brdffit_result *result;
        brdffit_status status;

        set_mode(modes[i]);
        status = brdffit_fit(samples, options, workspace, size, &result, NULL);
        after = mode_now();
        set_mode(callers);
        if (status != BRDFFIT_OK || after != modes[i] || !same_bits(first, result)) {
            fprintf(stderr, "stress_fit: environment %#x: status %d, left as %#x, or other bits\n", modes[i], status,
                    after);
            return 0;
        }
    }
    return 1;
}

static void print_number(const char *name, double value)
{
    if (isfinite(value)) {
        printf(",\"%s\":%.17g", name, value);
    } else {
        printf(",\"%s\":null", name);
    }
}

static void print_numbers(const char *name, const double *values, size_t count)
{
    size_t i;

    printf(",\"%s\":[", name);
    for (i = 0; i < count; i++) {
        printf("%s%.17g", i ? "," : "", values[i]);
    }
    printf("]");
}

static void print_result(const char *file, const struct copy *copy, int same, double tight_bound)
{
    const brdffit_result *r = &copy->result;
    size_t channels = copy->channels, lobes = copy->lobes, p;

    printf("{\"file\":\"%s\",\"stop\":\"%s\",\"certified\":%d,\"boxes\":%zu,\"same_bits\":%d", file,
           brdffit_stop_string(r->stop), r->certified, r->boxes, same);
    print_numbers("sigma", copy->sigma, lobes);
    print_numbers("x", copy->arrays, channels);
    print_numbers("y", copy->arrays + channels, channels * lobes);
    print_numbers("scale", copy->arrays + channels * (1 + lobes), channels);
    print_number("e2", r->e2);
    print_number("lower_bound", r->lower_bound);
    print_number("tight_bound", tight_bound);
    print_number("sum_of_squares", r->sum_of_squares);
    print_number("sigma_floor", r->sigma_floor);
    printf(",\"interval\":[");
    for (p = 0; p < lobes; p++) {
        printf("%s[%.17g,%.17g]", p ? "," : "", copy->lobe[p].sigma_low, copy->lobe[p].sigma_high);
    }
    printf("]}\n");
}

/*
 * The lower bound of a search that goes on as far as arithmetic (or 20,000 boxes) lets it: a bound that is wrong by
 * roundings only shows where the gap is no larger than they are. NaN if that fit fails.
 */
static double bound_at_rounding(const brdffit_samples *samples, const brdffit_options *options)
{
    brdffit_options tight = *options;
    const brdffit_result *result;
    double bound = NAN;

    tight.relative_gap = 1e-300;
    tight.absolute_gap = 0.0;
    tight.box_budget = 20000;
    if (brdffit_fit_new(samples, &tight, &result, NULL) == BRDFFIT_OK) {
        bound = result->lower_bound;
        brdffit_result_free(result);
    }
    return bound;
}

static int fit_file(const char *file, const brdffit_options *options)
{
    brdffit_table *table = NULL;
    const brdffit_result *result;
    brdffit_error error;
    struct copy copy;
    void *workspace;
    size_t size;

    if (brdffit_io_read(file, NULL, &table, &error) != BRDFFIT_OK) {
        fprintf(stderr, "%s: %s (line %zu)\n", file, error.message, error.line);
        return 0;
    }
    size = brdffit_workspace_size(table->samples->count, table->samples->channels, options);
    workspace = malloc(size);
    if (!workspace || brdffit_fit(table->samples, options, workspace, size, &result, &error) != BRDFFIT_OK) {
        printf("{\"file\":\"%s\",\"error\":\"%s\"}\n", file, workspace ? error.message : "no memory");
    } else {
        copy = copy_of(result);
        /* A long search is not run ten times. */
        print_result(file, &copy,
                     copy.result.boxes > 30000 ||
                         survives_environments(table->samples, options, workspace, size, &copy),
                     bound_at_rounding(table->samples, options));
        free(copy.arrays);
    }
    free(workspace);
    brdffit_io_free(table);
    return 1;
}

int main(int argc, char **argv)
{
    brdffit_options options;
    brdffit_distribution list[BRDFFIT_MAX_LOBES];
    int i, failed = argc < 5;

    brdffit_options_init(&options);
    if (failed || !bench_lobes(argv[2], &options, list) || !options.distributions) {
        fprintf(stderr, "usage: stress_fit LOBES NAME[,NAME...] max|none FILE...\nOne name is that of all lobes.\n");
        return 2;
    }
    if (options.lobes == 1) { /* one name for all */
        options.distribution = list[0];
        options.distributions = NULL;
        options.lobes = atoi(argv[1]);
    }
    options.normalise = argc > 3 && !strcmp(argv[3], "none") ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
    for (i = 4; i < argc; i++) {
        failed |= !fit_file(argv[i], &options);
        fflush(stdout);
    }
    return failed;
}
