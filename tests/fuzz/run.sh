#!/bin/sh
# Run every fuzz target for some seconds, one after the other, and say how many inputs each had.
#
#   run.sh TREE SECONDS libfuzzer|own
#
# SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/../.."

tree=$1
seconds=$2
kind=$3
failed=
total=0
mkdir -p "$tree/findings"
for program in "$tree"/tests/fuzz/fuzz_*; do
    case ${program##*/} in *.*) continue ;; esac
    name=${program##*/fuzz_}
    corpus=$tree/corpus/$name
    mkdir -p "$corpus"
    if [ "$kind" = libfuzzer ]; then
        # Messages of the parsers are not of interest (2: standard error closed to the target).
        "$program" -max_total_time="$seconds" -close_fd_mask=2 -max_len=65536 -rss_limit_mb=4096 -print_final_stats=1 \
            -artifact_prefix="$tree/findings/$name-" "$corpus" "tests/fuzz/corpus/$name" > "$tree/$name.out" 2>&1 && code=0 || code=$?
        count=$(sed -n 's/^stat::number_of_executed_units: *//p' "$tree/$name.out")
    else
        "$program" -t "$seconds" -w "$corpus" -f "$tree/findings/$name-" "tests/fuzz/corpus/$name" > "$tree/$name.out" 2> "$tree/$name.err" &&
            code=0 || code=$?
        count=$(sed -n 's/^\([0-9]*\) inputs.*/\1/p' "$tree/$name.out")
    fi
    total=$((total + ${count:-0}))
    if [ "$code" = 0 ]; then
        printf '  %-8s %12s inputs, no fault\n' "$name" "${count:-0}"
    else
        failed="$failed $name"
        printf '  %-8s FAILED (%s): %s\n' "$name" "$code" "$tree/$name.out, $tree/findings/$name-*"
    fi
done
echo "fuzz: $total inputs${failed:+; FAILED:$failed}"
[ -z "$failed" ]
