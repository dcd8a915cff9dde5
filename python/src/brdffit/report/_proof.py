"""The figures of a proof: profiles of the objective, and the map of boxes. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .. import _lobes, _words
from .._arrays import Floats
from ..boxes import Boxes
from ..fit import Fit
from . import _analysis as analysis
from ._analysis import Material
from ._png import data_uri
from ._svg import BOTTOM, LEFT, RIGHT, TOP, WIDTH, Axis, Plot, label, number

Figure = tuple[str, str]


# ---- Roughness in the distribution's own terms ---------------------------------


def _axis(fit: Fit, p: int, low: float, high: float) -> Axis:
    if fit.parameters[p] == "sigma":
        return Axis(low, high, True)
    return Axis(low, high, True, lambda sigma: sigma**-2, lambda n: n**-0.5)


def _title(fit: Fit, p: int) -> str:
    of = "" if len(set(fit.distributions)) == 1 else ", " + _lobes.title(fit.distributions[p])
    return ("roughness σ" if fit.parameters[p] == "sigma" else "exponent n (σ = 1/√n)") + of


def interval(fit: Fit, p: int, low: float, high: float) -> str:
    """Of lobe p's sigma; rounded outwards, so that what is said stays true. Ends of the range searched say nothing."""
    name, (least, most) = _words.parameter(fit, p), analysis.sigma_limits(fit, p)
    below, above = low > least * (1 + 1e-9), high < most * (1 - 1e-9)
    if fit.parameters[p] == "exponent":
        low, high, below, above = high**-2, low**-2, above, below
    first, last = _words.directed(low, 4, False), _words.directed(high, 4, True)
    if below and above:
        return "%s in [%s, %s]" % (name, first, last)
    return "%s ≥ %s" % (name, first) if below else "%s ≤ %s" % (name, last) if above else "any %s" % name


def near_optimal_words(material: Material, lobes: int) -> str:
    fit = material.fits[lobes]
    if not fit.e2 > 0:
        return ""
    share, intervals = material.near[lobes]
    found = [interval(fit, p, *pair) for p, pair in enumerate(intervals)]
    what = _words.OBJECTIVES[fit.norm]
    if all(words.startswith("any ") for words in found):
        return "Of the roughness of models whose %s is within %.3g %% of the optimum, the search proved nothing." % (
            what, 100 * share)
    which = found if lobes == 1 else ["%s in its %s" % pair for pair in zip(found, _lobes.each_lobe(fit.distributions))]
    among = "a model" if not _words.is_cut(fit) else "among the models that the proof is about, one"
    return "Proven: %s whose %s is within %.3g %% of the optimum has %s." % (
        among, what, 100 * share, " and ".join([", ".join(which[:-1]), which[-1]] if lobes > 1 else which))


_SHORT = {"unresolved": "lobe %d not resolved", "flat": "lobe %d: roughness not determined", "unused": "lobe %d unused",
          "at_limit": "lobe %d at the limit"}


def warned(fit: Fit) -> list[str]:
    """The warnings in a few words each."""
    return [_SHORT.get(word, word + " (lobe %d)") % (p + 1) for p, words in enumerate(fit.warnings)
            for word in words if word == "unused" or "unused" not in words]


# ---- Profile -------------------------------------------------------------------


def profiles(material: Material, lobes: int) -> list[Figure]:
    """Smallest E^2 over one roughness, above the bound that the search proved: a figure for each distribution."""
    fit = material.fits[lobes]
    grids: list[Floats] = []
    for _, same in _lobes.kinds(fit.distributions):
        grids += [analysis.sigma_grid(material, lobes, same.start)] * (same.stop - same.start)
    curve = analysis.objective(material, grids, lobes)
    return [_profile(material, lobes, same, grids[same.start], None if curve is None else np.asarray(curve.min(axis=tuple(
        p for p in range(lobes) if p != same.start)))) for _, same in _lobes.kinds(fit.distributions)]


