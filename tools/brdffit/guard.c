/* guard.c: files that are cut short, or fail, while they are mapped. SPDX-License-Identifier: MIT
 *
 * brdffit_io_read_sums() maps a table, which takes a third of the time that reading it does. Who truncates the file
 * meanwhile takes pages away, and touching one of those is SIGBUS, which would end a run of many files. The handler puts
 * an empty page in its place, so that the reading comes to its end, and makes a note. */
#define _DEFAULT_SOURCE
#include "guard.h"

#include <signal.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static volatile sig_atomic_t guarded, lost;
static uintptr_t page_size;

static void on_lost_page(int number, siginfo_t *info, void *context)
{
    const uintptr_t page = (uintptr_t)info->si_addr & ~(page_size - 1);
    (void)context;
    lost = 1;
    if (!guarded ||
        mmap((void *)page, page_size, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == MAP_FAILED) {
        (void)signal(number, SIG_DFL); /* and again, for good */
    }
}

static void install(void)
{
    struct sigaction action;
    page_size = (uintptr_t)sysconf(_SC_PAGESIZE);
    memset(&action, 0, sizeof action);
    (void)sigemptyset(&action.sa_mask);
    action.sa_sigaction = on_lost_page;
    action.sa_flags = SA_SIGINFO;
    (void)sigaction(SIGBUS, &action, NULL);
}

void brdffit_cli_guard_begin(void)
{
    if (page_size == 0) {
        install();
    }
    lost = 0;
    guarded = 1;
}

int brdffit_cli_guard_end(void)
{
    guarded = 0;
    return lost;
}
