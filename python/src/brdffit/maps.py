"""Every texel of a stack of images fitted, each with its own proof. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import time
from typing import TYPE_CHECKING, Any, Mapping

import numpy as np
import numpy.typing as npt

from . import _batch
from . import _structs as structs
from ._arrays import Floats, freeze
from ._batch import STATUS
from ._geometry import DirectionsLike, Geometry, geometry
from ._pool import MapProgressArgument, Pool, Teller, TileWorker, count_of, processors, tiles_of
from ._stack import Stack
from .options import FitOptions, Options

if TYPE_CHECKING:
    from typing_extensions import Unpack

STOP = (*structs.STOP, "none")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class FitMap:
    """Fitted models and certificates of many texels. S stands for the spatial shape of the values, K for channels, P for
    lobes. Texels that were not fitted have NaN in every floating-point array.

    sigma: S x P roughnesses, ascending (1/sqrt(n) where the distribution is known by its exponent n: see `exponent`)
    x: S x K diffuse coefficients; y: S x K x P specular ones, in the data's units
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
    stats: how many texels had each status, and what was (not) done: see `brdffit_many_stats` in brdffit.h
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
    quantity: str
    options: Options
    stats: Mapping[str, int]
    seconds: float

    STATUS = STATUS
    STOP = STOP

    @property
    def shape(self) -> tuple[int, ...]:
        """The spatial shape."""
        return self.status.shape

    @property
    def channels(self) -> int:
        return int(self.x.shape[-1])

    @property
    def lobes(self) -> int:
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
        return (self.status == _batch.CERTIFIED) | (self.status == _batch.NO_SIGNAL)

    @property
    def fitted(self) -> npt.NDArray[np.bool_]:
        """S: where there is a model (also status "open")."""
        fitted: npt.NDArray[np.bool_] = self.status <= _batch.NO_SIGNAL
        return fitted


def fit_map(values: npt.ArrayLike, light: DirectionsLike, view: npt.ArrayLike | None = None, *,
            normal: npt.ArrayLike | None = None, weights: npt.ArrayLike | None = None,
            mask: npt.ArrayLike | None = None, quantity: str | None = None, scale: float = 1.0, sample_axis: int = 0,
            channel_axis: int | None = -1, threads: int | None = None, tile: int | None = None,
            progress: MapProgressArgument = None, **options: Unpack[FitOptions]) -> FitMap:
    """Fit every texel of an array samples x ... x channels, each with its own proof."""
    asked = Options(**options)
    asked._struct()
    stack = Stack(values, sample_axis, channel_axis)
    given = geometry(light, view, normal, weights, quantity, stack.samples, stack.spatial)
    if given.own:
        raise NotImplementedError("directions a texel")
    flags = _batch.texel_mask(mask, stack.spatial)
    scale = _batch.positive("scale", scale)
    size = count_of("tile", tile, _batch.default_tile(asked))
    workers_wanted = count_of("threads", threads, processors())
    results = _batch.allocate(stack.count, stack.channels, asked.lobes)
    began = time.perf_counter()
    plan = _batch.plan_for(given.shared, stack.channels, asked)
    tiles = tiles_of(stack.count, size)
    pool = Pool(tiles)
    workers = [_batch.Worker(plan, stack, results, flags, scale) for _ in range(min(workers_wanted, len(tiles)))]
    teller = Teller(progress, stack.count)
    try:
        pool.run(workers, teller)
    finally:
        teller.close()
    stats = {name: sum(w.counts()[name] for w in workers) for name in _batch.COUNTS}
    for (first, count), done in zip(tiles, pool.done):
        if not done:
            _batch.blank(results, slice(first, first + count), _batch.NOT_REACHED)
    shaped = {name: freeze(array) for name, array in _batch.shaped(results, stack.spatial).items()}
    return FitMap(**shaped, samples=stack.samples, quantity=given.shared.quantity, options=asked, stats=stats,
                  seconds=time.perf_counter() - began)
