"""Pages of the Python reference, from what the package exports: a new public name appears by itself.

SPDX-License-Identifier: MIT
"""
import inspect

import brdffit
import brdffit.report
from sphinx.ext.autodoc.mock import mock

# Packages that a public name needs and the documentation does not.
ABSENT = ["sklearn"]

# Page, title, introduction, names. What no page lists is put on the page "more".
PAGES = (
    ("measurements", "Measurements", "From files and arrays to samples.", ("Samples", "MerlTable", "load_merl", "protocol84")),
    ("fits", "Fits", "One fit or many; what is asked for, and what comes back.",
     ("fit", "fit_many", "Fit", "Options", "Progress")),
    ("maps", "Maps", "Every texel of a stack of images.", ("fit_map", "FitMap", "MapProgress")),
    ("proof", "The proof, box by box", "The search itself, to look at: :doc:`/proof` draws these.", ("fit_boxes", "Boxes")),
    ("sklearn", "scikit-learn", "Needs scikit-learn (``pip install brdffit[sklearn]``).", ("BRDFRegressor",)),
    ("errors", "Errors and the library", "Every failure is a :py:class:`brdffit.BrdffitError` with a code and a place.",
     ("BrdffitError", "OptionError", "DataError", "FileError", "UnsupportedError", "OutOfMemoryError", "LibraryError",
      "library_path")),
)
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
    names = [name for name in brdffit.report.__all__ if name != "main"]
    (folder / "report.rst").write_text(_page("Report pages", "What ``brdffit report`` is made of: :doc:`/report`.", brdffit.report,
                                             names), encoding="utf-8")
    return [*written, "report"]
