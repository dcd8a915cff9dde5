/* json_parse.c: cJSON, and whether it was memory that it lacked: its NULL may be either. SPDX-License-Identifier: MIT */
#include "json_parse.h"

#include <stdlib.h>

/* cJSON's hooks know no argument. JSON is read in one thread. */
static int refused;

static void *take(size_t size)
{
    void *const block = malloc(size);
    refused |= block == NULL;
    return block;
}

cJSON *brdffit_cli_json_parse(const char *text, size_t size, const char **end, int *no_memory)
{
    cJSON_Hooks hooks = {take, free};
    refused = 0;
    cJSON_InitHooks(&hooks);
    cJSON *const value = cJSON_ParseWithLengthOpts(text, size, end, 0);
    *no_memory = value == NULL && refused;
    return value;
}
