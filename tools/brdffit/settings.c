/* settings.c: the table of options, and what they mean to the libraries.
 * SPDX-License-Identifier: MIT */
#include "settings.h"

#include <stdlib.h>
#include <string.h>

#include "criteria.h"
#include "lobes.h"
#include "reading.h"
#include "term.h"
#include "weigh.h"

const struct cli_choice brdffit_cli_norm_choices[] = {
    {"l2", BRDFFIT_NORM_L2, 0}, {"l1", BRDFFIT_NORM_L1, 0}, {"linf", BRDFFIT_NORM_LINF, 0}, {NULL, 0, 0}};

static const struct cli_choice engines[] = {
    {"moment", BRDFFIT_ENGINE_MOMENT, 0}, {"socp", BRDFFIT_ENGINE_SOCP, 0}, {NULL, 0, 0}};

const struct cli_choice brdffit_cli_normalise_choices[] = {
    {"max", BRDFFIT_NORMALISE_MAX, 0}, {"none", BRDFFIT_NORMALISE_NONE, 0}, {NULL, 0, 0}};
const struct cli_choice brdffit_cli_quantity_choices[] = {
    {"brdf", BRDFFIT_QUANTITY_BRDF, 0}, {"radiance", BRDFFIT_QUANTITY_RADIANCE, 0}, {NULL, 0, 0}};
const struct cli_choice brdffit_cli_bins_choices[] = {{"edge", BRDFFIT_IO_MERL_EDGE, 0},
                                                      {"centre", BRDFFIT_IO_MERL_CENTRE, 0},
                                                      {"center", BRDFFIT_IO_MERL_CENTRE, 1},
                                                      {NULL, 0, 0}};
const struct cli_choice brdffit_cli_format_choices[] = {{"auto", BRDFFIT_IO_FORMAT_AUTO, 0},
                                                        {"csv", BRDFFIT_IO_FORMAT_CSV, 0},
                                                        {"merl", BRDFFIT_IO_FORMAT_MERL, 0},
                                                        {NULL, 0, 0}};

static const struct cli_choice criteria[] = {
    {"bic", CLI_BIC, 0}, {"aic", CLI_AIC, 0}, {"aicc", CLI_AICC, 0}, {NULL, 0, 0}};

static const struct cli_choice observations[] = {{"effective", 0, 0}, {"all", 1, 0}, {NULL, 0, 0}};

static const struct cli_choice map_formats[] = {{"npy", CLI_MAP_NPY, 0}, {"pfm", CLI_MAP_PFM, 0}, {NULL, 0, 0}};

#define AT(member) offsetof(struct cli_settings, member)
#define READERS (CLI_FIT | CLI_EVAL | CLI_INFO | CLI_COMPARE)
#define TABLES (READERS | CLI_MAP)
#define ALL (TABLES | CLI_MERGE)
#define FITS (CLI_FIT | CLI_MAP)
#define SEARCHES (FITS | CLI_COMPARE)
#define CHOICE(name, commands, hidden, member, choices, value, help)                                                   \
    {name, 0, CLI_CHOICE, commands, hidden, AT(member), 0, 0, 0, choices, value, help}
#define NUMBER(name, kind, member, low, open, high, value, help)                                                       \
    {name, 0, kind, SEARCHES, 0, AT(member), low, high, open, NULL, value, help}
#define PLAIN(name, letter, kind, commands, member, value, help)                                                       \
    {name, letter, kind, commands, 0, AT(member), 0, 0, 0, NULL, value, help}

