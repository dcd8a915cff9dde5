/*
 * Names to roles: see roles.h. SPDX-License-Identifier: MIT
 *
 * An angle has a word for what it is (theta, azimuth, elevation) and one for whose it is (i, light, scatter); a component
 * has whose and an axis. A name with such a word that is not understood as a whole is CSV_DIRECTION, never a channel.
 */
#include "io/csv/roles.h"

#include <string.h>

static const char *const role_names[CSV_NAMED_ROLES] = {
    "theta_i", "phi_i", "theta_o", "phi_o", "phi",    "theta_h",     "phi_h",      "theta_d", "phi_d",  "lx",
    "ly",      "lz",    "vx",      "vy",    "vz",     "nx",          "ny",         "nz",      "tx",     "ty",
    "tz",      "a",     "b",       "c",     "weight", "uncertainty", "wavelength", "channel", "ignore",
};

const char *brdffit_io_role_name(enum csv_role role)
{
    return role_names[role];
}

enum csv_role brdffit_io_role_named(const char *text, size_t length)
{
    int role;

    for (role = 0; role < CSV_NAMED_ROLES; role++) {
        if (strlen(role_names[role]) == length && memcmp(role_names[role], text, length) == 0) {
            break;
        }
    }
    return (enum csv_role)role;
}

int brdffit_io_is_angle(enum csv_role role)
{
    return role <= CSV_PHI_D || role == CSV_THETA_S || role == CSV_PHI_S;
}

/* Whose: the one class of side that the words name; WORD_OTHER for none, WORD_CLASSES for several. */
static enum io_word side_of(const struct io_words *w)
{
    static const enum io_word sides[] = {WORD_LIGHT, WORD_VIEW, WORD_NORMAL, WORD_TANGENT, WORD_S, WORD_D, WORD_HALF};
    enum io_word found = WORD_OTHER;
    size_t i;

    for (i = 0; i < sizeof sides / sizeof *sides; i++) {
        if (w->of[sides[i]] > 0) {
            found = found == WORD_OTHER ? sides[i] : WORD_CLASSES;
        }
    }
    return found;
}

static int count_sides(const struct io_words *w)
{
    return w->of[WORD_LIGHT] + w->of[WORD_VIEW] + w->of[WORD_NORMAL] + w->of[WORD_TANGENT] + w->of[WORD_S] +
           w->of[WORD_D] + w->of[WORD_HALF];
}

static enum csv_role polar_role(enum io_word side)
{
    switch (side) {
    case WORD_LIGHT: return CSV_THETA_I;
    case WORD_VIEW: return CSV_THETA_O;
    case WORD_S: return CSV_THETA_S;
    case WORD_HALF: return CSV_THETA_H;
    case WORD_D: return CSV_THETA_D;
    default: return CSV_DIRECTION;
    }
}

static enum csv_role azimuth_role(const struct io_words *w, enum io_word side)
{
    const int both = w->of[WORD_LIGHT] > 0 && w->of[WORD_VIEW] > 0;

    if (w->of[WORD_RELATIVE] > 0 || both) {
        return side == WORD_OTHER || both ? CSV_PHI : CSV_DIRECTION;
    }
    switch (side) {
    case WORD_OTHER: return CSV_PHI;
    case WORD_LIGHT: return CSV_PHI_I;
    case WORD_VIEW: return CSV_PHI_O;
    case WORD_S: return CSV_PHI_S;
    case WORD_HALF: return CSV_PHI_H;
    case WORD_D: return CSV_PHI_D;
    default: return CSV_DIRECTION;
    }
}

static enum csv_role angle_role(const struct io_words *w, int *elevation)
{
    const int polar = w->of[WORD_POLAR], azimuth = w->of[WORD_AZIMUTH], up = w->of[WORD_ELEVATION];
    const int known = polar + azimuth + up + w->of[WORD_ANGLE] + w->of[WORD_FILLER] + w->of[WORD_RELATIVE];
    const enum io_word side = side_of(w);

