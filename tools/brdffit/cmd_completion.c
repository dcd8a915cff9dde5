/* cmd_completion.c: brdffit completion SHELL: the commands, options and values of the table in settings.c, as a script of
 * the shell that is asked for. SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "failure.h"
#include "output.h"
#include "settings.h"
#include "tell.h"
#include "text.h"

void brdffit_cli_completion_help(void)
{
    brdffit_cli_say("Usage: brdffit completion bash|zsh|fish\n"
                    "\n"
                    "Write a script to standard output that lets the shell complete commands,\n"
                    "options and their values. To have it in every session:\n"
                    "\n"
                    "  bash  eval \"$(brdffit completion bash)\" in ~/.bashrc\n"
                    "  zsh   brdffit completion zsh > DIR/_brdffit, for a DIR of $fpath\n"
                    "  fish  brdffit completion fish > ~/.config/fish/completions/brdffit.fish\n"
                    "\n"
                    "Exit status: 0 done; 1 it cannot be written; 2 wrong usage.\n");
}

/* ---- What there is ----------------------------------------------------- */

static const struct cli_option *next_option(const struct cli_option *o, unsigned command)
{
    while (o->name != NULL && (o->hidden || !(o->commands & command))) {
        o++;
    }
    return o->name != NULL ? o : NULL;
}

#define EACH_OPTION(o, command)                                                                                        \
    const struct cli_option *o = next_option(brdffit_cli_options, command);                                            \
    o != NULL;                                                                                                         \
    o = next_option(o + 1, command)

static int takes_value(const struct cli_option *o)
{
    return o->kind != CLI_FLAG && o->kind != CLI_HELP;
}

/* "l2 l1 linf"; nothing where any word will do. */
static void add_choices(struct cli_text *text, const struct cli_option *o)
{
    const char *separator = "";
    const struct cli_choice *c = takes_value(o) ? brdffit_cli_choices_of(o) : NULL;
    for (; c != NULL && c->name != NULL; c++) {
        if (!c->hidden) {
            brdffit_cli_text_printf(text, "%s%s", separator, c->name);
            separator = " ";
        }
    }
}

/* The help on one line, without what the shell's quotes and brackets would end at. */
static void add_help(struct cli_text *text, const char *help, const char *unwanted)
{
    for (; help != NULL && *help != '\0'; help++) {
        const int colon = *help == ':' && strchr(unwanted, ':') != NULL;
        const char c = *help == '\n' ? ' ' : colon ? ',' : *help;
        if (strchr(unwanted, c) == NULL) {
            brdffit_cli_text_add(text, &c, 1);
        }
    }
}

static const char *help_of(const struct cli_option *o)
{
    return o->help != NULL ? o->help : "distribution of the microfacets";
}

static void add_commands(struct cli_text *text)
{
    for (const struct cli_command *c = brdffit_cli_commands; c->name != NULL; c++) {
        brdffit_cli_text_printf(text, "%s%s", c == brdffit_cli_commands ? "" : " ", c->name);
    }
}

/* ---- bash -------------------------------------------------------------- */

static void bash_values(struct cli_text *text, const struct cli_command *c)
{
    for (EACH_OPTION(o, c->options)) {
        struct cli_text choices = {0};
        add_choices(&choices, o);
        if (choices.size > 0) {
            brdffit_cli_text_printf(text, "        %s,--%s) words='%s' ;;\n", c->name, o->name, choices.data);
        } else if (takes_value(o)) {
            brdffit_cli_text_printf(text, "        %s,--%s) words= ;;\n", c->name, o->name);
        }
        text->failed |= choices.failed;
        brdffit_cli_text_free(&choices);
    }
}

static void bash(struct cli_text *text)
{
    brdffit_cli_text_puts(text, "# bash completion of brdffit; made by 'brdffit completion bash'\n"
                                "_brdffit() {\n"
                                "    local now=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words\n"
                                "    if [ \"$COMP_CWORD\" = 1 ]; then\n        COMPREPLY=($(compgen -W '");
    add_commands(text);
    brdffit_cli_text_puts(text, " report help --help --version' -- \"$now\"))\n        return\n    fi\n"
                                "    case ${COMP_WORDS[1]},$before in\n");
    for (const struct cli_command *c = brdffit_cli_commands; c->name != NULL; c++) {
        bash_values(text, c);
    }
    brdffit_cli_text_puts(text, "        completion,completion) words='bash zsh fish' ;;\n        help,help) words='");
    add_commands(text);
    brdffit_cli_text_puts(text, "' ;;\n        *) case $now in\n            -*) case ${COMP_WORDS[1]} in\n");
    for (const struct cli_command *c = brdffit_cli_commands; c->name != NULL; c++) {
        brdffit_cli_text_printf(text, "                %s) words='", c->name);
        for (EACH_OPTION(o, c->options)) {
            brdffit_cli_text_printf(text, "--%s ", o->name);
        }
        brdffit_cli_text_puts(text, "' ;;\n");
    }
    brdffit_cli_text_puts(text, "                esac ;;\n            esac ;;\n    esac\n"
                                "    if [ -n \"$words\" ]; then\n"
                                "        COMPREPLY=($(compgen -W \"$words\" -- \"$now\"))\n    else\n"
                                "        COMPREPLY=($(compgen -f -- \"$now\"))\n    fi\n}\n"
                                "complete -o filenames -F _brdffit brdffit\n");
}

