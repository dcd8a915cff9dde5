"""The fit of an array in memory: every texel, each with its own proof. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .. import _structs as structs
from .._arguments import choose, count_of, positive, processors
from .._arrays import floats, freeze
from ..errors import BrdffitError
from ..fit import run
from ..options import FitOptions, Options
from . import batch, texelwise
from .arguments import TileArgument
from .fitmap import FitMap
from .geometry import DirectionsLike, Geometry, geometry
from .pool import MapProgressArgument, Pool, Teller, tiles_of
from .results import COUNTS, NOT_REACHED, Arrays, allocate, blank, shaped, terms_of, unusable
from .stack import Stack, texel_mask

if TYPE_CHECKING:
    from typing_extensions import Unpack

AnyWorker = batch.Worker | texelwise.Worker


class _Strict:
    """Stops the pool at the first texel that cannot be fitted."""

    def __init__(self, worker: AnyWorker, pool: Pool, status: npt.NDArray[np.uint8]) -> None:
        self.worker, self.pool, self.status = worker, pool, status

    def fit(self, first: int, count: int) -> bool:
        done = self.worker.fit(first, count)
        if done and unusable(self.status[first:first + count]).any():
            self.pool.stop()
        return done


def fit_array(values: npt.ArrayLike, light: DirectionsLike, view: npt.ArrayLike | None = None, *,
              normal: npt.ArrayLike | None = None, weights: npt.ArrayLike | None = None,
              mask: npt.ArrayLike | None = None, quantity: str | None = None, scale: float = 1.0,
              sample_axis: int | str = 0, channel_axis: int | str | None = -1, threads: int | None = None,
              tile: TileArgument = None, errors: str = "status", progress: MapProgressArgument = None,
              **options: Unpack[FitOptions]) -> FitMap:
    """`brdffit.fit_map` of what is in memory, or may be converted."""
    asked = Options(**options)._plain()  # wrong options fail here
    choose("errors", errors, ("status", "raise"))
    stack = Stack(values, sample_axis, channel_axis)  # type: ignore[arg-type]  # says that they cannot be names
    given = geometry(light, view, normal, weights, quantity, stack.samples, stack.spatial)
    flags = texel_mask(mask, stack.spatial)
    scale = positive("scale", scale)
    began = time.perf_counter()
    results = allocate(stack.count, stack.channels, asked.lobe_count, **terms_of(asked))
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
    return min(batch.default_tile(options, own), max(256, -(-count // 32)))


def _workers(given: Geometry, options: Options, stack: Stack, results: Arrays,
             mask: npt.NDArray[np.uint8] | None, scale: float, pool: Pool,
             threads: int) -> tuple[Sequence[AnyWorker], Mapping[str, int] | None]:
    """One for each thread; samples that no texel uses, where all have the same."""
    if given.own:
        texelwise.check(given, stack.samples, stack.channels, options)
        return [texelwise.Worker(given, options, stack, results, mask, scale, pool.stopped)
                for _ in range(threads)], None
    plan = batch.plan_for(given.shared, stack.channels, options)
    return [batch.Worker(plan, stack, results, mask, scale) for _ in range(threads)], plan.samples_skipped


def _run(pool: Pool, workers: Sequence[AnyWorker], strict: bool, results: Arrays, teller: Teller) -> None:
    try:
        if strict:
            pool.run([_Strict(worker, pool, results["status"]) for worker in workers], teller)
        else:
            pool.run(workers, teller)
    finally:
        teller.close()


def _raise(stack: Stack, given: Geometry, options: Options, scale: float, results: Arrays, pool: Pool) -> None:
    """The C library's own words for the first texel that could not be fitted: its fit by itself says them."""
    for (first, count), done in zip(pool.tiles, pool.done):
        bad = np.flatnonzero(unusable(results["status"][first:first + count]))
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


def _gather(results: Arrays, pool: Pool, workers: Sequence[AnyWorker], skipped: Mapping[str, int] | None,
            given: Geometry, options: Options, stack: Stack, seconds: float) -> FitMap:
    for (first, count), done in zip(pool.tiles, pool.done):
        if not done:
            blank(results, slice(first, first + count), NOT_REACHED)
    arrays: dict[str, Any] = {name: freeze(array) for name, array in shaped(results, stack.spatial).items()}
    out = FitMap(**arrays, samples=stack.samples, samples_skipped=_sum([w.skipped() for w in workers], structs.SKIP)
                 if skipped is None else skipped, quantity=given.shared.quantity, options=options, stats={},
                 seconds=seconds)
    counted = _sum([w.counts() for w in workers], COUNTS)
    return dataclasses.replace(out, stats={**counted, **out.counts, "texels": stack.count})


def _sum(parts: Sequence[Mapping[str, int]], names: Sequence[str]) -> dict[str, int]:
    return {name: sum(part.get(name, 0) for part in parts) for name in names}
