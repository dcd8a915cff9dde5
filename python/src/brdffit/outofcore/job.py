"""One tile, from its values to the maps: what a worker runs. Everything here can be pickled.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ..errors import BrdffitError, DataError
from ..maps.fitmap import FitMap
from ..maps.memory import fit_array
from . import store
from .sources import StoredBlock
from .tiles import Region, shape_of

# Scheduler's topic under which workers tell when they begin and end a tile: client.get_events(TOPIC).
TOPIC = "brdffit-tile"


class Stopped(Exception):
    """The run ends before this tile does."""


class Tile:
    """Which texels, and what of the arguments is theirs alone."""

    def __init__(self, number: int, region: Region, own: Mapping[str, Any]) -> None:
        self.number, self.region, self.own = number, region, own


class TileJob:
    """What all tiles have in common. arguments: keywords of `fit_map`; group: where the maps go, or None.

    Neither of them is a dataclass: Dask looks into those, and there is nothing for it in here.
    """

    def __init__(self, arguments: Mapping[str, Any], fields: Sequence[store.Field], group: Any = None) -> None:
        self.arguments, self.fields, self.group = arguments, fields, group

    def fit(self, tile: Tile, values: Any, stopped: Callable[[], bool] | None = None) -> FitMap:
        """`stopped` is asked about ten times a second; once it is true, raises `Stopped`."""
        def ask(_: object) -> bool:
            return stopped is not None and stopped()

        try:
            # One thread of C for a thread of the scheduler: it knows how many processors there are.
            result: FitMap = fit_array(values, threads=1, progress=None if stopped is None else ask, **self.arguments,
                                       **tile.own)
        except BrdffitError as error:
            texel = getattr(error, "texel", None)
            if texel is not None:
                error.texel = tuple(part.start + i for part, i in zip(tile.region, texel))
            raise
        if ask(None):
            raise Stopped("stopped")
        if result.shape != shape_of(tile.region):  # would be spread over the tile
            raise DataError("a block of values has texels of shape %s, and should have %s" % (
                result.shape, shape_of(tile.region)), code="argument")
        return result

    def arrays(self, tile: Tile, block: Any) -> dict[str, Any]:
        """Of one tile, by name, to become chunks of Dask arrays; "": its row of counts."""
        result = self.fit(tile, _values(block))
        return {"": store.counts_of(result), **{field.name: np.asarray(getattr(result, field.name), field.dtype)
                                                for field in self.fields}}

    def store(self, tile: Tile, block: Any, stopped: Callable[[], bool] | None = None) -> list[int]:
        """Fit and write. A tile that is recorded already is not fitted again, but its values have to be those that it was
        fitted to: an earlier run did it, or a worker that died before its answer arrived. Returns the row of counts."""
        values = _values(block)
        data = store.checksum(np.asarray(values))
        row = store.recorded(self.group, tile.number)
        if row is None:
            _tell(tile.number, "begin")
            row = store.write_tile(self.group, tile.number, tile.region, self.fields, self.fit(tile, values, stopped), data)
            _tell(tile.number, "end")
        else:
            store.check_data(self.group, tile.number, data)
        return row


def _values(block: Any) -> Any:
    """What a tile is made from; masked arrays stay such, to be refused."""
    return block.load() if isinstance(block, StoredBlock) else np.asanyarray(block)


def run_store(job: TileJob, tile: Tile, block: Any) -> list[int]:
    return job.store(tile, block)


def run_arrays(job: TileJob, tile: Tile, block: Any) -> dict[str, Any]:
    return job.arrays(tile, block)


def pick(arrays: dict[str, Any], name: str) -> Any:
    return arrays[name]


def _tell(tile: int, what: str) -> None:
    """To the scheduler's log of events, on a worker of one."""
    if "distributed" in sys.modules:
        from distributed import get_worker

        try:
            worker = get_worker()
        except ValueError:
            return
        worker.log_event(TOPIC, {"tile": tile, "what": what, "pid": os.getpid()})
