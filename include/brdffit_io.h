/*
 * brdffit_io: measured reflectance from files, ready for brdffit_fit().
 * Link libbrdffit_io (needs stdio and zlib; the core needs neither).
 * Thread-safe: no globals; the locale of the process does not matter.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_H
#define BRDFFIT_IO_H

#include "brdffit.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Why a file's entries did not even become samples. */
typedef enum brdffit_io_drop {
    BRDFFIT_IO_DROP_MASKED = 0, /* MERL: negative, that is, not measured */
    BRDFFIT_IO_DROP_ABSENT,     /* CSV: no value in a channel: an empty field, NA and the like, or options.missing */
    BRDFFIT_IO_DROP_BELOW_HORIZON, /* MERL cell whose angles leave the hemisphere, measured or not */
    BRDFFIT_IO_DROP_SATURATED, /* CSV: a value at or above options.saturated */
    BRDFFIT_IO_DROP_COUNT
} brdffit_io_drop;

/* Constant snake_case name: "masked", "absent", "cell_below_horizon", "saturated". */
BRDFFIT_API const char *brdffit_io_drop_string(brdffit_io_drop reason);

typedef enum brdffit_io_format {
    BRDFFIT_IO_FORMAT_AUTO = 0, /* by content: gzip magic is looked through; text is a table */
    BRDFFIT_IO_FORMAT_CSV,      /* comma, semicolon or tab separated, one header line */
    BRDFFIT_IO_FORMAT_MERL      /* .binary */
} brdffit_io_format;

typedef enum brdffit_io_merl_bins {
    BRDFFIT_IO_MERL_EDGE = 0, /* entry i stands for its bin's lower edge: theta_h = 90 (i/n)^2 degrees */
    BRDFFIT_IO_MERL_CENTRE    /* entry i stands for its bin's centre:    theta_h = 90 ((i+1/2)/n)^2 */
} brdffit_io_merl_bins;

typedef enum brdffit_io_merl_sampling {
    BRDFFIT_IO_MERL_TABLE = 0,  /* every valid cell */
    BRDFFIT_IO_MERL_PROTOCOL84, /* the paper's 84 directions, nearest-entry look-up */
    BRDFFIT_IO_MERL_DIRECTIONS  /* the directions of `directions`, nearest-entry look-up */
} brdffit_io_merl_sampling;

/* Which values of a CSV stand for "not measured", beside empty fields and words such as NA and NaN. */
typedef enum brdffit_io_missing {
    BRDFFIT_IO_MISSING_MARKED = 0, /* no number; one that looks like such a mark (-999, 99999) is refused */
    BRDFFIT_IO_MISSING_VALUE,      /* missing_value */
    BRDFFIT_IO_MISSING_NEGATIVE,   /* every number below 0 */
    BRDFFIT_IO_MISSING_NONE        /* no number, whatever it looks like */
} brdffit_io_missing;

/* What the values of a file are, where they have to be turned into f_r first. */
typedef enum brdffit_io_values {
    BRDFFIT_IO_VALUES_PLAIN = 0,         /* they are `quantity` */
    BRDFFIT_IO_VALUES_CCBRDF,            /* f_r (n.v), the cosine-corrected BRDF of scatterometers */
    BRDFFIT_IO_VALUES_REFLECTANCE_FACTOR /* pi f_r */
} brdffit_io_values;

/* What the directions of a CSV are, where its header does not say it: bits of brdffit_io_options.directions_as. */
#define BRDFFIT_IO_DEGREES 1u        /* however small the angles are */
#define BRDFFIT_IO_RADIANS 2u
#define BRDFFIT_IO_ELEVATION 4u      /* polar angles count from the surface up */
#define BRDFFIT_IO_MIRROR_AT_ZERO                                                                                      \
    8u /* the mirror direction is at the azimuth of the light; signed angles in a plane: at
                                        theta_o = -theta_i */
#define BRDFFIT_IO_LIGHT_TRAVELS 16u /* light vectors point the way that light travels, to the surface */
#define BRDFFIT_IO_Y_UP 32u          /* the normal is +y */
#define BRDFFIT_IO_AS_WRITTEN 64u    /* +z up and towards the light, whatever it looks like */

