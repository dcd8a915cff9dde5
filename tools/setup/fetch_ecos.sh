#!/bin/sh
# Fetch the source of ECOS into DIR/ecos-2.0.14, unpacked and with its hash checked.
#
#   fetch_ecos.sh DIR
#
# The C sources are taken from the source distribution of the Python package. pip insists on running
# its build backend for the metadata, which would need NumPy; a backend of a few lines stands in for
# it, so nothing of the package is executed, before or after its hash is checked.
# Without a network: put ecos-2.0.14.tar.gz into DIR, or build with ECOS_DIR=path or ECOS=0.
# Environment: PYTHON. SPDX-License-Identifier: MIT
set -eu

VERSION=2.0.14
SHA256=64b3201c0e0a7f0129050557c4ac50b00031e80a10534506dba1200c8dc1efe4
PYTHON=${PYTHON:-python3}
mkdir -p "$1"
directory=$(cd "$1" && pwd) # absolute: pip looks at it from elsewhere
name=ecos-$VERSION
archive=$directory/$name.tar.gz

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
        name = "ecos-$VERSION.dist-info"
        os.mkdir(os.path.join(directory, name))
        with open(os.path.join(directory, name, "METADATA"), "w") as out:
            out.write("Metadata-Version: 2.1\\nName: ecos\\nVersion: $VERSION\\n")
        return name


__legacy__ = Backend()
prepare_metadata_for_build_wheel = __legacy__.prepare_metadata_for_build_wheel
END
    echo "ecos==$VERSION --hash=sha256:$SHA256" > "$scratch/requirements.txt"
    PYTHONPATH="$scratch/backend" PIP_DISABLE_PIP_VERSION_CHECK=1 "$PYTHON" -m pip download --quiet --no-deps \
        --no-binary ecos --no-build-isolation --require-hashes --dest "$scratch/download" \
        --requirement "$scratch/requirements.txt" > "$scratch/log" 2>&1
}

if [ ! -e "$archive" ]; then
    echo "Fetching $name (GPL-3.0; 'make ECOS=0' builds without it)"
    if ! download; then
        {
            sed 's/^/    /' "$scratch/log"
            echo "brdffit: pip could not download $name (its words are above). Without a network, put"
            echo "$name.tar.gz into $directory/, or build with ECOS_DIR=path-of-its-source or ECOS=0."
        } >&2
        exit 1
    fi
    mv "$scratch/download/$name.tar.gz" "$archive"
fi
if [ "$(digest "$archive")" != "$SHA256" ]; then
    echo "brdffit: $archive is not the file that was published: its SHA-256 is" >&2
    echo "$(digest "$archive"), not $SHA256. Remove it." >&2
    exit 1
fi
tar -xzf "$archive" -C "$scratch"
touch "$scratch/$name/.verified"
rm -rf "${directory:?}/$name"
mv "$scratch/$name" "$directory/$name" # whole or not at all