def _profile(material: Material, lobes: int, same: slice, sigma: Floats, curve: Floats | None) -> Figure:
    fit, boxes, first = material.fits[lobes], material.boxes[lobes], same.start
    edges, bound = analysis.bound_steps(boxes, material.leaves[lobes], float(sigma[0]), float(sigma[-1]), same)
    top = float(np.max(curve if curve is not None else bound)) or 1.0
    low = min([v for v in (fit.e2, top) if v > 0], default=0.1) / 2
    name = _words.OBJECTIVES[fit.norm]
    family = _lobes.count_word(lobes) if len(set(fit.distributions)) == 1 else _lobes.each(fit.distributions)
    plot = Plot(_axis(fit, first, float(sigma[0]), float(sigma[-1])), Axis(low, max(top, low * 4) * 1.2, True),
                _title(fit, first), name, "Profile of %s over roughness with the certified lower bound, %s" % (name, family))
    if fit.e2 > 0:
        for a, b in material.near[lobes][1][same]:
            plot.band(a, b, "near")
    plot.line(np.repeat(edges, 2)[1:-1], np.maximum(np.repeat(bound, 2), low / 2), "line bound")
    if curve is not None:
        plot.line(sigma, curve, "line exact")
    plot.dots(fit.sigma[same], np.full(same.stop - first, fit.e2), "best", 3.2)
    words = family
    if lobes > 1:
        alone = same.stop - first == 1
        words += ": over the %s of %s, whatever that of the other%s" % (
            _words.parameter(fit, first), "one" if same.stop - first == lobes else "%s %s lobe" % (
                "the" if alone else "one", _lobes.title(fit.distributions[first])), "" if lobes == 2 else "s")
    if bound.min() < low:
        words += "; where no bound is seen, it is below the frame"
    return plot.svg(), words + ". " + near_optimal_words(material, lobes)


# ---- Map -----------------------------------------------------------------------


def _raster(boxes: Boxes, first: Floats, second: Floats) -> Floats:
    """Proven bound at each pair; boxes are painted in the order of the search, so that the smallest is on top."""
    out = np.full((len(first), len(second)), -np.inf)
    for (l1, l2), (h1, h2), bound in zip(boxes.sigma_low, boxes.sigma_high, boxes.lower_bound):
        i = slice(int(np.searchsorted(first, l1)), int(np.searchsorted(first, h1, "right")))
        j = slice(int(np.searchsorted(second, l2)), int(np.searchsorted(second, h2, "right")))
        tile = out[i, j]
        np.maximum(tile, bound, out=tile)
    return out


_RAMP = np.array([[253, 231, 37], [94, 201, 98], [33, 145, 140], [59, 82, 139], [68, 1, 84]], float)


def box_map(material: Material) -> Figure:
    """The (sigma_1, sigma_2) plane as the search saw it: of lobes of one distribution, its half."""
    fit, boxes = material.fits[2], material.boxes[2]
    alike = len(set(fit.distributions)) == 1
    height = WIDTH - LEFT - RIGHT + TOP + BOTTOM  # square
    size = 480
    edges = [np.geomspace(*analysis.sigma_span(material, 2, p), size + 1) for p in range(2)]
    bound = _raster(boxes, *(np.sqrt(edge[1:] * edge[:-1]) for edge in edges))
    if alike:
        bound = np.maximum(bound, bound.T)
    level = np.log10(np.maximum(bound, fit.e2 * 1e-6) / fit.e2) if fit.e2 > 0 else np.zeros_like(bound)
    top = max(float(np.quantile(level, 0.98)), 0.05)
    colour = _ramp(np.clip(level / top, 0, 1) ** 0.5)
    # Rows of a picture go down, sigma_2 goes up; only the half sigma_1 <= sigma_2 was searched.
    image = np.concatenate([colour, np.full((size, size, 1), 255.0)], -1).transpose(1, 0, 2)[::-1].copy()
    i, j = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    if alike:
        image[..., 3][(j > size - 1 - i)] = 0
    axis_x, axis_y = (_axis(fit, p, float(edge[0]), float(edge[-1])) for p, edge in enumerate(edges))
    titles = ["%s of the %s" % (_words.parameter(fit, p), lobe) for p, lobe in enumerate(_lobes.each_lobe(fit.distributions))]
    plot = Plot(axis_x, axis_y, titles[0], titles[1], "Map of the boxes that the search visited", height)
    plot.raw(_image(image, LEFT, TOP, WIDTH - LEFT - RIGHT, height - TOP - BOTTOM))
    half = "Z" if alike else "V%sZ" % number(height - BOTTOM)
    plot.raw("<clipPath id='half'><path d='M%s %sV%sH%s%s'/></clipPath><path class='boxes' clip-path='url(#half)' d='%s'/>" % (
        number(LEFT), number(height - BOTTOM), number(TOP), number(WIDTH - RIGHT), half, _outlines(boxes, axis_x, axis_y)))
    plot.dots(fit.sigma[:1], fit.sigma[1:], "best", 3.2)
    plot.raw(_scale(height, 10**top, alike))
    seen = _visible(boxes, axis_x, axis_y)
    some = "" if seen.all() else ", of which %s are wide enough to be outlined" % format(int(seen.sum()), ",")
    caption = ("All %s boxes of the search%s. The colour is what was proven of a box: the darker, the further every model in it "
               "lies above the fit (the dot); only the bright ones can hold a better one, and none that is better by more than "
               "the gap between the fit and its bound." % (format(len(boxes), ","), some))
    return plot.svg(), caption


