"""Fresnel and diffuse terms from the definition (include/brdffit.h, theory 7.2), on top of model.py: radiance of a model
whose members have the names of `brdffit fit --json`.

SPDX-License-Identifier: MIT
"""
import math

import numpy as np

import model


def geometry(count, seed=3, v_h=None):
    """Light and view, count x 3 each, above the horizon; half of them near the mirror direction. v_h: of all of them."""
    rng = np.random.default_rng(seed)
    tilt = np.where(rng.random(count) < 0.5, rng.exponential(0.1, count), rng.uniform(0, 1.2, count))
    half = model.unit(np.degrees(tilt), rng.uniform(0, 360, count))
    difference = rng.uniform(0, 85, count) if v_h is None else np.degrees(np.arccos(np.full(count, v_h)))
    side = np.cross(half, rng.normal(size=(count, 3)))
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    angle = np.radians(difference)[:, None]
    light, view = (half * np.cos(angle) + sign * side * np.sin(angle) for sign in (1, -1))
    up = (light[:, 2] > 0.02) & (view[:, 2] > 0.02)
    return light[up], view[up]


def diffuse_columns(name, light, view):
    """count x columns, of radiance."""
    half = light + view
    half = half / np.linalg.norm(half, axis=1, keepdims=True)
    nl, nv, d = light[:, 2], view[:, 2], np.sum(view * half, 1)
    flat = nl / np.pi
    grazing = [(1 - cosine) ** 5 for cosine in (nl, nv)]
    if name == "oren-nayar":
        plane = np.sum(light[:, :2] * view[:, :2], 1)
        lengths = np.hypot(*light[:, :2].T) * np.hypot(*view[:, :2].T)
        azimuth = np.maximum(0, np.divide(plane, lengths, out=np.zeros_like(plane), where=lengths > 0))
        angle = np.arccos(np.stack([nl, nv]).clip(-1, 1))
        return np.stack([flat, flat * azimuth * np.sin(angle.max(0)) * np.tan(angle.min(0))], 1)
    if name == "burley":
        return np.stack([flat * (1 - grazing[0] / 2) * (1 - grazing[1] / 2),
                         flat * 2 * d ** 2 * (grazing[0] + grazing[1] - grazing[0] * grazing[1]),
                         flat * 4 * d ** 4 * grazing[0] * grazing[1]], 1)
    return flat[:, None] * (name == "lambert")


def smiths_lambda(name, sigma, cosine):
    """Of one direction: Heitz 2014, for GGX and Beckmann."""
    tangent = np.sqrt(1 - cosine ** 2) / cosine
    if name == "ggx":
        return (np.sqrt(1 + (sigma * tangent) ** 2) - 1) / 2
    a = 1 / (sigma * np.maximum(tangent, 1e-300))
    return (np.vectorize(math.erf)(a) - 1) / 2 + np.exp(-a ** 2) / (2 * a * math.sqrt(math.pi))


def masked(name, masking, sigma, light, view, b):
    """b of a lobe, with another masking than v-cavities."""
    if masking == "v-cavity":
        return b
    half = light + view
    nh = half[:, 2] / np.linalg.norm(half, axis=1)
    to_light, to_view = (smiths_lambda(name, sigma, d[:, 2]) for d in (light, view))
    g = {"none": 1.0, "smith": 1 / (1 + to_light + to_view), "smith-separable": 1 / ((1 + to_light) * (1 + to_view))}[masking]
    return g / (math.pi * view[:, 2] * nh ** 4)


def radiance(fit, light, view):
    """count x K."""
    x = np.asarray(fit["x"], float)[:, None]
    if fit.get("x_more") is not None:
        x = np.hstack([x, fit["x_more"]])
    out = diffuse_columns(fit["diffuse"], light, view) @ x.T
    half = light + view
    half = half / np.linalg.norm(half, axis=1, keepdims=True)
    w = (1 - np.sum(view * half, 1)) ** 5
    for p, (name, sigma) in enumerate(zip(fit["distributions"], fit["sigma"])):
        _, b, c, _, _ = model.directions_to_abc(light, view, distribution=name)
        b = masked(name, fit.get("masking", "v-cavity"), sigma, light, view, b)
        lobe = b * model.shape(name, sigma ** -2.0, c)
        y = np.asarray(fit["y"], float)[:, p]
        f0 = np.asarray(fit["f0"], float)[:, p] if fit["fresnel"] == "schlick" else np.ones(len(y))
        out = out + lobe[:, None] * y * (f0 + np.outer(w, 1 - f0))
    return out


def write(path, light, view, values, names=("r", "g", "b")):
    table = np.hstack([light, view, values])
    head = ",".join(["lx", "ly", "lz", "vx", "vy", "vz", *names[:values.shape[1]]])
    np.savetxt(path, table, fmt="%.17g", delimiter=",", header=head, comments="")
