/*
 * Structures that callers fill, of any version of the interface. SPDX-License-Identifier: MIT
 *
 * Each begins with size_t struct_size, the caller's sizeof, and grows at its end only. What this version knows is
 * copied over defaults; what it does not know must be zero, for it cannot do what that asks.
 *
 * Structures of this kind that the library hands out (a result's model, a table's samples) say the size of the first
 * version as long as later fields are zero: an older program may copy what it knows of them, and pass the copy on.
 */
#ifndef BRDFFIT_INTAKE_H
#define BRDFFIT_INTAKE_H

#include <stddef.h>
#include <string.h>

/* Size of the first version of a structure, from the field that was its last. */
#define INTAKE_LEAST(type, last) (offsetof(type, last) + sizeof(((type *)0)->last))

/* No structure of any version is this large: a size that nobody has set is not believed. */
#define INTAKE_MOST 4096u

/* 1 when *own, which holds defaults, has got the caller's fields; 0 and untouched when *callers cannot be understood. */
static inline int intake(void *own, size_t own_size, size_t least, const void *callers)
{
    size_t size, i;

    if (!callers) {
        return 0;
    }
    memcpy(&size, callers, sizeof size);
    if (!(size >= least && size <= INTAKE_MOST)) {
        return 0;
    }
    for (i = own_size; i < size; i++) {
        if (((const unsigned char *)callers)[i]) {
            return 0;
        }
    }
    memcpy(own, callers, size < own_size ? size : own_size);
    memcpy(own, &own_size, sizeof own_size);
    return 1;
}

/* Fill the caller's structure with what ours holds, as far as it goes, and zeros beyond. NULL: nothing. */
static inline void intake_init(void *callers, size_t size, const void *own, size_t own_size)
{
    if (callers && size >= sizeof size) {
        memset(callers, 0, size);
        memcpy(callers, own, size < own_size ? size : own_size);
        memcpy(callers, &size, sizeof size);
    }
}

/* Hand what ours holds back to the caller's structure, but for its size. */
static inline void intake_return(void *callers, const void *own, size_t own_size)
{
    size_t size;

    memcpy(&size, callers, sizeof size);
    memcpy((unsigned char *)callers + sizeof size, (const unsigned char *)own + sizeof size,
           (size < own_size ? size : own_size) - sizeof size);
}

#endif
