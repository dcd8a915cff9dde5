/* terms_report.c: F0 and the diffuse term's coefficients as tables, a channel
 * a row. SPDX-License-Identifier: MIT */
#include "terms.h"

#include <math.h>
#include <stdio.h>

#include "lobes.h"
#include "report.h"
#include "words.h"

#define NUMBER_WIDTH 12
#define INDEX_WIDTH 9
#define MOST_CHANNEL 12

static int channel_width(struct cli_style style, const struct cli_job *job)
{
    const int wanted = brdffit_cli_channel_width(style, job->table);
    return wanted > MOST_CHANNEL ? MOST_CHANNEL : wanted;
}

static void begin(struct cli_text *text, struct cli_style style, int width)
{
    brdffit_cli_text_puts(text, "\n  ");
    brdffit_cli_cell(text, style, "channel", -width);
}

static void begin_row(struct cli_text *text, struct cli_style style, const struct cli_job *job, size_t k, int width)
{
    brdffit_cli_text_puts(text, "\n  ");
    brdffit_cli_channel_cell(text, style, job->table, k, width);
}

/* A number, or a dash where there is none. */
static void cell_or_dash(struct cli_text *text, struct cli_style style, double value, int width)
{
    if (isfinite(value)) {
        brdffit_cli_number_cell(text, value, 4, width);
    } else {
        brdffit_cli_cell(text, style, brdffit_cli_glyph(style, CLI_DASH), width);
    }
}

/* A lobe that a channel does not use has neither. */
static void f0_cells(struct cli_text *text, struct cli_style style, const brdffit_model *model, size_t at)
{
    const int used = model->y[at] > 0;
    const double f0 = model->f0[at];
    cell_or_dash(text, style, used ? f0 : NAN, NUMBER_WIDTH);
    if (used && !(f0 < 1)) {
        brdffit_cli_cell(text, style, "metal", INDEX_WIDTH);
    } else {
        cell_or_dash(text, style, used ? brdffit_cli_ior(f0) : NAN, INDEX_WIDTH);
    }
}

static void f0_table(struct cli_text *text, struct cli_style style, const struct cli_job *job)
{
    const brdffit_model *const model = job->result->model;
    const int width = channel_width(style, job);
    const size_t lobes = (size_t)model->lobes;
    begin(text, style, width);
    for (size_t p = 0; p < lobes; p++) {
        char title[32];
        (void)snprintf(title, sizeof title, "lobe %zu F0", p + 1);
        brdffit_cli_cell(text, style, title, NUMBER_WIDTH);
        brdffit_cli_cell(text, style, "index n", INDEX_WIDTH);
    }
    for (size_t k = 0; k < model->channels; k++) {
        begin_row(text, style, job, k, width);
        for (size_t p = 0; p < lobes; p++) {
            f0_cells(text, style, model, k * lobes + p);
        }
    }
    brdffit_cli_text_puts(text, "\n");
}

static void diffuse_cells(struct cli_text *text, struct cli_style style, const brdffit_model *model, size_t k)
{
    const size_t more = brdffit_cli_more_columns(model->diffuse);
    const double x = model->x[k], *const next = model->x_more + k * more;
    brdffit_cli_number_cell(text, x, 5, NUMBER_WIDTH);
    for (size_t j = 0; j < more; j++) {
        brdffit_cli_number_cell(text, next[j], 5, NUMBER_WIDTH);
    }
    if (model->diffuse == BRDFFIT_DIFFUSE_OREN_NAYAR) {
        cell_or_dash(text, style, brdffit_cli_oren_nayar_roughness(x, next[0]), NUMBER_WIDTH);
    } else {
        cell_or_dash(text, style, x > 0 ? next[0] / x : NAN, NUMBER_WIDTH);
        cell_or_dash(text, style, x > 0 ? sqrt(next[1] / x) : NAN, NUMBER_WIDTH);
    }
}

static void diffuse_table(struct cli_text *text, struct cli_style style, const struct cli_job *job)
{
    static const char *const oren_nayar[] = {"x A", "x B", "roughness", NULL};
    static const char *const burley[] = {"x", "x r", "x r^2", "r by x r", "r by x r^2", NULL};
    const brdffit_model *const model = job->result->model;
    const int width = channel_width(style, job);
    begin(text, style, width);
    for (const char *const *name = model->diffuse == BRDFFIT_DIFFUSE_OREN_NAYAR ? oren_nayar : burley; *name; name++) {
        brdffit_cli_cell(text, style, *name, NUMBER_WIDTH);
    }
    for (size_t k = 0; k < model->channels; k++) {
        begin_row(text, style, job, k, width);
        diffuse_cells(text, style, model, k);
    }
    brdffit_cli_text_puts(text, "\n");
}

