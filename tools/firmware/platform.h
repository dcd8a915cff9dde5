/*
 * What the example needs of a processor. SPDX-License-Identifier: MIT
 */
#ifndef PLATFORM_H
#define PLATFORM_H

#include <stddef.h>
#include <stdint.h>

void platform_print(const char *text);
void platform_exit(int code);

/* Instructions so far, where the platform counts them; else 0. */
uint64_t platform_instructions(void);

/* Bytes of stack used at most since the start; 0 where nobody knows. */
size_t platform_stack(void);

int firmware_main(void);

#endif
