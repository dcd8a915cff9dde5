"""Where the values of many texels lie, and how the C library may read them there.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .. import _structs as structs
from .._arrays import unmasked
from ..errors import DataError

Values = npt.NDArray[Any]

# Rows of a cropped image that are shorter than this are copied together: a call of its own costs more.
SHORT_RUN = 32


def of_all_samples(spatial: Iterable[Any]) -> tuple[Any, ...]:
    """An index: every sample of the texels that `spatial` selects."""
    return (slice(None), *spatial)


class Block(NamedTuple):
    """Texels for one call: element (i, t, k) is sample i, texel t, channel k. `values` is of a type that the C library
    reads, and aligned; strides are those of the caller's array when nothing was copied."""

    values: Values
    first: int
    texels: int


def _axis(name: str, axis: Any, dims: int) -> int:
    if not isinstance(axis, (int, np.integer)) or isinstance(axis, bool) or not -dims <= axis < dims:
        raise DataError("%s must be an axis of the %d-dimensional values, not %r" % (name, dims, axis), code="argument")
    return int(axis) % dims


def axes_of(sample_axis: Any, channel_axis: Any, dims: int) -> tuple[int, int | None]:
    """Both counted from 0; no channel axis: None."""
    sample = _axis("sample_axis", sample_axis, dims)
    channel = None if channel_axis is None else _axis("channel_axis", channel_axis, dims)
    if sample == channel:
        raise DataError("sample_axis and channel_axis are the same axis, %d" % sample, code="argument")
    return sample, channel


def _merged(shape: tuple[int, ...], strides: tuple[int, ...]) -> tuple[int, int]:
    """How many of the innermost elements lie one stride apart, and that stride."""
    run, stride = 1, 0
    for size, step in zip(reversed(shape), reversed(strides)):
        if size == 1:
            continue
        if run > 1 and step != stride * run:
            return run, stride
        if run == 1:
            stride = step
        run *= size
    return run, stride


class Stack:
    """Values samples x ... x channels, with those two axes anywhere, as one list of texels in C order.

    sample_axis, channel_axis: which they are; channel_axis None: there is none, each value is a texel's only channel
    """

    def __init__(self, values: npt.ArrayLike, sample_axis: int, channel_axis: int | None) -> None:
        array = self._numbers(values)
        if array.ndim < (1 if channel_axis is None else 2):
            raise DataError("values must have an axis of samples%s, not shape %s" % (
                "" if channel_axis is None else " and one of channels", array.shape), code="argument")
        sample, channel = axes_of(sample_axis, channel_axis, array.ndim)
        if channel is None:
            array, channel = array[..., np.newaxis], array.ndim
        self.array = np.moveaxis(array, (sample, channel), (0, -1))
        self.spatial: tuple[int, ...] = self.array.shape[1:-1]
        self.samples, self.channels = self.array.shape[0], self.array.shape[-1]
        self.count = math.prod(self.spatial)
        self.run, self.stride = _merged(self.spatial, self.array.strides[1:-1])
        item = array.dtype.itemsize
        self.readable = (array.dtype.isnative and array.dtype.name in structs.TYPE and array.flags.aligned
                         and all(step % item == 0 for step in self.array.strides))

        self._rows = self._lay_out() if self.in_place and self.count > 0 else self.array

    @staticmethod
    def _numbers(values: npt.ArrayLike) -> Values:
        if isinstance(values, np.ma.MaskedArray):
            raise DataError("values is a masked array: pass its data, and which texels to use as mask", code="argument")
        try:
            array = np.asarray(values)
            if array.dtype.kind not in "fiub":
                array = np.asarray(array, dtype=object).astype(np.float64)
        except (TypeError, ValueError) as error:
            raise DataError("values is not an array of numbers (%s)" % error, code="value") from error
        return array

    @property
    def in_place(self) -> bool:
        """Whether the C library reads the caller's memory."""
        return self.readable and (self.run >= SHORT_RUN or self.run == self.count)

    def blocks(self, first: int, count: int) -> Iterator[Block]:
        """Texels [first, first + count), in order. Blocks are views where the C library can read the array, and
        copies of these texels alone where not."""
        if self.in_place:
            while count > 0:
                here = min(count, self.run - first % self.run)
                yield Block(self._view(first, here), first, here)
                first, count = first + here, count - here
        elif count > 0:
            yield Block(self._copy(first, count), first, count)

    def _lay_out(self) -> Values:
        """A view samples x outer axes x run x channels."""
        outer, inner = len(self.spatial), 1
        while outer > 0 and inner * self.spatial[outer - 1] <= self.run:
            outer -= 1
            inner *= self.spatial[outer]
        steps = self.array.strides
        shape = (self.samples, *self.spatial[:outer], self.run, self.channels)
        return np.lib.stride_tricks.as_strided(
            self.array, shape, (*steps[:1 + outer], self.stride, steps[-1]), writeable=False)

    def _view(self, first: int, count: int) -> Values:
        rows = self._rows
        start = first % self.run
        if rows.ndim == 3:
            return rows[:, start:start + count]
        outer = np.unravel_index(first // self.run, rows.shape[1:-2])
        part: Values = rows[of_all_samples((*outer, slice(start, start + count)))]
        return part

    def _copy(self, first: int, count: int) -> Values:
        if not self.spatial:
            part = self.array[:, np.newaxis]
        else:
            part = self.array[of_all_samples(np.unravel_index(np.arange(first, first + count), self.spatial))]
        kept = part.dtype.newbyteorder("=") if part.dtype.newbyteorder("=").name in structs.TYPE else np.float64
        return np.ascontiguousarray(part, dtype=kept)


def texel_mask(mask: npt.ArrayLike | None, spatial: tuple[int, ...]) -> npt.NDArray[np.uint8] | None:
    """A byte a texel, flat: 0 where `mask` is 0 or NaN."""
    if mask is None:
        return None
    unmasked("mask", mask)
    array = np.asarray(mask)
    if array.dtype.kind not in "fiub":
        raise DataError("mask must be of numbers or truth values, not %s" % array.dtype, code="value")
    if array.shape != spatial:
        raise DataError("mask must have shape %s, as the texels have, not %s" % (spatial, array.shape), code="argument")
    if array.dtype.kind == "f":
        array = (array > 0) | (array < 0)
    return np.ascontiguousarray(array.astype(bool, copy=False)).reshape(-1).view(np.uint8)
