"""What a report shows, as numbers: fits, profiles, series. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import functools
import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _lobes, _terms, _words
from .._arrays import Floats
from ..boxes import Boxes, fit_boxes
from ..compare import Comparison, compare
from ..errors import BrdffitError
from ..fit import Fit
from ..fit import fit as brdffit_fit
from ..merl import MerlTable, load_merl
from ..options import Options
from ..readers.rgl import RGLMaterial, load_rgl
from ..samples import Samples

# Points of the exact curves, with one lobe, two and three, and of large tables: they evaluate every sample at each.
GRID, GRID_LARGE = {1: 240, 2: 72, 3: 24}, 40
LARGE = 100_000


# A share, and per lobe the smallest and largest sigma that a model within (1 + share) of the fit's objective can have,
# certified. 1 %, or what the gap that was asked for can tell.
Near = tuple[float, list[tuple[float, float]]]


@dataclasses.dataclass
class Material:
    """One file: its fits with one lobe and with those that were asked for (`main`), by their number.

    views: what is drawn over the angle of the light: the samples, or, when a whole table was fitted, the table looked up
    at the paper's views; None where there are no directions
    """

    name: str
    samples: Samples
    table: MerlTable | RGLMaterial | None
    options: Options
    fits: dict[int, Fit]
    boxes: dict[int, Boxes]
    leaves: dict[int, npt.NDArray[np.bool_]]
    near: dict[int, Near]
    views: Samples | None
    comparison: Comparison | None = None

    @property
    def main(self) -> Fit:
        return self.fits[self.options.lobe_count]


def measure(name: str, samples: Samples, options: dict[str, Any], lobes: int | Sequence[str],
            models: Sequence[str | Sequence[str]] | None = None) -> Material:
    """models: forms to compare as well, with the same options, norm and distribution excepted."""
    asked = Options(**{**options, "lobes": lobes})
    one = asked.replace(lobes=1, distribution=asked.distributions[0])
    table: MerlTable | RGLMaterial | None = None
    if samples.format == "merl" and samples.file is not None:
        table = load_merl(samples.file, bins=samples.merl_bins or "edge")
    elif samples.format == "rgl" and samples.file is not None:
        table = load_rgl(samples.file)
    fits, boxes, leaves, near = {}, {}, {}, {}
    for count, of in {1: one, asked.lobe_count: asked}.items():
        members: dict[str, Any] = {f.name: getattr(of, f.name) for f in dataclasses.fields(of)}
        fits[count], boxes[count] = fit_boxes(samples, **members)
        leaves[count] = leaf(boxes[count])
        near[count] = near_optimal(samples, of, fits[count], boxes[count], leaves[count])
    views = samples if _in_series(samples, table is not None) else None if table is None else _look_up(table, samples.channels)
    shared: Any = {key: value for key, value in options.items() if key not in ("distribution", "norm", "lobes")}
    comparison = None if models is None else compare(samples, models, **shared)
    return Material(name, samples, table, asked, fits, boxes, leaves, near, views, comparison)


def _in_series(samples: Samples, has_table: bool) -> bool:
    """Whether lines over the angle of the light can be drawn through the samples themselves. Where a table can be looked
    up instead, half of them have to be on lines of at least 30 degrees."""
    if samples.form != "directions":
        return False
    return not has_table or 2 * sum(len(one.index) for one in series(samples) if np.ptp(one.angle) >= 30) >= len(samples)


def _look_up(table: MerlTable | RGLMaterial, channels: tuple[str, ...]) -> Samples:
    """The table in the plane of incidence of the paper's four views, every 2.5 degrees of the light."""
    angle, view_angle = (np.radians(a.ravel()) for a in np.meshgrid(np.arange(-85, 85.1, 2.5), [0.0, 20, 40, 60]))
    zero = np.zeros_like(angle)
    light = np.stack([np.sin(angle), zero, np.cos(angle)], -1)
    view = np.stack([-np.sin(view_angle), zero, np.cos(view_angle)], -1)
    values = table.lookup(light, view)
    known = ~np.isnan(values).any(1)
    return Samples.from_arrays(light[known], view[known], values[known], channels=channels)


