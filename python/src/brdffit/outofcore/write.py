"""Maps into a zarr group, tile by tile: those that are not there yet. Of those that are, the values are looked at.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from .._arguments import count_of, processors
from ..maps.pool import MapProgressArgument, Teller
from . import store, tiles
from .arrays import MapArrays
from .call import Call
from .job import TileJob
from .labels import Labels
from .run import run
from .sources import ZarrSource


def _layout(call: Call, labels: Labels) -> store.Layout:
    return store.Layout(call.source.spatial, call.tile, len(call.regions), call.fields, labels.spatial, labels.renamed,
                        call.manifest(mark=True))


def write(call: Call, labels: Labels, output: Any, overwrite: bool, client: Any, threads: int | None, retries: int,
          progress: MapProgressArgument) -> MapArrays:
    inside = call.source.values if isinstance(call.source, ZarrSource) else None
    group, _ = store.open_maps(output, _layout(call, labels), overwrite, inside)
    if client is not None:
        store.need_shared(group)
    labels.write(group)
    there = store.read_counts(group)[:, 0] >= 0
    sizes = [math.prod(tiles.shape_of(region)) for region in call.regions]
    blocks = call.source.blocks(call.tile, call.regions)
    # What is there first: whether it is of these values is known before anything is fitted.
    order = [int(i) for i in (*np.flatnonzero(there), *np.flatnonzero(~there))]
    work = ((call.tile_of(i), blocks[i]) for i in order)
    new = [0 if done else size for done, size in zip(there, sizes)]
    teller = Teller(progress, sum(sizes))
    try:
        run(TileJob(call.arguments(), call.fields, group), work, client,
            min(count_of("threads", threads, processors()), max(1, len(order))), retries, sum(sizes) - sum(new), teller,
            lambda tile: new[tile.number])
    finally:
        teller.close()
    return MapArrays({field.name: group[field.stored] for field in call.fields}, None, call.about(), group)
