#!/bin/sh
# A virtual environment with exactly the packages of a requirements file, hashes checked.
#
#   venv.sh DIR REQUIREMENTS
#
# Does nothing when DIR already holds them. Environment: PYTHON. SPDX-License-Identifier: MIT
set -eu

PYTHON=${PYTHON:-python3}
directory=$1
requirements=$2
installed=$directory/requirements.txt # written last: its presence says that all went well

if cmp -s "$requirements" "$installed" && "$directory/bin/python" -c '' > /dev/null 2>&1; then
    exit 0
fi
echo "Making the Python environment of $requirements in $directory"
rm -rf "$directory"
"$PYTHON" -m venv "$directory"
if ! "$directory/bin/python" -m pip install --quiet --disable-pip-version-check --require-hashes -r "$requirements"; then
    echo "brdffit: pip could not install the packages of $requirements; its words are above." >&2
    exit 1
fi
cp "$requirements" "$installed"
