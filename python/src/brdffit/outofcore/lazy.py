"""Maps as Dask arrays, which fit when they are computed. SPDX-License-Identifier: MIT"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from . import tiles
from .arrays import MapArrays
from .call import Call
from .job import TileJob, pick, run_arrays


def _nested(flat: Sequence[Any], counts: Sequence[int]) -> Any:
    """A list in C order as lists of lists."""
    for count in reversed(counts[1:]):
        flat = [list(flat[at:at + count]) for at in range(0, len(flat), count)]
    return list(flat)


def delayed(call: Call) -> MapArrays:
    import dask
    import dask.array

    token = dask.base.tokenize(call.manifest(mark=False), call.source.values)
    run, take = dask.delayed(run_arrays, pure=False), dask.delayed(pick, pure=False)
    blocks = call.source.blocks(call.tile, call.regions)
    common = dask.delayed(TileJob(call.arguments(), call.fields), name="brdffit-job-%s" % token, traverse=False)
    fitted = [run(common, call.tile_of(i), blocks[i], dask_key_name="brdffit-tile-%s-%d" % (token, i))
              for i in range(len(call.regions))]
    counts = [-(-size // step) for size, step in zip(call.source.spatial, call.tile)]
    arrays = {}
    for field in call.fields:
        parts = [dask.array.from_delayed(
            take(tile, field.name, dask_key_name="brdffit-%s-%s-%d" % (field.name, token, i)),
            (*tiles.shape_of(region), *field.shape), np.dtype(field.dtype))
            for i, (tile, region) in enumerate(zip(fitted, call.regions))]
        # block() joins along the last axes: those behind the spatial ones are one block each.
        nested = _nested(parts, counts)
        for _ in field.shape:
            nested = _wrap(nested, len(counts))
        arrays[field.name] = dask.array.block(nested)
    rows = [take(tile, "", dask_key_name="brdffit-counts-%s-%d" % (token, i)) for i, tile in enumerate(fitted)]
    return MapArrays(arrays, rows, call.about())


def _wrap(nested: Any, depth: int) -> Any:
    return [nested] if depth == 0 else [_wrap(one, depth - 1) for one in nested]
