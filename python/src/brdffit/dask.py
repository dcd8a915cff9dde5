"""Maps of stacks that are too large for one machine's memory or patience: zarr, Dask and xarray arrays, in tiles, in
threads or on the workers of a `distributed.Client`.

    import brdffit, zarr
    brdffit.fit_map(zarr.open("stack.zarr"), light, view, output="maps.zarr", client=client, progress=True)

`brdffit.fit_map` comes here by itself for such arrays, and for any when `output` or `client` is given.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import dataclasses
import math
import time
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from . import _batch, _labels, _run_tiles, _texelwise, _tiles
from . import _zarr_maps as store
from ._arrays import freeze
from ._geometry import DirectionsLike, Geometry, geometry
from ._labels import Labels
from ._pool import MapProgressArgument, Teller, count_of, processors
from ._sources import DaskSource, LazySource, NumpySource, Source, ZarrSource, kind
from ._tile_job import TOPIC, Tile, TileJob, pick, run_arrays
from ._tiles import ChunkWarning, Region, TileArgument
from .errors import OptionError
from .options import FitOptions, Options
from .samples import choose

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .maps import FitMap

__all__ = ["TOPIC", "ChunkWarning", "MapArrays", "fit_map", "is_scaled", "open_maps"]


def is_scaled(values: Any) -> bool:
    """Whether `values` is an array of zarr, Dask or xarray."""
    return kind(values) in ("zarr", "dask", "xarray")


class MapArrays(Mapping[str, Any]):
    """The arrays of a `FitMap` by name, which are not in memory: zarr arrays that were written, or Dask arrays that fit
    when they are computed (all together: `dask.compute(*maps.values())`; each alone would fit everything again).

    group: the zarr group, or None; options, quantity, samples: as of FitMap
    """

    def __init__(self, arrays: Mapping[str, Any], rows: Any, about: Mapping[str, Any], group: Any = None) -> None:
        self._arrays, self._rows, self._about, self.group = dict(arrays), rows, about, group
        self.options: Options = about["options"]
        self.quantity: str = about["quantity"]
        self.samples: int = about["samples"]

    def __getitem__(self, name: str) -> Any:
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_") and name in self._arrays:
            return self._arrays[name]
        raise AttributeError("MapArrays has no attribute %r" % name)

    def __repr__(self) -> str:
        where = "in %s" % self.group.store_path if self.group is not None else "to be computed"
        return "<MapArrays %s: %s>" % (where, ", ".join("%s %s" % (n, tuple(a.shape)) for n, a in self.items()))

    def load(self) -> FitMap:
        """Read, or compute, all of them into memory. seconds are those of a computation, 0 when they are read."""
        from .maps import FitMap

        began = time.perf_counter()
        if self.group is not None:
            arrays = {name: np.asarray(array[...]) for name, array in self.items()}
            rows, seconds = store.read_counts(self.group), 0.0
        else:
            import dask

            parts, found = dask.compute(self._arrays, self._rows)
            arrays, rows = parts, np.array(found, np.int64)
            seconds = time.perf_counter() - began
        rows = rows[rows[:, 0] >= 0]
        names = store.COUNTED
        total = [int(n) for n in rows.sum(axis=0)]
        skipped = total[len(names):] if self._about["own"] or not len(rows) else [int(n) for n in rows[0, len(names):]]
        allocated = _batch.allocate(0, 1, 1)
        shaped: dict[str, Any] = {name: freeze(np.ascontiguousarray(arrays[name], dtype=allocated[name].dtype))
                                  for name in allocated}
        out = FitMap(**shaped, samples=self.samples, samples_skipped=dict(zip(store.SKIPPED, skipped)),
                     quantity=self.quantity, options=self.options, stats={}, seconds=seconds)
        stats = dict(zip(names, total)) | out.counts | {"texels": int(out.status.size)}
        return dataclasses.replace(out, stats=stats)


def open_maps(path: Any) -> MapArrays:
    """What `fit_map` wrote to an output, finished or not: a path, URL, zarr store or group. xarray.open_zarr opens it too.

    Raises `DataError` when it holds something else, and zarr's own errors when there is nothing.
    """
    _need("zarr")
    group, about = store.find_maps(path)
    asked: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value for name, value in about["options"].items()}
    named = {field.name: group[field.stored] for field in store.fields(about["channels"], asked["lobes"])}
    return MapArrays(named, None, {"options": Options(**asked), "quantity": about["quantity"],
                                   "samples": about["samples"], "own": about["own"]}, group)


@dataclasses.dataclass(frozen=True)
class Call:
    """What was asked for, checked."""

    source: Source
    given: Geometry
    options: Options
    mask: npt.NDArray[np.uint8] | None
    scale: float
    errors: str
    tile: tuple[int, ...]
    regions: Sequence[Region]
    fields: Sequence[store.Field]

    def arguments(self) -> dict[str, Any]:
        """Of `brdffit.fit_map`, for all tiles."""
        shared = self.given.shared
        where: dict[str, Any] = {"light": shared}
        if self.given.own:
            where = {"weights": shared.weights, "quantity": shared.quantity}
            for name in ("light", "view"):
                if getattr(self.given, name) is None:
                    where[name] = getattr(shared, name)
            if self.given.normal is None and shared.normal is not None:
                where["normal"] = shared.normal[0]
        asked = {field.name: getattr(self.options, field.name) for field in dataclasses.fields(self.options)}
        return {**where, "scale": self.scale, "sample_axis": self.source.sample_axis,
                "channel_axis": self.source.channel_axis, "errors": self.errors, **asked}

    def tile_of(self, number: int) -> Tile:
        """With the arguments that are its own."""
        region, given = self.regions[number], self.given
        mask = None if self.mask is None else self.mask.reshape(self.source.spatial)
        own = {"light": _tiles.part(given.light, 1, region), "view": _tiles.part(given.view, 1, region),
               "normal": _tiles.part(given.normal, 0, region), "mask": _tiles.part(mask, 0, region)}
        return Tile(number, region, {name: array for name, array in own.items() if array is not None})

    def about(self) -> dict[str, Any]:
        return {"options": self.options, "quantity": self.given.shared.quantity, "samples": self.source.samples,
                "own": self.given.own}

    def manifest(self, mark: bool) -> dict[str, Any]:
        s, shared = self.source, self.given.shared
        return store.manifest(
            dataclasses.asdict(self.options), spatial=list(s.spatial), samples=s.samples, channels=s.channels,
            type=s.dtype.str, tile=list(self.tile), quantity=shared.quantity, scale=self.scale, own=self.given.own,
            directions=_batch._content(shared).hex() + store.digest(self.given.light, self.given.view, self.given.normal),
            mask=store.digest(self.mask), **({"values": store.digest(*s.marks())} if mark else {}))


def _need(package: str) -> None:
    try:
        __import__(package)
    except ImportError as error:
        raise ImportError("%s is needed here: pip install 'brdffit[dask]'" % package) from error


def _source(values: Any, sample_axis: Any, channel_axis: Any) -> Source:
    found = kind(values)
    kinds = {"zarr": ZarrSource, "dask": DaskSource, "brdffit": LazySource}
    source: Source = kinds.get(found or "", NumpySource)(values, sample_axis, channel_axis)
    return source


def _check(source: Source, given: Geometry, options: Options) -> None:
    """What no tile could do fails here, before any is sent."""
    if given.own:
        _texelwise.check(given, source.samples, source.channels, options)
    else:
        _batch.plan_for(given.shared, source.channels, options)


def prepare(source: Source, light: DirectionsLike, view: Any, normal: Any, weights: Any, mask: Any,
             quantity: str | None, scale: float, errors: str, tile: TileArgument, options: Options) -> Call:
    given = geometry(light, view, normal, weights, quantity, source.samples, source.spatial)
    flags = _batch.texel_mask(mask, source.spatial)
    _check(source, given, options)
    shape = source.cut(tile)
    return Call(source, given, options, flags, _batch.positive("scale", scale), errors, shape,
                 _tiles.regions(source.spatial, shape), store.fields(source.channels, options.lobes))


# ---- With an output: now, tile by tile -------------------------------------------------------------------------------


def _layout(call: Call, labels: Labels) -> store.Layout:
    return store.Layout(call.source.spatial, call.tile, len(call.regions), call.fields, labels.spatial, labels.renamed,
                        call.manifest(mark=True))


def _write(call: Call, labels: Labels, output: Any, overwrite: bool, client: Any, threads: int | None, retries: int,
           progress: MapProgressArgument) -> MapArrays:
    inside = call.source.values if isinstance(call.source, ZarrSource) else None
    group, _ = store.open_maps(output, _layout(call, labels), overwrite, inside)
    if client is not None:
        store.need_shared(group)
    labels.write(group)
    there = store.read_counts(group)[:, 0] >= 0
    sizes = [math.prod(_tiles.shape_of(region)) for region in call.regions]
    blocks = call.source.blocks(call.tile, call.regions)
    missing = [int(i) for i in np.flatnonzero(~there)]
    work = ((call.tile_of(i), blocks[i]) for i in missing)
    teller = Teller(progress, sum(sizes))
    try:
        _run_tiles.run(TileJob(call.arguments(), call.fields, group), work, client,
                       min(count_of("threads", threads, processors()), max(1, len(missing))), retries,
                       sum(sizes) - sum(sizes[i] for i in missing), teller, lambda tile: sizes[tile.number])
    finally:
        teller.close()
    return MapArrays({field.name: group[field.stored] for field in call.fields}, None, call.about(), group)


# ---- Without: Dask arrays --------------------------------------------------------------------------------------------


def _nested(flat: Sequence[Any], counts: Sequence[int]) -> Any:
    """A list in C order as lists of lists."""
    for count in reversed(counts[1:]):
        flat = [list(flat[at:at + count]) for at in range(0, len(flat), count)]
    return list(flat)


def _lazy(call: Call) -> MapArrays:
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
            (*_tiles.shape_of(region), *field.shape), np.dtype(field.dtype))
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


# ---- The call --------------------------------------------------------------------------------------------------------


def fit_map(values: Any, light: DirectionsLike, view: npt.ArrayLike | None = None, *,
            normal: npt.ArrayLike | None = None, weights: npt.ArrayLike | None = None,
            mask: npt.ArrayLike | None = None, quantity: str | None = None, scale: float = 1.0,
            sample_axis: int | str = 0, channel_axis: int | str | None = -1, threads: int | None = None,
            tile: TileArgument = None, errors: str = "status", progress: MapProgressArgument = None,
            output: Any = None, client: Any = None, overwrite: bool = False, retries: int = 3,
            **options: Unpack[FitOptions]) -> Any:
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
        sample_axis, channel_axis = (_labels.axis_of(n, a, dims) for n, a in (("sample_axis", sample_axis),
                                                                       ("channel_axis", channel_axis)))
        values = _data(wrapped, sample_axis, channel_axis, tile, output is not None or bool(client))
    source = _source(values, sample_axis, channel_axis)
    labels = _labels.plain(source) if wrapped is None else _labels.of_xarray(wrapped, source)
    call = prepare(source, light, view, normal, weights, mask, quantity, scale, errors, tile, asked)
    labels.check(call.fields)
    if output is not None:
        return _write_all(call, labels, wrapped, output, overwrite, client, threads, retries, progress)
    if wrapped is not None and isinstance(source, NumpySource):
        return _here(call, labels, threads, progress)
    if progress is not None or threads is not None or client:
        raise OptionError("progress, threads and client need output: without it nothing is fitted before the arrays are "
                          "computed", code="option")
    _need("dask")
    maps = _lazy(call)
    return maps if wrapped is None else _labels.dataset(maps, call.fields, labels, call.manifest(mark=False))


def _write_all(call: Call, labels: Labels, wrapped: Any, output: Any, overwrite: bool, client: Any,
               threads: int | None, retries: int, progress: MapProgressArgument) -> Any:
    _need("zarr")
    client = _run_tiles.find_client(client)
    if client is not None and threads is not None:
        raise OptionError("threads are those of the client's workers: give it none, or client=False", code="option")
    maps = _write(call, labels, output, overwrite, client, threads, retries, progress)
    return maps if wrapped is None else _labels.dataset(maps, call.fields, labels, None)


def _here(call: Call, labels: Labels, threads: int | None, progress: MapProgressArgument) -> Any:
    """A DataArray in memory, without output or client: as brdffit.fit_map does."""
    from .maps import fit_map as local

    call = dataclasses.replace(call, regions=[tuple(slice(0, size) for size in call.source.spatial)])
    maps = local(call.source.values, threads=threads, progress=progress, **call.arguments(), **call.tile_of(0).own)
    return _labels.dataset(maps, call.fields, labels, call.manifest(mark=False))


def _data(wrapped: Any, sample_axis: Any, channel_axis: Any, tile: TileArgument, elsewhere: bool) -> Any:
    """The array behind a DataArray. What is not read yet stays so: each tile is read where it is fitted."""
    if wrapped.chunks is not None:
        return wrapped.data
    if not elsewhere:
        return np.asarray(wrapped)
    _need("dask")
    chunks = wrapped.encoding.get("chunks")
    shape = Source(wrapped.variable, sample_axis, channel_axis, chunks)
    sizes = dict(zip(shape.axes, shape.cut(tile)))
    return wrapped.chunk({dim: sizes.get(axis, -1) for axis, dim in enumerate(wrapped.dims)}).data
