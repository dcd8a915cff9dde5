#!/bin/sh
# Sources that are compiled without the Makefile's flags: the compiler's own multiply-adds stay out (src/base/ieee.h), and
# where they cannot be kept out they are told. Environment: CC. SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

CC=${CC:-cc}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$scratch/bare/base"
grep -v '^#pragma' src/base/ieee.h > "$scratch/bare/base/ieee.h" # what the sources would be without it

flags='-std=c11 -O2 -Iinclude -Isrc'
! echo 'int x;' | $CC -mfma -x c -c -o /dev/null - 2> /dev/null || flags="$flags -mfma"

cat > "$scratch/tells.c" << 'END'
#include "base/ieee.h"
int main(void) { return ieee_contracts(); }
END

multiply_adds() { # flags: in the disassembly of files that are all arithmetic
    for file in src/solve/newton.c src/solve/nnls_gain.c src/kernels/kernels_base.c; do
        # shellcheck disable=SC2086
        $CC $1 $flags -Wno-psabi -c "$file" -o "$scratch/file.o"
        objdump -d "$scratch/file.o"
    done | grep -c -E '\<(vfn?m(add|sub)|fn?m(add|sub|la|ls))' || true
}

bare=$(multiply_adds "-I$scratch/bare -ffp-contract=fast")
guarded=$(multiply_adds '')
[ "$guarded" = 0 ] || {
    echo "contraction: $guarded multiply-adds in sources compiled without flags" >&2
    exit 1
}

# What the program finds, where this processor has what it was compiled for.
tells() { # flags
    # shellcheck disable=SC2086
    $CC $1 $flags "$scratch/tells.c" -o "$scratch/tells"
    "$scratch/tells" && echo 0 || echo $?
}
[ "$(tells '')" = 0 ]
found='no multiply-add here'
if [ "$bare" != 0 ] && { [ "$flags" = "${flags% -mfma}" ] || grep -qw fma /proc/cpuinfo; }; then
    found=$(tells "-I$scratch/bare -ffp-contract=fast")
    [ "$found" = 1 ] || {
        echo "contraction: multiply-adds are not told ($found)" >&2
        exit 1
    }
    found='and are told'
fi
echo "contraction: none with the compiler's own flags; $bare without src/base/ieee.h, $found"
