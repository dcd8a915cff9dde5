#!/bin/sh
# Run one kind of tests to the end, whatever fails, then say how many passed; fail if any did not.
#
#   run_tests.sh programs PROGRAM...     C tests: cmocka prints each one's summary
#   run_tests.sh scripts SCRIPT...
#   run_tests.sh python VENV BUILD PATH...
#
# SPDX-License-Identifier: MIT
set -u

kind=$1
shift

processors() {
    getconf _NPROCESSORS_ONLN 2> /dev/null || echo 1
}

# Programs known to run long come first, so that none of them is left over at the end for one processor.
longest_first() { # programs
    for name in $(sed '/^#/d' tests/longest.txt); do
        for program in "$@"; do
            [ "${program##*/}" != "$name" ] || echo "$program"
        done
    done
    for program in "$@"; do
        grep -qx "${program##*/}" tests/longest.txt || echo "$program"
    done
}

# Run programs, as many at a time as there are processors; NAME.out and NAME.code of each in the scratch folder.
run_together() { # programs
    longest_first "$@" | xargs -P "$(processors)" -I '{}' sh -c \
        'name=$2/${1##*/}; "$1" > "$name.out" 2>&1; echo $? > "$name.code"' run '{}' "$scratch"
}

run_one() { # test: what it prints, and its exit code
    if [ "$kind" = scripts ]; then
        sh "$1"
        return $?
    fi
    cat "$scratch/${1##*/}.out"
    return "$(cat "$scratch/${1##*/}.code" 2> /dev/null || echo 99)"
}

run_each() { # tests
    passed=0
    failed=0
    broken=
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
    [ "$kind" = scripts ] || run_together "$@"
    for test in "$@"; do
        echo "== $test"
        run_one "$test"
        code=$?
        if [ $code = 0 ]; then
            passed=$((passed + 1))
        else
            failed=$((failed + 1))
            broken="$broken $test"
            echo "FAILED ($code): $test" >&2
        fi
    done
    [ $failed = 0 ] || echo "Failed:$broken" >&2
    echo "$kind: $passed passed, $failed failed"
    [ $failed = 0 ]
}

run_python() { # venv, build, paths
    environment=$1
    tree=$2
    shift 2
    # Nothing is written outside the build tree.
    [ $# -gt 0 ] && [ -n "$(find "$@" -name 'test_*.py' | head -n 1)" ] || {
        echo 'No Python tests here.'
        return 0
    }
    # As many files at a time as there are processors; a file's tests stay together, for the fixtures that they share.
    PYTHONPYCACHEPREFIX=$tree/pycache "$environment/bin/python" -m pytest -q -ra -o cache_dir="$tree/pytest_cache" \
        -n "$(processors)" --dist loadfile "$@"
}

case $kind in
programs | scripts) run_each "$@" ;;
python) run_python "$@" ;;
*)
    echo "run_tests.sh: unknown kind '$kind'" >&2
    exit 2
    ;;
esac