/* NULL stands for the defaults wherever this is taken. */
typedef struct brdffit_io_options {
    size_t struct_size;
    brdffit_io_format format;
    int quantity_set;            /* 0: f_r for directions and tables, radiance for a,b,c */
    brdffit_quantity quantity;   /* used when quantity_set */
    brdffit_io_merl_bins merl_bins;
    brdffit_io_merl_sampling merl_sampling;
    int directions_only;         /* 1: a CSV needs no channel; its samples may then have none (channels 0,
                                    values NULL): places to evaluate at or to look up, nothing to fit */
    const brdffit_samples *directions; /* form DIRECTIONS, used with MERL_DIRECTIONS */
    size_t max_bytes;            /* most that a file may have, and that a gzip stream may unpack to; 0: 8 GiB for
                                    files, 1 GiB unpacked */
    const char *channels; /* CSV: names separated by commas: these columns are the channels, in the file's order, and
                                    what means nothing else is left out. NULL: see brdffit_io_read() */
    const char *columns; /* CSV: "role=name,role=name": what columns mean that are not understood, or wrongly. Roles:
                                    theta_i, phi_i, theta_o, phi_o, phi (between the two), theta_h, phi_h, theta_d, phi_d,
                                    lx to nz, a, b, c, weight, uncertainty, wavelength, channel, ignore. NULL: none */
    brdffit_io_missing missing;
    brdffit_io_values values; /* not with quantity RADIANCE */
    unsigned directions_as; /* BRDFFIT_IO_DEGREES | ...; 0: as the header says, and in degrees */
    int reserved; /* 0 */
    double missing_value; /* used with BRDFFIT_IO_MISSING_VALUE */
    double saturated; /* > 0: samples with a value at or above it are left out; 0: none */
    char *fault; /* room for fault_size bytes: the text of the field that an error is about, terminated and
                                    printable; empty when it is about none. NULL: not wanted */
    size_t fault_size;
} brdffit_io_options;

/* Set struct_size and every default. NULL is fine: nothing happens. */
#define brdffit_io_options_init(options) brdffit_io_options_init_sized((options), sizeof(brdffit_io_options))
BRDFFIT_API void brdffit_io_options_init_sized(brdffit_io_options *options, size_t struct_size);

/* Something to know about how a file was read: a sentence in UTF-8, without the full stop. */
typedef struct brdffit_io_note {
    const char *text;
    size_t warning; /* 1: the data look wrong; 0: what was inferred, left out or counted */
} brdffit_io_note;

/*
 * A file in memory. Owns everything that it points to, samples included.
 * Release with brdffit_io_free().
 */
typedef struct brdffit_table {
    brdffit_samples *samples; /* ready for brdffit_fit() */
    char **channel_names; /* samples->channels strings */
    size_t *lines; /* per sample, the line of the text file; NULL for MERL */
    brdffit_io_format format; /* what the file turned out to be */
    int compressed; /* 1 for gzip */
    const size_t *dropped; /* BRDFFIT_IO_DROP_COUNT counts, by brdffit_io_drop */
    size_t negative; /* samples kept that have a negative value (CSV only) */
    size_t dims[3]; /* MERL: theta_h, theta_d, phi_d bins; else 0 */
    size_t rows; /* entries in the file: CSV data lines, or MERL cells */
    brdffit_io_merl_bins merl_bins;
    brdffit_io_merl_sampling merl_sampling;
    brdffit_sums *sums; /* by brdffit_io_read_sums(), or NULL */
    const brdffit_io_note *const *notes; /* what was inferred from a text, and what looks wrong in it */
    size_t note_count;
} brdffit_table;

