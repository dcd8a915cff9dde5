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
#include "tell.h"

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
    for (const struct cli_command *c = brdffit_cli_commands; c->name != NULL; c++) {
        fprintf(out, "  %-10s %s\n", c->name, c->summary);
    }
    fputs("  report     pages that show fits, proofs and residuals (of the Python package)\n"
          "  export     a fit as a material of Mitsuba, Blender, glTF, ... (likewise)\n",
          out);
    fputs("\n'brdffit COMMAND --help' explains a command; 'brdffit --version' tells the\n"
          "version. Any other NAME runs the program brdffit-NAME from your PATH.\n",
          out);
}

static const struct cli_command *find_command(const char *name)
{
    for (const struct cli_command *c = brdffit_cli_commands; c->name != NULL; c++) {
        if (strcmp(c->name, name) == 0) {
            return c;
        }
    }
    return NULL;
}

/* Options that stand where a command does. */
static const char *const alone[] = {"--help", "--version", NULL};

/* "; did you mean 'WORD'?" among the commands and these, dashes or not. */
static void hint(const char *name)
{
    struct cli_suggestion near = {0};
    for (const struct cli_command *c = brdffit_cli_commands; c->name != NULL; c++) {
        brdffit_cli_suggest(&near, name, c->name);
    }
    for (size_t i = 0; alone[i] != NULL; i++) {
        const char *const word = alone[i] + 2, *const given = name + strspn(name, "-");
        if (strcmp(given, word) == 0 || ((given[0] == 'v' || given[0] == 'V') && given[1] == '\0' && word[0] == 'v')) {
            near.word = alone[i];
        } else if (name[0] == '-') {
            brdffit_cli_suggest(&near, name, alone[i]);
        }
    }
    if (near.word != NULL) {
        brdffit_cli_tell("; did you mean '%s'?", near.word);
    }
}

static int unknown_command(const char *name)
{
    if (strcmp(name, "report") == 0 || strcmp(name, "export") == 0) {
        fprintf(stderr,
                "brdffit: there is no brdffit-%s on the PATH. It comes with the Python package: in a clone of "
                "brdffit,\n"
                "    pip install ./python\n"
                "and if that is in a virtual environment, activate it (or put its bin/ on the PATH).\n",
                name);
        return CLI_EXIT_USAGE;
    }
    brdffit_cli_tell("brdffit: '%s' is not a command", name);
    if (strchr(name, '/') == NULL) {
        brdffit_cli_tell(", and there is no brdffit-%s on the PATH", name);
    }
    hint(name);
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
        brdffit_cli_tell("brdffit: %s: %s\n", program.data, strerror(error));
        brdffit_cli_text_free(&program);
        return CLI_EXIT_FAILURE;
    }
    brdffit_cli_text_free(&program);
    return unknown_command(name);
}

static int help(char *name)
{
    const struct cli_command *const c = name == NULL ? NULL : find_command(name);
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
        brdffit_cli_tell("brdffit: unknown option '%s'; options follow a command", name);
        hint(name);
        fputs("\nTry 'brdffit --help'.\n", stderr);
        return CLI_EXIT_USAGE;
    }
    const struct cli_command *const c = find_command(name);
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
