/* commands.c: the subcommands. SPDX-License-Identifier: MIT */
#include "commands.h"

#include <stddef.h>

#include "settings.h"

const struct cli_command brdffit_cli_commands[] = {
    {"fit", brdffit_cli_fit, brdffit_cli_fit_help, "fit a model to measured files, with proof", CLI_FIT},
    {"compare", brdffit_cli_compare, brdffit_cli_compare_help, "fit many forms of model: which do the data support",
     CLI_COMPARE},
    {"eval", brdffit_cli_eval, brdffit_cli_eval_help, "evaluate a fit at a file's directions", CLI_EVAL},
    {"map", brdffit_cli_map, brdffit_cli_map_help, "fit every texel of a stack of images", CLI_MAP},
    {"merge", brdffit_cli_merge, brdffit_cli_merge_help, "put together what fit and map --shard did", CLI_MERGE},
    {"info", brdffit_cli_info, brdffit_cli_info_help, "what is in a file and what would be used", CLI_INFO},
    {"completion", brdffit_cli_completion, brdffit_cli_completion_help,
     "what a shell needs to complete all this: bash, zsh, fish", 0},
    {NULL, NULL, NULL, NULL, 0},
};
