"""The figures of measurement, fit and residuals. A figure is (svg, caption). SPDX-License-Identifier: MIT"""
from __future__ import annotations

import html

import numpy as np
import numpy.typing as npt

from . import _analysis as analysis
from ._analysis import Material
from ._svg import Axis, Plot, label, polar

Figure = tuple[str, str]
MOST_VIEWS, MOST_MORE = 12, 24
MOST_DOTS = 4000


def channel_kind(material: Material, k: int) -> str:
    names = [name.lower() for name in material.samples.channels]
    return "c%d" % (k % 3 if len(names) != 1 else 3) if sorted(names) != ["b", "g", "r"] else "c%d" % "rgb".index(names[k])


def shown_channels(material: Material) -> list[int]:
    """All of three or fewer; of many, the first, middle and last."""
    count = len(material.samples.channels)
    return list(range(count)) if count <= 3 else [0, count // 2, count - 1]


def legend(material: Material, words: str) -> str:
    items = ["<span class='key %s'>%s</span>" % (channel_kind(material, k), html.escape(material.samples.channels[k]))
             for k in shown_channels(material)]
    more = len(material.samples.channels) - len(items)
    if more:
        items.append("<span>and %d more channels, not drawn</span>" % more)
    return "<p class='legend'>%s<span>%s</span></p>" % ("".join(items), html.escape(words))


def _thin(index: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """At random, so that no pattern of the table shows; the same ones every time."""
    if len(index) <= MOST_DOTS:
        return index
    return np.sort(np.random.default_rng(0).choice(index, MOST_DOTS, replace=False))


def _thinned(shown: int, count: int) -> str:
    return "" if shown == count else "; %s of %s, drawn at random" % (format(shown, ","), format(count, ","))


# ---- Measured against fitted -------------------------------------------------


def by_view(material: Material) -> tuple[list[tuple[str, str, str]], list[tuple[str, str, str]], int]:
    """Per view and plane of light, the linear figure, the logarithmic one, and their caption: first those in the plane of
    incidence, spread over the view angles, then some of the others. And how many were left out."""
    found = analysis.series(material.views)
    plane = [s for s in found if s.azimuth == 0] or found
    first = [plane[i] for i in sorted(set(np.linspace(0, len(plane) - 1, min(MOST_VIEWS, len(plane))).round().astype(int)))]
    others = [s for s in found if not any(s is one for one in first)]
    return ([_view(material, one) for one in first], [_view(material, one) for one in others[:MOST_MORE]],
            max(len(others) - MOST_MORE, 0))


def _view(material: Material, one: analysis.Series) -> tuple[str, str, str]:
    assert material.views is not None
    at = analysis.places(material.views, material.options.incidence)
    radiance, used = at.radiance[one.index], at.used[one.index]
    # Every degree and every measured angle, so that a narrow peak is not cut between them.
    angles = np.unique(np.concatenate([np.linspace(one.angle.min(), one.angle.max(), 181), one.angle]))
    curve = material.main.predict(*analysis.along(one, angles), quantity="radiance")
    shown = shown_channels(material)
    where = "in the plane of incidence" if one.azimuth == 0 else "%s° out of the plane of incidence" % label(one.azimuth)
    what = "View at %s°, light %s" % (label(one.view_angle), where)
    values = np.concatenate([radiance[:, shown].ravel(), curve[:, shown].ravel()])
    span = float(max(np.abs(one.angle).max(), 1))
    figures = []
    for log in (False, True):
        plot = Plot(Axis(min(-5.0, float(one.angle.min())) - 0.03 * span, float(one.angle.max()) + 0.03 * span),
                    _scale(values, log), "angle of the light (°)", "radiance", "Measured against fitted radiance, %s%s" % (
                        what[0].lower() + what[1:], ", logarithmic" if log else ""))
        for k in shown:
            kind = channel_kind(material, k)
            plot.line(angles, curve[:, k], "line " + kind)
            plot.dots(one.angle[used], radiance[used, k], kind)
            plot.dots(one.angle[~used], radiance[~used, k], kind + " skipped")
        figures.append(plot.svg())
    zero = int(np.sum(radiance[:, shown] <= 0))
    note = "" if zero == 0 else "; %d measured value%s of 0 or less %s not on the logarithmic scale" % (
        zero, "" if zero == 1 else "s", "is" if zero == 1 else "are")
    return figures[0], figures[1], what + note


def _scale(values: npt.NDArray[np.float64], log: bool) -> Axis:
    high = float(values.max())
    if not log:
        return Axis(min(0.0, float(values.min())), high * 1.05 if high > 0 else 1.0)
    positive = values[values > 0]
    if len(positive) == 0:
        return Axis(0.1, 1.0, True)
    return Axis(float(max(positive.min(), high * 1e-5)) / 1.3, high * 1.3, True)


def against(material: Material) -> Figure:
    """Fitted over measured, for samples of any arrangement."""
    at = analysis.places(material.samples, material.options.incidence)
    used = np.flatnonzero(at.used)
    index = _thin(used)
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
    return plot.svg(), "Fitted over measured radiance of the samples that were used%s. On the line the fit is exact." % (
        _thinned(len(index), len(used)))


def polar_plots(material: Material) -> list[Figure]:
    out = []
    plane = [one for one in analysis.series(material.views) if one.azimuth == 0]
    picked = [plane[i] for i in sorted({0, len(plane) // 2, len(plane) - 1})] if plane else []
    for one in picked:
        assert material.views is not None
        at = analysis.places(material.views, material.options.incidence)
        near = at.used[one.index]
        if not near.any():
            continue
        angle = one.angle[near]
        brdf = at.radiance[one.index[near]] / np.maximum(at.cos_light[one.index[near]], 1e-9)[:, None]
        # Outside of what was fitted the curve is an extrapolation: not drawn.
        angles = np.unique(np.concatenate([np.linspace(angle.min(), angle.max(), 361), angle]))
        curve = material.main.predict(*analysis.along(one, angles), quantity="brdf")
        shown = shown_channels(material)
        what = "View at %s°, light in the plane of incidence" % label(one.view_angle)
        out.append((polar([(angles, curve[:, k], "line " + channel_kind(material, k)) for k in shown],
                          [(angle, brdf[:, k], channel_kind(material, k)) for k in shown], one.view_angle,
                          "Polar plot of f_r. " + what), what))
    return out


# ---- Residuals ----------------------------------------------------------------


def residuals(material: Material) -> list[Figure]:
    at = analysis.places(material.samples, material.options.incidence)
    fitted = material.main.predict_samples(material.samples, quantity="radiance")
    off = 100 * (at.radiance - fitted) / material.main.channel_scale
    shown = shown_channels(material)
    out = []
    for name, angle in (("angle of the light", at.incidence), ("angle of the viewer", at.view), ("half angle", at.half)):
        every = np.flatnonzero(np.isfinite(angle) & (at.cos_light > 0))
        index = _thin(every)
        used, others = index[at.used[index]], index[~at.used[index]]
        if len(used) == 0:
            continue
        span = float(np.abs(off[used][:, shown]).max()) * 1.1 or 1.0
        plot = Plot(Axis(-2.0, float(angle[index].max()) + 2), Axis(-span, span), name + " (°)",
                    "residual (% of max)" if material.main.normalise == "max" else "residual (%)", "Residuals over the " + name)
        plot.line(np.array([-2.0, 92.0]), np.zeros(2), "line faint")
        for k in shown:
            plot.dots(angle[used], off[used, k], channel_kind(material, k), 1.7)
            plot.dots(angle[others], off[others, k], channel_kind(material, k) + " skipped", 1.7)
        beyond = int(np.sum(np.abs(off[others][:, shown]) > span))
        note = "" if beyond == 0 else "; %s of skipped samples are beyond the frame" % format(beyond, ",")
        out.append((plot.svg(), "Measured less fitted, over the %s%s%s" % (name, _thinned(len(index), len(every)), note)))
    return out
