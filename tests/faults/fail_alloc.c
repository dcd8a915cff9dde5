/*
 * An allocator that refuses: for LD_PRELOAD. SPDX-License-Identifier: MIT
 *
 *     FAIL_ALLOC_AT=K           refuse the K-th allocation (from 1; 0 or absent: none) ...
 *     FAIL_ALLOC_FOR_GOOD=1     ... and all that follow
 *     FAIL_ALLOC_COUNT=FILE     write at the end how many there were
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static atomic_long asked;
static long refused_at;
static int for_good, ready;

/* What dlsym() itself takes while it looks for the real ones. */
static _Alignas(max_align_t) unsigned char early[65536];
static size_t early_used;

static void *(*real_malloc)(size_t);
static void *(*real_calloc)(size_t, size_t);
static void *(*real_realloc)(void *, size_t);
static void *(*real_aligned_alloc)(size_t, size_t);
static void (*real_free)(void *);

static void *find(const char *name)
{
    return dlsym(RTLD_NEXT, name);
}

__attribute__((constructor)) static void start(void)
{
    const char *const at = getenv("FAIL_ALLOC_AT"), *const good = getenv("FAIL_ALLOC_FOR_GOOD");

    *(void **)&real_malloc = find("malloc");
    *(void **)&real_calloc = find("calloc");
    *(void **)&real_realloc = find("realloc");
    *(void **)&real_aligned_alloc = find("aligned_alloc");
    *(void **)&real_free = find("free");
    refused_at = at ? atol(at) : 0;
    for_good = good && *good == '1';
    ready = 1;
}

__attribute__((destructor)) static void tell(void)
{
    const char *const path = getenv("FAIL_ALLOC_COUNT");
    const long count = asked;
    FILE *file;

    refused_at = 0;
    file = path ? fopen(path, "w") : NULL;
    if (file) {
        fprintf(file, "%ld\n", count);
        fclose(file);
    }
}

static int refuse(void)
{
    const long number = atomic_fetch_add(&asked, 1) + 1;
    const int no = refused_at > 0 && (number == refused_at || (for_good && number > refused_at));

    if (no) {
        errno = ENOMEM;
    }
    return no;
}

/* These stand before those of the C library. */
#pragma GCC visibility push(default)
void *malloc(size_t size);
void *calloc(size_t count, size_t size);
void *realloc(void *block, size_t size);
void *aligned_alloc(size_t alignment, size_t size);
void free(void *block);
#pragma GCC visibility pop

static int is_early(const void *block)
{
    return (const unsigned char *)block >= early && (const unsigned char *)block < early + sizeof early;
}

static void *take_early(size_t size)
{
    unsigned char *const block = early + early_used;

    early_used += (size / sizeof(max_align_t) + 1) * sizeof(max_align_t);
    return early_used <= sizeof early ? block : NULL;
}

void *malloc(size_t size)
{
    return !ready ? take_early(size) : refuse() ? NULL : real_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return !ready ? take_early(count * size) : refuse() ? NULL : real_calloc(count, size);
}

void *realloc(void *block, size_t size)
{
    void *moved;

    if (ready && !is_early(block)) {
        return refuse() ? NULL : real_realloc(block, size);
    }
    moved = malloc(size); /* the length of an early block is not known, but that of its neighbourhood is enough */
    if (moved && block) {
        memcpy(moved, block, size < 256 ? size : 256);
    }
    return moved;
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return refuse() ? NULL : real_aligned_alloc(alignment, size);
}

void free(void *block)
{
    if (block && ready && !is_early(block)) {
        real_free(block);
    }
}
