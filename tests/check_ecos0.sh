#!/bin/sh
# The permissive library (make ECOS=0): it builds in its own tree, holds nothing of ECOS, and passes the C
# tests. Environment: BRDFFIT_BUILD, MAKE. SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

MAKE=${MAKE:-make}
build=${BRDFFIT_BUILD:-build}/ecos0

$MAKE --no-print-directory -s ECOS=0 ECOS_DIR= BUILD="$build" THIRD_PARTY="$build/none" libraries programs test-programs > /dev/null
if nm "$build/libbrdffit.a" "$build/libbrdffit.so" 2> /dev/null | grep -i -E ' (ecos|amd|ldl)_'; then
    echo "make ECOS=0 has linked ECOS" >&2
    exit 1
fi
if [ -e "$build/none" ]; then
    echo "make ECOS=0 has fetched ECOS" >&2
    exit 1
fi
failed=0
for test in "$build"/tests/test_*; do
    if BRDFFIT_BUILD=$build "$test" > "$build/output" 2>&1; then
        :
    else
        cat "$build/output" >&2
        echo "FAILED without ECOS: $test" >&2
        failed=1
    fi
done
[ $failed = 0 ] && echo "ecos0: builds without ECOS; the C tests pass"
exit $failed