const struct cli_option brdffit_cli_options[] = {
    PLAIN("lobes", 0, CLI_STRING, CLI_FIT, lobes_given, "1|2|3|auto|NAME,...",
          "specular lobes (default 1): how many of\n--distribution (auto: the fewest that the data\n"
          "support, by BIC), or what each is: ggx,ward"),
    PLAIN("lobes", 0, CLI_STRING, CLI_MAP, lobes_given, "1|2|3|NAME,...",
          "specular lobes (default 1): how many of\n--distribution, or what each is: ggx,ward"),
    PLAIN(
        "model", 0, CLI_STRING, CLI_FIT, model, "NAME",
        "a preset (below), or a form as of 'brdffit\ncompare' (ggx/smith/schlick); options beside it\ngo before what it stands for"),
    PLAIN("models", 0, CLI_STRING, CLI_COMPARE, models, "NAME,...", "forms of model to compare; see below"),
    CHOICE("criterion", CLI_COMPARE, 0, criterion, criteria, "bic|aic|aicc",
           "what weighs the fit against the number of its\nparameters (default bic)"),
    {"threshold", 0, CLI_NUMBER, CLI_COMPARE, 0, AT(threshold), 0, 1e300, 1, NULL, "X",
     "models less than this behind the best in that\ncriterion cannot be told from it (default 6)"},
    CHOICE("observations", CLI_COMPARE, 0, count_all, observations, "effective|all",
           "what the criterion counts: as many Gaussian\nresiduals as would be as uneven as the best\n"
           "fit's, or every value (default effective)"),
    PLAIN("distribution", 0, CLI_DISTRIBUTION, FITS, distribution, "NAME", NULL),
    PLAIN("fresnel", 0, CLI_FRESNEL, FITS, fresnel, "none|schlick",
          "what a lobe does at grazing angles: nothing, or\nSchlick's Fresnel term with an F0 of each lobe\n"
          "and channel (default none)"),
    PLAIN("diffuse", 0, CLI_DIFFUSE, FITS, diffuse, "NAME",
          "diffuse term: lambert, none, oren-nayar or\nburley (default lambert)"),
    PLAIN("masking", 0, CLI_MASKING, FITS, masking, "NAME",
          "masking of beckmann and ggx lobes: v-cavity,\nsmith, smith-separable or none\n(default v-cavity)"),
    CHOICE("norm", FITS, 0, norm, brdffit_cli_norm_choices, "l2|l1|linf",
           "minimise the sum of squared or of absolute\nresiduals, or the largest one (default l2)"),
    CHOICE("engine", FITS, 0, engine, engines, "moment|socp",
           "how norm l2 is proven: bounds of second order,\nor the paper's cone programs by ECOS\n"
           "(default moment)"),
    PLAIN("socp-every-box", 0, CLI_FLAG, FITS, socp_every_box, NULL,
          "send every box to ECOS as the paper does, also\nthose that a closed form decides"),
    PLAIN("physical", 0, CLI_FLAG, SEARCHES, physical, NULL,
          "only models that reflect no more than they\nreceive: x + sum of 4 y <= 1 in each channel,\n"
          "of values that are absolute (engine moment)"),
    PLAIN("anisotropic", 0, CLI_FLAG, CLI_FIT, anisotropic, NULL,
          "the first lobe has two roughnesses, along the\ntangent (azimuth 0) and across it (beckmann,\n"
          "ggx, ward, ashikhmin-shirley)"),
    {"anisotropy", 0, CLI_NUMBER, CLI_FIT, 0, AT(anisotropy), 1e-6, 1e6, 0, NULL, "X",
     "their ratio, along over across, where it is\nknown (default: searched); --anisotropic too"},
    {"tangent-angle", 0, CLI_NUMBER, CLI_FIT, 0, AT(tangent_angle), -360, 360, 0, NULL, "DEG",
     "where the lobe's own tangent lies, from azimuth\n0 counterclockwise (default 0); --anisotropic\ntoo"},
    PLAIN("verify", 0, CLI_STRING, CLI_FIT, verify, "socp[=X]",
          "prove again, by engine socp alone, that nothing\nlies below the bound less this fraction of it\n"
          "(default 1e-3)"),
    {"confidence", 0, CLI_NUMBER, CLI_FIT, 0, AT(confidence), 0, 99.9999999, 1, NULL, "PERCENT",
     "after the fit, an interval for every parameter:\nproven for the data, of this likelihood (95)"},
    NUMBER("sigma-min", CLI_NUMBER, sigma_min, 1e-12, 0, 1e3, "X", "smallest roughness searched (default 1e-12)"),
    NUMBER("sigma-max", CLI_NUMBER, sigma_max, 1e-12, 0, 1e3, "X", "largest roughness searched (default 6)"),
    NUMBER("exponent-min", CLI_NUMBER, exponent_min, 1e-6, 0, 1e24, "X", "smallest exponent searched (default 0.1)"),
    NUMBER("exponent-max", CLI_NUMBER, exponent_max, 1e-6, 0, 1e24, "X", "largest exponent searched (default 1e7)"),
    NUMBER("gap", CLI_NUMBER, gap, 0, 1, 1e300, "X",
           "certify E^2 to within this fraction of the\nproven bound (default 1e-3)"),
    NUMBER("absolute-gap", CLI_NUMBER, absolute_gap, 0, 0, 1e300, "X",
           "or to within this fraction of the data's sum\nof squares (default 1e-12)"),
    NUMBER("resolution", CLI_NUMBER, resolution, 0, 0, 1e300, "X",
           "do not split boxes narrower than this in\nevery sigma, or 1/sqrt(n) (default 0: off)"),
    NUMBER("box-budget", CLI_COUNT, box_budget, 1, 0, 9e15, "N", "most boxes to bound (default 1000000)"),
    CHOICE("normalise", SEARCHES, 0, normalise, brdffit_cli_normalise_choices, "max|none",
           "divide each channel by its largest used\nradiance, or not (default max)"),
    CHOICE("normalize", SEARCHES, 1, normalise, brdffit_cli_normalise_choices, "", ""),
    {"max-incidence", 0, CLI_DEGREES, FITS, 0, AT(max_incidence), 0, 90, 1, NULL, "DEG|off",
     "skip samples lit from further off the normal\n(default 60; with --fresnel schlick off)"},
    {"max-incidence", 0, CLI_DEGREES, CLI_COMPARE, 0, AT(max_incidence), 0, 90, 1, NULL, "DEG|off",
     "skip samples lit from further off the normal\n(default 60; off when a model has Fresnel)"},
    {"max-incidence", 0, CLI_DEGREES, CLI_INFO, 0, AT(max_incidence), 0, 90, 1, NULL, "DEG|off",
     "skip samples lit from further off the normal\n(default 60)"},
    CHOICE(
        "values", READERS, 0, values, brdffit_cli_values_choices, "brdf|radiance|ccbrdf|reflectance-factor",
        "what the file's values are: f_r, f_r times the\n"
        "light's cosine, or a text's f_r times the\nviewer's cosine or times pi (default brdf; for\nfiles with a,b,c radiance)"),
    CHOICE("values", CLI_MAP, 0, values, brdffit_cli_quantity_choices, "brdf|radiance",
           "what the stack's values are: f_r, or f_r times\nthe light's cosine (default brdf)"),
    PLAIN("channels", 0, CLI_STRING, READERS, channels, "NAME,...",
          "columns of a text that are the channels; what\nmeans nothing else is left out"),
    PLAIN("column", 0, CLI_LIST, TABLES, columns, "ROLE=NAME,...",
          "what a column of a text means: theta_i, phi_i,\ntheta_o, phi_o, phi, lx ... vz, nx, a, b, c,\n"
          "weight, uncertainty, wavelength, channel or\nignore; #3 is the third column"),
    PLAIN("directions", 0, CLI_STRING, TABLES, directions, "WORD,...",
          "what a text's directions are: degrees, radians,\nelevation, mirror-at-0, light-travels, y-up,\nas-written"),
    PLAIN("missing", 0, CLI_STRING, READERS, missing, "X|negative|none",
          "values of a text that stand for none: X, all\nbelow 0, or no number"),
    {"saturated", 0, CLI_NUMBER, READERS, 0, AT(saturated), 0, 1e300, 1, NULL, "X",
     "leave samples of a text out that have a value\nof X or more"},
    CHOICE(
        "weight", CLI_FIT | CLI_COMPARE, 0, weight, brdffit_cli_weight_choices,
        "none|column|cosine|solid-angle|relative",
        "what samples count for: alike, as the file\nsays, by n.l, by the share of directions that\neach stands for, or by 1/value^2 (default\ncolumn where there is one, else none)"),
    CHOICE("merl-bins", CLI_FIT | CLI_INFO | CLI_COMPARE, 0, merl_bins, brdffit_cli_bins_choices, "edge|centre",
           "angle that a MERL entry stands for\n(default edge)"),
    PLAIN("merl-samples", 0, CLI_STRING, CLI_FIT | CLI_INFO | CLI_COMPARE, merl_samples, "table|84|FILE.csv",
          "use every cell of a MERL table, the paper's\n84 directions, or those of a file\n"
          "(default table)"),
    CHOICE("format", READERS, 0, format, brdffit_cli_format_choices, "auto|csv|merl",
           "format of FILE (default auto: by content)"),
    {"max-bytes", 0, CLI_COUNT, READERS, 0, AT(max_bytes), 1, 9e15, 0, NULL, "N",
     "most bytes of FILE, and of what a gzip file\nunpacks to (default 8 and 1 GiB)"},
    PLAIN("select", 0, CLI_COUNT, CLI_EVAL, select, "N",
          "use line N of FIT.json, from 1 (default: the\nline whose \"file\" is FILE)"),
    PLAIN("json", 0, CLI_FLAG, CLI_FIT | CLI_INFO, json, NULL, "one JSON object a line and file"),
    PLAIN("json", 0, CLI_FLAG, CLI_COMPARE, json, NULL,
          "a JSON line of 'brdffit fit' for each model,\nthen one of the verdict"),
    PLAIN("shard", 0, CLI_STRING, CLI_FIT, shard, "I/N",
          "fit part I of N only: every Nth FILE, from the\nIth; needs --json. 'brdffit merge' joins the\n"
          "parts"),
    PLAIN("geometry", 'g', CLI_STRING, CLI_MAP, geometry, "FILE.csv",
          "directions of light and viewer, a line a\nsample, with the columns of 'brdffit fit'; a\n"
          "column named file lists the images"),
    PLAIN("lights", 0, CLI_STRING, CLI_MAP, lights, "FILE.npy",
          "instead: vectors to the light, samples x 3, or\nsamples x height x width x 3"),
    PLAIN("views", 0, CLI_STRING, CLI_MAP, views, "FILE.npy",
          "and to the viewer: the same, or 3 for all\n(default: +z)"),
    PLAIN("normals", 0, CLI_STRING, CLI_MAP, normals, "FILE",
          "normal map, height x width x 3\n(default: +z everywhere)"),
    PLAIN("mask", 0, CLI_STRING, CLI_MAP, mask, "FILE", "height x width; fit where it is not 0"),
    PLAIN("srgb", 0, CLI_FLAG, CLI_MAP, srgb, NULL, "8-bit PNG are sRGB (default: linear)"),
    CHOICE("format", CLI_MAP | CLI_MERGE, 0, map_format, map_formats, "npy|pfm",
           "format of the maps in a folder (default npy)"),
    {"tile", 0, CLI_COUNT, CLI_MAP, 0, AT(tile), 1, 9e15, 0, NULL, "N",
     "rows fitted, and kept, at a time\n(default: about 16 MB)"},
    {"threads", 0, CLI_COUNT, CLI_MAP, 0, AT(threads), 1, 9e15, 0, NULL, "N",
     "threads (default: the processors available)"},
    PLAIN("shard", 0, CLI_STRING, CLI_MAP, shard, "I/N",
          "fit part I of N only, for many machines on one\nfolder; afterwards 'brdffit merge OUTPUT' puts\n"
          "the maps together"),
    PLAIN("fresh", 0, CLI_FLAG, CLI_MAP, fresh, NULL, "do not go on with an earlier, unfinished run"),
    PLAIN("stats", 0, CLI_FLAG, CLI_FIT | CLI_MAP, stats, NULL, "what was skipped, merged and saved"),
    PLAIN("quiet", 'q', CLI_FLAG, ALL, quiet, NULL, "no report, summary or progress; errors only"),
    PLAIN("output", 'o', CLI_STRING, CLI_MAP, output, "DIR|FILE.npz",
          "the maps, whole or not at all (default:\nNAME-maps where you are)"),
    PLAIN("output", 'o', CLI_STRING, READERS | CLI_MERGE, output, "FILE",
          "write there, whole or not at all, instead of\nto standard output"),
    {"help", 'h', CLI_HELP, ALL, 0, 0, 0, 0, 0, NULL, NULL, "show this"},
    {NULL, 0, CLI_FLAG, 0, 0, 0, 0, 0, 0, NULL, NULL, NULL},
};

