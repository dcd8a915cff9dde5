#!/bin/sh
# Prints 1 when C programs can be linked with NLopt as its C++ build has it (StoGO is in that one alone), else 0; says on
# standard error what is missing.
#
#   nlopt.sh [install]
#
# With "install" it first tries apt-get, as root or through a sudo that asks nothing. Only `make bench` wants it.
# Environment: CC. SPDX-License-Identifier: MIT
set -eu

CC=${CC:-cc}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
printf '#include <nlopt.h>\nint main(void) { return nlopt_create(NLOPT_GD_STOGO, 1) == 0; }\n' > "$scratch/try.c"

found() {
    # CC may hold options.
    # shellcheck disable=SC2086
    $CC -o "$scratch/try" "$scratch/try.c" -lnlopt_cxx > /dev/null 2>&1
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@" 2> /dev/null; fi
}

if ! found && [ "${1:-}" = install ] && command -v apt-get > /dev/null 2>&1; then
    echo 'Installing: libnlopt-cxx-dev (for the benchmark of global optimisers)' >&2
    as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq > /dev/null 2>&1 || :
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends libnlopt-cxx-dev \
        libnlopt-dev > /dev/null 2>&1 || :
fi
if found; then
    echo 1
else
    echo 'brdffit: no NLopt with StoGO here (Debian: apt-get install libnlopt-cxx-dev): going on without NLopt' >&2
    echo 0
fi