@dataclasses.dataclass
class Places:
    """Angles of the samples in degrees (NaN where the form has no such thing), radiance, and why the fit left one out: a
    key of _words.SKIPPED, or "" for those that it used."""

    reason: npt.NDArray[np.str_]
    cos_light: Floats
    incidence: Floats
    view: Floats
    half: Floats
    radiance: Floats

    @property
    def used(self) -> npt.NDArray[np.bool_]:
        return np.asarray(self.reason == "")


def places(s: Samples, limit: float) -> Places:
    count = len(s)
    if s.form == "coefficients":
        assert s.c is not None
        nan = np.full(count, np.nan)
        return Places(_reasons(s, np.ones(count), np.ones(count), 90.0), np.ones(count), nan, nan,
                      np.degrees(np.arctan(np.sqrt(s.c))), s.values)
    if s.form == "angles":
        assert s.cos_light is not None and s.cos_view is not None and s.tan2_half is not None
        nl, nv, half = s.cos_light, s.cos_view, np.degrees(np.arctan(np.sqrt(s.tan2_half)))
    else:
        l, v, n = _frames(s)
        h = l + v
        nl, nv = np.sum(n * l, 1), np.sum(n * v, 1)
        half = np.degrees(np.arctan2(np.linalg.norm(np.cross(n, h), axis=1), np.sum(n * h, 1)))
    radiance = s.values if s.quantity == "radiance" else s.values * nl[:, None]
    light, view = (np.degrees(np.arccos(np.clip(c, -1, 1))) for c in (nl, nv))
    return Places(_reasons(s, nl, nv, limit), nl, light, view, half, radiance)


def _reasons(s: Samples, nl: Floats, nv: Floats, limit: float) -> npt.NDArray[np.str_]:
    """In the library's order: the first that applies."""
    weightless = np.zeros(len(s), bool) if s.weights is None else ~(s.weights > 0)
    # 60 degrees from a file in degrees is 60, whatever the rounding of its cosine.
    oblique = nl < (0 if limit >= 90 else np.cos(np.radians(limit))) - 1e-12
    return np.select([weightless, ~(nl > 0), ~(nv > 0), oblique],
                     ["zero_weight", "light_below_horizon", "view_below_horizon", "incidence"], "")


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


def series(samples: Samples | None) -> list[Series]:
    """Of at least 4 angles each; by view angle, in-plane first."""
    if samples is None or samples.form != "directions":
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
        if len(np.unique(np.round(signed[index], 2))) >= 4:
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


