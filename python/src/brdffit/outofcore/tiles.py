"""Tiles of texels: how a stack is cut up for machines, and what of the arguments a tile needs.

A tile has all samples and channels of its texels, since a fit needs them all. It is made of whole chunks of the stack
where it can be, so that each chunk is read once, and is one chunk of the maps, so that nobody else writes there.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import itertools
import math
import warnings
from typing import Any

import numpy as np
import numpy.typing as npt

from .._arguments import count_of
from ..errors import OptionError
from ..maps.arguments import TileArgument

# Texels of a tile: some tenths of a second of one-lobe fits, beside which a scheduler's milliseconds are nothing.
TILE_TEXELS = 65_536
# A tile is not made larger than this (bytes of its values) to spare a chunk a second reading.
TILE_BYTES = 2**30

Region = tuple[slice, ...]


class ChunkWarning(UserWarning):
    """The stack's chunks make it be read more than once."""


def _given(tile: TileArgument, spatial: tuple[int, ...]) -> tuple[int, ...] | None:
    """The shape of a tile, where the caller gave one."""
    if tile is None or isinstance(tile, int) or hasattr(tile, "__index__"):
        return None
    shape = tuple(tile)
    if len(shape) != len(spatial):
        raise OptionError("tile must have %d numbers, one a spatial axis, not %r" % (len(spatial), tile), code="option")
    return tuple(min(count_of("tile", one, 1), size) for one, size in zip(shape, spatial))


def tile_shape(spatial: tuple[int, ...], chunks: tuple[int, ...] | None, texel_bytes: int,
               tile: TileArgument) -> tuple[int, ...]:
    """At least `tile` texels (or just that shape), in whole chunks as far as TILE_BYTES allows."""
    given = _given(tile, spatial)
    if given is not None:
        return given
    wanted = count_of("tile", tile, TILE_TEXELS)  # type: ignore[arg-type]
    most = max(wanted, TILE_BYTES // max(1, texel_bytes))
    shape = [1] * len(spatial) if chunks is None else [min(c, s) for c, s in zip(chunks, spatial)]
    while math.prod(shape) > most:
        longest = shape.index(max(shape))
        shape[longest] = -(-shape[longest] // 2)
    for axis in reversed(range(len(spatial))):
        more = min(-(-wanted // math.prod(shape)), -(-spatial[axis] // shape[axis]))
        shape[axis] = min(shape[axis] * more, spatial[axis])
    return tuple(shape)


def warn_of_chunks(spatial: tuple[int, ...], chunks: tuple[int, ...], tile: tuple[int, ...], along_samples: int) -> None:
    """When tiles cut chunks: each is read once for every tile that it touches."""
    often = math.prod(max(1, min(-(-c // t), -(-s // t))) if t % c and t < s else 1
                      for c, t, s in zip(chunks, tile, spatial))
    if often > 1:
        along = ", %d of them along the samples" % along_samples if along_samples > 1 else ""
        warnings.warn("tiles of %s texels cut the stack's chunks of %s texels%s: each chunk is read about %d times. A "
                      "stack with all samples and fewer texels in a chunk is read once" %
                      (_by(tile), _by(chunks), along, often), ChunkWarning, stacklevel=6)


def _by(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape))


def regions(spatial: tuple[int, ...], tile: tuple[int, ...]) -> list[Region]:
    """Of all tiles, in C order."""
    cuts = [[slice(at, min(at + step, size)) for at in range(0, size, step)] for size, step in zip(spatial, tile)]
    return list(itertools.product(*cuts))


def shape_of(region: Region) -> tuple[int, ...]:
    return tuple(part.stop - part.start for part in region)


def stack_index(region: Region, sample_axis: int, channel_axis: int | None) -> Region:
    """The region of the stack itself: all samples and channels. Axes count from 0."""
    index = list(region)
    for axis in sorted(axis for axis in (sample_axis, channel_axis) if axis is not None):
        index.insert(axis, slice(None))
    return tuple(index)


def part(array: npt.NDArray[Any] | None, before: int, region: Region) -> npt.NDArray[Any] | None:
    """Of an array with `before` axes before the spatial ones, what a tile needs. What was broadcast is not multiplied."""
    if array is None:
        return None
    index = [slice(None)] * before + [slice(0, 1) if array.strides[before + i] == 0 and before > 0 else one
                                      for i, one in enumerate(region)]
    return np.ascontiguousarray(array[tuple(index)])
