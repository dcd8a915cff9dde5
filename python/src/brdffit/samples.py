"""Measured samples: from files, from arrays. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import weakref
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _structs as structs
from . import _weights
from ._arguments import Path, choose
from ._arrays import Floats, Frozen, address, column, floats, freeze, vectors
from ._ffi import library
from ._words import readable
from .errors import DataError
from .readers import load
from .readers.native import column_words, protocol84

__all__ = ["Samples", "column_words", "protocol84"]

_VECTORS = ("light", "view", "normal", "tangent")
_ANGLES = ("cos_light", "cos_view", "tan2_half", "cos_difference")
_COEFFICIENTS = ("a", "b", "c")
_COLUMNS = (*_ANGLES, *_COEFFICIENTS, "weights")
_ARRAYS = (*_VECTORS, *_COLUMNS, "values")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Samples(Frozen):
    """Measured reflectance: N samples of K channels. Make one with `from_file`, `from_arrays` or another `from_...`.

    values: N x K, f_r in 1/sr (quantity "brdf") or f_r (n.l) (quantity "radiance")
    channels: K names
    form: which of the following are given
        "directions": light, view (N x 3, any length but zero), normal (N x 3, or None for +z), tangent (N x 3, or None for +x)
        "angles": cos_light, cos_view, tan2_half, cos_difference (N each)
        "coefficients": a, b, c of the model (N each)
    weights: N, multiplies squared residuals of radiance; None: all 1
    weighting: what they are: "none", "column" (given, or a file's own), or made by `weighted`
    file: where it came from, or None
    lines: per sample, its line of the text file, or None
    dropped: entries of the file that did not become samples of their own, by reason
    notes: what was inferred from a text file or left out of it, a sentence each; data_warnings: what looks wrong in it
    reading: how it was asked to be read, as the JSON of a fit has it, or None

    Arrays cannot be written to.
    """

    values: Floats
    channels: tuple[str, ...]
    form: str = "directions"
    quantity: str = "brdf"
    light: Floats | None = None
    view: Floats | None = None
    normal: Floats | None = None
    tangent: Floats | None = None
    cos_light: Floats | None = None
    cos_view: Floats | None = None
    tan2_half: Floats | None = None
    cos_difference: Floats | None = None
    a: Floats | None = None
    b: Floats | None = None
    c: Floats | None = None
    weights: Floats | None = None
    file: str | None = None
    format: str | None = None
    merl_bins: str | None = None
    merl_samples: str | None = None
    lines: npt.NDArray[np.uintp] | None = None
    dropped: Mapping[str, int] = dataclasses.field(default_factory=dict)
    _merl_directions: Floats | None = None
    weighting: str = ""
    notes: tuple[str, ...] = ()
    data_warnings: tuple[str, ...] = ()
    reading: Mapping[str, Any] | None = None

    def __post_init__(self) -> None:
        def put(name: str, value: object) -> None:
            object.__setattr__(self, name, value)

        values = floats("values", self.values)
        if values.ndim == 1:
            values = values.reshape(-1, 1)
        if values.ndim != 2:
            raise DataError("values must be N x K, not shape %s" % (values.shape,), code="argument")
        put("values", freeze(values))
        if not self.weighting:
            put("weighting", "none" if self.weights is None else "column")
        choose("weighting", self.weighting, structs.WEIGHTING)
        choose("form", self.form, structs.FORM)
        choose("quantity", self.quantity, structs.QUANTITY)
        if len(self.channels) != values.shape[1]:
            raise DataError("%d channel names for %d channels" % (len(self.channels), values.shape[1]), code="argument")
        put("channels", tuple(self.channels))
        for name in _VECTORS:
            if getattr(self, name) is not None:
                array = vectors(name, getattr(self, name))
                if array.shape != (len(values), 3):
                    raise DataError("%s must have shape (%d, 3), not %s" % (name, len(values), array.shape),
                                    code="argument")
                put(name, freeze(array))
        for name in _COLUMNS:
            if getattr(self, name) is not None:
                put(name, freeze(column(name, getattr(self, name), len(values))))
        if self.lines is not None:
            put("lines", freeze(self.lines))
        for name in {"directions": ("light", "view"), "angles": _ANGLES, "coefficients": _COEFFICIENTS}[self.form]:
            if getattr(self, name) is None:
                raise DataError("samples of form %r need %s" % (self.form, name), code="argument")

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        source = "" if self.file is None else " from %s" % readable(self.file)
        return "<Samples: %d x %d (%s), %s as %s%s>" % (
            len(self), len(self.channels), ", ".join(self.channels[:8]) + (", ..." if len(self.channels) > 8 else ""),
            self.quantity, self.form, source)

    # ---- Where they come from

    @classmethod
    def from_arrays(cls, light: npt.ArrayLike, view: npt.ArrayLike, values: npt.ArrayLike, *,
                    normal: npt.ArrayLike | None = None, weights: npt.ArrayLike | None = None,
                    channels: Sequence[str] | None = None, quantity: str = "brdf",
                    tangent: npt.ArrayLike | None = None) -> Samples:
        """Directions towards light and viewer (N x 3 each) around the normal (N x 3, one vector, or None for +z), and
        values N x K or N. Directions need not be normalised. tangent, likewise: where anisotropic lobes have their sigma_x; it
        is needed by them where there are normals."""
        data = _rows(values)
        count = len(data)
        return cls(values=data, channels=_names(channels, data), quantity=quantity,
                   light=_spread("light", light, count), view=_spread("view", view, count),
                   normal=None if normal is None else _spread("normal", normal, count),
                   tangent=None if tangent is None else _spread("tangent", tangent, count),
                   weights=None if weights is None else column("weights", weights, count))

    @classmethod
    def from_angles(cls, cos_light: npt.ArrayLike, cos_view: npt.ArrayLike, tan2_half: npt.ArrayLike,
                    cos_difference: npt.ArrayLike, values: npt.ArrayLike, *, weights: npt.ArrayLike | None = None,
                    channels: Sequence[str] | None = None, quantity: str = "brdf") -> Samples:
        """By angles alone, as tables in half and difference angles have them (N each): n.l, n.v, the squared tangent of the
        half angle, v.h. They belong together: n.l + n.v = 2 (v.h) (n.h), to 1e-3."""
        data = _rows(values)
        n = len(data)
        _belong(*(column(name, value, n) for name, value in (("cos_light", cos_light), ("cos_view", cos_view),
                                                            ("tan2_half", tan2_half), ("cos_difference", cos_difference))))
        return cls(values=data, channels=_names(channels, data), quantity=quantity, form="angles",
                   cos_light=column("cos_light", cos_light, n), cos_view=column("cos_view", cos_view, n),
                   tan2_half=column("tan2_half", tan2_half, n),
                   cos_difference=column("cos_difference", cos_difference, n),
                   weights=None if weights is None else column("weights", weights, n))

    @classmethod
    def from_coefficients(cls, a: npt.ArrayLike, b: npt.ArrayLike, c: npt.ArrayLike, values: npt.ArrayLike, *,
                          weights: npt.ArrayLike | None = None, channels: Sequence[str] | None = None) -> Samples:
        """The model's own a, b, c (N each) and radiance."""
        data = _rows(values)
        n = len(data)
        return cls(values=data, channels=_names(channels, data), quantity="radiance", form="coefficients",
                   a=column("a", a, n), b=column("b", b, n), c=column("c", c, n),
                   weights=None if weights is None else column("weights", weights, n))

    @classmethod
    def from_csv(cls, path: Path, *, quantity: str | None = None, channels: Sequence[str] | None = None,
                 columns: Mapping[str, str] | None = None, missing: float | str | None = None,
                 saturated: float | None = None, directions: str | Sequence[str] | None = None,
                 max_bytes: int = 0) -> Samples:
        """A CSV or TSV file (also .gz). One header line names the columns: theta_i, phi_i, theta_o, phi_o in degrees,
        or lx, ly, lz, vx, vy, vz, or a, b, c; weight; uncertainty (standard deviation of the values, in their units, which
        becomes a weight); other columns of numbers are channels. Names are matched by their words (`column_words`), and what
        was inferred or left out is in `notes`.

        quantity: "brdf", "radiance", "ccbrdf" (f_r times the viewer's cosine) or "reflectance-factor" (pi f_r), the last two
            turned into f_r; None: "brdf" for directions, "radiance" for a, b, c
        channels: these columns are the channels; what means nothing else is left out
        columns: what columns mean whose names do not say it: {"theta_i": "Incidence", "ignore": "#3"} (the third column)
        missing: a value that stands for none, "negative" for all below 0, or "none"
        saturated: samples with a value from there on are left out
        directions: what they are, of "degrees", "radians", "elevation" (angles above the surface), "mirror-at-0" (azimuths
            count from the mirror direction), "light-travels" (its vectors point to the surface), "y-up", "as-written"
        max_bytes: most of the file, and of what it unpacks to (0: 8 and 1 GiB)
        """
        return cls(**load(path, "csv", quantity=quantity, channels=channels, columns=columns, missing=missing,
                          saturated=saturated, directions=directions, max_bytes=max_bytes))

    @classmethod
    def _places(cls, path: Path, quantity: str | None) -> Samples:
        """A CSV file that needs no channel: for its directions and weights."""
        return cls(**load(path, "csv", quantity=quantity, directions_only=True))

    @classmethod
    def from_merl(cls, path: Path, *, samples: str | tuple[npt.ArrayLike, npt.ArrayLike] = "table",
                  bins: str = "edge", max_bytes: int = 0) -> Samples:
        """A MERL .binary file (also .gz). samples: "table" (every cell that was measured), "84" (the paper's
        directions), or (light, view) to look up. bins: which angle entry i stands for, its bin's "edge" or "centre".
        max_bytes: most of the file, and of what it unpacks to (0: 8 and 1 GiB)."""
        choose("bins", bins, structs.MERL_BINS)
        if isinstance(samples, str):
            return cls(**load(path, "merl", samples=samples, bins=bins, max_bytes=max_bytes))
        light, view = (vectors(name, value) for name, value in zip(("light", "view"), samples))
        at = cls(values=np.zeros((len(light), 1)), channels=("",), light=light, view=view)
        return cls(**load(path, "merl", samples=at._struct(), bins=bins, max_bytes=max_bytes),
                   _merl_directions=np.hstack([light, view]))

    @classmethod
    def from_rgl(cls, path: Path, *, samples: str | tuple[npt.ArrayLike, npt.ArrayLike] = "measured",
                 clip: bool = True) -> Samples:
        """An isotropic .bsdf file of the RGL database. samples: "measured" (the instrument's own directions, which crowd
        where the material is bright: their weights are solid angles), "84" (the paper's), or (light, view) to look up. clip:
        raise negative channels (colours outside of sRGB) to 0. `load_rgl` does more."""
        return cls(**load(path, "rgl", samples=samples, clip=clip))

    @classmethod
    def from_hdf5(cls, path: Path, *, names: Mapping[str, str | Sequence[str]] | None = None, group: str | None = None,
                  quantity: str | None = None) -> Samples:
        """An HDF5 file (needs h5py). Data sets of `group` (None: the root):

        values: N x K or N; a sample with a channel that is NaN is left out
        light, view: N x 3, or theta_i, phi_i, theta_o, phi_o: N each, in degrees (or with an attribute units = "radians");
            or cos_light, cos_view, tan2_half, cos_difference; or a, b, c
        normal (N x 3) and weights (N): may be absent

        Attributes of values or of the group: quantity ("brdf" or "radiance") and channels. names: other names that the file
        has for these: {"values": "reflectance/data"}; for values also several, one a channel.
        """
        return cls(**load(path, "hdf5", names=names, group=group, quantity=quantity))

    @classmethod
    def from_zarr(cls, path: Path, *, names: Mapping[str, str | Sequence[str]] | None = None, group: str | None = None,
                  quantity: str | None = None) -> Samples:
        """A zarr group, a folder or a .zip (needs zarr), as from_hdf5."""
        return cls(**load(path, "zarr", names=names, group=group, quantity=quantity))

    @classmethod
    def from_file(cls, path: Path) -> Samples:
        """Any of these, by its content (.lp and files that cannot be opened by their name)."""
        return cls(**load(path))

    @classmethod
    def example(cls) -> Samples:
        """The shipped example: satin paint of known truth (sigma 0.12 and 0.45), measured by the project's synthetic
        instrument with 1 % noise."""
        import importlib.resources

        with importlib.resources.as_file(importlib.resources.files("brdffit") / "two_lobe_satin.csv") as path:
            return cls.from_csv(path)

    # ---- What they count for

    def weighted(self, weight: str, *, floor: float = _weights.FLOOR) -> Samples:
        """The same samples with other weights. A sample of weight 0 keeps it.

        weight: "none": all alike; "column": those that they have; "cosine": n.l; "solid-angle": the share of all pairs of
            directions that each stands for, 1 on average, so that it does not matter where most samples lie; "relative":
            1/max(m, floor)^2, m the root mean square over channels of radiance by the channel's largest: relative errors
        floor: of "relative": samples darker than this share of the brightest count no more than it
        """
        if weight == "column" and self.weights is not None:
            return self
        weights = freeze(_weights.weigh(self._struct(), weight, floor, self.file))
        alike = weight == "none" and bool((weights == 1).all())
        return dataclasses.replace(self, weights=None if alike else weights, weighting=weight)

    def crowded(self) -> bool:
        """Whether directions crowd where the material is bright, as those of an instrument that follows the lobe do: without
        weights a fit is to that part (brdffit_weights_crowded). False for other forms and for too few to tell."""
        return self.form == "directions" and len(self) >= 16 and _weights.crowded(self._struct())

    # ---- To C

    def _struct(self) -> structs.Samples:
        """Points into this object's arrays: keep it alive."""
        made = _STRUCTS.get(self)
        if made is None:
            made = _STRUCTS[self] = bytes(self._make())
        return structs.Samples.from_buffer_copy(made)

    def _make(self) -> structs.Samples:
        out = library().samples()
        out.count, out.channels = self.values.shape
        out.form = structs.FORM.index(self.form)
        out.quantity = structs.QUANTITY.index(self.quantity)
        for name in _ARRAYS:
            setattr(out, name, address(getattr(self, name)))
        return out


# What _struct gives copies of. Not kept in the object, which travels: addresses do not.
_STRUCTS: weakref.WeakKeyDictionary[Samples, bytes] = weakref.WeakKeyDictionary()


def _rows(values: npt.ArrayLike) -> Floats:
    data = floats("values", values)
    if data.ndim not in (1, 2):
        raise DataError("values must be N x K or N, not shape %s" % (data.shape,), code="argument")
    return data.reshape(-1, 1) if data.ndim == 1 else data


def _belong(cos_light: Floats, cos_view: Floats, tan2_half: Floats, cos_difference: Floats) -> None:
    """Whether four angles are of one pair of directions: h is between the two."""
    with np.errstate(invalid="ignore"):
        off = np.abs(cos_light + cos_view - 2 * cos_difference / np.sqrt(1 + tan2_half))
    wrong = np.flatnonzero((off > 1e-3) & (cos_light > 0) & (cos_view > 0))
    if len(wrong):
        raise DataError("cos_light + cos_view is not 2 cos_difference / sqrt(1 + tan2_half), which it is of any two directions: "
                        "are all four cosines and a squared tangent, in this order?", code="value", sample=int(wrong[0]),
                        value=float(off[wrong[0]]))


def _names(channels: Sequence[str] | None, values: Floats) -> tuple[str, ...]:
    count = values.shape[1]
    if channels is not None:
        return tuple(str(name) for name in channels)
    return ("r", "g", "b") if count == 3 else tuple("channel%d" % (k + 1) for k in range(count))


def _spread(name: str, value: npt.ArrayLike, count: int) -> Floats:
    array = vectors(name, value)
    if array.ndim == 1:
        array = np.broadcast_to(array, (count, 3))
    return np.ascontiguousarray(array)
