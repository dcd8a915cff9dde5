#!/bin/sh
# make demo: a synthetic instrument measures three materials; fit them and show the proof beside the numbers.
#
#   demo.sh BUILD
#
# SPDX-License-Identifier: MIT
set -eu

build=$1
data=$build/demo

run() { # show a command, then run it
    printf '\n$ %s\n' "$*"
    "$@"
}

run "$build/goniometer" "$data"
run "$build/brdffit" info "$data/two_lobe_satin.csv"
for lobes in 1 2; do
    run "$build/brdffit" fit --lobes $lobes "$data/two_lobe_satin.csv"
done
run "$build/brdffit" fit --lobes 2 "$data/ggx_metal.csv" "$data/matte.csv" "$data/two_lobe_table.binary"
printf '\nYours: %s fit --lobes 2 FILE...  (CSV, TSV or MERL .binary, also .gz; %s fit --help)\n' "$build/brdffit" "$build/brdffit"
