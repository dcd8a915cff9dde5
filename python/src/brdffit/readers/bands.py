"""Stacks that are larger than the memory: fitted a band of rows at a time. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import concurrent.futures
import dataclasses
from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from .. import _batch
from .._arrays import freeze
from .._pool import MapProgress, MapProgressArgument, Teller, count_of
from ..errors import BrdffitError
from ..maps import FitMap, fit_map
from .stack import Stack

BAND_BYTES = 1 << 27  # one is fitted while the next is read


def default_rows(stack: Stack) -> int:
    """As many as BAND_BYTES hold, and whole blocks of the file if it holds one."""
    values = stack.values
    count, _, width, channels = values.shape
    rows = max(1, BAND_BYTES // (count * width * channels * values.dtype.itemsize))
    block = getattr(values, "rows_together", 1)
    return int(rows // block * block or rows)


class _Told:
    """Progress of one band as that of the whole; remembers a wish to stop."""

    def __init__(self, progress: MapProgressArgument, total: int) -> None:
        self.teller, self.before, self.stopped = Teller(progress, total), 0, False

    def __call__(self, moment: MapProgress) -> bool:
        self.stopped |= self.teller.tell(self.before + moment.done)
        return self.stopped


def fit_bands(stack: Stack, rows: int | None, progress: MapProgressArgument, options: Mapping[str, Any]) -> FitMap:
    """See Stack.fit_map."""
    _, height, width, channels = stack.values.shape
    step = count_of("rows", rows, default_rows(stack))
    told, parts, whole = _Told(progress, height * width), [], None
    bands = [slice(first, min(first + step, height)) for first in range(0, height, step)]
    with concurrent.futures.ThreadPoolExecutor(1) as reader:
        try:
            ahead = reader.submit(_read, stack, bands[0])
            for at, band in enumerate(bands):
                values = ahead.result()
                if at + 1 < len(bands):
                    ahead = reader.submit(_read, stack, bands[at + 1])
                told.before = band.start * width
                part = _fit(stack, band, values, told if told.teller.listens else None, options)
                if whole is None:
                    whole = _batch.allocate(height * width, channels, part.lobes)
                    _batch.blank(whole, slice(None), _batch.NOT_REACHED)
                for name, array in whole.items():
                    array[band.start * width:band.stop * width] = getattr(part, name).reshape(-1, *array.shape[1:])
                parts.append(dataclasses.replace(part, **{name: getattr(part, name)[:0] for name in whole}))
                if told.stopped:
                    break
        finally:
            told.teller.close()
    assert whole is not None
    return _join(parts, _batch.shaped(whole, (height, width)), own=stack.normal is not None)


def _read(stack: Stack, band: slice) -> npt.NDArray[Any]:
    return np.asarray(stack.values[:, band])


def _fit(stack: Stack, band: slice, values: npt.NDArray[Any], progress: MapProgressArgument, options: Mapping[str, Any]) -> FitMap:
    try:
        return fit_map(values, stack.light, stack.view, normal=None if stack.normal is None else stack.normal[band],
                       mask=None if stack.mask is None else stack.mask[band], quantity=stack.quantity, progress=progress,
                       **options)
    except BrdffitError as error:
        if error.texel is not None:
            error.texel = (error.texel[0] + band.start, *error.texel[1:])
        error.path = error.path or stack.file
        raise


def _join(parts: list[FitMap], arrays: Mapping[str, npt.NDArray[Any]], own: bool) -> FitMap:
    """The arrays of all and the sums of the rest. Skipped samples are the same in each band, unless texels differ."""
    skipped = parts[0].samples_skipped
    if own:
        skipped = {name: sum(part.samples_skipped[name] for part in parts) for name in skipped}
    frozen: dict[str, Any] = {name: freeze(array) for name, array in arrays.items()}
    out = dataclasses.replace(parts[0], **frozen, samples_skipped=skipped, seconds=sum(part.seconds for part in parts))
    counted = {name: sum(part.stats[name] for part in parts) for name in parts[0].stats}
    return dataclasses.replace(out, stats={**counted, **out.counts, "texels": out.status.size})
