"""Certified globally optimal fits of analytic BRDF models.

    import brdffit
    fit = brdffit.fit(brdffit.Samples.example(), lobes=2)
    print(fit)

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import importlib.util
from typing import TYPE_CHECKING, Any

from ._ffi import LibraryError
from ._lobes import distributions
from ._version import __version__
from .boxes import Boxes, fit_boxes
from .compare import Comparison, compare
from .errors import BrdffitError, DataError, FileError, OptionError, OutOfMemoryError, UnsupportedError
from .fit import Fit, fit
from .intervals import Intervals
from .many import fit_many
from .maps import FitMap, fit_map
from .maps.pool import MapProgress
from .merl import MerlTable, load_merl
from .options import Options
from .progress import Progress
from .readers.lp import LightPositions, load_lp
from .readers.rgl import RGLMaterial, load_rgl
from .readers.stack import Stack, load_stack
from .samples import Samples, column_words, protocol84

if TYPE_CHECKING:
    from .regressor import BRDFRegressor

__all__ = ["BRDFRegressor", "Boxes", "BrdffitError", "Comparison", "DataError", "FileError", "Fit", "FitMap", "Intervals",
           "LibraryError",
           "LightPositions", "MapProgress", "MerlTable", "Options", "OptionError", "OutOfMemoryError", "Progress", "RGLMaterial",
           "Samples", "Stack", "UnsupportedError", "__version__", "column_words", "compare", "distributions", "fit", "fit_boxes",
           "fit_many",
           "fit_map", "library_path", "load_lp", "load_merl", "load_rgl", "load_stack", "protocol84"]
if importlib.util.find_spec("sklearn") is None:
    __all__.remove("BRDFRegressor")  # which cannot be imported: `import *` would fail for everything


def library_path() -> str:
    """The C library that is in use."""
    from ._ffi import library

    return library().path


def __getattr__(name: str) -> Any:
    # scikit-learn is needed by this one alone.
    if name == "BRDFRegressor":
        from .regressor import BRDFRegressor

        return BRDFRegressor
    raise AttributeError("module %r has no attribute %r" % (__name__, name))
