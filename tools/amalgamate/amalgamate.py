#!/usr/bin/env python3
"""
Write the library as one source file and one header, for firmware and for projects without a build of their own.

    amalgamate.py [--distributions beckmann,ggx] [--lobes 1] [--without anisotropic,fresnel,diffuse,masking] [--malloc] [-o DIR]

DIR/brdffit.c holds the core for the processor that it is compiled for, with no other instruction set, no ECOS (engine
socp and norms l1 and linf are refused), no stdio and, but with --malloc, no malloc; DIR/brdffit.h is the public
header. A distribution that is left out is refused like one that does not exist, and so is what `--without` leaves out.

A file becomes part of another as the compiler would see it: headers once, where they are first included; names of one
file that another file has too get the file's name in front; macros of a file end with it. Functions of files that are
left out answer BRDFFIT_ERR_UNSUPPORTED. SPDX-License-Identifier: MIT
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SRC = ROOT / "src"

# Files of other instruction sets, of ECOS and of what is proven with it.
LEFT_OUT = re.compile(r"(_avx2|_avx512)\.c$|^io/|^bound/(socp|lp)/|^solve/conic/|^solve/(l1_linf|simplex\w*)\.c$")

# What can be left out, as the limit of a number of columns (kernels/kernels.h).
FEATURES = {"anisotropic": "BRDFFIT_WITHOUT_ANISOTROPIC", "fresnel": "BRDFFIT_WITHOUT_FRESNEL",
            "diffuse": "BRDFFIT_WITHOUT_DIFFUSE", "masking": "BRDFFIT_WITHOUT_MASKING"}

TOKEN = re.compile(r'\b(?:struct|enum|union)\s+[A-Za-z_]\w*'
                   r'|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|\.\s*[A-Za-z_]\w*|->\s*[A-Za-z_]\w*'
                   r'|[A-Za-z_]\w*|\d[\w.]*', re.S)
INCLUDE = re.compile(r'^#include "([^"]+)"[^\n]*\n', re.M)
# At the left edge: static functions and objects, and tags of structures and enumerations.
FUNCTION = re.compile(r"^[A-Za-z_][\w \*]*?\b(?!brdffit_)(\w+)\([^;{}]*\)\n\{", re.M)
OBJECT = re.compile(r"^(?:static |\}) ?[^;={}()\[\]]*?\b(\w+)(?:\[[^=;]*\])?\s*(?:=|;)", re.M)
TAG = re.compile(r"^((?:struct|enum|union) \w+) \{", re.M)


def blank(text):
    """The text without comments, strings and function bodies' contents left as they are."""
    return re.sub(r"/\*.*?\*/", lambda m: re.sub(r"[^\n]", " ", m.group()), text, flags=re.S)


def own_names(text):
    """Names that a file declares for itself alone; a tag with the word before it."""
    plain = re.sub(r"__attribute__\(\(\w+\)\) ?", "", blank(text))
    return {*FUNCTION.findall(plain), *OBJECT.findall(plain), *TAG.findall(plain)}


def enumerators(text):
    """Constants of a file's enumerations."""
    bodies = re.findall(r"^enum[^{;]*\{([^}]*)\}", blank(text), re.M)
    return {name for body in bodies for name in re.findall(r"\b([A-Z]\w*)\b(?=\s*(?:,|=|$))", body)}


def renamed(text, names, prefix):
    """The text with these names prefixed, but for members and words in comments and strings."""
    return TOKEN.sub(lambda m: re.sub(r"\w+$", prefix + r"\g<0>", m.group()) if m.group() in names else m.group(), text)


