"""What a report shows, as numbers: fits, profiles, series. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import itertools
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _words
from .._arrays import Floats
from ..boxes import Boxes, fit_boxes
from ..fit import Fit
from ..merl import MerlTable, load_merl
from ..options import Options
from ..readers.rgl import RGLMaterial, load_rgl
from ..samples import Samples

# Exact curves evaluate every sample at every roughness: above this, the certified bound alone is drawn.
MOST_SAMPLES_OF_A_CURVE = 20000
GRID_ONE, GRID_TWO = 240, 72


@dataclasses.dataclass
class Material:
    """One file: its fits with one and with two lobes, `main` the one that was asked for."""

    name: str
    samples: Samples
    table: MerlTable | RGLMaterial | None
    options: Options
    fits: dict[int, Fit]
    boxes: dict[int, Boxes]

    @property
    def main(self) -> Fit:
        return self.fits[self.options.lobes]


def measure(name: str, samples: Samples, options: dict[str, Any], lobes: int) -> Material:
    table: MerlTable | RGLMaterial | None = None
    if samples.format == "merl" and samples.file is not None:
        table = load_merl(samples.file, bins=samples.merl_bins or "edge")
    elif samples.format == "rgl" and samples.file is not None:
        table = load_rgl(samples.file)
    fits, boxes = {}, {}
    for count in sorted({1, lobes}):
        fits[count], boxes[count] = fit_boxes(samples, **{**options, "lobes": count})
    return Material(name, samples, table, Options(**{**options, "lobes": lobes}), fits, boxes)


@dataclasses.dataclass
class Places:
    """Angles of the samples in degrees, radiance, and which of them the fit used; None where the form has no such thing."""

    used: npt.NDArray[np.bool_]
    cos_light: Floats
    incidence: Floats
    half: Floats
    radiance: Floats


def places(material: Material) -> Places:
    s, limit = material.samples, material.options.max_incidence
    if s.form == "coefficients":
        count = len(s)
        assert s.c is not None
        nan = np.full(count, np.nan)
        used = np.ones(count, bool) if s.weights is None else s.weights > 0
        return Places(used, np.ones(count), nan, np.degrees(np.arctan(np.sqrt(s.c))), s.values)
    if s.form == "angles":
        assert s.cos_light is not None and s.cos_view is not None and s.tan2_half is not None
        nl, nv, half = s.cos_light, s.cos_view, np.degrees(np.arctan(np.sqrt(s.tan2_half)))
    else:
        l, v, n = _frames(s)
        h = l + v
        nl, nv = np.sum(n * l, 1), np.sum(n * v, 1)
        half = np.degrees(np.arctan2(np.linalg.norm(np.cross(n, h), axis=1), np.sum(n * h, 1)))
    # 60 degrees from a file in degrees is 60, whatever the rounding of its cosine.
    used = (nl > 0) & (nv > 0) & (nl >= (0 if limit >= 90 else np.cos(np.radians(limit))) - 1e-12)
    if s.weights is not None:
        used &= s.weights > 0
    radiance = s.values if s.quantity == "radiance" else s.values * nl[:, None]
    return Places(used, nl, np.degrees(np.arccos(np.clip(nl, -1, 1))), half, radiance)


def _frames(s: Samples) -> tuple[Floats, Floats, Floats]:
    assert s.light is not None and s.view is not None
    normal = np.array([[0.0, 0.0, 1.0]]) if s.normal is None else s.normal
    l, v, n = (d / np.linalg.norm(d, axis=1, keepdims=True) for d in (s.light, s.view, normal))
    return l, v, np.broadcast_to(n, l.shape)


# ---- Series: one view, one plane of light ------------------------------------


@dataclasses.dataclass
class Series:
    """Samples of one view whose lights lie in one plane through the normal; signed angles, the mirror side positive."""

    view_angle: float
    azimuth: float  # of the plane against the view's, degrees in [0, 90]
    index: npt.NDArray[np.intp]
    angle: Floats


def series(samples: Samples) -> list[Series]:
    """Of at least 4 samples each; by view angle, in-plane first."""
    if samples.form != "directions":
        return []
    l, v, n = _frames(samples)
    view_angle = np.degrees(np.arccos(np.clip(np.sum(n * v, 1), -1, 1)))
    light_angle = np.degrees(np.arccos(np.clip(np.sum(n * l, 1), -1, 1)))
    turn = np.degrees(_azimuth(l, n) - _azimuth(v, n))
    turn = np.where(view_angle < 1e-6, np.degrees(_azimuth(l, n)) + 180, turn) % 360
    opposite = (turn > 90 + 1e-6) & (turn < 270 - 1e-6)  # the mirror side
    plane = np.where(opposite, turn - 180, (turn + 90) % 360 - 90)
    signed = np.where(opposite, light_angle, -light_angle)
    # Half spaces of the same plane at +-p look alike to an isotropic material.
    keys = np.stack([np.round(view_angle, 2), np.round(np.abs(plane), 1)], 1)
    keys[light_angle < 1e-6, 1] = np.nan  # along the normal: in every plane
    out = []
    for angle, azimuth in sorted({(float(a), float(p)) for a, p in keys if p == p}):
        mine = (keys[:, 0] == angle) & ((keys[:, 1] == azimuth) | np.isnan(keys[:, 1]))
        index = np.flatnonzero(mine)
        if len(index) >= 4:
            index = index[np.argsort(signed[index], kind="stable")]
            out.append(Series(angle, azimuth, index, signed[index]))
    return out


def _azimuth(d: Floats, n: Floats) -> Floats:
    """In the frame of the normal; of +z, the usual one."""
    side = np.where(np.abs(n[:, [0]]) < 0.9, np.array([[1.0, 0, 0]]), np.array([[0, 1.0, 0]]))
    side = side - n * np.sum(n * side, 1, keepdims=True)
    side = side / np.linalg.norm(side, axis=1, keepdims=True)
    return np.asarray(np.arctan2(np.sum(np.cross(n, side) * d, 1), np.sum(side * d, 1)))


def along(one: Series, angles: Floats) -> tuple[Floats, Floats]:
    """Light and view of a series at any signed angles, around +z."""
    theta, p = np.radians(angles), np.radians(one.azimuth)
    light = np.stack([np.sin(theta) * np.cos(p), np.sin(theta) * np.sin(p), np.cos(theta)], -1)
    t = np.radians(one.view_angle)
    return light, np.broadcast_to([-np.sin(t), 0, np.cos(t)], light.shape)


# ---- E at given roughness ----------------------------------------------------


def objective(material: Material, sigma: Floats, lobes: int) -> Floats | None:
    """Smallest E^2 at each sigma (of two lobes: at each pair), by plain non-negative least squares: independent of the
    search. None where it would be long, or another norm is fitted."""
    if material.options.norm != "l2" or len(material.samples) > MOST_SAMPLES_OF_A_CURVE:
        return None
    fit, at = material.fits[lobes], places(material)
    s = material.samples
    root = np.ones(len(s)) if s.weights is None else np.sqrt(s.weights)
    root = root[at.used]
    data = (at.radiance[at.used] / fit.channel_scale) * root[:, None]
    columns = [_column(fit, s, at, 1.0, sigma[0], 0.0), *(_column(fit, s, at, 0.0, t, 1.0) for t in sigma)]
    matrix = np.stack(columns, 1) * root[:, None]
    length = np.linalg.norm(matrix, axis=0)
    matrix = matrix / np.where(length > 0, length, 1)
    gram, t, total = matrix.T @ matrix, matrix.T @ data, np.sum(data * data)
    n = len(sigma)
    if lobes == 1:
        index = np.stack([np.zeros(n, int), 1 + np.arange(n)], -1)
    else:
        i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
        index = np.stack([np.zeros_like(i), 1 + i, 1 + j], -1)
    gain = np.sum([_gain(gram, t[:, k], index) for k in range(t.shape[1])], axis=0)
    return np.asarray(np.maximum(total - gain, 0))


def _column(fit: Fit, s: Samples, at: Places, x: float, sigma: float, y: float) -> Floats:
    one = dataclasses.replace(fit, lobes=1, sigma=np.array([sigma]), x=np.array([x]), y=np.array([[y]]), channels=("",))
    column: Floats = one.predict_samples(s, quantity="radiance")[at.used, 0]
    return column


def _gain(gram: Floats, t: Floats, index: npt.NDArray[Any]) -> Floats:
    """max over z >= 0 of 2 t.z - z'Mz for the columns of each row of `index`: every support is tried."""
    size = index.shape[-1]
    best = np.zeros(index.shape[:-1])
    for count in range(1, size + 1):
        for support in itertools.combinations(range(size), count):
            chosen = index[..., list(support)]
            m = gram[chosen[..., :, None], chosen[..., None, :]]
            # Equal columns: the smaller supports hold the answer, this one only must not divide by zero.
            m = m + 1e-13 * np.eye(count)
            right = t[chosen]
            z = np.linalg.solve(m, right[..., None])[..., 0]
            best = np.where(np.all(z >= 0, -1), np.maximum(best, np.sum(z * right, -1)), best)
    return np.asarray(best)


