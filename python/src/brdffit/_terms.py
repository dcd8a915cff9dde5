"""What a model has beside the distributions of its lobes: Fresnel, masking and the diffuse term.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import ctypes
import math
from ctypes import byref
from typing import Any

import numpy as np

from . import _structs as structs
from ._arguments import choose
from ._arrays import Floats, address, floats
from ._ffi import library
from .errors import DataError

# Options and members of a fit, in the order of the C library's structures, and their defaults.
DEFAULTS = {"fresnel": "none", "diffuse": "lambert", "masking": "v-cavity"}
_WORDS = {("fresnel", "schlick"): "Schlick Fresnel", ("masking", "smith"): "Smith masking",
          ("masking", "smith-separable"): "separable Smith masking", ("masking", "none"): "no masking",
          ("diffuse", "none"): "no diffuse term", ("diffuse", "oren-nayar"): "Oren-Nayar diffuse",
          ("diffuse", "burley"): "Burley diffuse"}
WIDE = 0.5  # an interval of F0 beyond this is as good as none


def check(kind: str, name: str) -> int:
    """The value in C of a name."""
    return choose(kind, name, library().terms[kind])


def incidence(fresnel: str, given: float | None) -> float:
    """Options.max_incidence where it was not given: no limit with Fresnel, which grazing light tells."""
    return given if given is not None else 60.0 if fresnel == "none" else 90.0


def more_columns(diffuse: str) -> int:
    """Coefficients of the diffuse term after the first."""
    return int(library().core.brdffit_diffuse_columns(check("diffuse", diffuse))) - 1


def words(of: Any) -> str:
    """ " (Schlick Fresnel, Smith masking)": of options or a fit, what is not the default; "" when all is."""
    anisotropic = of.anisotropy is not None or bool(getattr(of, "anisotropic", False))
    lobes = getattr(of, "lobe_count", None) or of.lobes
    first = ["the first anisotropic" if lobes > 1 else "anisotropic"] if anisotropic else []
    found = first + [_WORDS.get((kind, getattr(of, kind)), getattr(of, kind)) for kind in ("fresnel", "masking", "diffuse")
             if getattr(of, kind) != DEFAULTS[kind]]
    return " (%s)" % ", ".join(found) if found else ""


# ---- Figures -----------------------------------------------------------------


def ior(f0: Floats) -> Floats:
    """Index of refraction of a reflectance at normal incidence; infinite for 1."""
    with np.errstate(divide="ignore"):
        out: Floats = (1 + np.sqrt(f0)) / (1 - np.sqrt(f0))
    return out


def oren_nayar_roughness(a: float, b: float) -> float:
    """Radians, of the coefficients of Oren-Nayar's A and B; NaN when they are of none: B/A grows from 0 to 0.9."""
    q = b / a if a > 0 else math.nan
    if not q < 0.9:
        return math.nan
    second, first, last = 0.45 - 0.5 * q, 0.1485 - 0.375 * q, 0.0297 * q
    root = math.sqrt(first * first + 4 * second * last)
    return math.sqrt(2 * last / (first + root) if first > 0 else (root - first) / (2 * second))


# ---- C -----------------------------------------------------------------------


def of_model(model: structs.Model) -> dict[str, Any]:
    """Members of a Fit, in Python's own memory."""
    channels, lobes = model.channels, model.lobes
    out: dict[str, Any] = {kind: library().terms[kind][getattr(model, kind)] for kind in DEFAULTS}
    more = int(library().core.brdffit_diffuse_columns(model.diffuse)) - 1
    out["f0"] = _copy(model.f0, channels, lobes) if model.fresnel else None
    out["x_more"] = _copy(model.x_more, channels, more) if more else None
    for name in ("anisotropy", "tangent_angle"):
        start = getattr(model, name)
        out[name] = _copy(start, 1, lobes).reshape(lobes) if start else None
    return out


def _copy(start: int, channels: int, width: int) -> Floats:
    return np.frombuffer(ctypes.string_at(start, 8 * channels * width), np.float64).reshape(channels, width)


def shapes(fit: Any) -> dict[str, tuple[int, ...]]:
    """Of the arrays that the fit has to have."""
    out: dict[str, tuple[int, ...]] = {}
    if fit.anisotropy is not None:
        out["anisotropy"] = out["tangent_angle"] = (fit.lobes,)
    if fit.fresnel != "none":
        out["f0"] = (len(fit.channels), fit.lobes)
    if more_columns(fit.diffuse):
        out["x_more"] = (len(fit.channels), more_columns(fit.diffuse))
    return out


