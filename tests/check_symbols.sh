#!/bin/sh
# What the libraries export and what the core imports, read with nm. Environment: BRDFFIT_BUILD, ECOS.
# SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

build=${BRDFFIT_BUILD:-build}
failed=0

problem() { # title, lines
    [ -z "$2" ] || {
        echo "$1:" >&2
        echo "$2" | sed 's/^/    /' >&2
        failed=1
    }
}


exported() {
    nm -D --defined-only "$1" | awk '{ print $NF }' | sort -u
}

# The shared libraries export what the headers declare: no more, no less.
for pair in libbrdffit:brdffit.h libbrdffit_io:brdffit_io.h; do
    library=$build/${pair%:*}.so
    header=${pair#*:}
    declared=$(grep -v -e '^ \*' -e '^#define' "include/$header" | grep -A 3 'BRDFFIT_API' | grep -o 'brdffit_[a-z0-9_]*(' | tr -d '(' | sort -u)
    problem "$library exports what $header does not declare" \
        "$(exported "$library" | while read -r name; do echo "$declared" | grep -qx "$name" || echo "$name"; done)"
    problem "$library lacks what $header declares" \
        "$(echo "$declared" | while read -r name; do exported "$library" | grep -qx "$name" || echo "$name"; done)"
done

# Static archives define no global name without the prefix: ECOS, AMD and LDL are local to socp.o.
for library in "$build/libbrdffit.a" "$build/libbrdffit_io.a"; do
    problem "$library defines global names without the prefix" \
        "$(nm -g --defined-only "$library" 2> /dev/null | awk 'NF == 3 && $3 !~ /^brdffit_/ { print $3 }' | sort -u)"
done

# The core, but for its allocating modules, needs from outside only memory and string functions and
# those of libm that are exact or correctly rounded everywhere; isa.o asks the compiler's
# runtime which processor this is.
exact='sqrt|fabs|fmin|fmax|floor|ceil|trunc|rint|nearbyint|round|lround|ldexp|scalbn|frexp|ilogb|logb|copysign|fmod'
allowed="^(brdffit_.*|mem(cpy|move|set|cmp)|str(len|cmp|ncmp)|$exact|fegetenv|fesetenv|_GLOBAL_OFFSET_TABLE_|__stack_chk_fail(_local)?|__mem(cpy|move|set)_chk)\$"
problem "the core imports" \
    "$(nm -A -u "$build/libbrdffit.a" 2> /dev/null | grep -v -e '[:/]allocation\.o:' -e '[:/]socp\.o:' -e '[:/]ecos_memory\.o:' -e '[:/]isa\.o:.* __cpu_\(model\|indicator_init\)$' | awk '{ print $1, $NF }' |
        while read -r where name; do echo "$name" | grep -Eqx "$allowed" || echo "$where $name"; done)"

# Nothing anywhere can take over signals or end the process.
problem "a library imports" \
    "$(nm -A -u "$build/libbrdffit.a" "$build/libbrdffit_io.a" 2> /dev/null | awk '$NF ~ /^(signal|sigaction|exit|_exit|abort|setlocale|srand|rand|system)$/ { print $1, $NF }')"

[ $failed = 0 ] && echo "symbols: $(exported "$build/libbrdffit.so" | wc -l) and $(exported "$build/libbrdffit_io.so" | wc -l) exported, all declared"
exit $failed
