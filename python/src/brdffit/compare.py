"""Many forms of model on the same samples, and which of them the data support.

What is called proven follows from lower bounds of E^2, as in `brdffit compare`; docs/compare.md has the formulas.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import dataclasses
import html as _html
import math
import textwrap
import time
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, TypedDict, overload

import numpy as np

from . import _lobes, _words
from ._arguments import choose, positive
from ._arrays import Floats
from ._forms import MODELS, Form, named
from .errors import BrdffitError, OptionError, OutOfMemoryError, UnsupportedError
from .fit import Fit, SamplesLike, run
from .options import Options
from .progress import ProgressArgument
from .samples import Samples

if TYPE_CHECKING:
    from typing_extensions import Unpack

CRITERIA = ("bic", "aic", "aicc")
TITLES = {"bic": "BIC", "aic": "AIC", "aicc": "AICc"}
# Differences below this are "positive" evidence at most to Kass and Raftery (1995, 3.2), whose "strong" begins here.
TELLING = 6.0
ROUNDING = 1e-20  # of the sum of squares: E^2 is taken to be no less, nor less than the absolute gap

RANKS = ("best", "tied", "behind", "proven_behind", "unranked")


class CompareOptions(TypedDict, total=False):
    """Keyword arguments of `compare` that go to every fit; `Options` explains them."""

    engine: str
    normalise: str
    sigma_range: tuple[float, float]
    exponent_range: tuple[float, float]
    relative_gap: float
    absolute_gap: float
    sigma_resolution: float
    box_budget: int
    max_incidence: float | None
    socp_every_box: bool
    isa: str


@dataclasses.dataclass(frozen=True)
class Criteria:
    """n ln(E^2 / n) and what each adds for p parameters on n observations: the lower, the better. NaN where there is none."""

    bic: float
    aic: float
    aicc: float

    @classmethod
    def of(cls, e2: float, n: float, p: int) -> Criteria:
        """Of a model that leaves E^2; all NaN unless n > p, AICc unless n > p + 1."""
        if not (e2 > 0 and n > p):
            return cls(math.nan, math.nan, math.nan)
        deviance = n * math.log(e2 / n)
        corrected = deviance + 2 * p * n / (n - p - 1) if n > p + 1 else math.nan
        return cls(deviance + p * math.log(n), deviance + 2 * p, corrected)


@dataclasses.dataclass(frozen=True)
class Row:
    """One form of model.

    model: its name, "2beckmann" or "ggx/smith/schlick"; title: for people, "2 Beckmann" or "GGX, Smith, Schlick"
    distributions: what each lobe is; masking, fresnel, diffuse: the rest of the form, as in `Options`
    fit: the fit, or None and `error` says why
    rank: "best"; "tied": less than the threshold behind; "proven_behind": by that or more, whatever its parameters;
        "behind": its fit is, but its search stopped before that was proven; "unranked": without a criterion
    delta: of the criterion, from that of the best; delta_proven: the least that any parameters of this form could have
    parameters: how many are fitted, the size of the noise among them; effective_observations: to go by its residuals
    criteria: of the fit; criteria_bound: of its lower bound; r2: 1 - E^2 / (the data's sum of squares)
    """

    model: str
    title: str
    distributions: tuple[str, ...]
    fit: Fit | None
    error: BrdffitError | None
    rank: str
    delta: float
    delta_proven: float
    parameters: int
    effective_observations: float
    r2: float
    criteria: Criteria
    criteria_bound: Criteria
    seconds: float
    e2_floor: float
    masking: str
    fresnel: str
    diffuse: str

    @property
    def exact(self) -> bool:
        """Whether E^2 is below what certificates can see."""
        return self.fit is not None and self.fit.e2 < self.e2_floor

    @property
    def e2(self) -> float:
        """As it is ranked: no less than e2_floor."""
        return max(self.fit.e2, self.e2_floor) if self.fit is not None else math.nan

    @property
    def lower_bound(self) -> float:
        """As it is ranked: no less than e2_floor."""
        return max(self.fit.lower_bound, self.e2_floor) if self.fit is not None else math.nan

    def cannot_reach(self, other: Row) -> bool:
        """Proven: no model of this form has an E^2 as small as that fit's."""
        return other.fit is not None and self.lower_bound > other.e2 + other.fit.e2_error


class Comparison(Sequence[Row]):
    """Rows, best first, then those without a criterion; by index, or by the name of a model.

    criterion, threshold: as asked for; observations: samples used times channels that say something of their own;
    effective_observations: what the criterion counts
    """

    def __init__(self, rows: Sequence[Row], criterion: str, threshold: float, observations: int,
                 effective_observations: float, samples_used: int, channels: int, file: str | None) -> None:
        self._rows = tuple(rows)
        self.criterion = criterion
        self.threshold = threshold
        self.observations = observations
        self.effective_observations = effective_observations
        self.samples_used = samples_used
        self.channels = channels
        self.file = file

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, at: int | str) -> Row: ...
    @overload
    def __getitem__(self, at: slice) -> tuple[Row, ...]: ...
    def __getitem__(self, at: int | str | slice) -> Row | tuple[Row, ...]:
        if isinstance(at, str):
            for row in self._rows:
                if row.model == at:
                    return row
            raise KeyError(at)
        return self._rows[at]

    def __iter__(self) -> Iterator[Row]:
        return iter(self._rows)

    @property
    def ranked(self) -> tuple[Row, ...]:
        """The rows that have a criterion, best first."""
        return tuple(row for row in self._rows if row.rank != "unranked")

    @property
    def best(self) -> Row | None:
        """The row of the least criterion; None when there is none."""
        return self.ranked[0] if self.ranked else None

    @property
    def tied(self) -> tuple[Row, ...]:
        """The rows that the data cannot tell from the best."""
        return tuple(row for row in self._rows if row.rank == "tied")

    @property
    def simplest(self) -> Row | None:
        """Of the best and those tied with it, the one of fewest parameters."""
        return min((self.ranked[0], *self.tied), key=lambda row: row.parameters) if self.ranked else None

    @property
    def verdict(self) -> str:
        """ "one", "cannot_tell" (between the best and those tied with it), or "none"."""
        return "none" if not self.ranked else "cannot_tell" if self.tied else "one"

    @property
    def words(self) -> list[str]:
        """What the data say, a paragraph each."""
        return _paragraphs(self)

    def to_dict(self) -> dict[str, Any]:
        """The verdict as `brdffit compare --json` ends with."""
        names = {"best": self.best, "simplest": self.simplest}
        return {"schema": "brdffit.comparison/1", "file": self.file, "verdict": self.verdict, "criterion": self.criterion,
                "threshold": self.threshold, "samples_used": self.samples_used, "observations": self.observations,
                "effective_observations": self.effective_observations,
                **{key: None if row is None else row.model for key, row in names.items()},
                "tied": [row.model for row in self.tied], "models": [_plain(row) for row in self]}

    def __repr__(self) -> str:
        cells = _table(self)
        widths = [max(len(row[i]) for row in cells) for i in range(len(cells[0]))]
        counted = "" if self.effective_observations >= self.observations else ", counted as %.0f" % self.effective_observations
        lines = ["%s%s samples used, %s observations%s" % (
            "" if self.file is None else _words.readable(self.file) + ": ", format(self.samples_used, ","),
            format(self.observations, ","), counted), ""]
        for row in cells:
            text = [row[0], row[1].ljust(widths[1]), row[2].ljust(widths[2]),
                    *(cell.rjust(w) for cell, w in zip(row[3:], widths[3:]))]
            lines.append(("  " + "  ".join(text)).rstrip())
        lines.append("")
        for paragraph in self.words:
            lines += textwrap.wrap(paragraph, 79, initial_indent="  ", subsequent_indent="  ")
        return "\n".join(lines)

    @property
    def table(self) -> list[list[str]]:
        """Heads, then a row a model, best first, as text."""
        return [[row[1] + (" " + row[0] if row[0].strip() else ""), *row[2:]] for row in _table(self)]

    def _repr_html_(self) -> str:
        return "<div class='brdffit'>%s%s</div>" % (
            _words.html_table(self.table), "".join("<p>%s</p>" % _html.escape(text) for text in self.words))


