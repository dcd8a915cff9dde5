/* map_counts.c: how texels ended, and map.json, which says what the maps are. SPDX-License-Identifier: MIT */
#include "map.h"

#include <stdio.h>
#include <stdlib.h>

#include "failure.h"
#include "json_fit.h"
#include "lobes.h"
#include "output.h"

void brdffit_cli_map_add(struct cli_map_counts *sum, const struct cli_map_counts *counts)
{
    for (int s = 0; s < CLI_TEXEL_COUNT; s++) {
        sum->status[s] += counts->status[s];
    }
    for (int s = 0; s < BRDFFIT_SKIP_COUNT; s++) {
        sum->skipped[s] += counts->skipped[s];
    }
    sum->equal += counts->equal;
    sum->general += counts->general;
    sum->zero_channels += counts->zero_channels;
    sum->equal_channels += counts->equal_channels;
    sum->boxes += counts->boxes;
    sum->nodes += counts->nodes;
    sum->one_lobe_enough += counts->one_lobe_enough;
    if (counts->bad_texel < sum->bad_texel) {
        sum->bad_texel = counts->bad_texel;
        sum->bad_where = counts->bad_where;
    }
}

static void legend(struct cli_json *json)
{
    char key[16];
    brdffit_cli_json_open(json, "status", '{');
    for (int s = 0; s < CLI_TEXEL_COUNT; s++) {
        (void)snprintf(key, sizeof key, "%d", s);
        brdffit_cli_json_string(
            json, key, s == CLI_TEXEL_NO_SAMPLES ? "no_samples" : brdffit_texel_status_string((brdffit_texel_status)s));
    }
    brdffit_cli_json_close(json, '}');
}

int brdffit_cli_map_describe(const struct cli_map *map, const struct cli_map_counts *total)
{
    struct cli_text text = {0};
    struct cli_json json = {&text, 0};
    struct cli_output output;
    char *const path = brdffit_cli_map_path(map, "out/map.json");
    brdffit_cli_json_open(&json, NULL, '{');
    brdffit_cli_json_string(&json, "schema", "brdffit.map/1");
    brdffit_cli_json_string(&json, "version", brdffit_version());
    brdffit_cli_json_count(&json, "samples", map->samples);
    brdffit_cli_json_count(&json, "height", map->height);
    brdffit_cli_json_count(&json, "width", map->width);
    brdffit_cli_json_count(&json, "channels", map->channels);
    brdffit_cli_json_count(&json, "lobes", (size_t)map->options.lobes);
    brdffit_cli_json_lobes(&json, &map->options);
    brdffit_cli_json_string(&json, "norm", brdffit_norm_string(map->options.norm));
    brdffit_cli_json_options(&json, &map->options);
    brdffit_cli_json_string(&json, "quantity",
                            brdffit_cli_choice_name(brdffit_cli_quantity_choices, (int)map->geometry.quantity));
    legend(&json);
    brdffit_cli_json_open(&json, "texels", '{');
    for (int s = 0; s < CLI_TEXEL_COUNT; s++) {
        brdffit_cli_json_count(
            &json, s == CLI_TEXEL_NO_SAMPLES ? "no_samples" : brdffit_texel_status_string((brdffit_texel_status)s),
            (size_t)total->status[s]);
    }
    brdffit_cli_json_close(&json, '}');
    brdffit_cli_json_close(&json, '}');
    brdffit_cli_text_puts(&text, "\n");
    int code = path == NULL ? brdffit_cli_no_memory() : 0;
    if (code == 0 && brdffit_cli_output_replace(&output, path) != 0) {
        code = CLI_EXIT_FAILURE;
    } else if (code == 0 &&
               (brdffit_cli_output_write(&output, &text) != 0 || brdffit_cli_output_commit(&output) != 0)) {
        brdffit_cli_output_abandon(&output);
        code = CLI_EXIT_FAILURE;
    }
    free(path);
    brdffit_cli_text_free(&text);
    return code;
}
