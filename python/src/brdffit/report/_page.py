"""Pages: one of each material, and an index. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import html
from typing import Iterable, Sequence

from .. import _words
from .._version import __version__
from . import _analysis as analysis
from . import _plots as plots
from . import _spheres as spheres
from ._analysis import Material

CSS = """
:root{color-scheme:light dark;--bg:#fff;--ink:#1d2329;--soft:#5b6672;--line:#d8dee4;--card:#f6f8fa;--ok:#1a7f37;--bad:#9a6700;
--c0:#c62828;--c1:#2e7d32;--c2:#1e5fc1;--c3:#1d2329;--bound:#8250df;--near:#d4a72c40}
@media (prefers-color-scheme:dark){:root{--bg:#0f1418;--ink:#e4e9ee;--soft:#9aa6b2;--line:#2f3943;--card:#171e24;--ok:#4ac26b;
--bad:#d4a72c;--c0:#ff7b72;--c1:#56d364;--c2:#79b8ff;--c3:#e4e9ee;--bound:#c297ff;--near:#d4a72c40}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:1180px;padding:16px;background:var(--bg);color:var(--ink);font:16px/1.5 system-ui,sans-serif;
overflow-wrap:anywhere}
h1{font-size:1.6rem;line-height:1.25;margin:.4em 0}h2{font-size:1.2rem;margin:2em 0 .4em;border-bottom:1px solid var(--line)}
a{color:var(--c2)}p{max-width:46em}.soft{color:var(--soft)}
.tables{display:flex;flex-wrap:wrap;gap:8px 32px}.scroll{overflow-x:auto;max-width:100%}
table{border-collapse:collapse;font-size:.92rem;font-variant-numeric:tabular-nums}
th,td{white-space:nowrap;padding:3px 10px 3px 0;text-align:right;border-bottom:1px solid var(--line);overflow-wrap:normal}
th:first-child,td:first-child{text-align:left}thead th{color:var(--soft);font-weight:500}
.certificate{background:var(--card);border-left:4px solid var(--ok);padding:10px 14px;margin:12px 0}
.certificate.open{border-color:var(--bad)}.certificate p{margin:.3em 0}
.grid{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(310px,100%),1fr));gap:12px}
figure{margin:0;background:var(--card);padding:8px;border-radius:6px;min-width:0;break-inside:avoid}
figure svg,figure img{display:block;width:100%;max-width:520px;margin:auto;height:auto}
figure.wide{max-width:620px}figure.wide svg{max-width:600px}
figcaption{font-size:.85rem;color:var(--soft);padding:6px 4px 0}
figure.ball{flex:0 1 220px}.balls{display:flex;flex-wrap:wrap;gap:12px}
.legend{display:flex;flex-wrap:wrap;gap:4px 16px;font-size:.9rem;color:var(--soft)}
.key::before{content:"";display:inline-block;width:.7em;height:.7em;border-radius:50%;background:currentColor;margin-right:.4em}
svg text{font:11px system-ui,sans-serif;fill:var(--soft)}
svg .grid{display:inline;stroke:var(--line);stroke-width:.6;fill:none}
.frame{stroke:var(--soft);stroke-width:.8;fill:none}.line{fill:none;stroke-width:1.4}.faint{stroke:var(--soft);stroke-width:.8}
.dot{fill:none;stroke-linecap:round;stroke-opacity:.75}.skipped{stroke-opacity:.25}
.c0{stroke:var(--c0);color:var(--c0)}.c1{stroke:var(--c1);color:var(--c1)}.c2{stroke:var(--c2);color:var(--c2)}
.c3{stroke:var(--c3);color:var(--c3)}.bound{stroke:var(--bound)}.exact{stroke:var(--ink)}
.best{stroke:var(--c0);stroke-opacity:1}.near{fill:var(--near)}.boxes{fill:none;stroke:#fff;stroke-opacity:.45;stroke-width:.35}
@media (max-width:480px){table{font-size:.8rem}th,td{padding-right:7px}}
@media print{:root{--bg:#fff;--ink:#000;--card:#fff}body{max-width:none;padding:0;font-size:10pt}h2{break-after:avoid}
.grid{grid-template-columns:repeat(2,1fr)}figure{border:1px solid var(--line)}}
"""


def _document(title: str, body: str) -> str:
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


def _fit(material: Material, lobes: int) -> str:
    fit = material.fits[lobes]
    tables = "".join("<div class='scroll'>%s</div>" % _words.html_table(rows)
                     for rows in (_words.lobe_table(fit), _words.channel_table(fit)))
    words = "".join(_paragraph(text) for text in (fit.certificate, *_words.warnings(fit)))
    return "<h2>%s with %s</h2><div class='tables'>%s</div><div class='certificate%s'>%s</div>" % (
        html.escape(_words.TITLES[fit.distribution]), _words.lobes_word(fit), tables, "" if fit.certified else " open", words)


def _views(material: Material) -> str:
    parts = ["<h2>Measured against fitted</h2>", plots.legend(material)]
    pairs = plots.by_view(material)
    parts.append(_grid(f for pair in pairs for f in pair))
    parts.append(_grid([plots.against(material)], "wide") if not pairs else "")
    polar = plots.polar_plots(material)
    if polar:
        parts += ["<h2>In the plane of incidence</h2>",
                  _paragraph("f_r over the angle of the light; the lines end where the fit's data do."), _grid(polar)]
    return "".join(parts)


def _proof(material: Material) -> str:
    parts = ["<h2>The proof</h2>"]
    extra = analysis.second_lobe(material)
    if extra is not None:
        parts.append(_paragraph(extra))
    figures = [plots.profile(material, lobes) for lobes in sorted(material.fits)]
    if 2 in material.boxes:
        figures.append(plots.box_map(material))
    return "".join(parts) + _grid(figures)


def _spheres(material: Material) -> str:
    balls = "".join("<figure class='ball'><img width='%d' height='%d' alt='%s' src='%s'><figcaption>%s</figcaption></figure>" % (
        spheres.SIZE, spheres.SIZE, html.escape(caption, quote=True), uri, html.escape(caption))
        for uri, caption in spheres.render(material))
    note = "" if material.table is not None else _paragraph(
        "Samples of single directions give no picture of the measurement; a whole table (MERL) does.")
    return "<h2>Spheres</h2>%s<div class='balls'>%s</div>" % (note, balls)


def _residuals(material: Material) -> str:
    fit = material.main
    rows = [["samples", "count"], ["used", format(fit.samples_used, ",")]]
    for reason, words in _words.SKIPPED:
        count = fit.samples_skipped.get(reason, 0)
        if count:
            rows.append([words % fit.max_incidence if "%" in words else words, format(count, ",")])
    return "<h2>Residuals and skipped samples</h2>%s<div class='scroll'>%s</div>" % (
        _grid(plots.residuals(material)), _words.html_table(rows))


def material_page(material: Material, index: str | None) -> str:
    s = material.samples
    source = "%s, %s samples of %d channel%s" % (s.file or "arrays", format(len(s), ","), len(s.channels),
                                                 "" if len(s.channels) == 1 else "s")
    if s.merl_samples is not None:
        source += "; " + {"84": "the paper's 84 directions of the table", "table": "every cell of the table"}.get(
            s.merl_samples, "looked-up directions")
    top = "" if index is None else "<p><a href='%s'>All materials</a></p>" % html.escape(index, quote=True)
    order = sorted(material.fits, reverse=True)
    if order[0] != material.options.lobes:
        order.reverse()
    body = [top, "<h1>%s</h1><p class='soft'>%s</p>" % (html.escape(material.name), html.escape(source)),
            *(_fit(material, lobes) for lobes in order), _views(material), _proof(material), _spheres(material),
            _residuals(material)]
    return _document(material.name, "".join(body))


def index_page(rows: Sequence[tuple[str, str, Material]], failures: Sequence[tuple[str, str]]) -> str:
    table = [["material", "lobes", "σ", "RMS", "E² at most above the bound", "proof"]]
    for _, _, material in rows:
        fit = material.main
        above = "%s %%" % _words.directed(100 * (fit.e2 / fit.lower_bound - 1), 2, True) if fit.lower_bound > 0 else "—"
        table.append([material.name, str(fit.lobes), ", ".join("%.4g" % v for v in fit.sigma), "%.3g" % fit.rms_total,
                      above, "certified" if fit.certified else "open: " + fit.stop])
    text = _words.html_table(table)
    for link, name, _ in rows:
        text = text.replace("<th scope='row'>%s</th>" % html.escape(name),
                            "<th scope='row'><a href='%s'>%s</a></th>" % (html.escape(link, quote=True), html.escape(name)), 1)
    bad = "".join("<li>%s: %s</li>" % (html.escape(a), html.escape(b)) for a, b in failures)
    if bad:
        text += "<h2>Failed</h2><ul>%s</ul>" % bad
    return _document("brdffit report", "<h1>%d materials</h1><div class='scroll'>%s</div>" % (len(rows), text))