# ---- Compare ---------------------------------------------------------------


def _distinct(fit: Fit) -> list[int]:
    """Channels that say something of their own: not those without signal, nor those that repeat an earlier one."""
    seen, out = set(), []
    for k in range(len(fit.channels)):
        if fit.rms[k] > 0 or fit.x[k] > 0 or np.any(fit.y[k] > 0):
            key = (fit.rms[k], fit.x[k], fit.channel_scale[k], fit.y[k].tobytes())
            out += [] if key in seen else [k]
            seen.add(key)
    return out


def _cosines(s: Samples) -> tuple[Floats, Floats]:
    """Of light and viewer against the normal."""
    if s.form == "coefficients":
        return np.ones(len(s)), np.ones(len(s))
    if s.form == "angles":
        assert s.cos_light is not None and s.cos_view is not None
        return s.cos_light, s.cos_view
    assert s.light is not None and s.view is not None
    normal = np.array([[0.0, 0.0, 1.0]]) if s.normal is None else s.normal
    l, v, n = (d / np.linalg.norm(d, axis=1, keepdims=True) for d in (s.light, s.view, normal))
    return np.sum(n * l, 1), np.sum(n * v, 1)


def effective_observations(fit: Fit, samples: Samples) -> float:
    """How many Gaussian residuals r of one variance would be as uneven as those of the fit, at most the observations:
    3 (sum w r^2)^2 / sum (w r^2)^2. All of them where the fit is exact as far as certificates can tell."""
    channels = _distinct(fit)
    most = float(len(channels) * fit.samples_used)
    if not fit.e2 > max(fit.absolute_gap, ROUNDING) * fit.sum_of_squares:
        return most
    light, view = _cosines(samples)
    weights = np.ones(len(samples)) if samples.weights is None else samples.weights
    limit = 0.0 if fit.max_incidence >= 90 or samples.form == "coefficients" else math.cos(math.radians(fit.max_incidence)) - 1e-12
    used = (weights > 0) & (light > 0) & (view > 0) & (light >= limit)
    r = (samples.values - fit.predict_samples(samples)) * (1 if samples.quantity == "radiance" else light[:, None])
    squares = (weights[:, None] * (r / fit.channel_scale) ** 2)[used][:, channels]
    return min(most, float(3 * squares.sum() ** 2 / (squares ** 2).sum()))


