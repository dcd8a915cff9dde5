"""Modules of the package import one way: each its own layer or lower ones, and none in a circle.

Read from the source, so that an import inside of a function counts as any other, whether it ever runs or not. So does one
for types alone, but between a class and the functions that its methods are (`TYPES`). What an import runs beside the module
that it names, the `__init__` of the packages around it, does not count: brdffit's own has always begun before.

SPDX-License-Identifier: MIT
"""
import ast
import fnmatch
import graphlib

import pytest

from places import SOURCES

PACKAGE = SOURCES / "brdffit"

# Lowest first; a new module needs a place here. A name without pattern wins over one with.
LAYERS = (
    ("the library", ("_version", "_structs", "_ffi", "errors")),
    ("arguments", ("_arguments", "_arrays", "_forms", "_lobes", "_terms", "_weights", "_words", "options", "progress")),
    ("files as arrays", ("readers", "readers.*")),
    ("samples", ("samples",)),
    ("fits", ("intervals", "fit", "boxes", "compare", "many", "merl", "regressor", "readers.rgl", "export", "export.*")),
    ("maps in memory", ("maps.*",)),
    ("maps out of core", ("outofcore", "outofcore.*")),
    ("maps", ("maps", "maps.dispatch")),
    ("stacks", ("readers.stack",)),
    ("the public package", ("", "dask", "export.command", "report", "report.*")),
)
# Who may name the class of the other, whose methods call it.
TYPES = {("_words", "fit"), ("intervals", "fit"), ("export.fitted", "fit"),
         ("maps.evaluate", "maps.fitmap"), ("maps.files", "maps.fitmap"), ("maps.words", "maps.fitmap")}


def modules(package):
    """Path of each, by its name inside of the package; "" is the package's own."""
    out = {}
    for path in sorted(package.rglob("*.py")):
        parts = path.relative_to(package).with_suffix("").parts
        out[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return out


def for_types(tree):
    """The imports that no run executes."""
    return {id(inner) for node in ast.walk(tree) if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
            for branch in node.body for inner in ast.walk(branch)}


def targets(node, inside, package, known):
    """The modules that an import names. inside: the names of the packages around it."""
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names]
    else:
        kept = len(inside) + 2 - node.level if node.level else 0
        base = [package, *inside][:kept] + ([node.module] if node.module else [])
        names = [".".join([*base, alias.name]) for alias in node.names]
    for name in names:
        head, _, rest = name.partition(".")
        if head == package:
            yield rest if rest in known else rest.rpartition(".")[0]


def graph(package, types=TYPES):
    """What each module imports."""
    known = modules(package)
    out = {name: set() for name in known}
    for name, path in known.items():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        unrun = for_types(tree)
        inside = path.relative_to(package).parts[:-1]
        for node in ast.walk(tree):
            if isinstance(node, (ast.Import, ast.ImportFrom)):
                found = set(targets(node, inside, package.name, known))
                out[name] |= {to for to in found if id(node) not in unrun or (name, to) not in types}
    return out


def layer_of(name):
    """Its number, from 0."""
    places = [at for at, (_, names) in enumerate(LAYERS) if name in names] or [
        at for at, (_, names) in enumerate(LAYERS) if any("*" in one and fnmatch.fnmatchcase(name, one) for one in names)]
    assert len(places) == 1, "module %r has %d places in LAYERS" % (name, len(places))
    return places[0]


def circle(imports):
    """Modules in a circle, or None."""
    try:
        graphlib.TopologicalSorter(imports).prepare()
    except graphlib.CycleError as error:
        return error.args[1]
    return None


def test_no_circle():
    imports = graph(PACKAGE)
    assert len(imports) > 50 and sum(map(len, imports.values())) > 200  # it did read them
    assert circle(imports) is None


def test_no_import_points_up():
    up = ["%s (%s) imports %s (%s)" % (name, LAYERS[layer_of(name)][0], to, LAYERS[layer_of(to)][0])
          for name, found in graph(PACKAGE).items() for to in found if layer_of(to) > layer_of(name)]
    assert not up, "\n".join(up)


def test_every_entry_is_needed():
    known = modules(PACKAGE)
    assert all(fnmatch.filter(known, one) for _, names in LAYERS for one in names)
    with_types, without = graph(PACKAGE, types=()), graph(PACKAGE)
    assert {(name, to) for name in known for to in with_types[name] - without[name]} == TYPES


@pytest.mark.parametrize("line", [
    "from .upper import f", "from . import upper", "import pack.upper as u", "from pack.upper import f", "from .inner import h",
    "def g():\n    from .upper import f", "class C:\n    def g(self):\n        import pack.upper",
    "if TYPE_CHECKING:\n    from .upper import f", "try:\n    from . import upper\nexcept E:\n    pass"])
def test_circles_are_seen(tmp_path, line):
    package = tmp_path / "pack"
    (package / "inner").mkdir(parents=True)
    for name, text in (("__init__", "from .upper import f"), ("lower", line), ("upper", "from .lower import x"),
                       ("inner/__init__", "from ..upper import f"), ("inner/leaf", "import numpy, package.upper")):
        (package / (name + ".py")).write_text(text)
    found = circle(graph(package))
    assert found is not None and {"lower", "upper"} <= set(found)
    assert graph(package)["inner.leaf"] == set() and graph(package)[""] == {"upper"}
    assert circle(graph(package, types={("lower", "upper")})) is None or "TYPE_CHECKING" not in line
