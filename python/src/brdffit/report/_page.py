"""Pages: one of each material, and an index. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import html
from collections.abc import Iterable

import numpy as np

from .. import _lobes, _terms, _words
from .._version import __version__
from ..fit import Fit
from . import _analysis as analysis
from . import _plots as plots
from . import _proof as proof
from . import _spheres as spheres
from ._analysis import Material
from ._style import CSS


def document(title: str, body: str) -> str:
    return ("<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><meta name='viewport' content='width=device-width, "
            "initial-scale=1'><title>%s</title><link rel='icon' href='data:,'><style>%s</style></head><body>%s<p class='soft'>"
            "Made by brdffit %s.</p></body></html>\n") % (html.escape(title), CSS, body, __version__)


def _figure(figure: tuple[str, str], kind: str = "") -> str:
    svg, caption = figure
    return "<figure%s>%s<figcaption>%s</figcaption></figure>" % (" class='%s'" % kind if kind else "", svg,
                                                                 html.escape(caption))


def _grid(figures: Iterable[tuple[str, str]], kind: str = "") -> str:
    return "<div class='grid'>%s</div>" % "".join(_figure(f, kind) for f in figures)


def _paragraph(text: str) -> str:
    return "<p>%s</p>" % html.escape(text)


def _badge(material: Material) -> str:
    certified = material.main.certified
    return "<span class='badge%s'>%s</span>" % (("", "certified") if certified else (" open", "not proven to its gap"))


def _fit(material: Material, lobes: int) -> str:
    fit = material.fits[lobes]
    tables = "".join("<div class='scroll'>%s</div>" % _words.html_table(rows)
                     for rows in (_words.lobe_table(fit), _words.channel_table(fit), *_terms.tables(fit)))
    words = "".join(_paragraph(text) for text in (
        fit.certificate, proof.near_optimal_words(material, lobes), *_words.warnings(fit)) if text)
    head = _lobes.each(fit.distributions)
    if len(set(fit.distributions)) == 1:
        head = "%s with %s" % (_lobes.title(fit.distributions[0]), _lobes.count_word(lobes))
    return "<h2>%s</h2><div class='tables'>%s</div><div class='certificate%s'>%s</div>" % (
        html.escape(head[0].upper() + head[1:]), tables, "" if fit.certified else " open", words)


def _models(material: Material) -> str:
    """Nothing where none were compared."""
    found = material.comparison
    if found is None:
        return ""
    counted = "%s observations, counted as %.0f" % (format(found.observations, ","), found.effective_observations)
    return "<h2>Which model</h2><p class='soft'>%s; p: parameters; * the best, = not told from it, ? not proven</p>%s%s" % (
        html.escape(counted), "<div class='scroll keep'>%s</div>" % _words.html_table(found.table),
        "".join(map(_paragraph, found.words)))


def _pairs(views: Iterable[tuple[str, str, str]]) -> str:
    return "<div class='views'>%s</div>" % "".join(
        "<figure><div class='pair'>%s%s</div><figcaption>%s</figcaption></figure>" % (linear, log, html.escape(caption))
        for linear, log, caption in views)


def _views(material: Material) -> str:
    words = "dots: measured, lines: fitted; pale: skipped by the fit"
    if material.views is not None and material.views is not material.samples:
        words = "dots: the measured table, lines: fitted; pale: beyond the incidence that was fitted"
    parts = ["<h2>Measured against fitted</h2>", plots.legend(material, words)]
    views, more, hidden = plots.by_view(material)
    parts.append(_pairs(views))
    if more:
        note = "" if not hidden else _paragraph("%s more are not drawn." % format(hidden, ","))
        parts.append("<details><summary>%d more, mostly out of the plane of incidence</summary>%s%s</details>" % (
            len(more), _pairs(more), note))
    if material.views is not material.samples or not views:
        parts.append(_figure(plots.against(material), "wide"))
    polar = plots.polar_plots(material)
    if polar:
        parts += ["<h2>In the plane of incidence</h2>",
                  _paragraph("f_r over the angle of the light; the lines end where the fit's data do."), _grid(polar)]
    return "".join(parts)


def _proof(material: Material) -> str:
    name = _words.OBJECTIVES[material.main.norm]
    parts = ["<h2>The proof</h2>"]
    extra = analysis.more_lobes(material)
    if extra is not None:
        parts.append(_paragraph(extra))
    curve = "<span class='key exact'>smallest %s with a lobe of that roughness, by plain least squares</span>" % name
    parts.append("<p class='legend'>%s<span class='key bound'>proven: no model is below</span>"
                 "<span class='key near square'>near-optimal, proven</span>"
                 "<span class='key c0'>the fit</span></p>" % (curve if material.main.norm == "l2" else ""))
    figures = [figure for lobes in sorted(material.fits) for figure in proof.profiles(material, lobes)]
    if 2 in material.boxes:
        figures.append(proof.box_map(material))
    return "".join(parts) + _grid(figures)


def _spheres(material: Material) -> str:
    rendered = spheres.render(material)
    balls = "".join("<figure class='ball'><img width='%d' height='%d' alt='%s' src='%s'><figcaption>%s</figcaption></figure>" % (
        spheres.SIZE, spheres.SIZE, html.escape(caption, quote=True), uri, html.escape(caption))
        for uri, caption in rendered.pictures)
    return "<h2>Spheres</h2>%s<div class='balls'>%s</div>" % ("".join(map(_paragraph, rendered.words)), balls)


def _residuals(material: Material) -> str:
    fit = material.main
    rows = [["samples", "count"], ["used", format(fit.samples_used, ",")]]
    for reason, _ in _words.SKIPPED:
        count = fit.samples_skipped.get(reason, 0)
        if count:
            rows.append(["skipped: " + _why(fit, reason), format(count, ",")])
    return "<h2>Residuals and skipped samples</h2>%s%s<div class='scroll keep'>%s</div>%s" % (
        plots.legend(material, "pale: skipped by the fit"), _grid(plots.residuals(material)), _words.html_table(rows),
        _skipped(material))


def _why(fit: Fit, reason: str) -> str:
    words = dict(_words.SKIPPED)[reason]
    return words % fit.max_incidence if "%" in words else words


MOST_LISTED = 200


def _skipped(material: Material) -> str:
    """Which ones, by name."""
    s, fit = material.samples, material.main
    at = analysis.places(s, fit.max_incidence)
    index = np.flatnonzero(~at.used)
    if len(index) == 0:
        return ""
    first = index[:MOST_LISTED]
    shown = plots.shown_channels(material)
    rows = [["sample" if s.lines is None else "line", "light", "viewer", *(s.channels[k] for k in shown), "why"]]
    for i in first:
        rows.append([str(int(i) if s.lines is None else int(s.lines[i])), _angle(at.incidence[i]), _angle(at.view[i]),
                     *("%.4g" % s.values[i, k] for k in shown), _why(fit, str(at.reason[i]))])
    title = "The skipped samples" if len(first) == len(index) else "The first %d of %s skipped samples" % (
        len(first), format(len(index), ","))
    return "<details><summary>%s</summary><div class='scroll'>%s</div></details>" % (title, _words.html_table(rows))


def _angle(degrees: float) -> str:
    return "%.4g°" % degrees if degrees == degrees else ""


def _source(material: Material) -> str:
    s, fit = material.samples, material.main
    out = "%s: %s samples of %d channel%s" % (
        s.file or "arrays", format(len(s), ","), len(s.channels), "" if len(s.channels) == 1 else "s")
    if s.merl_samples is not None:
        which = {"84": "the paper's 84 directions of the table", "table": "every cell of the table"}
        out += ", %s, bins by their %s" % (which.get(s.merl_samples, "looked-up directions"), s.merl_bins)
    return "%s. Values are %s; the norm is %s, relative gap %.3g. %s" % (
        out, "BRDF values in 1/sr" if s.quantity == "brdf" else "radiance", fit.norm, fit.relative_gap, _words.WEIGHTS[s.weighting])


def _crowded(material: Material) -> str:
    """A warning, or nothing."""
    if material.samples.weighting != "none" or not material.samples.crowded():
        return ""
    return "<div class='certificate open'>%s</div>" % _paragraph(
        "Warning: most samples crowd where the material is bright, and the fit is to that part of the directions. "
        "--weight solid-angle fits all of them.")


def material_page(material: Material, index: str | None) -> str:
    top = "" if index is None else "<p class='noprint'><a href='%s'>All materials</a></p>" % html.escape(index, quote=True)
    order = sorted(material.fits, reverse=True)
    if order[0] != material.options.lobe_count:
        order.reverse()
    head = "<h1>%s %s</h1><p class='soft'>%s</p>" % (
        html.escape(material.name), _badge(material), html.escape(_source(material)))
    body = [top, head, _crowded(material), *(_fit(material, lobes) for lobes in order), _models(material), _views(material),
            _proof(material),
            _spheres(material), _residuals(material)]
    return document("%s - brdffit" % material.name, "".join(body))
