"""What a target can show, as numbers in a box: values, and the parameters of the BSDFs that give them.

A space turns a vector of parameters into radiance, N x 3, and has bounds for each. `refit.py` moves them.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from .._arrays import Floats
from . import microfacet as m
from .conventions import Target
from .fitted import Fit

SIGMA_LEAST = 1e-4
ETA_MOST = 3.0


class Space(Protocol):
    """Values of parameters, and their bounds; where to begin from a fit, and whether that is the fit itself."""

    low: Floats
    high: Floats

    def values(self, p: Floats, a: m.Angles) -> Floats: ...

    def total(self, p: Floats) -> float: ...

    def scaled(self, p: Floats, by: float) -> Floats: ...

    def starts(self, fit: Fit, chosen: list[int]) -> tuple[list[Floats], bool]: ...


def coefficients(fit: Fit, chosen: list[int]) -> tuple[Floats, Floats, Floats]:
    """x (3); 4 y F0 and 4 y (1 - F0), P x 3."""
    four = 4 * np.asarray(fit.y)[chosen].T
    f0 = np.ones_like(four) if fit.f0 is None else np.asarray(fit.f0)[chosen].T
    x = np.asarray(fit.x)[chosen] if fit.diffuse != "none" else np.zeros(3)
    return x, four * f0, four * (1 - f0)


class Lobe(NamedTuple):
    """One lobe: `colour` times F = 1, and `weight` (of each channel) times a Fresnel factor of `base`, white at grazing angles."""

    distribution: str
    sigma: float
    colour: Floats
    weight: Floats
    base: Floats
    fresnel: str  # "schlick" or "conductor"
    eta: Floats  # of a conductor

    @property
    def k(self) -> Floats:
        return m.extinction(self.eta, self.base)


class Sum:
    """x, and of each lobe ln sigma, base, colour, weight; of a conductor three weights and three eta."""

    def __init__(self, target: Target, distributions: tuple[str, ...], fresnel: str = "schlick") -> None:
        self.target, self.distributions, self.fresnel = target, distributions, fresnel
        self.weights = 3 if fresnel == "conductor" else 1
        most = 1.0 if target.total else 100.0
        self.more = [1.0] * 3 if fresnel == "conductor" else []
        top = [np.log(target.sigma)] + [0.999 if self.more else 1] * 3 + [most] * 3 + [1] * self.weights
        top += [ETA_MOST] * len(self.more)
        least = [np.log(SIGMA_LEAST)] + [0.0] * (6 + self.weights) + self.more
        self.low = np.array([0.0] * 3 + least * len(distributions))
        self.high = np.array([most] * 3 + top * len(distributions))
        for name, row in zip(distributions, self.rows(self.high)):
            if name == "beckmann" and fresnel == "schlick" and target.name == "mitsuba":
                row[7:] = 0  # principled is GGX

    def rows(self, p: Floats) -> Floats:
        """One a lobe, a view."""
        return p[3:].reshape(-1, 7 + self.weights + len(self.more))

    def lobes(self, p: Floats) -> list[Lobe]:
        return [Lobe(name, float(np.exp(row[0])), row[4:7], np.broadcast_to(row[7:7 + self.weights], 3), row[1:4], self.fresnel,
                     row[-3:])
                for name, row in zip(self.distributions, self.rows(p))]

    def values(self, p: Floats, a: m.Angles) -> Floats:
        out = np.multiply.outer(m.lambert(a), p[:3])
        for one in self.lobes(p):
            g = m.lobe(one.distribution, self.target.masking, one.sigma, a)
            f = m.schlick(one.base, a) if one.fresnel == "schlick" else m.conductor(one.eta, one.k, a.vh)
            out = out + g[:, None] * (one.colour + one.weight * f)
        return out

    def total(self, p: Floats) -> float:
        """What a blend's weights sum to."""
        return float(p[:3].max() + sum(one.weight.max() + one.colour.max() for one in self.lobes(p)))

    def scaled(self, p: Floats, by: float) -> Floats:
        """All that adds up."""
        out = p.copy()
        out[:3] *= by
        self.rows(out)[:, 4:7 + self.weights] *= by
        return np.asarray(out)

    def starts(self, fit: Fit, chosen: list[int]) -> tuple[list[Floats], bool]:
        """Exact where each channel's 4 y is at least the largest 4 y (1 - F0): the columns of Schlick's F are then those of one
        white-edged lobe and a coloured one, whose weights sum to the largest 4 y."""
        x, plain, grazing = coefficients(fit, chosen)
        rows, exact = [x], self.fresnel == "schlick" or not grazing.any()
        for sigma, a, c in zip(fit.sigma, plain, grazing):
            weight = float(c.max())
            base = np.ones(3) if weight == 0 else 1 - c / weight
            colour = a - weight * base
            if self.weights == 3:
                weight, base, colour = a + c, a / np.maximum(a + c, 1e-12), np.zeros(3)
                exact = False
            elif (colour < -1e-12 * weight).any():
                weight, exact = float(c.mean()), False  # the mean is nearer
                base = np.clip(1 - c / weight, 0, 1)
                colour = a - weight * base
            rows.append(np.concatenate([[np.log(sigma)], base, np.maximum(colour, 0), np.atleast_1d(weight), self.more]))
        p = np.concatenate(rows)
        inside = np.clip(p, self.low, self.high)
        return [inside], exact and bool(np.allclose(p, inside, rtol=1e-12, atol=1e-12))


