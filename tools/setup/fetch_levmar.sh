#!/bin/sh
# Fetch the source of levmar 2.6 into DIR/levmar-2.6, unpacked and with its hash checked.
#
#   fetch_levmar.sh DIR
#
# For the benchmark of local solvers only (tools/bench/peers.mk): levmar is GPL and is never linked into the library.
# Its C source lies in the source distribution of the Python package levmar 0.2.3 (sdist.sh).
# Without a network: put levmar-0.2.3.tar.gz into DIR. Environment: PYTHON. SPDX-License-Identifier: MIT
set -eu

PACKAGE=levmar
VERSION=0.2.3
SHA256=fbdeaac4390e69121d4195bcafc815e7ba92bca06bcced769abeed37a13cd5c0
NAME=levmar-2.6
TITLE='levmar 2.6 (GPL; for the benchmark of local solvers only)'
WITHOUT=
. "$(dirname "$0")/sdist.sh"

sdist_open "$1"
source=$unpacked/levmar/$NAME
# levmar's own option to do without LAPACK is this line of its header (its CMake file writes it).
sed 's|^#define HAVE_LAPACK$|/* #undef HAVE_LAPACK */|' "$source/levmar.h" > "$scratch/levmar.h"
mv "$scratch/levmar.h" "$source/levmar.h"
sdist_install "$source"