void brdffit_cli_settings_free(struct cli_settings *settings)
{
    free((void *)settings->files);
    free(settings->columns);
    settings->files = NULL;
    settings->columns = NULL;
    settings->file_count = 0;
}

void brdffit_cli_fit_options(const struct cli_settings *settings, brdffit_options *options)
{
    brdffit_options_init(options);
    options->lobes = settings->lobes;
    options->distributions = settings->distributions;
    options->distribution = settings->distributions[0];
    options->fresnel = (brdffit_fresnel)settings->fresnel;
    options->diffuse = (brdffit_diffuse)settings->diffuse;
    options->masking = (brdffit_masking)settings->masking;
    options->norm = (brdffit_norm)settings->norm;
    options->engine = (brdffit_engine)settings->engine;
    options->socp_every_box = settings->socp_every_box;
    options->physical = settings->physical;
    options->anisotropic = settings->anisotropic || settings->anisotropy > 0 || settings->tangent_angle < 0 ||
                           settings->tangent_angle > 0;
    options->anisotropy = settings->anisotropy;
    options->tangent_angle = settings->tangent_angle;
    options->normalise = (brdffit_normalise)settings->normalise;
    options->sigma_min = settings->sigma_min;
    options->sigma_max = settings->sigma_max;
    options->exponent_min = settings->exponent_min;
    options->exponent_max = settings->exponent_max;
    options->relative_gap = settings->gap;
    options->absolute_gap = settings->absolute_gap;
    options->sigma_resolution = settings->resolution;
    options->box_budget = settings->box_budget;
    options->max_incidence = settings->max_incidence;
}