def sigma_axis(material: Material, lobes: int, count: int) -> Floats:
    """Logarithmic, over what is worth looking at of the range searched."""
    fit = material.fits[lobes]
    low, high = fit.sigma_range
    low = max(low, min(0.01, float(fit.sigma[0]) / 4), 1e-4)
    low = min(low, high / 1.01)
    return np.geomspace(low, high, count)


def near_optimal(material: Material, lobes: int, share: float) -> list[tuple[float, float]]:
    """Per lobe, the smallest and largest sigma that a model within (1 + share) of the optimum can have, certified: every
    box outside is proven worse."""
    fit, boxes = material.fits[lobes], material.boxes[lobes]
    keep = leaf(boxes) & (boxes.lower_bound <= (1 + share) * fit.e2)
    out = []
    for p in range(lobes):
        low, high = boxes.sigma_low[keep, p], boxes.sigma_high[keep, p]
        out.append((float(min([fit.sigma[p], *low])), float(max([fit.sigma[p], *high]))))
    return out


def bound_steps(boxes: Boxes, low: float, high: float) -> tuple[Floats, Floats]:
    """Edges, and the bound between each two: no model with a lobe of such a sigma (whatever the other lobe) has less."""
    leaves = leaf(boxes)
    bounds = boxes.lower_bound[leaves]
    sides = [(boxes.sigma_low[leaves, p], boxes.sigma_high[leaves, p]) for p in range(boxes.sigma_low.shape[1])]
    edges = np.unique(np.clip(np.concatenate([side for pair in sides for side in pair]), low, high))
    edges = np.unique(np.concatenate([[low], edges, [high]]))
    middle = np.sqrt(edges[1:] * edges[:-1])
    out = np.full(len(middle), np.inf)
    for a, b in sides:
        for l, h, bound in zip(a, b, bounds):
            at = slice(int(np.searchsorted(middle, l)), int(np.searchsorted(middle, h, "right")))
            out[at] = np.minimum(out[at], bound)
    return edges, np.where(np.isfinite(out), out, 0.0)


