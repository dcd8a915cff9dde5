#!/bin/sh
# make check-package: the Python package as people install it, in fresh virtual environments, from a copy of the tree.
#
#   package.sh [SCRATCH]       a new directory for all of it (default: a temporary one, removed at the end)
#
# Wheel (without the tree, without a compiler), sdist, editable installation, ECOS=0 without a network, removal. pip
# fetches NumPy, hatchling and ECOS, so that this is no part of `make check`. Environment: PYTHON, CC, CFLAGS.
# SPDX-License-Identifier: MIT
set -eu

PYTHON=${PYTHON:-python3}
root=$(cd "$(dirname "$0")/../.." && pwd)
if [ $# -gt 0 ]; then
    mkdir "$1"
    scratch=$(cd "$1" && pwd)
else
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
    trap 'exit 1' HUP INT TERM
fi
unset BRDFFIT_LIBRARY BRDFFIT_PYTHON_BUILD THIRD_PARTY ECOS ECOS_DIR PYTHONPATH MAKEFLAGS MFLAGS MAKELEVEL
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_QUIET=1
tree=$scratch/tree

step() { echo "== $*"; }

fail() {
    echo "package.sh: $*" >&2
    exit 1
}

copy_tree() { # what git would ship, uncommitted changes too; and nothing built
    mkdir "$tree"
    tar -C "$root" -cf - --exclude=__pycache__ --exclude=_lib Makefile LICENSE include src tools python | tar -C "$tree" -xf -
}

environment() { # name: a new one
    "$PYTHON" -m venv "$scratch/$1"
}

EXAMPLE='import brdffit
fit = brdffit.fit(brdffit.Samples.example(), lobes=2)
print(fit)'

# The example in an environment, from another directory, with no variable and no program on the path.
try_example() { # name
    (cd / && env -i PATH= "$scratch/$1/bin/python" -c "$EXAMPLE
import shutil
assert not any(map(shutil.which, ('cc', 'gcc', 'clang', 'make')))
print(brdffit.library_path())") > "$scratch/$1.txt" || fail "the example fails in $1"
    grep -q 'Proven: no Beckmann fit with 2 lobes' "$scratch/$1.txt" || fail "no proof: $scratch/$1.txt"
    tail -n 1 "$scratch/$1.txt" | grep -q "^$2" || fail "$(tail -n 1 "$scratch/$1.txt") was loaded, not one of $2"
    "$scratch/$1/bin/brdffit-report" --version | grep -q '^brdffit-report' || fail "no brdffit-report in $1"
}

install_from_tree() {
    step "pip install ./python"
    environment install
    (cd "$tree" && "$scratch/install/bin/pip" install ./python)
    try_example install "$scratch/install/lib"
    sed 's/^/    /' "$scratch/install.txt"
}

build_archives() {
    step "wheel and sdist"
    environment tools
    "$scratch/tools/bin/pip" install build hatchling editables numpy
    (cd "$tree" && "$scratch/tools/bin/pip" wheel --no-deps -w "$scratch/wheels" ./python)
    "$scratch/tools/bin/python" -m build --sdist --outdir "$scratch/sdist" "$tree/python" > "$scratch/build.log" 2>&1 ||
        fail "no sdist: $(tail -n 20 "$scratch/build.log")"
    ls -l "$scratch"/wheels/*.whl "$scratch"/sdist/*.tar.gz
}

editable() {
    step "pip install -e ./python"
    environment editable
    (cd "$tree" && "$scratch/editable/bin/pip" install -e ./python)
    try_example editable "$tree/python/src/brdffit/_lib"
    echo 'MARK = "changed"' >> "$tree/python/src/brdffit/__init__.py"
    [ "$(cd / && "$scratch/editable/bin/python" -c 'import brdffit; print(brdffit.MARK)')" = changed ] ||
        fail "a change of the Python sources is not seen"
    # The C sources: the same command again compiles what has changed.
    echo 'const char brdffit_mark[] = "a change of package.sh";' >> "$tree/src/base/status.c"
    touch "$scratch/before"
    (cd "$tree" && "$scratch/editable/bin/pip" install -e ./python)
    fresh=$(find "$tree/build/python/obj/src" -name '*.o' -newer "$scratch/before" | wc -l)
    [ "$fresh" = 1 ] || fail "$fresh objects were compiled after a change of one source"
    grep -q 'a change of package.sh' "$tree/python/src/brdffit/_lib/libbrdffit.so" || fail "the library is the old one"
    try_example editable "$tree/python/src/brdffit/_lib"
    remove editable
    [ ! -e "$tree/python/src/brdffit/_lib/libbrdffit.so.new" ] || fail "a half-made library was left"
}

without_ecos() {
    step "ECOS=0, without a network"
    rm -rf "$tree/build"
    # Nothing may be fetched: pip is told so, and a proxy that is not there stops everybody else.
    environment noecos
    (cd "$tree" && ECOS=0 https_proxy=http://127.0.0.1:9 http_proxy=http://127.0.0.1:9 "$scratch/tools/bin/pip" wheel \
        --no-deps --no-index --no-build-isolation -w "$scratch/noecos-wheel" ./python)
    [ ! -e "$tree/build/third_party" ] || fail "ECOS=0 fetched something"
    "$scratch/noecos/bin/pip" install "$scratch"/noecos-wheel/*.whl
    try_example noecos "$scratch/noecos/lib"
    "$scratch/noecos/bin/python" -c 'import brdffit
try:
    brdffit.fit(brdffit.Samples.example(), norm="l1")
except brdffit.BrdffitError as error:
    print("    norm l1:", error)
    assert error.code == "unsupported", error.code
else:
    raise SystemExit("norm l1 works without ECOS")'
}

remove() { # name: nothing stays behind
    "$scratch/$1/bin/pip" uninstall -y brdffit
    [ -z "$(find "$scratch/$1" -name '*brdffit*')" ] || fail "left behind: $(find "$scratch/$1" -name '*brdffit*')"
    if (cd / && "$scratch/$1/bin/python" -c 'import brdffit' 2> /dev/null); then fail "$1 still imports brdffit"; fi
}

copy_tree
install_from_tree
build_archives
without_ecos
editable
rm -rf "$tree" # from here on there is no tree

step "the wheel, without the tree"
environment wheel
"$scratch/wheel/bin/pip" install "$scratch"/wheels/*.whl
try_example wheel "$scratch/wheel/lib"

step "the sdist, without the tree"
environment sdist_only
(cd / && "$scratch/sdist_only/bin/pip" install "$scratch"/sdist/*.tar.gz)
try_example sdist_only "$scratch/sdist_only/lib"
# The same numbers; the first line and the last hold paths.
for name in wheel sdist_only; do sed '1d;$d' "$scratch/$name.txt" > "$scratch/$name.fit"; done
cmp "$scratch/wheel.fit" "$scratch/sdist_only.fit" || fail "wheel and sdist print different fits"

step "removal"
for name in install noecos wheel sdist_only; do remove $name; done
echo "package.sh: everything passed"
