#!/bin/sh
# Install into an empty directory, build programs against it with nothing but what the .pc files say (static
# and shared, C and C++), run them, uninstall: nothing is left. Environment: BRDFFIT_BUILD, MAKE, CC.
# SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

MAKE=${MAKE:-make}
CC=${CC:-cc}
build=${BRDFFIT_BUILD:-build}
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
prefix=/opt/brdffit
root=$stage/root$prefix

$MAKE --no-print-directory -s BUILD="$build" install DESTDIR="$stage/root" PREFIX=$prefix > /dev/null

cat > "$stage/consumer.c" << 'END'
#include <brdffit_io.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

int main(void)
{
    char csv[4096] = "a,b,c,v\n";
    brdffit_table *table;
    const brdffit_result *result;
    brdffit_error error;
    int i;

    for (i = 0; i < 40; i++) { /* one lobe: x = 0.2, y = 0.5, sigma = 0.25 */
        double a = 0.3 - 0.002 * i, b = 0.3 + 0.001 * i, c = 0.0004 * i * i;
        sprintf(csv + strlen(csv), "%.17g,%.17g,%.17g,%.17g\n", a, b, c, 0.2 * a + 0.5 * b * 16.0 * exp(-16.0 * c));
    }
    if (brdffit_io_read_memory(csv, strlen(csv), NULL, &table, &error) ||
        brdffit_fit_new(table->samples, NULL, &result, &error)) {
        printf("%s: %s\n", brdffit_status_string(error.status), error.message);
        return 1;
    }
    printf("%s sigma %.9f certified %d\n", brdffit_version(), result->model->sigma[0], result->certified);
    i = !(fabs(result->model->sigma[0] - 0.25) < 1e-9 && result->certified &&
          strcmp(brdffit_version(), BRDFFIT_VERSION_STRING) == 0);
    brdffit_result_free(result);
    brdffit_io_free(table);
    return i;
}
END
cat > "$stage/headers.cc" << 'END'
#include <brdffit.h>
#include <brdffit_io.h>
#include <brdffit_shade.h>
int main() { return brdffit_version()[0] == 0 || brdffit_io_drop_string(BRDFFIT_IO_DROP_MASKED)[0] == 0; }
END

field() { # file, field: its value with the variables put in
    sed -n "s/^$2: *//p" "$root/lib/pkgconfig/$1.pc" | sed -e "s|\${libdir}|$root/lib|g" -e "s|\${includedir}|$root/include|g"
}

for name in brdffit brdffit_io; do
    grep -qx "Version: $(sed -n 's/.*VERSION_STRING "\(.*\)"/\1/p' include/brdffit.h)" "$root/lib/pkgconfig/$name.pc"
    grep -qx "prefix=$prefix" "$root/lib/pkgconfig/$name.pc"
done
flags=$(field brdffit_io Cflags)
shared="$(field brdffit_io Libs) $(field brdffit Libs)"
private="-lz $(field brdffit_io Libs.private) $(field brdffit Libs.private)" # -lz: Requires.private: zlib

# Splitting is wanted below. The consumer itself uses libm.
# shellcheck disable=SC2086
$CC ${CFLAGS:-} -o "$stage/shared" "$stage/consumer.c" $flags $shared -lm
LD_LIBRARY_PATH=$root/lib "$stage/shared"
# shellcheck disable=SC2086
$CC ${CFLAGS:-} -o "$stage/static" "$stage/consumer.c" $flags -L"$root/lib" -Wl,-Bstatic -lbrdffit_io -lbrdffit -Wl,-Bdynamic $private
"$stage/static"
# A program that only has the run-time names (libbrdffit.so.1) still starts.
rm "$root"/lib/libbrdffit.so "$root"/lib/libbrdffit_io.so
LD_LIBRARY_PATH=$root/lib "$stage/shared" > /dev/null
CXX=${CXX:-c++}
if command -v "$CXX" > /dev/null 2>&1; then
    # shellcheck disable=SC2086
    $CXX -std=c++11 -Wall -Wextra -Wpedantic -Werror -o "$stage/headers" "$stage/headers.cc" $flags \
        "$root"/lib/libbrdffit_io.a "$root"/lib/libbrdffit.a $private
    "$stage/headers"
else
    echo "install: no C++ compiler here, headers not tried in C++"
fi
if [ -e "$build/brdffit" ]; then
    "$root/bin/brdffit" --version > /dev/null
fi

$MAKE --no-print-directory -s BUILD="$build" uninstall DESTDIR="$stage/root" PREFIX=$prefix > /dev/null
left=$(find "$stage/root" ! -type d)
if [ -n "$left" ]; then
    echo "make uninstall left behind: $left" >&2
    exit 1
fi
echo "install: shared and static consumers ran; uninstall left nothing"
