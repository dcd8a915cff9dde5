"""Maps: every texel of a stack of images fitted, each with its own proof.

    fitmap          FitMap, what comes back: `evaluate`, `files` and `words` are what its methods do
    memory          the fit of an array in memory: `stack`, `geometry` and `arguments` are what it is given, `pool` shares it
                    out, `batch` and `texelwise` call the C library, `results` holds what it writes
    dispatch        fit_map: in memory, or as brdffit.outofcore does

SPDX-License-Identifier: MIT
"""
from .dispatch import fit_map
from .fitmap import FitMap
from .results import STATUS, STOP

__all__ = ["STATUS", "STOP", "FitMap", "fit_map"]