def _image(pixels: Floats, x: float, y: float, width: float, height: float) -> str:
    return "<image x='%s' y='%s' width='%s' height='%s' preserveAspectRatio='none' href='%s'/>" % (
        number(x), number(y), number(width), number(height), data_uri(np.clip(pixels.round(), 0, 255).astype(np.uint8)))


def _ramp(part: Floats) -> Floats:
    """Colours at 0 to 1."""
    place = np.clip(part, 0, 1) * (len(_RAMP) - 1)
    at = np.minimum(place.astype(int), len(_RAMP) - 2)
    return np.asarray(_RAMP[at] + (_RAMP[at + 1] - _RAMP[at]) * (place - at)[..., None])


def _scale(height: float, most: float, free: bool) -> str:
    """In the corner that the search leaves free: there the first lobe would be the wider one. Or on a ground of its own."""
    width, y = 116.0, height - BOTTOM - 34
    x = WIDTH - RIGHT - 10 - width
    ground = "" if free else "<rect class='ground' x='%s' y='%s' width='%s' height='50'/>" % (
        number(x - 6), number(y - 20), number(width + 12))
    return ground + _image(_ramp(np.linspace(0, 1, 64)[None, :]), x, y, width, 9) + (
        "<text x='%s' y='%s' text-anchor='end'>proven of any model</text><text x='%s' y='%s'>as the fit</text>"
        "<text x='%s' y='%s' text-anchor='end'>%s ×</text>" % (
            number(x + width), number(y - 5), number(x), number(y + 21), number(x + width), number(y + 21),
            "≥ " + label(float("%.2g" % most))))


def _sides(boxes: Boxes, x: Axis, y: Axis) -> tuple[Floats, Floats, Floats, Floats]:
    """Left, right, bottom and top on the screen."""
    return (np.maximum(x.place(boxes.sigma_low[:, 0]), LEFT - 1), x.place(boxes.sigma_high[:, 0]),
            np.minimum(y.place(boxes.sigma_low[:, 1]), y.start + 1), y.place(boxes.sigma_high[:, 1]))


def _visible(boxes: Boxes, x: Axis, y: Axis) -> npt.NDArray[np.bool_]:
    a, b, c, d = _sides(boxes, x, y)
    return np.asarray((b - a >= 0.4) & (c - d >= 0.4))


def _outlines(boxes: Boxes, x: Axis, y: Axis) -> str:
    seen = _visible(boxes, x, y)
    return "".join("M%s %sH%sV%sH%sZ" % (number(a), number(c), number(b), number(d), number(a))
                   for a, b, c, d in zip(*(side[seen] for side in _sides(boxes, x, y))) if b > LEFT and d < y.start)
