"""The figures of a report. Each function returns (svg, caption) pairs. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .. import _words
from .._arrays import Floats
from ..boxes import Boxes
from . import _analysis as analysis
from ._analysis import Material
from ._png import data_uri
from ._svg import BOTTOM, LEFT, RIGHT, TOP, WIDTH, Axis, Plot, label, number, polar

Figure = tuple[str, str]
MOST_VIEWS = 6
MOST_DOTS = 4000


def channel_kind(material: Material, k: int) -> str:
    names = [name.lower() for name in material.samples.channels]
    return "c%d" % (k % 3 if len(names) != 1 else 3) if sorted(names) != ["b", "g", "r"] else "c%d" % "rgb".index(names[k])


def shown_channels(material: Material) -> list[int]:
    """All of three or fewer; of many, the first, middle and last."""
    count = len(material.samples.channels)
    return list(range(count)) if count <= 3 else [0, count // 2, count - 1]


def legend(material: Material) -> str:
    import html

    items = ["<span class='key %s'>%s</span>" % (channel_kind(material, k), html.escape(material.samples.channels[k]))
             for k in shown_channels(material)]
    return "<p class='legend'>%s<span>dots: measured, lines: fitted; pale: skipped by the fit</span></p>" % "".join(items)


def _thin(index: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    return index if len(index) <= MOST_DOTS else index[np.linspace(0, len(index) - 1, MOST_DOTS).astype(int)]


# ---- Measured against fitted -------------------------------------------------


def by_view(material: Material) -> list[tuple[Figure, Figure]]:
    """Per view and plane of light: linear and logarithmic."""
    out = []
    found = analysis.series(material.samples)
    if len(found) > MOST_VIEWS:  # the in-plane ones first, spread over the view angles
        plane = [s for s in found if s.azimuth == 0] or found
        found = [plane[i] for i in sorted(set(np.linspace(0, len(plane) - 1, min(MOST_VIEWS, len(plane))).round().astype(int)))]
    for one in found:
        out.append((_view(material, one, False), _view(material, one, True)))
    return out


def _view(material: Material, one: analysis.Series, log: bool) -> Figure:
    at = analysis.places(material)
    radiance, used = at.radiance[one.index], at.used[one.index]
    span = float(max(np.abs(one.angle).max(), 1))
    angles = np.linspace(one.angle.min(), one.angle.max(), 181)
    light, view = analysis.along(one, angles)
    curve = material.main.predict(light, view, quantity="radiance")
    shown = shown_channels(material)
    high = float(max(radiance[:, shown].max(), curve[:, shown].max())) * 1.05 or 1.0
    if log:
        positive = np.concatenate([radiance[:, shown].ravel(), curve[:, shown].ravel()])
        positive = positive[positive > 0]
        low = float(max(positive.min(), positive.max() * 1e-5)) / 1.3 if len(positive) else 0.1
        y = Axis(low, high * 1.3, log=True)
    else:
        y = Axis(min(0.0, float(radiance[:, shown].min())), high)
    where = "in the plane of incidence" if one.azimuth == 0 else "%s° out of the plane of incidence" % label(one.azimuth)
    what = "view at %s°, light %s%s" % (label(one.view_angle), where, ", logarithmic" if log else "")
    plot = Plot(Axis(min(-5.0, float(one.angle.min())) - 0.03 * span, float(one.angle.max()) + 0.03 * span), y,
                "angle of the light (°)", "radiance", "Measured against fitted radiance, " + what)
    for k in shown:
        kind = channel_kind(material, k)
        plot.line(angles, curve[:, k], "line " + kind)
        plot.dots(one.angle[used], radiance[used, k], kind)
        plot.dots(one.angle[~used], radiance[~used, k], kind + " skipped")
    return plot.svg(), what[0].upper() + what[1:]


def against(material: Material) -> Figure:
    """Fitted over measured, for samples of any arrangement."""
    at = analysis.places(material)
    index = _thin(np.flatnonzero(at.used))
    fitted = material.main.predict_samples(material.samples, quantity="radiance")
    shown = shown_channels(material)
    values = np.concatenate([at.radiance[index][:, shown].ravel(), fitted[index][:, shown].ravel()])
    values = values[values > 0]
    low, high = (float(max(values.min(), values.max() * 1e-5)), float(values.max())) if len(values) else (0.1, 1.0)
    plot = Plot(Axis(low / 1.2, high * 1.2, True), Axis(low / 1.2, high * 1.2, True), "measured radiance", "fitted radiance",
                "Fitted over measured radiance of every sample")
    plot.line(np.array([low / 1.2, high * 1.2]), np.array([low / 1.2, high * 1.2]), "line faint")
    for k in shown:
        plot.dots(at.radiance[index, k], fitted[index, k], channel_kind(material, k), 1.6)
    return plot.svg(), "Fitted over measured, all used samples; the diagonal is a perfect fit"


def polar_plots(material: Material) -> list[Figure]:
    out = []
    s = material.samples
    plane = [one for one in analysis.series(s) if one.azimuth == 0]
    picked = [plane[i] for i in sorted({0, len(plane) // 2, len(plane) - 1})] if plane else []
    for one in picked:
        angles = np.linspace(-89.5, 89.5, 359)
        curve = material.main.predict(*analysis.along(one, angles), quantity="brdf")
        at = analysis.places(material)
        brdf = at.radiance[one.index] / np.maximum(at.cos_light[one.index], 1e-9)[:, None]
        near = np.abs(one.angle) <= material.options.max_incidence + 1e-6
        shown = shown_channels(material)
        # Beyond the incidences that were fitted the curve is an extrapolation: not drawn.
        reach = np.abs(angles) <= max(float(np.abs(one.angle[near]).max(initial=0)), 1)
        what = "View at %s° (left of the normal), light in the plane of incidence" % label(one.view_angle)
        out.append((polar([(angles[reach], curve[reach, k], "line " + channel_kind(material, k)) for k in shown],
                          [(one.angle[near], brdf[near, k], channel_kind(material, k)) for k in shown],
                          "Polar plot of f_r. " + what), what))
    return out


# ---- The proof ---------------------------------------------------------------


def profile(material: Material, lobes: int) -> Figure:
    """Smallest E^2 over one roughness, above the bound that the search proved."""
    fit, boxes = material.fits[lobes], material.boxes[lobes]
    sigma = analysis.sigma_axis(material, lobes, analysis.GRID_ONE if lobes == 1 else analysis.GRID_TWO)
    sigma = np.unique(np.concatenate([sigma, np.clip(fit.sigma, sigma[0], sigma[-1])]))
    curve = analysis.objective(material, sigma, lobes)
    if curve is not None and lobes == 2:
        curve = curve.min(axis=1)
    edges, bound = analysis.bound_steps(boxes, float(sigma[0]), float(sigma[-1]))
    top = float(np.max(curve if curve is not None else bound)) or 1.0
    low = min([v for v in (fit.e2, top) if v > 0], default=0.1) / 2
    near = analysis.near_optimal(material, lobes, 0.01)
    name = "E²" if fit.norm == "l2" else _words.OBJECTIVES[fit.norm]
    plot = Plot(Axis(float(sigma[0]), float(sigma[-1]), True), Axis(low, max(top, low * 4) * 1.2, True), "roughness σ", name,
                "Profile of %s over roughness with the certified lower bound, %s" % (name, _words.lobes_word(fit)))
    for a, b in near:
        plot.band(a, b, "near")
    plot.line(np.repeat(edges, 2)[1:-1], np.maximum(np.repeat(bound, 2), low / 2), "line bound")
    if curve is not None:
        plot.line(sigma, curve, "line exact")
    plot.dots(fit.sigma, np.full(fit.lobes, fit.e2), "best", 3.2)
    other = "" if lobes == 1 else ", whatever the other lobe"
    words = "%s: %s; below the lower line is nothing, proven. " % (_words.lobes_word(fit), (
        "the upper line is the smallest %s with a lobe of that σ%s" % (name, other)) if curve is not None else name + other)
    words += "Models within 1 %% of the optimum have σ in %s, proven." % " and ".join(
        "[%s, %s]" % (_words.directed(a, 4, False), _words.directed(b, 4, True)) for a, b in near)
    return plot.svg(), words


def _raster(boxes: Boxes, first: Floats, second: Floats) -> Floats:
    """Proven bound at each pair; boxes are painted in the order of the search, so that the smallest is on top."""
    out = np.full((len(first), len(second)), -np.inf)
    for (l1, l2), (h1, h2), bound in zip(boxes.sigma_low, boxes.sigma_high, boxes.lower_bound):
        i = slice(int(np.searchsorted(first, l1)), int(np.searchsorted(first, h1, "right")))
        j = slice(int(np.searchsorted(second, l2)), int(np.searchsorted(second, h2, "right")))
        tile = out[i, j]
        np.maximum(tile, bound, out=tile)
    return np.asarray(np.maximum(out, out.T))


_RAMP = np.array([[253, 231, 37], [94, 201, 98], [33, 145, 140], [59, 82, 139], [68, 1, 84]], float)


def box_map(material: Material) -> Figure:
    """The (sigma_1, sigma_2) plane as the search saw it."""
    fit, boxes = material.fits[2], material.boxes[2]
    height = WIDTH - LEFT - RIGHT + TOP + BOTTOM  # square
    size = 480
    edge = analysis.sigma_axis(material, 2, size + 1)
    middle = np.sqrt(edge[1:] * edge[:-1])
    bound = _raster(boxes, middle, middle)
    level = np.log10(np.maximum(bound, fit.e2 * 1e-6) / fit.e2) if fit.e2 > 0 else np.zeros_like(bound)
    top = max(float(np.quantile(level, 0.98)), 0.05)
    part = np.clip(level / top, 0, 1) ** 0.5 * (len(_RAMP) - 1)
    at = np.minimum(part.astype(int), len(_RAMP) - 2)
    colour = _RAMP[at] + (_RAMP[at + 1] - _RAMP[at]) * (part - at)[..., None]
    # Rows of a picture go down, sigma_2 goes up; only the half sigma_1 <= sigma_2 was searched.
    image = np.concatenate([colour, np.full((size, size, 1), 255.0)], -1).transpose(1, 0, 2)[::-1].copy()
    i, j = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    image[..., 3][(j > size - 1 - i)] = 0
    axis_x, axis_y = Axis(float(edge[0]), float(edge[-1]), True), Axis(float(edge[0]), float(edge[-1]), True)
    plot = Plot(axis_x, axis_y, "σ of the sharper lobe", "σ of the wider lobe", "Map of the boxes that the search visited",
                height)
    plot.raw("<image x='%s' y='%s' width='%s' height='%s' preserveAspectRatio='none' href='%s'/>" % (
        number(LEFT), number(TOP), number(WIDTH - LEFT - RIGHT), number(height - TOP - BOTTOM),
        data_uri(np.clip(image.round(), 0, 255).astype(np.uint8))))
    plot.raw("<clipPath id='half'><path d='M%s %sV%sH%sZ'/></clipPath><path class='boxes' clip-path='url(#half)' d='%s'/>" % (
        number(LEFT), number(height - BOTTOM), number(TOP), number(WIDTH - RIGHT), _outlines(boxes, axis_x, axis_y)))
    plot.dots(fit.sigma[:1], fit.sigma[1:], "best", 3.2)
    caption = ("All %s boxes of the search. Colour is what was proven of a box: yellow ones reach down to the optimum, and the "
               "darker, the further above it every model in them lies. The boxes shrink around the fit (the dot) because "
               "nowhere else can a better one be." % format(len(boxes), ","))
    return plot.svg(), caption


def _outlines(boxes: Boxes, x: Axis, y: Axis) -> str:
    low_x, high_x = x.place(boxes.sigma_low[:, 0]), x.place(boxes.sigma_high[:, 0])
    low_y, high_y = y.place(boxes.sigma_low[:, 1]), y.place(boxes.sigma_high[:, 1])
    parts = []
    for a, b, c, d in zip(np.maximum(low_x, LEFT - 1), high_x, np.minimum(low_y, y.start + 1), high_y):
        if b - a >= 0.4 and c - d >= 0.4 and b > LEFT and d < y.start:
            parts.append("M%s %sH%sV%sH%sZ" % (number(a), number(c), number(b), number(d), number(a)))
    return "".join(parts)


# ---- Residuals ----------------------------------------------------------------


def residuals(material: Material) -> list[Figure]:
    at = analysis.places(material)
    fitted = material.main.predict_samples(material.samples, quantity="radiance")
    off = 100 * (at.radiance - fitted) / material.main.channel_scale
    out = []
    for name, angle in (("angle of the light", at.incidence), ("half angle", at.half)):
        index = _thin(np.flatnonzero(np.isfinite(angle)))
        used = index[at.used[index]]
        if len(used) == 0:
            continue
        shown = shown_channels(material)
        span = float(np.abs(off[used][:, shown]).max()) * 1.1 or 1.0
        others = index[~at.used[index] & (at.cos_light[index] > 0)]
        right = float(angle[np.concatenate([used, others])].max()) + 2
        plot = Plot(Axis(-2.0, right), Axis(-span, span), name + " (°)", "residual (% of max)", "Residuals over the " + name)
        plot.line(np.array([-2.0, right]), np.zeros(2), "line faint")
        for k in shown:
            plot.dots(angle[used], off[used, k], channel_kind(material, k), 1.7)
            plot.dots(angle[others], off[others, k], channel_kind(material, k) + " skipped", 1.7)
        out.append((plot.svg(), "Measured less fitted, over the %s" % name))
    return out
