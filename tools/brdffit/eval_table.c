/* eval_table.c: a fit beside the measurements. Directions are written the
 * way people give them: angles in degrees when the normal is +z, vectors
 * otherwise, half and difference angles for a MERL table, a, b, c as they are.
 * SPDX-License-Identifier: MIT */
#include "eval_table.h"

#include <math.h>
#include <string.h>

#include "sample.h"

/* Written in blocks: a full MERL table has 1.4 million rows. */
#define BLOCK 65536

static double degrees(double radians)
{
    return radians * (180 / 3.14159265358979323846);
}

void brdffit_cli_match_channels(struct cli_comparison *comparison)
{
    const struct cli_fit *const fit = comparison->fit;
    const brdffit_table *const table = comparison->table;
    const size_t channels = table->samples->channels;
    comparison->complete = 1;
    for (size_t k = 0; k < fit->model.channels; k++) {
        size_t column = BRDFFIT_NONE;
        if (fit->names == NULL) {
            column = channels == fit->model.channels ? k : BRDFFIT_NONE;
        } else {
            for (size_t j = 0; j < channels && column == BRDFFIT_NONE; j++) {
                if (strcmp(table->channel_names[j], fit->names[k]) == 0) {
                    column = j;
                }
            }
        }
        comparison->measured[k] = column;
        comparison->complete &= column != BRDFFIT_NONE;
    }
}

/* ---- CSV --------------------------------------------------------------- */

/* A header field; quoted when it needs to be. */
static void header_field(struct cli_text *text, const char *name, const char *suffix)
{
    const int plain = strpbrk(name, ",;\t\"\r\n") == NULL;
    brdffit_cli_text_puts(text, plain ? "," : ",\"");
    for (; *name; name++) {
        if (*name == '"') {
            brdffit_cli_text_puts(text, "\"");
        }
        brdffit_cli_text_add(text, name, 1);
    }
    brdffit_cli_text_puts(text, suffix);
    if (!plain) {
        brdffit_cli_text_puts(text, "\"");
    }
}

static void header(struct cli_text *text, const struct cli_comparison *c)
{
    const brdffit_samples *const samples = c->table->samples;
    if (samples->form == BRDFFIT_FORM_COEFFICIENTS) {
        brdffit_cli_text_puts(text, "a,b,c");
    } else if (samples->form == BRDFFIT_FORM_ANGLES) {
        brdffit_cli_text_puts(text, "theta_h,theta_d,theta_i,theta_o");
    } else if (samples->normal == NULL) {
        brdffit_cli_text_puts(text, "theta_i,phi_i,theta_o,phi_o");
    } else {
        brdffit_cli_text_puts(text, "lx,ly,lz,vx,vy,vz,nx,ny,nz");
    }
    for (size_t k = 0; k < c->fit->model.channels; k++) {
        char number[32];
        (void)snprintf(number, sizeof number, "channel%zu", k + 1);
        const size_t column = c->measured[k];
        const char *name = c->fit->names != NULL    ? c->fit->names[k]
                           : column != BRDFFIT_NONE ? c->table->channel_names[column]
                                                    : number;
        header_field(text, name, "_fit");
        if (column != BRDFFIT_NONE) {
            header_field(text, name, "_measured");
            header_field(text, name, "_residual");
        }
    }
    brdffit_cli_text_puts(text, "\n");
}

/* Twelve digits: 1e-12 degrees is far below what any instrument resolves,
 * and 30 degrees read "30". */
static void angle(struct cli_text *text, const char *separator, double radians)
{
    double shown = degrees(radians);
    if (!(fabs(shown) >= 1e-10)) {
        shown = 0;
    }
    brdffit_cli_text_printf(text, "%s%.12g", separator, shown);
}

static void polar(struct cli_text *text, const char *separator, const double *v)
{
    const double around = atan2(v[1], v[0]);
    angle(text, separator, atan2(hypot(v[0], v[1]), v[2]));
    angle(text, ",", around < -1e-12 ? around + 2 * 3.14159265358979323846 : around);
}

static void vector(struct cli_text *text, const char *separator, const double *v)
{
    brdffit_cli_text_printf(text, "%s%.17g,%.17g,%.17g", separator, v[0], v[1], v[2]);
}

