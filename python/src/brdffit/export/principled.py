"""Shading models with one GGX lobe and one base colour, as their specifications tie them. SPDX-License-Identifier: MIT

glTF 2.0, appendix B, with KHR_materials_specular: of reflectance F_k = F0_k + (1 - F0_k)(1 - v.h)^5, F0_k = min(0.04 c_k, 1),

    dielectric = (1 - s max_k F_k) base / pi + s F_k lobe        metal = Schlick(base) lobe        mixed by metallic

UsdPreviewSurface with useSpecularWorkflow: (1 - F_k) diffuse / pi + F_k lobe; F_k of specularColor as above.

OpenPBR 1.1 without coat: metal = s F82(base, specular colour) lobe; dielectric = c F(eta) lobe + (1 - E(n.v)) base / pi, F exact,
E the lobe's directional albedo; mixed by metalness. Compensation of energy that microfacets scatter more than once is left
to renderers, and is not in here.
"""
from __future__ import annotations

import functools

import numpy as np

from .._arrays import Floats
from . import microfacet as m
from .conventions import Target
from .fitted import Fit
from .spaces import SIGMA_LEAST, coefficients


class _OneLobe:
    """ln sigma first, colours after it."""

    more = 0  # parameters after ln sigma

    def __init__(self, target: Target, distributions: tuple[str, ...]) -> None:
        self.target = target
        self.low = np.array([np.log(SIGMA_LEAST)] + [0.0] * self.more)
        self.high = np.array([np.log(target.sigma)] + [1.0] * self.more)

    def lobe(self, p: Floats, a: m.Angles) -> Floats:
        return m.lobe("ggx", self.target.masking, float(np.exp(p[0])), a)[:, None]

    def total(self, p: Floats) -> float:
        return 0.0  # the models take care of that

    def scaled(self, p: Floats, by: float) -> Floats:
        return p

    def guess(self, fit: Fit, chosen: list[int]) -> tuple[float, Floats, Floats, Floats]:
        """ln sigma, x, weight and F0 of the strongest lobe."""
        x, plain, grazing = coefficients(fit, chosen)
        p = int(np.argmax((plain + grazing).sum(1)))
        total = plain[p] + grazing[p]
        weight = np.full(3, max(float(total.mean()), 1e-6))
        f0 = plain[p] / np.maximum(total, 1e-12) if fit.fresnel == "schlick" else plain[p] / max(float(total.max()), 1.0)
        return float(np.log(fit.sigma[p])), np.clip(x, 0, 1), np.clip(weight, 0, 1), np.clip(f0, 0, 1)

    def inside(self, *rows: list[Floats | float]) -> list[Floats]:
        return [np.clip(np.concatenate([np.atleast_1d(one) for one in row]), self.low, self.high) for row in rows]


class Gltf(_OneLobe):
    """ln sigma, base (3), metallic, specular factor, F0 (3)."""

    more = 8

    def values(self, p: Floats, a: m.Angles) -> Floats:
        base, metallic, factor, f0 = p[1:4], p[4], p[5], p[6:9]
        g, f = self.lobe(p, a), m.schlick(f0, a)
        diffuse = np.multiply.outer(m.lambert(a), base) * (1 - factor * f.max(1, keepdims=True))
        return np.asarray((1 - metallic) * (diffuse + factor * f * g) + metallic * m.schlick(base, a) * g)

    def starts(self, fit: Fit, chosen: list[int]) -> tuple[list[Floats], bool]:
        sigma, x, weight, f0 = self.guess(fit, chosen)
        under = x / (1 - 0.9 * f0.max())
        return self.inside([sigma, under, 0.0, weight[0], f0], [sigma, under, 0.0, 1.0, f0 * weight],
                           [sigma, f0, 0.95, weight[0], f0], [sigma, 0.5 * (x + f0), 0.5, weight[0], f0 * weight]), False


class Usd(_OneLobe):
    """ln sigma, diffuse (3), specular (3)."""

    more = 6

    def values(self, p: Floats, a: m.Angles) -> Floats:
        f = m.schlick(p[4:7], a)
        return np.asarray(np.multiply.outer(m.lambert(a), p[1:4]) * (1 - f) + f * self.lobe(p, a))

    def starts(self, fit: Fit, chosen: list[int]) -> tuple[list[Floats], bool]:
        sigma, x, weight, f0 = self.guess(fit, chosen)
        return self.inside([sigma, x, f0 * weight], [sigma, x / np.maximum(1 - f0 * weight, 0.1), f0 * weight],
                           [sigma + 0.7, x, f0 * weight]), False


class OpenPbr(_OneLobe):
    """ln sigma, base (3), metalness, specular weight, specular colour (3), ior less 1 (in [0, 2])."""

    more = 9
    _NODES = np.linspace(0.02, 1, 10)

    def __init__(self, target: Target, distributions: tuple[str, ...]) -> None:
        super().__init__(target, distributions)
        self.high[-1] = 2.0

    @staticmethod
    def eta(p: Floats) -> float:
        """The index, as specular_weight modulates it."""
        ior = 1 + p[9]
        root = np.sqrt(min(0.99999, p[5] * ((ior - 1) / (ior + 1)) ** 2))
        return float((1 + root) / (1 - root))

    @functools.lru_cache(maxsize=64)  # noqa: B019 (one object an export)
    def _albedo(self, alpha: float, eta: float) -> Floats:
        return m.albedo("ggx", self.target.masking, alpha, lambda at: m.dielectric(eta, at.vh), self._NODES)

    def values(self, p: Floats, a: m.Angles) -> Floats:
        base, metalness, weight, colour = p[1:4], p[4], p[5], p[6:9]
        eta, g = self.eta(p), self.lobe(p, a)
        seen = np.interp(a.nv, self._NODES, self._albedo(float(np.exp(p[0])), eta))
        diffuse = np.multiply.outer(m.lambert(a) * (1 - seen), base)
        plastic = diffuse + np.multiply.outer(m.dielectric(eta, a.vh), colour) * g
        return np.asarray((1 - metalness) * plastic + metalness * weight * m.f82(base, colour, a) * g)

    def starts(self, fit: Fit, chosen: list[int]) -> tuple[list[Floats], bool]:
        sigma, x, weight, f0 = self.guess(fit, chosen)
        root = np.sqrt(min(0.2, f0.mean() * weight.mean()))
        eta = (1 + root) / (1 - root)
        return self.inside([sigma, x, 0.0, 1.0, weight, eta - 1], [sigma, f0, 0.95, weight[0], np.ones(3), 0.5],
                           [sigma, 0.5 * (x + f0), 0.5, weight[0], np.ones(3), 0.5]), False
