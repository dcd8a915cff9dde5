"""What a fit is asked for. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import ctypes
import dataclasses
import functools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, TypedDict

from . import _lobes, _terms
from . import _structs as structs
from ._arguments import choose
from ._ffi import library
from .errors import OptionError

if TYPE_CHECKING:
    from typing_extensions import Self

class FitOptions(TypedDict, total=False):
    """Keyword arguments that `fit` and its relatives share; `Options` explains them."""

    lobes: int | Sequence[str]
    distribution: str | None
    norm: str
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
    fresnel: str
    diffuse: str
    masking: str
    physical: bool
    anisotropic: bool
    anisotropy: float | None
    tangent_angle: float
    memory: int


@dataclasses.dataclass(frozen=True)
class Options:
    """What a fit is asked for; the defaults are those of the C library.

    lobes: 1, 2 or 3, beside the diffuse term; or what each of them is: ["beckmann", "ggx"]. Lobes come out with those of a
        distribution together, in the order of their first mention, and by ascending roughness among them
    distribution: what every lobe is, when `lobes` is a number: one of `brdffit.distributions()`. None: "beckmann"
    norm: "l2", "l1" (robust to gross outliers) or "linf"; the last two need ECOS
    engine: "moment", or "socp": the paper's feasibility problem (needs ECOS); of norm l2
    normalise: "max" divides each channel by its largest radiance, "none" does not
    sigma_range, exponent_range: where the search looks, and where the proof holds: the one for lobes that are known by
        their roughness sigma, the other for those known by an exponent n
    relative_gap: the search stops when E^2 <= (1 + gap) lower bound
    absolute_gap: or when E^2 - lower bound is at most this share of the data's sum of squares
    sigma_resolution: boxes narrower than this are not split; 0: off
    box_budget: most boxes to bound
    max_incidence: degrees; light further from the normal is skipped. 90: all above the horizon. None: 60, or 90 with Fresnel
    socp_every_box: send every box to ECOS, as the paper does
    isa: "auto", "base", "avx2" or "avx512"; the results have the same bits
    fresnel: "none", or "schlick": Schlick's Fresnel term, with an F0 of each lobe and channel
    diffuse: the diffuse term: "lambert", "none", "oren-nayar" or "burley"
    masking: of Beckmann and GGX lobes: "v-cavity", "smith", "smith-separable" or "none"
    physical: only models that reflect no more than they receive: in each channel x + sum of reflectances (4 y of Beckmann and
        GGX lobes) at most 1, of values that are absolute; of norm l2 and engine moment. `Fit.physical` says what came of it
    anisotropic: the first lobe (Beckmann, GGX, Ward or Ashikhmin-Shirley, beside one other at most) has two roughnesses, along
        the samples' tangent and across it; of norm l2 and engine moment, masking "v-cavity" or "none"
    anisotropy: their ratio sigma_x / sigma_y where it is known; None: searched
    tangent_angle: degrees that the lobe's own tangent is turned by from that of the samples
    memory: bytes that a fit may take, which it makes the best of at the cost of boxes; 0: what nearly every search wants. Of
        norm l2 and engine moment
    """

    lobes: int | Sequence[str] = 1
    distribution: str | None = None
    norm: str = "l2"
    engine: str = "moment"
    normalise: str = "max"
    sigma_range: tuple[float, float] = (1e-12, 6.0)
    exponent_range: tuple[float, float] = (0.1, 1e7)
    relative_gap: float = 1e-3
    absolute_gap: float = 1e-12
    sigma_resolution: float = 0.0
    box_budget: int = 1_000_000
    max_incidence: float | None = None
    socp_every_box: bool = False
    isa: str = "auto"
    fresnel: str = "none"
    diffuse: str = "lambert"
    masking: str = "v-cavity"
    physical: bool = False
    anisotropic: bool = False
    anisotropy: float | None = None
    tangent_angle: float = 0.0
    memory: int = 0

    def __post_init__(self) -> None:
        if self.max_incidence is None:
            object.__setattr__(self, "max_incidence", _terms.incidence(self.fresnel, None))
        if isinstance(self.lobes, list):  # so that options can be looked up
            object.__setattr__(self, "lobes", tuple(self.lobes))

    @functools.cached_property
    def distributions(self) -> tuple[str, ...]:
        """What each lobe is, in the order of the fit."""
        return _lobes.asked(self.lobes, self.distribution)

    @property
    def parameters(self) -> tuple[str, ...]:
        """What each lobe is known by: "sigma", or "exponent" (n; sigma is 1/sqrt(n) then)."""
        return _lobes.parameters(self.distributions)

    @property
    def lobe_count(self) -> int:
        """How many lobes."""
        return len(self.distributions)

    @property
    def incidence(self) -> float:
        """max_incidence, as it is used. `replace` keeps it, also where only fresnel changes."""
        return _terms.incidence(self.fresnel, self.max_incidence)

    @property
    def sigma_searched(self) -> tuple[float, float]:
        """The range of sigma that the search covers for lobes known by it; if there are none, that of the exponent in
        terms of sigma."""
        if "sigma" in self.parameters:
            return self.sigma_range
        return 1 / math.sqrt(self.exponent_range[1]), 1 / math.sqrt(self.exponent_range[0])

    def replace(self, **changes: object) -> Self:
        """A copy with some of them changed."""
        return dataclasses.replace(self, **changes)  # type: ignore[arg-type]

    def _plain(self) -> Self:
        """The same in Python's own numbers, whatever kind (0-d arrays, numpy's scalars) they were given as."""
        c = self._struct()
        names = self.distributions
        alike = len(set(names)) == 1
        return self.replace(
            lobes=int(c.lobes) if alike else names, distribution=names[0] if alike else None,
            sigma_range=(c.sigma_min, c.sigma_max), exponent_range=(c.exponent_min, c.exponent_max),
            relative_gap=c.relative_gap, absolute_gap=c.absolute_gap, sigma_resolution=c.sigma_resolution,
            box_budget=int(c.box_budget), max_incidence=c.max_incidence, socp_every_box=bool(c.socp_every_box),
            physical=bool(c.physical), anisotropic=bool(c.anisotropic), anisotropy=c.anisotropy or None,
            tangent_angle=c.tangent_angle, memory=int(c.memory))

    def _struct(self) -> structs.Options:
        try:
            return structs.Options.from_buffer_copy(_checked(self))
        except TypeError:  # of 0-d arrays or lists: nothing that can be looked up
            return self._make()

    def _make(self) -> structs.Options:
        out = library().options()
        names = self.distributions
        out.lobes = len(names) if isinstance(self.lobes, tuple) else _integer("lobes", self.lobes, 2**31)  # type: ignore[arg-type]
        out.distribution = _lobes.value(names[0])
        if len(set(names)) > 1:
            out.distributions = ctypes.addressof(_lobes.as_c(names))
        out.norm = choose("norm", self.norm, structs.NORM)
        out.engine = choose("engine", self.engine, structs.ENGINE)
        out.normalise = choose("normalise", self.normalise, structs.NORMALISE)
        out.isa = choose("isa", self.isa, structs.ISA)
        out.sigma_min, out.sigma_max = _pair("sigma_range", self.sigma_range)
        out.exponent_min, out.exponent_max = _pair("exponent_range", self.exponent_range)
        for name in ("relative_gap", "absolute_gap", "sigma_resolution", "max_incidence"):
            setattr(out, name, _number(name, getattr(self, name)))
        out.box_budget = _integer("box_budget", self.box_budget, 2**63)
        out.socp_every_box = int(bool(self.socp_every_box))
        out.physical = int(bool(self.physical))
        out.anisotropic = int(bool(self.anisotropic))
        out.anisotropy = 0.0 if self.anisotropy is None else _number("anisotropy", self.anisotropy)
        out.tangent_angle = _number("tangent_angle", self.tangent_angle)
        out.memory = _integer("memory", self.memory, 2**63)
        for kind in _terms.DEFAULTS:
            setattr(out, kind, _terms.check(kind, getattr(self, kind)))
        return out


@functools.lru_cache(maxsize=64)
def _checked(options: Options) -> bytes:
    """The struct of options that are in order: checking them takes as long as a small fit."""
    return bytes(options._make())


def _number(name: str, value: float) -> float:
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise OptionError("%s must be a number, not %r" % (name, value), code="option") from error


def _integer(name: str, value: int, limit: int) -> int:
    try:
        number = int(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise OptionError("%s must be a whole number, not %r" % (name, value), code="option") from error
    if number != value or not 0 <= number < limit:
        raise OptionError("%s must be a whole number of at least 0, not %r" % (name, value), code="option")
    return number


def _pair(name: str, value: tuple[float, float]) -> tuple[float, float]:
    try:
        low, high = value
    except (TypeError, ValueError) as error:
        raise OptionError("%s must be a pair (low, high), not %r" % (name, value), code="option") from error
    return _number(name, low), _number(name, high)
