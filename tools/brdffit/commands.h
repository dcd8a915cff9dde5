/* commands.h: one function a subcommand, one file each. Each takes argv from
 * its own name on, and returns the exit code.
 * SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_COMMANDS_H
#define BRDFFIT_CLI_COMMANDS_H

int brdffit_cli_fit(int argc, char **argv);
int brdffit_cli_eval(int argc, char **argv);
int brdffit_cli_info(int argc, char **argv);
int brdffit_cli_map(int argc, char **argv);
int brdffit_cli_merge(int argc, char **argv);
int brdffit_cli_compare(int argc, char **argv);
int brdffit_cli_completion(int argc, char **argv);

/* The help of a command on standard output. */
void brdffit_cli_fit_help(void);
void brdffit_cli_eval_help(void);
void brdffit_cli_info_help(void);
void brdffit_cli_map_help(void);
void brdffit_cli_merge_help(void);
void brdffit_cli_compare_help(void);
void brdffit_cli_completion_help(void);

struct cli_command {
    const char *name; /* NULL ends the list */
    int (*run)(int argc, char **argv);
    void (*help)(void);
    const char *summary;
    unsigned options; /* whose of settings.c: CLI_FIT, ...; 0: none */
};

extern const struct cli_command brdffit_cli_commands[];

#endif
