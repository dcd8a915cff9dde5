"""Stacks that are too large for memory, or elsewhere: zarr, Dask and xarray arrays, and images in files, each as tiles.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import DataError
from ..maps.arguments import TileArgument
from ..maps.stack import Stack, axes_of
from . import tiles
from .tiles import Region


def kind(values: Any) -> str | None:
    """"zarr", "dask", "xarray" or "brdffit" (`load_stack`'s), without importing any of them; None: something else."""
    for base in type(values).__mro__:
        package = base.__module__.partition(".")[0]
        if (package, base.__name__) in (("zarr", "Array"), ("dask", "Array"), ("xarray", "DataArray"),
                                         ("brdffit", "LazyArray")):
            return package
    return None


def is_scaled(values: Any) -> bool:
    """Whether `values` is an array of zarr, Dask or xarray."""
    return kind(values) in ("zarr", "dask", "xarray")


class StoredBlock:
    """A tile's values, which the worker reads itself: only the place travels."""

    def __init__(self, array: Any, index: Region) -> None:
        self.array, self.index = array, index

    def load(self) -> Any:
        return self.array[self.index]


class Source:
    """A stack by its shape. Axes count from 0; chunks are those of the spatial axes, where the stack has any."""

    warns = True  # when tiles cut chunks: who made the stack could have made others

    def __init__(self, values: Any, sample_axis: Any, channel_axis: Any, chunks: Sequence[int] | None) -> None:
        dims = values.ndim
        self.values = values
        self.dtype = np.dtype(values.dtype)
        if self.dtype.kind not in "fiub":
            raise DataError("values must be numbers, not %s" % self.dtype, code="value")
        self.sample_axis, self.channel_axis = axes_of(sample_axis, channel_axis, dims)
        self.axes = tuple(a for a in range(dims) if a not in (self.sample_axis, self.channel_axis))
        if not self.axes:
            raise DataError("values of shape %s have no spatial axis" % (values.shape,), code="argument")
        self.spatial: tuple[int, ...] = tuple(int(values.shape[a]) for a in self.axes)
        self.samples = int(values.shape[self.sample_axis])
        self.channels = 1 if self.channel_axis is None else int(values.shape[self.channel_axis])
        if 0 in values.shape:
            raise DataError("values of shape %s have no texel" % (values.shape,), code="argument")
        self.chunks = None if chunks is None else tuple(int(chunks[a]) for a in self.axes)
        self.along_samples = 1 if chunks is None else -(-self.samples // max(1, int(chunks[self.sample_axis])))

    def cut(self, tile: TileArgument) -> tuple[int, ...]:
        """The shape of a tile."""
        texel = self.samples * self.channels * self.dtype.itemsize
        shape = tiles.tile_shape(self.spatial, self.chunks, texel, tile)
        if self.chunks is not None and self.warns:
            tiles.warn_of_chunks(self.spatial, self.chunks, shape, self.along_samples)
        return shape

    def index(self, region: Region) -> Region:
        return tiles.stack_index(region, self.sample_axis, self.channel_axis)

    def blocks(self, tile: tuple[int, ...], regions: Sequence[Region]) -> list[Any]:
        """What a worker makes the values of each tile from."""
        raise NotImplementedError

    def part(self, region: Region) -> npt.NDArray[Any]:
        """Some texels, here and now."""
        return np.asarray(self.values[self.index(region)])

    def marks(self) -> list[npt.NDArray[Any]]:
        """The first, the middle and the last texel: stacks that differ are told apart by them, if not surely."""
        places = {tuple(0 for _ in self.spatial), tuple(s // 2 for s in self.spatial), tuple(s - 1 for s in self.spatial)}
        return [self.part(tuple(slice(i, i + 1) for i in place)) for place in sorted(places)]


class NumpySource(Source):
    def __init__(self, values: npt.ArrayLike, sample_axis: Any, channel_axis: Any) -> None:
        Stack(values, sample_axis, channel_axis)  # says what it cannot be
        super().__init__(np.asarray(values), sample_axis, channel_axis, None)

    def blocks(self, tile: tuple[int, ...], regions: Sequence[Region]) -> list[Any]:
        return [self.values[self.index(region)] for region in regions]


class StoredSource(Source):
    """Its values are read where a tile is fitted."""

    def blocks(self, tile: tuple[int, ...], regions: Sequence[Region]) -> list[Any]:
        return [StoredBlock(self.values, self.index(region)) for region in regions]


class ZarrSource(StoredSource):
    def __init__(self, values: Any, sample_axis: Any, channel_axis: Any) -> None:
        super().__init__(values, sample_axis, channel_axis, values.chunks)


class LazySource(StoredSource):
    """What `load_stack` gives: samples x height x width x channels."""

    warns = False

    def __init__(self, values: Any, sample_axis: Any, channel_axis: Any) -> None:
        _, height, width, channels = values.shape
        super().__init__(values, sample_axis, channel_axis, (1, min(values.rows_together, height), width, channels))
        if (self.sample_axis, self.channel_axis) != (0, 3):
            raise DataError("the stack in files has its samples on axis 0 and its channels on axis 3", code="argument")


class DaskSource(Source):
    def __init__(self, values: Any, sample_axis: Any, channel_axis: Any) -> None:
        if any(size != size for size in values.shape):
            raise DataError("values have chunks of unknown size: call compute_chunk_sizes() first", code="argument")
        super().__init__(values, sample_axis, channel_axis, [max(sizes) for sizes in values.chunks])

    def blocks(self, tile: tuple[int, ...], regions: Sequence[Region]) -> list[Any]:
        chunks = dict(zip(self.axes, tile))
        whole = self.values.rechunk({a: chunks.get(a, -1) for a in range(self.values.ndim)})
        return list(whole.to_delayed().reshape(-1))

    def part(self, region: Region) -> npt.NDArray[Any]:
        return np.asarray(self.values[self.index(region)].compute())


def source_of(values: Any, sample_axis: Any, channel_axis: Any) -> Source:
    found = kind(values)
    kinds = {"zarr": ZarrSource, "dask": DaskSource, "brdffit": LazySource}
    source: Source = kinds.get(found or "", NumpySource)(values, sample_axis, channel_axis)
    return source
