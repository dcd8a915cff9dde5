# Fetch a source distribution of PyPI, check its hash, unpack it. Sourced by fetch_*.sh with set -eu and these set:
#
#   PACKAGE VERSION SHA256   the source distribution PACKAGE-VERSION.tar.gz
#   NAME                     DIR/NAME is what the caller makes; with DIR/NAME/.verified there is nothing to do
#   TITLE                    said before a download
#   WITHOUT                  said after a failed one: what to do without a network
#
# sdist_open DIR leaves it unpacked in $unpacked; sdist_install SOURCE makes it DIR/NAME, whole or not at all.
# pip insists on running the package's build backend for the metadata; a backend of a few lines stands in for it, so
# nothing of the package is executed, before or after its hash is checked. SPDX-License-Identifier: MIT
PYTHON=${PYTHON:-python3}

sdist_digest() {
    "$PYTHON" -c 'import hashlib, sys; print(hashlib.sha256(open(sys.argv[1], "rb").read()).hexdigest())' "$1"
}

sdist_download() {
    mkdir -p "$scratch/backend/setuptools" "$scratch/download"
    : > "$scratch/backend/setuptools/__init__.py"
    cat > "$scratch/backend/setuptools/build_meta.py" << END
"""Stands in for setuptools: answers pip's question for metadata, builds nothing."""
import os


class Backend:
    def prepare_metadata_for_build_wheel(self, directory, config_settings=None):
        name = "$PACKAGE-$VERSION.dist-info"
        os.mkdir(os.path.join(directory, name))
        with open(os.path.join(directory, name, "METADATA"), "w") as out:
            out.write("Metadata-Version: 2.1\\nName: $PACKAGE\\nVersion: $VERSION\\n")
        return name


__legacy__ = Backend()
prepare_metadata_for_build_wheel = __legacy__.prepare_metadata_for_build_wheel
END
    echo "$PACKAGE==$VERSION --hash=sha256:$SHA256" > "$scratch/requirements.txt"
    PYTHONPATH="$scratch/backend" PIP_DISABLE_PIP_VERSION_CHECK=1 "$PYTHON" -m pip download --quiet --no-deps \
        --no-binary "$PACKAGE" --no-build-isolation --require-hashes --dest "$scratch/download" \
        --requirement "$scratch/requirements.txt" > "$scratch/log" 2>&1
}

sdist_open() { # DIR
    mkdir -p "$1"
    directory=$(cd "$1" && pwd) # absolute: pip looks at it from elsewhere
    archive=$directory/$PACKAGE-$VERSION.tar.gz
    [ ! -e "$directory/$NAME/.verified" ] || exit 0
    scratch=$(mktemp -d "$directory/fetch.XXXXXX")
    trap 'rm -rf "$scratch"' EXIT
    trap 'exit 1' HUP INT TERM
    if [ ! -e "$archive" ]; then
        echo "Fetching $TITLE"
        if ! sdist_download; then
            {
                sed 's/^/    /' "$scratch/log"
                echo "brdffit: pip could not download $PACKAGE $VERSION (its words are above). Without a network, put"
                echo "$PACKAGE-$VERSION.tar.gz into $directory/$WITHOUT."
            } >&2
            exit 1
        fi
        mv "$scratch/download/$PACKAGE-$VERSION.tar.gz" "$archive"
    fi
    if [ "$(sdist_digest "$archive")" != "$SHA256" ]; then
        echo "brdffit: $archive is not the file that was published: its SHA-256 is" >&2
        echo "$(sdist_digest "$archive"), not $SHA256. Remove it." >&2
        exit 1
    fi
    tar -xzf "$archive" -C "$scratch"
    unpacked=$scratch/$PACKAGE-$VERSION
}

sdist_install() { # SOURCE
    touch "$1/.verified"
    rm -rf "${directory:?}/$NAME"
    mv "$1" "$directory/$NAME"
}