def leaf(boxes: Boxes) -> npt.NDArray[np.bool_]:
    """Boxes that were not split. Their centre lies in no later box."""
    with np.errstate(divide="ignore"):
        low, high = np.log(np.maximum(boxes.sigma_low, 1e-300)), np.log(boxes.sigma_high)
    centre = (low + high) / 2
    if centre.shape[1] == 2:  # a box on the diagonal is its half below it
        diagonal = (low[:, 0] == low[:, 1]) & (high[:, 0] == high[:, 1])
        width = high - low
        centre[diagonal, 0] -= 0.26 * width[diagonal, 0]
        centre[diagonal, 1] += 0.26 * width[diagonal, 1]
    out = np.ones(len(boxes), bool)
    for start in range(0, len(boxes), 512):  # pairs in blocks, so that memory stays small
        c = centre[start:start + 512]
        later = np.arange(len(boxes))[None, :] > np.arange(start, start + len(c))[:, None]
        inside = np.all((low[None] <= c[:, None]) & (c[:, None] <= high[None]), -1)
        out[start:start + len(c)] = ~np.any(later & inside, 1)
    return out


def second_lobe(material: Material) -> str | None:
    """What the second lobe is worth, in words that the bounds allow."""
    if 1 not in material.fits or 2 not in material.fits:
        return None
    one, two = material.fits[1], material.fits[2]
    if not two.lower_bound > 0:
        return None
    most, least = one.e2 / two.lower_bound, one.lower_bound / two.e2
    if one.e2 <= two.e2:
        return "The second lobe is of no use: one lobe fits as well."
    if most < 1.01:
        return "The second lobe is worth at most %.2g %% of E², proven: one is enough." % (100 * (most - 1))
    if most < 2:
        return "One lobe leaves an E² between %.3g %% and %.3g %% larger, proven." % (100 * max(least - 1, 0), 100 * (most - 1))
    return "One lobe leaves an E² between %s and %s times as large, proven." % (
        _words.directed(max(least, 1), 3, False), _words.directed(most, 3, True))



