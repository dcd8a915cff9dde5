"""Every texel of a stack of images fitted, each with its own proof. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import os
import time
from typing import TYPE_CHECKING, Any, Mapping, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import dask as scaled
from . import _batch, _map_eval, _map_files, _map_words, _texelwise
from . import _structs as structs
from ._arrays import Floats, Frozen, floats, freeze
from ._geometry import DirectionsLike, Geometry, geometry
from ._pool import MapProgressArgument, Pool, Teller, count_of, processors, tiles_of
from ._sources import kind
from ._stack import Stack
from ._tiles import TileArgument
from .errors import BrdffitError
from .fit import run
from .options import FitOptions, Options
from .samples import Samples, choose

if TYPE_CHECKING:
    from typing_extensions import Unpack

STATUS = _batch.STATUS
STOP = (*structs.STOP, "none")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class FitMap(Frozen):
    """Fitted models and certificates of many texels. S stands for the spatial shape of the values, K for channels, P for
    lobes. Texels that were not fitted have NaN in every floating-point array. Arrays cannot be written to.

    sigma: S x P roughnesses, ascending (1/sqrt(n) where the distribution is known by its exponent n: see `exponent`)
    x: S x K diffuse coefficients; y: S x K x P specular ones, both in the data's units
    channel_scale: S x K divisors: e2, lower_bound and sum_of_squares are in units of the values divided by them
    e2: S, what the norm minimises; lower_bound: S, proven: no model of this form has less; gap: e2 - lower_bound
    sum_of_squares: S, e2 of the zero model
    status: S, bytes that index `FitMap.STATUS`: 0 "certified", 1 "open" (the search stopped early; fit and bound are
        valid), 2 "no_signal" (all values 0: so is the model, proven), 3 "masked", 4 "bad_value" (NaN or infinite),
        5 "refused" (a fit of it alone would fail), 6 "no_samples" (its own directions leave none), 7 "not_reached"
        (the run was stopped)
    stop: S, bytes that index `FitMap.STOP`: why the search of a certified or open texel ended; 7 "none" for others
    where: S, of a bad value: sample * K + channel; else -1
    boxes: S, how many the search bounded
    samples: of each texel; samples_skipped: by reason, of each texel; summed over texels with directions of their own
    quantity, options: what was asked for
    stats: how many texels have each status, and what was done or saved: equal (to the texel before), general, boxes ...
        as of brdffit_many_stats in brdffit.h
    seconds: of the fits, on the clock
    """

    sigma: Floats
    x: Floats
    y: Floats
    channel_scale: Floats
    e2: Floats
    lower_bound: Floats
    sum_of_squares: Floats
    status: npt.NDArray[np.uint8]
    stop: npt.NDArray[np.uint8]
    where: npt.NDArray[np.intp]
    boxes: npt.NDArray[np.intp]
    samples: int
    samples_skipped: Mapping[str, int]
    quantity: str
    options: Options
    stats: Mapping[str, int]
    seconds: float

    STATUS = STATUS
    STOP = STOP

    @property
    def shape(self) -> tuple[int, ...]:
        """S."""
        return self.status.shape

    @property
    def channels(self) -> int:
        """K."""
        return int(self.x.shape[-1])

    @property
    def lobes(self) -> int:
        """P."""
        return int(self.sigma.shape[-1])

    @property
    def gap(self) -> Floats:
        """S: e2 - lower_bound, at least 0."""
        return np.maximum(self.e2 - self.lower_bound, 0.0)

    @property
    def exponent(self) -> Floats | None:
        """S x P: n = 1 / sigma^2, where the distribution is known by it; else None."""
        return 1.0 / (self.sigma * self.sigma) if self.options.by_exponent else None

    @property
    def certified(self) -> npt.NDArray[np.bool_]:
        """S: where optimality is proven to the gap that was asked for (status "certified" or "no_signal")."""
        return np.isin(self.status, (_batch.CERTIFIED, _batch.NO_SIGNAL))

    @property
    def fitted(self) -> npt.NDArray[np.bool_]:
        """S: where there is a model, proven or not."""
        return np.asarray(self.status <= _batch.NO_SIGNAL)

    @property
    def counts(self) -> dict[str, int]:
        """How many texels have each status."""
        found = np.bincount(self.status.reshape(-1), minlength=len(STATUS))
        return {name: int(found[i]) for i, name in enumerate(STATUS)}

    # ---- Evaluate

    def predict(self, light: npt.ArrayLike, view: npt.ArrayLike = (0.0, 0.0, 1.0), *,
                normal: npt.ArrayLike | None = None, quantity: str | None = None) -> Floats:
        """The texels under other directions, in the map's quantity or the one that is named ("brdf" or "radiance").

        light, view: one vector for all: the image S x K; or N x 3, or N x S x 3 (broadcast): a stack N x S x K
        normal: one vector, or S x 3; None: +z

        0 on and below the horizon, NaN where no model was fitted. Raises `DataError` for wrong shapes and for
        directions that are not finite or have no length.
        """
        return _map_eval.predict(self, light, view, normal, quantity)

    # ---- Keep

    def save(self, path: str | os.PathLike[str], *, format: str = "npy") -> None:
        """Write the maps as `brdffit map` does: a folder of sigma.npy, x.npy, ... and map.json, or, when path ends in
        .npz, one file of them all. format "pfm": a folder of float images for two spatial axes, e2 rounded up and
        lower_bound down so that what is claimed stays true. Files that are there are replaced, each as a whole."""
        _map_files.save(self, path, format)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> FitMap:
        """Of a folder of .npy that `save` or `brdffit map` wrote, or an .npz that `save` wrote. What these do not keep
        is NaN (channel_scale, sum_of_squares), -1 (where), 0 (boxes), "none" (stop), or the default (options engine,
        socp_every_box and isa)."""
        return cls(**_map_files.load(path))

    # ---- Show

    def __repr__(self) -> str:
        return _map_words.text(self)

    def _repr_html_(self) -> str:
        return _map_words.html(self)


AnyWorker = Union[_batch.Worker, _texelwise.Worker]


class _Strict:
    """Stops the pool at the first texel that cannot be fitted."""

    def __init__(self, worker: AnyWorker, pool: Pool, status: npt.NDArray[np.uint8]) -> None:
        self.worker, self.pool, self.status = worker, pool, status

    def fit(self, first: int, count: int) -> bool:
        done = self.worker.fit(first, count)
        if done and _unusable(self.status[first:first + count]).any():
            self.pool.stop()
        return done


def _unusable(status: npt.NDArray[np.uint8]) -> npt.NDArray[np.bool_]:
    return (status >= _batch.BAD_VALUE) & (status <= _batch.NO_SAMPLES)


def fit_map(values: npt.ArrayLike, light: DirectionsLike, view: npt.ArrayLike | None = None, *,
            normal: npt.ArrayLike | None = None, weights: npt.ArrayLike | None = None,
            mask: npt.ArrayLike | None = None, quantity: str | None = None, scale: float = 1.0,
            sample_axis: int | str = 0, channel_axis: int | str | None = -1, threads: int | None = None,
            tile: TileArgument = None, errors: str = "status", progress: MapProgressArgument = None, output: Any = None,
            client: Any = None, overwrite: bool = False, retries: int = 3, **options: Unpack[FitOptions]) -> FitMap:
    """Fit every texel of a stack of images, each with its own proof.

    values: samples x S x channels, where S is any number of axes (height x width of images). float64, float32 and uint16
        of the machine's byte order are read where they lie, whatever their strides, and also memory-mapped
        (`np.load(..., mmap_mode="r")`); other numbers are converted tile by tile. Each is multiplied by `scale`.
    sample_axis, channel_axis: which axes of `values` these are, if not the first and last; channel_axis None: there is
        none (samples x S), and the results have one channel
    light, view: towards light and viewer, around the normal: N x 3 for N samples, one vector, or N x S x 3
        (broadcast) where texels differ; any length but zero. view None: +z. Or light is a `Samples` (its values are
        not looked at) or the path of a CSV file as of `brdffit map --geometry`: its directions, angles or coefficients,
        weights and quantity hold for all texels.
    normal: one vector, or S x 3: a normal map in the frame of the directions; None: +z
    weights: N, multiply squared residuals; a sample of weight 0 is not looked at
    mask: S; texels where it is 0, False or NaN are skipped
    quantity: "brdf" (f_r in 1/sr, the default) or "radiance" (f_r n.l)
    threads: at a time; None: as many as there are processors for this process
    tile: texels of one call of the C library. Progress and Ctrl-C wait for it; None: some milliseconds' worth
    errors: "status": a texel that cannot be fitted has a status that says why; "raise" a `BrdffitError` for the first
        that is met, with `texel`, `sample` and `channel`
    progress: called in this thread about ten times a second with a `MapProgress` (done, total, rate), and once at the
        end; a true return value stops the run, and texels that it did not reach have status "not_reached". True shows
        a bar (tqdm's, when it is installed).

    and the options of a fit: see `Options`.

    The values of `load_stack` are read and fitted a band of rows at a time; tile may be a shape there, whose rows make one.

    Arrays of zarr, Dask and xarray, and any with output (a zarr store) or client (of dask.distributed), go the way of
    `brdffit.dask.fit_map`: tile by tile, in this process or on many machines, into arrays of their own kind. output,
    client, overwrite and retries are explained there.

    Threads, tiles, types and strides change no bit of the results: each is the same as of the texel alone. Directions,
    normals or views of a texel's own make it a fit by itself, as by `fit` (many times slower than shared ones).

    Raises `OptionError` and `DataError` for arguments, shapes and directions that cannot be used, `UnsupportedError` for
    what needs ECOS in a build without. An exception in `progress`, or Ctrl-C, ends the call within a tile.
    """
    if output is not None or client or scaled.is_scaled(values):
        out: FitMap = scaled.fit_map(
            values, light, view, normal=normal, weights=weights, mask=mask, quantity=quantity, scale=scale,
            sample_axis=sample_axis, channel_axis=channel_axis, threads=threads, tile=tile, errors=errors,
            progress=progress, output=output, client=client, overwrite=overwrite, retries=retries, **options)
        return out
    if kind(values) == "brdffit":
        from ._bands import fit_bands

        return fit_bands(values, light, view, normal=normal, weights=weights, mask=mask, quantity=quantity, scale=scale,
                         sample_axis=sample_axis, channel_axis=channel_axis, threads=threads, tile=tile, errors=errors,
                         progress=progress, options=options)
    asked = Options(**options)._plain()  # wrong options fail here
    choose("errors", errors, ("status", "raise"))
    stack = Stack(values, sample_axis, channel_axis)  # type: ignore[arg-type]  # says that they cannot be names
    given = geometry(light, view, normal, weights, quantity, stack.samples, stack.spatial)
    flags = _batch.texel_mask(mask, stack.spatial)
    scale = _batch.positive("scale", scale)
    began = time.perf_counter()
    results = _batch.allocate(stack.count, stack.channels, asked.lobes)
    size = count_of("tile", tile, _tile(asked, given.own, stack.count))  # type: ignore[arg-type]  # a shape is refused
    tiles = tiles_of(stack.count, size)
    pool = Pool(tiles)
    workers, skipped = _workers(given, asked, stack, results, flags, scale, pool,
                                min(count_of("threads", threads, processors()), len(tiles)))
    _run(pool, workers, errors == "raise", results, Teller(progress, stack.count))
    if errors == "raise":
        _raise(stack, given, asked, scale, results, pool)
    return _gather(results, pool, workers, skipped, given, asked, stack, time.perf_counter() - began)


def _tile(options: Options, own: bool, count: int) -> int:
    """Few tiles would leave threads idle. The number of threads has no say: counts in `stats` shall not depend on it."""
    return min(_batch.default_tile(options, own), max(256, -(-count // 32)))


def _workers(given: Geometry, options: Options, stack: Stack, results: _batch.Arrays,
             mask: npt.NDArray[np.uint8] | None, scale: float, pool: Pool,
             threads: int) -> tuple[Sequence[AnyWorker], Mapping[str, int] | None]:
    """One for each thread; samples that no texel uses, where all have the same."""
    if given.own:
        _texelwise.check(given, stack.samples, stack.channels, options)
        return [_texelwise.Worker(given, options, stack, results, mask, scale, pool.stopped)
                for _ in range(threads)], None
    plan = _batch.plan_for(given.shared, stack.channels, options)
    return [_batch.Worker(plan, stack, results, mask, scale) for _ in range(threads)], plan.samples_skipped


def _run(pool: Pool, workers: Sequence[AnyWorker], strict: bool, results: _batch.Arrays, teller: Teller) -> None:
    try:
        if strict:
            pool.run([_Strict(worker, pool, results["status"]) for worker in workers], teller)
        else:
            pool.run(workers, teller)
    finally:
        teller.close()


def _raise(stack: Stack, given: Geometry, options: Options, scale: float, results: _batch.Arrays, pool: Pool) -> None:
    """The C library's own words for the first texel that could not be fitted: its fit by itself says them."""
    for (first, count), done in zip(pool.tiles, pool.done):
        bad = np.flatnonzero(_unusable(results["status"][first:first + count]))
        if not done or len(bad) == 0:
            continue
        texel = first + int(bad[0])
        place = tuple(int(i) for i in np.unravel_index(texel, stack.spatial))
        own = given.at(place)
        values = floats("values", next(stack.blocks(texel, 1)).values[:, 0]) * scale
        names = tuple(str(k) for k in range(stack.channels))
        try:
            run(dataclasses.replace(own, values=values, channels=names), options, None, None, {})
        except BrdffitError as error:
            error.texel, error.channel_name = place, None
            raise
        raise AssertionError("texel %s was not fitted, and alone it is" % (place,))


def _gather(results: _batch.Arrays, pool: Pool, workers: Sequence[AnyWorker], skipped: Mapping[str, int] | None,
            given: Geometry, options: Options, stack: Stack, seconds: float) -> FitMap:
    for (first, count), done in zip(pool.tiles, pool.done):
        if not done:
            _batch.blank(results, slice(first, first + count), _batch.NOT_REACHED)
    shaped: dict[str, Any] = {name: freeze(array) for name, array in _batch.shaped(results, stack.spatial).items()}
    out = FitMap(**shaped, samples=stack.samples, samples_skipped=_sum([w.skipped() for w in workers], structs.SKIP)
                 if skipped is None else skipped, quantity=given.shared.quantity, options=options, stats={},
                 seconds=seconds)
    counted = _sum([w.counts() for w in workers], _batch.COUNTS)
    return dataclasses.replace(out, stats={**counted, **out.counts, "texels": stack.count})


def _sum(parts: Sequence[Mapping[str, int]], names: Sequence[str]) -> dict[str, int]:
    return {name: sum(part.get(name, 0) for part in parts) for name in names}
