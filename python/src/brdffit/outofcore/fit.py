"""`fit_map` for stacks that are not in memory. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, overload

import numpy as np
import numpy.typing as npt

from .._arguments import choose
from ..errors import OptionError
from ..maps.arguments import LabelledArray, MapOptions, TileArgument, TiledArray
from ..maps.geometry import DirectionsLike
from ..maps.memory import fit_array
from ..maps.pool import MapProgressArgument
from ..options import FitOptions, Options
from . import labels as labelling
from .arrays import MapArrays, need
from .call import Call, prepare
from .labels import Labels
from .lazy import delayed
from .run import find_client
from .sources import NumpySource, Source, kind, source_of
from .write import write

if TYPE_CHECKING:
    import xarray
    from typing_extensions import Unpack


@overload
def fit_map(values: LabelledArray, light: DirectionsLike, view: npt.ArrayLike | None = None, *, output: Any = None,
            **options: Unpack[MapOptions]) -> xarray.Dataset: ...


@overload
def fit_map(values: TiledArray | npt.ArrayLike, light: DirectionsLike, view: npt.ArrayLike | None = None, *,
            output: Any = None, **options: Unpack[MapOptions]) -> MapArrays: ...


def fit_map(values: Any, light: DirectionsLike, view: npt.ArrayLike | None = None, *,
            normal: npt.ArrayLike | None = None, weights: npt.ArrayLike | None = None,
            mask: npt.ArrayLike | None = None, quantity: str | None = None, scale: float = 1.0,
            sample_axis: int | str = 0, channel_axis: int | str | None = -1, threads: int | None = None,
            tile: TileArgument = None, errors: str = "status", progress: MapProgressArgument = None,
            output: Any = None, client: Any = None, overwrite: bool = False, retries: int = 3,
            **options: Unpack[FitOptions]) -> MapArrays | xarray.Dataset:
    """`brdffit.fit_map` for stacks that are not in memory, with the same bits.

    values: a zarr array (opened by the worker: its numbers never pass through here), a Dask array, an xarray DataArray
        (axes also by the names of their dimensions), or, with output or client, anything that brdffit.fit_map takes
    tile: at least so many texels go to a worker at a time (default 65,536), in whole chunks of the stack; or a shape,
        one number a spatial axis. A tile has all samples: chunks along samples are joined
    output: path, URL, zarr store or group. Maps are written there tile by tile, in zarr format 3, each tile a chunk of
        its own. Finished tiles are recorded: after Ctrl-C, a crash or a lost cluster the same call does those that are
        missing. Other arguments, or another stack (told by its shape, type and three texels), are refused
    overwrite: replace maps of another run in `output`; where anything else lies there it is refused
    client: a distributed.Client; None: the active one, if there is one; False: none. Without one, `threads` threads of
        this process (default: as many as processors) do it
    retries: how often a client repeats a tile that failed. A worker that dies costs the tiles that it was at
    progress: as for brdffit.fit_map, called after each tile; needs output

    Each worker's thread runs one thread of C, so workers are as busy as their nthreads say.

    Returns, with output, a `MapArrays` of zarr arrays; without, one of Dask arrays that fit when computed; and for a
    DataArray an xarray Dataset with its dimensions and coordinates.

    Raises as brdffit.fit_map does, and `DataError` when `output` holds something else.
    """
    asked = Options(**options)._plain()
    choose("errors", errors, ("status", "raise"))
    wrapped = values if kind(values) == "xarray" else None
    if wrapped is not None:
        dims = tuple(str(dim) for dim in wrapped.dims)
        sample_axis, channel_axis = (labelling.axis_of(name, axis, dims) for name, axis in (
            ("sample_axis", sample_axis), ("channel_axis", channel_axis)))
        values = _data(wrapped, sample_axis, channel_axis, tile, output is not None or bool(client))
    source = source_of(values, sample_axis, channel_axis)
    labels = labelling.plain(source) if wrapped is None else labelling.of_xarray(wrapped, source)
    call = prepare(source, light, view, normal, weights, mask, quantity, scale, errors, tile, asked)
    labels.check(call.fields)
    if output is not None:
        return _write_all(call, labels, wrapped, output, overwrite, client, threads, retries, progress)
    if wrapped is not None and isinstance(source, NumpySource):
        return _here(call, labels, threads, progress)
    if progress is not None or threads is not None or client:
        raise OptionError("progress, threads and client need output: without it nothing is fitted before the arrays are "
                          "computed", code="option")
    need("dask")
    maps = delayed(call)
    return maps if wrapped is None else labelling.dataset(maps, call.fields, labels, call.manifest(mark=False))


def _write_all(call: Call, labels: Labels, wrapped: Any, output: Any, overwrite: bool, client: Any,
               threads: int | None, retries: int, progress: MapProgressArgument) -> MapArrays | xarray.Dataset:
    need("zarr")
    client = find_client(client)
    if client is not None and threads is not None:
        raise OptionError("threads are those of the client's workers: give it none, or client=False", code="option")
    maps = write(call, labels, output, overwrite, client, threads, retries, progress)
    return maps if wrapped is None else labelling.dataset(maps, call.fields, labels, None)


def _here(call: Call, labels: Labels, threads: int | None, progress: MapProgressArgument) -> xarray.Dataset:
    """A DataArray in memory, without output or client: as brdffit.fit_map does."""
    call = dataclasses.replace(call, regions=[tuple(slice(0, size) for size in call.source.spatial)])
    maps = fit_array(call.source.values, threads=threads, progress=progress, **call.arguments(), **call.tile_of(0).own)
    return labelling.dataset(maps, call.fields, labels, call.manifest(mark=False))


def _data(wrapped: Any, sample_axis: Any, channel_axis: Any, tile: TileArgument, elsewhere: bool) -> Any:
    """The array behind a DataArray. What is not read yet stays so: each tile is read where it is fitted."""
    if wrapped.chunks is not None:
        return wrapped.data
    if not elsewhere:
        return np.asarray(wrapped)
    need("dask")
    chunks = wrapped.encoding.get("chunks")
    shape = Source(wrapped.variable, sample_axis, channel_axis, chunks)
    sizes = dict(zip(shape.axes, shape.cut(tile)))
    return wrapped.chunk({dim: sizes.get(axis, -1) for axis, dim in enumerate(wrapped.dims)}).data