class Free:
    """The fit's own columns, for targets that colour both ends of F: x, and of each lobe ln sigma, 4 y F0, 4 y (1 - F0)."""

    def __init__(self, target: Target, distributions: tuple[str, ...]) -> None:
        self.target, self.distributions = target, distributions
        self.low = np.array([0.0] * 3 + ([np.log(1e-12)] + [0.0] * 6) * len(distributions))
        self.high = np.array([np.inf] * 3 + ([np.log(target.sigma)] + [np.inf] * 6) * len(distributions))

    def values(self, p: Floats, a: m.Angles) -> Floats:
        out = np.multiply.outer(m.lambert(a), p[:3])
        for name, row in zip(self.distributions, p[3:].reshape(-1, 7)):
            g = m.lobe(name, self.target.masking, float(np.exp(row[0])), a)
            out = out + g[:, None] * (row[1:4] + np.multiply.outer(a.versine ** 5, row[4:]))
        return out

    def total(self, p: Floats) -> float:
        return 0.0  # it adds, and has no limit

    def scaled(self, p: Floats, by: float) -> Floats:
        return p

    def starts(self, fit: Fit, chosen: list[int]) -> tuple[list[Floats], bool]:
        x, plain, grazing = coefficients(fit, chosen)
        return [np.concatenate([x, *(np.concatenate([[np.log(sigma)], a, c])
                                     for sigma, a, c in zip(fit.sigma, plain, grazing))])], True


class Conductors:
    """pbrt: x, and of each lobe ln sigma, weight, base, eta: 3 + 8 P."""

    def __init__(self, target: Target, distributions: tuple[str, ...]) -> None:
        self.target, self.count = target, len(distributions)
        self.low = np.array([0.0] * 3 + [np.log(SIGMA_LEAST), 0, 0, 0, 0, 1, 1, 1] * self.count)
        self.high = np.array([1.0] * 3 + [np.log(target.sigma), 1, 0.999, 0.999, 0.999, *[ETA_MOST] * 3] * self.count)

    def values(self, p: Floats, a: m.Angles) -> Floats:
        out = np.multiply.outer(m.lambert(a), p[:3])
        for row in p[3:].reshape(-1, 8):
            g = m.lobe("ggx", self.target.masking, float(np.exp(row[0])), a)
            out = out + row[1] * g[:, None] * m.conductor(row[5:], m.extinction(row[5:], row[2:5]), a.vh)
        return out

    def total(self, p: Floats) -> float:
        return float(p[:3].max() + p[3:].reshape(-1, 8)[:, 1].sum())

    def scaled(self, p: Floats, by: float) -> Floats:
        out = p.copy()
        out[:3] *= by
        out[3:].reshape(-1, 8)[:, 1] *= by
        return np.asarray(out)

    def starts(self, fit: Fit, chosen: list[int]) -> tuple[list[Floats], bool]:
        """With eta 1 and 4 y as the weight; as dielectrics; and with all of the weight."""
        x, plain, grazing = coefficients(fit, chosen)
        rows: list[list[Floats]] = [[x], [x], [x]]
        for sigma, a, c in zip(fit.sigma, plain, grazing):
            total = np.maximum(a + c, 1e-9)
            weight = float(total.max()) if fit.fresnel == "none" else float(total.mean())
            root = np.sqrt(np.clip(a / total, 1e-4, 0.2))
            ones = np.ones(3)
            rows[0].append(np.concatenate([[np.log(sigma), weight], a / weight, ones]))
            rows[1].append(np.concatenate([[np.log(sigma), weight], 0 * a, (1 + root) / (1 - root)]))
            rows[2].append(np.concatenate([[np.log(sigma), 0.9 / len(fit.sigma)], a * len(fit.sigma), ones]))
        return [np.clip(np.concatenate(row), self.low, self.high) for row in rows], False