/*
 * Read `path` ("-": standard input). On failure returns the code, fills
 * *error (may be NULL) with line, column, sample, channel and value where
 * they apply, and *table holds NULL.
 *
 * CSV: fields separated by commas, semicolons, tabs, bars or blanks, in UTF-8 or UTF-16. Lines that begin with #, % or
 * // and blank lines are skipped. The header is the first line that names directions; it may stand behind # when only
 * numbers follow. Names are matched by the words that they are made of, whatever their case and punctuation, and units
 * in brackets or at the end ("theta_i (rad)") are obeyed (brdffit_io_column_words()):
 *
 *   theta_i,phi_i,theta_o,phi_o in degrees; without azimuths the data are in-plane, with the mirror direction at theta_o =
 *   theta_i; a single azimuth is that between light and viewer, 180 towards the mirror direction
 *   theta_h,theta_d,phi_d: half and difference angles
 *   lx,ly,lz,vx,vy,vz: vectors, optionally nx,ny,nz
 *   a,b,c: the model's own coefficients
 *   weight: weights
 *   uncertainty (or stddev, std): the standard deviation of the sample's values, > 0, in their units: of radiance u the
 *   weight is 1 / u^2, and of f_r, whose residuals are multiplied by n.l, 1 / (u n.l)^2; times a column weight
 *   wavelength: rows of the same directions become one sample with a channel for each wavelength
 *
 * Other columns of numbers are channels, unless their names or numbers say that they are something else (a running
 * number, a mask, a temperature): such columns are left out, with a note, or refused where leaving them out could be
 * wrong. Decimal commas, degree and percent signs and D exponents are understood; thousands separators are refused.
 * Empty fields, NA, NaN, #N/A and the like in a channel drop the sample as absent. All that was inferred is in
 * table->notes.
 *
 * MERL: three little-endian int32 n_h, n_d, n_p, then three planes of
 * n_h n_d n_p float64, index p + n_p (d + n_d h), scaled by 1/1500,
 * 1.15/1500, 1.66/1500. n_p covers [0, 180) degrees. Negative entries in
 * any channel mask the cell. NaN and infinities are errors. The size of the
 * file must be exactly what its header says.
 */
BRDFFIT_API brdffit_status brdffit_io_read(const char *path, const brdffit_io_options *options, brdffit_table **table,
                                           brdffit_error *error);

/* The same from memory. Data may be gzip. Both give the same bits in every floating-point environment of the caller. */
BRDFFIT_API brdffit_status brdffit_io_read_memory(const void *data, size_t size, const brdffit_io_options *options,
                                                  brdffit_table **table, brdffit_error *error);

/*
 * brdffit_io_read() in a fraction of time and memory, for who only fits: a whole MERL table is added up while it is read, for
 * `fit` (NULL: defaults; its distribution, max_incidence and isa), and table->sums is what brdffit_fit_sums() takes.
 * table->samples then has a count but no arrays. Whatever sums cannot do (text, look-ups, other norms and engines,
 * LAFORTUNE, lobes of several geometries, values beyond their range) is read as by brdffit_io_read(), and table->sums is NULL.
 *
 * A regular file is mapped for the time of the call and as long as table->sums is there: truncating it meanwhile ends
 * the process with SIGBUS. Who cannot exclude that uses brdffit_io_read(), or standard input.
 */
BRDFFIT_API brdffit_status brdffit_io_read_sums(const char *path, const brdffit_io_options *options,
                                                const brdffit_options *fit, brdffit_table **table,
                                                brdffit_error *error);

/* The same from memory, which must stay as it is while table->sums is there. Data may be gzip. */
BRDFFIT_API brdffit_status brdffit_io_read_sums_memory(const void *data, size_t size, const brdffit_io_options *options,
                                                       const brdffit_options *fit, brdffit_table **table,
                                                       brdffit_error *error);

/* Samples in place of sums, of the same file; nothing happens where there are samples already. On failure the table
 * stays as it was. */
BRDFFIT_API brdffit_status brdffit_io_samples(brdffit_table *table, brdffit_error *error);

BRDFFIT_API void brdffit_io_free(brdffit_table *table);

/*
 * The words that names of columns are made of, by meaning: the i-th meaning as *what, and its words separated by
 * blanks. NULL past the last.
 */
BRDFFIT_API const char *brdffit_io_column_words(size_t i, const char **what);

/* ---- Arrays and images: what maps are made of -------------------------- */

/* Most dimensions that an array may have. */
#define BRDFFIT_IO_MAX_DIMS 8

typedef enum brdffit_io_container {
    BRDFFIT_IO_NPY = 0, /* NumPy's .npy, versions 1 to 3 */
    BRDFFIT_IO_NPZ, /* a .npy in a zip, stored or deflated; zip64 too */
    BRDFFIT_IO_PFM /* "PF" colour or "Pf" grey, float32, either byte order */
} brdffit_io_container;

/*
 * A numeric array in a file: what its header says. Made by brdffit_io_array_open() and released by
 * brdffit_io_array_close(). Only read; threads may share it.
 * A PFM is height x width x 3, or height x width when grey, with row 0 at the top.
 */
typedef struct brdffit_array {
    brdffit_io_container container;
    char kind; /* as in NumPy: 'b' bool, 'i', 'u' integer, 'f' float */
    int item_size; /* bytes: 1, 2, 4 or 8; floats 2, 4 or 8 */
    int big_endian; /* of more than one byte */
    int fortran_order; /* the first index runs fastest in the file */
    int compressed; /* a deflated member of a .npz: unpacked when opened */
    int dims; /* 0 to BRDFFIT_IO_MAX_DIMS */
    size_t shape[BRDFFIT_IO_MAX_DIMS]; /* each at least 1 */
    size_t count; /* product of shape; count * item_size fits size_t */
} brdffit_array;