def check_fit(fit: Any) -> None:
    """Names, and arrays of the right shape: C reads as much as they say."""
    for kind in DEFAULTS:
        check(kind, getattr(fit, kind))
    for name, shape in shapes(fit).items():
        if np.shape(getattr(fit, name)) != shape:
            raise DataError("%s of this fit must have shape %s, not %s" % (name, shape, np.shape(getattr(fit, name))),
                            code="format")
    if fit.f0 is not None and not np.all((np.asarray(fit.f0) >= 0) & (np.asarray(fit.f0) <= 1)):
        raise DataError("f0 of this fit must be in [0, 1]", code="format")


def fill(model: structs.Model, fit: Any) -> list[Floats]:
    """Tell C of them; what it points to is to be kept."""
    for kind in DEFAULTS:
        setattr(model, kind, check(kind, getattr(fit, kind)))
    kept = {name: floats(name, getattr(fit, name)) for name in shapes(fit)}
    for name, array in kept.items():
        setattr(model, name, address(array))
    return list(kept.values())


def f0_interval(model: Any, samples: structs.Samples, options: structs.Options) -> Floats | None:
    """K x P x 2, of brdffit_f0_interval; None where it has nothing to say."""
    if model.contents.fresnel == 0 or options.norm != 0:
        return None
    low, high = (np.empty((model.contents.channels, model.contents.lobes)) for _ in range(2))
    if library().core.brdffit_f0_interval(byref(samples), byref(options), model, low.ctypes.data, high.ctypes.data,
                                          None) != 0:
        return None
    return np.stack([low, high], -1)


_AZIMUTH_SAMPLES = 20_000  # more are not looked at: it would take longer than the fit


def azimuth_share(result: structs.Result, samples: structs.Samples, options: structs.Options) -> float | None:
    """Of brdffit_azimuth_share; None where it has nothing to say."""
    share = ctypes.c_double()
    if options.norm != 0 or samples.form != structs.FORM.index("directions") or samples.count > _AZIMUTH_SAMPLES:
        return None
    if library().core.brdffit_azimuth_share(byref(samples), byref(options), result.model, result.channel_scale, byref(share),
                                            None) != 0:
        return None
    return share.value


# ---- Tables ------------------------------------------------------------------


def tables(fit: Any) -> list[list[list[str]]]:
    """Of F0, and of the diffuse term's coefficients; those that the model has."""
    out = []
    if fit.f0 is not None:
        out.append(_f0_table(fit, fit.f0))
    if fit.x_more is not None:
        out.append(_diffuse_table(fit, fit.x_more))
    return out


def _number(value: float, form: str = "%.4g") -> str:
    return form % value if math.isfinite(value) else "–"


def _f0_table(fit: Any, f0: Floats) -> list[list[str]]:
    rows = [["channel", *(head for p in range(fit.lobes) for head in ("lobe %d F0" % (p + 1), "index n"))]]
    for k, name in enumerate(fit.channels):
        cells = []
        for p in range(fit.lobes):
            used = fit.y[k, p] > 0
            cells += [_number(f0[k, p]) if used else "–",
                      "–" if not used else "metal" if f0[k, p] == 1 else _number(float(ior(f0[k, p])))]
        rows.append([name, *cells])
    return rows


def _diffuse_table(fit: Any, more: Floats) -> list[list[str]]:
    oren_nayar = fit.diffuse == "oren-nayar"
    heads = ["x A", "x B", "roughness"] if oren_nayar else ["x", "x r", "x r^2", "r by x r", "r by x r^2"]
    rows = [["channel", *heads]]
    for k, name in enumerate(fit.channels):
        x, next_ = float(fit.x[k]), [float(one) for one in more[k]]
        implied = ([oren_nayar_roughness(x, next_[0])] if oren_nayar else
                   [next_[0] / x, math.sqrt(next_[1] / x)] if x > 0 else [math.nan, math.nan])
        rows.append([name, *("%.5g" % one for one in (x, *next_)), *map(_number, implied)])
    return rows


def warnings(fit: Any) -> list[str]:
    """A sentence for each lobe whose F0 the directions do not tell."""
    if fit.f0_interval is None:
        return []
    out = []
    for p in range(fit.lobes):
        ends = max((tuple(fit.f0_interval[k, p]) for k in range(len(fit.channels)) if fit.y[k, p] > 0),
                   key=lambda one: float(one[1] - one[0]), default=(0.0, 0.0))
        if ends[1] - ends[0] > WIDE:
            out.append("Warning, lobe %d: F0 is not identified by these directions: anything in [%.2g, %.2g] fits within two "
                       "standard errors, and the index n means nothing." % (p + 1, *ends))
    return out