class Amalgamation:
    def __init__(self, distributions, lobes, without, malloc):
        self.distributions, self.lobes, self.without, self.malloc = distributions, lobes, without, malloc
        self.headers, self.private = set(), set()
        self.out = []

    def sources(self):
        """The files that are taken, in the order of the layers."""
        layers = ["base", "kernels", "model", "weight", "data", "solve", "search", "bound/moment",
                  "bound/cell", "fit", "batch", "api"]
        found = [p for layer in layers for p in sorted((SRC / layer).glob("*.c"))]
        return [p for p in found if not self.left_out(p.relative_to(SRC).as_posix())]

    def left_out(self, name):
        if LEFT_OUT.search(name) or (name == "api/allocation.c" and not self.malloc):
            return True
        if name == "model/masked.c" and "masking" in self.without:
            return True
        if (name.startswith("bound/cell/") or name == "fit/anisotropic.c") and "anisotropic" in self.without:
            return True
        kind = lobe_files().get(name)
        return kind is not None and kind not in self.distributions

    def header(self, name, rename):
        """What takes an #include's place."""
        path = SRC / name
        if not path.exists():
            return "" if name == "brdffit.h" else f'#include "{name}"\n'
        text = path.read_text(encoding="utf-8")
        if re.search(r"^#ifndef BRDFFIT_\w+_H$", text, re.M):
            if name in self.headers:
                return ""
            self.headers.add(name)
        return f"\n/* ---- src/{name} ---- */\n{self.expanded(text, name, rename)}\n"

    def expanded(self, text, name, rename):
        """A file with its headers in place; it and headers that are nobody else's with their names renamed."""
        parts, at = [], 0
        own = rename if name in self.private or name.endswith(".c") else lambda part: part
        for match in INCLUDE.finditer(text):
            parts += [own(text[at:match.start()]), self.header(match.group(1), rename)]
            at = match.end()
        return "".join([*parts, own(text[at:])])

    def file(self, path, shared):
        name = path.relative_to(SRC).as_posix()
        text = path.read_text(encoding="utf-8")
        if name == "model/lobes.c":
            text = self.table_of_lobes(text)
        whole = "".join([text, *((SRC / h).read_text(encoding="utf-8") for h in reached(name) & self.private)])
        mine = (own_names(whole) | enumerators(whole)) & shared
        body = self.expanded(text, name, lambda part: renamed(part, mine, f"{path.parent.name}_{path.stem}_"))
        undefined = "".join(f"#undef {macro}\n" for macro in re.findall(r"^#define (\w+)", text, re.M))
        self.out.append(f"\n/* ==== src/{name} ==== */\n{body}\n{undefined}")

    def table_of_lobes(self, text):
        kinds = set(lobe_files().values()) - set(self.distributions)
        return re.sub(r"^ *\[BRDFFIT_\w+\] = &brdffit_lobe_(\w+),\n",
                      lambda m: "" if m.group(1) in kinds else m.group(), text, flags=re.M)

    def missing(self):
        """Functions that somebody calls and nobody here defines, as the headers declare them."""
        text = "".join(self.out)
        plain = blank(text)
        defined = set(re.findall(r"^(?!static|extern)[\w \*]*?\b(brdffit_\w+)\([^;{}]*\)\n\{", plain, re.M))
        called = set(re.findall(r"\b(brdffit_\w+)\s*\(", re.sub(r"^(?!static)[A-Za-z][\w \*]*\([^;{}]*\);", "", plain, flags=re.M)))
        declared = {m.group(2): m for m in re.finditer(r"^([A-Za-z][\w \*]*?)\b(brdffit_\w+)\(([^;{}]*)\);", plain, re.M)}
        return [declared[name] for name in sorted(called - defined) if name in declared]

    def stub(self, match):
        kind, name, arguments = match.group(1).replace("ENVIRONMENT_APART ", "").strip(), match.group(2), match.group(3)
        used = "".join(f"    (void){a};\n" for a in re.findall(r"(\w+)(?:\[\w*\])?\s*(?:,|$)", arguments) if a != "void")
        if kind.endswith("*"):
            return f"{kind}{name}({' '.join(arguments.split())})\n{{\n{used}    return NULL;\n}}\n"
        answer = {"void": "", "brdffit_status": "    return BRDFFIT_ERR_UNSUPPORTED;\n", "int": "    return 0;\n",
                  "double": "    return 0.0;\n", "size_t": "    return 0;\n"}[kind]
        return f"{kind} {name}({' '.join(arguments.split())})\n{{\n{used}{answer}}}\n"

    def write(self, folder):
        files = self.sources()
        texts = {p: p.read_text(encoding="utf-8") for p in files}
        count = {}
        headers = [h.read_text(encoding="utf-8") for h in SRC.rglob("*.h")]
        for text in [*texts.values(), *headers]:
            for name in own_names(text) | enumerators(text):
                count[name] = count.get(name, 0) + 1
        shared = {name for name, n in count.items() if n > 1}
        users = [header for path in files for header in reached(path.relative_to(SRC).as_posix())]
        self.private = {header for header in users if users.count(header) == 1}
        for path in files:
            self.file(path, shared)
        stubs = [self.stub(match) for match in self.missing()]
        if stubs:
            self.out.append("\n/* ==== What this copy is without ==== */\n" + "\n".join(stubs))
        version = re.search(r'BRDFFIT_VERSION_STRING "(.*)"', header_text()).group(1)
        head = (f"/*\n * brdffit {version} in one file, without ECOS and files{'' if self.malloc else ' and malloc'}: "
                "distributions "
                f"{', '.join(self.distributions)}; at most {self.lobes} lobe{'s' * (self.lobes > 1)}"
                f"{'; without ' + ', '.join(self.without) if self.without else ''}.\n"
                " * Made by tools/amalgamate/amalgamate.py: change the sources there, not here.\n"
                " * SPDX-License-Identifier: MIT\n */\n#define BRDFFIT_NO_ECOS\n"
                + "".join(f"#define {FEATURES[f]}\n" for f in self.without)
                + '#include "brdffit.h"\n#pragma GCC diagnostic ignored "-Wunused-function"\n'
                '#ifndef __clang__\n#pragma GCC diagnostic ignored "-Wpsabi"\n'
                '/* What a copy with fewer lobes or columns never reaches. */\n'
                '#pragma GCC diagnostic ignored "-Warray-bounds"\n#endif\n')
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "brdffit.c").write_text(head + "".join(self.out), encoding="utf-8")
        (folder / "brdffit.h").write_text(
            re.sub(r"^(#define BRDFFIT_MAX_LOBES) \d+", rf"\1 {self.lobes}", header_text(), flags=re.M), encoding="utf-8")