def compare(samples: SamplesLike, models: Sequence[str | Sequence[str]] | None = None, *, criterion: str = "bic",
            threshold: float = TELLING, observations: str = "effective", progress: ProgressArgument = None,
            **options: Unpack[CompareOptions]) -> Comparison:
    """Fit many forms of model to samples (or to a file of them), with proof, and say which of them the data support.

    models: names as "2beckmann", "beckmann+ggx" or "ggx/smith/schlick" (docs/compare.md has the grammar), presets of `fit`, or
        lists of distributions; None: a dozen, distributions alone, more lobes, Fresnel and diffuse terms
    criterion: "bic", "aic" or "aicc"
    threshold: models less than this behind the best in the criterion cannot be told from it
    observations: what the criterion counts: "effective", as many Gaussian residuals as would be as uneven as those of the fit
        of least E^2, or "all"

    Criteria suppose independent Gaussian noise of one size in the units that are minimised (of variance in proportion to
    1 / weight, where there are weights). A model that cannot be fitted is a row with an error; anything else that is wrong
    raises, as in `fit`.
    """
    choose("criterion", criterion, CRITERIA)
    choose("observations", observations, ("effective", "all"))
    threshold = positive("threshold", threshold)
    wanted = [Form.of(_lobes.asked(one, None)) if isinstance(one, (list, tuple)) else named(one)  # type: ignore[arg-type]
              for one in (MODELS if models is None else models)]
    if not wanted or len({form.name for form in wanted}) < len(wanted):
        raise OptionError("models must be at least one, each once", code="option")
    if options.get("max_incidence") is None and any(form.fresnel != "none" for form in wanted):
        options["max_incidence"] = 90.0  # of all: criteria compare fits to the same samples
    asked = Options(**options)
    asked._struct()  # wrong options fail here, once
    data = samples if isinstance(samples, Samples) else Samples.from_file(samples)
    rows: list[Row] = []
    for form in wanted:
        began = time.perf_counter()
        fit, error = _attempt(data, asked.replace(**form.options), progress)
        seconds = time.perf_counter() - began
        rows.append(_row(form, fit, error, data, seconds))
    return _ranked(rows, criterion, threshold, observations == "all", data.file)


