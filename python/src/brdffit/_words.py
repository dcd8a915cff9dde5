"""A fit as plain data, as text, as HTML; its certificate in the words of the command line.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import decimal
import html as _html
import math
import os
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _lobes, _terms

if TYPE_CHECKING:
    from .fit import Fit

OBJECTIVES = {"l2": "E²", "l1": "sum of absolute residuals", "linf": "maximum absolute residual"}
SKIPPED = (("incidence", "lit from beyond %.6g°"), ("light_below_horizon", "with the light below the horizon"),
           ("view_below_horizon", "with the viewer below the horizon"), ("zero_weight", "of weight 0"),
           ("masked", "masked (not measured)"), ("absent", "without a value"),
           ("saturated", "saturated"), ("cell_below_horizon", "cells beyond the hemisphere"))

WEIGHTS = {"none": "Samples count alike.", "column": "Samples have weights of their own.",
           "cosine": "Samples are weighted by the cosine of the light.",
           "solid-angle": "Samples are weighted by the solid angle that each stands for.",
           "relative": "Samples are weighted by one over their squared values."}

# Order of the members of `brdffit fit --json`.
_MEMBERS = ("schema", "file", "status", "distribution", "distributions", "fresnel", "diffuse", "masking", "norm", "engine",
            "lobes", "sigma", "exponent", "x", "y", "azimuth_share", "sigma_xy", "anisotropy", "tangent_angle",
            "f0", "ior", "f0_interval", "x_more", "channel_scale", "e2", "objective",
            "e2_error", "lower_bound", "gap", "rms", "rms_total", "r2", "r2_total", "relative_rms",
            "foreseen", "misfit", "sum_of_squares",
            "kkt_residual", "physical", "samples_used", "samples_skipped", "boxes", "nodes", "socp", "verify", "distinct_c", "stop",
            "weight", "effective_samples", "sigma_interval", "exponent_interval", "warnings", "channels", "normalise",
            "sigma_range", "exponent_range", "relative_gap", "absolute_gap", "sigma_resolution", "box_budget",
            "max_incidence", "proven_sigma", "proven_exponent", "reading", "format", "quantity", "merl_bins", "merl_samples",
            "weighting", "notes", "data_warnings", "seconds")
# f0_interval: null where there is an f0 but none of it
_WHERE_THERE = ("azimuth_share", "sigma_xy", "anisotropy", "tangent_angle", "f0", "ior", "x_more", "physical", "reading")
_ONLY_BY_EXPONENT = ("exponent", "exponent_interval", "exponent_range")  # proven_exponent: where there is an exponent


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, tuple):
        return [_plain(v) for v in value]
    if isinstance(value, Mapping):
        return {k: _plain(v) for k, v in value.items()}
    return value


def readable(text: str) -> str:
    """U+FFFD for each byte of a path that is not UTF-8, as the command line has it: no output could take it as it is."""
    return re.sub(r"[\ud800-\udfff]", "\ufffd", text)


def plain(fit: Fit) -> dict[str, Any]:
    out = {}
    for name in _MEMBERS:
        value = getattr(fit, name)
        if value is None and (name in _ONLY_BY_EXPONENT or (name == "proven_exponent" and fit.exponent is None)):
            continue
        if value is None and (name in _WHERE_THERE or (name == "f0_interval" and fit.f0 is None)):
            continue
        out[name] = _plain(value)
        if name == "r2" and value is not None:
            out[name] = [one if one == one else None for one in out[name]]
        if name == "ior":
            out[name] = [[one if math.isfinite(one) else None for one in row] for row in out[name]]
        if name in ("exponent", "exponent_interval"):
            out[name] = [one if by == "exponent" else None for one, by in zip(out[name], fit.parameters)]
        if name in ("proven_sigma", "proven_exponent"):  # NaN: there is none
            out[name] = [None if one[0] != one[0] else one for one in out[name]]
        if name == "file" and value is not None and readable(value) != value:
            out.update(file=readable(value), file_bytes=os.fsencode(value).hex())
    if fit._merl_directions is not None:
        out["merl_directions"] = fit._merl_directions.tolist()
    return out


# ---- Numbers in words ------------------------------------------------------


def directed(value: float, digits: int, up: bool) -> str:
    """`value` with `digits` significant digits, rounded so that what is claimed stays true."""
    if value == 0 or not math.isfinite(value):
        return "%g" % value
    rounding = decimal.ROUND_CEILING if up else decimal.ROUND_FLOOR
    context = decimal.Context(prec=digits, rounding=rounding)
    return "%.*g" % (digits, context.create_decimal(decimal.Decimal(value)))


def parameter(fit: Fit, p: int) -> str:
    """The letter of a lobe's."""
    return _lobes.letter(fit.distributions[p])