def reached(name):
    """Headers that a file includes, through others or not."""
    found, waiting = set(), [name]
    while waiting:
        for header in re.findall(r'^#include "([^"]+)"', (SRC / waiting.pop()).read_text(encoding="utf-8"), re.M):
            if header not in found and (SRC / header).exists():
                found.add(header)
                waiting.append(header)
    return found


def header_text():
    return (ROOT / "include/brdffit.h").read_text(encoding="utf-8")


def lobe_files():
    """Files that are one distribution each, with its name."""
    found = {}
    for path in sorted((SRC / "model").glob("*.c")):
        match = re.search(r"^const struct lobe_kind brdffit_lobe_(\w+) = ", path.read_text(encoding="utf-8"), re.M)
        if match:
            found[path.relative_to(SRC).as_posix()] = match.group(1)
    return found


def names(text):
    return [name.strip().replace("-", "_") for name in text.split(",") if name.strip()]


def choice(given, known, what):
    unknown = [name for name in given if name not in known]
    if unknown:
        sys.exit(f"amalgamate.py: no {what} '{unknown[0]}'; there are {', '.join(known)}")
    return given


def print_sizes(folder, compilers):
    """Text, data and bss of the compiled file, as each compiler's `size` has it."""
    for compiler in compilers:
        with tempfile.TemporaryDirectory() as scratch:
            target = f"{scratch}/brdffit.o"
            words = compiler.split()
            if shutil.which(words[0]) is None:
                continue
            subprocess.run([*words, "-std=c11", "-Os", "-c", str(folder / "brdffit.c"), "-o", target], check=True)
            line = subprocess.run(["size", target], capture_output=True, text=True, check=True).stdout.splitlines()[1]
            text, data, bss = line.split()[:3]
            print(f"{compiler} -Os: {text} bytes of text, {data} of data, {bss} of bss (before the linker drops what is not used)")


def main():
    kinds = list(lobe_files().values())
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument("--distributions", default=",".join(kinds), metavar="NAME,...", help="default: all")
    parser.add_argument("--lobes", type=int, choices=(1, 2, 3), default=3, help="most lobes of a model (default: 3)")
    parser.add_argument("--without", default="", metavar="NAME,...", help=f"of {', '.join(FEATURES)}")
    parser.add_argument("--malloc", action="store_true", help="with the functions that allocate (brdffit_fit_new)")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("."), metavar="DIR")
    parser.add_argument("--cc", action="append", metavar="COMPILER", help="print the size that it compiles to (default: cc)")
    options = parser.parse_args()
    given = choice(names(options.distributions), kinds, "distribution")
    without = choice(names(options.without), list(FEATURES), "part to leave out")
    if not {"beckmann", "ggx"} <= set(given) and "masking" not in without:
        without.append("masking") # is that of these two
    Amalgamation(given, options.lobes, without, options.malloc).write(options.output)
    lines = len((options.output / "brdffit.c").read_text(encoding="utf-8").splitlines())
    print(f"{options.output}/brdffit.c: {lines} lines; {options.output}/brdffit.h")
    print_sizes(options.output, options.cc or ["cc"])


if __name__ == "__main__":
    main()
