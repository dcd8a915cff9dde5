"""Stacks in files that may be larger than the memory: fitted a band of rows at a time, the next one read meanwhile.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import concurrent.futures
import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy.typing as npt

from .._arguments import count_of
from .._arrays import freeze
from ..errors import BrdffitError
from ..maps.arguments import TileArgument
from ..maps.fitmap import FitMap
from ..maps.memory import fit_array
from ..maps.pool import MapProgress, MapProgressArgument, Teller
from ..maps.results import NOT_REACHED, Arrays, allocate, blank, shaped, terms_of
from ..options import FitOptions, Options
from .call import Call, prepare
from .sources import LazySource

BAND_BYTES = 1 << 27  # one is fitted while the next is read


class _Told:
    """Progress of one band as that of the whole; remembers a wish to stop."""

    def __init__(self, progress: MapProgressArgument, total: int) -> None:
        self.teller, self.before, self.stopped = Teller(progress, total), 0, False

    def __call__(self, moment: MapProgress) -> bool:
        self.stopped |= self.teller.tell(self.before + moment.done)
        return self.stopped


def _rows(source: LazySource, tile: TileArgument) -> int:
    """Of a band: the first number of a tile's shape, or as many as BAND_BYTES hold, in whole blocks of the file."""
    if isinstance(tile, Sequence):
        return count_of("rows", tile[0], 1)
    rows = max(1, BAND_BYTES // (source.samples * source.spatial[1] * source.channels * source.dtype.itemsize))
    block = source.values.rows_together
    return int(rows // block * block or rows)


def fit_bands(values: Any, light: Any, view: Any, *, normal: Any, weights: Any, mask: Any, quantity: str | None,
              scale: float, sample_axis: Any, channel_axis: Any, threads: int | None, tile: TileArgument, errors: str,
              progress: MapProgressArgument, options: FitOptions) -> FitMap:
    """`brdffit.fit_map` of a LazyArray, with the same bits. tile may be a shape: its rows make a band."""
    source = LazySource(values, sample_axis, channel_axis)
    width = source.spatial[1]
    call = prepare(source, light, view, normal, weights, mask, quantity, scale, errors, (_rows(source, tile), width),
                   Options(**options)._plain())
    told, parts, whole = _Told(progress, source.spatial[0] * width), [], None
    inner = None if isinstance(tile, Sequence) else tile
    with concurrent.futures.ThreadPoolExecutor(1) as reader:
        try:
            blocks = source.blocks(call.tile, call.regions)
            ahead = reader.submit(blocks[0].load)
            for at, region in enumerate(call.regions):
                band = ahead.result()
                if at + 1 < len(blocks):
                    ahead = reader.submit(blocks[at + 1].load)
                told.before = region[0].start * width
                part = _fit(call, at, band, threads, inner, told if told.teller.listens else None)
                whole = whole or _nothing(source, part.options)
                _put(whole, part, told.before)
                parts.append(dataclasses.replace(part, **{name: getattr(part, name)[:0] for name in whole}))
                if told.stopped:
                    break
        finally:
            told.teller.close()
    assert whole is not None
    return _join(parts, shaped(whole, source.spatial), call.given.own)


def _fit(call: Call, number: int, values: npt.NDArray[Any], threads: int | None, tile: TileArgument,
         progress: MapProgressArgument) -> FitMap:
    try:
        return fit_array(values, threads=threads, tile=tile, progress=progress, **call.arguments(), **call.tile_of(number).own)
    except BrdffitError as error:
        if error.texel is not None:
            error.texel = (error.texel[0] + call.regions[number][0].start, *error.texel[1:])
        raise


def _nothing(source: LazySource, options: Options) -> Arrays:
    arrays = allocate(source.spatial[0] * source.spatial[1], source.channels, options.lobe_count,
                      **terms_of(options))
    blank(arrays, slice(None), NOT_REACHED)
    return arrays


def _put(whole: Arrays, part: FitMap, first: int) -> None:
    for name, array in whole.items():
        one = getattr(part, name)
        array[first:first + one.shape[0] * one.shape[1]] = one.reshape(-1, *array.shape[1:])


def _join(parts: list[FitMap], arrays: Mapping[str, npt.NDArray[Any]], own: bool) -> FitMap:
    """The arrays of all and the sums of the rest. Skipped samples are the same in each band, unless texels differ."""
    skipped = parts[0].samples_skipped
    if own:
        skipped = {name: sum(part.samples_skipped[name] for part in parts) for name in skipped}
    frozen: dict[str, Any] = {name: freeze(array) for name, array in arrays.items()}
    out = dataclasses.replace(parts[0], **frozen, samples_skipped=skipped, seconds=sum(part.seconds for part in parts))
    counted = {name: sum(part.stats[name] for part in parts) for name in parts[0].stats}
    return dataclasses.replace(out, stats={**counted, **out.counts, "texels": out.status.size})
