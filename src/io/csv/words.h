/*
 * The words that names of columns are made of. SPDX-License-Identifier: MIT
 *
 * "theta_i (deg)", "thetaIn", "Incident zenith angle [°]" and "θi" are the same two words and a unit: a polar angle, of
 * the light. Names are cut at whatever is neither letter nor digit, between a small and a capital letter and between
 * letters and digits; case does not count, and Greek letters are their names.
 */
#ifndef BRDFFIT_IO_WORDS_H
#define BRDFFIT_IO_WORDS_H

#include "io/csv/fields.h"

enum io_word {
    WORD_OTHER = 0,
    WORD_POLAR,
    WORD_AZIMUTH,
    WORD_ELEVATION,
    WORD_ANGLE, /* polar, next to a side and nothing more */
    WORD_LIGHT,
    WORD_VIEW,
    WORD_NORMAL,
    WORD_TANGENT,
    WORD_S, /* sun or scatter: by what else there is */
    WORD_D, /* difference or detector, likewise */
    WORD_HALF,
    WORD_RELATIVE,
    WORD_X,
    WORD_Y,
    WORD_Z,
    WORD_FILLER,
    WORD_NUMBER,
    WORD_VALUE, /* what channels are called */
    WORD_WEIGHT,
    WORD_UNCERTAINTY,
    WORD_SPREAD, /* an uncertainty of something, or of some other kind */
    WORD_MASK,
    WORD_INDEX,
    WORD_WAVELENGTH,
    WORD_CONDITION, /* temperature, time: about the measurement, not of it */
    WORD_CORRECTION, /* dark level, exposure: what the values may still need */
    WORD_TURN,      /* tilt, rotation: of a sample or an arm, which says nothing of how */
    WORD_REMARK,
    WORD_GROUP, /* what tells several measurements in a file apart */
    WORD_LOGARITHM,
    WORD_CLASSES
};

enum io_unit { UNIT_NONE = 0, UNIT_DEGREES, UNIT_RADIANS, UNIT_PERCENT, UNIT_OTHER };

#define IO_WORDS_MOST 8
#define IO_WORD_LENGTH 24

struct io_words {
    enum io_word word[IO_WORDS_MOST];
    char text[IO_WORDS_MOST][IO_WORD_LENGTH];
    int count; /* IO_WORDS_MOST + 1: more than that, which no name of ours has */
    enum io_unit unit;
    int of[WORD_CLASSES]; /* how many of each */
};

void brdffit_io_words(const struct io_field *name, struct io_words *words);

/* The unit that a field says and nothing else: "deg", "[rad]", "1/sr". UNIT_NONE: it is none. */
enum io_unit brdffit_io_unit(const struct io_field *field);

/* Equal but for case, blanks and punctuation; names without letters and digits only when they are the same. */
int brdffit_io_same_name(const struct io_field *a, const char *b, size_t length);

#endif
