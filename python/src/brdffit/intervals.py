"""How sure: proven intervals of every parameter of a fit. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import ctypes
import dataclasses
import math
from ctypes import POINTER, byref
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from . import _lobes, _terms
from . import _structs as structs
from ._arrays import Floats, Frozen, address, floats, freeze
from ._ffi import library
from .errors import DataError, OptionError, from_struct
from .options import Options, _number
from .samples import Samples

if TYPE_CHECKING:
    from .fit import Fit


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Intervals(Frozen):
    """Intervals of the parameters over all models with E^2 <= threshold, the other parameters free.

    sigma: P x 2, lobes as in the fit; exponent: the same in terms of n, NaN of lobes that are not known by it, None where
        no lobe is
    x: K x 2, of a diffuse term of several columns K x F x 2; y: K x P x 2, in the data's units; f0: K x P x 2, or None.
        inf where the data set no limit
    inner: the same names in a dictionary: ends that some model with E^2 <= threshold reaches. So the true interval lies
        between, and both are equal to some percent of the width where complete is true
    at_end: the same names: P x 2 and so on, whether an end is that of what the model allows at all: the data set no
        limit there
    threshold: of E^2, in units of the fit's e2; level, noise, degrees: what it was made of (brdffit.h); boxes: what it took
    complete: whether every end is as near its inner one as was asked for; else the budget ended: proven all the same, but wider

    That the intervals hold for this threshold is proven. That a threshold of this kind makes 95 % intervals of it is the
    usual approximation for independent Gaussian noise.
    """

    sigma: Floats
    exponent: Floats | None
    x: Floats
    y: Floats
    f0: Floats | None
    inner: dict[str, Floats]
    at_end: dict[str, npt.NDArray[np.bool_]]
    threshold: float
    e2: float
    level: float
    noise: float
    degrees: float
    boxes: int
    complete: bool

    def __repr__(self) -> str:
        lines = ["Intervals (%s, threshold %.6g of e2 %.6g%s)" % (
            "%g %%" % (100 * self.level) if self.level else "eta", self.threshold, self.e2,
            "" if self.complete else ", some wider than need be")]
        for name in ("sigma", "exponent", "x", "y", "f0"):
            value = getattr(self, name)
            if value is not None:
                for place in np.ndindex(*value.shape[:-1]):
                    lines.append("  %s[%s]  %.6g to %.6g" % (name, ", ".join(map(str, place)), *value[place]))
        return "\n".join(lines)


def _options(fit: Fit) -> Options:
    """What the fit was asked for."""
    if fit.norm != "l2":
        raise OptionError("intervals are of norm l2 only, not of %s" % fit.norm, code="unsupported")
    return Options(lobes=tuple(fit.distributions), normalise=fit.normalise, sigma_range=fit.sigma_range,
                   exponent_range=fit.exponent_range or (0.1, 1e7), relative_gap=fit.relative_gap,
                   absolute_gap=fit.absolute_gap, max_incidence=fit.max_incidence, fresnel=fit.fresnel,
                   diffuse=fit.diffuse, masking=fit.masking)


def _asked(level: float, noise: float | None, eta: float | None, tolerance: float, budget: int) -> structs.IntervalOptions:
    level, tolerance = _number("level", level), _number("tolerance", tolerance)
    noise, eta = (0.0 if v is None else _number(name, v) for name, v in (("noise", noise), ("eta", eta)))
    if not 0 < level < 1:
        raise OptionError("level must be in (0, 1), not %r" % (level,), code="option")
    for name, value in (("noise", noise), ("eta", eta)):
        if not (value >= 0 and math.isfinite(value)):
            raise OptionError("%s must be finite and not negative, not %r" % (name, value), code="option")
    return structs.IntervalOptions(ctypes.sizeof(structs.IntervalOptions), level, noise, eta, tolerance, budget)


def _table(start: int | None, shape: tuple[int, ...]) -> npt.NDArray[np.float64] | None:
    """low, high, inner_low, inner_high and the flags as a float, of each."""
    if not start:
        return None
    count = math.prod(shape)
    flat = np.frombuffer(ctypes.string_at(start, ctypes.sizeof(structs.Range) * count), np.float64)
    words: npt.NDArray[np.float64] = flat.reshape(*shape, 5).copy()
    words[..., 4] = words[..., 4].copy().view(np.uint64)
    return words


def _tables(r: structs.IntervalResult, by_n: npt.NDArray[np.bool_]) -> dict[str, npt.NDArray[np.float64]]:
    lobes, channels, columns = r.lobes, r.channels, r.diffuse_columns
    found = {"sigma": _table(r.sigma, (lobes,)), "exponent": _table(r.exponent, (lobes,)),
             "x": _table(r.x, (channels, columns) if columns > 1 else (channels,)), "y": _table(r.y, (channels, lobes)),
             "f0": _table(r.f0, (channels, lobes))}
    exponent = found["exponent"]
    if not by_n.any():
        found["exponent"] = None
    elif exponent is not None:
        exponent[~by_n, :4] = np.nan
    return {name: table for name, table in found.items() if table is not None}


def _convert(r: structs.IntervalResult, by_n: npt.NDArray[np.bool_]) -> Intervals:
    tables = _tables(r, by_n)
    outer = {name: freeze(table[..., :2].copy()) for name, table in tables.items()}
    ends = {name: np.stack([table[..., 4].astype(np.intp) & bit for bit in (1, 2)], axis=-1) > 0
            for name, table in tables.items()}
    return Intervals(
        sigma=outer["sigma"], exponent=outer.get("exponent"), x=outer["x"], y=outer["y"], f0=outer.get("f0"),
        inner={name: freeze(table[..., 2:4].copy()) for name, table in tables.items()}, at_end=ends,
        threshold=r.threshold, e2=r.e2, level=r.level, noise=r.noise, degrees=r.degrees, boxes=int(r.boxes),
        complete=bool(r.complete))


def intervals(fit: Fit, samples: Samples, level: float = 0.95, noise: float | None = None, eta: float | None = None,
              tolerance: float = 0.02, box_budget: int = 20_000) -> Intervals:
    """What `Fit.intervals` does."""
    if len(samples.channels) != len(fit.channels):
        raise DataError("the samples have %d channels, the fit has %d" % (len(samples.channels), len(fit.channels)),
                        code="format")
    if samples.weighting != fit.weighting:
        samples = samples.weighted(fit.weighting)
    ffi = library()
    asked = _asked(level, noise, eta, tolerance, box_budget)
    options = _options(fit)
    c_options, c_samples = options._struct(), samples._struct()
    fit._check_model()
    sigma, x, y = floats("sigma", fit.sigma), floats("x", fit.x), floats("y", fit.y)
    names = _lobes.as_c(tuple(fit.distributions))
    model = ffi.model()
    model.distribution, model.lobes, model.distributions = names[0], fit.lobes, ctypes.addressof(names)
    model.channels = len(x)
    model.sigma, model.x, model.y = address(sigma), address(x), address(y)
    keep = _terms.fill(model, fit)  # noqa: F841 (arrays that the model points to)
    size = ffi.core.brdffit_intervals_workspace_size(c_samples.count, c_samples.channels, byref(c_options))
    workspace = np.empty(size, np.uint8)
    result, error = POINTER(structs.IntervalResult)(), structs.Error()
    if ffi.core.brdffit_intervals(byref(c_samples), byref(c_options), byref(model), fit.e2, byref(asked),
                                  workspace.ctypes.data, size, byref(result), byref(error)) != 0:
        raise from_struct(error, path=samples.file, channels=samples.channels, lines=samples.lines)
    by_n = np.array([p == "exponent" for p in fit.parameters])
    return _convert(result.contents, by_n)
