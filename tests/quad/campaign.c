/*
 * Random problems whose certificates are held against quad precision:
 *
 *     campaign SEED COUNT [--from N] [--family NAME] [--effort N] [--budget N] [--boxes N] [--proofs N] [--print N]
 *              [--keep DIR] [--progress N]
 *     campaign replay FILE...         problems that were printed, once more
 *
 * --from       number of the first problem (0): a fault names its number, and `campaign SEED 1 --from N` is that one,
 *              with --family NAME where that was given; problem N is of family N mod their number otherwise
 * --effort     evaluations of E^2 in search of a better point, a fit (200)
 * --budget     boxes of a fit of one lobe, at most (0: what the problem says); fewer where lobes or engine make them dear
 * --boxes      attack the boxes of one fit in so many (16; 1: all, 0: none); --proofs: brdffit_verify() (32)
 * --print      faulty problems printed in full, of each family and kind (1); --keep writes all of them, a file each
 * --progress   the table so far on stderr, after so many problems
 *
 * Prints a line a family; exit code 1 when anything is at fault. SPDX-License-Identifier: MIT
 */
#include <stdlib.h>
#include <string.h>

#include "campaign_run.h"

static int usage(void)
{
    int f;

    fputs(
        "campaign SEED COUNT [--from N] [--family NAME] [--effort N] [--budget N] [--boxes N] [--proofs N] [--print N] "
        "[--keep DIR] [--progress N]\ncampaign replay FILE...\nfamilies:",
        stderr);
    for (f = 0; f < draw_family_count; f++) {
        fprintf(stderr, " %s", draw_families[f].name);
    }
    fputc('\n', stderr);
    return 2;
}

static int family_of(const char *name)
{
    int f;

    for (f = 0; f < draw_family_count; f++) {
        if (!strcmp(draw_families[f].name, name)) {
            return f;
        }
    }
    return -1;
}

static int option(struct campaign *c, const char *name, const char *value)
{
    unsigned long number = strtoul(value, NULL, 10);

    if (!strcmp(name, "--from")) {
        c->from = number;
    } else if (!strcmp(name, "--family")) {
        c->family = family_of(value);
        return c->family >= 0;
    } else if (!strcmp(name, "--effort")) {
        c->effort = number;
    } else if (!strcmp(name, "--budget")) {
        c->budget = number;
    } else if (!strcmp(name, "--boxes")) {
        c->boxes = number;
    } else if (!strcmp(name, "--proofs")) {
        c->proofs = number;
    } else if (!strcmp(name, "--print")) {
        c->print = (int)number;
    } else if (!strcmp(name, "--keep")) {
        c->keep = value;
    } else if (!strcmp(name, "--progress")) {
        c->progress = number;
    } else {
        return 0;
    }
    return 1;
}

static int replay(int files, char **path)
{
    char text[2048];
    int i, any = 0;

    for (i = 0; i < files; i++) {
        int faults = campaign_replay(path[i], text, sizeof text);

        printf("%s: %s: %s\n", path[i], faults < 0 ? "not judged" : faults ? "at fault" : "fine", text);
        any |= faults != 0;
    }
    return any;
}

int main(int argc, char **argv)
{
    struct campaign_row row[CAMPAIGN_FAMILIES];
    struct campaign c;
    unsigned long faulty;
    int i;

    campaign_defaults(&c);
    if (argc > 2 && !strcmp(argv[1], "replay")) {
        return replay(argc - 2, argv + 2);
    }
    if (argc < 3 || argc % 2 == 0) {
        return usage();
    }
    c.seed = strtoull(argv[1], NULL, 10);
    c.count = strtoul(argv[2], NULL, 10);
    for (i = 3; i < argc; i += 2) {
        if (!option(&c, argv[i], argv[i + 1])) {
            return usage();
        }
    }
    faulty = campaign_run(&c, row);
    campaign_table(row, stdout);
    return faulty > 0;
}
