#!/bin/sh
# The same bits on other processors: the core is cross-built (as one file: tools/amalgamate), and runs under QEMU's user
# emulation; firmware runs under its system emulation. Minutes long, so only with BRDFFIT_CROSS=1 (or a list of targets); tools/setup/cross.sh installs what
# it needs. Environment: BRDFFIT_BUILD, BRDFFIT_DATA, BRDFFIT_CROSS, VENV. SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

[ -n "${BRDFFIT_CROSS:-}" ] || {
    echo "cross: skipped; BRDFFIT_CROSS=1 builds for other processors and compares bits under QEMU"
    exit 0
}
build=${BRDFFIT_BUILD:-$PWD/build}
data=${BRDFFIT_DATA:-../shared/data}
out=$build/cross
count=60 # random problems
failed=0
mkdir -p "$out"

# Name, compiler, emulator, flags.
targets='aarch64 aarch64-linux-gnu-gcc qemu-aarch64
armhf arm-linux-gnueabihf-gcc qemu-arm
riscv64 riscv64-linux-gnu-gcc qemu-riscv64
ppc64le powerpc64le-linux-gnu-gcc qemu-ppc64le
s390x s390x-linux-gnu-gcc qemu-s390x
i386 i686-linux-gnu-gcc qemu-i386'

# Measurements, where the Python package is at hand; random problems always.
: > "$out/problems"
if [ -n "${VENV:-}" ] && [ -n "$(ls "$data"/jsss/*.csv 2> /dev/null)" ]; then
    PYTHONPATH=python/src BRDFFIT_LIBRARY="$build/libbrdffit.so" "$VENV/bin/python" tests/cross/problems.py \
        "$data"/jsss/*.csv "$data"/hard/*.csv ${BRDFFIT_CROSS_FILES:-} > "$out/problems"
fi
"${PYTHON:-python3}" tools/amalgamate/amalgamate.py -o "$out" --cc none > /dev/null
${CC:-cc} -O2 -Iinclude tests/cross/bits.c "$build/libbrdffit.a" -lm -o "$out/bits"
"$out/bits" $count < "$out/problems" > "$out/expected"

while read -r name compiler emulator; do
    case " $BRDFFIT_CROSS " in *" 1 "* | *" $name "*) ;; *) continue ;; esac
    if ! command -v "$compiler" > /dev/null || ! command -v "$emulator" > /dev/null; then
        echo "cross: $name skipped: no $compiler or no $emulator"
        continue
    fi
    tree=$out/$name
    mkdir -p "$tree"
    flags=
    [ "$name" != i386 ] || flags='-msse2 -mfpmath=sse'
    # shellcheck disable=SC2086
    "$compiler" -std=gnu11 -O1 $flags -I"$out" -static tests/cross/bits.c "$out/brdffit.c" -lm -o "$tree/bits"
    "$emulator" "$tree/bits" $count < "$out/problems" > "$tree/bits.out"
    if cmp -s "$out/expected" "$tree/bits.out"; then
        echo "cross: $name: $(wc -l < "$tree/bits.out") fits, every bit that of $(uname -m)"
    else
        echo "cross: $name: $(diff "$out/expected" "$tree/bits.out" | grep -c '^>') of $(wc -l < "$out/expected") fits have other bits" >&2
        failed=1
    fi
done << END
$targets
END

case " $BRDFFIT_CROSS " in
*" 1 "* | *" firmware "*) "${PYTHON:-python3}" tools/firmware/run.py --build "$build" || failed=1 ;;
esac
exit $failed