def family(distributions: Sequence[str], sigma_range: Sequence[float], exponent_range: Sequence[float] | None,
           terms: str = "") -> str:
    """With the ranges of the parameters that its lobes have."""
    ranges = {"σ": sigma_range, "n": exponent_range}
    found = ["%s in [%.6g, %.6g]" % (letter, *ranges[letter]) for letter in sorted(  # type: ignore[misc]  # a range is there
        {_lobes.letter(name) for name in distributions}, reverse=True)]
    return "%s%s %s %s" % (_lobes.family(distributions), terms, "and" if len(set(distributions)) == 1 else "with",
                           " and ".join(found))


def is_cut(fit: Fit) -> bool:
    """Whether less is proven than the range that was asked for."""
    return bool(np.any(~(fit.proven_sigma[:, 0] <= [_asked_floor(fit, p) for p in range(fit.lobes)])))


def _asked_floor(fit: Fit, p: int) -> float:
    by_sigma = fit.parameters[p] == "sigma" or fit.exponent_range is None
    return fit.sigma_range[0] if by_sigma else 1 / math.sqrt(fit.exponent_range[1])  # type: ignore[index]


def _proven(fit: Fit, by: str) -> tuple[str, str] | None:
    """Ends of the range of a parameter that the bound is about, rounded inwards where they are not what was asked for."""
    mine = [p for p in range(fit.lobes) if fit.parameters[p] == by and np.isfinite(fit.proven_sigma[p, 0])]
    cut = any(fit.proven_sigma[p, 0] > _asked_floor(fit, p) for p in mine)
    if by == "sigma":
        low, high = fit.sigma_range
        return directed(max(fit.proven_sigma[p, 0] for p in mine), 6, True) if cut else "%.6g" % low, "%.6g" % high
    assert fit.exponent_range is not None
    low, high = fit.exponent_range
    if not cut or fit.proven_exponent is None:
        return "%.6g" % low, "%.6g" % high
    return "%.6g" % low, directed(min(fit.proven_exponent[p, 1] for p in mine), 6, False)


def _family(fit: Fit) -> str:
    """Which models the bound is about."""
    if not np.any(np.isfinite(fit.proven_sigma[:, 0])):
        return "diffuse fit" + _terms.words(fit)
    every = "every " if fit.anisotropy is not None else ""
    found = ["%s%s in [%s, %s]" % (every, letter, *_proven(fit, by)) for letter, by in (("σ", "sigma"), ("n", "exponent"))  # type: ignore[misc]
             if by in fit.parameters]
    return "%s%s %s %s" % (_lobes.family(fit.distributions), _terms.words(fit),
                           "and" if len(set(fit.distributions)) == 1 else "with", " and ".join(found))


def _cut(fit: Fit) -> str:
    """Why a range is not the one that was asked for."""
    if not np.any(np.isfinite(fit.proven_sigma[:, 0])):
        return (" No sample is near enough to the mirror direction for any lobe of the range that was asked for: its "
                "coefficients would be beyond any double.")
    out = ""
    for letter, by in (("σ", "sigma"), ("n", "exponent")):
        mine = [p for p in range(fit.lobes) if fit.parameters[p] == by and np.isfinite(fit.proven_sigma[p, 0])]
        if any(fit.proven_sigma[p, 0] > _asked_floor(fit, p) for p in mine):
            asked = "down to %.6g" % fit.sigma_range[0] if by == "sigma" else "up to %.6g" % fit.exponent_range[1]  # type: ignore[index]
            out += " Of %s %s, as asked for, nothing is said: no sample sees %s." % (
                letter, asked, "1e-7 of such lobes' peak but in the mirror direction" if fit.anisotropy is not None else
                "such lobes, whose coefficients would be beyond any double")
    return out


def _digits(low: float, high: float) -> int:
    """Digits that show the two apart, and at least five."""
    if not (low > 0 and high > low):
        return 6
    return int(min(17, max(5, 2 - math.floor(math.log10(high / low - 1)))))


