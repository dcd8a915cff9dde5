/* main.c: goniometer OUTDIR writes the data of synthetic instruments, the
 * same bytes from the same seed. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "truth.h"

enum { EXIT_USAGE = 2 };

struct arguments {
    const char *folder;
    uint64_t seed;
    double outliers; /* 0: no such file */
};

static const char help_text[] = "Usage: goniometer OUTDIR [--seed N] [--outliers FRACTION]\n"
                                "\n"
                                "Write synthetic reflectance measurements of known materials to OUTDIR:\n"
                                "\n"
                                "  two_lobe_satin.csv     two Beckmann lobes, 1 % noise\n"
                                "  two_lobe_exact.csv     the same material, noise-free, 17 digits\n"
                                "  ggx_metal.csv          GGX with Fresnel: no sum of Beckmann lobes fits it\n"
                                "  matte.csv              Oren-Nayar: nothing specular to find\n"
                                "  two_lobe_table.binary  the two lobes in MERL's layout, 30 x 15 x 30 cells\n"
                                "  truth.json             what they were made from\n"
                                "  two_lobe_outliers.csv  with --outliers: that fraction of the samples spoilt\n"
                                "\n"
                                "  --seed N               of the noise, 0 to 18446744073709551615 (default 1)\n"
                                "  --outliers FRACTION    above 0, below 1\n"
                                "  -h, --help             show this\n"
                                "\n"
                                "OUTDIR is created if need be; its folder must exist. Each file is written\n"
                                "whole or not at all. Exit status: 0 done, 1 cannot write, 2 wrong usage.\n";

static const struct gonio_recipe csv_files[] = {
    {"two_lobe_satin.csv", &brdffit_gonio_satin, 0.01, 5e-4, 0, 1},
    {"two_lobe_exact.csv", &brdffit_gonio_satin, 0, 0, 0, 2},
    {"ggx_metal.csv", &brdffit_gonio_metal, 0.01, 5e-4, 0, 3},
    {"matte.csv", &brdffit_gonio_matte, 0.01, 5e-4, 0, 4},
};

static const struct gonio_recipe table_file = {"two_lobe_table.binary", &brdffit_gonio_satin, 0, 0, 0, 5};

static int usage(const char *message, const char *what)
{
    fprintf(stderr, "goniometer: %s'%s'\nTry 'goniometer --help'.\n", message, what);
    return EXIT_USAGE;
}

static int parse_seed(const char *text, uint64_t *seed)
{
    char *end;
    if (*text < '0' || *text > '9') {
        return 0;
    }
    errno = 0;
    *seed = strtoull(text, &end, 10);
    return *end == '\0' && errno == 0;
}

static int parse_fraction(const char *text, double *fraction)
{
    char *end;
    if (*text == '\0' || text[strspn(text, ".0123456789eE-")] != '\0') {
        return 0;
    }
    *fraction = strtod(text, &end);
    return *end == '\0' && *fraction > 0 && *fraction < 1;
}

/* The value of `name` at argv[*at], as "--name VALUE" or "--name=VALUE"; NULL
 * when the argument is something else. A missing value is "". */
static const char *option_value(int argc, char **argv, int *at, const char *name)
{
    const size_t length = strlen(name);
    if (strncmp(argv[*at], name, length) != 0) {
        return NULL;
    }
    if (argv[*at][length] == '=') {
        return argv[*at] + length + 1;
    }
    if (argv[*at][length] != '\0') {
        return NULL;
    }
    return *at + 1 < argc ? argv[++*at] : "";
}

/* 0: go on. Otherwise 1 + the exit code. */
static int parse(int argc, char **argv, struct arguments *a)
{
    int ended = 0;
    for (int at = 1; at < argc; at++) {
        const char *const given = argv[at];
        const char *value;
        if (!ended && (strcmp(given, "-h") == 0 || strcmp(given, "--help") == 0)) {
            fputs(help_text, stdout);
            return 1;
        } else if (!ended && strcmp(given, "--") == 0) {
            ended = 1;
        } else if (!ended && (value = option_value(argc, argv, &at, "--seed")) != NULL) {
            if (!parse_seed(value, &a->seed)) {
                return 1 + usage("--seed needs a whole number from 0, not ", value);
            }
        } else if (!ended && (value = option_value(argc, argv, &at, "--outliers")) != NULL) {
            if (!parse_fraction(value, &a->outliers)) {
                return 1 + usage("--outliers needs a fraction above 0 and below 1, not ", value);
            }
        } else if (!ended && given[0] == '-') {
            return 1 + usage("unknown option (--seed, --outliers, --help): ", given);
        } else if (a->folder != NULL) {
            return 1 + usage("only one OUTDIR can be given, not also ", given);
        } else {
            a->folder = given;
        }
    }
    if (a->folder == NULL || *a->folder == '\0') {
        return 1 + usage("OUTDIR is needed, not ", "");
    }
    return 0;
}

static int write_csv(const struct arguments *a, const struct gonio_recipe *recipe, struct gonio_file *truth, int first)
{
    struct gonio_file file = {0};
    unsigned char wrong[GONIO_SAMPLES];
    brdffit_gonio_csv(&file, recipe, a->seed, wrong);
    brdffit_gonio_truth_add(truth, recipe, wrong, first);
    return brdffit_gonio_write(&file, a->folder, recipe->name);
}

static int write_all(const struct arguments *a)
{
    struct gonio_file truth = {0}, table = {0};
    int failed = 0;
    brdffit_gonio_truth_begin(&truth, a->seed);
    for (size_t i = 0; i < sizeof csv_files / sizeof *csv_files; i++) {
        failed |= write_csv(a, &csv_files[i], &truth, i == 0);
    }
    if (a->outliers > 0) {
        const struct gonio_recipe recipe = {"two_lobe_outliers.csv", &brdffit_gonio_satin, 0.01, 5e-4, a->outliers, 6};
        failed |= write_csv(a, &recipe, &truth, 0);
    }
    brdffit_gonio_merl(&table, table_file.material, a->seed, table_file.stream);
    brdffit_gonio_truth_add(&truth, &table_file, NULL, 0);
    failed |= brdffit_gonio_write(&table, a->folder, table_file.name);
    brdffit_gonio_truth_end(&truth);
    failed |= brdffit_gonio_write(&truth, a->folder, "truth.json");
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
    struct arguments a = {NULL, 1, 0};
    int code = parse(argc, argv, &a);
    if (code != 0) {
        code -= 1;
    } else if (mkdir(a.folder, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "goniometer: %s: cannot create: %s\n", a.folder, strerror(errno));
        code = EXIT_FAILURE;
    } else {
        code = write_all(&a);
    }
    return fclose(stdout) == 0 ? code : EXIT_FAILURE;
}
