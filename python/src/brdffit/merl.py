"""Whole tables in MERL's layout. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import gzip
import os
import zlib

import numpy as np
import numpy.typing as npt

from ._arguments import Path, choose
from ._arrays import Floats, freeze, vectors
from .errors import DataError, FileError, OptionError
from .samples import Samples

Index = npt.NDArray[np.intp]
_SNAP = 1e-14  # radians: IO_EDGE_SNAP
SCALE = np.array([1.0, 1.15, 1.66]) / 1500


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class MerlTable:
    """A measured isotropic BRDF over half and difference angles.

    values: n_h x n_d x n_p x 3, f_r in 1/sr; NaN where nothing was measured
    bins: which angle entry i stands for: its bin's "edge", theta_h = 90 (i/n)^2 degrees, or its "centre"
    """

    values: Floats
    bins: str = "edge"
    file: str | None = None

    def __repr__(self) -> str:
        return "<MerlTable %s: %s cells>" % (self.file or "", " x ".join(map(str, self.values.shape[:3])))

    def lookup(self, light: npt.ArrayLike, view: npt.ArrayLike) -> Floats:
        """f_r of the entry whose bin holds directions ... x 3 around +z: ... x 3; NaN below the horizon, where nothing was
        measured, and for directions that are not finite or have no length."""
        l, v = np.broadcast_arrays(vectors("light", light), vectors("view", view))
        with np.errstate(invalid="ignore", divide="ignore"):
            l, v = (d / np.linalg.norm(d, axis=-1, keepdims=True) for d in (l, v))
        none = ~(np.isfinite(l) & np.isfinite(v)).all(-1) | (l[..., 2] <= 0) | (v[..., 2] <= 0)
        l, v = (np.where(none[..., None], (0.0, 0.0, 1.0), d) for d in (l, v))
        i, j, k = _cells(self.values.shape[:3], l, v)
        out = self.values[i, j, k]
        out[none] = np.nan
        return np.asarray(out)

    def samples(self, at: str | tuple[npt.ArrayLike, npt.ArrayLike] = "table") -> Samples:
        """Samples to fit: see Samples.from_merl."""
        if self.file is None:
            raise OptionError("this table has no file: save() it first", code="argument")
        return Samples.from_merl(self.file, samples=at, bins=self.bins)

    def save(self, path: Path) -> MerlTable:
        """Write a MERL .binary file, whole or not at all: this table, as it would be loaded from there."""
        name = os.fspath(path)
        if not (np.isnan(self.values) | ((self.values >= 0) & np.isfinite(self.values))).all():
            raise DataError("a value is negative or infinite, which a MERL file cannot hold", code="value", path=name)
        hole = np.isnan(self.values).any(-1, keepdims=True)
        planes = np.moveaxis(np.where(hole, -1, self.values / SCALE), -1, 0)
        partial = "%s.%d.part" % (name, os.getpid())
        try:
            try:
                with open(partial, "wb") as file:
                    file.write(np.array(self.values.shape[:3], "<i4").tobytes())
                    file.write(np.ascontiguousarray(planes, "<f8").data)
                os.replace(partial, name)
            except BaseException:
                if os.path.exists(partial):
                    os.unlink(partial)
                raise
        except OSError as error:
            raise FileError("cannot be written: %s" % error.strerror, code="open", path=name) from error
        return dataclasses.replace(self, file=name)


def cell_directions(dims: tuple[int, int, int], bins: str, row: int) -> tuple[Floats, Floats]:
    """Light and view of the entries of one theta_h, n_d x n_p x 3, the half vector at azimuth 0; some are below the
    horizon."""
    n_h, n_d, n_p = dims
    shift = 0.5 if bins == "centre" else 0.0
    theta_h = 0.5 * np.pi * ((row + shift) / n_h) ** 2
    theta_d = 0.5 * np.pi * (np.arange(n_d)[:, None] + shift) / n_d
    phi_d = np.pi * (np.arange(n_p)[None, :] + shift) / n_p
    x, y, z = np.sin(theta_d) * np.cos(phi_d), np.sin(theta_d) * np.sin(phi_d), np.cos(theta_d) + 0 * phi_d
    sine, cosine = np.sin(theta_h), np.cos(theta_h)
    light = np.stack([cosine * x + sine * z, y, cosine * z - sine * x], -1)
    view = np.stack([sine * z - cosine * x, -y, cosine * z + sine * x], -1)
    return light, view


def _cells(dims: tuple[int, ...], l: Floats, v: Floats) -> tuple[Index, Index, Index]:
    """The cell that unit vectors fall into, as src/io/merl_lookup.c finds it: bins are the database's own, and an angle
    that rounding left just below an edge is on it."""
    h, d = l + v, 0.5 * (l - v)
    length = np.linalg.norm(h, axis=-1)
    flat = np.hypot(h[..., 0], h[..., 1])
    theta_h = np.arctan2(flat, h[..., 2])
    theta_d = np.arctan2(2 * np.linalg.norm(d, axis=-1), length)
    tilted = theta_h > _SNAP
    safe = np.where(tilted, flat, 1)
    east, north = np.where(tilted, h[..., 0] / safe, 1), np.where(tilted, h[..., 1] / safe, 0)
    x = (h[..., 2] * (east * d[..., 0] + north * d[..., 1]) - flat * d[..., 2]) / np.where(length > 0, length, 1)
    phi = np.arctan2(east * d[..., 1] - north * d[..., 0], x)
    phi = np.where(theta_d > _SNAP, np.where(phi < 0, phi + np.pi, phi), 0)
    lever = np.minimum(theta_d, np.where(tilted, theta_h, theta_d))
    n_h, n_d, n_p = dims
    snap = np.minimum(_SNAP + _SNAP / np.where(lever > 0, lever, 1), 0.25 * np.pi / n_p)
    i = _settle(theta_h / (0.5 * np.pi), _SNAP / (0.5 * np.pi), n_h, square=True)
    j = _settle(theta_d / (0.5 * np.pi), _SNAP / (0.5 * np.pi), n_d)
    k = _settle(phi / np.pi, snap / np.pi, n_p)
    return np.minimum(i, n_h - 1), np.minimum(j, n_d - 1), np.where(k < n_p, k, 0)


def _settle(part: Floats, snap: float | Floats, bins: int, square: bool = False) -> Index:
    """Bin of an angle that is `part` of its range; edge i is at i/bins, or at its square."""
    index = np.minimum(bins * (np.sqrt(part) if square else part), bins).astype(np.intp)
    edge = (index + 1) / bins
    return np.asarray(index + ((index < bins) & ((edge * edge if square else edge) - part <= snap)))


def load_merl(path: Path, *, bins: str = "edge") -> MerlTable:
    """A MERL .binary file (also .gz) as an array. `Samples.from_merl` is the way to a fit."""
    choose("bins", bins, ("edge", "centre"))
    name = os.fspath(path)
    try:
        with open(name, "rb") as file:
            raw = file.read()
        if raw[:2] == b"\x1f\x8b":
            raw = gzip.decompress(raw)
    except (OSError, EOFError, zlib.error) as error:
        raise FileError(str(error), code="open" if isinstance(error, FileNotFoundError) else "read",
                        path=name) from error
    dims = np.frombuffer(raw[:12], "<i4") if len(raw) >= 12 else np.zeros(3)
    count = int(np.prod(dims.astype(object)))
    if not (all(dims > 0) and len(raw) == 12 + 24 * count):
        raise DataError("the file's size is not what its MERL header says", code="format", path=name)
    planes = np.frombuffer(raw, "<f8", 3 * count, 12).reshape(3, *dims)
    if not np.isfinite(planes).all():
        raise DataError("a value is not finite", code="value", path=name)
    values = np.moveaxis(planes, 0, -1) * SCALE
    values[(planes < 0).any(0)] = np.nan
    return MerlTable(freeze(values), bins, name)
