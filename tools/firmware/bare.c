/*
 * The example on a bare processor under QEMU: start, output by semihosting, instructions, stack. SPDX-License-Identifier: MIT
 *
 * QEMU's -icount shift=0 makes an instruction a nanosecond: RISC-V counts them in minstret, and a timer of the ARM boards, of 25 MHz
 * and 32 bits, goes down by one every forty.
 */
#include "platform.h"

extern unsigned char __stack_low[], __stack_top[], __bss_start[], __bss_end[];
extern unsigned char __data_start[], __data_end[], __data_load[];

#define PAINT 0xa5u
#define SYS_WRITE0 0x04
#define SYS_EXIT 0x18
#define EXIT_FINE 0x20026
#define EXIT_FAILED 0x20023

void start(void);

#if defined(__arm__)

static int semihost(int call, const void *argument)
{
    register int r0 __asm__("r0") = call;
    register const void *r1 __asm__("r1") = argument;

    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define TIMER_CONTROL REGISTER(0x40000000u)
#define TIMER_VALUE REGISTER(0x40000004u)
#define TIMER_RELOAD REGISTER(0x40000008u)
#define COPROCESSORS REGISTER(0xe000ed88u)
#define TICK 40u

static void set_up(void)
{
#if defined(__ARM_FP)
    COPROCESSORS |= 0xfu << 20;
    __asm__ volatile("dsb\n\tisb" : : : "memory");
#endif
    TIMER_RELOAD = TIMER_VALUE = UINT32_MAX;
    TIMER_CONTROL = 1;
}

uint64_t platform_instructions(void)
{
    return (uint64_t)(UINT32_MAX - TIMER_VALUE) * TICK;
}

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    __stack_top,
    (const void *)start,
};

#else /* RISC-V */

static int semihost(int call, const void *argument)
{
    register int a0 __asm__("a0") = call;
    register const void *a1 __asm__("a1") = argument;

    __asm__ volatile(".balign 16\n\t.option push\n\t.option norvc\n\tslli x0, x0, 0x1f\n\tebreak\n\tsrai x0, x0, 7\n\t"
                     ".option pop"
                     : "+r"(a0)
                     : "r"(a1)
                     : "memory");
    return a0;
}

static void set_up(void)
{
}

uint64_t platform_instructions(void)
{
    uint32_t low, high, again;

    do {
        __asm__ volatile(".option push\n\t.option arch, +zicsr\n\tcsrr %0, minstreth\n\tcsrr %1, minstret\n\t"
                         "csrr %2, minstreth\n\t.option pop"
                         : "=r"(high), "=r"(low), "=r"(again));
    } while (high != again);
    return (uint64_t)high << 32 | low;
}

/* No stack yet, and floating-point registers are off. */
__asm__(".section .vectors, \"ax\"\n\t.globl _start\n_start:\n\tla sp, __stack_top\n\tli t0, 0x2000\n\t"
        ".option push\n\t.option arch, +zicsr\n\tcsrs mstatus, t0\n\t.option pop\n\tj start\n\t.text");

#endif

void platform_print(const char *text)
{
    (void)semihost(SYS_WRITE0, text);
}

void platform_exit(int code)
{
    (void)semihost(SYS_EXIT, (const void *)(uintptr_t)(code ? EXIT_FAILED : EXIT_FINE));
    for (;;) {
    }
}

size_t platform_stack(void)
{
    const unsigned char *low = __stack_low;

    while (low < __stack_top && *low == PAINT) {
        low++;
    }
    return (size_t)(__stack_top - low);
}

void start(void)
{
    unsigned char *to, *here = (unsigned char *)__builtin_frame_address(0) - 256;
    const unsigned char *from = __data_load;

    for (to = __data_start; to < __data_end && to != from; to++) {
        *to = *from++;
    }
    for (to = __bss_start; to < __bss_end; to++) {
        *to = 0;
    }
    for (to = __stack_low; to < here; to++) {
        *to = PAINT;
    }
    set_up();
    platform_exit(firmware_main());
}
