#!/bin/sh
# Fetch the source of levmar 2.6 into DIR/levmar-2.6, unpacked and with its hash checked.
#
#   fetch_levmar.sh DIR
#
# For the benchmark of local solvers only (tools/bench/peers.mk): levmar is GPL and is never linked into the library.
# Its C source lies in the source distribution of the Python package levmar 0.2.3. As in fetch_ecos.sh, a backend of a
# few lines answers pip's question for metadata, so nothing of the package is executed.
# Without a network: put levmar-0.2.3.tar.gz into DIR. Environment: PYTHON. SPDX-License-Identifier: MIT
set -eu

VERSION=0.2.3
SHA256=fbdeaac4390e69121d4195bcafc815e7ba92bca06bcced769abeed37a13cd5c0
PYTHON=${PYTHON:-python3}
mkdir -p "$1"
directory=$(cd "$1" && pwd) # absolute: pip looks at it from elsewhere
archive=$directory/levmar-$VERSION.tar.gz
name=levmar-2.6

[ ! -e "$directory/$name/.verified" ] || exit 0

scratch=$(mktemp -d "$directory/fetch.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' HUP INT TERM

digest() {
    "$PYTHON" -c 'import hashlib, sys; print(hashlib.sha256(open(sys.argv[1], "rb").read()).hexdigest())' "$1"
}

download() {
    mkdir -p "$scratch/backend/setuptools" "$scratch/download"
    : > "$scratch/backend/setuptools/__init__.py"
    cat > "$scratch/backend/setuptools/build_meta.py" << END
"""Stands in for setuptools: answers pip's question for metadata, builds nothing."""
import os


class Backend:
    def prepare_metadata_for_build_wheel(self, directory, config_settings=None):
        name = "levmar-$VERSION.dist-info"
        os.mkdir(os.path.join(directory, name))
        with open(os.path.join(directory, name, "METADATA"), "w") as out:
            out.write("Metadata-Version: 2.1\\nName: levmar\\nVersion: $VERSION\\n")
        return name


__legacy__ = Backend()
prepare_metadata_for_build_wheel = __legacy__.prepare_metadata_for_build_wheel
END
    echo "levmar==$VERSION --hash=sha256:$SHA256" > "$scratch/requirements.txt"
    PYTHONPATH="$scratch/backend" PIP_DISABLE_PIP_VERSION_CHECK=1 "$PYTHON" -m pip download --quiet --no-deps \
        --no-binary levmar --no-build-isolation --require-hashes --dest "$scratch/download" \
        --requirement "$scratch/requirements.txt" > "$scratch/log" 2>&1
}

if [ ! -e "$archive" ]; then
    echo "Fetching levmar 2.6 (GPL; for the benchmark of local solvers only)"
    if ! download; then
        {
            sed 's/^/    /' "$scratch/log"
            echo "brdffit: pip could not download levmar $VERSION (its words are above). Without a network, put"
            echo "levmar-$VERSION.tar.gz into $directory/."
        } >&2
        exit 1
    fi
    mv "$scratch/download/levmar-$VERSION.tar.gz" "$archive"
fi
if [ "$(digest "$archive")" != "$SHA256" ]; then
    echo "brdffit: $archive is not the file that was published: its SHA-256 is" >&2
    echo "$(digest "$archive"), not $SHA256. Remove it." >&2
    exit 1
fi
tar -xzf "$archive" -C "$scratch"
source=$scratch/levmar-$VERSION/levmar/$name
# levmar's own option to do without LAPACK is this line of its header (its CMake file writes it).
sed 's|^#define HAVE_LAPACK$|/* #undef HAVE_LAPACK */|' "$source/levmar.h" > "$scratch/levmar.h"
mv "$scratch/levmar.h" "$source/levmar.h"
touch "$source/.verified"
rm -rf "${directory:?}/$name"
mv "$source" "$directory/$name" # whole or not at all
