"""Maps of stacks that are too large for one machine's memory or patience: zarr, Dask and xarray arrays, in tiles, in
threads or on the workers of a `distributed.Client`.

    import brdffit, zarr
    brdffit.fit_map(zarr.open("stack.zarr"), light, view, output="maps.zarr", client=client, progress=True)

`brdffit.fit_map` comes here by itself for such arrays, and for any when `output` or `client` is given.

SPDX-License-Identifier: MIT
"""
from .outofcore.arrays import MapArrays, open_maps
from .outofcore.fit import fit_map
from .outofcore.job import TOPIC
from .outofcore.sources import is_scaled
from .outofcore.tiles import ChunkWarning

__all__ = ["TOPIC", "ChunkWarning", "MapArrays", "fit_map", "is_scaled", "open_maps"]
