/*
 * Fuzz target: what `brdffit merge` reads, the stamps of lines and the manifests of maps. SPDX-License-Identifier: MIT
 */
#include "../../tools/brdffit/map.h"
#include "../../tools/brdffit/merge.h"
#include "../../tools/brdffit/shard.h"
#include "fuzz/claims.h"
#include "fuzz/standalone.h"

static void read_line(const char *line)
{
    struct cli_shard shard;
    size_t position = 0, length;
    const char *why = "";

    length = brdffit_cli_shard_read(line, &shard, &position, &why);
    if (why) {
        CLAIM(length == 0 && why[0]);
        return;
    }
    CLAIM(length < strlen(line) && shard.part >= 1 && shard.part <= shard.of);
    CLAIM(position >= shard.part && position <= shard.files && (position - shard.part) % shard.of == 0);
}

static void read_manifest(char *manifest, size_t size)
{
    struct cli_settings settings;
    struct cli_map map;
    const char *file = NULL;

    memset(&settings, 0, sizeof settings);
    memset(&map, 0, sizeof map);
    settings.files = &file;
    settings.file_count = 1;
    map.settings = &settings;
    (void)brdffit_cli_map_key(manifest);
    if (brdffit_cli_parse_manifest(&map, &settings, manifest, size)) {
        brdffit_cli_fit_options(&settings, &map.options);
        CLAIM(file && map.tiles > 0 && map.tile_rows > 0 && brdffit_cli_map_depth(&map) > 0);
        CLAIM(map.options.lobes >= 1 && map.options.lobes <= BRDFFIT_MAX_LOBES);
        CLAIM(brdffit_cli_map_rows(&map, map.tiles - 1) > 0);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);

    if (text) {
        memcpy(text, data, size);
        text[size] = 0;
        read_line(text);
        read_manifest(text, strlen(text));
    }
    free(text);
    return 0;
}

#if !defined(BRDFFIT_LIBFUZZER)

static const struct fuzz_seed seeds[] = {
    SEED("{\"schema\":\"brdffit.fit/1\",\"shard\":{\"part\":1,\"of\":2,\"position\":3,\"files\":5,\"run\":"
         "\"0123456789abcdef\",\"crc32\":\"3f2b0c1d\"}}"),
    SEED("brdffit map 1, version 0.2.0\nstack s.npy: 12 bytes, f8, 3 x 4 x 5 x 1\ntime of stack s.npy: 1.000000002\n"
         "--lobes 1\n--distribution beckmann\n--fresnel none\n--diffuse lambert\n--masking v-cavity\n--norm l2\n"
         "--engine moment\n--normalise max\n--sigma-min 1e-12\n--sigma-max 6\n--exponent-min 0.1\n"
         "--exponent-max 1e7\n--gap 0.001\n--absolute-gap 1e-12\n--resolution 0\n--box-budget 1000000\n"
         "--max-incidence 60\n--values brdf\n--tile 2\nmaps of 3 x 4 x 5 x 1: s.npy\n"),
    SEED("brdffit map 1, version 0.2.0\n--lobes ggx,ward\n--fresnel schlick\n--diffuse burley\n--masking smith\n"
         "--norm l1\n--normalise none\n--sigma-min 0.01\n--sigma-max 2\n--exponent-min 1\n--exponent-max 100\n"
         "--gap 0.1\n--absolute-gap 0\n--resolution 0.01\n--box-budget 7\n--max-incidence 90\n--values radiance\n"
         "--tile 1\nmaps of 84 x 1 x 1 x 3: x\n"),
};
static const size_t seed_count = sizeof seeds / sizeof *seeds;

FUZZ_MAIN(seeds, seed_count)
#endif