def objective(material: Material, sigma: Floats | Sequence[Floats], lobes: int) -> Floats | None:
    """Smallest E^2 at each sigma (of several lobes: each combination, an axis a lobe), by plain non-negative least squares:
    independent of the search. sigma: for every lobe, or a list of them. None where another norm is fitted."""
    if material.options.norm != "l2":
        return None
    s, fit = material.samples, material.fits[lobes]
    grids = [sigma] * lobes if isinstance(sigma, np.ndarray) else list(sigma)
    # Lobes of a distribution share their columns, behind the diffuse ones: `each` to a lobe.
    fixed, each = 1 + _terms.more_columns(fit.diffuse), 1 if fit.fresnel == "none" else 2
    first = [0] * lobes
    wanted: list[tuple[str, float]] = []
    for name, same in _lobes.kinds(fit.distributions):
        for p in range(same.start, same.stop):
            first[p] = len(wanted)
            if p + 1 == same.stop or grids[p + 1] is not grids[p]:
                wanted += [(name, float(v)) for v in grids[p]]
    n = fixed + each * len(wanted)
    gram, t, total = np.zeros((n, n)), np.zeros((n, len(s.channels))), 0.0
    for start in range(0, len(s), LARGE // 2):
        part = _part(s, slice(start, start + LARGE // 2))
        at = places(part, material.options.incidence)
        used = np.flatnonzero(at.used)
        if len(used) == 0:
            continue
        part, data = _part(part, used), at.radiance[used] / fit.channel_scale
        root = np.ones((len(part), 1)) if part.weights is None else np.sqrt(part.weights)[:, None]
        columns = [*(_column(fit, part, *wanted[0], diffuse=f) for f in range(fixed)),
                   *(_column(fit, part, *one, f0=1.0 - second) for one in wanted for second in range(each))]
        matrix = np.stack(columns, 1) * root
        gram += matrix.T @ matrix
        t += matrix.T @ (data * root)
        total += float(np.sum((data * root) ** 2))
    length = np.sqrt(np.diag(gram))
    length[length == 0] = 1
    gram, t = gram / np.outer(length, length), t / length[:, None]
    chosen = np.meshgrid(*(fixed + each * (at + np.arange(len(grid))) for at, grid in zip(first, grids)), indexing="ij")
    index = np.stack([*(np.full_like(chosen[0], f) for f in range(fixed)),
                      *(one + second for one in chosen for second in range(each))], -1)
    gain = np.sum([_gain(gram, t[:, k], index) for k in range(t.shape[1])], axis=0)
    return np.asarray(np.maximum(total - gain, 0))


def _part(s: Samples, rows: slice | npt.NDArray[np.intp]) -> Samples:
    members: dict[str, Any] = {f.name: getattr(s, f.name) for f in dataclasses.fields(s)}
    for name, value in members.items():
        if isinstance(value, np.ndarray) and name != "_merl_directions":
            members[name] = value[rows]
    return Samples(**members)


def _column(fit: Fit, s: Samples, name: str, sigma: float, diffuse: int | None = None, f0: float = 0.0) -> Floats:
    """Of the diffuse term, by number, or of a lobe."""
    x = np.array([float(f == diffuse) for f in range(1 + _terms.more_columns(fit.diffuse))])
    one = dataclasses.replace(fit, lobes=1, distribution=name, distributions=(name,), sigma=np.array([sigma]), x=x[:1],
                              y=np.array([[float(diffuse is None)]]), channels=("",), x_more=x[None, 1:] if len(x) > 1 else None,
                              f0=None if fit.f0 is None else np.array([[f0]]))
    column: Floats = one.predict_samples(s, quantity="radiance")[:, 0]
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


def same_kind(fit: Fit, p: int) -> slice:
    """The lobes of the distribution of lobe p."""
    return next(same for _, same in _lobes.kinds(fit.distributions) if same.start <= p < same.stop)


def sigma_limits(fit: Fit, p: int) -> tuple[float, float]:
    """The range of a lobe's sigma that the proof is about: what was searched, whichever way it was given, or less."""
    if math.isfinite(fit.proven_sigma[p][0]):
        return float(fit.proven_sigma[p][0]), float(fit.proven_sigma[p][1])
    if fit.parameters[p] == "sigma" or fit.exponent_range is None:
        return fit.sigma_range
    least, most = fit.exponent_range
    return most**-0.5, least**-0.5


def sigma_span(material: Material, lobes: int, p: int = 0) -> tuple[float, float]:
    """What is worth looking at of the range that was searched for the lobes of lobe p's kind."""
    fit = material.fits[lobes]
    low, high = sigma_limits(fit, p)
    low = max(low, min(0.01, float(fit.sigma[same_kind(fit, p)][0]) / 4), 1e-4)
    return min(low, high / 1.01), high


def sigma_grid(material: Material, lobes: int, p: int = 0) -> Floats:
    """Logarithmic, denser around the fit's lobes of lobe p's kind."""
    low, high = sigma_span(material, lobes, p)
    count = min(GRID[lobes], GRID_LARGE if len(material.samples) > LARGE else GRID[lobes])
    fit = material.fits[lobes]
    near = [found * np.geomspace(0.7, 1.4, 9 if lobes < 3 else 5) for found in fit.sigma[same_kind(fit, p)]]
    return np.unique(np.clip(np.concatenate([np.geomspace(low, high, count), *near]), low, high))


def near_optimal(samples: Samples, options: Options, fit: Fit, boxes: Boxes, leaves: npt.NDArray[np.bool_]) -> Near:
    """Every box outside is proven worse."""
    share = max(0.01, 2 * fit.relative_gap)
    level = (1 + share) * fit.e2
    keep = leaves & (boxes.lower_bound <= level)
    out = []
    for p in range(fit.lobes):
        low, high = boxes.sigma_low[keep, p], boxes.sigma_high[keep, p]
        out.append((float(min([fit.sigma[p], *low])), float(max([fit.sigma[p], *high]))))
    if fit.norm == "l2" and fit.e2 > 0 and len(samples) <= LARGE:
        # The search halved no box that was already worse than the fit, even if by less than the share. Searches of a part
        # of the range say more: if all lobes are below some sigma, so is the widest one; if above, the sharpest one. A range
        # is that of a parameter: it has to be one distribution's alone.
        for _, same in _lobes.kinds(fit.distributions):
            first, last = same.start, same.stop - 1
            by = fit.parameters[first]
            if fit.parameters.count(by) == same.stop - same.start:
                shrink = functools.partial(_shrink, samples, options, level, by, sigma_limits(fit, first))
                out[last] = (shrink(out[last][0], float(fit.sigma[last])), out[last][1])
                out[first] = (out[first][0], shrink(out[first][1], float(fit.sigma[first])))
    return share, out


def _shrink(samples: Samples, options: Options, level: float, by: str, limits: tuple[float, float], end: float,
            inside: float) -> float:
    """`end`, moved towards `inside` as far as the range beyond it is proven to hold nothing below `level`. by: the parameter
    whose range that is; limits: in terms of sigma"""
    below = end < inside
    members = {f.name: getattr(options, f.name) for f in dataclasses.fields(options)}
    members["box_budget"] = min(options.box_budget, 10000)
    for _ in range(12):
        middle = float(np.sqrt(end * inside))
        low, high = (limits[0], middle) if below else (middle, limits[1])
        if not high > low > 0:
            break
        if by == "exponent":  # a little more than the range, so that rounding leaves nothing out
            members["exponent_range"] = (high**-2 * (1 - 1e-12), low**-2 * (1 + 1e-12))
        else:
            members["sigma_range"] = (low, high)
        try:
            worse = brdffit_fit(samples, **members).lower_bound > level
        except BrdffitError:  # no range of its own: nothing is proven there
            break
        if worse:
            end = middle
        else:
            inside = middle
    return end


def bound_steps(boxes: Boxes, leaves: npt.NDArray[np.bool_], low: float, high: float,
                which: slice = slice(None)) -> tuple[Floats, Floats]:
    """Edges, and the bound between each two: no model with a lobe of such a sigma (whatever the others) has less.
    which: lobes that are looked at, all of one distribution"""
    bounds = boxes.lower_bound[leaves]
    sides = [(boxes.sigma_low[leaves, p], boxes.sigma_high[leaves, p]) for p in range(boxes.sigma_low.shape[1])[which]]
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
    """Boxes that were not split. A box shares a corner with the one that it was cut from, and of those that have that
    corner the latest is the smallest: so its parent is the smallest of the latest at its corners."""
    out = np.ones(len(boxes), bool)
    latest: dict[tuple[tuple[bool, float], ...], int] = {}
    level = boxes.level.tolist()
    for i, (low, high) in enumerate(zip(boxes.sigma_low.tolist(), boxes.sigma_high.tolist())):
        corners = list(itertools.product(*(((False, a), (True, b)) for a, b in zip(low, high))))
        around = [latest[c] for c in corners if c in latest]
        if around:
            out[max(around, key=level.__getitem__)] = False
        for c in corners:
            latest[c] = i
    return out


def more_lobes(material: Material) -> str | None:
    """What the lobes beside the first are worth, in words that the bounds allow."""
    one, more = material.fits[1], material.main
    if more.lobes == 1 or not more.lower_bound > 0:
        return None
    what = _words.OBJECTIVES[more.norm]
    alone = "one lobe" if len(set(more.distributions)) == 1 else "one %s lobe" % _lobes.title(one.distributions[0])
    others, s, they = ("The second lobe", "s", "is") if more.lobes == 2 else ("The other lobes", "", "are")
    most, least = one.e2 / more.lower_bound, one.lower_bound / more.e2
    if one.e2 <= more.e2:
        return "%s %s of no use: %s fits as well." % (others, they, alone)
    if most < 1.01:
        return "%s lower%s the %s by at most %s %%, proven: one is enough." % (
            others, s, what, _words.directed(100 * (1 - 1 / most), 2, True))
    if most < 2:
        return "With %s the %s is between %s %% and %s %% larger, proven." % (
            alone, what, _words.directed(100 * max(least - 1, 0), 3, False), _words.directed(100 * (most - 1), 3, True))
    return "With %s the %s is between %s and %s times as large, proven." % (
        alone, what, _words.directed(max(least, 1), 3, False), _words.directed(most, 3, True))
