#!/bin/sh
# Prints 1 when C++ programs with Ceres can be built, else 0; says on standard error what is missing.
#
#   ceres.sh [install]
#
# With "install" it first tries apt-get, as root or through a sudo that asks nothing. Only the benchmark of local
# solvers (tools/bench/peers.mk) wants it. Environment: CXX. SPDX-License-Identifier: MIT
set -eu

CXX=${CXX:-c++}

found() {
    # CXX may hold options.
    # shellcheck disable=SC2086
    echo '#include <ceres/version.h>' | $CXX -E -x c++ -o /dev/null - > /dev/null 2>&1
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@" 2> /dev/null; fi
}

if ! found && [ "${1:-}" = install ] && command -v apt-get > /dev/null 2>&1; then
    echo 'Installing: g++ libceres-dev (for the benchmark of local solvers)' >&2
    as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq > /dev/null 2>&1 || :
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends g++ libceres-dev \
        > /dev/null 2>&1 || :
fi
if found; then
    echo 1
else
    echo 'brdffit: no C++ compiler with Ceres here (Debian: apt-get install g++ libceres-dev): going on without it' >&2
    echo 0
fi
