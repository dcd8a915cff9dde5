/*
 * The words of a column's name: see words.h. SPDX-License-Identifier: MIT
 */
#include "io/csv/words.h"

#include <string.h>

#include "brdffit_io.h"

struct vocabulary {
    enum io_word word;
    const char *what;  /* as users are told */
    const char *words; /* each between blanks */
};

/* The one table of what names mean: the readers, --help, the documentation's test and Python ask for it. */
static const struct vocabulary vocabulary[] = {
    {WORD_POLAR, "polar angle", " theta th polar zenith zen "},
    {WORD_AZIMUTH, "azimuth", " phi azimuth azimuthal azim azi az "},
    {WORD_ELEVATION, "angle above the surface", " elevation elev altitude "},
    {WORD_ANGLE, "polar angle, beside light or viewer", " angle ang "},
    {WORD_LIGHT, "light",
     " i in wi inc incident incidence incoming input source src light l illumination illum lamp laser beam sun solar "},
    {WORD_VIEW, "viewer",
     " o out wo outgoing output r ref refl reflected reflection v view viewing viewer e em emission emergent exit exitant "
     "detector det scatter scattered scattering scat camera cam observer observation obs sensor receiver rec "},
    {WORD_NORMAL, "normal", " n normal norm "},
    {WORD_TANGENT, "tangent, beside an axis", " t tangent "},
    {WORD_S, "sun, or scatter beside i", " s "},
    {WORD_D, "difference beside h, or detector", " d diff difference "},
    {WORD_HALF, "half vector", " h half halfway "},
    {WORD_RELATIVE, "between light and viewer", " rel relative delta "},
    {WORD_X, NULL, " x "},
    {WORD_Y, NULL, " y "},
    {WORD_Z, NULL, " z "},
    {WORD_FILLER, NULL, " of the direction dir vector vec to and omega w "},
    {WORD_VALUE, "channel",
     " red green blue brdf fr f value values radiance reflectance luminance intensity signal counts data measured "},
    {WORD_WEIGHT, "weight", " weight weights wt wgt weighting "},
    {WORD_UNCERTAINTY, "uncertainty", " uncertainty stddev std stdev "},
    {WORD_SPREAD, "left out: an uncertainty of some kind",
     " sigma err error errors unc sd sem se rms noise variance var cov snr deviation "},
    {WORD_MASK, "left out or refused: a mask",
     " valid validity mask masked flag flags quality qc qa ok good bad use used status saturation saturated reject "
     "rejected outlier outliers "},
    {WORD_INDEX, "left out: a running number",
     " index idx id no nr num number row sample samples point pt seq sequence unnamed frame image img line step scan "},
    {WORD_WAVELENGTH, "wavelength", " wavelength wavelengths lambda wl wvl nm "},
    {WORD_CONDITION, "left out: a condition",
     " temperature temp time timestamp date datetime humidity pressure thickness duration elapsed distance pos position "
     "coordinate coord pixel "},
    {WORD_CORRECTION, "left out, with a warning: a correction", " exposure gain dark background integration "},
    {WORD_TURN, "refused unless directions are complete: a rotation",
     " tilt rotation rot yaw pitch roll inclination declination heading slope aspect "},
    {WORD_REMARK, "left out: a remark",
     " note notes comment comments remark remarks description operator filename file path instrument serial label "},
    {WORD_GROUP, "left out where it is the same throughout, else refused",
     " material name specimen band channel color colour filter polarization polarisation pol run set group state "},
    {WORD_LOGARITHM, "refused: a logarithm", " db decibel decibels log ln logarithm "},
};

/* Letters that stand for words, in UTF-8; a degree sign in Latin-1, too. */
static const struct {
    const char *letter, *word;
} letters[] = {
    {"\xce\xb8", "theta"}, {"\xcf\x91", "theta"},  {"\xce\x98", "theta"}, {"\xcf\x86", "phi"},   {"\xcf\x95", "phi"},
    {"\xce\xa6", "phi"},   {"\xce\xbb", "lambda"}, {"\xcf\x83", "sigma"}, {"\xce\x94", "delta"}, {"\xcf\x89", "w"},
    {"\xe1\xb5\xa2", "i"}, {"\xe2\x82\x92", "o"},  {"\xe1\xb5\xa3", "r"}, {"\xe1\xb5\xa5", "v"}, {"\xc2\xb0", "deg"},
    {"\xc2\xba", "deg"},   {"\xb0", "deg"},
};

/* Abbreviations and words run together. */
static const struct {
    const char *word, *first, *second;
} compounds[] = {
    {"sza", "sun", "zenith"},   {"saa", "sun", "azimuth"},  {"vza", "view", "zenith"}, {"vaa", "view", "azimuth"},
    {"raa", "rel", "azimuth"},  {"aoi", "light", "angle"},  {"aor", "view", "angle"},  {"aos", "view", "angle"},
    {"dphi", "rel", "phi"},     {"deltaphi", "rel", "phi"}, {"relphi", "rel", "phi"},  {"phirel", "rel", "phi"},
    {"dazimuth", "rel", "phi"},
};

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c + ('a' - 'A')) : c;
}

