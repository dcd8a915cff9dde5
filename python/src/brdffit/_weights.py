"""What samples count for, by the library (brdffit_weights). SPDX-License-Identifier: MIT"""
from __future__ import annotations

from ctypes import byref

import numpy as np
import numpy.typing as npt

from . import _structs as structs
from ._arguments import choose
from ._arrays import Floats, address
from ._ffi import library
from .errors import from_struct

FLOOR = 0.01  # BRDFFIT_WEIGHT_FLOOR


def weigh(samples: structs.Samples, weight: str, floor: float = FLOOR, path: str | None = None) -> Floats:
    """Weights of samples as C has them: N."""
    core = library().core
    kind = choose("weight", weight, structs.WEIGHTING)
    out = np.empty(samples.count)
    work = _room(samples, kind)
    error = structs.Error()
    if core.brdffit_weights(byref(samples), kind, floor, work.ctypes.data, work.size, out.ctypes.data, byref(error)) != 0:
        raise from_struct(error, path=path)
    return out


def solid_angles(light: Floats, view: Floats) -> Floats:
    """Of directions around +z, N x 3 each."""
    samples = library().samples()
    l, v = np.ascontiguousarray(light), np.ascontiguousarray(view)
    samples.count, samples.channels = len(l), 1
    samples.form = structs.FORM.index("directions")
    samples.light, samples.view = address(l), address(v)
    return weigh(samples, "solid-angle")


def crowded(samples: structs.Samples) -> bool:
    """Whether they crowd where the material is bright."""
    angles = weigh(samples, "solid-angle")
    work = _room(samples, structs.WEIGHTING.index("relative"))
    return bool(library().core.brdffit_weights_crowded(byref(samples), angles.ctypes.data, work.ctypes.data, work.size))


def _room(samples: structs.Samples, kind: int) -> npt.NDArray[np.uint8]:
    return np.empty(library().core.brdffit_weights_size(samples.count, samples.channels, kind), np.uint8)