void brdffit_cli_io_options(const struct cli_settings *settings, brdffit_io_options *options)
{
    brdffit_io_options_init(options);
    options->format = (brdffit_io_format)settings->format;
    brdffit_cli_reading_options(settings, options);
    options->max_bytes = settings->max_bytes;
    options->merl_bins = (brdffit_io_merl_bins)settings->merl_bins;
    if (strcmp(settings->merl_samples, "84") == 0) {
        options->merl_sampling = BRDFFIT_IO_MERL_PROTOCOL84;
    } else if (strcmp(settings->merl_samples, "table") == 0) {
        options->merl_sampling = BRDFFIT_IO_MERL_TABLE;
    } else {
        options->merl_sampling = BRDFFIT_IO_MERL_DIRECTIONS;
    }
}

void brdffit_cli_record_options(struct cli_text *text, const brdffit_options *o)
{
    brdffit_cli_text_puts(text, "--lobes ");
    if (brdffit_cli_lobes_differ(o)) {
        brdffit_cli_add_names(text, o);
    } else {
        brdffit_cli_text_printf(text, "%d\n--distribution %s", o->lobes,
                                brdffit_distribution_string(brdffit_cli_lobe(o, 0)));
    }
    brdffit_cli_text_printf(text, "\n--fresnel %s\n--diffuse %s\n--masking %s", brdffit_fresnel_string(o->fresnel),
                            brdffit_diffuse_string(o->diffuse), brdffit_masking_string(o->masking));
    brdffit_cli_text_printf(text, "\n--norm %s\n--engine %s\n--socp-every-box %d\n", brdffit_norm_string(o->norm),
                            brdffit_engine_string(o->engine), o->socp_every_box);
    brdffit_cli_text_printf(text, "--normalise %s\n",
                            brdffit_cli_choice_name(brdffit_cli_normalise_choices, (int)o->normalise));
    brdffit_cli_text_printf(text, "--sigma-min %.17g\n--sigma-max %.17g\n--exponent-min %.17g\n--exponent-max %.17g\n",
                            o->sigma_min, o->sigma_max, o->exponent_min, o->exponent_max);
    brdffit_cli_text_printf(text, "--gap %.17g\n--absolute-gap %.17g\n--resolution %.17g\n--box-budget %zu\n",
                            o->relative_gap, o->absolute_gap, o->sigma_resolution, o->box_budget);
    brdffit_cli_text_printf(text, "--max-incidence %.17g\n", o->max_incidence);
    brdffit_cli_text_puts(text, o->physical ? "--physical\n" : "");
    if (o->anisotropic) {
        brdffit_cli_text_printf(text, "--anisotropic\n--anisotropy %.17g\n--tangent-angle %.17g\n", o->anisotropy,
                                o->tangent_angle);
    }
}

