/*
 * A program of version 0.2: check_abi.sh compiles it with that version's headers (tests/data/abi) and runs it with
 * today's library and with one whose structures have grown. It uses every structure once, each of its own with guards
 * around it, and prints all numbers. Not to be changed: what it does must go on working. SPDX-License-Identifier: MIT
 */
#include <brdffit_io.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLES 84
#define CHANNELS 3
#define TEXELS 5
#define GUARD 256

static struct {
    unsigned char *block;
    size_t size;
    const char *name;
} guarded[64];
static size_t guards;

static void *guard(const char *name, size_t size)
{
    unsigned char *block = malloc(size + 2 * GUARD);

    if (!block || guards == sizeof guarded / sizeof *guarded) {
        exit(1);
    }
    memset(block, 0x5a, size + 2 * GUARD);
    guarded[guards].block = block;
    guarded[guards].size = size;
    guarded[guards++].name = name;
    return block + GUARD;
}

#define NEW(type) guard(#type, sizeof(type))

static void check_guards(const char *when)
{
    size_t g, i;

    for (g = 0; g < guards; g++) {
        for (i = 0; i < GUARD; i++) {
            if (guarded[g].block[i] != 0x5a || guarded[g].block[GUARD + guarded[g].size + i] != 0x5a) {
                printf("%s: memory beside %s was written to\n", when, guarded[g].name);
                exit(1);
            }
        }
    }
}

static void check(const char *what, brdffit_status status, const brdffit_error *error)
{
    check_guards(what);
    printf("%s: %s\n", what, status == BRDFFIT_OK ? "ok" : brdffit_status_string(status));
    if (status != BRDFFIT_OK && status != BRDFFIT_ERR_UNSUPPORTED) {
        printf("%s\n", error->message);
        exit(1);
    }
}

static void print(const char *name, const double *values, size_t count)
{
    size_t i;

    printf("%s", name);
    for (i = 0; i < count; i++) {
        printf(" %a", values[i]);
    }
    printf("\n");
}

static double light[3 * SAMPLES], view[3 * SAMPLES], values[TEXELS * SAMPLES * CHANNELS];

static void direction(double theta, double phi, double *out)
{
    const double degree = 3.14159265358979323846 / 180.0;

    out[0] = sin(theta * degree) * cos(phi * degree);
    out[1] = sin(theta * degree) * sin(phi * degree);
    out[2] = cos(theta * degree);
}

/* The paper's directions, and values of a model with some disturbance. */
static void make_samples(brdffit_samples *samples)
{
    static const double sigma[2] = {0.12, 0.45}, x[CHANNELS] = {0.2, 0.1, 0.3};
    static const double y[2 * CHANNELS] = {0.02, 0.1, 0.03, 0.05, 0.01, 0.2};
    brdffit_model *model = NEW(brdffit_model);
    brdffit_error error;
    size_t t, i;

    for (i = 0; i < SAMPLES; i++) {
        direction(10.0 * (double)(i / 3 % 7), 90.0 * (double)(i % 3), light + 3 * i);
        direction(20.0 * (double)(i / 21), 0.0, view + 3 * i);
    }
    light[2] = -1.0; /* below the horizon */
    brdffit_samples_init(samples);
    samples->count = SAMPLES;
    samples->channels = CHANNELS;
    samples->light = light;
    samples->view = view;
    samples->values = values;
    brdffit_model_init(model);
    model->lobes = 2;
    model->channels = CHANNELS;
    model->sigma = sigma;
    model->x = x;
    model->y = y;
    check("eval", brdffit_eval(model, samples, values, &error), &error);
    print("values", values, SAMPLES * CHANNELS);
    for (t = TEXELS; t-- > 0;) {
        for (i = 0; i < SAMPLES * CHANNELS; i++) {
            values[t * SAMPLES * CHANNELS + i] = values[i] *
                                                 (1.0 + 0.02 * (double)((i * (7 + t)) % 5) + 0.1 * (double)t);
        }
    }
}

struct seen {
    size_t progress, boxes;
    double sum;
};

static int see_progress(void *user, const brdffit_progress *progress)
{
    struct seen *seen = user;

    seen->progress++;
    seen->sum += progress->e2 + progress->lower_bound + (double)progress->boxes + (double)progress->phase;
    return 0;
}

static void see_box(void *user, const brdffit_box *box)
{
    struct seen *seen = user;
    int p;

    seen->boxes++;
    for (p = 0; p < box->lobes; p++) {
        seen->sum += box->sigma_low[p] * box->sigma_high[p];
    }
    seen->sum += box->lower_bound + box->level;
}

