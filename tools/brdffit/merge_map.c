/* merge_map.c: the maps from what the parts of `brdffit map` left in their
 * work folder. SPDX-License-Identifier: MIT
 *
 * The stack is not needed, and need not be on this machine: the manifest says
 * what the maps are. It belongs to its tiles, as each bears its hash. */
#define _POSIX_C_SOURCE 200809L
#include "merge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lobes.h"
#include "map.h"
#include "slurp.h"
#include "tell.h"
#include "terms.h"

/* ---- The manifest ------------------------------------------------------ */

/* What follows "\nKEY " in the manifest; NULL when nothing does. */
static const char *after(const char *manifest, const char *key)
{
    for (const char *at = manifest; (at = strstr(at, key)) != NULL; at++) {
        if (at > manifest && at[-1] == '\n' && at[strlen(key)] == ' ') {
            return at + strlen(key) + 1;
        }
    }
    return NULL;
}

static int choice(const char *manifest, const char *key, const struct cli_choice *choices, int *value)
{
    const char *const word = after(manifest, key);
    for (; word != NULL && choices->name != NULL; choices++) {
        if (strlen(choices->name) == strcspn(word, "\n") && strncmp(choices->name, word, strlen(choices->name)) == 0) {
            *value = choices->value;
            return 1;
        }
    }
    return 0;
}

/* Shapes that memory could never hold are no shapes of a run. */
static int sound(const struct cli_map *map)
{
    const double texels = (double)map->tile_rows * (double)map->width;
    return map->samples > 0 && map->height > 0 && map->width > 0 && map->channels > 0 && map->tile_rows > 0 &&
           map->channels < 1u << 20 && map->height < 1u << 30 && texels < 1e9;
}

static int number(const char *manifest, const char *key, double *value)
{
    const char *const word = after(manifest, key);
    return word != NULL && sscanf(word, "%lf", value) == 1;
}

/* A number and a distribution, or names. */
static int parse_lobes(struct cli_settings *s, const char *options)
{
    char given[128] = "";
    s->distribution = CLI_UNSET;
    if (sscanf(options, "%127[^\n]", given) != 1) {
        return 0;
    }
    if (given[1] == '\0' && !choice(options, "--distribution", brdffit_cli_distribution_choices(), &s->distribution)) {
        return 0;
    }
    s->lobes_given = given;
    const int settled = brdffit_cli_settle_lobes(s, NULL) == 0;
    s->lobes_given = NULL;
    return settled;
}

/* What brdffit_cli_record_options wrote, as far as map.json tells it. */
static int parse_options(struct cli_settings *s, const char *options)
{
    const char *const budget = after(options, "--box-budget");
    return parse_lobes(s, options) &&
           choice(options, "--fresnel", brdffit_cli_term_choices(CLI_FRESNEL), &s->fresnel) &&
           choice(options, "--diffuse", brdffit_cli_term_choices(CLI_DIFFUSE), &s->diffuse) &&
           choice(options, "--masking", brdffit_cli_term_choices(CLI_MASKING), &s->masking) &&
           choice(options, "--norm", brdffit_cli_norm_choices, &s->norm) &&
           choice(options, "--normalise", brdffit_cli_normalise_choices, &s->normalise) &&
           number(options, "--sigma-min", &s->sigma_min) && number(options, "--sigma-max", &s->sigma_max) &&
           number(options, "--exponent-min", &s->exponent_min) && number(options, "--exponent-max", &s->exponent_max) &&
           number(options, "--gap", &s->gap) && number(options, "--absolute-gap", &s->absolute_gap) &&
           number(options, "--resolution", &s->resolution) && budget != NULL &&
           sscanf(budget, "%zu", &s->box_budget) == 1 && number(options, "--max-incidence", &s->max_incidence);
}

/* 1 when all is found. The name of the stack ends the manifest, whatever characters it has. */
int brdffit_cli_parse_manifest(struct cli_map *map, struct cli_settings *settings, char *manifest, size_t size)
{
    const char *const shape = after(manifest, "maps of"), *const options = after(manifest, "--lobes");
    const char *const tile = options != NULL ? after(options, "--tile") : NULL;
    int quantity = 0, start = 0;
    if (shape == NULL || options == NULL || tile == NULL || size == 0 || manifest[size - 1] != '\n' ||
        !parse_options(settings, options) || sscanf(tile, "%zu", &map->tile_rows) != 1 ||
        sscanf(shape, "%zu x %zu x %zu x %zu: %n", &map->samples, &map->height, &map->width, &map->channels, &start) !=
            4 ||
        start == 0 || !choice(options, "--values", brdffit_cli_quantity_choices, &quantity) || !sound(map)) {
        return 0;
    }
    manifest[size - 1] = '\0';
    settings->files[0] = shape + start;
    map->geometry.quantity = (brdffit_quantity)quantity;
    map->tiles = (map->height + map->tile_rows - 1) / map->tile_rows;
    return 1;
}

