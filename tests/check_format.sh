#!/bin/sh
# C is as clang-format writes it (.clang-format), Python passes ruff (ruff.toml): both as tests/requirements.txt pins
# them, for other versions judge otherwise. They live in the tests' environment, which make check makes first. Without
# it nothing is checked, and that is said; with it a tool that does not run is a failure. To mend what is found:
#
#   build/venv/bin/clang-format -i FILE     build/venv/bin/ruff check --fix FILE
#
# Environment: VENV. SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

venv=${VENV:-build/venv}

# The copy is what tools/setup/venv.sh leaves when all went well.
if ! cmp -s tests/requirements.txt "$venv/requirements.txt"; then
    echo "format: NOT CHECKED: $venv is not there, or not of today's tests/requirements.txt ('make venv' makes it)"
    exit 0
fi

failed=0
list=$(mktemp)
trap 'rm -f "$list"' EXIT
find src include tools tests -name '*.[ch]' | sort > "$list"
xargs "$venv/bin/clang-format" --dry-run --Werror < "$list" || failed=1
"$venv/bin/ruff" check --quiet --no-cache --output-format=concise tools tests docs python || failed=1
[ $failed = 0 ] || exit 1
echo "format: $(wc -l < "$list") files of C as clang-format writes them, Python as ruff wants it"
