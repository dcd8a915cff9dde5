#!/bin/sh
# The library as one file (tools/amalgamate): it compiles without a warning, alone and with flags of its own, and the example
# firmware prints with it what it prints with the library. Environment: BRDFFIT_BUILD, CC. SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

CC=${CC:-cc}
PYTHON=${PYTHON:-python3}
build=${BRDFFIT_BUILD:-build}
out=$build/amalgamation
mkdir -p "$out/whole" "$out/small"

make_copy() { # folder, options
    folder=$1
    shift
    "$PYTHON" tools/amalgamate/amalgamate.py "$@" -o "$folder" --cc none > "$folder/said"
}

make_copy "$out/whole"
cmp "$out/whole/brdffit.h" include/brdffit.h
$CC -std=c11 -Wall -Wextra -Werror -fsyntax-only "$out/whole/brdffit.c"
make_copy "$out/small" --distributions beckmann,ggx --lobes 2 --without anisotropic,fresnel,diffuse,masking

# Flags that contract multiply-adds where the processor has them: src/base/ieee.h stands in for the Makefile's.
native=
! echo 'int x;' | $CC -march=native -x c -c -o /dev/null - 2> /dev/null || native=-march=native
firmware='tools/firmware/firmware.c tools/firmware/goniometer.c tools/firmware/host.c -Itools/firmware -DWORKSPACE=131072'
# shellcheck disable=SC2086
$CC -O1 -fexpensive-optimizations $native -c "$out/small/brdffit.c" -o "$out/small/brdffit.o"
# shellcheck disable=SC2086
$CC -O1 -I"$out/small" $firmware "$out/small/brdffit.o" -lm -o "$out/small/firmware"
# shellcheck disable=SC2086
$CC -O1 -Iinclude $firmware "$build/libbrdffit.a" -lm -o "$out/firmware"
"$out/small/firmware" | sed '/^#/d' > "$out/small/printed"
"$out/firmware" | sed '/^#/d' > "$out/printed"
cmp "$out/small/printed" "$out/printed" || {
    echo "amalgamation: other bits than the library's" >&2
    exit 1
}
grep -q 'certified' "$out/printed"

# What a copy is without is refused, and not computed.
cat > "$out/refuses.c" << 'END'
#include <stdio.h>
#include "brdffit.h"
int main(void)
{
    brdffit_options o;
    brdffit_options_init(&o);
    int ok = brdffit_workspace_size(10, 1, &o) > 0;
    o.distribution = BRDFFIT_WARD;
    ok = ok && brdffit_workspace_size(10, 1, &o) == 0;
    brdffit_options_init(&o);
    o.fresnel = BRDFFIT_FRESNEL_SCHLICK;
    ok = ok && brdffit_workspace_size(10, 1, &o) == 0;
    brdffit_options_init(&o);
    o.masking = BRDFFIT_MASKING_SMITH;
    ok = ok && brdffit_workspace_size(10, 1, &o) == 0;
    brdffit_options_init(&o);
    o.diffuse = BRDFFIT_DIFFUSE_BURLEY;
    ok = ok && brdffit_workspace_size(10, 1, &o) == 0;
    brdffit_options_init(&o);
    o.anisotropic = 1;
    ok = ok && brdffit_workspace_size(10, 1, &o) == 0;
    brdffit_options_init(&o);
    o.lobes = 3;
    ok = ok && brdffit_workspace_size(10, 1, &o) == 0;
    return !ok;
}
END
$CC -I"$out/small" "$out/refuses.c" "$out/small/brdffit.o" -lm -o "$out/refuses"
"$out/refuses" || {
    echo "amalgamation: a copy takes what it is without" >&2
    exit 1
}
echo "amalgamation: $(cat "$out/small/said"): the library's bits"
