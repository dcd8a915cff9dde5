"""Numbers on their way to C and back. SPDX-License-Identifier: MIT"""
from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from .errors import DataError

Floats = npt.NDArray[np.float64]


def unmasked(name: str, value: object) -> None:
    """A masked array would become its data, and what was masked would be fitted."""
    if np.ma.is_masked(value):
        raise DataError("%s is an array with masked entries: leave them out, give their samples the weight 0, or their texels "
                        "the mask 0" % name, code="argument")


def floats(name: str, value: npt.ArrayLike) -> Floats:
    """`value` as float64 in C order; not copied when it is that already."""
    unmasked(name, value)
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "fiub":
            array = np.asarray(array, dtype=object).astype(np.float64)
        return np.ascontiguousarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise DataError("%s is not an array of numbers (%s)" % (name, error), code="value") from error


def vectors(name: str, value: npt.ArrayLike) -> Floats:
    """... x 3."""
    array = floats(name, value)
    if array.ndim < 1 or array.shape[-1] != 3:
        raise DataError("%s must have 3 components in its last dimension, not shape %s" % (name, array.shape),
                        code="argument")
    return array


def column(name: str, value: npt.ArrayLike, count: int) -> Floats:
    """`count` numbers."""
    array = floats(name, value)
    if array.shape != (count,):
        raise DataError("%s must have shape (%d,), not %s" % (name, count, array.shape), code="argument")
    return array


Array = TypeVar("Array", bound=npt.NDArray[Any])


def freeze(array: Array) -> Array:
    """A view of `array` that cannot be written through; the array of the caller keeps its flags."""
    view: Array = array.view()
    view.flags.writeable = False
    return view


class Frozen:
    """Base of dataclasses whose arrays cannot be written to: nor can those of a copy or of what was pickled."""

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update({name: freeze(value) if isinstance(value, np.ndarray) else value for name, value in state.items()})


def from_address(address: int | None, shape: tuple[int, ...], owner: object) -> Floats | None:
    """Doubles in the C library's memory as an array that keeps `owner` alive, without a copy."""
    import ctypes

    if not address:
        return None
    count = int(np.prod(shape))
    if count == 0:
        return np.zeros(shape)
    memory = (ctypes.c_double * count).from_address(address)
    memory._owner = owner  # type: ignore[attr-defined]  # an attribute of this one buffer: what frees it
    return np.frombuffer(memoryview(memory).cast("B"), dtype=np.float64).reshape(shape)


def address(array: Floats | None) -> int | None:
    return None if array is None else int(array.ctypes.data)