static int is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Of a word; bytes beyond ASCII are letters of some language. */
static int is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (unsigned char)c >= 0x80;
}

static int is_capital(char c)
{
    return c >= 'A' && c <= 'Z';
}

static int listed(const char *list, const char *text, size_t length)
{
    const char *at = list;

    while (length > 0 && (at = strstr(at + 1, " ")) != NULL) {
        if (at - list > (ptrdiff_t)length && at[-(ptrdiff_t)length - 1] == ' ' &&
            memcmp(at - length, text, length) == 0) {
            return 1;
        }
    }
    return 0;
}

static enum io_word class_of(const char *text, size_t length)
{
    size_t i;

    if (length > 0 && is_digit(text[0])) {
        return WORD_NUMBER;
    }
    for (i = 0; i < sizeof vocabulary / sizeof *vocabulary; i++) {
        if (listed(vocabulary[i].words, text, length)) {
            return vocabulary[i].word;
        }
    }
    return WORD_OTHER;
}

static enum io_unit unit_word(const char *text, size_t length)
{
    static const char *const degrees = " deg degs degree degrees degre grad° ", *const radians =
                                                                                    " rad rads radian radians ";

    if (listed(degrees, text, length)) {
        return UNIT_DEGREES;
    }
    return listed(radians, text, length) ? UNIT_RADIANS : UNIT_NONE;
}

static void push(struct io_words *out, const char *text, size_t length)
{
    const enum io_unit unit = unit_word(text, length);
    const int n = out->count;

    if (unit != UNIT_NONE) {
        out->unit = unit;
        return;
    }
    if (n >= IO_WORDS_MOST) {
        out->count = IO_WORDS_MOST + 1;
        return;
    }
    length = length < IO_WORD_LENGTH ? length : IO_WORD_LENGTH - 1;
    memcpy(out->text[n], text, length);
    out->text[n][length] = '\0';
    out->word[n] = class_of(text, length);
    out->of[out->word[n]]++;
    out->count++;
}

/* "thetai", "phiout": an angle and a side run together. */
static int push_glued(struct io_words *out, const char *text, size_t length)
{
    static const char *const angle[] = {"theta", "phi", "azimuth", "zenith", "elevation", "th"};
    size_t i;

    for (i = 0; i < sizeof angle / sizeof *angle; i++) {
        const size_t n = strlen(angle[i]);

        if (length > n && memcmp(text, angle[i], n) == 0) {
            const enum io_word rest = class_of(text + n, length - n);

            if ((rest >= WORD_LIGHT && rest <= WORD_HALF && rest != WORD_NORMAL && rest != WORD_TANGENT)) {
                push(out, angle[i], n);
                push(out, text + n, length - n);
                return 1;
            }
        }
    }
    return 0;
}

static void push_word(struct io_words *out, const char *text, size_t length)
{
    size_t i;

    for (i = 0; i < sizeof compounds / sizeof *compounds; i++) {
        if (strlen(compounds[i].word) == length && memcmp(compounds[i].word, text, length) == 0) {
            push(out, compounds[i].first, strlen(compounds[i].first));
            push(out, compounds[i].second, strlen(compounds[i].second));
            return;
        }
    }
    if (!push_glued(out, text, length)) {
        push(out, text, length);
    }
}

/* Of a letter that stands for a word; 0: it does not. */
static size_t letter_at(const char *at, const char *end, const char **word)
{
    size_t i;

    for (i = 0; i < sizeof letters / sizeof *letters; i++) {
        const size_t n = strlen(letters[i].letter);

        if ((size_t)(end - at) >= n && memcmp(at, letters[i].letter, n) == 0) {
            *word = letters[i].word;
            return n;
        }
    }
    return 0;
}

/* A Greek letter and the subscript that follows it are two words; letters in small print end one. */
static const char *plain_word(const char *at, const char *end, char *word, size_t *length)
{
    const int digits = is_digit(*at);
    const char *unused, *first = at;

    if (end - at >= 2 && at[0] == 'd' && at[1] == 'B' && (end - at == 2 || !is_letter(at[2]))) { /* no camel */
        *length = 2;
        memcpy(word, "db", 2);
        return at + 2;
    }
    for (*length = 0; at < end && (digits ? is_digit(*at) : is_letter(*at)); at++) {
        if (letter_at(at, end, &unused) > 0 || (at > first && is_capital(*at) && !is_capital(at[-1]))) {
            break;
        }
        if (*length < 2 * IO_WORD_LENGTH) {
            word[(*length)++] = lower(*at);
        }
    }
    return at;
}

