/*
 * Every public function in every floating-point environment: the same bits, and the caller's environment is there again.
 * The list of functions is read from the headers, so that a new one is missed here and not forgotten.
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "brdffit_io.h"
#include "environments.h"
#include "support.h"

/* ---- What is remembered ----------------------------------------------------------------------------------------- */

struct record {
    unsigned char *bytes;
    size_t size, capacity;
};

static struct record now;
static size_t mode;

static char called[128][64];
static size_t calls;

static void mark(const char *name)
{
    size_t i;

    for (i = 0; i < calls; i++) {
        if (strcmp(called[i], name) == 0) {
            return;
        }
    }
    assert_true(calls < sizeof called / sizeof *called && strlen(name) < sizeof *called);
    strcpy(called[calls++], name);
}

static void keep(const void *data, size_t size)
{
    if (now.size + size > now.capacity) {
        now.capacity = 2 * (now.size + size);
        now.bytes = realloc(now.bytes, now.capacity);
        assert_non_null(now.bytes);
    }
    memcpy(now.bytes + now.size, data, size);
    now.size += size;
}

/* A call in the environment of the moment; what it returns is remembered. */
#define VALUE(type, function, ...)                                                                                     \
    do {                                                                                                               \
        type got_;                                                                                                     \
                                                                                                                       \
        mark(#function);                                                                                               \
        leave_tests(mode);                                                                                             \
        got_ = function(__VA_ARGS__);                                                                                  \
        back_to_tests(mode);                                                                                           \
        keep(&got_, sizeof got_);                                                                                      \
    } while (0)

#define STATUS(function, ...)                                                                                          \
    do {                                                                                                               \
        brdffit_status got_;                                                                                           \
                                                                                                                       \
        mark(#function);                                                                                               \
        leave_tests(mode);                                                                                             \
        got_ = function(__VA_ARGS__);                                                                                  \
        back_to_tests(mode);                                                                                           \
        keep(&got_, sizeof got_);                                                                                      \
        if (got_ != BRDFFIT_OK) {                                                                                      \
            fail_msg("%s in environment %#x: %s", #function, modes[mode], brdffit_status_string(got_));                \
        }                                                                                                              \
    } while (0)

#define VOID(function, ...)                                                                                            \
    do {                                                                                                               \
        mark(#function);                                                                                               \
        leave_tests(mode);                                                                                             \
        function(__VA_ARGS__);                                                                                         \
        back_to_tests(mode);                                                                                           \
    } while (0)

#define STRING(function, ...)                                                                                          \
    do {                                                                                                               \
        const char *got_;                                                                                              \
                                                                                                                       \
        mark(#function);                                                                                               \
        leave_tests(mode);                                                                                             \
        got_ = function(__VA_ARGS__);                                                                                  \
        back_to_tests(mode);                                                                                           \
        keep(got_, strlen(got_));                                                                                      \
    } while (0)

static void keep_result(const brdffit_result *r)
{
    const size_t lobes = (size_t)r->model->lobes, channels = r->model->channels;
    const double numbers[] = {r->rms_total,      r->e2,          r->e2_error,   r->lower_bound, r->gap,
                              r->sum_of_squares, r->sigma_floor, r->sigma_tail, r->kkt_residual};

    keep(numbers, sizeof numbers);
    keep(&r->stop, sizeof r->stop);
    keep(&r->boxes, sizeof r->boxes);
    keep(r->model->sigma, lobes * sizeof(double));
    keep(r->model->x, channels * sizeof(double));
    keep(r->model->y, channels * lobes * sizeof(double));
    keep(r->rms, channels * sizeof(double));
}

/* ---- The calls -------------------------------------------------------------------------------------------------- */

#define SAMPLES 84
#define CHANNELS 3

/* Subnormal gaps, which are > 0 even where DAZ says that they are not. */
static brdffit_options small_options(void)
{
    brdffit_options o;

    VOID(brdffit_options_init_sized, &o, sizeof o);
    o.relative_gap = 1e-310;
    o.absolute_gap = 1e-311;
    o.box_budget = 60;
    return o;
}

static void call_strings(void)
{
    {
        const char *version;

        mark("brdffit_version");
        leave_tests(mode);
        version = brdffit_version();
        back_to_tests(mode);
        keep(version, strlen(version));
    }
    STRING(brdffit_status_string, BRDFFIT_ERR_VALUE);
    STRING(brdffit_skip_string, BRDFFIT_SKIP_INCIDENCE);
    STRING(brdffit_weighting_string, BRDFFIT_WEIGHTING_RELATIVE);
    STRING(brdffit_distribution_string, BRDFFIT_GGX);
    STRING(brdffit_distribution_title, BRDFFIT_GGX);
    STRING(brdffit_parameter_string, BRDFFIT_GGX);
    STRING(brdffit_fresnel_string, BRDFFIT_FRESNEL_SCHLICK);
    STRING(brdffit_masking_string, BRDFFIT_MASKING_SMITH);
    STRING(brdffit_diffuse_string, BRDFFIT_DIFFUSE_BURLEY);
    VALUE(int, brdffit_diffuse_columns, BRDFFIT_DIFFUSE_BURLEY);
    STRING(brdffit_norm_string, BRDFFIT_NORM_L1);
    STRING(brdffit_engine_string, BRDFFIT_ENGINE_SOCP);
    STRING(brdffit_isa_string, BRDFFIT_ISA_BASE);
    STRING(brdffit_stop_string, BRDFFIT_STOP_CONTRADICTION);
    STRING(brdffit_texel_status_string, BRDFFIT_TEXEL_OPEN);
    STRING(brdffit_io_drop_string, (brdffit_io_drop)0);
    {
        const char *what = NULL, *words = brdffit_io_column_words(0, &what);

        mark("brdffit_io_column_words");
        keep(what, strlen(what));
        keep(words, strlen(words));
    }
    VALUE(int, brdffit_isa_supported, BRDFFIT_ISA_BASE);
}

static void call_fits(const brdffit_samples *samples)
{
    brdffit_options o = small_options();
    size_t size = brdffit_workspace_size(SAMPLES, CHANNELS, &o), used, skipped[BRDFFIT_SKIP_COUNT];
    void *workspace = malloc(size);
    const brdffit_result *r;
    double out[SAMPLES * CHANNELS];
    brdffit_samples blank;
    brdffit_model model;

    VOID(brdffit_samples_init_sized, &blank, sizeof blank);
    keep(&blank, sizeof blank);
    VOID(brdffit_model_init_sized, &model, sizeof model);
    keep(&model, sizeof model);
    VALUE(size_t, brdffit_workspace_size, SAMPLES, CHANNELS, &o);
    STATUS(brdffit_inspect, samples, &o, &used, skipped, BRDFFIT_SKIP_COUNT, NULL);
    keep(skipped, sizeof skipped);
    STATUS(brdffit_fit, samples, &o, workspace, size, &r, NULL);
    keep_result(r);
    STATUS(brdffit_eval, r->model, samples, out, NULL);
    keep(out, sizeof out);
    {
        double r2[CHANNELS], total[3];
        unsigned misfit = 0;

        STATUS(brdffit_quality, samples, &o, out, r2, total, &misfit, NULL);
        keep(r2, sizeof r2);
        keep(total, sizeof total);
        keep(&misfit, sizeof misfit);
    }
    {
        double share = 0.0;

        STATUS(brdffit_azimuth_share, samples, &o, r->model, r->channel_scale, &share, NULL);
        keep(&share, sizeof share);
    }
    {
        brdffit_options fresnel = o;
        double low[CHANNELS * BRDFFIT_MAX_LOBES] = {0.0}, high[CHANNELS * BRDFFIT_MAX_LOBES] = {0.0};
        const brdffit_result *schlick;

        fresnel.fresnel = BRDFFIT_FRESNEL_SCHLICK;
        if (brdffit_fit_new(samples, &fresnel, &schlick, NULL) == BRDFFIT_OK) {
            STATUS(brdffit_f0_interval, samples, &fresnel, schlick->model, low, high, NULL);
            brdffit_result_free(schlick);
        }
        keep(low, sizeof low);
        keep(high, sizeof high);
    }
#ifndef BRDFFIT_NO_ECOS
    {
        brdffit_options cones = o;
        const brdffit_verification *proof;
        double level = 0.2 * r->lower_bound;

        cones.engine = BRDFFIT_ENGINE_SOCP;
        free(workspace);
        size = brdffit_workspace_size(SAMPLES, CHANNELS, &cones);
        workspace = malloc(size);
        STATUS(brdffit_verify, samples, &o, level, workspace, size, &proof, NULL);
        keep(&proof->unproven, sizeof proof->unproven);
        keep(&proof->boxes, sizeof proof->boxes);
    }
#else
    mark("brdffit_verify"); /* BRDFFIT_ERR_UNSUPPORTED */
#endif
    STATUS(brdffit_fit_new, samples, &o, &r, NULL);
    keep_result(r);
    VOID(brdffit_result_free, r);
    free(workspace);
}

static void call_intervals(const brdffit_samples *samples)
{
    brdffit_options o = small_options();
    const size_t size = brdffit_intervals_workspace_size(SAMPLES, CHANNELS, &o);
    void *workspace = malloc(size);
    const brdffit_interval_result *found;
    brdffit_interval_options asked;
    const brdffit_result *r;

    assert_int_equal(brdffit_fit_new(samples, &o, &r, NULL), BRDFFIT_OK);
    VOID(brdffit_interval_options_init_sized, &asked, sizeof asked);
    keep(&asked, sizeof asked);
    asked.eta = 0.1;
    asked.box_budget = 300;
    VALUE(size_t, brdffit_intervals_workspace_size, SAMPLES, CHANNELS, &o);
    STATUS(brdffit_intervals, samples, &o, r->model, r->e2, &asked, workspace, size, &found, NULL);
    keep(found->sigma, (size_t)found->lobes * sizeof *found->sigma);
    keep(found->x, CHANNELS * sizeof *found->x);
    keep(found->y, CHANNELS * (size_t)found->lobes * sizeof *found->y);
    brdffit_result_free(r);
    free(workspace);
}

static void call_weights(const brdffit_samples *samples)
{
    const size_t size = brdffit_weights_size(SAMPLES, CHANNELS, BRDFFIT_WEIGHTING_SOLID_ANGLE);
    void *memory = malloc(size);
    double out[SAMPLES];

    VALUE(size_t, brdffit_weights_size, SAMPLES, CHANNELS, BRDFFIT_WEIGHTING_RELATIVE);
    STATUS(brdffit_weights, samples, BRDFFIT_WEIGHTING_SOLID_ANGLE, 0, memory, size, out, NULL);
    keep(out, sizeof out);
    VALUE(double, brdffit_weights_effective, out, SAMPLES);
    VALUE(int, brdffit_weights_crowded, samples, out, memory, size);
    STATUS(brdffit_weights, samples, BRDFFIT_WEIGHTING_RELATIVE, 0.1, memory, size, out, NULL);
    keep(out, sizeof out);
    free(memory);
}

static void call_maps(const brdffit_samples *samples)
{
    brdffit_options o = small_options();
    brdffit_many_stats stats;
    brdffit_texels texels;
    brdffit_texel_results to;
    const brdffit_plan *plan;
    double numbers[6 * CHANNELS];
    void *memory, *work;
    size_t size;

    o.relative_gap = 1e-3;
    o.box_budget = 2000; /* the fast path */
    VALUE(size_t, brdffit_plan_size, samples, &o);
    size = brdffit_plan_size(samples, &o);
    memory = malloc(size);
    STATUS(brdffit_plan_init, samples, &o, memory, size, &plan, NULL);
    VALUE(size_t, brdffit_many_workspace_size, plan);
    size = brdffit_many_workspace_size(plan);
    work = malloc(size);
    VOID(brdffit_texels_init_sized, &texels, sizeof texels, plan);
    texels.count = 1;
    texels.values = samples->values;
    VOID(brdffit_texel_results_init_sized, &to, sizeof to);
    memset(numbers, 0, sizeof numbers);
    to.sigma = numbers;
    to.e2 = numbers + 1;
    to.lower_bound = numbers + 2;
    to.sum_of_squares = numbers + 3;
    to.sigma_floor = numbers + 4;
    to.x = numbers + CHANNELS + 2;
    to.y = numbers + 2 * CHANNELS + 2;
    to.channel_scale = numbers + 3 * CHANNELS + 2;
    VOID(brdffit_many_stats_init_sized, &stats, sizeof stats);
    STATUS(brdffit_fit_many, plan, &texels, &to, work, size, &stats, NULL);
    assert_int_equal(stats.certified, 1);
    keep(numbers, sizeof numbers);
    keep(&stats, sizeof stats);
    free(work);
    free(memory);
}

/* A row of 2 x 2 cells. */
static void call_row(brdffit_sums *sums)
{
    static const double sine[2] = {0.1, 0.5}, cosine[2] = {0.99498743710662, 0.86602540378444},
                        azimuth[2] = {0.3, -0.2};
    static const double entries[3][4] = {{0.5, 0.25, 4e-320, 1.0}, {1.0, 0.1, 0.2, 0.3}, {0.1, 0.2, 0.3, 0.4}};
    static const double scale[3] = {1.0, 2.0, 3.0};
    const void *const channels[3] = {entries[0], entries[1], entries[2]};
    size_t cells[BRDFFIT_CELL_COUNT] = {0};
    brdffit_row row;

    VOID(brdffit_row_init_sized, &row, sizeof row);
    row.differences = row.azimuths = 2;
    row.sin_half = 0.1;
    row.cos_half = 0.99498743710662;
    row.sin_difference = sine;
    row.cos_difference = cosine;
    row.cos_azimuth = azimuth;
    row.entries = channels;
    row.scale = scale;
    STATUS(brdffit_sums_add_row, sums, &row, cells, NULL);
    keep(cells, sizeof cells);
}

static void call_sums(const brdffit_samples *samples)
{
    brdffit_options o = small_options();
    size_t size = brdffit_sums_size(CHANNELS, 600), used, skipped[BRDFFIT_SKIP_COUNT], k;
    void *memory = malloc(size), *workspace;
    brdffit_sums *sums;
    const brdffit_result *r;
    int binned;

    VALUE(size_t, brdffit_sums_size, CHANNELS, 600);
    for (binned = 0; binned < 2; binned++) {
        STATUS(brdffit_sums_init, memory, size, CHANNELS, 600, &o, &sums, NULL);
        if (binned) {
            STATUS(brdffit_sums_bins, sums, 6, NULL);
        } else {
            call_row(sums);
        }
        STATUS(brdffit_sums_add, sums, samples, NULL);
        VOID(brdffit_sums_count, sums, &used, skipped, BRDFFIT_SKIP_COUNT);
        keep(&used, sizeof used);
        for (k = 0; k < CHANNELS; k++) {
            VALUE(double, brdffit_sums_largest, sums, k);
        }
        VALUE(size_t, brdffit_sums_workspace_size, sums, &o);
        used = brdffit_sums_workspace_size(sums, &o);
        workspace = malloc(used);
        STATUS(brdffit_fit_sums, sums, &o, workspace, used, &r, NULL);
        keep_result(r);
        free(workspace);
    }
    free(memory);
}

static const char text[] = "theta_i,phi_i,theta_o,phi_o,weight,r\n"
                           "10.1,33.3,20.7,200,0.1,1.1\n"
                           "41.3,1e-3,7.77,12,1e-310,123456789012345678901234567890e-31\n"
                           "0.3,359.9,59.999999999999,180,3e-5,1.00000000000000011102230246251565\n";

static void keep_table(const brdffit_table *table)
{
    keep(table->samples->light, 3 * table->samples->count * sizeof(double));
    keep(table->samples->values, table->samples->count * sizeof(double));
    keep(table->samples->weights, table->samples->count * sizeof(double));
}

static void call_tables(void)
{
    brdffit_options o = small_options();
    double light[SAMPLES * 3], view[SAMPLES * 3];
    brdffit_io_options io;
    brdffit_table *table;
    char path[64];
    FILE *file;

    VOID(brdffit_io_options_init_sized, &io, sizeof io);
    VOID(brdffit_io_protocol84, light, view);
    keep(light, sizeof light);
    STATUS(brdffit_io_read_memory, text, sizeof text - 1, NULL, &table, NULL);
    keep_table(table);
    STATUS(brdffit_io_samples, table, NULL);
    VOID(brdffit_io_free, table);
    STATUS(brdffit_io_read_sums_memory, text, sizeof text - 1, NULL, &o, &table, NULL);
    brdffit_io_free(table);
    (void)snprintf(path, sizeof path, "build/every_function.csv");
    file = fopen(path, "wb");
    if (!file) {
        print_message("no file can be written here: two functions are not called\n");
        mark("brdffit_io_read");
        mark("brdffit_io_read_sums");
        mark("brdffit_io_array_open");
        return;
    }
    fputs(text, file);
    fclose(file);
    STATUS(brdffit_io_read, path, &io, &table, NULL);
    keep_table(table);
    brdffit_io_free(table);
    STATUS(brdffit_io_read_sums, path, &io, &o, &table, NULL);
    brdffit_io_free(table);
    remove(path);
}

static int write_zip(void *user, const void *data, size_t size)
{
    (void)user;
    keep(data, size);
    return 0;
}

static void call_arrays(void)
{
    static const double values[4] = {1.5, 4e-320, 1e300, -0.1};
    static const size_t shape[1] = {4}, start[1] = {0};
    unsigned char bytes[BRDFFIT_IO_HEADER_MAX + sizeof values];
    unsigned char header[BRDFFIT_IO_HEADER_MAX];
    brdffit_array *array;
    double out[4];
    brdffit_io_zip *zip;
    size_t size = brdffit_io_npy_header('f', 8, 1, shape, bytes);
    FILE *file;

    VALUE(size_t, brdffit_io_npy_header, 'f', 8, 1, shape, header);
    VALUE(size_t, brdffit_io_pfm_header, 4, 3, 1, header);
    VALUE(unsigned long, brdffit_io_crc32, 0, values, sizeof values);
    memcpy(bytes + size, values, sizeof values);
    STATUS(brdffit_io_array_open_memory, bytes, size + sizeof values, NULL, &array, NULL);
    STATUS(brdffit_io_array_read, array, start, shape, out, NULL);
    keep(out, sizeof out);
    VOID(brdffit_io_array_close, array);
    file = fopen("build/every_function.npy", "wb");
    if (file) {
        fwrite(bytes, 1, size + sizeof values, file);
        fclose(file);
        STATUS(brdffit_io_array_open, "build/every_function.npy", NULL, &array, NULL);
        brdffit_io_array_close(array);
        remove("build/every_function.npy");
    }
    mark("brdffit_io_zip_new");
    leave_tests(mode);
    zip = brdffit_io_zip_new(write_zip, NULL);
    back_to_tests(mode);
    STATUS(brdffit_io_zip_begin, zip, "a.npy", sizeof values, brdffit_io_crc32(0, values, sizeof values));
    STATUS(brdffit_io_zip_write, zip, values, sizeof values);
    STATUS(brdffit_io_zip_finish, zip, 0);
}

static void call_all(const brdffit_samples *samples)
{
    now.size = 0;
    call_strings();
    call_fits(samples);
    call_intervals(samples);
    call_weights(samples);
    call_maps(samples);
    call_sums(samples);
    call_tables();
    call_arrays();
}

static void test_same_bits(void **state)
{
    struct brdffit_test_spec spec = brdffit_test_spec_default();
    struct brdffit_test_data data;
    struct record first = {NULL, 0, 0};

    (void)state;
    spec.noise = 0.02;
    brdffit_test_data_new(&spec, &data);
    assert_true(data.samples.count == SAMPLES && data.samples.channels == CHANNELS);
    data.values[7] = 4e-320;
    for (mode = 0; mode < MODES; mode++) {
        call_all(&data.samples);
        if (mode == 0) {
            first = now;
            memset(&now, 0, sizeof now);
        } else if (now.size != first.size || memcmp(now.bytes, first.bytes, now.size)) {
            size_t i = 0;

            while (i < now.size && i < first.size && now.bytes[i] == first.bytes[i]) {
                i++;
            }
            fail_msg("environment %#x: other bits from byte %zu of %zu on", modes[mode], i, first.size);
        }
    }
    free(first.bytes);
    free(now.bytes);
    brdffit_test_data_free(&data);
}

/* ---- Nothing is left out ---------------------------------------------------------------------------------------- */

/* Names in a header of functions that it declares: "brdffit_x(" on a line after BRDFFIT_API, up to the semicolon. */
static size_t missed_of(const char *path)
{
    char line[512];
    size_t missed = 0, i;
    FILE *file = fopen(path, "rb");
    int declared = 0;

    if (!file) {
        print_message("%s is not here: the list of functions was not compared\n", path);
        skip();
    }
    while (fgets(line, sizeof line, file)) {
        const char *at = strncmp(line, "BRDFFIT_API ", 12) == 0 || declared ? strstr(line, "brdffit_") : NULL;
        char name[64];

        declared = strncmp(line, "BRDFFIT_API ", 12) == 0;
        while (at && !(strchr(at, '(') && strcspn(at, " *,;") > strcspn(at, "("))) {
            at = strstr(at + 1, "brdffit_");
        }
        if (!at) {
            continue;
        }
        declared = 0;
        i = strcspn(at, "(");
        assert_true(i < sizeof name);
        memcpy(name, at, i);
        name[i] = '\0';
        for (i = 0; i < calls && strcmp(called[i], name); i++) {
        }
        if (i == calls) {
            print_error("%s is declared in %s, and not called by this test\n", name, path);
            missed++;
        }
    }
    fclose(file);
    return missed;
}

static void test_every_function(void **state)
{
    (void)state;
    assert_true(calls > 30);
    assert_int_equal(missed_of("include/brdffit.h") + missed_of("include/brdffit_io.h"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_every_function),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