const char *brdffit_cli_choice_name(const struct cli_choice *choices, int value)
{
    for (; choices->name != NULL; choices++) {
        if (choices->value == value) {
            return choices->name;
        }
    }
    return "unknown";
}

#define HELP_COLUMN 32

/* A word of a help, on a line of its own when this one is full. */
static void add_word(struct cli_text *text, size_t *column, const char *word)
{
    const size_t length = strlen(word);
    if (*column + 1 + length > CLI_WIDTH - HELP_COLUMN) {
        brdffit_cli_text_puts(text, "\n");
        *column = 0;
    } else {
        brdffit_cli_text_puts(text, *column > 0 ? " " : "");
        *column += *column > 0;
    }
    brdffit_cli_text_puts(text, word);
    *column += length;
}

/* "beckmann, ggx or ward," and so on: those known by sigma, or by the exponent. */
static void add_distributions(struct cli_text *text, size_t *column, int by_exponent)
{
    size_t left = 0;
    for (const struct cli_choice *c = brdffit_cli_distribution_choices(); c->name != NULL; c++) {
        left += brdffit_cli_by_exponent((brdffit_distribution)c->value) == by_exponent;
    }
    for (const struct cli_choice *c = brdffit_cli_distribution_choices(); c->name != NULL; c++) {
        if (brdffit_cli_by_exponent((brdffit_distribution)c->value) != by_exponent) {
            continue;
        }
        struct cli_text word = {0};
        left--;
        brdffit_cli_text_printf(&word, "%s%s", c->name, left > 1 ? "," : "");
        add_word(text, column, brdffit_cli_text_string(&word));
        if (left == 1) {
            add_word(text, column, "or");
        }
        brdffit_cli_text_free(&word);
    }
}

