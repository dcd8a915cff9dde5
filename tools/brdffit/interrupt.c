/* interrupt.c: signals. The only globals of the program: a handler can reach
 * nothing else. SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700 /* POSIX 2008 with SIGXFSZ */
#include "interrupt.h"

#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t interrupted;
static volatile sig_atomic_t cancels;
static const char *volatile to_remove;
static struct sigaction pipe_before, size_before;

static const int ending[] = {SIGINT, SIGTERM, SIGHUP};
#define ENDING_COUNT (sizeof ending / sizeof *ending)

static void on_signal(int number)
{
    if (number == SIGINT && cancels && !interrupted) {
        interrupted = 1;
        return;
    }
    if (to_remove != NULL) {
        (void)unlink(to_remove);
    }
    (void)signal(number, SIG_DFL);
    (void)raise(number);
}

void brdffit_cli_catch_signals(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    (void)sigemptyset(&action.sa_mask);
    action.sa_handler = SIG_IGN;
    (void)sigaction(SIGPIPE, &action, &pipe_before);
    /* So does a limit on the size of files. */
    (void)sigaction(SIGXFSZ, &action, &size_before);
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    for (size_t i = 0; i < ENDING_COUNT; i++) {
        struct sigaction before;
        /* What the caller ignores (nohup, a background job) stays ignored. */
        if (sigaction(ending[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN) {
            (void)sigaction(ending[i], &action, NULL);
        }
    }
}

/* Handlers end with exec by themselves; ignoring would be passed on. */
void brdffit_cli_release_signals(void)
{
    (void)sigaction(SIGPIPE, &pipe_before, NULL);
    (void)sigaction(SIGXFSZ, &size_before, NULL);
}

void brdffit_cli_cancel_on_interrupt(void)
{
    cancels = 1;
}

int brdffit_cli_interrupted(void)
{
    return interrupted;
}

/* The handler must never see a path that is being exchanged. */
void brdffit_cli_remove_on_signal(const char *path)
{
    sigset_t block, before;
    (void)sigemptyset(&block);
    for (size_t i = 0; i < ENDING_COUNT; i++) {
        (void)sigaddset(&block, ending[i]);
    }
    (void)sigprocmask(SIG_BLOCK, &block, &before);
    to_remove = path;
    (void)sigprocmask(SIG_SETMASK, &before, NULL);
}