/* "(deg)", "[1/sr]": a unit in brackets, or NULL. */
static const char *bracketed(const char *at, const char *end, struct io_words *out)
{
    const char close = *at == '(' ? ')' : *at == '[' ? ']' : '}';
    const char *stop = at + 1;
    struct io_field inside = {at + 1, 0, 0};
    enum io_unit unit;

    while (stop < end && *stop != close) {
        stop++;
    }
    inside.length = (size_t)(stop - at - 1);
    unit = brdffit_io_unit(&inside);
    if (stop == end || unit == UNIT_NONE) {
        return NULL;
    }
    out->unit = unit;
    return stop + 1;
}

/* "lx", "wiz": a side and an axis, where they are the whole name. */
static void split_axis(struct io_words *out)
{
    static const char *const sides = " l v n wi wo i o ";
    char text[IO_WORD_LENGTH];
    const size_t length = out->count == 1 ? strlen(out->text[0]) : 0;

    if (length < 2 || length > 3 || !strchr("xyz", out->text[0][length - 1]) ||
        !listed(sides, out->text[0], length - 1)) {
        return;
    }
    memcpy(text, out->text[0], length);
    out->of[out->word[0]]--;
    out->count = 0;
    if (strchr("io", text[length - 2])) {
        push(out, text[length - 2] == 'i' ? "in" : "out", text[length - 2] == 'i' ? 2 : 3);
    } else {
        push(out, text, 1);
    }
    push(out, text + length - 1, 1);
}

void brdffit_io_words(const struct io_field *name, struct io_words *words)
{
    const char *at = name->text, *const end = at + name->length;
    char word[2 * IO_WORD_LENGTH + 1];

    memset(words, 0, sizeof *words);
    while (at < end && words->count <= IO_WORDS_MOST) {
        const char *stop = strchr("([{", *at) && *at ? bracketed(at, end, words) : NULL, *meaning;
        size_t length = stop ? 0 : letter_at(at, end, &meaning);

        if (stop) {
            at = stop;
        } else if (length > 0) {
            push_word(words, meaning, strlen(meaning));
            at += length;
        } else if (is_digit(*at) || is_letter(*at)) {
            at = plain_word(at, end, word, &length);
            push_word(words, word, length);
        } else {
            words->unit = *at == '%' ? UNIT_PERCENT : words->unit;
            at++;
        }
    }
    split_axis(words);
}

/* Of the text without blanks, brackets and case. */
static size_t bare(const struct io_field *field, char *out, size_t most)
{
    size_t i, n = 0;

    for (i = 0; i < field->length && n < most; i++) {
        if (!strchr(" \t()[]{}", field->text[i])) {
            out[n++] = lower(field->text[i]);
        }
    }
    return i < field->length ? 0 : n;
}

enum io_unit brdffit_io_unit(const struct io_field *field)
{
    static const char *const others =
        " 1/sr sr^-1 sr-1 /sr 1/steradian sr a.u. au arb. none 1 - nm um mm c k v s ms w/m2 "
        "w/sr/m2 cd/m2 w/m^2 counts unitless dimensionless sr^{-1} ";
    char text[32];
    const size_t n = bare(field, text, sizeof text);

    if (n == 0) {
        return UNIT_NONE;
    }
    if ((n == 2 && (memcmp(text, "\xc2\xb0", 2) == 0 || memcmp(text, "\xc2\xba", 2) == 0)) ||
        (n == 1 && text[0] == '\xb0')) {
        return UNIT_DEGREES;
    }
    if ((n == 1 && text[0] == '%') || (n == 7 && memcmp(text, "percent", 7) == 0)) {
        return UNIT_PERCENT;
    }
    return unit_word(text, n) != UNIT_NONE ? unit_word(text, n) : listed(others, text, n) ? UNIT_OTHER : UNIT_NONE;
}

static const char *next_significant(const char *at, const char *end)
{
    while (at < end && !is_digit(*at) && !is_letter(*at)) {
        at++;
    }
    return at;
}

int brdffit_io_same_name(const struct io_field *a, const char *b, size_t length)
{
    const char *p = a->text, *p_end = p + a->length, *q = b, *q_end = b + length;

    if (a->length == length && memcmp(a->text, b, length) == 0) {
        return 1;
    }
    if (next_significant(p, p_end) == p_end) {
        return 0;
    }
    for (;;) {
        p = next_significant(p, p_end);
        q = next_significant(q, q_end);
        if (p == p_end || q == q_end) {
            return p == p_end && q == q_end;
        }
        if (lower(*p++) != lower(*q++)) {
            return 0;
        }
    }
}

const char *brdffit_io_column_words(size_t i, const char **what)
{
    size_t k;

    for (k = 0; k < sizeof vocabulary / sizeof *vocabulary; k++) {
        if (vocabulary[k].what && i-- == 0) {
            *what = vocabulary[k].what;
            return vocabulary[k].words + 1;
        }
    }
    return NULL;
}
