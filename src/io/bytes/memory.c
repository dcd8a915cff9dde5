/*
 * The only allocations of libbrdffit_io: see memory.h. SPDX-License-Identifier: MIT
 */
#include "io/bytes/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef BRDFFIT_TEST_ALLOC
static long test_successes = -1;
static size_t test_live;

void brdffit_io_test_fail_after(long successes)
{
    test_successes = successes;
}

size_t brdffit_io_test_live(void)
{
    return test_live;
}

static int test_refuses(void)
{
    if (test_successes == 0) {
        return 1;
    }
    test_successes -= test_successes > 0;
    return 0;
}

#define REFUSED() test_refuses()
#define BORN(block) (test_live += (block) != NULL)
#define DIED(block) (test_live -= (block) != NULL)
#else
#define REFUSED() 0
#define BORN(block) ((void)0)
#define DIED(block) ((void)0)
#endif

void *brdffit_io_resize(void *block, size_t count, size_t size)
{
    void *moved;

    if (REFUSED() || (size > 0 && count > SIZE_MAX / size)) {
        return NULL;
    }
    moved = realloc(block, count * size > 0 ? count * size : 1);
    if (!block) {
        BORN(moved);
    }
    return moved;
}

void *brdffit_io_alloc(size_t count, size_t size)
{
    return brdffit_io_resize(NULL, count, size);
}

void *brdffit_io_alloc_zero(size_t count, size_t size)
{
    void *block = brdffit_io_alloc(count, size);

    if (block) {
        memset(block, 0, count * size);
    }
    return block;
}

void brdffit_io_release(void *block)
{
    DIED(block);
    free(block);
}
