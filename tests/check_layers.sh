#!/bin/sh
# Includes point down. Every file of src/ states its layer in its first comment ("Layer 2."), which must be
# the one of the table below, and includes only files of its own layer or lower ones, without a cycle.
# src/io and the tools (but the benchmarks) see public headers and their own; only socp.c sees ECOS; the core includes nothing
# that allocates, prints or reads clocks. SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

layer_of() { # file name without directory
    case ${1%.[ch]} in
    status | tolerance | vector | kernel_* | lanes | isa | arena | environment) echo 0 ;;
    kernels | kernels_* | gain | strip | strip_*) echo 1 ;;
    nnls | nnls_* | vertex | vertex_* | heap | axis | certificate | scaling) echo 1 ;;
    family | family_* | geometry | geometry_* | reduce | reduce_* | sums | sums_* | moments | moments_* | residual | residual_* | socp | lp | lp_*)
        echo 2
        ;;
    bound | bound_* | restricted | restricted_* | interval | interval_* | varpro | varpro_* | newton | moment_descend | refine | refine_*) echo 3 ;;
    search | search_*) echo 4 ;;
    fit | fit_* | many | many_* | options | report | report_* | eval | eval_* | observe | reprove | entry) echo 5 ;;
    *) echo none ;;
    esac
}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
: > "$scratch/problems"

problem() {
    echo "$1" >> "$scratch/problems"
}

includes() { # file: what it includes, quotes and brackets off
    sed -n 's/^[[:space:]]*#[[:space:]]*include[[:space:]]*["<]\([^">]*\)[">].*/\1/p' "$1"
}

check_core() { # file
    name=${1#src/}
    layer=$(layer_of "$name")
    stated=$(sed -n 's/^.*Layer \([0-9]\).*$/\1/p' "$1" | head -n 1)
    if [ "$layer" = none ]; then
        problem "$1: not in the table of tests/check_layers.sh; say which layer it is"
        return
    fi
    [ "$stated" = "$layer" ] || problem "$1: says layer '${stated:-nothing}', the table says $layer"
    for header in $(includes "$1"); do
        if [ -e "src/$header" ]; then
            [ "$(layer_of "$header")" -le "$layer" ] 2> /dev/null || problem "$1 (layer $layer) includes $header above it"
            # Files that share their first word (reduce, reduce_rows) are one module.
            from=${name%.[ch]} to=${header%.h}
            [ "${from%%_*}" = "${to%%_*}" ] || echo "${from%%_*} ${to%%_*}" >> "$scratch/edges"
            continue
        fi
        case $name:$header in
        socp.c:ecos.h | fit_alloc.c:stdlib.h | socp.c:stdlib.h) ;;
        lanes.h:immintrin.h) ;;
        environment.h:fenv.h | socp.c:ecos.h | fit_alloc.c:stdlib.h | socp.c:stdlib.h) ;;
        *:brdffit.h | *:float.h | *:limits.h | *:math.h | *:stddef.h | *:stdint.h | *:string.h | *:stdalign.h) ;;
        *) problem "$1 includes $header: the core may not" ;;
        esac
    done
}

check_room() { # file, header it may include besides its own and the C library's
    case $1 in
    tools/bench/*) return 0 ;; # benchmarks measure other rooms from inside
    esac
    for header in $(includes "$1"); do
        case $header in
        brdffit.h | brdffit_io.h) continue ;;
        environment.h) [ "$(dirname "$1")" != src/io ] || continue ;; # the core's, compiled into both libraries
        ecos.h) problem "$1 includes ecos.h: only src/socp.c may" ;;
        */../* | ../*) problem "$1 includes $header: name no other room's files" ;;
        esac
        [ ! -e "src/$header" ] || [ -e "$(dirname "$1")/$header" ] || problem "$1 includes the core's private $header"
    done
}

: > "$scratch/edges"
for file in src/*.[ch]; do
    check_core "$file"
done
for file in src/io/*.[ch] tools/*/*.[ch]; do
    [ ! -e "$file" ] || check_room "$file"
done
if ! tsort "$scratch/edges" > /dev/null 2> "$scratch/loop"; then
    problem "modules that include each other: $(tr '\n' ' ' < "$scratch/loop")"
fi
if [ -s "$scratch/problems" ]; then
    cat "$scratch/problems" >&2
    exit 1
fi
echo "layers: $(ls src/*.[ch] src/io/*.[ch] 2> /dev/null | wc -l) files of src point down"
