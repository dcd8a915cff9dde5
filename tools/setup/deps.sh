#!/bin/sh
# What the build, the tests and the download of ECOS need from the system.
#
#   deps.sh check   compiler|cli|ecos|build|test|browser ...   look; say what is missing, how to get it, and fail
#   deps.sh install compiler|cli|ecos|build|test|browser ...   the same, but install it first where that is possible:
#                                                     apt-get, as root or through a sudo that asks nothing
#
# Everything is found by trying it (a header by compiling and linking), never by asking a package
# manager, so that other systems and hand-made installations count. Environment: CC, PYTHON.
# SPDX-License-Identifier: MIT
set -eu

CC=${CC:-cc}
PYTHON=${PYTHON:-python3}
mode=$1
shift
groups=$*

links() { # header, libraries: does a program with them link?
    scratch=$(mktemp -d)
    {
        printf '#include <%s>\n' stdarg.h stddef.h stdint.h setjmp.h "$1" # cmocka.h wants the first four
        echo 'int main(void) { return 0; }'
    } > "$scratch/try.c"
    # CC may hold options, and CPPFLAGS and LDFLAGS always do: splitting is wanted.
    # shellcheck disable=SC2086
    if $CC ${CPPFLAGS:-} ${LDFLAGS:-} -o "$scratch/try" "$scratch/try.c" $2 > /dev/null 2>&1; then found=0; else found=1; fi
    rm -rf "$scratch"
    return $found
}

browses() { # the names that python/tests/browser.py tries
    for program in chromium chromium-browser google-chrome; do
        ! "$program" --version > /dev/null 2>&1 || return 0
    done
    return 1
}

compiles() {
    if ! command -v "${CC%% *}" > /dev/null 2>&1; then
        need "a C compiler ($CC)" "gcc libc6-dev zlib1g-dev"
    elif ! links stdio.h ''; then
        need "the C library's headers (<stdio.h>)" "libc6-dev"
    fi
}

missing= # what, for people
packages= # Debian's names

need() { # what is missing, its Debian packages
    missing="$missing
  - $1"
    packages="$packages $2"
}

look() {
    missing=
    packages=
    for group in "$@"; do
        case $group in
        compiler)
            compiles
            ;;
        build)
            compiles
            links zlib.h -lz || need "zlib with headers (<zlib.h>)" zlib1g-dev
            ;;
        cli)
            links cjson/cJSON.h -lcjson || need "cJSON with headers (<cjson/cJSON.h>)" libcjson-dev
            links png.h '-lpng -lz -lm' || need "libpng with headers (<png.h>)" libpng-dev
            ;;
        ecos)
            "$PYTHON" -m pip --version > /dev/null 2>&1 ||
                need "Python 3 with pip, which downloads ECOS (or build with ECOS_DIR=path or ECOS=0)" "python3 python3-pip"
            ;;
        test)
            links cmocka.h -lcmocka || need "cmocka with headers (<cmocka.h>)" libcmocka-dev
            "$PYTHON" -c 'import venv, ensurepip' > /dev/null 2>&1 ||
                need "Python 3's modules venv and ensurepip" "python3 python3-venv"
            ;;
        browser)
            # Some letters are needed as well: a browser without a font measures every text as nothing.
            browses || need "Chromium, headless, for the test of the report's pages" "chromium fonts-dejavu-core"
            ;;
        *)
            echo "deps.sh: unknown group '$group'" >&2
            exit 2
            ;;
        esac
    done
}

complain() {
    {
        echo "brdffit: missing on this system:$missing"
        echo "On Debian or Ubuntu: apt-get install$packages"
        [ "$mode" = install ] || echo "or let 'make deps DEPS=\"$groups\"' do that, as root or with sudo."
    } >&2
    exit 1
}

as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    else
        sudo -n "$@"
    fi
}

look "$@"
[ -n "$missing" ] || exit 0
[ "$mode" = install ] || complain
command -v apt-get > /dev/null 2>&1 || complain
if [ "$(id -u)" != 0 ]; then
    command -v sudo > /dev/null 2>&1 && sudo -n true > /dev/null 2>&1 || complain
fi

echo "Installing:$packages"
# An update may fail for a foreign repository and still serve: what counts is the installation.
as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq ||
    echo "apt-get update reported an error; going on" >&2
# shellcheck disable=SC2086
as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $packages > /dev/null || complain
look "$@"
[ -z "$missing" ] || complain
