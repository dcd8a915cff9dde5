"""The boxes of a search: its proof, to look at. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _lobes
from ._arrays import Floats, Frozen, freeze
from .fit import Fit, SamplesLike, run
from .options import FitOptions, Options
from .samples import Samples

if TYPE_CHECKING:
    from typing_extensions import Unpack


@dataclasses.dataclass(frozen=True, eq=False)
class Boxes(Frozen):
    """Every box that a search bounded, in its order: those that a box was split into come after it.

    sigma_low, sigma_high: N x P sides, lobes as in the fit (equal sides of lobes of one distribution stand for the part
        where their sigma ascend)
    lower_bound: N, proven: no model with its roughness in the box has a smaller e2
    level: N, how often it was halved
    distributions: what each lobe is
    """

    sigma_low: Floats
    sigma_high: Floats
    lower_bound: Floats
    level: npt.NDArray[np.intc]
    distributions: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.lower_bound)

    def bound_at(self, *sigma: npt.ArrayLike) -> Floats:
        """The proven lower bound of e2 at roughness, a sigma for each lobe (in any order among those of one distribution):
        that of the smallest box around it. -inf outside of the range searched."""
        points = [np.asarray(s, dtype=np.float64) for s in np.broadcast_arrays(*sigma)]
        if len(points) != self.sigma_low.shape[1]:
            raise TypeError("one sigma for each lobe")
        stacked = np.stack(points)
        for _, same in _lobes.kinds(self.distributions):
            stacked[same] = np.sort(stacked[same], axis=0)
        shape = stacked.shape[1:]
        flat = stacked.reshape(len(points), -1)
        out = np.full(flat.shape[1], -np.inf)
        for low, high, bound in zip(self.sigma_low, self.sigma_high, self.lower_bound):
            # A box and what it was split into are nested, so that the largest bound around a point holds.
            inside = np.all((flat >= low[:, None]) & (flat <= high[:, None]), axis=0)
            out[inside] = np.maximum(out[inside], bound)
        return out.reshape(shape)


def fit_boxes(samples: SamplesLike, **options: Unpack[FitOptions]) -> tuple[Fit, Boxes]:
    """The fit and every box of its search."""
    data = samples if isinstance(samples, Samples) else Samples.from_file(samples)
    asked = Options(**options)
    rows: list[tuple[float, ...]] = []

    def receive(user: object, box: Any) -> None:
        b = box.contents
        rows.append((*b.sigma_low[:b.lobes], *b.sigma_high[:b.lobes], b.lower_bound, b.level))

    fit = run(data, asked, None, None, {}, receive)
    n = fit.lobes
    table = np.array(rows).reshape(-1, 2 * n + 2)
    return fit, Boxes(freeze(table[:, :n].copy()), freeze(table[:, n:2 * n].copy()), freeze(table[:, 2 * n].copy()),
                      freeze(table[:, 2 * n + 1].astype(np.intc)), fit.distributions)
