/* interrupt.h: signals. The first Ctrl-C asks a running search to stop and
 * report what it has; the second one, and every other request to terminate,
 * ends the program and leaves no temporary file behind.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_INTERRUPT_H
#define BRDFFIT_CLI_INTERRUPT_H

/* Install the handlers. A closed pipe or a file too large for its limit
 * becomes an error of write(). */
void brdffit_cli_catch_signals(void);

/* Before another program takes over: what was ignored ends it again. */
void brdffit_cli_release_signals(void);

/* From now on the first Ctrl-C only sets brdffit_cli_interrupted(). */
void brdffit_cli_cancel_on_interrupt(void);

int brdffit_cli_interrupted(void);

/* The file to remove when a signal ends the program; NULL: none. The string
 * must stay alive until the next call. */
void brdffit_cli_remove_on_signal(const char *path);

#endif
