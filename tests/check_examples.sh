#!/bin/sh
# The examples compile without a warning, run, and find what is in their data. Environment: BRDFFIT_BUILD, MAKE, ECOS.
# SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

MAKE=${MAKE:-make}
build=${BRDFFIT_BUILD:-build}
output=$(mktemp)
trap 'rm -f "$output" "$output.o"' EXIT
$MAKE --no-print-directory -s BUILD="$build" examples > /dev/null
# Once more as they were compiled, to see that nothing is said: WERROR=1 would build all else anew, too.
for example in examples/*.c; do
    sh -c "$(cat "$build/obj/compile.flags") -Werror -MF /dev/null -c $example -o $output.o"
done

says() { # example, what it prints
    "$build/examples/$1" > "$output" || {
        echo "examples/$1 fails" >&2
        cat "$output" >&2
        exit 1
    }
    grep -q "$2" "$output" || {
        echo "examples/$1 does not print '$2':" >&2
        cat "$output" >&2
        exit 1
    }
}

says first_fit '^sigma 0.17[0-9]*, diffuse 0.2[45].*, specular 0.0[34]' # made with 0.18, 0.25, 0.04 and 1 % noise
says workspace '^sigma .*: relative_gap after'
says map '^3072 of 3072 texels certified; sigma from 0.100 to 0.494$'
says shade '^sigma 0.3000; albedo 0.5[0-9]* by 4096 draws, 0.5[0-9]* by the table$'
says stream '^100000 samples: sigma 0.1000 and 0.4000, .* (relative_gap)$'
if [ "${ECOS:-1}" = 0 ]; then
    says proof '^verified: '
else
    says proof '^verified: proven again'
fi
set -- examples/*.c
[ $# = 6 ] || {
    echo "an example without a line in $0" >&2
    exit 1
}
echo "examples: $# programs compile, run and find what their data were made of"
