"""Pages of the Python reference, from what the package exports: a new public name appears by itself.

SPDX-License-Identifier: MIT
"""
import importlib
import importlib.util
import inspect

from sphinx.ext.autodoc.mock import mock

import brdffit

# Packages that a public name needs and the documentation does not.
ABSENT = ["sklearn"]

# Page, title, introduction, names. What no page lists is put on the page "more".
PAGES = (
    ("measurements", "Measurements", "From files and arrays to samples.",
     ("Samples", "MerlTable", "load_merl", "RGLMaterial", "load_rgl", "protocol84")),
    ("fits", "Fits", "One fit or many; what is asked for, and what comes back.",
     ("fit", "fit_many", "Fit", "Options", "Progress")),
    ("compare", "Which model", "Many forms of model on the same samples: :doc:`/compare`.", ("compare", "Comparison")),
    ("maps", "Maps", "Every texel of a stack of images.", ("fit_map", "FitMap", "MapProgress", "Stack", "load_stack",
                                                        "LightPositions", "load_lp")),
    ("proof", "The proof, box by box", "The search itself, to look at: :doc:`/proof` draws these.", ("fit_boxes", "Boxes")),
    ("sklearn", "scikit-learn", "Needs scikit-learn (``pip install brdffit[sklearn]``).", ("BRDFRegressor",)),
    ("errors", "Errors and the library", "Every failure is a :py:class:`brdffit.BrdffitError` with a code and a place.",
     ("BrdffitError", "OptionError", "DataError", "FileError", "UnsupportedError", "OutOfMemoryError", "LibraryError",
      "library_path")),
)
# Modules with public names of their own, where there are such.
MODULES = (("dask", "Maps at scale", "Arrays of zarr, Dask and xarray, larger than memory: :doc:`/maps`."),
           ("report", "Report pages", "What ``brdffit report`` is made of: :doc:`/report`."))
_MEMBERS = {"class": ["   :members:"], "exception": ["   :show-inheritance:"]}


def _kind(thing):
    if inspect.isclass(thing):
        return "exception" if issubclass(thing, BaseException) else "class"
    return "function" if callable(thing) else "data"


def _entry(module, name):
    with mock(ABSENT):
        kind = _kind(getattr(module, name))
    return [".. auto%s:: %s.%s" % (kind, module.__name__, name), *_MEMBERS.get(kind, []), ""]


def _page(title, words, module, names):
    names = list(names)
    table = [".. autosummary::", "   :nosignatures:", "", *("   " + name for name in names), ""]
    body = [line for name in names for line in _entry(module, name)]
    return "\n".join([title, "=" * len(title), "", ".. currentmodule:: " + module.__name__, "", words, "", *table, *body])


def write(folder):
    """One file a page; their names in order."""
    folder.mkdir()
    public = [name for name in brdffit.__all__ if name != "__version__"]
    rest, written = set(public), []
    for page, title, words, listed in PAGES:
        names = [name for name in listed if name in rest]
        rest -= set(names)
        if names:
            (folder / (page + ".rst")).write_text(_page(title, words, brdffit, names), encoding="utf-8")
            written.append(page)
    if rest:
        names = [name for name in public if name in rest]
        (folder / "more.rst").write_text(_page("More", "", brdffit, names), encoding="utf-8")
        written.append("more")
    for module, title, words in MODULES:
        names = _exports(module)
        if names:
            text = _page(title, words, importlib.import_module("brdffit." + module), names)
            (folder / (module + ".rst")).write_text(text, encoding="utf-8")
            written.append(module)
    return written


def _exports(name):
    """Public classes and functions of a module of the package that are not also the package's; none when there is no such
    module."""
    if importlib.util.find_spec("brdffit." + name) is None:
        return []
    module = importlib.import_module("brdffit." + name)
    return [n for n in module.__all__ if n not in brdffit.__all__ and n != "main" and _kind(getattr(module, n)) != "data"]


def exported():
    """Every public name, with the module that it is imported from."""
    return ["brdffit." + name for name in brdffit.__all__ if name != "__version__"] + [
        "brdffit.%s.%s" % (module, name) for module, _, _ in MODULES for name in _exports(module)]
