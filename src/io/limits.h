/*
 * Every tolerance and limit of the file readers: name, unit, why this value.
 * SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_IO_LIMITS_H
#define BRDFFIT_IO_LIMITS_H

#include <stdint.h>

/* Most bytes that a file may hold, and a deflated array unpack to: 8 GiB. A MERL table of 90 x 90 x 180 has 35 MB. */
#if SIZE_MAX / 4 < 8589934592
#define IO_LIMIT_BYTES (SIZE_MAX / 4)
#else
#define IO_LIMIT_BYTES ((size_t)8589934592)
#endif

/* Most bytes that a gzip stream unpacks to where the caller sets no limit (brdffit_io_options.max_bytes): a hostile one
 * of 1 MB has up to 1032 times as many, and all of it would have to be in memory. Ten million lines of a table fit. */
#define IO_LIMIT_UNPACKED ((size_t)1073741824)

/* First buffer for input of unknown length, bytes. */
#define IO_FIRST_BUFFER ((size_t)65536)

/* Bytes at the start of a file that decide whether it is text. */
#define IO_TEXT_PROBE ((size_t)65536)

/* Lines of text above the header of a text table, at most. */
#define IO_HEADER_LINES ((size_t)100)

/* First rows that a text table makes room for; doubled as needed. */
#define IO_FIRST_ROWS ((size_t)256)

/* A MERL cell with n.l or n.v at or below this is on the horizon: the product formula rounds by less
 * (theta_h = 40, theta_d = 50, phi_d = 0 is exactly on it), and no table is fine enough to come near it. */
#define IO_HORIZON 1e-15

/* Radians. A direction this little below the lower edge of a bin belongs to that bin: unit vectors round by
 * 1e-16 a component, and half vectors of them by a few times that. 6e-13 degrees is far below any aim. */
#define IO_EDGE_SNAP 1e-14

/* Longest header of a .npy, bytes. NumPy writes 118 for any array of numbers and refuses 10,000 by default. */
#define IO_LIMIT_NPY_HEADER ((size_t)65535)

/* Largest directory of a .npz, bytes: some ten thousand members. */
#define IO_LIMIT_ZIP_DIRECTORY ((size_t)1048576)

/* Longest name of a member of a .npz, bytes. */
#define IO_LIMIT_ZIP_NAME ((size_t)255)

/* Elements converted at a time. */
#define IO_ELEMENTS ((size_t)4096)

#endif
