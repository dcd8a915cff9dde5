#!/bin/sh
# Fetch the source of ECOS into DIR/ecos-2.0.14, unpacked and with its hash checked.
#
#   fetch_ecos.sh DIR
#
# The C sources are taken from the source distribution of the Python package (sdist.sh).
# Without a network: put ecos-2.0.14.tar.gz into DIR, or build with ECOS_DIR=path or ECOS=0.
# Environment: PYTHON. SPDX-License-Identifier: MIT
set -eu

PACKAGE=ecos
VERSION=2.0.14
SHA256=64b3201c0e0a7f0129050557c4ac50b00031e80a10534506dba1200c8dc1efe4
NAME=ecos-$VERSION
TITLE="$NAME (GPL-3.0; 'make ECOS=0' builds without it)"
WITHOUT=', or build with ECOS_DIR=path-of-its-source or ECOS=0'
. "$(dirname "$0")/sdist.sh"

sdist_open "$1"
sdist_install "$unpacked"
