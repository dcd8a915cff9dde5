/*
 * Where a reduction keeps what it makes: first what is by channel and by sample, then what is by group, which can be packed
 * once the groups are known; and its scratch. SPDX-License-Identifier: MIT
 */
#include "data/reduce.h"

#include <string.h>

#include "data/reduce_parts.h"
#include "model/lobe.h"

static void layout_scratch(struct table *t, struct arena *arena, size_t count)
{
    t->sample_b = ARENA_DOUBLES(arena, count);
    t->sample_c = ARENA_DOUBLES(arena, count);
    t->sample_light = t->masked ? ARENA_DOUBLES(arena, count) : NULL;
    t->sample_view = t->masked ? ARENA_DOUBLES(arena, count) : NULL;
}

/* An array by group, at its place in the arena: what it held, if anything, moves there. */
static void place(struct arena *arena, double **array, size_t count, size_t doubles, int move)
{
    double *to = brdffit_arena_take(arena, count, doubles * sizeof(double));

    if (move && to != *array) {
        memmove(to, *array, count * doubles * sizeof(double));
    }
    *array = to;
}

/* Arrays by group, `stride` apart. To `move` them is to pack them, in this order, where they begin. */
static void layout_groups(struct reduced *r, struct arena *arena, size_t stride, size_t functionals, int move)
{
    int g, h;

    for (g = 0; g < r->geometries; g++) {
        struct table *t = &r->table[g];
        struct charge *c = &t->charge;

        place(arena, &t->c, stride, 1, move);
        place(arena, &t->bb, stride, 1, move);
        place(arena, &t->concentration, stride, 1, move);
        place(arena, &t->linear, stride, functionals, move);
        place(arena, &c->gamma, stride, 1, move);
        place(arena, &c->off, stride, 1, move);
        place(arena, &c->weight, stride, 1, move);
        if (t->masked) {
            place(arena, &t->light, stride, 1, move);
            place(arena, &t->view, stride, 1, move);
        } else {
            t->light = t->view = NULL;
        }
        for (h = 0; h < g; h++) {
            place(arena, &r->cross[g * (g - 1) / 2 + h], stride, 1, move);
        }
    }
}

void *brdffit_reduce_pack(struct reduced *r)
{
    struct arena arena;
    int g;

    brdffit_arena_init(&arena, r->table[0].c, SIZE_MAX / 2);
    layout_groups(r, &arena, r->stride, r->functionals, 1);
    for (g = 0; g < r->geometries; g++) {
        r->table[g].sight.c = r->table[g].c;
        r->table[g].sight.light = r->table[g].light;
        r->table[g].sight.view = r->table[g].view;
    }
    return arena.base + arena.used;
}

/* Columns of a sample's row: data, fixed columns, and one a geometry. */
static size_t width_of(size_t channels, const struct model *model)
{
    return channels + (size_t)model->fixed + (size_t)model->geometries;
}

void brdffit_reduce_layout_kept(struct reduced *reduced, struct arena *arena, size_t count, size_t channels,
                                const struct model *model)
{
    size_t fixed = (size_t)model->fixed, width = width_of(channels, model);
    int geometries = model->geometries, g;

    if (channels > SIZE_MAX / 64 || count > UINT32_MAX || width > SIZE_MAX / 8 / (width + REDUCE_BLOCK)) {
        arena->failed = 1;
        return;
    }
    reduced->channels = channels;
    reduced->geometries = geometries;
    reduced->bases = model->bases;
    reduced->fixed = model->fixed;
    reduced->room = count;
    for (g = 0; g < geometries; g++) {
        reduced->table[g].masked = model->kind[model->shown_by[g]]->smith ||
                                   (g % model->bases == 0 && model->shapes > 1);
        reduced->table[g].row_b = ARENA_DOUBLES(arena, count);
    }
    reduced->bound_channel = brdffit_arena_take(arena, channels, sizeof(uint64_t)); /* the same on any processor */
    reduced->bound_root = ARENA_DOUBLES(arena, channels);
    reduced->ai = brdffit_arena_take(arena, channels, fixed * sizeof(double));
    reduced->ii = ARENA_DOUBLES(arena, channels);
    reduced->channel_scale = ARENA_DOUBLES(arena, channels);
    reduced->row_a = brdffit_arena_take(arena, count, fixed * sizeof(double));
    reduced->row_value = brdffit_arena_take(arena, count, channels * sizeof(double));
    reduced->row_c = brdffit_arena_take(arena, count, sizeof(uint32_t));
    reduced->row_square = ARENA_DOUBLES(arena, count);
    reduced->sample = brdffit_arena_take(arena, count, sizeof(uint32_t));
    reduced->begin = brdffit_arena_take(arena, count + 1, sizeof(uint32_t));
    layout_groups(reduced, arena, PADDED(count), reduced_functionals(model, channels), 0);
}

void brdffit_reduce_layout_scratch(struct reduced *reduced, struct arena *arena, size_t count, size_t channels,
                                   const struct model *model)
{
    size_t fixed = (size_t)model->fixed, width = width_of(channels, model);
    int g;

    for (g = 0; g < model->geometries; g++) {
        layout_scratch(&reduced->table[g], arena, count);
    }
    reduced->sample_a = brdffit_arena_take(arena, count, fixed * sizeof(double));
    reduced->off_a = brdffit_arena_take(arena, count, fixed * sizeof(double));
    reduced->sample_factor = ARENA_DOUBLES(arena, count);
    reduced->order = brdffit_arena_take(arena, count, sizeof(uint32_t));
    reduced->merge = brdffit_arena_take(arena, count, sizeof(uint32_t));
    reduced->block = ARENA_DOUBLES(arena, width * (width + REDUCE_BLOCK));
    brdffit_charge_layout_scratch(reduced, arena, PADDED(count));
}

void brdffit_reduce_layout(struct reduced *reduced, struct arena *arena, size_t count, size_t channels,
                           const struct model *model)
{
    brdffit_reduce_layout_kept(reduced, arena, count, channels, model);
    if (!arena->failed) {
        brdffit_reduce_layout_scratch(reduced, arena, count, channels, model);
    }
}
