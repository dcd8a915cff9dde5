"""Forms of model by name: [N]DISTRIBUTION[+[N]DISTRIBUTION...][/TERM...], as "2beckmann" or "ggx/smith/schlick".

The names are the library's; tools/brdffit/model_names.c has the same grammar, and models.c the same lists.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

from . import _lobes, _terms
from ._ffi import library
from .errors import OptionError

# What is compared when nobody says what.
MODELS = ("beckmann", "ggx", "ward", "blinn-phong", "ashikhmin-shirley", "lafortune", "2beckmann", "2ggx", "beckmann/schlick",
          "2beckmann/schlick", "ggx/smith/schlick", "ggx/smith/schlick/burley", "beckmann/oren-nayar")

_KINDS = ("masking", "fresnel", "diffuse")  # in the order of a name
_TITLES = {"smith": "Smith", "smith-separable": "separable Smith", "no-masking": "no masking", "schlick": "Schlick",
           "no-diffuse": "no diffuse", "oren-nayar": "Oren-Nayar", "burley": "Burley"}


def _join(distributions: Sequence[str], word: Any, space: str, plus: str) -> str:
    parts = [(at.stop - at.start, name) for name, at in _lobes.kinds(distributions)]
    return plus.join("%s%s" % ("%d%s" % (count, space) if count > 1 else "", word(name)) for count, name in parts)


def _term_name(kind: str, value: str) -> str:
    return "no-" + kind if value == "none" else value


@dataclasses.dataclass(frozen=True)
class Form:
    """Lobes in the order of a fit, and the terms beside them. name: "ggx/smith/schlick", or that of a preset."""

    name: str
    distributions: tuple[str, ...]
    masking: str
    fresnel: str
    diffuse: str

    @classmethod
    def of(cls, distributions: Sequence[str], **terms: str) -> Form:
        """Of lobes in any order; the name follows."""
        found = {**_terms.DEFAULTS, **terms}
        lobes = _lobes.group(distributions)
        added = ["/" + _term_name(kind, found[kind]) for kind in _KINDS if found[kind] != _terms.DEFAULTS[kind]]
        return cls(_join(lobes, str, "", "+") + "".join(added), lobes, **found)

    @property
    def title(self) -> str:
        """For people: "2 Beckmann", "Beckmann + GGX", "GGX, Smith, Schlick"."""
        added = [_term_name(kind, getattr(self, kind)) for kind in _KINDS if getattr(self, kind) != _terms.DEFAULTS[kind]]
        return ", ".join([_join(self.distributions, _lobes.title, " ", " + "), *(_TITLES.get(one, one) for one in added)])

    @property
    def options(self) -> dict[str, Any]:
        """Of `Options`: what asks for this form."""
        return {"lobes": self.distributions, "distribution": None, **{kind: getattr(self, kind) for kind in _KINDS}}

    def parameters(self, channels: int) -> int:
        """All that is fitted: coefficients of the diffuse term and of each lobe, a roughness of each, the size of the noise."""
        diffuse = 0 if self.diffuse == "none" else 1 + _terms.more_columns(self.diffuse)
        lobes = len(self.distributions)
        return channels * (diffuse + lobes * (1 if self.fresnel == "none" else 2)) + lobes + 1


@dataclasses.dataclass(frozen=True)
class Preset:
    """A form with a name of its own, and what else that name stands for in `fit`."""

    form: Form
    max_incidence: float | None = None
    merl_samples: str | None = None


def _preset(name: str, distributions: Sequence[str], max_incidence: float | None = None, merl_samples: str | None = None,
            **terms: str) -> Preset:
    return Preset(dataclasses.replace(Form.of(distributions, **terms), name=name), max_incidence, merl_samples)


PRESETS = {one.form.name: one for one in (
    _preset("paper", ("beckmann", "beckmann"), 60.0, "84"),
    _preset("principled", ("ggx",), masking="smith", fresnel="schlick"),
    _preset("disney", ("ggx",), masking="smith", fresnel="schlick", diffuse="burley"),
    _preset("cook-torrance", ("beckmann",)),
    _preset("phong", ("lafortune",)),
)}


def named(name: str) -> Form:
    """The form of a name, or a preset's, which keeps its own."""
    if not isinstance(name, str):
        raise _wrong(name)
    if name in PRESETS:
        return PRESETS[name].form
    lobes, *terms = name.split("/")
    return Form.of(_read_lobes(name, lobes), **_read_terms(name, terms))


def _read_lobes(name: str, lobes: str) -> list[str]:
    out: list[str] = []
    for part in lobes.split("+"):
        count, kind = (int(part[0]), part[1:]) if part[:1] in ("1", "2", "3") else (1, part)
        if kind not in _lobes.distributions():
            raise _wrong(name)
        out += [kind] * count
    if len(out) > _lobes.MOST:
        raise OptionError("a model has 1 to %d lobes, not %r" % (_lobes.MOST, name), code="option")
    return out


def _read_terms(name: str, terms: Sequence[str]) -> dict[str, str]:
    """One of a kind."""
    known = {_term_name(kind, value): (kind, value) for kind in _KINDS for value in library().terms[kind]}
    found = [known[one] for one in terms if one in known]
    if len(dict(found)) < len(terms):
        raise _wrong(name)
    return dict(found)


def _wrong(name: Any) -> OptionError:
    terms = [_term_name(kind, value) for kind in _KINDS for value in library().terms[kind]]
    return OptionError("%r is no model: [N]DISTRIBUTION with + between several, of %s; then /TERM, of %s; or a preset: %s" % (
        name, ", ".join(_lobes.distributions()), ", ".join(terms), ", ".join(PRESETS)), code="option")


def under(model: str | None, **given: Any) -> dict[str, Any]:
    """Of `Options`: what a model's name stands for, over the defaults and under what is given beside it (None: is not)."""
    out: dict[str, Any] = {"lobes": 1, "distribution": None, **_terms.DEFAULTS, "max_incidence": None}
    if model is not None:
        form = named(model)
        alike = len(set(form.distributions)) == 1
        out.update(form.options, lobes=len(form.distributions) if alike else form.distributions)
        out["max_incidence"] = PRESETS[model].max_incidence if model in PRESETS else None
        lobes = given.get("lobes")
        if not isinstance(lobes, (list, tuple)) and (alike or lobes is not None):
            out["distribution"] = form.distributions[0]
    out.update((name, value) for name, value in given.items() if value is not None)
    return out
