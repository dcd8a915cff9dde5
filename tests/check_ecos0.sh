#!/bin/sh
# The permissive library (make ECOS=0): it builds, of the objects that are the same with and without and of its own (in
# obj/no_ecos), holds nothing of ECOS, and passes the C tests. Environment: BRDFFIT_BUILD, MAKE.
# SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

MAKE=${MAKE:-make}
tree=${BRDFFIT_BUILD:-build}
build=$tree/ecos0

# The Makefile's list of those with objects of their own looks at .c files alone.
asking=$(grep -lE 'BRDFFIT_NO_ECOS|"fewer\.h"' tests/*.h tests/*/*.h | grep -vx tests/fewer.h || :)
[ -z "$asking" ] || {
    echo "asks for ECOS, which only a .c file may: $asking" >&2
    exit 1
}
# `make check` has built it. Otherwise a make of its own: the caller's jobs are not passed on to scripts.
MAKEFLAGS='' $MAKE -j"$(getconf _NPROCESSORS_ONLN 2> /dev/null || echo 1)" --no-print-directory -s BUILD="$tree" \
    build-ecos0 > /dev/null
if nm "$build/libbrdffit.a" "$build/libbrdffit.so" 2> /dev/null | grep -i -E ' (ecos|amd|ldl)_'; then
    echo "make ECOS=0 has linked ECOS" >&2
    exit 1
fi
if [ -e "$build/none" ]; then
    echo "make ECOS=0 has fetched ECOS" >&2
    exit 1
fi
printf 'programs:%s\n' "$build"/tests/test_* | xargs sh tools/setup/run_tests.sh > "$build/output" 2>&1 || {
    cat "$build/output" >&2
    exit 1
}
echo "ecos0: builds without ECOS; the C tests pass ($(tail -n 1 "$build/output"))"