/* Along the tangent and across it: sigma, or the exponent where that is the lobe's parameter. */
static void roughness_table(struct cli_text *text, struct cli_style style, const brdffit_result *result)
{
    brdffit_cli_text_puts(text, "\n  lobe");
    brdffit_cli_cell(text, style, "along", NUMBER_WIDTH);
    brdffit_cli_cell(text, style, "across", NUMBER_WIDTH);
    brdffit_cli_cell(text, style, "ratio", NUMBER_WIDTH);
    brdffit_cli_cell(text, style, "tangent at", NUMBER_WIDTH);
    for (int p = 0; p < result->model->lobes; p++) {
        const brdffit_lobe *const lobe = result->lobe[p];
        const int by = brdffit_cli_by_exponent(result->model->distributions[p]);
        brdffit_cli_text_printf(text, "\n  %-4d", p + 1);
        if (result->model->anisotropy[p] == 1 && p > 0) {
            brdffit_cli_text_puts(text, "   isotropic");
            continue;
        }
        brdffit_cli_number_cell(text, by ? 1 / (lobe->sigma_x * lobe->sigma_x) : lobe->sigma_x, 6, NUMBER_WIDTH);
        brdffit_cli_number_cell(text, by ? 1 / (lobe->sigma_y * lobe->sigma_y) : lobe->sigma_y, 6, NUMBER_WIDTH);
        brdffit_cli_number_cell(text, result->model->anisotropy[p], 4, NUMBER_WIDTH);
        brdffit_cli_number_cell(text, lobe->tangent_angle, 4, NUMBER_WIDTH);
        brdffit_cli_text_puts(text, " deg");
    }
    brdffit_cli_text_puts(text, "\n");
}

void brdffit_cli_terms_report(struct cli_text *text, struct cli_style style, const struct cli_job *job)
{
    const brdffit_model *const model = job->result->model;
    if (model->anisotropy != NULL) {
        roughness_table(text, style, job->result);
    }
    if (model->fresnel != BRDFFIT_FRESNEL_NONE) {
        f0_table(text, style, job);
    }
    if (brdffit_cli_more_columns(model->diffuse) > 0) {
        diffuse_table(text, style, job);
    }
}

/* F0 of an interval wider than this is as good as not told. */
#define WIDE 0.5

/* The widest interval of a lobe over the channels that use it; 0 when all are told. */
static int widest(const struct cli_job *job, size_t p, double ends[2])
{
    const brdffit_model *const model = job->result->model;
    const size_t lobes = (size_t)model->lobes;
    ends[0] = ends[1] = 0;
    for (size_t k = 0; k < model->channels; k++) {
        const double low = job->f0_low[k * lobes + p], high = job->f0_high[k * lobes + p];
        if (model->y[k * lobes + p] > 0 && high - low > ends[1] - ends[0]) {
            ends[0] = low;
            ends[1] = high;
        }
    }
    return ends[1] - ends[0] > WIDE;
}

/* E^2 that a slight stretch would take off is worth a word from this part on. */
#define AZIMUTH_MATTERS 0.25

static void azimuth_warning(struct cli_text *text, struct cli_style style, const struct cli_job *job)
{
    struct cli_text words = {0};
    if (job->azimuth < AZIMUTH_MATTERS) {
        return;
    }
    brdffit_cli_text_printf(
        &words,
        "the values vary with the azimuth of the half vector, as an isotropic model cannot: a slight "
        "stretch of a lobe would take\t%.0f %% off E%s. '--anisotropic' fits two roughnesses.",
        100 * job->azimuth, brdffit_cli_glyph(style, CLI_SQUARED));
    brdffit_cli_paragraph(text, style, CLI_YELLOW, "Warning,", brdffit_cli_text_string(&words));
    text->failed |= words.failed;
    brdffit_cli_text_free(&words);
}

void brdffit_cli_terms_warnings(struct cli_text *text, struct cli_style style, const struct cli_job *job)
{
    azimuth_warning(text, style, job);
    for (int p = 0; job->f0_low != NULL && p < job->result->model->lobes; p++) {
        struct cli_text words = {0};
        double ends[2];
        if (widest(job, (size_t)p, ends)) {
            brdffit_cli_text_printf(&words,
                                    "lobe %d: F0 is not identified by these directions: anything in [%.2g,\t%.2g] fits"
                                    " within two standard errors, and the index n means nothing.",
                                    p + 1, ends[0], ends[1]);
            brdffit_cli_paragraph(text, style, CLI_YELLOW, "Warning,", brdffit_cli_text_string(&words));
        }
        text->failed |= words.failed;
        brdffit_cli_text_free(&words);
    }
}
