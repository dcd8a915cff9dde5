#!/bin/sh
# The permissive library (make ECOS=0): it builds in its own tree, holds nothing of ECOS, and passes the C
# tests. Environment: BRDFFIT_BUILD, MAKE. SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

MAKE=${MAKE:-make}
build=${BRDFFIT_BUILD:-build}/ecos0
export BRDFFIT_BUILD="$build" # what the tests look for there

# A make of its own, with as many jobs as there are processors: the caller's are not passed on to scripts.
MAKEFLAGS='' $MAKE -j"$(getconf _NPROCESSORS_ONLN 2> /dev/null || echo 1)" --no-print-directory -s ECOS=0 ECOS_DIR= \
    BUILD="$build" THIRD_PARTY="$build/none" libraries programs test-programs > /dev/null
if nm "$build/libbrdffit.a" "$build/libbrdffit.so" 2> /dev/null | grep -i -E ' (ecos|amd|ldl)_'; then
    echo "make ECOS=0 has linked ECOS" >&2
    exit 1
fi
if [ -e "$build/none" ]; then
    echo "make ECOS=0 has fetched ECOS" >&2
    exit 1
fi
sh tools/setup/run_tests.sh programs "$build"/tests/test_* > "$build/output" 2>&1 || {
    cat "$build/output" >&2
    exit 1
}
echo "ecos0: builds without ECOS; the C tests pass ($(tail -n 1 "$build/output"))"
