"""
Folders of src/ are layers: includes and calls point down, and no two files need each other.

Includes are read from the sources, calls from the symbols of the objects (argument: folder of the objects, such as
build/obj): what a file leaves undefined and another defines. src/io may call what brdffit.h declares.
SPDX-License-Identifier: MIT
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SRC = ROOT / "src"

# From the bottom up; a folder may use those before it and itself. src/io is a library of its own.
LAYERS = ["base", "kernels", "model", "weight", "data", "solve/conic", "solve", "search", "bound/moment", "bound/cell",
          "bound/socp", "bound/lp", "fit", "batch", "api"]
# Engines do not know each other.
APART = {"bound/moment", "bound/cell", "bound/socp", "bound/lp"}

STANDARD = {"float.h", "limits.h", "math.h", "stddef.h", "stdint.h", "string.h", "stdalign.h"}
# Headers beyond these, file by file.
SPECIAL = {"base/environment.c": {"fenv.h"}, "base/environment.h": {"fenv.h"}, "base/lanes.h": {"immintrin.h"},
           "api/allocation.c": {"stdlib.h"}, "solve/conic/socp.c": {"ecos.h", "stdlib.h"},
           "solve/conic/ecos_memory.c": {"setjmp.h", "stdlib.h"}}
PUBLIC = {"brdffit.h", "brdffit_io.h"}


def folder(name):
    return str(pathlib.PurePosixPath(name).parent)


def includes(path):
    return re.findall(r'^\s*#\s*include\s*["<]([^">]+)[">]', path.read_text(encoding="utf-8"), re.M)


def layer_problem(name, other):
    """Why file `name` may not use file `other` of src/, or None."""
    here, there = folder(name), folder(other)
    if here == there:
        return None
    if here.startswith("io"):
        if other.startswith("base/environment") or other in {"base/intake.h", "base/ieee.h", "base/degrees.h"}:
            return None  # compiled into both libraries
        return None if there.startswith("io") else f"{name}: src/io uses the core's {other}"
    if there.startswith("io") or here not in LAYERS or there not in LAYERS:
        return f"{name}: {other} is in no layer that it may use"
    if LAYERS.index(there) > LAYERS.index(here):
        return f"{name}: {other} is above it"
    if here in APART and there in APART:
        return f"{name}: {other} belongs to another engine"
    return None


def check_includes(files, problems, edges):
    for path in files:
        name = path.relative_to(SRC).as_posix()
        for header in includes(path):
            if (SRC / header).exists():
                edges.add((name, header))
                problem = layer_problem(name, header)
                if problem:
                    problems.append(problem)
            elif not name.startswith("io/") and header not in STANDARD | {"brdffit.h"} | SPECIAL.get(name, set()):
                problems.append(f"{name} includes {header}: the core may not")


def reaches(name, wanted, seen):
    """Whether a file of src/ includes `wanted`, through others or not."""
    if name == wanted:
        return True
    seen.add(name)
    return any(reaches(header, wanted, seen) for header in includes(SRC / name)
               if header not in seen and (SRC / header).exists())


def check_arithmetic(files, problems):
    """Whatever computes with doubles says what it needs of them."""
    for path in files:
        name = path.relative_to(SRC).as_posix()
        if re.search(r"\bdouble\b", path.read_text(encoding="utf-8")) \
                and not reaches(name, "base/ieee.h", set()):
            problems.append(f"{name} computes with doubles, but includes no base/ieee.h")


def unit(name):
    """A file without its ending; instances of one body for several instruction sets are one, beside the file that chooses."""
    return re.sub(r"_(base|avx2|avx512|body)$", "_isa", name.rsplit(".", 1)[0])


def symbols(objects):
    """Global symbols that each object defines, and those that it needs."""
    defined, needed = {}, {}
    for path in objects:
        name = path.relative_to(objects_root / "src").with_suffix("").as_posix()
        for line in subprocess.run(["nm", "-g", str(path)], capture_output=True, text=True, check=True).stdout.splitlines():
            kind, symbol = line.split()[-2:]
            if kind == "U":
                needed.setdefault(name, set()).add(symbol)
            else:
                defined[symbol] = name
    return defined, needed


def declared():
    """Names of the public functions."""
    text = (ROOT / "include/brdffit.h").read_text(encoding="utf-8")
    return set(re.findall(r"\b(brdffit_\w+)\s*\(", text))


def check_calls(problems, edges):
    public = declared()
    objects = sorted((objects_root / "src").rglob("*.o"))
    objects = [o for o in objects if (SRC / o.relative_to(objects_root / "src")).with_suffix(".c").exists()]
    if not objects:
        problems.append(f"no objects in {objects_root}: calls cannot be checked")
    defined, needed = symbols(objects)
    for name, wanted in needed.items():
        for symbol in sorted(wanted):
            other = defined.get(symbol)
            if other is None or unit(other) == unit(name):
                continue
            if name.startswith("io/") and symbol in public:
                continue
            edges.add((unit(name), unit(other)))
            problem = layer_problem(name + ".c", other + ".c")
            if problem:
                problems.append(f"{problem} (calls {symbol})")


def circles(edges):
    """Strongly connected components of more than one unit (Tarjan)."""
    graph, index, low, stack, found = {}, {}, {}, [], []
    for a, b in sorted(edges):
        graph.setdefault(a, []).append(b)

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for after in graph.get(node, []):
            if after not in index:
                visit(after)
            if after in stack:
                low[node] = min(low[node], low[after])
        if low[node] == index[node]:
            members = stack[stack.index(node):]
            del stack[stack.index(node):]
            if len(members) > 1:
                found.append(sorted(members))

    sys.setrecursionlimit(10000)
    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def check_rooms(problems):
    """The command line and the goniometer see public headers and their own; only socp.c sees ECOS."""
    for path in sorted((ROOT / "tools").rglob("*.[ch]")):
        if "bench" in path.parts:
            continue  # benchmarks measure other rooms from inside
        for header in includes(path):
            if (SRC / header).exists() and not (path.parent / header).exists():
                problems.append(f"{path.relative_to(ROOT)} includes the core's private {header}")
            if ".." in header or header == "ecos.h":
                problems.append(f"{path.relative_to(ROOT)} includes {header}")


def main():
    files = sorted(SRC.rglob("*.[ch]"))
    problems, include_edges, call_edges = [], set(), set()
    check_includes(files, problems, include_edges)
    check_arithmetic([p for p in files if p.suffix == ".c"], problems)
    check_calls(problems, call_edges)
    check_rooms(problems)
    problems += ["files that include each other: " + ", ".join(members) for members in circles(include_edges)]
    problems += ["files that call each other: " + ", ".join(members) for members in circles(call_edges)]
    long = [f"{p.relative_to(ROOT)} has {n} lines: one subject a file, 450 at most"
            for p in files if (n := len(p.read_text(encoding="utf-8").splitlines())) > 450]
    problems += long
    if problems:
        sys.exit("\n".join(problems))
    print(f"layers: {len(files)} files in {len({folder(f.relative_to(SRC).as_posix()) for f in files})} folders, "
          f"{len(include_edges)} includes and {len(call_edges)} calls, all downwards")


if __name__ == "__main__":
    objects_root = pathlib.Path(sys.argv[1])
    main()
