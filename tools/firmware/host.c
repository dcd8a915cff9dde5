/*
 * The example on a computer: what firmware is compared with. SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>

#include "platform.h"

void platform_print(const char *text)
{
    fputs(text, stdout);
}

void platform_exit(int code)
{
    exit(code);
}

uint64_t platform_instructions(void)
{
    return 0;
}

size_t platform_stack(void)
{
    return 0;
}

int main(void)
{
    return firmware_main();
}
