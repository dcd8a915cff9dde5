"""What renderers compute, by their own published formulas, in double precision. SPDX-License-Identifier: MIT

Radiance f_r (n.l) of unit vectors l and v, N x 3. Written from the renderers' sources and specifications, and not from the
library: an export's error is that of these against `Fit.predict`, and the tests hold them against the renderers themselves.
"""
from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .._arrays import Floats


class Angles(NamedTuple):
    """Of pairs of directions above the surface, N each."""

    nl: Floats
    nv: Floats
    tan2: Floats  # of the half vector
    vh: Floats
    versine: Floats  # 1 - v.h
    sin2_l: Floats
    sin2_v: Floats


def angles(light: Floats, view: Floats) -> Angles:
    """Of unit vectors around +z."""
    half, apart = light + view, light - view
    across = (half[:, :2] ** 2).sum(1)
    vh = 0.5 * np.sqrt(across + half[:, 2] ** 2)
    return Angles(light[:, 2], view[:, 2], across / half[:, 2] ** 2, vh, 0.25 * (apart ** 2).sum(1) / (1 + vh),
                  (light[:, :2] ** 2).sum(1), (view[:, :2] ** 2).sum(1))


def _side(distribution: str, alpha: float, cosine: Floats, sin2: Floats) -> Floats:
    """cos (1 + 2 Lambda). Of Beckmann the rational approximation of Walter et al. (2007), which Mitsuba and Cycles have: up to
    0.31 % of G1."""
    if distribution == "ggx":
        return np.sqrt(cosine ** 2 + alpha ** 2 * sin2)
    c = cosine / np.maximum(alpha * np.sqrt(sin2), cosine / 1.6)
    return np.asarray(cosine * (1 + 2 * np.where(c < 1.6, (1 - 1.259 * c + 0.396 * c * c) / (3.535 * c + 2.181 * c * c), 0)))


def lobe(distribution: str, masking: str, alpha: float, a: Angles) -> Floats:
    """D G / (4 n.v): F = 1. distribution: "ggx" or "beckmann"; masking: "smith" or "smith-separable"."""
    secant2 = 1 + a.tan2
    if distribution == "ggx":
        normals = alpha ** 2 * (secant2 / (alpha ** 2 + a.tan2)) ** 2 / math.pi
    else:
        normals = np.exp(-a.tan2 / alpha ** 2) * secant2 ** 2 / (math.pi * alpha ** 2)
    l, v = _side(distribution, alpha, a.nl, a.sin2_l), _side(distribution, alpha, a.nv, a.sin2_v)
    if masking == "smith":
        return normals * 0.5 * a.nl / (a.nv * l + a.nl * v)
    return normals * a.nl / ((a.nl + l) * (a.nv + v))


def lambert(a: Angles) -> Floats:
    """Of reflectance 1."""
    return a.nl / math.pi


def schlick(f0: Floats, a: Angles) -> Floats:
    """N x K of K reflectances at normal incidence."""
    return np.asarray(f0 + np.multiply.outer(a.versine ** 5, 1 - f0))


def f82(f0: Floats, tint: Floats, a: Angles) -> Floats:
    """Kutz, Hasan and Edmondson 2021: Schlick's, less what makes it `tint` times that at 82 degrees (cosine 1/7)."""
    bar = 1 / 7
    drop = (f0 + (1 - f0) * (1 - bar) ** 5) * (1 - tint) / (bar * (1 - bar) ** 6)
    return schlick(f0, a) - np.multiply.outer(a.vh * a.versine ** 6, drop)


def dielectric(eta: float, cosine: Floats) -> Floats:
    """Exact, unpolarised, from outside."""
    inner = np.sqrt(np.maximum(0.0, 1 - (1 - cosine ** 2) / eta ** 2))
    across, along = (cosine - eta * inner) / (cosine + eta * inner), (eta * cosine - inner) / (eta * cosine + inner)
    return np.asarray((across ** 2 + along ** 2) / 2)


def extinction(eta: Floats, base: Floats) -> Floats:
    """k of a conductor whose reflectance at normal incidence is a dielectric's of that eta, and `base` of what is left."""
    least = ((eta - 1) / (eta + 1)) ** 2
    r = np.minimum(least + base * (1 - least), 0.9999)
    return np.asarray(np.sqrt(np.maximum(0.0, (r * (eta + 1) ** 2 - (eta - 1) ** 2) / (1 - r))))


def conductor(eta: Floats, k: Floats, cosine: Floats) -> Floats:
    """Exact Fresnel factor of the complex index eta - i k, N x K."""
    c = np.asarray(cosine)[:, None]
    c2, s2 = c * c, 1 - c * c
    t0 = eta * eta - k * k - s2
    both = np.sqrt(t0 * t0 + 4 * eta * eta * k * k)
    a = np.sqrt(np.maximum(0.0, 0.5 * (both + t0)))
    t1, t2 = both + c2, 2 * c * a
    across = (t1 - t2) / (t1 + t2)
    t3, t4 = c2 * both + s2 * s2, t2 * s2
    return np.asarray(across * (1 + (t3 - t4) / (t3 + t4)) / 2)


def albedo(distribution: str, masking: str, alpha: float, fresnel: object, cosines: Floats) -> Floats:
    """Directional albedo of a lobe times a Fresnel factor of Angles, at each cosine of the viewer: by GGX's visible normals."""
    side = 24
    u1, u2 = (g.ravel() for g in np.meshgrid((np.arange(side) + 0.5) / side, (np.arange(side) + 0.5) / side))
    out = []
    for nv in cosines:
        sine = math.sqrt(1 - nv * nv)
        w = np.array([alpha * sine, 0.0, nv]) / math.hypot(alpha * sine, nv)
        r, phi = np.sqrt(u1), 2 * math.pi * u2
        p, half = r * np.cos(phi), 0.5 * (1 + w[2])
        q = (1 - half) * np.sqrt(1 - p * p) + half * r * np.sin(phi)
        t = np.sqrt(np.maximum(0.0, 1 - p * p - q * q))
        n = np.stack([alpha * (t * w[0] - q * w[2]), alpha * p, np.maximum(1e-12, t * w[2] + q * w[0])], 1)
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        view = np.array([sine, 0.0, nv])
        light = 2 * (n @ view)[:, None] * n - view
        up = light[:, 2] > 0
        a = angles(light[up], np.broadcast_to(view, (int(up.sum()), 3)))
        ggx_side = _side("ggx", alpha, a.nv, a.sin2_v)
        density = lobe("ggx", "smith", alpha, a) * (a.nv * _side("ggx", alpha, a.nl, a.sin2_l) + a.nl * ggx_side) / (
            a.nl * (a.nv + ggx_side))
        out.append(float((lobe(distribution, masking, alpha, a) * fresnel(a) / density).sum()) / len(u1))  # type: ignore[operator]
    return np.array(out)
