#!/bin/sh
# A program that was compiled with the headers of version 0.2 prints the same with today's library, and with one whose
# structures have grown at their ends (abi/grow.awk); nothing beside its own structures is written to.
# Environment: BRDFFIT_BUILD, MAKE, CC, THIRD_PARTY. SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

MAKE=${MAKE:-make}
CC=${CC:-cc}
build=${BRDFFIT_BUILD:-build}
grown=$build/grown
mkdir -p "$grown/old"
trap 'rm -rf "$grown/old"' EXIT

for name in brdffit brdffit_io; do
    cp "tests/data/abi/$name-0.2.h" "$grown/old/$name.h"
done
# `make check` has built it.
MAKEFLAGS='' $MAKE -j"$(getconf _NPROCESSORS_ONLN 2> /dev/null || echo 1)" --no-print-directory -s BUILD="$build" \
    THIRD_PARTY="${THIRD_PARTY:-$build/third_party}" build-grown > /dev/null
$CC -std=c11 -O1 -Wall -Wextra -I"$grown/old" -o "$grown/program" tests/abi/program.c -L"$build" -lbrdffit_io -lbrdffit -lm

LD_LIBRARY_PATH=$build "$grown/program" > "$grown/today.txt" || { tail -n 1 "$grown/today.txt" >&2; exit 1; }
LD_LIBRARY_PATH=$grown "$grown/program" > "$grown/later.txt" || { tail -n 1 "$grown/later.txt" >&2; exit 1; }
cmp "$grown/today.txt" "$grown/later.txt"
echo "abi: a program of 0.2 prints the same $(wc -l < "$grown/today.txt") lines with a library that has grown"
