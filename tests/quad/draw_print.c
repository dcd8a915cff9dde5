/*
 * A problem as text, to freeze it. SPDX-License-Identifier: MIT
 */
#include "draw.h"

const char *draw_route_string(enum draw_route route)
{
    static const char *const names[] = {"fit", "sums", "bins", "many"};

    return names[route];
}

static void print_options(const struct draw *d, FILE *to)
{
    const brdffit_options *o = &d->question.options;
    int j;

    fprintf(to, "# route %s", draw_route_string(d->route));
    if (d->route == DRAW_SUMS || d->route == DRAW_BINS) {
        fprintf(to, " (%zu groups, %d bits)", d->groups, d->bits);
    }
    fprintf(to, "; lobes");
    for (j = 0; j < d->question.lobes; j++) {
        fprintf(to, " %s", brdffit_distribution_string(d->question.distribution[j]));
    }
    fprintf(to, "; norm %s; engine %s; fresnel %s; diffuse %s; masking %s; normalise %s; quantity %s\n",
            brdffit_norm_string(o->norm), brdffit_engine_string(o->engine), brdffit_fresnel_string(o->fresnel),
            brdffit_diffuse_string(o->diffuse), brdffit_masking_string(o->masking),
            o->normalise == BRDFFIT_NORMALISE_NONE ? "none" : "max",
            d->samples.quantity == BRDFFIT_QUANTITY_BRDF ? "brdf" : "radiance");
    fprintf(to,
            "# sigma %.17g %.17g; exponent %.17g %.17g; relative_gap %.17g; absolute_gap %.17g; box_budget %zu; "
            "max_incidence %.17g; isa %s\n",
            o->sigma_min, o->sigma_max, o->exponent_min, o->exponent_max, o->relative_gap, o->absolute_gap,
            o->box_budget, o->max_incidence, brdffit_isa_string(o->isa));
}

static void print_array(const char *names, const double *array, size_t i, size_t width, FILE *to, const char *comma)
{
    size_t j;

    if (names) {
        fprintf(to, "%s%s", comma, names);
        return;
    }
    for (j = 0; j < width; j++) {
        fprintf(to, "%s%.17g", j ? "," : comma, array[i * width + j]);
    }
}

/* The header (i = BRDFFIT_NONE) or a sample. */
static void print_line(const struct draw *d, const double *values, size_t i, FILE *to)
{
    const brdffit_samples *s = &d->samples;
    int head = i == BRDFFIT_NONE;
    size_t k;

    if (s->form == BRDFFIT_FORM_DIRECTIONS) {
        print_array(head ? "lx,ly,lz" : NULL, s->light, i, 3, to, "");
        print_array(head ? "vx,vy,vz" : NULL, s->view, i, 3, to, ",");
        if (s->normal) {
            print_array(head ? "nx,ny,nz" : NULL, s->normal, i, 3, to, ",");
        }
    } else if (s->form == BRDFFIT_FORM_ANGLES) {
        print_array(head ? "cos_light" : NULL, s->cos_light, i, 1, to, "");
        print_array(head ? "cos_view" : NULL, s->cos_view, i, 1, to, ",");
        print_array(head ? "tan2_half" : NULL, s->tan2_half, i, 1, to, ",");
        print_array(head ? "cos_difference" : NULL, s->cos_difference, i, 1, to, ",");
    } else {
        print_array(head ? "a" : NULL, s->a, i, 1, to, "");
        print_array(head ? "b" : NULL, s->b, i, 1, to, ",");
        print_array(head ? "c" : NULL, s->c, i, 1, to, ",");
    }
    if (s->weights) {
        print_array(head ? "weight" : NULL, s->weights, i, 1, to, ",");
    }
    for (k = 0; k < s->channels; k++) {
        if (head) {
            fprintf(to, ",c%zu", k);
        } else {
            fprintf(to, ",%.17g", values[i * s->channels + k]);
        }
    }
    fputc('\n', to);
}

void draw_print(const struct draw *d, size_t texel, FILE *to)
{
    const double *values = d->values + texel * d->samples.count * d->samples.channels;
    size_t i;

    print_options(d, to);
    print_line(d, values, BRDFFIT_NONE, to);
    for (i = 0; i < d->samples.count; i++) {
        print_line(d, values, i, to);
    }
}