static void distribution_help(struct cli_text *text)
{
    size_t column = strlen("what a lobe is:");
    brdffit_options defaults;
    brdffit_options_init(&defaults);
    brdffit_cli_text_puts(text, "what a lobe is:");
    add_distributions(text, &column, 0);
    add_word(text, &column, "with roughness sigma;");
    add_distributions(text, &column, 1);
    add_word(text, &column, "with exponent n");
    brdffit_cli_text_printf(text, "\n(default %s)", brdffit_distribution_string(defaults.distribution));
}

/* The left column: option and value; the right: its help, indented. */
void brdffit_cli_option_help(struct cli_text *text, unsigned command)
{
    struct cli_text names = {0};
    distribution_help(&names);
    for (const struct cli_option *option = brdffit_cli_options; option->name != NULL; option++) {
        if (option->hidden || !(option->commands & command)) {
            continue;
        }
        const size_t start = text->size;
        if (option->letter) {
            brdffit_cli_text_printf(text, "  -%c, --%s", option->letter, option->name);
        } else {
            brdffit_cli_text_printf(text, "  --%s", option->name);
        }
        if (option->value != NULL) {
            brdffit_cli_text_printf(text, " %s", option->value);
        }
        size_t column = text->size - start;
        if (column + 2 > HELP_COLUMN) {
            brdffit_cli_text_puts(text, "\n");
            column = 0;
        }
        const char *help = option->kind == CLI_DISTRIBUTION ? brdffit_cli_text_string(&names) : option->help;
        for (const char *line = help; *line;) {
            const size_t length = strcspn(line, "\n");
            brdffit_cli_text_pad(text, HELP_COLUMN - column);
            brdffit_cli_text_add(text, line, length);
            brdffit_cli_text_puts(text, "\n");
            column = 0;
            line += length + (line[length] == '\n');
        }
    }
    brdffit_cli_text_free(&names);
}
