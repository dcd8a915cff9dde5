/*
 * A problem as draw_print() wrote it, to try it again. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "draw.h"

#define LINE 1048576 /* 10,000 channels */
#define ROWS 4096
#define WORD 32

/* The words after `name` up to the next semicolon; 0 when there are none. */
static int words_after(const char *line, const char *name, char words[4][WORD])
{
    const char *at = strstr(line, name);
    size_t length;
    int n = 0;

    for (at = at ? at + strlen(name) : ""; n < 4 && *at == ' '; n++, at += length) {
        length = strcspn(++at, " ;\n");
        snprintf(words[n], WORD, "%.*s", (int)length, at);
    }
    return n;
}

/* Which of `count` names this is; 0 when it is none. */
static int find(const char *text, int count, const char *(*name_of)(int))
{
    int i;

    for (i = 0; i < count; i++) {
        if (!strcmp(text, name_of(i))) {
            return i;
        }
    }
    return 0;
}

static const char *distribution_name(int i)
{
    return brdffit_distribution_string((brdffit_distribution)i);
}

static const char *norm_name(int i)
{
    return brdffit_norm_string((brdffit_norm)i);
}

static const char *engine_name(int i)
{
    return brdffit_engine_string((brdffit_engine)i);
}

static const char *fresnel_name(int i)
{
    return brdffit_fresnel_string((brdffit_fresnel)i);
}

static const char *diffuse_name(int i)
{
    return brdffit_diffuse_string((brdffit_diffuse)i);
}

static const char *masking_name(int i)
{
    return brdffit_masking_string((brdffit_masking)i);
}

static const char *isa_name(int i)
{
    return brdffit_isa_string((brdffit_isa)i);
}

static const char *route_name(int i)
{
    return draw_route_string((enum draw_route)i);
}

static void read_names(struct draw *d, const char *line)
{
    brdffit_options *o = &d->question.options;
    char word[4][WORD];
    int j;

    if (words_after(line, "# route", word)) {
        d->route = (enum draw_route)find(word[0], DRAW_MANY + 1, route_name);
    }
    sscanf(strchr(line, '(') ? strchr(line, '(') : "", "(%zu groups, %d bits)", &d->groups, &d->bits);
    d->question.lobes = words_after(line, "; lobes", word);
    d->question.lobes = d->question.lobes < QUAD_LOBES ? d->question.lobes : QUAD_LOBES;
    for (j = 0; j < d->question.lobes; j++) {
        d->question.distribution[j] = (brdffit_distribution)find(word[j], BRDFFIT_DISTRIBUTION_COUNT,
                                                                 distribution_name);
    }
    if (words_after(line, "; norm", word)) {
        o->norm = (brdffit_norm)find(word[0], BRDFFIT_NORM_COUNT, norm_name);
    }
    if (words_after(line, "; engine", word)) {
        o->engine = (brdffit_engine)find(word[0], BRDFFIT_ENGINE_COUNT, engine_name);
    }
    if (words_after(line, "; fresnel", word)) { /* tables from before there was one do not say */
        o->fresnel = (brdffit_fresnel)find(word[0], BRDFFIT_FRESNEL_COUNT, fresnel_name);
        (void)words_after(line, "; diffuse", word);
        o->diffuse = (brdffit_diffuse)find(word[0], BRDFFIT_DIFFUSE_COUNT, diffuse_name);
        (void)words_after(line, "; masking", word);
        o->masking = (brdffit_masking)find(word[0], BRDFFIT_MASKING_COUNT, masking_name);
    }
    o->normalise = strstr(line, "normalise none") ? BRDFFIT_NORMALISE_NONE : BRDFFIT_NORMALISE_MAX;
    d->samples.quantity = strstr(line, "quantity brdf") ? BRDFFIT_QUANTITY_BRDF : BRDFFIT_QUANTITY_RADIANCE;
}

static void read_numbers(struct draw *d, const char *line)
{
    brdffit_options *o = &d->question.options;
    char isa[WORD] = "";

    sscanf(
        line,
        "# sigma %lf %lf; exponent %lf %lf; relative_gap %lf; absolute_gap %lf; box_budget %zu; max_incidence %lf; isa %31s",
        &o->sigma_min, &o->sigma_max, &o->exponent_min, &o->exponent_max, &o->relative_gap, &o->absolute_gap,
        &o->box_budget, &o->max_incidence, isa);
    o->isa = (brdffit_isa)find(isa, BRDFFIT_ISA_COUNT, isa_name);
    o->isa = brdffit_isa_supported(o->isa) ? o->isa : BRDFFIT_ISA_AUTO;
}

/* Numbers of a line, in the order of draw_print(). */
struct target {
    size_t width; /* so many a sample */
    double *array;
};

static size_t columns_of(const char *line)
{
    size_t n = 1;

    for (; *line; line++) {
        n += *line == ',';
    }
    return n;
}

/* Room and form, from the header. */
static void read_header(struct draw *d, const char *line)
{
    brdffit_form form = strstr(line, "lx,")         ? BRDFFIT_FORM_DIRECTIONS
                        : strstr(line, "cos_light") ? BRDFFIT_FORM_ANGLES
                                                    : BRDFFIT_FORM_COEFFICIENTS;
    brdffit_quantity quantity = d->samples.quantity;
    struct fit_question question = d->question;
    int normals = strstr(line, "nx,") != NULL, weights = strstr(line, "weight") != NULL;
    size_t others = form == BRDFFIT_FORM_DIRECTIONS ? 6 : form == BRDFFIT_FORM_ANGLES ? 4 : 3;

    others += (normals ? 3u : 0u) + (weights ? 1u : 0u);
    draw_shape(d, ROWS, columns_of(line) - others, 1, form);
    d->question = question;
    d->question.samples = &d->samples;
    d->samples.quantity = quantity;
    d->samples.normal = normals ? d->normal : NULL;
    d->samples.weights = weights ? d->weights : NULL;
    d->samples.count = 0;
}

static void read_row(struct draw *d, char *line)
{
    const brdffit_samples *s = &d->samples;
    int form = (int)s->form;
    struct target target[] = {
        {form == 0 ? 3 : 0, d->light},
        {form == 0 ? 3 : 0, d->view},
        {s->normal ? 3 : 0, d->normal},
        {form == 1, d->cos_light},
        {form == 1, d->cos_view},
        {form == 1, d->tan2_half},
        {form == 1, d->cos_difference},
        {form == 2, d->a},
        {form == 2, d->b},
        {form == 2, d->c},
        {s->weights != NULL, d->weights},
        {s->channels, d->values},
    };
    size_t t, j, i = s->count;
    char *next = line;

    for (t = 0; t < sizeof target / sizeof target[0]; t++) {
        for (j = 0; j < target[t].width; j++) {
            target[t].array[i * target[t].width + j] = strtod(next, &next);
            next += *next == ',';
        }
    }
    d->samples.count++;
}

int draw_read(struct draw *d, FILE *from)
{
    char *line = malloc(LINE);
    int header = 0;

    memset(d, 0, sizeof *d);
    brdffit_samples_init(&d->samples);
    fit_question_init(&d->question, &d->samples, 1, BRDFFIT_BECKMANN);
    while (line && fgets(line, LINE, from)) {
        if (!strncmp(line, "# route", 7)) {
            read_names(d, line);
        } else if (!strncmp(line, "# sigma", 7)) {
            read_numbers(d, line);
        } else if (*line != '#' && !header) {
            read_header(d, line);
            header = 1;
        } else if (*line != '#' && d->samples.count < ROWS) {
            read_row(d, line);
        }
    }
    free(line);
    return header && d->samples.count > 0;
}
