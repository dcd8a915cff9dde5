/*
 * The memory of a fit. SPDX-License-Identifier: MIT
 *
 * What the data reduce to, the result, and the vector form of the problem lie first, for as many samples as there are. Then
 * comes one block that serves twice: as scratch of the reduction, and then for the search, which is laid out in it by
 * what the reduction found (fewer groups than samples, no negative data).
 *
 * A search that is out of nodes or of places for boxes goes on depth first, so that less memory costs boxes before it costs
 * the proof. With options.memory the block is what that leaves, and capacity_of() makes the best of it: nodes first, with
 * their boxes, up to what most searches want; then the shapes of nodes, which save time only; then more of all.
 *
 * How far a search gets is part of the result. So capacities follow from sizes that are the same on every processor: those
 * of 64-bit ones, as upper bounds.
 */
#include "fit/fit.h"
#include "base/tolerance.h"
#include "base/vector.h"

/* Sizes to count with, whatever the processor. */
#define HANDOUT_BYTES 1152u
#define NODE_BYTES 104u
#define INTERVAL_BYTES 96u
#define BESIDE_BYTES 32u
#define BOX_BYTES 32u
#define PAIR_BYTES 48u
#define AXIS_BYTES (8u + 2u * 12u) /* a coordinate and two intervals */
_Static_assert(sizeof(struct handout) <= HANDOUT_BYTES, "sizes to count with");
_Static_assert(sizeof(struct node) <= NODE_BYTES && sizeof(struct interval) <= INTERVAL_BYTES, "sizes to count with");
_Static_assert(sizeof(struct beside) <= BESIDE_BYTES && sizeof(struct box) <= BOX_BYTES, "sizes to count with");
_Static_assert(sizeof(struct pair) <= PAIR_BYTES && sizeof(struct axis_interval) <= 12u, "sizes to count with");

/* What a search has room for. */
struct capacity {
    uint32_t nodes, lent, shaped, pairs;
    size_t boxes;
};

/* What the search is laid out for: before a reduction the most that there may be. */
struct extent {
    size_t count, channels, functionals;
    uint32_t rows; /* samples, for what lies by row */
};

static int by_moments(const brdffit_options *o)
{
    return o->norm == BRDFFIT_NORM_L2 && o->engine == BRDFFIT_ENGINE_MOMENT && !brdffit_options_two_shapes(o);
}

/* Levels that a search may go depth first: enough for every side to be halved until it is too narrow. */
static uint32_t levels(const brdffit_options *o)
{
    return LIMIT_HALVINGS * (uint32_t)(o->lobes + o->anisotropic);
}

/* Every split makes one node, so a budget of boxes bounds them too. Engine socp keeps nothing else about nodes. */
static uint32_t most_nodes(const brdffit_options *o)
{
    static const size_t caps[] = {LIMIT_NODES_ONE, LIMIT_NODES_TWO, LIMIT_NODES_MORE};
    size_t cap = by_moments(o)                   ? caps[o->lobes - 1]
                 : brdffit_options_two_shapes(o) ? LIMIT_NODES_MORE
                                                 : LIMIT_NODES_SOCP;
    size_t wanted = o->box_budget < cap ? o->box_budget + FIRST_INTERVALS + 2 + levels(o) : cap;

    return (uint32_t)(wanted < cap ? wanted : cap);
}

/* Boxes open at once: a split closes one and opens one more than lobes at most. */
static size_t most_boxes(const brdffit_options *o)
{
    static const size_t caps[] = {LIMIT_HEAP_ONE, LIMIT_HEAP_TWO, LIMIT_HEAP};
    size_t cap = by_moments(o) ? caps[o->lobes - 1] : LIMIT_HEAP;
    size_t wanted = o->box_budget < cap ? o->box_budget + 2 + BRDFFIT_MAX_LOBES : cap;

    return wanted < cap ? wanted : cap;
}

/* Doubles of all shapes of one node of each kind. */
static size_t shape_doubles(const struct model *model, const struct extent *e)
{
    size_t kept = 0;
    int i;

    for (i = 0; i < model->kinds; i++) {
        kept += moments_kept(model->kind[i]);
    }
    return kept * (e->count ? PADDED(e->count) : LANES); /* there may be none */
}

/* Where memory does not matter. */
static struct capacity plenty(const struct model *model, const struct extent *e, const brdffit_options *o)
{
    struct capacity c = {.nodes = most_nodes(o), .lent = levels(o), .boxes = most_boxes(o)};
    size_t shaped = LIMIT_SHAPE_DOUBLES / shape_doubles(model, e);

    c.shaped = shaped < c.nodes + (size_t)model->lobes ? (uint32_t)shaped : c.nodes + (uint32_t)model->lobes;
    c.pairs = model->lobes * model->each > 1 ? LIMIT_PAIRS * (uint32_t)(model->each * model->each) : 0;
    return c;
}

/* Bytes of one more node of each kind, but for shapes. */
static size_t bare_bytes(const struct model *model, const struct extent *e)
{
    return (size_t)model->kinds * (NODE_BYTES + 1 + 8 * (e->channels + (size_t)model->fixed) + 24 * e->functionals);
}

