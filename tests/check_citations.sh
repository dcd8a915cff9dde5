#!/bin/sh
# What comments cite exists: sections of docs/theory.md, and files (citations.py says which). First the check itself is
# tried on a small tree with known errors: one that finds nothing proves nothing. Environment: PYTHON.
# SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."

PYTHON=${PYTHON:-python3}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

mkdir -p "$scratch/docs" "$scratch/src/deep" "$scratch/tools"
printf '# Theory\n\n## 1 One\n\n### 1.2 Two\n\n## 3 Three\n' > "$scratch/docs/theory.md"
cat > "$scratch/src/deep/right_part.c" << 'END'
/* theory 1.2, theory section 3, theory, sections 1 and 3, theory
 * section 1's table; right_part.c, docs/theory.md, math.h, right_*.c, _part.c; (n.h)(v.h), x.c */
const char *text = "/* theory 9 of nowhere.c"; // theory 1
END
cat > "$scratch/src/wrong.h" << 'END'
/* theory 1.2 and 1.3; theory
 * section 4: gone.c */
END
echo '# theory, section 2' > "$scratch/tools/wrong.py"
cat > "$scratch/expected" << 'END'
src/deep/right_part.c:3: theory 9 is no section of docs/theory.md
src/wrong.h:1: theory 1.3 is no section of docs/theory.md
src/wrong.h:2: gone.c is no file of the tree
src/wrong.h:2: theory 4 is no section of docs/theory.md
tools/wrong.py:1: theory 2 is no section of docs/theory.md
END
if "$PYTHON" tests/citations.py "$scratch" > /dev/null 2> "$scratch/found"; then
    echo "citations.py found nothing wrong in a tree with five errors" >&2
    exit 1
fi
LC_ALL=C sort "$scratch/found" | diff "$scratch/expected" - >&2

"$PYTHON" tests/citations.py
