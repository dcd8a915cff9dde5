"""Arrays in files, read as they are indexed. SPDX-License-Identifier: MIT"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Part = tuple[slice, slice, slice, slice]
Names = Mapping[str, str | Sequence[str]]


class LazyArray:
    """samples x height x width x channels in files. Indexing with numbers, slices (of any step) and `...` reads what is
    asked for, as float32 or float64; `numpy.asarray` reads all. A base: `_read` knows the format."""

    ndim = 4
    rows_together = 32  # rows of an image that are stored as one block, or close to it

    def __init__(self, shape: tuple[int, int, int, int], dtype: npt.DTypeLike) -> None:
        self.shape = shape
        self.dtype: np.dtype[Any] = np.dtype(dtype)

    def _read(self, part: Part) -> npt.NDArray[Any]:
        """part: slices with start, stop and step of 1, inside of the shape and not empty."""
        raise NotImplementedError

    @property
    def size(self) -> int:
        return int(np.prod(self.shape))

    @property
    def nbytes(self) -> int:
        return self.size * self.dtype.itemsize

    def __len__(self) -> int:
        return self.shape[0]

    def __repr__(self) -> str:
        return "<%s: %s, %s>" % (type(self).__name__, " x ".join(map(str, self.shape)), self.dtype)

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if copy is False:
            raise ValueError("the values are in files: an array of them is a copy")
        array = self[...]
        return array if dtype is None else array.astype(dtype)

    def __getitem__(self, key: Any) -> npt.NDArray[Any]:
        part: list[slice] = []
        after: list[slice | int] = []
        for index, extent in zip(self._complete(key), self.shape):
            if isinstance(index, slice):
                chosen = range(*index.indices(extent))
                low, high = (min(chosen[0], chosen[-1]), max(chosen[0], chosen[-1])) if chosen else (0, -1)
                part.append(slice(low, high + 1, 1))
                after.append(slice(None, None, chosen.step))
            else:
                at = index + extent if index < 0 else index
                if not 0 <= at < extent:
                    raise IndexError("index %d is out of bounds for %d" % (index, extent))
                part.append(slice(at, at + 1, 1))
                after.append(0)
        shape = tuple(one.stop - one.start for one in part)
        if 0 in shape:
            return np.empty(shape, self.dtype)[tuple(after)]
        return self._read((part[0], part[1], part[2], part[3]))[tuple(after)]

    def _complete(self, key: Any) -> list[Any]:
        """One index a dimension, integers or slices."""
        given = list(key) if isinstance(key, tuple) else [key]
        dots = [at for at, index in enumerate(given) if index is Ellipsis]
        if len(dots) > 1:
            raise IndexError("only one ... may stand in an index")
        if not dots:
            given.append(Ellipsis)
        at = dots[0] if dots else len(given) - 1
        if len(given) - 1 > self.ndim:
            raise IndexError("%d indices for %d dimensions" % (len(given) - 1, self.ndim))
        given[at:at + 1] = [slice(None)] * (self.ndim - len(given) + 1)
        return [index if isinstance(index, slice) else _integer(index) for index in given]


def _integer(index: Any) -> int:
    if isinstance(index, bool) or not isinstance(index, (int, np.integer)):
        raise IndexError("a stack is indexed with numbers, slices and ..., not %s" % type(index).__name__)
    return int(index)