def above(fit: Fit) -> str:
    if not fit.lower_bound > 0:
        return ""
    share = 100 * (fit.e2 / fit.lower_bound - 1)
    return " (%s %% above)" % directed(share, 2, True) if share > 0 else " (the same to rounding)"


_STOPS = {"resolution": "every box left is narrower than sigma_resolution",
          "rounding": "what is left of the gap is rounding of double precision",
          "budget": "the box budget was used up", "memory": "its memory was full",
          "cancelled": "it was interrupted"}


def certificate(fit: Fit) -> str:
    if fit.stop == "contradiction":
        return ("CONTRADICTION, nothing is proven: the bound came out above this fit's own %s, %.6g. Neither can be "
                "trusted: this is an error in brdffit. Please report it, with the file and the options." % (
                    OBJECTIVES[fit.norm], fit.e2))
    return _proof(fit) + _cut(fit)


def _proof(fit: Fit) -> str:
    what = OBJECTIVES[fit.norm]
    a, its = ("", "") if fit.norm == "l2" else ("a ", "its ")
    n = _digits(fit.lower_bound, fit.e2)
    low, high = directed(fit.lower_bound, n, False), directed(fit.e2, n, True)
    if not fit.certified:
        return "NOT proven: the search stopped because %s. The smallest %s of any %s lies between %s and this fit's %s%s." % (
            _STOPS.get(fit.stop, fit.stop), what, _family(fit), low, high, above(fit))
    if not fit.e2 > 0:
        return "Proven: this fit is exact, %s%s is 0." % (its, what)
    if fit.stop == "absolute_gap" and fit.sum_of_squares > 0:
        share = fit.gap / fit.sum_of_squares
        tiny = fit.e2 <= (1e-20 if fit.norm == "l2" else 1e-12) * fit.sum_of_squares
        data = "sum of squares" if fit.norm == "l2" else "own"
        more = "" if not share > 0 else "; no %s can lower it by more than %s of that" % (
            _family(fit), directed(share, 2, True))
        return "Proven: %s%s is %s, the data's %s %.6g%s%s." % (
            "" if fit.norm == "l2" else "the ", what, directed(fit.e2, 3, True), data, fit.sum_of_squares,
            ": zero to rounding" if tiny else "", more)
    return "Proven: no %s has %s%s below %s; this one has %s%s." % (_family(fit), a, what, low, high, above(fit))


def warnings(fit: Fit) -> list[str]:
    """A sentence for each thing that looks wrong: in the data, in how the model describes them, in a lobe (of an unused one only
    that)."""
    return ["Warning, data: %s" % _sentence(note) for note in fit.data_warnings] + _misfit(fit) + [
        "Warning, lobe %d: %s" % (p + 1, _warning(fit, p, word)) for p, words in enumerate(fit.warnings)
        for word in words if word == "unused" or "unused" not in words] + _terms.warnings(fit)


def _sentence(note: str) -> str:
    return note if note.endswith("?") else note + "."


def _misfit(fit: Fit) -> list[str]:
    if not fit.misfit or fit.relative_rms is None:
        return []
    r2 = "" if fit.r2_total is None else "R² is %.3g in all, " % fit.r2_total
    foretold = (", and those of neighbouring samples foretell %.2g %% of their squares, which are no noise" % (100 * fit.foreseen)
                if "patterned" in fit.misfit and fit.foreseen is not None else "")
    return ["Warning, misfit: this model does not describe these data. %sresiduals are %.2g %% of the data%s. Are directions "
            "and values what they are read as (notes)? Or is this another kind of material (compare)?" % (
                r2, 100 * fit.relative_rms, foretold)]


def _warning(fit: Fit, p: int, word: str) -> str:
    name = parameter(fit, p)
    values, interval, limits = (fit.sigma, fit.sigma_interval, fit.sigma_range)
    if (fit.parameters[p] == "exponent" and fit.exponent is not None and fit.exponent_interval is not None and
            fit.exponent_range is not None):
        values, interval, limits = fit.exponent, fit.exponent_interval, fit.exponent_range
    if word == "unresolved":
        return ("rests on no more than %s effective samples: these directions do not resolve it, and it is a fit to "
                "single samples." % directed(float(fit.effective_samples[p]), 2, True))
    if word == "flat":
        return "the data cannot tell %s inside [%.6g, %.6g]: any value there fits as well." % (name, *interval[p])
    if word == "unused":
        return "its coefficient is 0 in every channel: %s." % (
            "the data show no such lobe" if fit.lobes == 1 else "one lobe fewer fits as well")
    if word == "at_limit":
        lower = values[p] - limits[0] < limits[1] - values[p]
        return "%s sits on the %s end of the range searched; widen it." % (name, "lower" if lower else "upper")
    return word


