"""From a fit to what a target can show: as it is where the target has its model, else fitted again in the target's.

First the library fits the forms of model that the target has, to the measurement or to the fit, and proves them. Where the target's
parameters are tied further (one weight for three channels, a diffuse term that the lobe dims, weights that sum to 1), these are
moved from there, by Levenberg and Marquardt's method within their bounds; no proof covers that step, and the export says so.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from .._arrays import Floats
from ..errors import BrdffitError, DataError
from ..samples import Samples
from . import microfacet as m
from .conventions import Target
from .fitted import Fit
from .places import Places
from .principled import Gltf, OpenPbr, Usd
from .spaces import Conductors, Free, Space, Sum

WORSE = 1.02  # a form that is this much worse than the fit calls for another lobe
_STEPS = 40
_MOST = 1500  # samples that parameters are moved on

_PRINCIPLED: dict[str, type[Gltf | Usd | OpenPbr]] = {"gltf": Gltf, "usd": Usd, "openpbr": OpenPbr}


Again = Callable[..., "Fit"]  # brdffit.fit


class Shown(NamedTuple):
    """What the target shows: parameters of its space, whose values are the material's."""

    space: Space
    parameters: Floats
    exact: bool  # it is the fit
    base: Fit  # the fit that it came from: the one given, or one of the target's form
    refitted: bool
    certified: bool  # the target's model is proven to be the best of its form: nothing was moved
    error: float  # RMS from the measurement, or from the fit, relative
    fit_error: float  # of the fit from the measurement; 0 without one
    from_fit: float  # of the target from the fit

    def values(self, light: Floats, view: Floats) -> Floats:
        """Radiance, N x 3, by the target's own formulas."""
        return self.space.values(self.parameters, m.angles(light, view))


def shown(fit: Fit, target: Target, at: Places, chosen: list[int], again: Again) -> Shown:
    """The fit itself where the target holds it, or the best that the target can do."""
    found: list[Shown] = []
    for bases in _bases(fit, target, at, again):
        for base in bases:
            for space in _spaces(target, tuple(base.distributions)):
                one = _judge(fit, base, space, target, at, chosen)
                if one.exact:
                    return one
                found.append(one)
        if found and min(one.error for one in found) <= WORSE * found[0].fit_error:
            break
    if not found:
        raise DataError("no form of model that %s has can be fitted to these values" % target.title, code="unsupported")
    return min(found, key=lambda one: one.error)


def _spaces(target: Target, distributions: tuple[str, ...]) -> Iterator[Space]:
    if target.space == "principled":
        yield _PRINCIPLED[target.name](target, distributions)
    elif target.space == "sum":
        yield Sum(target, distributions)
        yield Sum(target, distributions, "conductor")
    else:
        yield Free(target, distributions) if target.space == "free" else Conductors(target, distributions)


def _bases(fit: Fit, target: Target, at: Places, again: Again) -> Iterator[Iterator[Fit]]:
    """The fit where the target has its form; forms of the target, with as many lobes (of conductors, whose F is always there, from
    one on), and with another."""
    if _holds(fit, target):
        yield iter([fit])
    fresnel = "schlick" if target.space != "sum" or fit.fresnel == "schlick" else "none"
    least = 1 if target.space == "conductor" else min(fit.lobes, target.lobes)
    # Without a measurement, a lobe that is there for the difference of two formulas is worth nothing.
    most = min(target.lobes, max(fit.lobes, 2 if at.measured else 1))
    for lobes in range(least, most + 1):
        yield (one for distribution in target.distributions
               for one in _fits(at.samples, fit, target, distribution, lobes, fresnel, again))


def _fits(samples: Samples, fit: Fit, target: Target, distribution: str, lobes: int, fresnel: str,
          again: Again) -> Iterator[Fit]:
    """One, with physical bounds where the target has them and the data take them."""
    for physical in ((True, False) if target.total else (False,)):
        try:
            yield again(samples, lobes=lobes, distribution=distribution, masking=target.masking, fresnel=fresnel,
                        diffuse="none" if fit.diffuse == "none" else "lambert", physical=physical, max_incidence=90,
                        sigma_range=(1e-3, target.sigma), box_budget=100_000)
        except BrdffitError:
            continue  # of channels without light, or sums that physical bounds do not take
        return


def stretched(fit: Fit) -> bool:
    """Whether it has an anisotropic lobe: no target is given one yet."""
    return fit.anisotropy is not None and bool((np.asarray(fit.anisotropy) != 1).any())


def _holds(fit: Fit, target: Target) -> bool:
    return (not stretched(fit) and all(name in target.distributions for name in fit.distributions) and
            fit.masking == target.masking and fit.lobes <= target.lobes and fit.diffuse in ("lambert", "none") and
            bool((np.asarray(fit.sigma) <= target.sigma).all()))


def _judge(fit: Fit, base: Fit, space: Space, target: Target, at: Places, chosen: list[int]) -> Shown:
    refitted = base is not fit
    starts, exact = space.starts(base, [0, 1, 2] if refitted else chosen)
    exact = exact and not (target.total and space.total(starts[0]) > 1 + 1e-9)
    best = starts[0] if exact else min((_moved(space, p, target, at) for p in starts), key=lambda p: _error(space, p, at))
    values = space.values(best, m.angles(at.light, at.view))
    return Shown(space, best, exact and not refitted, base, refitted, exact and base.certified, at.rms(values, at.values),
                 at.rms(at.fitted, at.values), at.rms(values, at.fitted))


def _error(space: Space, p: Floats, at: Places) -> float:
    return at.rms(space.values(p, m.angles(at.light, at.view)), at.values)


def _moved(space: Space, p: Floats, target: Target, at: Places) -> Floats:
    """Levenberg and Marquardt, each step cut off at the bounds; what a blend's weights sum to beyond 1 is a residual of its own,
    and what is left of it is scaled away."""
    pick = np.random.default_rng(2).permutation(len(at.light))[:_MOST]
    a, weight = m.angles(at.light[pick], at.view[pick]), np.sqrt(at.weight[pick])
    size = float(np.sqrt((weight ** 2 * at.values[pick] ** 2).sum()))

    def residual(q: Floats) -> Floats:
        over = max(0.0, space.total(q) - 1) if target.total else 0.0
        return np.append(((space.values(q, a) - at.values[pick]) * weight).ravel() / size, 10 * over)

    damping, r = 1e-3, residual(p)
    for _ in range(_STEPS):
        slope = _slope(residual, p, r, space)
        normal, gradient = slope.T @ slope, slope.T @ r
        free = ~(((p <= space.low) & (gradient > 0)) | ((p >= space.high) & (gradient < 0)))
        for _ in range(12):
            step = np.zeros_like(p)
            some = normal[np.ix_(free, free)]
            step[free] = -np.linalg.solve(some + damping * np.diag(np.diag(some) + 1e-12), gradient[free])
            q = np.clip(p + step, space.low, space.high)
            s = residual(q)
            if s @ s < r @ r:
                break
            damping *= 4
        else:
            break
        gain = r @ r - s @ s
        p, r, damping = q, s, damping / 6
        if gain < 1e-9 * (r @ r):
            break
    total = space.total(p) if target.total else 0.0
    return space.scaled(p, 1 / total) if total > 1 else p


def _slope(residual: Callable[[Floats], Floats], p: Floats, r: Floats, space: Space) -> Floats:
    out = np.empty((len(r), len(p)))
    for i in range(len(p)):
        q = p.copy()
        h = 1e-6 if p[i] + 1e-6 <= space.high[i] else -1e-6
        q[i] += h
        out[:, i] = (residual(q) - r) / h
    return out
