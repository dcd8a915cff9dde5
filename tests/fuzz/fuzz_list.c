/*
 * Fuzz target: lists of images, and the directions that are left of them. SPDX-License-Identifier: MIT
 */
#include "../../tools/brdffit/map.h"
#include "fuzz/claims.h"
#include "fuzz/standalone.h"

static size_t lines_of(const struct cli_text *text)
{
    size_t i, lines = 0;

    for (i = 0; i < text->size; i++) {
        lines += text->data[i] == '\n';
    }
    return lines;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct cli_text text = {0};
    struct cli_map map;
    brdffit_io_options options;
    brdffit_table *table = NULL;
    brdffit_error error;
    int found = 0, code;
    size_t i, lines;

    memset(&map, 0, sizeof map);
    memset(&error, 0, sizeof error);
    brdffit_cli_text_add(&text, (const char *)data, size);
    lines = lines_of(&text) + (size > 0 && data[size - 1] != '\n');
    code = brdffit_cli_map_take_files(&map, &text, "folder/list.csv", NULL, &found);
    CLAIM(code == 0 || code == CLI_EXIT_DATA);
    if (code == 0 && found) {
        CLAIM(lines_of(&text) == lines); /* so that messages have the numbers of the file's lines */
    }
    for (i = 0; i < map.samples; i++) {
        CLAIM(map.images[i][0]);
        free(map.images[i]);
    }
    free(map.images);
    brdffit_io_options_init(&options);
    options.format = BRDFFIT_IO_FORMAT_CSV;
    options.directions_only = 1;
    if (code == 0 &&
        brdffit_io_read_memory(brdffit_cli_text_string(&text), text.size, &options, &table, &error) == BRDFFIT_OK) {
        CLAIM(table->samples->count > 0 && (table->samples->channels > 0) == (table->samples->values != NULL));
        claim_form(table->samples);
        brdffit_io_free(table);
    }
    brdffit_cli_text_free(&text);
    return 0;
}

#if !defined(BRDFFIT_LIBFUZZER)

static const struct fuzz_seed seeds[] = {
    SEED("file,lx,ly,lz,vx,vy,vz\na.pfm,0,0,1,0,0,1\n\"b c.pfm\",1,0,1,0,0,1\n"),
    SEED("\xef\xbb\xbf# lights\r\ntheta_i;file;theta_o\r\n10;/a/x.png;0\r\n\r\n20;y.png;0\r\n"),
    SEED("theta_i\tphi_i\ttheta_o\tphi_o\tfile\n1\t2\t3\t4\tz.npy\n"),
};
static const size_t seed_count = sizeof seeds / sizeof *seeds;

FUZZ_MAIN(seeds, seed_count)
#endif
