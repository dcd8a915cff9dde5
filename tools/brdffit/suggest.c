/* suggest.c: the near match for a misspelt word, by the distance of optimal
 * string alignment. SPDX-License-Identifier: MIT */
#include "suggest.h"

#include <string.h>

/* Longer words are not typing errors of our options. */
#define LONGEST 40

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Capitals are no distance; whatever the locale. */
static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static size_t edits(const char *a, size_t m, const char *b, size_t n)
{
    size_t row[3][LONGEST + 1];
    for (size_t j = 0; j <= n; j++) {
        row[0][j] = j;
    }
    for (size_t i = 1; i <= m; i++) {
        size_t *now = row[i % 3];
        const size_t *before = row[(i + 2) % 3];
        const size_t *earlier = row[(i + 1) % 3];
        now[0] = i;
        for (size_t j = 1; j <= n; j++) {
            const size_t replace = before[j - 1] + (lower(a[i - 1]) != lower(b[j - 1]));
            now[j] = least(replace, least(before[j], now[j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                now[j] = least(now[j], earlier[j - 2] + 1);
            }
        }
    }
    return row[m % 3][n];
}

void brdffit_cli_suggest(struct cli_suggestion *best, const char *given, const char *candidate)
{
    const size_t m = strlen(given), n = strlen(candidate);
    if (m == 0 || m > LONGEST || n > LONGEST) {
        return;
    }
    size_t distance = edits(given, m, candidate, n);
    const size_t allowed = n <= 3 ? 1 : 2 + n / 8;
    if (m >= 3 && m < n && strncmp(given, candidate, m) == 0) {
        distance = 1;
    }
    if (distance <= allowed && distance < n && (best->word == NULL || distance < best->distance)) {
        best->word = candidate;
        best->distance = distance;
    }
}
