"""The index of a report: a row of each file, those that failed with their error. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import html
from collections.abc import Sequence

from .. import _words
from ._analysis import Material
from ._page import document
from ._proof import warned
from ._spheres import thumbnail


@dataclasses.dataclass
class Row:
    """What the index keeps of a material whose page is written."""

    link: str
    name: str
    cells: list[str]
    picture: str
    certified: bool


@dataclasses.dataclass
class Failure:
    path: str
    message: str


def row(link: str, name: str, material: Material) -> Row:
    fit = material.main
    values = fit.sigma if fit.exponent is None else fit.exponent
    share = " and ".join("%.1f %%" % (100 * w) for w in fit.weight)
    above = "≤ %s %%" % _words.directed(100 * (fit.e2 / fit.lower_bound - 1), 2, True) if fit.lower_bound > 0 else (
        "exact to rounding" if fit.certified else "no bound yet")
    proof = "certified" if fit.certified else "open: " + fit.stop
    return Row(link, name, [proof, ", ".join("%.4g" % v for v in values), share, "%.3g %%" % (100 * fit.rms_total), above,
                            ", ".join(warned(fit))], thumbnail(material), fit.certified)


def _cell(kind: str, text: str) -> str:
    inside = html.escape(text)
    if kind == "each":  # on a phone one below the other
        inside = "<span>%s</span>" % inside.replace(", ", ",</span> <span>")
    return "<td%s>%s</td>" % (" class='%s'" % kind if kind else "", inside)


def index_page(rows: Sequence[Row], failures: Sequence[Failure], parameter: str) -> str:
    """Failures first: they are what somebody has to look after."""
    opened = sum(not r.certified for r in rows)
    parts = ["%d of %d files fitted" % (len(rows), len(rows) + len(failures)), "%d certified" % (len(rows) - opened)]
    if opened:
        parts.append("%d open" % opened)
    if failures:
        parts.append("%d failed" % len(failures))
    body = "<h1>brdffit report</h1><p>%s.</p>" % ", ".join(parts)
    if failures:
        body += "<h2 class='failed'>Failed</h2><ul>%s</ul>" % "".join(
            "<li><b>%s</b>: %s</li>" % (html.escape(f.path), html.escape(f.message)) for f in failures)
    if rows:
        head = "".join("<th scope='col'%s>%s</th>" % (" class='%s'" % kind if kind else "", html.escape(text)) for kind, text in (
            ("left", ""), ("left", "material"), ("left", "proof"), ("", parameter),
            ("less", "share of each lobe"), ("", "RMS, of max"), ("less", "E² above its proven bound"), ("left less", "warnings")))
        lines = "".join(
            "<tr%s><td class='ball'><img alt='' src='%s'></td><th scope='row' class='left'><a href='%s'>%s</a></th>%s</tr>" % (
                "" if r.certified else " class='failed'", r.picture, html.escape(r.link, quote=True), html.escape(r.name),
                "".join(map(_cell, ("left", "each", "less", "", "less", "words less"), r.cells))) for r in rows)
        body += ("<h2>Materials</h2><div class='scroll'><table class='index'><thead><tr>%s</tr></thead><tbody>%s</tbody></table>"
                 "</div>") % (head, lines)
    return document("brdffit report", body)