def _attempt(data: Samples, options: Options, progress: ProgressArgument) -> tuple[Fit | None, BrdffitError | None]:
    try:
        return run(data, options, None, progress, {}), None
    except (UnsupportedError, OutOfMemoryError) as error:
        return None, error


def _row(form: Form, fit: Fit | None, error: BrdffitError | None, data: Samples, seconds: float) -> Row:
    none = Criteria.of(0.0, 0, 0)
    row = Row(form.name, form.title, form.distributions, fit, error, "unranked", math.nan, math.nan, 0, math.nan, math.nan, none,
              none, seconds, math.nan, form.masking, form.fresnel, form.diffuse)
    if fit is None:
        return row
    return dataclasses.replace(
        row, parameters=form.parameters(len(_distinct(fit))), effective_observations=effective_observations(fit, data),
        r2=1 - fit.e2 / fit.sum_of_squares if fit.sum_of_squares > 0 else math.nan,
        e2_floor=max(fit.absolute_gap, ROUNDING) * fit.sum_of_squares)


def _counted(fitted: Sequence[Row], everything: bool) -> tuple[int, int, float]:
    """Samples used, channels, and the observations of the criteria: by the residuals that are nearest to noise alone."""
    first = next((row.fit for row in fitted if row.fit is not None), None)
    if first is None:
        return 0, 0, 0.0
    channels = len(_distinct(first))
    least = min(fitted, key=lambda row: row.e2)
    return first.samples_used, channels, float(channels * first.samples_used) if everything else least.effective_observations


def _ranked(rows: Sequence[Row], criterion: str, threshold: float, everything: bool, file: str | None) -> Comparison:
    used, channels, n = _counted([row for row in rows if row.fit is not None], everything)
    weighed = [row if row.fit is None else dataclasses.replace(
        row, criteria=Criteria.of(row.e2, n, row.parameters), criteria_bound=Criteria.of(row.lower_bound, n, row.parameters))
        for row in rows]
    order = sorted((row for row in weighed if not math.isnan(getattr(row.criteria, criterion))),
                   key=lambda row: float(getattr(row.criteria, criterion)))
    out = [_placed(row, order[0], n, criterion, threshold) for row in order]
    others = [row for row in weighed if math.isnan(getattr(row.criteria, criterion))]
    return Comparison([*out, *others], criterion, threshold, channels * used, n, used, channels, file)


def _placed(row: Row, best: Row, n: float, criterion: str, threshold: float) -> Row:
    assert best.fit is not None
    worst = Criteria.of(best.e2 + best.fit.e2_error, n, best.parameters)  # what is proven grants the best its error
    delta = getattr(row.criteria, criterion) - getattr(best.criteria, criterion)
    proven = getattr(row.criteria_bound, criterion) - getattr(worst, criterion)
    rank = ("best" if row is best else "tied" if delta < threshold else
            "proven_behind" if proven >= threshold else "behind")
    return dataclasses.replace(row, rank=rank, delta=delta, delta_proven=proven)


# ---- Words -----------------------------------------------------------------


def _plain(row: Row) -> dict[str, Any]:
    out: dict[str, Any] = {"model": row.model, "title": row.title, "rank": "error" if row.fit is None else row.rank}
    if row.rank != "unranked":
        out.update(delta=row.delta, delta_proven=row.delta_proven)
    if row.fit is not None:
        out.update(parameters=row.parameters, e2=row.fit.e2, lower_bound=row.fit.lower_bound,
                   criteria=dataclasses.asdict(row.criteria), criteria_bound=dataclasses.asdict(row.criteria_bound))
    return out


def _shape(fit: Fit) -> str:
    return " ".join("n=%.3g" % v if by == "exponent" else "%.4g" % v for v, by in zip(fit.values, fit.parameters))


def _down(value: float) -> str:
    return "%.1f" % (math.floor(value * 10) / 10)


