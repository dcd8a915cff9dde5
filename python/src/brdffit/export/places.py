"""Where an export is judged: the measurement's directions, or directions that stand for all. SPDX-License-Identifier: MIT"""
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._arrays import Floats
from ..errors import DataError, UnsupportedError
from ..samples import Samples
from .fitted import Fit

COUNT = 1200  # pairs where there is no measurement


class Places(NamedTuple):
    """Unit vectors around +z above the surface, radiance there, and what it counts for; units that the fit minimised."""

    light: Floats
    view: Floats
    values: Floats  # N x 3, measured, or the fit's
    fitted: Floats  # N x 3, the fit's
    weight: Floats  # N x 3: of squared residuals
    samples: Samples  # to fit again
    measured: bool

    def rms(self, values: Floats, other: Floats) -> float:
        """Of the difference, relative to the RMS of what is there."""
        return float(np.sqrt((self.weight * (values - other) ** 2).sum() / (self.weight * self.values ** 2).sum()))


def channels(fit: Fit, names: tuple[str, ...] | None) -> list[int]:
    """Three indices: renderers have red, green and blue."""
    count = len(fit.channels)
    if names is not None:
        unknown = [name for name in names if name not in fit.channels]
        if unknown or len(names) != 3:
            raise UnsupportedError("channels must be three of %s, not %s" % (", ".join(fit.channels), ", ".join(names)),
                                   code="unsupported")
        return [fit.channels.index(name) for name in names]
    if count == 1:
        return [0, 0, 0]
    if count != 3:
        raise UnsupportedError("renderers take red, green and blue, and this fit has the channels %s: say which three are "
                               "those (--channels, channels=)" % ", ".join(fit.channels), code="unsupported")
    return [0, 1, 2]


def places(fit: Fit, samples: Samples | None, chosen: list[int]) -> Places:
    """Those of the samples that the fit used, or of `spread`."""
    measured = samples is not None
    at = spread(fit) if samples is None else samples
    light, view = directions(at)
    values = at.values * (light[:, 2:] if at.quantity == "brdf" else 1)
    if measured and len(at.channels) != len(fit.channels):
        raise DataError("the samples have %d channels, and the fit %d" % (len(at.channels), len(fit.channels)), code="argument")
    used = (view[:, 2] > 0) & (light[:, 2] > (np.cos(np.radians(fit.max_incidence)) - 1e-12 if fit.max_incidence < 90 else 0))
    weight = np.ones(len(light)) if at.weights is None else at.weights
    used &= weight > 0
    if not used.any():
        raise DataError("the fit uses none of these samples", code="no_samples")
    light, view, values, weight = light[used], view[used], values[used][:, chosen], weight[used]
    fitted = fit.predict(light, view, quantity="radiance")[:, chosen]
    scale = np.asarray(fit.channel_scale)[chosen]
    kept = Samples.from_arrays(light, view, values, weights=None if at.weights is None else weight, quantity="radiance")
    return Places(light, view, values, fitted, weight[:, None] / scale ** 2, kept, measured)


def directions(samples: Samples) -> tuple[Floats, Floats]:
    """Unit vectors around +z; of angles alone some that have them."""
    if samples.form == "coefficients":
        raise UnsupportedError("samples given as a, b, c have no directions to judge an export at", code="unsupported")
    if samples.form == "directions":
        assert samples.light is not None and samples.view is not None
        light, view = _unit(samples.light), _unit(samples.view)
        if samples.normal is None and samples.tangent is None:
            return light, view
        n = np.broadcast_to([0.0, 0.0, 1.0], light.shape) if samples.normal is None else _unit(samples.normal)
        return _turned(n, samples.tangent, light), _turned(n, samples.tangent, view)
    assert samples.cos_light is not None and samples.cos_view is not None and samples.cos_difference is not None
    nl, nv = samples.cos_light, samples.cos_view
    sl, sv = np.sqrt(np.maximum(0, 1 - nl ** 2)), np.sqrt(np.maximum(0, 1 - nv ** 2))
    cosine = (2 * samples.cos_difference ** 2 - 1 - nl * nv) / np.maximum(sl * sv, 1e-300)
    phi = np.arccos(np.clip(cosine, -1, 1))
    return np.stack([sl * np.cos(phi), sl * np.sin(phi), nl], 1), np.stack([sv, 0 * sv, nv], 1)


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def _turned(n: Floats, tangent: Floats | None, d: Floats) -> Floats:
    """d in a frame whose +z is n, and whose +x is along the tangent, or anywhere."""
    helper = np.where(np.abs(n[:, :1]) < 0.5, [[1.0, 0, 0]], [[0, 1.0, 0]]) if tangent is None else tangent
    x = _unit(helper - (helper * n).sum(1, keepdims=True) * n)
    return np.stack([(x * d).sum(1), (np.cross(n, x) * d).sum(1), (n * d).sum(1)], 1)


def spread(fit: Fit) -> Samples:
    """Pairs of directions for a fit whose samples are gone, with its own values: a third anywhere, the rest about the mirror
    direction at the scales of its lobes."""
    rng = np.random.default_rng(1)
    least = np.cos(np.radians(min(fit.max_incidence, 85.0)))
    light, view = (_around(rng, COUNT, low) for low in (least, np.cos(np.radians(85.0))))
    width = rng.choice(np.clip(fit.sigma, 1e-4, 1), COUNT)[:, None] * 2 * rng.random((COUNT, 1))
    near = light * [-1, -1, 1] + width * rng.standard_normal((COUNT, 3))
    near = _unit(near)
    mirror = (np.arange(COUNT) % 3 > 0) & (near[:, 2] > 0.05)
    view = np.where(mirror[:, None], near, view)
    return Samples.from_arrays(light, view, fit.predict(light, view, quantity="radiance"), quantity="radiance",
                               channels=fit.channels)


def _around(rng: np.random.Generator, count: int, least: float) -> Floats:
    cosine, phi = rng.uniform(least, 1, count), rng.uniform(0, 2 * np.pi, count)
    sine = np.sqrt(1 - cosine ** 2)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], 1)