/* The same with the two intervals that come with it, and so many quarters of a box. */
static size_t node_bytes(const struct model *model, const struct extent *e, size_t quarters)
{
    size_t interval = INTERVAL_BYTES + 1 + 16 * (e->channels + (size_t)model->fixed);
    size_t second = (size_t)(model->kinds - model->axes);

    return bare_bytes(model, e) + 2 * ((size_t)model->kinds * interval + second * BESIDE_BYTES) +
           (size_t)model->axes * AXIS_BYTES + quarters * BOX_BYTES / 4;
}

/* Bytes of what does not depend on the number of nodes: nodes at any theta, scratch, sums by channel, and what aligning
 * each array costs. */
static size_t fixed_bytes(const struct model *model, const struct extent *e, const brdffit_options *o)
{
    size_t limits = o->physical ? (size_t)(1 + model->fixed + 4 * (model->columns - model->fixed)) : 0;
    size_t by_channel = (size_t)(1 + model->fixed) + limits;
    size_t second = (size_t)(model->kinds - model->axes);
    size_t arrays = by_channel + 8 * (size_t)model->kinds + second + 2 * (size_t)model->axes + 3;

    return (size_t)model->lobes * bare_bytes(model, e) + 8 * brdffit_moments_scratches(model) * PADDED(e->count) +
           by_channel * 8 * e->channels + arrays * ARENA_ALIGNMENT;
}

/* Quarters of boxes that are open at once for each node, and nodes that most searches want: 100 materials, and some more. */
static const size_t quarters[] = {1, 12, 96};
static const size_t nodes_wanted[] = {96, 192, 256};

/* Fewest nodes that a search is begun with. */
#define FEWEST_NODES 8u

/* The most of `bytes`, which hold FEWEST_NODES. */
static struct capacity capacity_of(size_t bytes, const struct model *model, const struct extent *e,
                                   const brdffit_options *o)
{
    struct capacity most = plenty(model, e, o), c = most;
    size_t wanted = nodes_wanted[o->lobes - 1], boxes = quarters[o->lobes - 1], nodes, shaped = 0;
    size_t each = node_bytes(model, e, boxes), shape = 8 * shape_doubles(model, e), left;

    while (c.pairs > 16 && c.pairs * PAIR_BYTES > bytes / 8) {
        c.pairs /= 2;
    }
    left = bytes - fixed_bytes(model, e, o) - c.pairs * PAIR_BYTES - 8 * BOX_BYTES;
    nodes = left / each;
    if (nodes > wanted) {
        shaped = (left - wanted * each) / shape;
        nodes = shaped < wanted ? wanted : left / (each + shape);
        shaped = shaped < wanted ? shaped : nodes;
    }
    c.nodes = nodes < most.nodes ? (uint32_t)nodes : most.nodes;
    c.boxes = boxes * nodes / 4 + 8 < most.boxes ? boxes * nodes / 4 + 8 : most.boxes;
    c.shaped = shaped < most.shaped ? (uint32_t)shaped : most.shaped;
    c.lent = c.nodes / 4 < most.lent ? c.nodes / 4 : most.lent;
    return c;
}

/* The least that a search can be laid out in. */
static size_t least_bytes(const struct model *model, const struct extent *e, const brdffit_options *o)
{
    return fixed_bytes(model, e, o) + FEWEST_NODES * node_bytes(model, e, quarters[o->lobes - 1]) + 8 * BOX_BYTES +
           (model->lobes * model->each > 1 ? 16 * PAIR_BYTES : 0);
}

static void layout_search(struct fit *f, struct arena *arena, const struct extent *e, const struct capacity *c,
                          const brdffit_options *o)
{
    const struct moments_room room = {.nodes = c->nodes,
                                      .shaped = c->shaped,
                                      .pairs = c->pairs,
                                      .stride = PADDED(e->count),
                                      .channels = e->channels,
                                      .functionals = e->functionals};
    int axis, two = brdffit_options_two_shapes(o);

    for (axis = 0; axis < (two ? f->model.sides : f->model.axes); axis++) {
        brdffit_axis_layout(&f->axis[axis], arena, c->nodes);
        brdffit_axis_reserve(&f->axis[axis], c->lent);
    }
    brdffit_heap_layout(&f->heap, arena, c->boxes);
    if (o->norm != BRDFFIT_NORM_L2) {
        brdffit_l1_linf_layout(&f->restricted, arena, e->rows, e->channels, &f->model, o->norm);
        brdffit_bound_lp_layout(&f->linear, arena, e->rows, e->channels, &f->model, o->norm);
    } else if (o->engine == BRDFFIT_ENGINE_SOCP) {
        brdffit_bound_socp_layout(&f->socp, arena, e->rows, e->channels, &f->model);
    } else if (two) {
        brdffit_bound_cell_layout(&f->cells, arena, e->rows, e->channels, &f->model);
    } else {
        brdffit_bound_moment_layout(&f->moment, arena, &room, &f->model);
        if (o->physical) {
            brdffit_limits_layout(&f->moment.limits, arena, e->channels, &f->model);
        }
    }
}