    if (known + count_sides(w) != w->count || (polar > 0) + (azimuth > 0) + (up > 0) > 1) {
        return CSV_DIRECTION;
    }
    if (azimuth > 0) {
        return azimuth_role(w, side);
    }
    *elevation = up > 0;
    return w->of[WORD_RELATIVE] > 0 || (up > 0 && (side == WORD_HALF || side == WORD_D)) ? CSV_DIRECTION
                                                                                         : polar_role(side);
}

/* "I x" may be anything: of single letters only l, v and n stand for vectors. */
static int has_short_side(const struct io_words *w)
{
    int i;

    for (i = 0; i < w->count; i++) {
        if (!w->text[i][1] && w->word[i] >= WORD_LIGHT && w->word[i] <= WORD_HALF && !strchr("lvnt", w->text[i][0])) {
            return 1;
        }
    }
    return 0;
}

/* "lx", "light_dir_y": or CSV_UNKNOWN. */
static enum csv_role component_role(const struct io_words *w)
{
    const int axes = w->of[WORD_X] + w->of[WORD_Y] + w->of[WORD_Z], sides = count_sides(w);
    const enum io_word side = side_of(w);
    const int axis = w->of[WORD_Y] ? 1 : w->of[WORD_Z] ? 2 : 0;

    if (axes != 1 || sides == 0 || has_short_side(w) || axes + sides + w->of[WORD_FILLER] != w->count) {
        return CSV_UNKNOWN;
    }
    switch (side) {
    case WORD_LIGHT: return (enum csv_role)(CSV_LX + axis);
    case WORD_VIEW: return (enum csv_role)(CSV_VX + axis);
    case WORD_NORMAL: return (enum csv_role)(CSV_NX + axis);
    case WORD_TANGENT: return (enum csv_role)(CSV_TX + axis);
    default: return CSV_DIRECTION;
    }
}

static int is_one_of(const char *text, const char *const *list, size_t count)
{
    size_t i;

    for (i = 0; i < count; i++) {
        if (strcmp(text, list[i]) == 0) {
            return 1;
        }
    }
    return 0;
}

/* A direction's word, alone: of what, it does not say. */
static int is_bare_direction(const struct io_words *w)
{
    static const char *const list[] = {"light",    "incident", "incidence", "incoming", "source",      "sun",
                                       "solar",    "view",     "viewing",   "viewer",   "observation", "outgoing",
                                       "emission", "exit",     "scatter",   "emergent", "omega"};

    return w->count == 1 && is_one_of(w->text[0], list, sizeof list / sizeof *list);
}

static int is_channel_letter(const struct io_words *w)
{
    static const char *const list[] = {"r", "g", "b", "x", "y", "z", "l", "i"};

    return w->count == 1 && is_one_of(w->text[0], list, sizeof list / sizeof *list);
}

static int is_spread(const struct io_words *w)
{
    const int u = w->count > 0 && w->count <= 2 && strcmp(w->text[0], "u") == 0;

    return u || w->of[WORD_SPREAD] > 0 || (w->of[WORD_UNCERTAINTY] > 0 && w->count > 1) ||
           (w->of[WORD_WEIGHT] > 0 && w->count > 1);
}

static int is_standard_deviation(const struct io_words *w)
{
    return w->count == 2 && strcmp(w->text[0], "standard") == 0 &&
           (w->of[WORD_UNCERTAINTY] > 0 || strcmp(w->text[1], "deviation") == 0);
}

/* What stands beside directions and channels. CSV_UNKNOWN: none of these. */
static enum csv_role beside_role(const struct io_words *w)
{
    const int numbers = w->of[WORD_NUMBER], filler = w->of[WORD_FILLER];