def skipped(fit: Fit) -> str:
    """ "40 lit from beyond 60°, 2 of weight 0"; "" when every sample was used."""
    out = []
    for reason, words in SKIPPED:
        count = (fit.samples_skipped or {}).get(reason, 0)
        if count:
            out.append("%s %s" % (format(count, ","), words % fit.max_incidence if "%" in words else words))
    return ", ".join(out)


# ---- Tables ----------------------------------------------------------------


def title(fit: Fit) -> str:
    name = "" if fit.file is None else "%s: " % readable(fit.file)
    words = _lobes.family(fit.distributions) + _terms.words(fit)
    return "%s%s, %s samples used" % (name, words if name else words[0].upper() + words[1:], format(fit.samples_used, ","))


def lobe_table(fit: Fit) -> list[list[str]]:
    differ, both = len(set(fit.distributions)) > 1, len(set(fit.parameters)) > 1
    rows = [["lobe", *(["distribution"] if differ else []), "parameter" if both else parameter(fit, 0), "share w",
             "effective samples"]]
    for p, value in enumerate(fit.values):
        rows.append([str(p + 1), *([_lobes.title(fit.distributions[p])] if differ else []),
                     "%s%.8g" % (parameter(fit, p) + " = " if both else "", value), "%.1f %%" % (100 * fit.weight[p]),
                     "%.1f" % fit.effective_samples[p]])
    return rows


def channel_table(fit: Fit) -> list[list[str]]:
    rows = [["channel", "diffuse x", *("lobe %d y" % (p + 1) for p in range(fit.lobes)), "RMS", "of max", "R²"]]
    for k, name in enumerate(fit.channels):
        r2 = "" if fit.r2 is None or fit.r2[k] != fit.r2[k] else "%.4g" % fit.r2[k]
        share = "%.3g %%" % (100 * fit.rms[k] / fit.channel_scale[k]) if fit.normalise == "max" else ""
        rows.append([name, "%.5g" % fit.x[k], *("%.5g" % y for y in fit.y[k]), "%.3g" % fit.rms[k], share, r2])
    return rows


def _columns(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return ["  " + "   ".join([row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:]))]).rstrip()
            for row in rows]


def _paragraphs(fit: Fit) -> list[str]:
    return [certificate(fit), *([WEIGHTS[fit.weighting]] if fit.weighting != "none" else []), *warnings(fit)]


def text(fit: Fit) -> str:
    import textwrap

    lines = [title(fit)]
    if skipped(fit):
        lines.append("  Skipped: " + skipped(fit))
    lines += ["", *_columns(lobe_table(fit)), "", *_columns(channel_table(fit)), ""]
    for table in _terms.tables(fit):
        lines += [*_columns(table), ""]
    for paragraph in _paragraphs(fit):
        lines += textwrap.wrap(paragraph, 79, initial_indent="  ", subsequent_indent="  ")
    return "\n".join(lines)


def html_table(rows: Sequence[Sequence[str]]) -> str:
    """First row: heads; first column: heads of rows."""
    head = "".join("<th scope='col'>%s</th>" % _html.escape(cell) for cell in rows[0])
    body = "".join("<tr><th scope='row'>%s</th>%s</tr>" % (
        _html.escape(row[0]), "".join("<td>%s</td>" % _html.escape(cell) for cell in row[1:])) for row in rows[1:])
    return "<table><thead><tr>%s</tr></thead><tbody>%s</tbody></table>" % (head, body)


def html(fit: Fit) -> str:
    parts = ["<p><b>%s</b></p>" % _html.escape(title(fit))]
    if skipped(fit):
        parts.append("<p>Skipped: %s</p>" % _html.escape(skipped(fit)))
    parts += [html_table(lobe_table(fit)), html_table(channel_table(fit)), *map(html_table, _terms.tables(fit))]
    parts += ["<p>%s</p>" % _html.escape(paragraph) for paragraph in _paragraphs(fit)]
    return "<div class='brdffit'>%s</div>" % "".join(parts)