/* What arrays of a fit are counted as taking. */
static size_t counted(const struct arena *arena)
{
    return arena->failed ? SIZE_MAX : arena->used - (ARENA_ALIGNMENT - 1);
}

static size_t plenty_bytes(struct fit *f, const struct extent *e, const brdffit_options *o)
{
    const struct capacity c = plenty(&f->model, e, o);
    struct arena arena;

    brdffit_arena_init(&arena, NULL, 0);
    layout_search(f, &arena, e, &c, o);
    return counted(&arena);
}

static size_t scratch_bytes(struct fit *f, const struct extent *e)
{
    struct arena arena;

    brdffit_arena_init(&arena, NULL, 0);
    brdffit_reduce_layout_scratch(&f->data, &arena, e->rows, e->channels, &f->model);
    return counted(&arena);
}

/* Size of the block; `kept` bytes lie before it. */
static size_t block_bytes(struct fit *f, const struct extent *e, size_t kept, const brdffit_options *o)
{
    size_t scratch = scratch_bytes(f, e), search = plenty_bytes(f, e, o), left, least;

    f->limited = 0;
    if (o->memory > 0 && by_moments(o)) {
        left = o->memory > kept ? (o->memory - kept) / ARENA_ALIGNMENT * ARENA_ALIGNMENT : 0;
        least = least_bytes(&f->model, e, o);
        f->limited = left < search;
        search = left > search ? search : left > least ? left : least;
    }
    return search > scratch ? search : scratch;
}

static void layout_kept(struct fit *f, struct arena *arena, size_t count, size_t channels, const brdffit_options *o)
{
    f->handout = brdffit_arena_take(arena, 1, HANDOUT_BYTES);
    f->x = ARENA_DOUBLES(arena, channels);
    f->y = brdffit_arena_take(arena, channels, (size_t)o->lobes * sizeof(double));
    f->rms = ARENA_DOUBLES(arena, channels);
    f->z = brdffit_arena_take(arena, channels, (size_t)f->model.columns * sizeof(double));
    f->f0 = f->model.each > 1 ? brdffit_arena_take(arena, channels, (size_t)o->lobes * sizeof(double)) : NULL;
    f->x_more = f->model.fixed > 1 ? brdffit_arena_take(arena, channels, (size_t)(f->model.fixed - 1) * sizeof(double))
                                   : NULL;
    f->at_limit = o->physical ? brdffit_arena_take(arena, channels, sizeof *f->at_limit) : NULL;
    brdffit_varpro_layout(&f->varpro, arena, count, channels, &f->model);
}

void brdffit_fit_layout(struct fit *f, struct arena *arena, size_t count, size_t channels, const brdffit_options *o)
{
    struct extent e = {.count = count, .channels = channels, .rows = (uint32_t)count};
    size_t begin = arena->used;
    struct arena block;

    brdffit_model_make(&f->model, o);
    layout_kept(f, arena, count, channels, o);
    brdffit_reduce_layout_kept(&f->data, arena, count, channels, &f->model); /* last: it shrinks */
    if (arena->failed) {
        return;
    }
    f->rows_error = 0.0;
    f->physical = 0;
    e.functionals = reduced_functionals(&f->model, channels);
    f->block_bytes = block_bytes(f, &e, arena->used - begin + (ARENA_ALIGNMENT - 1), o);
    f->block = brdffit_arena_take(arena, 1, f->block_bytes);
    brdffit_arena_init(&block, f->block, f->block_bytes);
    brdffit_reduce_layout_scratch(&f->data, &block, count, channels, &f->model);
}

void brdffit_fit_layout_search(struct fit *f, const brdffit_options *o)
{
    const struct extent e = {.count = f->data.distinct,
                             .channels = f->data.channels,
                             .functionals = f->data.functionals,
                             .rows = (uint32_t)f->data.room};
    unsigned char *end = (unsigned char *)f->block + f->block_bytes, *begin = brdffit_reduce_pack(&f->data);
    size_t bytes = (size_t)(end - begin);
    const struct capacity c = f->limited ? capacity_of(bytes, &f->model, &e, o) : plenty(&f->model, &e, o);
    struct arena arena;

    brdffit_arena_init(&arena, begin, bytes);
    layout_search(f, &arena, &e, &c, o);
}

size_t brdffit_fit_workspace(size_t count, size_t channels, const brdffit_options *options)
{
    size_t given = 0;
    struct arena arena;
    struct fit fit;

    if (channels == 0 || brdffit_options_check(options, NULL) != BRDFFIT_OK) {
        return 0;
    }
    brdffit_arena_init(&arena, NULL, 0);
    brdffit_fit_layout(&fit, &arena, count, channels, options);
    if (brdffit_options_two_shapes(options)) { /* what was found is fitted once more, in the same workspace */
        brdffit_options again = *options;

        again.anisotropy = 1.0;
        given = brdffit_fit_workspace(count, channels, &again);
    }
    return arena.failed ? 0 : arena.used > given ? arena.used : given;
}
