/* map_png.c: PNG images of 8 and 16 bits, by libpng. They can only be read
 * from front to back: each is unpacked once, into an array in the work folder.
 * SPDX-License-Identifier: MIT
 *
 * A value v of 8 bits becomes v / 255 and one of 16 bits v / 65535, as float32;
 * with --srgb, 8 bits are decoded by sRGB's curve. Palettes become colours,
 * fewer bits than 8 are spread to 8, and an alpha channel is left out. Chunks
 * about gamma and profiles are not looked at. */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <png.h>

#include "map.h"
#include "output.h"
#include "tell.h"

struct reader {
    const char *path;
    int no_memory;
    FILE *file;
    png_structp png;
    png_infop info;
    size_t height, width, channels;
    int bits;
    unsigned char **volatile rows;
    unsigned char *volatile pixels;
};

static void on_error(png_structp png, png_const_charp message)
{
    const struct reader *const r = png_get_error_ptr(png);
    if (r->no_memory) {
        (void)brdffit_cli_no_memory();
    } else {
        brdffit_cli_tell("brdffit: %s: the PNG cannot be read: %s\n", r->path, message);
    }
    longjmp(png_jmpbuf(png), 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void *take(png_structp png, png_alloc_size_t size)
{
    struct reader *const r = png_get_mem_ptr(png);
    void *const block = malloc(size);
    r->no_memory |= block == NULL;
    return block;
}

static void release(png_structp png, void *block)
{
    (void)png;
    free(block);
}

/* After a jump out of libpng. */
static int broken_off(const struct reader *r)
{
    return r->no_memory ? CLI_EXIT_FAILURE : CLI_EXIT_DATA;
}

static void finish(struct reader *r)
{
    free((void *)r->rows);
    free(r->pixels);
    png_destroy_read_struct(&r->png, &r->info, NULL);
    if (r->file != NULL) {
        (void)fclose(r->file);
    }
}

/* Header and conversions. After it png_jmpbuf must be set anew. */
static int begin(struct reader *r, const char *path)
{
    memset(r, 0, sizeof *r);
    r->path = path;
    r->file = fopen(path, "rb");
    if (r->file == NULL) {
        brdffit_cli_tell("brdffit: %s: cannot open the file (%s)\n", path, strerror(errno));
        return CLI_EXIT_FAILURE;
    }
    r->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, r, on_error, on_warning, r, take, release);
    r->info = r->png != NULL ? png_create_info_struct(r->png) : NULL;
    if (r->info == NULL) {
        return brdffit_cli_no_memory();
    }
    if (setjmp(png_jmpbuf(r->png))) {
        return broken_off(r);
    }
    png_init_io(r->png, r->file);
    png_read_info(r->png, r->info);
    r->bits = png_get_bit_depth(r->png, r->info) == 16 ? 16 : 8;
    if (png_get_color_type(r->png, r->info) == PNG_COLOR_TYPE_PALETTE) {
        png_set_palette_to_rgb(r->png);
    }
    if (png_get_bit_depth(r->png, r->info) < 8) {
        png_set_expand_gray_1_2_4_to_8(r->png);
    }
    png_set_strip_alpha(r->png);
    (void)png_set_interlace_handling(r->png);
    png_read_update_info(r->png, r->info);
    r->height = png_get_image_height(r->png, r->info);
    r->width = png_get_image_width(r->png, r->info);
    r->channels = png_get_channels(r->png, r->info);
    return 0;
}

int brdffit_cli_png_shape(const char *path, size_t shape[3])
{
    struct reader r;
    const int code = begin(&r, path);
    shape[0] = r.height;
    shape[1] = r.width;
    shape[2] = r.channels;
    finish(&r);
    return code;
}

static int read_pixels(struct reader *r)
{
    const size_t stride = png_get_rowbytes(r->png, r->info);
    r->pixels = malloc(r->height * stride);
    r->rows = calloc(r->height, sizeof *r->rows);
    if (r->pixels == NULL || r->rows == NULL) {
        return brdffit_cli_no_memory();
    }
    for (size_t y = 0; y < r->height; y++) {
        r->rows[y] = r->pixels + y * stride;
    }
    if (setjmp(png_jmpbuf(r->png))) {
        return broken_off(r);
    }
    png_read_image(r->png, (png_bytepp)r->rows);
    png_read_end(r->png, NULL);
    return 0;
}

/* What each of the 256 values of 8 bits stands for. */
static void make_curve(float curve[256], int srgb)
{
    for (int v = 0; v < 256; v++) {
        const double c = v / 255.0;
        curve[v] = (float)(!srgb ? c : c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
    }
}

static void put_float(struct cli_text *row, float value)
{
    uint32_t bits;
    char bytes[4];
    memcpy(&bits, &value, sizeof bits);
    for (int i = 0; i < 4; i++) {
        bytes[i] = (char)(unsigned char)(bits >> 8 * i);
    }
    brdffit_cli_text_add(row, bytes, 4);
}

static int write_pixels(const struct reader *r, const float curve[256], struct cli_output *output)
{
    struct cli_text row = {0};
    int failed = 0;
    for (size_t y = 0; y < r->height && !failed; y++) {
        const unsigned char *at = r->rows[y];
        brdffit_cli_text_clear(&row);
        for (size_t i = 0; i < r->width * r->channels; i++, at += r->bits / 8) {
            put_float(&row, r->bits == 8 ? curve[at[0]] : (float)((at[0] << 8 | at[1]) / 65535.0));
        }
        failed = brdffit_cli_output_add(output, &row) != 0;
    }
    brdffit_cli_text_free(&row);
    return failed ? CLI_EXIT_FAILURE : 0;
}

static int unpack_one(const struct cli_map *map, const char *path, const float curve[256], struct cli_output *output)
{
    struct reader r;
    int code = begin(&r, path);
    if (code == 0 && (r.height != map->height || r.width != map->width || r.channels != map->channels)) {
        brdffit_cli_tell("brdffit: %s: the image changed while it was read\n", path);
        code = CLI_EXIT_DATA;
    }
    if (code == 0 && r.bits == 16 && map->settings->srgb) {
        brdffit_cli_tell("brdffit: %s: --srgb is for 8-bit images, and this one has 16\n", path);
        code = CLI_EXIT_DATA;
    }
    if (code == 0) {
        code = read_pixels(&r);
    }
    if (code == 0) {
        code = write_pixels(&r, curve, output);
    }
    finish(&r);
    return code;
}

static int open_unpacked(struct cli_map *map, const char *path)
{
    brdffit_error error = {0};
    errno = 0;
    const brdffit_status status = brdffit_io_array_open(path, NULL, &map->stack, &error);
    if (status != BRDFFIT_OK) {
        brdffit_cli_report_error(path, &error, NULL, errno);
    }
    return brdffit_cli_status_exit(status);
}

int brdffit_cli_png_unpack(struct cli_map *map)
{
    const size_t shape[4] = {map->samples, map->height, map->width, map->channels};
    char *const path = brdffit_cli_map_path(map, "images.npy");
    unsigned char header[BRDFFIT_IO_HEADER_MAX];
    float curve[256];
    struct cli_output output;
    struct cli_text head = {0};
    if (path == NULL) {
        return brdffit_cli_no_memory();
    }
    int code = brdffit_cli_output_replace(&output, path) != 0 ? CLI_EXIT_FAILURE : 0;
    if (code == 0) {
        brdffit_cli_text_add(&head, (const char *)header, brdffit_io_npy_header('f', 4, 4, shape, header));
        code = brdffit_cli_output_add(&output, &head) != 0 ? CLI_EXIT_FAILURE : 0;
        make_curve(curve, map->settings->srgb);
        for (size_t i = 0; code == 0 && i < map->samples; i++) {
            code = unpack_one(map, map->images[i], curve, &output);
        }
        if (code != 0) {
            brdffit_cli_output_abandon(&output);
        } else if (brdffit_cli_output_commit(&output) != 0) {
            code = CLI_EXIT_FAILURE;
        }
    }
    brdffit_cli_text_free(&head);
    if (code == 0) {
        code = open_unpacked(map, path);
    }
    free(path);
    return code;
}
