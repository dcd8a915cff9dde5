"""The arrays that texels are fitted into, by the names of `FitMap`, and what becomes of a texel.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _structs as structs
from .. import _terms
from ..options import Options

Arrays = dict[str, npt.NDArray[Any]]

# Beyond the C library's: of texels with directions of their own, and of a run that was stopped.
STATUS = (*structs.TEXEL_STATUS, "no_samples", "not_reached")
CERTIFIED, OPEN, NO_SIGNAL, MASKED, BAD_VALUE, REFUSED, NO_SAMPLES, NOT_REACHED = range(len(STATUS))
STOP = (*structs.STOP, "none")
NO_STOP = len(structs.STOP)

COUNTS = tuple(field[0] for field in structs.ManyStats._fields_[1:])


def terms_of(options: Options) -> dict[str, int]:
    """Further arguments of `allocate`."""
    return {"f0": int(options.fresnel != "none"), "more": _terms.more_columns(options.diffuse)}


def allocate(count: int, channels: int, lobes: int, f0: int = 0, more: int = 0) -> Arrays:
    """What `count` texels are fitted into; not filled. f0: whether there is one; more: columns of x_more, if any."""
    further = {"f0": np.empty((count, channels, lobes))} if f0 else {}
    if more:
        further["x_more"] = np.empty((count, channels, more))
    return {"sigma": np.empty((count, lobes)), "x": np.empty((count, channels)),
            "y": np.empty((count, channels, lobes)), "channel_scale": np.empty((count, channels)),
            "e2": np.empty(count), "lower_bound": np.empty(count), "sum_of_squares": np.empty(count),
            "status": np.empty(count, np.uint8), "stop": np.empty(count, np.uint8),
            "where": np.empty(count, np.intp), "boxes": np.empty(count, np.intp), "sigma_floor": np.empty(count), **further}


def blank(results: Arrays, part: slice, status: int) -> None:
    """Texels that were not fitted."""
    for array in results.values():
        array[part] = np.nan if array.dtype.kind == "f" else 0
    results["status"][part] = status
    results["stop"][part] = NO_STOP
    results["where"][part] = -1


def shaped(results: Mapping[str, npt.NDArray[Any]], spatial: tuple[int, ...]) -> Arrays:
    return {name: array.reshape((*spatial, *array.shape[1:])) for name, array in results.items()}


def unusable(status: npt.NDArray[np.uint8]) -> npt.NDArray[np.bool_]:
    """Texels whose fit alone would fail."""
    return (status >= BAD_VALUE) & (status <= NO_SAMPLES)
