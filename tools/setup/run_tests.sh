#!/bin/sh
# Run tests, as many at a time as there are processors, to the end, whatever fails; then print what each of them printed,
# kind by kind, and how many passed. Fails if any did.
#
#   run_tests.sh UNIT...       a unit is KIND:PATH and keeps one processor busy:
#
#   programs:PROGRAM           C tests, each in the folder tests of its build tree: cmocka prints a summary
#   sanitized:PROGRAM          the same under AddressSanitizer and UBSan
#   scripts:SCRIPT
#   python:TREE:PATHS          pytest with the programs of a build tree; PATHS may be a pattern, or words
#   sanitized-python:TREE:PATHS
#   docs:TREE                  the documentation
#
# Units of longest.txt start first, in its order, so that none is left over at the end for one processor. stderr tells
# what has run for seconds. Environment: VENV, DOCS_VENV, BRDFFIT_DATA, what scripts take, and BRDFFIT_JOBS: so many
# units at a time. SPDX-License-Identifier: MIT
set -u

processors=${BRDFFIT_JOBS:-$(getconf _NPROCESSORS_ONLN 2> /dev/null || echo 1)}

# A file's tests stay together, for the fixtures that they share. Nothing is written outside the build tree. As many
# files at a time as there are processors to spare: the other units have the first two.
run_pytest() { # tree, paths
    BRDFFIT_BUILD=$(cd "$1" && pwd)
    export BRDFFIT_BUILD
    together=
    [ "$processors" -le 2 ] || together="-n $((processors - 2)) --dist loadfile"
    # Splitting is wanted: $2 may be a pattern.
    # shellcheck disable=SC2086
    PYTHONPYCACHEPREFIX=$1/pycache "$VENV/bin/python" -m pytest -q -ra -o cache_dir="$1/pytest_cache" $together $2
}

run_unit() { # unit: what it prints, and its exit code
    path=${1#*:}
    case $1 in
    programs:* | sanitized:*) "$path" ;;
    scripts:*) BRDFFIT_JOBS=1 sh "$path" ;;
    python:* | sanitized-python:*) run_pytest "${path%%:*}" "${path#*:}" ;;
    docs:*) "$DOCS_VENV/bin/python" docs/build.py "$path" ;;
    esac
}

if [ "$1" = --unit ]; then # what xargs calls: the scratch folder, a number and a unit
    began=$(date +%s)
    run_unit "${3#* }" > "$2/${3%% *}.out" 2>&1
    code=$?
    echo $code > "$2/${3%% *}.code"
    took=$(($(date +%s) - began))
    [ $took -lt 5 ] || echo "  done   ${3#* } in $took s" >&2
    [ $code = 0 ] || echo "  FAILED ${3#* } ($code)" >&2
    exit 0
fi

# Numbered as given, in the order in which they start. A line of longest.txt is a unit without its folders or its tree.
longest_first() { # units
    printf '%s\n' "$@" | awk '
        NR == FNR { if (!/^#/) { rank[$0] = NR } next }
        { key = $0; sub(/^[a-z-]*:/, "", key); kind = substr($0, 1, length($0) - length(key)); docs = kind == "docs:"
          if (kind ~ /python/) { sub(/^[^:]*:/, "", key) } else { sub(/^.*\//, "", key) }
          key = docs ? kind : kind key
          print ((key in rank) ? rank[key] : 1000) " " FNR " " $0 }' tests/longest.txt - | sort -s -n -k 1,1 | cut -d ' ' -f 2-
}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
longest_first "$@" | tr '\n' '\0' | xargs -0 -P "$processors" -n 1 sh "$0" --unit "$scratch"

summary=
broken=
for kind in programs sanitized scripts python sanitized-python docs; do
    number=0
    passed=0
    failed=0
    for unit in "$@"; do
        number=$((number + 1))
        [ "${unit%%:*}" = "$kind" ] || continue
        echo "== ${unit#*:}"
        cat "$scratch/$number.out"
        if [ "$(cat "$scratch/$number.code" 2> /dev/null)" = 0 ]; then
            passed=$((passed + 1))
        else
            failed=$((failed + 1))
            broken="$broken $unit"
        fi
    done
    [ $((passed + failed)) = 0 ] || summary="$summary$kind: $passed passed, $failed failed
"
done
printf '%s' "$summary"
[ -z "$broken" ] || {
    echo "Failed:$broken" >&2
    exit 1
}
