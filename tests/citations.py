"""What comments cite, and whether it exists: check_citations.sh calls this.

    citations.py [ROOT]

Every "theory N.M", "theory section N" or "theory, sections N and M" in src/, include/, tools/, tests/ and python/ is a numbered
heading of docs/theory.md; every file that a comment of src/ names (.c, .h, .md, .py, .sh, .ipynb) is somewhere in the tree,
whatever folder it is in. "_avx2.c" in a list of files is the end of a name, "kernels_*.c" a pattern. Only the standard library
is needed.
SPDX-License-Identifier: MIT
"""
import fnmatch
import os
import pathlib
import re
import sys

CITING = ("src", "include", "tools", "tests", "python")
TEXT = (".c", ".h", ".py", ".sh", ".md", ".txt", ".cc", ".inc")
# Not ours: the compiler's, the C library's, zlib's and ECOS's.
FOREIGN = {"assert.h", "ecos.h", "errno.h", "fenv.h", "float.h", "glblopts.h", "immintrin.h", "inttypes.h", "limits.h", "math.h",
           "cmocka.h", "setjmp.h", "spla.h", "stdarg.h", "stddef.h", "stdint.h", "stdio.h", "stdlib.h", "string.h", "zlib.h"}
LEFT_OUT = {"build", "__pycache__", "node_modules"}

# Between two words of a comment: blanks, and a new line with what comments begin with.
GAP = r"(?:[ \t]|\n[ \t]*(?:\*|//|#)?)+"
NUMBER = r"\d+(?:\.\d+)*"
CITATION = re.compile(r"\b[Tt]heory,?%s(?:sections?%s)?(%s(?:(?:,%s|%sand%s|[–-]|,%sand%s)%s)*)"
                      % (GAP, GAP, NUMBER, GAP, GAP, GAP, GAP, GAP, NUMBER))
HEADING = re.compile(r"^#{2,6} (%s) " % NUMBER, re.M)
# One letter before the dot is no file: n.h is the product of two vectors.
FILE = re.compile(r"(?<![\w.*-])((?:[\w*-]+/)*(?:[\w*-]{2,}|\*))\.(c|h|md|py|sh|ipynb)\b(?!\()")
TOKEN = re.compile(r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.S)


def files(root, folders=("",)):
    for folder in folders:
        for path, names, found in os.walk(root / folder):
            names[:] = sorted(n for n in names if n not in LEFT_OUT and not n.startswith("."))
            yield from (pathlib.Path(path, name) for name in sorted(found))


def line_of(text, place):
    return text.count("\n", 0, place) + 1


def comments(text):
    """Comments of C with their places; strings are passed over."""
    for token in TOKEN.finditer(text):
        if token.group(0)[0] == "/":
            yield token.start(), token.group(0)


def cited(text):
    """Numbers of sections with their places."""
    for match in CITATION.finditer(text):
        for number in re.finditer(NUMBER, match.group(1)):
            yield match.start(1) + number.start(), number.group(0)


def exists(name, names):
    if name in names or name in FOREIGN:
        return True
    pattern = "*" + name if name.startswith("_") else name
    return ("*" in pattern) and any(fnmatch.fnmatchcase(other, pattern) for other in names)


def check(root):
    """Problems as 'file:line: words', and how many citations and names there were."""
    wrong, counted = [], [0, 0]
    theory = root / "docs" / "theory.md"
    headings = set(HEADING.findall(theory.read_text(encoding="utf-8"))) if theory.is_file() else set()
    names = {path.name for path in files(root)}
    for path in files(root, CITING):
        if path.suffix not in TEXT or path.name in ("citations.py", "check_citations.sh"):
            continue
        text, here = path.read_text(encoding="utf-8"), path.relative_to(root)
        for place, number in cited(text):
            counted[0] += 1
            if number not in headings:
                wrong.append("%s:%d: theory %s is no section of docs/theory.md" % (here, line_of(text, place), number))
        if here.parts[0] != "src" or path.suffix not in (".c", ".h"):
            continue
        for start, comment in comments(text):
            for match in FILE.finditer(comment):
                name = match.group(0).rpartition("/")[2]
                counted[1] += 1
                if not exists(name, names):
                    wrong.append("%s:%d: %s is no file of the tree" % (here, line_of(text, start + match.start()), name))
    return wrong, counted


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
    wrong, (citations, named) = check(root)
    for line in wrong:
        print(line, file=sys.stderr)
    if not wrong:
        print("citations: %d of the theory and %d files named in comments exist" % (citations, named))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
