"""One fit: the call, and its result. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import ctypes
import dataclasses
import json
import math
import os
import time
from collections.abc import Callable, Mapping, Sequence
from ctypes import POINTER, byref
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _forms, _lobes, _terms, _words
from . import _structs as structs
from ._arguments import Path, choose
from ._arrays import Floats, Frozen, address, floats, freeze, vectors
from ._ffi import library
from .errors import DataError, OptionError, from_struct
from .export import Exported
from .export import export as _export
from .intervals import Intervals
from .intervals import intervals as _intervals
from .options import Options, _number
from .progress import Observer, ProgressArgument
from .samples import Samples

SCHEMA = "brdffit.fit/1"
SamplesLike = Union[Samples, str, "os.PathLike[str]"]

_ARRAY_FIELDS = ("sigma", "exponent", "x", "y", "channel_scale", "rms", "weight", "effective_samples",
                 "sigma_interval", "exponent_interval", "proven_sigma", "proven_exponent", "_merl_directions", "f0", "x_more",
                 "f0_interval", "sigma_xy", "anisotropy", "tangent_angle")
_WORD_FIELDS = ("channels", "sigma_range", "exponent_range", "misfit", "notes", "data_warnings")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Fit(Frozen):
    """A fitted model and its certificate. Attribute names are those of `brdffit fit --json`.

    status: "certified", or "gap_open" when the search stopped before its gap closed (the fit and its bound are valid
        all the same), or "contradiction" (an error of the library: nothing is proven); stop: why it stopped
    distributions: what each of the P lobes is: those of a distribution stand together; distribution: the same as one word,
        None where they differ
    sigma: P roughnesses, ascending among lobes of one distribution
    exponent: P exponents n, sigma = 1/sqrt(n), NaN of lobes that are not known by them; None where no lobe is
    x: K diffuse coefficients; y: K x P specular ones, in the data's units (the paper's scaling, see brdffit.h)
    fresnel, diffuse, masking: the rest of the model, as in `Options`
    physical: None, unless physical bounds were asked for: channels_at_limit, how many of them they hold down, and e2_free, the
        e2 of the fit without them
    f0: K x P reflectances at normal incidence, factors of y, 0 of a lobe with y = 0; ior: the indices of refraction that
        they stand for; f0_interval: K x P x 2, how well the samples tell f0 (two standard errors, sigma given; see
        brdffit_f0_interval of brdffit.h). All None without Fresnel, f0_interval also with other norms than l2
    x_more: K x (1 or 2) coefficients of the diffuse term's further columns (Oren-Nayar's B; Burley's x r and x r^2); None
        where it has one
    sigma_xy: P x 2, roughness along and across the tangent; anisotropy: P, their ratio, sigma being the root of their product;
        tangent_angle: P, degrees from the samples' tangent. None where no lobe was asked to be anisotropic
    azimuth_share: the part of e2 that a slight stretch of a lobe would take off, to first order: from about 0.25 on
        `anisotropic` is worth it; None where it was not looked at
    e2, objective: what the norm minimises, in units of channel_scale (K divisors)
    e2_error: how far e2 may be from that of this model on the samples, by rounding and by what sums do not know
    lower_bound: proven: no model of this form with each lobe's sigma in its proven_sigma has less; gap: e2 - lower_bound
    proven_sigma: P x 2, those ranges, ends included: what was asked for, or less where narrower lobes have coefficients
        beyond any double; NaN where no lobe is left. proven_exponent: the same in terms of n, NaN of lobes that are not
        known by it; None where no lobe is
    rms: K root mean square radiance residuals, the data's units; rms_total: of all, in units of channel_scale
    r2: K, 1 - sum w r^2 / sum w (I - mean I)^2 of radiance I and its residuals r, NaN where I does not vary; r2_total,
        relative_rms (sqrt(sum w r^2 / sum w I^2)): of all channels in units of their largest I; foreseen: the share of squared
        residuals that those of neighbouring samples foretell, near 1 where the model misses something; misfit: "poor" (in some
        channel R^2 below 0.5 and residuals above 0.1 of the data), "patterned" (foreseen above 0.77,
        relative_rms above 0.02): this model does not
        describe these data (see brdffit_quality of brdffit.h). None in fits of fit_many
    weight: share of each lobe; effective_samples: how many samples it rests on
    sigma_interval: P x 2, where E^2 is the optimum's to rounding; warnings: per lobe, of "unresolved", "flat",
        "unused", "at_limit"
    samples_used, samples_skipped: how many, and by reason
    weighting: what samples counted for, see `Samples.weighted`
    notes, data_warnings, reading: as of `Samples`
    seconds: read (when it was a file), reduce (where it was told apart), search; None in fits of fit_many, which are
        not timed one by one
    """

    status: str
    distribution: str | None
    norm: str
    engine: str | None
    lobes: int
    sigma: Floats
    exponent: Floats | None
    x: Floats
    y: Floats
    channel_scale: Floats
    e2: float
    lower_bound: float
    gap: float
    rms: Floats
    rms_total: float
    sum_of_squares: float
    kkt_residual: float
    samples_used: int
    samples_skipped: Mapping[str, int]
    boxes: int
    nodes: int
    socp: Mapping[str, int] | None
    verify: Mapping[str, Any] | None
    distinct_c: int
    stop: str
    weight: Floats
    effective_samples: Floats
    sigma_interval: Floats
    exponent_interval: Floats | None
    warnings: tuple[tuple[str, ...], ...]
    channels: tuple[str, ...]
    normalise: str
    sigma_range: tuple[float, float]
    exponent_range: tuple[float, float] | None
    proven_sigma: Floats
    relative_gap: float
    absolute_gap: float
    sigma_resolution: float
    box_budget: int
    max_incidence: float
    format: str | None
    quantity: str
    merl_bins: str | None
    merl_samples: str | None
    seconds: Mapping[str, float] | None
    file: str | None = None
    schema: str = SCHEMA
    e2_error: float = 0.0
    proven_exponent: Floats | None = None
    _merl_directions: Floats | None = None
    distributions: tuple[str, ...] = ()
    fresnel: str = "none"
    diffuse: str = "lambert"
    masking: str = "v-cavity"
    physical: Mapping[str, Any] | None = None
    f0: Floats | None = None
    x_more: Floats | None = None
    f0_interval: Floats | None = None
    weighting: str = "none"
    r2: Floats | None = None
    r2_total: float | None = None
    relative_rms: float | None = None
    foreseen: float | None = None
    misfit: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    data_warnings: tuple[str, ...] = ()
    reading: Mapping[str, Any] | None = None
    sigma_xy: Floats | None = None
    anisotropy: Floats | None = None
    tangent_angle: Floats | None = None
    azimuth_share: float | None = None

    def __post_init__(self) -> None:
        if not self.distributions and self.distribution is not None:  # from before there were lists
            object.__setattr__(self, "distributions", (self.distribution,) * self.lobes)

    @property
    def parameters(self) -> tuple[str, ...]:
        """What each lobe is known by: "sigma" or "exponent"."""
        return _lobes.parameters(self.distributions)

    @property
    def values(self) -> Floats:
        """P: of each lobe its own parameter, sigma or n."""
        return self.sigma if self.exponent is None else np.where(np.isnan(self.exponent), self.sigma, self.exponent)

    @property
    def ior(self) -> Floats | None:
        """K x P: (1 + sqrt f0) / (1 - sqrt f0), infinite where f0 is 1; None without Fresnel."""
        return None if self.f0 is None else _terms.ior(self.f0)

    @property
    def certified(self) -> bool:
        """Whether optimality is proven to the gap that was asked for."""
        return self.status == "certified"

    @property
    def objective(self) -> float:
        """What the norm minimises: e2 under a name that fits every norm."""
        return self.e2

    @property
    def certificate(self) -> str:
        """What is proven, in words."""
        return _words.certificate(self)

    # ---- Evaluate

    def predict(self, light: npt.ArrayLike, view: npt.ArrayLike, *, normal: npt.ArrayLike | None = None,
                tangent: npt.ArrayLike | None = None, quantity: str | None = None) -> Floats:
        """The model at directions ... x 3 (broadcast against each other): ... x K, in the fit's quantity or the one
        that is named ("brdf" or "radiance"). 0 on and below the horizon."""
        directions = [vectors("light", light), vectors("view", view)]
        names = ["light", "view"]
        for name, given in (("normal", normal), ("tangent", tangent)):
            if given is not None:
                directions.append(vectors(name, given))
                names.append(name)
        spread = np.broadcast_arrays(*directions)
        flat = [np.ascontiguousarray(d.reshape(-1, 3)) for d in spread]
        at = library().samples()
        at.count, at.form = len(flat[0]), structs.FORM.index("directions")
        for name, array in zip(names, flat):
            setattr(at, name, address(array))
        out = self._evaluate(at, quantity)
        return out.reshape(*spread[0].shape[:-1], len(self.channels))

    def predict_samples(self, samples: Samples, *, quantity: str | None = None) -> Floats:
        """The model at the samples' own places, N x K: any form of samples."""
        return self._evaluate(samples._struct(), quantity or samples.quantity)

    def _evaluate(self, at: structs.Samples, quantity: str | None) -> Floats:
        ffi = library()
        at.quantity = choose("quantity", self.quantity if quantity is None else quantity, structs.QUANTITY)
        self._check_model()
        sigma, x, y = floats("sigma", self.sigma), floats("x", self.x), floats("y", self.y)
        model = ffi.model()
        names = _lobes.as_c(tuple(self.distributions))
        model.distribution, model.lobes, model.distributions = names[0], self.lobes, ctypes.addressof(names)
        model.channels = len(x)
        model.sigma, model.x, model.y = address(sigma), address(x), address(y)
        keep = _terms.fill(model, self)
        out = np.zeros((at.count, len(x)))
        error = structs.Error()
        if ffi.core.brdffit_eval(byref(model), byref(at), out.ctypes.data, byref(error)) != 0:
            raise from_struct(error, channels=self.channels)
        del keep
        return out

    def _check_model(self) -> None:
        """C reads as much as lobes and channels say: of a fit that was made by hand or by others, is it there?"""
        channels, lobes = len(self.channels), self.lobes
        if lobes not in range(1, _lobes.MOST + 1):
            raise DataError("a fit has 1 to %d lobes, not %r" % (_lobes.MOST, lobes), code="format")
        if self.distribution is not None and set(self.distributions) != {self.distribution}:
            raise DataError("distribution %r and distributions %r do not say the same" % (
                self.distribution, self.distributions), code="format")
        if len(self.distributions) != lobes:
            raise DataError("distributions of a fit of %s must be as many, not %r" % (
                _lobes.count_word(lobes), self.distributions), code="format")
        for name in self.distributions:
            choose("distribution", name, tuple(_lobes.distributions()))
        for name, shape in (("sigma", (lobes,)), ("x", (channels,)), ("y", (channels, lobes))):
            if np.shape(getattr(self, name)) != shape:
                raise DataError("%s of a fit of %s and %d channel%s must have shape %s, not %s" % (
                    name, _lobes.count_word(lobes), channels, "" if channels == 1 else "s", shape,
                    np.shape(getattr(self, name))), code="format")
        _terms.check_fit(self)

    # ---- How sure

    def intervals(self, samples: Samples, level: float = 0.95, noise: float | None = None, eta: float | None = None,
                  tolerance: float = 0.02, box_budget: int = 20_000) -> Intervals:
        """Intervals of every parameter, over all models that are nearly as good: proven for the data and a threshold of E^2.

        samples: those of the fit
        level: of profile-likelihood intervals for independent Gaussian noise
        noise: its standard deviation, in the units that were minimised (the data's over channel_scale); None: from the residual
        eta: instead of the two: all models with E^2 <= (1 + eta) e2
        tolerance: ends are proven to this share of their distance from the fit, within box_budget boxes each

        Norm l2 only.
        """
        return _intervals(self, samples, level, noise, eta, tolerance, box_budget)

    # ---- Elsewhere

    def export(self, target: str, path: Path, *, samples: Samples | None = None, channels: Sequence[str] | None = None,
               scene: bool = False) -> Exported:
        """Write the fit as a material: exact where the target has its model, else fitted again in the target's own.

        target: "mitsuba", "pbrt", "cycles", "blender", "materialx", "openpbr", "gltf", "usd"; "osl", "glsl", "hlsl" (functions);
            "merl", "rgl" (tables). What each means by its numbers: docs/export.md
        samples: the measurement, for what is fitted again and for the error that is told; None: the fit's own values, at
            directions that stand for all
        channels: which three are red, green and blue; None: the fit has three, or one (grey)
        scene: "mitsuba" and "blender": a whole scene that renders a sphere of it
        """
        return _export(self, target, path, samples, None if channels is None else tuple(channels), scene, fit)

    # ---- Show

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, strings and lists: the JSON of the command line, member for member."""
        return _words.plain(self)

    def to_json(self) -> str:
        """One line as of `brdffit fit --json`, with the fewest digits that read back the same; `brdffit eval` takes it."""
        return json.dumps(self.to_dict(), ensure_ascii=False, allow_nan=False, separators=(",", ":"))

    @classmethod
    def from_dict(cls, line: Mapping[str, Any]) -> Fit:
        """Of an object that `to_dict` or the command line wrote. Raises `DataError` when it is none, or damaged."""
        try:
            fit = cls._of_members(line)
            with np.errstate(all="ignore"):
                _words.html(fit)  # what can be neither shown nor written is of no use
                fit.to_json()
            return fit
        except DataError:
            raise
        except (ArithmeticError, AssertionError, AttributeError, LookupError, RecursionError, TypeError,
                ValueError) as error:
            raise DataError("this fit is damaged (%s: %s)" % (type(error).__name__, error), code="format") from error

    @classmethod
    def _of_members(cls, line: Mapping[str, Any]) -> Fit:
        if line.get("schema") != SCHEMA:
            raise DataError("this is not a fit of schema %s" % SCHEMA, code="format")
        if line.get("status") == "error":
            raise DataError("this fit failed: %s" % line.get("error", {}).get("message", "no reason given"),
                            code="format")
        given = dict(line)
        given["_merl_directions"] = given.pop("merl_directions", None)
        if "file_bytes" in given:
            given["file"] = os.fsdecode(bytes.fromhex(given["file_bytes"]))
        given["warnings"] = tuple(tuple(words) for words in given.get("warnings", ()))
        names = {field.name for field in dataclasses.fields(cls)}
        members: dict[str, Any] = {name: given.get(name) for name in names}
        members["e2_error"] = given.get("e2_error", 0.0)
        members.update({kind: given.get(kind) or name for kind, name in _terms.DEFAULTS.items()})
        members["weighting"] = given.get("weighting") or "none"
        members["distributions"] = tuple(given["distributions"]) if given.get("distributions") else ()
        for name, missing_one in (("exponent", np.nan), ("exponent_interval", (np.nan, np.nan))):
            if members[name] is not None:
                members[name] = [missing_one if one is None else one for one in members[name]]
        for name, asked in (("proven_sigma", "sigma_range"), ("proven_exponent", "exponent_range")):
            found = given.get(name, [given.get(asked)] * int(given.get("lobes") or 1) if given.get(asked) else None)
            members[name] = None if found is None else [(np.nan, np.nan) if one is None else one for one in found]
        for name in _ARRAY_FIELDS:
            if members[name] is not None:
                members[name] = freeze(floats(name, members[name]))
        if given.get("r2") is not None:
            members["r2"] = freeze(floats("r2", [np.nan if one is None else one for one in given["r2"]]))
        for name in ("misfit", "notes", "data_warnings"):
            members[name] = members[name] or ()
        for name in _WORD_FIELDS:
            if members[name] is not None:
                members[name] = tuple(members[name])
        missing = sorted(n for n in ("sigma", "x", "y", "channels") if members[n] is None)
        if not members["distributions"] and members["distribution"] is None:
            missing.append("distributions")
        if missing:
            raise DataError("this fit has no %s" % ", ".join(missing), code="format")
        fit = cls(**members)
        fit._check_model()
        return fit

    @classmethod
    def from_json(cls, text: str) -> Fit:
        """Of one line that `to_json` or `brdffit fit --json` wrote. Raises `DataError` when it is none, or damaged."""
        try:
            line = json.loads(text)
        except (RecursionError, ValueError) as error:
            raise DataError("this is not JSON (%s)" % error, code="format") from error
        if not isinstance(line, dict):
            raise DataError("this is not a JSON object", code="format")
        return cls.from_dict(line)

    def __repr__(self) -> str:
        return _words.text(self)

    def _repr_html_(self) -> str:
        return _words.html(self)


def fit(samples: SamplesLike, *, lobes: int | Sequence[str] | None = None, distribution: str | None = None, norm: str = "l2",
        engine: str = "moment", normalise: str = "max", sigma_range: tuple[float, float] = (1e-12, 6.0),
        exponent_range: tuple[float, float] = (0.1, 1e7), relative_gap: float = 1e-3, absolute_gap: float = 1e-12,
        sigma_resolution: float = 0.0, box_budget: int = 1_000_000, max_incidence: float | None = None,
        socp_every_box: bool = False, isa: str = "auto", weight: str | None = None,
        verify: float | None = None, progress: ProgressArgument = None, fresnel: str | None = None,
        diffuse: str | None = None, masking: str | None = None, model: str | None = None, physical: bool = False,
        anisotropic: bool = False, anisotropy: float | None = None, tangent_angle: float = 0.0, memory: int = 0) -> Fit:
    """Fit a model to samples (or to a file of them) and prove how close to the best it is.

    Options are explained at `Options`; those that are None are the model's, or else as there.

    model: a preset ("principled", "disney", "paper", "cook-torrance", "phong"), or a form by the name that `compare` has for it
        ("2beckmann", "ggx/smith/schlick"): it stands for options, and those that are given beside it go before
    weight: what samples count for, as of `Samples.weighted`; None: the weights that they have
    verify: prove the bound again with engine socp, less this margin (0.1: 10 %): `Fit.verify` says what came of it
    progress: called with a `Progress` every 256 boxes, a true return value stops the search (the fit is valid all
        the same); True shows a bar (tqdm's, when it is installed). An exception in it ends the call, as Ctrl-C does.

    Raises a `BrdffitError`. A search that stops early is not an error: see `Fit.status`. Thread-safe, and threads run
    at the same time; the result has the same bits in each.
    """
    form = _forms.under(model, lobes=lobes, distribution=distribution, max_incidence=max_incidence, fresnel=fresnel,
                        diffuse=diffuse, masking=masking)
    options = Options(norm=norm, engine=engine, normalise=normalise, sigma_range=sigma_range, exponent_range=exponent_range,
                      relative_gap=relative_gap, absolute_gap=absolute_gap, sigma_resolution=sigma_resolution,
                      box_budget=box_budget, socp_every_box=socp_every_box, isa=isa, physical=physical,
                      anisotropic=anisotropic, anisotropy=anisotropy, tangent_angle=tangent_angle, memory=memory, **form)
    began = time.perf_counter()
    data = samples if isinstance(samples, Samples) else _read(samples, model)
    read = {} if data is samples else {"read": time.perf_counter() - began}
    if weight is not None:
        data = data.weighted(weight)
    return run(data, options, verify, progress, read)


def _read(path: str | os.PathLike[str], model: str | None) -> Samples:
    """A file; of a MERL table the directions that the model's preset asks for."""
    data = Samples.from_file(path)
    preset = None if model is None else _forms.PRESETS.get(model)
    if preset is None or preset.merl_samples is None or data.format != "merl":
        return data
    return Samples.from_merl(path, samples=preset.merl_samples)


def run(samples: Samples, options: Options, verify: float | None, progress: ProgressArgument,
        read: Mapping[str, float], box: Callable[[object, Any], None] | None = None) -> Fit:
    """The fit itself: one call of brdffit_fit_new, and its result in Python's own memory."""
    ffi = library()
    if verify is not None:  # said before the search
        verify = _number("verify", verify)
        if not 0 <= verify < 1:
            raise OptionError("verify must be a margin in [0, 1), not %r" % (verify,), code="option")
    c_options, c_samples = options._struct(), samples._struct()
    observer = Observer(progress)
    observer.attach(c_options)
    if box is not None:
        box_function = structs.BoxFunction(box)  # alive until the call returns
        c_options.box = box_function
    result = POINTER(structs.Result)()
    error = structs.Error()
    began = time.perf_counter()
    try:
        with observer:
            status = ffi.core.brdffit_fit_new(byref(c_samples), byref(c_options), byref(result), byref(error))
            ended = time.perf_counter()
        if status != 0:
            raise from_struct(error, path=samples.file, channels=samples.channels, lines=samples.lines)
        proof = None if verify is None else _verify(samples, options, result.contents, verify)
        told = None if options.physical else _terms.f0_interval(result.contents.model, c_samples, c_options)
        share = None if options.anisotropic else _terms.azimuth_share(result.contents, c_samples, c_options)
        return convert(result.contents, samples, options, proof, {**read, **observer.seconds(began, ended)}, told, share,
                       _quality(result.contents.model, c_samples, c_options))
    finally:
        ffi.core.brdffit_result_free(result)


def _verify(samples: Samples, options: Options, result: structs.Result, margin: float) -> dict[str, Any]:
    ffi = library()
    c_options = options.replace(engine="socp")._struct()
    c_samples = samples._struct()
    size = ffi.core.brdffit_workspace_size(c_samples.count, c_samples.channels, byref(c_options))
    workspace = np.empty(size, np.uint8)  # its pages exist once they are touched
    made, error = POINTER(structs.Verification)(), structs.Error()
    began = time.perf_counter()
    if ffi.core.brdffit_verify(byref(c_samples), byref(c_options), result.lower_bound * (1 - margin),
                               workspace.ctypes.data, size, byref(made), byref(error)) != 0:
        raise from_struct(error, path=samples.file)
    v = made.contents  # in the workspace
    proven = bool(v.proven)
    return {"engine": "socp", "level": v.level, "proven": proven, "unproven": v.unproven,
            "stop": None if proven else structs.STOP[v.stop], "boxes": int(v.boxes), "leaves": int(v.leaves),
            "solved": int(v.solved), "refused": int(v.refused), "decided": int(v.decided),
            "seconds": time.perf_counter() - began}


def _quality(model: Any, samples: structs.Samples, options: structs.Options) -> dict[str, Any]:
    """How good the fit is, as attributes of a `Fit`."""
    ffi = library()
    count, channels = samples.count, samples.channels
    fitted, r2, total, misfit = np.empty((count, channels)), np.empty(channels), np.empty(3), ctypes.c_uint(0)
    if (ffi.core.brdffit_eval(model, byref(samples), fitted.ctypes.data, None) != 0 or
            ffi.core.brdffit_quality(byref(samples), byref(options), fitted.ctypes.data, r2.ctypes.data, total.ctypes.data,
                                     byref(misfit), None) != 0):
        return {}
    r2[~np.isfinite(r2)] = np.nan
    figures = [float(one) if math.isfinite(one) else None for one in total]
    return {"r2": freeze(r2), "r2_total": figures[0], "relative_rms": figures[1], "foreseen": figures[2],
            "misfit": tuple(word for bit, word in enumerate(structs.MISFIT) if misfit.value >> bit & 1)}


def _copy(start: int, count: int) -> Floats:
    """Doubles at an address, in Python's own memory, which cannot be written to."""
    return np.frombuffer(ctypes.string_at(start, 8 * count), np.float64)


# Words of a brdffit_lobe, and where each of its figures is.
_LOBE_BYTES = ctypes.sizeof(structs.Lobe)
_LOBE = {field[0]: getattr(structs.Lobe, field[0]).offset // 8 for field in structs.Lobe._fields_}
_FIGURES = ("e2", "e2_error", "lower_bound", "gap", "rms_total", "sum_of_squares", "kkt_residual", "samples_used", "boxes",
            "nodes", "distinct_c")


_CONTRADICTION = structs.STOP.index("contradiction")


def _warned(r: structs.Result, lobes: int) -> tuple[tuple[str, ...], ...]:
    bits = [r.lobe[p].contents.warnings for p in range(lobes)]
    return tuple(tuple(word for bit, word in enumerate(structs.WARNINGS) if b >> bit & 1) if b else () for b in bits)


def _status(r: structs.Result) -> str:
    return "certified" if r.certified else "contradiction" if r.stop == _CONTRADICTION else "gap_open"


def _proven(floor: Floats, by_n: Sequence[bool], options: Options) -> tuple[Floats, Floats | None]:
    """What the bound is about, lobe by lobe: in sigma, and (None where no lobe has one) in the exponent."""
    low, high = options.exponent_range
    sigma = np.array([(f, 1 / math.sqrt(low) if by else options.sigma_range[1]) if math.isfinite(f) else (math.nan, math.nan)
                      for f, by in zip(floor, by_n)])
    if not any(by_n):
        return freeze(sigma), None
    least = 1 / math.sqrt(high)
    return freeze(sigma), freeze(np.array([
        (low, (1 - 1e-15) / (f * f) if f > least else high) if by and math.isfinite(f) else (math.nan, math.nan)
        for f, by in zip(floor, by_n)]))


def convert(r: structs.Result, samples: Samples, options: Options, proof: Mapping[str, Any] | None,
            seconds: Mapping[str, float] | None, f0_interval: Floats | None = None,
            azimuth_share: float | None = None, quality: Mapping[str, Any] | None = None) -> Fit:
    """A brdffit_result as a Fit that owns its memory."""
    model = r.model.contents
    lobes, channels = model.lobes, model.channels
    names = _lobes.from_c(model.distributions, lobes)
    by_n = [name == "exponent" for name in _lobes.parameters(names)]
    by_exponent = any(by_n)
    skipped = dict(zip(structs.SKIP, r.samples_skipped[:len(structs.SKIP)]), **{
        reason: int(samples.dropped.get(reason, 0)) for reason in structs.DROP})
    table = np.frombuffer(b"".join(ctypes.string_at(r.lobe[p], _LOBE_BYTES) for p in range(lobes)),
                          np.float64).reshape(lobes, -1)
    n = _LOBE["exponent"]
    if by_exponent and not all(by_n):  # 0 in C where there is no n
        table = table.copy()
        table[np.logical_not(by_n), n:n + 3] = np.nan
    proven = _proven(table[:, _LOBE["sigma_floor"]], by_n, options)
    fit = object.__new__(Fit)
    # What Fit() does, one member after the other and slower than a small fit. A test holds the two against each other.
    fit.__dict__.update(
        status=_status(r), proven_sigma=proven[0], proven_exponent=proven[1],
        distribution=names[0] if len(set(names)) == 1 else None, distributions=names, norm=options.norm,
        engine=options.engine if options.norm == "l2" else None, lobes=lobes,
        sigma=_copy(model.sigma, lobes), exponent=table[:, n] if by_exponent else None,
        x=_copy(model.x, channels), y=_copy(model.y, channels * lobes).reshape(channels, lobes),
        channel_scale=_copy(r.channel_scale, channels), rms=_copy(r.rms, channels),
        **{name: getattr(r, name) for name in _FIGURES}, samples_skipped=skipped, socp=_socp(r), verify=proof,
        stop=structs.STOP[r.stop], weight=table[:, _LOBE["weight"]], effective_samples=table[:, _LOBE["effective_samples"]],
        sigma_interval=table[:, _LOBE["sigma_low"]:_LOBE["sigma_high"] + 1],
        exponent_interval=table[:, n + 1:n + 3] if by_exponent else None, warnings=_warned(r, lobes),
        channels=samples.channels, normalise=options.normalise,
        sigma_range=options.sigma_searched, exponent_range=options.exponent_range if by_exponent else None,
        relative_gap=options.relative_gap, absolute_gap=options.absolute_gap,
        sigma_resolution=options.sigma_resolution, box_budget=options.box_budget,
        max_incidence=options.max_incidence, format=samples.format, quantity=samples.quantity,
        merl_bins=samples.merl_bins, merl_samples=samples.merl_samples, seconds=seconds, file=samples.file,
        schema=SCHEMA, _merl_directions=samples._merl_directions, weighting=samples.weighting,
        physical={"channels_at_limit": int(r.channels_at_limit), "e2_free": r.e2_free} if options.physical else None,
        **_terms.of_model(model), **(quality or {}), notes=samples.notes, data_warnings=samples.data_warnings,
        reading=samples.reading,
        azimuth_share=azimuth_share,
        sigma_xy=table[:, _LOBE["sigma_x"]:_LOBE["sigma_y"] + 1] if model.anisotropy else None,
        f0_interval=None if f0_interval is None else freeze(f0_interval))
    return fit


def _socp(r: structs.Result) -> dict[str, int] | None:
    if r.programs_solved + r.programs_decided == 0:
        return None
    return {"solved": int(r.programs_solved), "refused": int(r.programs_refused), "decided": int(r.programs_decided)}
