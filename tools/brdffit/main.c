/* main.c: brdffit, the command line of the library. Finds the subcommand;
 * one that it does not know is looked for as brdffit-NAME on the PATH.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "brdffit.h"
#include "commands.h"
#include "failure.h"
#include "interrupt.h"
#include "output.h"
#include "suggest.h"

struct command {
    const char *name;
    int (*run)(int argc, char **argv);
    void (*help)(void);
    const char *summary;
};

static const struct command commands[] = {
    {"fit", brdffit_cli_fit, brdffit_cli_fit_help, "fit a model to measured files, with proof"},
    {"compare", brdffit_cli_compare, brdffit_cli_compare_help, "fit many forms of model: which do the data support"},
    {"eval", brdffit_cli_eval, brdffit_cli_eval_help, "evaluate a fit at a file's directions"},
    {"map", brdffit_cli_map, brdffit_cli_map_help, "fit every texel of a stack of images"},
    {"merge", brdffit_cli_merge, brdffit_cli_merge_help, "put together what fit and map --shard did"},
    {"info", brdffit_cli_info, brdffit_cli_info_help, "what is in a file and what would be used"},
};
#define COMMAND_COUNT (sizeof commands / sizeof *commands)

/* A standard descriptor that the caller closed would be taken by the next
 * file opened, and results would end up there. Fill it so that its own use
 * still fails: standard input cannot be read, the others cannot be written. */
static void guard_descriptors(void)
{
    for (int descriptor = 0; descriptor < 3; descriptor++) {
        if (fcntl(descriptor, F_GETFD) == -1 && errno == EBADF) {
            (void)open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY);
        }
    }
}

static void usage(FILE *out)
{
    fputs("Usage: brdffit COMMAND ...\n\n", out);
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        fprintf(out, "  %-8s %s\n", commands[i].name, commands[i].summary);
    }
    fputs("  report   pages that show fits, their proofs and residuals (of the Python package)\n"
          "  export   a fit as a material of Mitsuba, Blender, glTF, ... (of the Python package)\n",
          out);
    fputs("\n'brdffit COMMAND --help' explains a command; 'brdffit --version' tells the\n"
          "version. Any other NAME runs the program brdffit-NAME from your PATH.\n",
          out);
}

static const struct command *find_command(const char *name)
{
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        if (strcmp(commands[i].name, name) == 0) {
            return &commands[i];
        }
    }
    return NULL;
}

static int unknown_command(const char *name)
{
    struct cli_suggestion near = {0};
    for (size_t i = 0; i < COMMAND_COUNT; i++) {
        brdffit_cli_suggest(&near, name, commands[i].name);
    }
    if (strcmp(name, "report") == 0 || strcmp(name, "export") == 0) {
        fprintf(stderr,
                "brdffit: there is no brdffit-%s on the PATH. It comes with the Python package: in a clone of "
                "brdffit,\n"
                "    pip install ./python\n"
                "and if that is in a virtual environment, activate it (or put its bin/ on the PATH).\n",
                name);
        return CLI_EXIT_USAGE;
    }
    fprintf(stderr, "brdffit: '%s' is not a command", name);
    if (strchr(name, '/') == NULL) {
        fprintf(stderr, ", and there is no brdffit-%s on the PATH", name);
    }
    if (near.word != NULL) {
        fprintf(stderr, "; did you mean '%s'?", near.word);
    }
    fputs("\nTry 'brdffit --help'.\n", stderr);
    return CLI_EXIT_USAGE;
}

/* Returns only when there is no such program. */
static int run_external(char **argv)
{
    struct cli_text program = {0};
    const char *const name = argv[0];
    if (*name == '\0' || strchr(name, '/') != NULL) {
        return unknown_command(name);
    }
    brdffit_cli_text_printf(&program, "brdffit-%s", name);
    if (program.failed) {
        return brdffit_cli_no_memory();
    }
    argv[0] = program.data;
    brdffit_cli_release_signals();
    (void)execvp(program.data, argv);
    const int error = errno;
    if (error != ENOENT && error != ENOTDIR) {
        fprintf(stderr, "brdffit: %s: %s\n", program.data, strerror(error));
        brdffit_cli_text_free(&program);
        return CLI_EXIT_FAILURE;
    }
    brdffit_cli_text_free(&program);
    return unknown_command(name);
}

static int help(char *name)
{
    const struct command *const c = name == NULL ? NULL : find_command(name);
    if (name != NULL && c == NULL) {
        return run_external((char *[]){name, (char[]){"--help"}, NULL});
    }
    if (c == NULL) {
        usage(stdout);
    } else {
        c->help();
    }
    return 0;
}

static int dispatch(int argc, char **argv)
{
    if (argc < 2) {
        usage(stderr);
        return CLI_EXIT_USAGE;
    }
    const char *const name = argv[1];
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        return help(NULL);
    }
    if (strcmp(name, "help") == 0) {
        return help(argc > 2 ? argv[2] : NULL);
    }
    if (strcmp(name, "--version") == 0) {
        printf("brdffit %s\n", brdffit_version());
        return 0;
    }
    if (name[0] == '-') {
        fprintf(stderr, "brdffit: unknown option '%s'; options follow a command\n", name);
        fputs("Try 'brdffit --help'.\n", stderr);
        return CLI_EXIT_USAGE;
    }
    const struct command *const c = find_command(name);
    if (c == NULL) {
        return run_external(argv + 1);
    }
    return c->run(argc - 1, argv + 1);
}

int main(int argc, char **argv)
{
    /* A help is written whole when standard output is closed, so that its failure is told there. */
    static char buffer[16384];
    (void)setvbuf(stdout, buffer, _IOFBF, sizeof buffer);
    guard_descriptors();
    brdffit_cli_catch_signals();
    /* Characters only: numbers keep the "C" locale's decimal point. */
    (void)setlocale(LC_CTYPE, "");
    const int code = dispatch(argc, argv);
    return brdffit_cli_close_stdout() == 0 ? code : CLI_EXIT_FAILURE;
}