def _table(c: Comparison) -> list[list[str]]:
    share = any(row.fit is not None and row.fit.normalise == "max" for row in c)
    out = [[" ", "model", "σ", "p", "RMS %" if share else "RMS", "R²", "d" + TITLES[c.criterion], "proven", "time"]]
    for row in c:
        mark = {"best": "*", "tied": "=", "behind": "?"}.get(row.rank, " ")
        if row.fit is None:
            out.append([mark, row.title, "not fitted: %s" % row.error, *[""] * 6])
            continue
        ranked = row.rank != "unranked"
        out.append([mark, row.title, _shape(row.fit), str(row.parameters), "%.3g" % (row.fit.rms_total * (100 if share else 1)),
                    "" if math.isnan(row.r2) else "%.6f" % row.r2, "%.1f" % row.delta if ranked else "",
                    _down(row.delta_proven) if ranked and row.rank != "best" else "", "%.3g s" % row.seconds])
    return out


def _paragraphs(c: Comparison) -> list[str]:
    best = c.best
    if best is None:
        return ["No best: " + ("no model was fitted." if c.samples_used == 0 else
                               "the data are all zero, and so is every model." if c.observations == 0 else
                               "no model has fewer parameters than there are observations.")]
    found = (_best(c, best), _tied(c, best), _proven(c, best), _more(c, best), _open(c), _warned(best), _light(c))
    return [text for text in found if text]


def _best(c: Comparison, best: Row) -> str:
    out = "Best: %s has the least %s" % (best.title, TITLES[c.criterion])
    if best.exact:
        out += ", and is exact as far as a certificate can tell"
    if not c.tied and len(c.ranked) > 1:
        out += ", %.*f less than the next: %s" % (c.ranked[1].delta < 1000, c.ranked[1].delta, c.ranked[1].title)
    return out + "."


def _tied(c: Comparison, best: Row) -> str:
    if not c.tied:
        return ""
    out = "Undecided: the data cannot tell it from %s. More directions or less noise may." % "; ".join(
        "%s (%.1f behind)" % (row.title, row.delta) for row in c.tied)
    simplest = c.simplest
    if simplest is not None and simplest.parameters < best.parameters:
        out += " With the fewest parameters: %s." % simplest.title
    return out


def _proven(c: Comparison, best: Row) -> str:
    assert best.fit is not None
    most = best.e2 + best.fit.e2_error
    found = ["%s %s" % (row.title, _words.directed(row.lower_bound / most * (1 - 1e-15), 4, False))
             for row in c.ranked[1:] if row.cannot_reach(best)]
    if not found:
        return ""
    return ("Proven: no fit of these forms, whatever its parameters, reaches the E² of this %s; they leave at least so many "
            "times as much: %s." % (best.title, "; ".join(found)))


def _more(c: Comparison, best: Row) -> str:
    assert best.fit is not None
    found = []
    for row in c.ranked[1:]:
        if row.rank == "proven_behind" and not row.cannot_reach(best) and row.parameters > best.parameters:
            most = 100 * (1 - row.lower_bound / (best.e2 + best.fit.e2_error))
            found.append("%s (%d more; %s)" % (row.title, row.parameters - best.parameters, "as exact" if best.exact else
                                               "proven: at most %s %% smaller" % _words.directed(most, 2, True)))
    return "" if not found else "More parameters: the E² of others is too little smaller for their number: %s." % "; ".join(found)


def _open(c: Comparison) -> str:
    found = [row.title for row in c if row.rank == "behind"]
    return "" if not found else ("NOT proven: a better fit than was found is not ruled out of %s. A smaller relative_gap or a "
                                 "larger box_budget tells." % "; ".join(found))


def _warned(best: Row) -> str:
    assert best.fit is not None
    words = {word for lobe in best.fit.warnings for word in lobe}
    out = []
    if "at_limit" in words:
        out.append("a lobe of the best sits on an end of the range searched: perhaps no form of this list is that of the "
                   "material.")
    if "unresolved" in words:
        out.append("a lobe of the best rests on fewer than 3 effective samples: it may be a fit to single samples.")
    return "Warning: " + " ".join(out) if out else ""


def _light(c: Comparison) -> str:
    """Why it is not limited, where it otherwise would be."""
    everywhere = any(row.fit is not None and row.fit.max_incidence >= 90 for row in c)
    return "" if not everywhere or all(row.fresnel == "none" for row in c) else (
        "All forms are fitted to light from everywhere, as grazing light tells of Fresnel: max_incidence limits it.")
