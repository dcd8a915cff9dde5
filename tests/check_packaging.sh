#!/bin/sh
# CMake and Meson: built, installed, found by find_package and pkg-config, used as subprojects; each program fits. Builds
# the library five times, so only with BRDFFIT_PACKAGING=1. Environment: BRDFFIT_BUILD. SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

[ "${BRDFFIT_PACKAGING:-}" = 1 ] || {
    echo "packaging: skipped; BRDFFIT_PACKAGING=1 builds and uses the library by CMake and Meson"
    exit 0
}
root=$PWD
out=$(cd "${BRDFFIT_BUILD:-build}" && pwd)/packaging
rm -rf "$out"
mkdir -p "$out/user/subprojects"
cp examples/first_fit.c "$out/user/"
tried=

fits() { # how, program
    "$2" | grep -q '^sigma 0.17[0-9]*, diffuse 0.2[45].*' || {
        echo "packaging: $1: the program does not find what its data were made of" >&2
        exit 1
    }
    tried="$tried $1,"
}

if command -v cmake > /dev/null; then
    for shared in OFF ON; do
        cmake -S . -B "$out/cmake$shared" -DBUILD_SHARED_LIBS=$shared -DCMAKE_C_FLAGS_RELWITHDEBINFO=-O1 \
            -DCMAKE_INSTALL_PREFIX="$out/prefix$shared" > "$out/log"
        cmake --build "$out/cmake$shared" -j2 >> "$out/log"
        cmake --install "$out/cmake$shared" >> "$out/log"
        cat > "$out/user/CMakeLists.txt" << 'END'
cmake_minimum_required(VERSION 3.16)
project(user C)
find_package(brdffit 0.2 REQUIRED)
add_executable(user first_fit.c)
target_link_libraries(user brdffit::io brdffit::brdffit m)
END
        cmake -S "$out/user" -B "$out/found$shared" -DCMAKE_PREFIX_PATH="$out/prefix$shared" >> "$out/log"
        cmake --build "$out/found$shared" >> "$out/log"
        fits "find_package ($shared)" "$out/found$shared/user"
    done
    for option in --exists --validate; do PKG_CONFIG_PATH="$out/prefixON/lib/pkgconfig" pkg-config $option brdffit; done
    # shellcheck disable=SC2046
    cc "$out/user/first_fit.c" $(PKG_CONFIG_PATH="$out/prefixON/lib/pkgconfig" pkg-config --cflags --libs brdffit) -lm -o "$out/by_pkgconfig"
    LD_LIBRARY_PATH="$out/prefixON/lib" fits pkg-config "$out/by_pkgconfig"
    cat > "$out/user/CMakeLists.txt" << END
cmake_minimum_required(VERSION 3.16)
project(user C)
set(BRDFFIT_IO OFF CACHE BOOL "")
add_subdirectory($root brdffit)
add_executable(user first_fit.c)
target_link_libraries(user brdffit::brdffit m)
END
    cmake -S "$out/user" -B "$out/within" -DCMAKE_C_FLAGS=-O1 >> "$out/log"
    cmake --build "$out/within" -j2 >> "$out/log"
    fits add_subdirectory "$out/within/user"
fi
if command -v meson > /dev/null; then
    ln -s "$root" "$out/user/subprojects/brdffit"
    cat > "$out/user/meson.build" << 'END'
project('user', 'c')
m = meson.get_compiler('c').find_library('m', required: false)
executable('user', 'first_fit.c', dependencies: [dependency('brdffit', fallback: ['brdffit', 'brdffit_dep']), m])
END
    (cd "$out/user" && meson setup "$out/meson" . --wrap-mode=nofallback --force-fallback-for=brdffit -Dbrdffit:optimization=1) > "$out/log"
    ninja -C "$out/meson" >> "$out/log"
    fits 'Meson subproject' "$out/meson/user"
fi
echo "packaging:${tried%,} fit"