/*
 * Open an array and check everything that its header claims against the file. `member` names the array of a .npz
 * that is wanted, without ".npy" (NULL: its only one); other containers have none. A deflated member is unpacked in
 * memory when it is opened, at most 8 GiB, and its checksum verified; a stored one is read in place, unchecked.
 *
 * Fails with BRDFFIT_ERR_FORMAT, where error->value often holds a byte's position as the message says: not one of
 * these containers, a damaged or lying header, an encrypted member, an unknown compression, a file that is
 * shorter or longer than its header says, no elements, or a type that is not a plain number.
 */
BRDFFIT_API brdffit_status brdffit_io_array_open(const char *path, const char *member, brdffit_array **array,
                                                 brdffit_error *error);

/* The same from memory, which must outlive the array. */
BRDFFIT_API brdffit_status brdffit_io_array_open_memory(const void *data, size_t size, const char *member,
                                                        brdffit_array **array, brdffit_error *error);

/*
 * Elements start[d] <= index[d] < start[d] + count[d] of every dimension d as doubles into `out`, the last index
 * running fastest whatever the file's order. Integers beyond 2^53 are rounded; NaN and infinities pass. Reads only
 * these elements of the file (PFM and NPY in either order: random access), without allocating.
 */
BRDFFIT_API brdffit_status brdffit_io_array_read(const brdffit_array *array, const size_t *start, const size_t *count,
                                                 double *out, brdffit_error *error);

BRDFFIT_API void brdffit_io_array_close(brdffit_array *array);

/* Room that a header takes at most. */
#define BRDFFIT_IO_HEADER_MAX 512

/*
 * The bytes that go before the elements of a file to be written: NPY version 1, little-endian and C order, kind and
 * item_size as in brdffit_array; and PFM, little-endian float32 with 1 or 3 channels and the bottom row first.
 * Returns the length, or 0 when there is no such file.
 */
BRDFFIT_API size_t brdffit_io_npy_header(char kind, int item_size, int dims, const size_t *shape,
                                         unsigned char out[BRDFFIT_IO_HEADER_MAX]);
BRDFFIT_API size_t brdffit_io_pfm_header(size_t width, size_t height, int channels,
                                         unsigned char out[BRDFFIT_IO_HEADER_MAX]);

/*
 * A .npz to be written, stored, zip64 where sizes ask for it. `write` gets the bytes in order and returns 0 once it
 * has taken them. Each member's size and CRC-32 (brdffit_io_crc32 over its bytes, starting from 0) have to be known
 * when it begins; brdffit_io_zip_finish() fails when what was written differs. All return BRDFFIT_OK,
 * BRDFFIT_ERR_MEMORY, BRDFFIT_ERR_READ when `write` refused, or BRDFFIT_ERR_ARGUMENT. Times are not recorded: same
 * content, same bytes.
 */
typedef int (*brdffit_io_write_fn)(void *user, const void *data, size_t size);
typedef struct brdffit_io_zip brdffit_io_zip;

BRDFFIT_API unsigned long brdffit_io_crc32(unsigned long crc, const void *data, size_t size);
BRDFFIT_API brdffit_io_zip *brdffit_io_zip_new(brdffit_io_write_fn write, void *user);
BRDFFIT_API brdffit_status brdffit_io_zip_begin(brdffit_io_zip *zip, const char *name, unsigned long long size,
                                                unsigned long crc);
BRDFFIT_API brdffit_status brdffit_io_zip_write(brdffit_io_zip *zip, const void *data, size_t size);

/* Directory and end; releases `zip` (NULL: BRDFFIT_ERR_MEMORY) whatever the answer. `abandon`: only release. */
BRDFFIT_API brdffit_status brdffit_io_zip_finish(brdffit_io_zip *zip, int abandon);

/* The paper's protocol: 84 x 3 light and 84 x 3 view unit vectors, normal +z:
 * for views 0, 20, 40, 60 degrees, lights 0..60 by 10 at azimuths 0, 90, 180. */
BRDFFIT_API void brdffit_io_protocol84(double light[84 * 3], double view[84 * 3]);

#ifdef __cplusplus
}
#endif
#endif