static void print_result(const brdffit_result *r)
{
    const brdffit_model *m = r->model;
    size_t lobes = (size_t)m->lobes, i;

    printf("%s %d lobes %zu channels\n", brdffit_distribution_string(m->distributions[0]), m->lobes, m->channels);
    print("sigma", m->sigma, lobes);
    print("x", m->x, m->channels);
    print("y", m->y, m->channels * lobes);
    print("scale", r->channel_scale, m->channels);
    print("rms", r->rms, m->channels);
    print("figures", &r->rms_total, 9); /* rms_total to kkt_residual */
    for (i = 0; i < lobes; i++) {
        print("lobe", &r->lobe[i]->sigma, 8); /* sigma to effective_samples */
        printf("warnings %u\n", r->lobe[i]->warnings);
    }
    for (i = 0; i < BRDFFIT_SKIP_COUNT; i++) {
        printf("%s %zu\n", brdffit_skip_string((brdffit_skip)i), r->samples_skipped[i]);
    }
    printf("%s %d %zu %zu %zu %zu %zu %zu %zu %zu %zu\n", brdffit_stop_string(r->stop), r->certified, r->boxes,
           r->nodes, r->programs_solved, r->programs_refused, r->programs_decided, r->distinct_c, r->channels_zero,
           r->channels_identical, r->samples_used);
}

static void fit(const brdffit_samples *samples, brdffit_options *options)
{
    static double out[SAMPLES * CHANNELS];
    struct seen seen = {0, 0, 0.0};
    const brdffit_result *result;
    brdffit_error *error = NEW(brdffit_error);
    brdffit_model *copy = NEW(brdffit_model);
    size_t size, used, *skipped = guard("skipped", BRDFFIT_SKIP_COUNT * sizeof *skipped);
    void *workspace;

    brdffit_options_init(options);
    options->lobes = 2;
    options->progress = see_progress;
    options->progress_user = &seen;
    options->box = see_box;
    options->box_user = &seen;
    check("fit_new", brdffit_fit_new(samples, options, &result, error), error);
    print_result(result);
    printf("seen %zu %zu %a\n", seen.progress, seen.boxes, seen.sum);
    *copy = *result->model;
    check("eval of a copy", brdffit_eval(copy, samples, out, error), error);
    print("out", out, SAMPLES * CHANNELS);
    brdffit_result_free(result);
    size = brdffit_workspace_size(samples->count, samples->channels, options);
    workspace = guard("workspace", size);
    check("fit", brdffit_fit(samples, options, workspace, size, &result, error), error);
    print_result(result);
    check("inspect", brdffit_inspect(samples, options, &used, skipped, BRDFFIT_SKIP_COUNT, error), error);
    printf("%zu %zu %zu\n", used, skipped[0], skipped[1]);
}

static void sums(const brdffit_samples *samples, const brdffit_options *with)
{
    static const double sine[2] = {0.0, 0.5}, cosine[2] = {1.0, 0.8660254037844386}, azimuth[3] = {1.0, 0.0, -1.0};
    static const double entries[6] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, scale[CHANNELS] = {0.01, 0.01, 0.01};
    const void *planes[CHANNELS] = {entries, entries, entries};
    brdffit_options *options = NEW(brdffit_options);
    brdffit_row *row = NEW(brdffit_row);
    size_t size = brdffit_sums_size(CHANNELS, 100), cells[BRDFFIT_CELL_COUNT] = {0, 0, 0}, used, i;
    size_t *skipped = guard("skipped", BRDFFIT_SKIP_COUNT * sizeof *skipped);
    const brdffit_result *result;
    brdffit_error error;
    brdffit_sums *made;

    *options = *with;
    options->box = NULL;
    check("sums_init", brdffit_sums_init(guard("sums", size), size, CHANNELS, 100, options, &made, &error), &error);
    check("sums_add", brdffit_sums_add(made, samples, &error), &error);
    brdffit_row_init(row);
    row->differences = 2;
    row->azimuths = 3;
    row->sin_half = 0.6;
    row->cos_half = 0.8;
    row->sin_difference = sine;
    row->cos_difference = cosine;
    row->cos_azimuth = azimuth;
    row->entries = planes;
    row->scale = scale;
    check("sums_add_row", brdffit_sums_add_row(made, row, cells, &error), &error);
    brdffit_sums_count(made, &used, skipped, BRDFFIT_SKIP_COUNT);
    printf("%zu %zu %zu %zu %zu\n", used, skipped[1], skipped[3], cells[0], cells[1]);
    print("largest", (double[1]){brdffit_sums_largest(made, 1)}, 1);
    size = brdffit_sums_workspace_size(made, options);
    check("fit_sums", brdffit_fit_sums(made, options, guard("workspace", size), size, &result, &error), &error);
    for (i = 0; i < 2; i++) {
        print_result(result);
    }
}

