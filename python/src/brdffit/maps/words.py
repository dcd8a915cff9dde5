"""A map as text and as HTML. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import html as _html
import textwrap
from typing import TYPE_CHECKING

import numpy as np

from .. import _lobes, _terms
from .._words import OBJECTIVES, family, html_table

if TYPE_CHECKING:
    from .fitmap import FitMap

_STATUSES = (("certified", "certified"), ("open", "open: the search stopped early"), ("no_signal", "without signal"),
             ("masked", "masked"), ("bad_value", "with a bad value"), ("refused", "refused"),
             ("no_samples", "with no sample left to fit"), ("not_reached", "not reached: the run was stopped"))


def _shape(fits: FitMap) -> str:
    return " x ".join(map(str, fits.shape)) if fits.shape else "1"


def title(fits: FitMap) -> str:
    return "%d samples of %s texel%s, %d channel%s" % (
        fits.samples, _shape(fits), "" if fits.status.size == 1 else "s", fits.channels,
        "" if fits.channels == 1 else "s")


def statuses(fits: FitMap) -> list[tuple[str, str]]:
    """Count and words of each status that occurs."""
    counts = fits.counts
    return [(format(counts[name], ","), words) for name, words in _STATUSES if counts[name]]


def parameters(fits: FitMap) -> list[list[str]]:
    """Quantiles of each lobe's parameter over the fitted texels."""
    names = fits.distributions
    exponent, differ, both = fits.exponent, len(set(names)) > 1, len(set(fits.parameters)) > 1
    rows = [["lobe", *(["distribution"] if differ else []), "least" if both else "least " + _lobes.letter(names[0]), "median",
             "largest"]]
    for p in range(fits.lobes if fits.fitted.any() else 0):
        values = fits.sigma if exponent is None or fits.parameters[p] == "sigma" else exponent
        chosen = values[fits.fitted][:, p]
        rows.append([str(p + 1), *([_lobes.title(names[p])] if differ else []), *(
            "%s%.5g" % (_lobes.letter(names[p]) + " = " if both else "", f(chosen)) for f in (np.min, np.median, np.max))])
    return rows


def certificate(fits: FitMap) -> str:
    o = fits.options
    return ("Proven of each certified texel: its %s is within %.6g %% of the smallest that any %s has, or within %.6g times "
            "that of the zero model." % (OBJECTIVES[o.norm], 100 * o.relative_gap, family(
                fits.distributions, o.sigma_range, o.exponent_range, _terms.words(o)), o.absolute_gap))


def run(fits: FitMap) -> str:
    texels = fits.status.size - fits.counts["not_reached"]
    rate = ", %.3g texels/s" % (texels / fits.seconds) if fits.seconds > 0 else ""
    return "%.3g s%s; %s boxes" % (fits.seconds, rate, format(fits.stats.get("boxes", 0), ","))


def bad(fits: FitMap) -> str:
    """Where the first bad value is."""
    found = np.flatnonzero(fits.where.reshape(-1) >= 0)
    if not len(found):
        return ""
    sample, channel = divmod(int(fits.where.reshape(-1)[found[0]]), fits.channels)
    place = ", ".join(str(int(i)) for i in np.unravel_index(int(found[0]), fits.shape))
    return "The first bad value: texel (%s), sample %d, channel %d, all from 0." % (place, sample, channel)


def _lines(fits: FitMap) -> list[str]:
    counted = ", ".join("%s %s" % pair for pair in statuses(fits))
    out = ["Fitted: %s texel%s%s." % (format(fits.status.size, ","), "" if fits.status.size == 1 else "s",
                                      ": " + counted if counted else "")]
    if bad(fits):
        out.append(bad(fits))
    if fits.seconds > 0:
        out.append("Run: %s." % run(fits))
    return out


def text(fits: FitMap) -> str:
    rows = parameters(fits)
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = [title(fits)]
    for paragraph in _lines(fits):
        lines += textwrap.wrap(paragraph, 79, initial_indent="  ", subsequent_indent="  ")
    if len(rows) > 1:
        lines += ["", *("  " + "   ".join(c.rjust(w) for c, w in zip(row, widths)) for row in rows), ""]
    if fits.counts["certified"]:
        lines += textwrap.wrap(certificate(fits), 79, initial_indent="  ", subsequent_indent="  ")
    return "\n".join(lines)


def html(fits: FitMap) -> str:
    parts = ["<p><b>%s</b></p>" % _html.escape(title(fits)),
             html_table([["texels", "count"], *([words, count] for count, words in statuses(fits))])]
    rows = parameters(fits)
    if len(rows) > 1:
        parts.append(html_table(rows))
    parts += ["<p>%s</p>" % _html.escape(line) for line in [*_lines(fits)[1:], *(
        [certificate(fits)] if fits.counts["certified"] else [])]]
    return "<div class='brdffit'>%s</div>" % "".join(parts)