/* ---- zsh --------------------------------------------------------------- */

static void zsh_option(struct cli_text *text, const struct cli_option *o)
{
    brdffit_cli_text_printf(text, "                '--%s%s[", o->name, takes_value(o) ? "=" : "");
    add_help(text, help_of(o), "'[]:\\");
    brdffit_cli_text_puts(text, "]");
    if (takes_value(o)) {
        struct cli_text choices = {0};
        add_choices(&choices, o);
        brdffit_cli_text_puts(text, ":value:");
        if (choices.size > 0) {
            brdffit_cli_text_printf(text, "(%s)", choices.data);
        } else {
            brdffit_cli_text_puts(text, "_files");
        }
        text->failed |= choices.failed;
        brdffit_cli_text_free(&choices);
    }
    brdffit_cli_text_puts(text, "' \\\n");
}

static void zsh(struct cli_text *text)
{
    brdffit_cli_text_puts(text, "#compdef brdffit\n# zsh completion of brdffit; made by 'brdffit completion zsh'\n"
                                "_brdffit() {\n    local -a commands\n    commands=(\n");
    for (const struct cli_command *c = brdffit_cli_commands; c->name != NULL; c++) {
        brdffit_cli_text_printf(text, "        '%s:", c->name);
        add_help(text, c->summary, "':\\");
        brdffit_cli_text_puts(text, "'\n");
    }
    brdffit_cli_text_puts(text,
                          "    )\n    if (( CURRENT == 2 )); then\n        _describe command commands\n        return\n"
                          "    fi\n    local command=$words[2]\n    shift words\n    (( CURRENT-- ))\n"
                          "    case $command in\n");
    for (const struct cli_command *c = brdffit_cli_commands; c->name != NULL; c++) {
        if (c->options == 0) {
            continue;
        }
        brdffit_cli_text_printf(text, "        %s)\n            _arguments \\\n", c->name);
        for (EACH_OPTION(o, c->options)) {
            zsh_option(text, o);
        }
        brdffit_cli_text_puts(text, "                '*:file:_files'\n            ;;\n");
    }
    brdffit_cli_text_puts(text, "        completion) _values shell bash zsh fish ;;\n    esac\n}\n_brdffit \"$@\"\n");
}

/* ---- fish -------------------------------------------------------------- */

static void fish_option(struct cli_text *text, const struct cli_command *c, const struct cli_option *o)
{
    brdffit_cli_text_printf(text, "complete -c brdffit -n '__fish_seen_subcommand_from %s' -l %s", c->name, o->name);
    if (o->letter != 0) {
        brdffit_cli_text_printf(text, " -s %c", o->letter);
    }
    if (takes_value(o)) {
        struct cli_text choices = {0};
        add_choices(&choices, o);
        brdffit_cli_text_printf(text, choices.size > 0 ? " -x -a '%s'" : " -r%s", brdffit_cli_text_string(&choices));
        text->failed |= choices.failed;
        brdffit_cli_text_free(&choices);
    }
    brdffit_cli_text_puts(text, " -d '");
    add_help(text, help_of(o), "'\\");
    brdffit_cli_text_puts(text, "'\n");
}

static void fish(struct cli_text *text)
{
    brdffit_cli_text_puts(text, "# fish completion of brdffit; made by 'brdffit completion fish'\n");
    for (const struct cli_command *c = brdffit_cli_commands; c->name != NULL; c++) {
        brdffit_cli_text_printf(text, "complete -c brdffit -f -n __fish_use_subcommand -a %s -d '", c->name);
        add_help(text, c->summary, "'\\");
        brdffit_cli_text_puts(text, "'\n");
    }
    for (const struct cli_command *c = brdffit_cli_commands; c->name != NULL; c++) {
        for (EACH_OPTION(o, c->options)) {
            fish_option(text, c, o);
        }
    }
    brdffit_cli_text_puts(text,
                          "complete -c brdffit -f -n '__fish_seen_subcommand_from completion' -a 'bash zsh fish'\n");
}

/* ---- The command ------------------------------------------------------- */

int brdffit_cli_completion(int argc, char **argv)
{
    static const struct {
        const char *name;
        void (*write)(struct cli_text *text);
    } shells[] = {{"bash", bash}, {"zsh", zsh}, {"fish", fish}};
    struct cli_text text = {0};
    if (argc == 2 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)) {
        brdffit_cli_completion_help();
        return 0;
    }
    for (size_t i = 0; argc == 2 && i < sizeof shells / sizeof *shells; i++) {
        if (strcmp(argv[1], shells[i].name) == 0) {
            shells[i].write(&text);
            const int failed = text.failed;
            brdffit_cli_say(failed ? "" : brdffit_cli_text_string(&text));
            brdffit_cli_text_free(&text);
            return failed ? brdffit_cli_no_memory() : 0;
        }
    }
    brdffit_cli_tell("brdffit completion: needs the name of a shell: bash, zsh or fish\n"
                     "Try 'brdffit completion --help'.\n");
    return CLI_EXIT_USAGE;
}