static void map(const brdffit_samples *samples, int lobes)
{
    double *number = guard("arrays", TEXELS * 32 * sizeof *number);
    unsigned char *mask = guard("mask", TEXELS), *word = guard("words", 2 * TEXELS);
    size_t *count = guard("counts", 2 * TEXELS * sizeof *count), size, t;
    brdffit_options *options = NEW(brdffit_options);
    brdffit_texels *texels = NEW(brdffit_texels);
    brdffit_texel_results *results = NEW(brdffit_texel_results);
    brdffit_many_stats *stats = NEW(brdffit_many_stats);
    const brdffit_plan *plan;
    brdffit_error error;

    brdffit_options_init(options);
    options->lobes = lobes;
    size = brdffit_plan_size(samples, options);
    check("plan", brdffit_plan_init(samples, options, guard("plan", size), size, &plan, &error), &error);
    brdffit_texels_init(texels, plan);
    texels->count = TEXELS;
    texels->values = values;
    memset(mask, 1, TEXELS);
    mask[3] = 0;
    texels->mask = mask;
    brdffit_texel_results_init(results);
    memset(number, 0, TEXELS * 32 * sizeof *number);
    results->sigma = number;
    results->x = number + 2 * TEXELS;
    results->y = number + 5 * TEXELS;
    results->channel_scale = number + 11 * TEXELS;
    results->e2 = number + 14 * TEXELS;
    results->lower_bound = number + 15 * TEXELS;
    results->sum_of_squares = number + 16 * TEXELS;
    results->status = word;
    results->stop = word + TEXELS;
    results->where = count;
    results->boxes = count + TEXELS;
    brdffit_many_stats_init(stats);
    size = brdffit_many_workspace_size(plan);
    check("fit_many", brdffit_fit_many(plan, texels, results, guard("workspace", size), size, stats, &error), &error);
    print("map", number, 17 * TEXELS);
    for (t = 0; t < TEXELS; t++) {
        printf("%s %zu %zu\n", brdffit_texel_status_string((brdffit_texel_status)word[t]), count[t], count[TEXELS + t]);
    }
    printf("stats %zu %zu %zu %zu %zu %zu %zu %zu\n", stats->texels, stats->certified, stats->masked, stats->equal,
           stats->general, stats->boxes, stats->nodes, stats->one_lobe_enough);
}

static void verify(const brdffit_samples *samples)
{
    brdffit_options *options = NEW(brdffit_options);
    const brdffit_verification *made;
    brdffit_error error;
    brdffit_status status;
    size_t size;

    brdffit_options_init(options);
    options->engine = BRDFFIT_ENGINE_SOCP;
    options->box_budget = 2000;
    size = brdffit_workspace_size(samples->count, samples->channels, options);
    status = brdffit_verify(samples, options, 1e-3, guard("workspace", size), size, &made, &error);
    check("verify", status, &error);
    if (status == BRDFFIT_OK) {
        printf("%a %d %zu %zu %zu %zu %zu %a\n", made->level, made->proven, made->boxes, made->leaves, made->solved,
               made->refused, made->decided, made->unproven);
    }
}

static void file(void)
{
    static const char text[] =
        "lx,ly,lz,vx,vy,vz,r\n0,0,1,0,0,1,0.5\n0.5,0,1,0,0,1,0.4\n1,0,1,0,0,1,\n1,0,1,1,0,1,0.3\n";
    brdffit_io_options *io = NEW(brdffit_io_options);
    brdffit_samples *copy = NEW(brdffit_samples);
    const brdffit_result *result;
    brdffit_table *table;
    brdffit_error error;

    brdffit_io_options_init(io);
    io->format = BRDFFIT_IO_FORMAT_CSV;
    check("read", brdffit_io_read_memory(text, sizeof text - 1, io, &table, &error), &error);
    *copy = *table->samples;
    printf("%zu %zu %zu %zu %s\n", copy->count, table->dropped[BRDFFIT_IO_DROP_ABSENT], table->rows, table->lines[1],
           table->channel_names[0]);
    check("fit of a copy", brdffit_fit_new(copy, NULL, &result, &error), &error);
    print_result(result);
    brdffit_result_free(result);
    brdffit_io_free(table);
}

int main(void)
{
    brdffit_samples *samples = NEW(brdffit_samples);
    brdffit_options *options = NEW(brdffit_options);

    make_samples(samples);
    fit(samples, options);
    sums(samples, options);
    map(samples, 1);
    map(samples, 2);
    verify(samples);
    file();
    check_guards("the end");
    while (guards > 0) {
        free(guarded[--guards].block);
    }
    return 0;
}
