"""What a map is fitted to: a model and a certificate for each texel. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import os
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from .._arrays import Floats, Frozen
from ..options import Options
from . import evaluate, files, words
from .results import CERTIFIED, NO_SIGNAL, STATUS, STOP


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class FitMap(Frozen):
    """Fitted models and certificates of many texels. S stands for the spatial shape of the values, K for channels, P for
    lobes. Texels that were not fitted have NaN in every floating-point array. Arrays cannot be written to.

    sigma: S x P roughnesses, those of a distribution ascending (1/sqrt(n) of a lobe that is known by its exponent n: see
        `exponent`); `distributions` says what each lobe is
    x: S x K diffuse coefficients; y: S x K x P specular ones, both in the data's units
    f0: S x K x P reflectances at normal incidence, None without Fresnel; x_more: S x K x (1 or 2) coefficients of the
        diffuse term's further columns, None where it has one
    channel_scale: S x K divisors: e2, lower_bound and sum_of_squares are in units of the values divided by them
    e2: S, what the norm minimises; lower_bound: S, proven: no model of this form has less; gap: e2 - lower_bound
    sum_of_squares: S, e2 of the zero model
    status: S, bytes that index `FitMap.STATUS`: 0 "certified", 1 "open" (the search stopped early; fit and bound are
        valid), 2 "no_signal" (all values 0: so is the model, proven), 3 "masked", 4 "bad_value" (NaN or infinite),
        5 "refused" (a fit of it alone would fail), 6 "no_samples" (its own directions leave none), 7 "not_reached"
        (the run was stopped)
    stop: S, bytes that index `FitMap.STOP`: why the search of a certified or open texel ended; "none" for others
    where: S, of a bad value: sample * K + channel; else -1
    boxes: S, how many the search bounded
    sigma_floor: S: what is proven is proven for sigma from here to the largest of the range: the smallest of the range,
        or more where narrower lobes have coefficients beyond any double (infinite: no lobe is left)
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
    sigma_floor: Floats
    samples: int
    samples_skipped: Mapping[str, int]
    quantity: str
    options: Options
    stats: Mapping[str, int]
    seconds: float
    f0: Floats | None = None
    x_more: Floats | None = None

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
    def distributions(self) -> tuple[str, ...]:
        """P: what each lobe is."""
        return self.options.distributions

    @property
    def parameters(self) -> tuple[str, ...]:
        """P: what each lobe is known by: "sigma" or "exponent"."""
        return self.options.parameters

    @property
    def exponent(self) -> Floats | None:
        """S x P: n = 1 / sigma^2, NaN of lobes that are not known by it; None where no lobe is."""
        if "exponent" not in self.parameters:
            return None
        out: Floats = 1.0 / (self.sigma * self.sigma)
        out[..., [name == "sigma" for name in self.parameters]] = np.nan
        return out

    @property
    def certified(self) -> npt.NDArray[np.bool_]:
        """S: where optimality is proven to the gap that was asked for (status "certified" or "no_signal")."""
        return np.isin(self.status, (CERTIFIED, NO_SIGNAL))

    @property
    def fitted(self) -> npt.NDArray[np.bool_]:
        """S: where there is a model, proven or not."""
        return np.asarray(self.status <= NO_SIGNAL)

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
        return evaluate.predict(self, light, view, normal, quantity)

    # ---- Keep

    def save(self, path: str | os.PathLike[str], *, format: str = "npy") -> None:
        """Write the maps as `brdffit map` does: a folder of sigma.npy, x.npy, ... and map.json, or, when path ends in
        .npz, one file of them all. format "pfm": a folder of float images for two spatial axes, e2 rounded up and
        lower_bound down so that what is claimed stays true. Files that are there are replaced, each as a whole."""
        files.save(self, path, format)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> FitMap:
        """Of a folder of .npy that `save` or `brdffit map` wrote, or an .npz that `save` wrote. What these do not keep
        is NaN (channel_scale, sum_of_squares, sigma_floor), -1 (where), 0 (boxes), "none" (stop), or the default (options engine,
        socp_every_box and isa)."""
        return cls(**files.load(path))

    # ---- Show

    def __repr__(self) -> str:
        return words.text(self)

    def _repr_html_(self) -> str:
        return words.html(self)