static int check_version(const char *manifest, const char *work)
{
    const char *const start = "brdffit map 1, version ";
    const size_t length = strcspn(manifest, "\n");
    if (length > strlen(start) && strncmp(manifest, start, strlen(start)) == 0) {
        const int wanted = (int)(length - strlen(start));
        if (strlen(brdffit_version()) == (size_t)wanted &&
            strncmp(manifest + strlen(start), brdffit_version(), (size_t)wanted) == 0) {
            return 0;
        }
        brdffit_cli_tell("brdffit merge: %s: its parts are of version %.*s, this is %s\n", work, wanted,
                         manifest + strlen(start), brdffit_version());
    } else {
        brdffit_cli_tell("brdffit merge: %s: its manifest is not one of 'brdffit map'\n", work);
    }
    return CLI_EXIT_DATA;
}

/* Into `text`, which the settings go on pointing into. */
static int read_manifest(struct cli_map *map, struct cli_settings *settings, struct cli_text *text)
{
    char *const path = brdffit_cli_map_path(map, "manifest");
    int code = path == NULL ? brdffit_cli_no_memory() : brdffit_cli_slurp(text, path);
    free(path);
    if (code == 0) {
        code = check_version(brdffit_cli_text_string(text), map->work);
    }
    map->key = brdffit_cli_map_key(brdffit_cli_text_string(text));
    if (code == 0 && !brdffit_cli_parse_manifest(map, settings, text->data, text->size)) {
        brdffit_cli_tell("brdffit merge: %s: its manifest is damaged\n", map->work);
        code = CLI_EXIT_DATA;
    }
    return code;
}

/* ---- The maps ---------------------------------------------------------- */

#define TILES_SHOWN 12

static int check_tiles(const struct cli_map *map)
{
    size_t missing = 0;
    for (size_t tile = 0; tile < map->tiles; tile++) {
        missing += !brdffit_cli_map_has_tile(map, tile);
    }
    if (missing == 0) {
        return 0;
    }
    brdffit_cli_tell("brdffit merge: %s: %zu of %zu tiles are missing or damaged:", map->work, missing, map->tiles);
    size_t shown = 0;
    for (size_t tile = 0; tile < map->tiles && shown < TILES_SHOWN; tile++) {
        if (!brdffit_cli_map_has_tile(map, tile)) {
            brdffit_cli_tell("%s %zu", shown++ > 0 ? "," : "", tile + 1);
        }
    }
    brdffit_cli_tell("%s\nOf N parts, number I has the tiles I, I + N, I + 2 N ...: run those again.\n",
                     missing > shown ? ", ..." : "");
    return CLI_EXIT_DATA;
}

static int merge(struct cli_map *map, struct cli_settings *settings, const char *target, struct cli_text *manifest)
{
    struct cli_map_counts counts;
    int code = brdffit_cli_map_reopen(map, target);
    if (code == 0) {
        code = read_manifest(map, settings, manifest);
    }
    brdffit_cli_fit_options(settings, &map->options);
    if (code == 0) {
        code = brdffit_cli_map_check_target(settings, target);
    }
    if (code == 0) {
        code = check_tiles(map);
    }
    if (code != 0) {
        return code;
    }
    code = brdffit_cli_map_write(map, target, &counts);
    if (code != 0) {
        return code;
    }
    brdffit_cli_map_forget(map);
    if (!settings->quiet) {
        brdffit_cli_map_report(map, target, &counts, 0, 0, 0);
    }
    return brdffit_cli_map_finish(map, &counts);
}

int brdffit_cli_merge_map(struct cli_settings *settings, const char *target)
{
    struct cli_map map;
    struct cli_text manifest = {0};
    memset(&map, 0, sizeof map);
    map.settings = settings;
    const int code = merge(&map, settings, target, &manifest);
    brdffit_cli_map_close(&map);
    brdffit_cli_text_free(&manifest);
    return code;
}