    if (is_standard_deviation(w) || (w->of[WORD_UNCERTAINTY] > 0 && w->count == 1)) {
        return CSV_UNCERTAINTY;
    }
    if (w->of[WORD_WEIGHT] > 0 && w->count == 1) {
        return CSV_WEIGHT;
    }
    if (is_spread(w)) {
        return CSV_SPREAD;
    }
    if (w->of[WORD_MASK] > 0 && w->count <= 2 && w->of[WORD_VALUE] == 0) {
        return CSV_MASK;
    }
    if (w->of[WORD_WAVELENGTH] > 0 && w->of[WORD_WAVELENGTH] + numbers + filler == w->count) {
        return numbers > 0 ? CSV_CHANNEL : CSV_WAVELENGTH;
    }
    if (w->of[WORD_CONDITION] > 0 && w->of[WORD_VALUE] == 0) {
        return CSV_CONDITION;
    }
    if (w->of[WORD_CORRECTION] > 0) {
        return CSV_CORRECTION;
    }
    if (w->of[WORD_REMARK] > 0) {
        return CSV_REMARK;
    }
    if (w->of[WORD_INDEX] > 0 && w->of[WORD_INDEX] + numbers + filler == w->count) {
        return CSV_INDEX;
    }
    if (w->of[WORD_GROUP] > 0 && w->of[WORD_GROUP] + w->of[WORD_INDEX] == w->count) {
        return CSV_GROUP;
    }
    return CSV_UNKNOWN;
}

static enum csv_role role_of(const struct io_words *w, int *elevation)
{
    enum csv_role role;

    if (w->of[WORD_LOGARITHM] > 0) {
        return CSV_LOGARITHM;
    }
    if (w->of[WORD_SPREAD] == 0 && w->of[WORD_POLAR] + w->of[WORD_AZIMUTH] + w->of[WORD_ELEVATION] > 0) {
        return angle_role(w, elevation);
    }
    if (w->of[WORD_SPREAD] == 0 && w->of[WORD_ANGLE] > 0) {
        return count_sides(w) > 0 ? angle_role(w, elevation) : CSV_DIRECTION;
    }
    role = component_role(w);
    if (role == CSV_UNKNOWN) {
        role = beside_role(w);
    }
    if (role != CSV_UNKNOWN) {
        return role;
    }
    if (is_bare_direction(w) || w->of[WORD_TURN] > 0) {
        return CSV_DIRECTION;
    }
    return w->of[WORD_VALUE] > 0 || w->of[WORD_NUMBER] == w->count || is_channel_letter(w) ? CSV_CHANNEL : CSV_UNKNOWN;
}

struct csv_meaning brdffit_io_meaning(const struct io_field *name)
{
    struct csv_meaning meaning = {CSV_UNKNOWN, UNIT_NONE, 0};
    struct io_words words;

    brdffit_io_words(name, &words);
    meaning.unit = words.unit;
    if (name->length == 0) {
        meaning.role = CSV_UNNAMED;
    } else if (name->length == 1 && strchr("abcABC", name->text[0])) {
        meaning.role = (enum csv_role)(CSV_A + ((name->text[0] | 0x20) - 'a'));
    } else if (name->length == 1 && (name->text[0] | 0x20) == 'w') {
        meaning.role = CSV_W;
    } else if (words.count == 0) {
        meaning.role = name->length == 1 && name->text[0] == '#' ? CSV_INDEX : CSV_UNKNOWN;
    } else if (words.count <= IO_WORDS_MOST) {
        meaning.role = role_of(&words, &meaning.elevation);
    } else if (words.of[WORD_POLAR] + words.of[WORD_AZIMUTH] + words.of[WORD_ELEVATION] > 0) {
        meaning.role = CSV_DIRECTION;
    }
    return meaning;
}

const char *brdffit_io_names_values(const struct io_field *name)
{
    static const struct {
        const char *word, *values;
    } known[] = {{"radiance", "radiance"},         {"ccbrdf", "ccbrdf"},
                 {"cos", "radiance or ccbrdf"},    {"cosine", "radiance or ccbrdf"},
                 {"factor", "reflectance-factor"}, {"brf", "reflectance-factor"},
                 {"hcrf", "reflectance-factor"},   {"hdrf", "reflectance-factor"}};
    struct io_words words;
    size_t i;
    int k;

    brdffit_io_words(name, &words);
    for (k = 0; k < words.count && words.count <= IO_WORDS_MOST; k++) {
        for (i = 0; i < sizeof known / sizeof *known; i++) {
            if (strcmp(words.text[k], known[i].word) == 0) {
                return known[i].values;
            }
        }
    }
    return NULL;
}