static void directions(struct cli_text *text, const brdffit_samples *s, size_t i)
{
    if (s->form == BRDFFIT_FORM_COEFFICIENTS) {
        brdffit_cli_text_printf(text, "%.17g,%.17g,%.17g", s->a[i], s->b[i], s->c[i]);
    } else if (s->form == BRDFFIT_FORM_ANGLES) {
        angle(text, "", atan(sqrt(s->tan2_half[i])));
        angle(text, ",", acos(s->cos_difference[i]));
        angle(text, ",", acos(s->cos_light[i]));
        angle(text, ",", acos(s->cos_view[i]));
    } else if (s->normal == NULL) {
        polar(text, "", s->light + 3 * i);
        polar(text, ",", s->view + 3 * i);
    } else {
        vector(text, "", s->light + 3 * i);
        vector(text, ",", s->view + 3 * i);
        vector(text, ",", s->normal + 3 * i);
    }
}

int brdffit_cli_eval_rows(const struct cli_comparison *c, struct cli_output *output)
{
    const brdffit_samples *const samples = c->table->samples;
    const size_t channels = c->fit->model.channels;
    struct cli_text text = {0};
    int failed = 0;
    header(&text, c);
    for (size_t i = 0; i < samples->count && !failed; i++) {
        directions(&text, samples, i);
        for (size_t k = 0; k < channels; k++) {
            const double fitted = c->fitted[i * channels + k];
            brdffit_cli_text_printf(&text, ",%.17g", fitted);
            if (c->measured[k] == BRDFFIT_NONE) {
                continue;
            }
            const double value = samples->values[i * samples->channels + c->measured[k]];
            brdffit_cli_text_printf(&text, ",%.17g,%.17g", value, value - fitted);
        }
        brdffit_cli_text_puts(&text, "\n");
        if (text.size > BLOCK || text.failed) {
            failed = brdffit_cli_output_add(output, &text);
            brdffit_cli_text_clear(&text);
        }
    }
    failed = failed || brdffit_cli_output_write(output, &text) != 0;
    brdffit_cli_text_free(&text);
    return failed ? -1 : 0;
}

/* ---- Figures ----------------------------------------------------------- */

/* One residual, in the units that were minimised, on top of what there is. */
static double accumulate(brdffit_norm norm, double sum, double weight, double residual)
{
    if (norm == BRDFFIT_NORM_LINF) {
        return fmax(sum, fabs(residual));
    }
    return sum + weight * (norm == BRDFFIT_NORM_L1 ? fabs(residual) : residual * residual);
}

void brdffit_cli_eval_figures(const struct cli_comparison *c, struct cli_figures *figures)
{
    const brdffit_samples *const samples = c->table->samples;
    const size_t channels = c->fit->model.channels;
    brdffit_options options;
    brdffit_options_init(&options);
    options.max_incidence = c->fit->max_incidence;
    double weights = 0;
    figures->e2 = 0;
    figures->data = 0;
    figures->used = 0;
    memset(figures->rms, 0, channels * sizeof *figures->rms);
    for (size_t i = 0; i < samples->count; i++) {
        if (!brdffit_cli_is_used(samples, &options, i)) {
            continue;
        }
        const double weight = brdffit_cli_weight(samples, i);
        const double to_radiance = brdffit_cli_to_radiance(samples, i);
        weights += weight;
        figures->used++;
        for (size_t k = 0; k < channels; k++) {
            const double value = samples->values[i * samples->channels + c->measured[k]];
            const double residual = (value - c->fitted[i * channels + k]) * to_radiance;
            const double scale = c->fit->channel_scale[k];
            figures->rms[k] += weight * residual * residual;
            figures->data = accumulate(c->fit->norm, figures->data, weight, value * to_radiance / scale);
            if (c->fit->norm != BRDFFIT_NORM_L2) {
                figures->e2 = accumulate(c->fit->norm, figures->e2, weight, residual / scale);
            }
        }
    }
    for (size_t k = 0; k < channels; k++) {
        const double scale = c->fit->channel_scale[k];
        if (c->fit->norm == BRDFFIT_NORM_L2) {
            figures->e2 += figures->rms[k] / scale / scale;
        }
        figures->rms[k] = weights > 0 ? sqrt(figures->rms[k] / weights) : 0;
    }
}
