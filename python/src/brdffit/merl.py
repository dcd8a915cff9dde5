"""Whole tables in MERL's layout. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import gzip
import os

import numpy as np
import numpy.typing as npt

from ._arrays import Floats, freeze, vectors
from .errors import DataError, FileError, OptionError
from .samples import Path, Samples, choose

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
        """f_r of the nearest entry at directions ... x 3 around +z: ... x 3; NaN below the horizon and where nothing
        was measured."""
        l, v = np.broadcast_arrays(vectors("light", light), vectors("view", view))
        l, v = (d / np.linalg.norm(d, axis=-1, keepdims=True) for d in (l, v))
        half = l + v
        half = half / np.maximum(np.linalg.norm(half, axis=-1, keepdims=True), 1e-300)
        theta_h = np.arctan2(np.hypot(half[..., 0], half[..., 1]), half[..., 2])
        cos_d = np.clip(np.sum(l * half, -1), -1, 1)
        # The difference vector: light in the frame whose pole is the half vector.
        phi = np.arctan2(half[..., 1], half[..., 0])
        side = np.stack([np.cos(theta_h) * np.cos(phi), np.cos(theta_h) * np.sin(phi), -np.sin(theta_h)], -1)
        across = np.stack([-np.sin(phi), np.cos(phi), np.zeros_like(phi)], -1)
        phi_d = np.arctan2(np.sum(l * across, -1), np.sum(l * side, -1)) % np.pi
        n_h, n_d, n_p = self.values.shape[:3]
        shift = 0.5 if self.bins == "edge" else 0.0
        places = (n_h * np.sqrt(theta_h / (np.pi / 2)), n_d * np.arccos(cos_d) / (np.pi / 2), n_p * phi_d / np.pi)
        i, j, k = (np.clip((p + shift).astype(int), 0, n - 1) for p, n in zip(places, (n_h, n_d, n_p)))
        k = np.where((places[2] + shift).astype(int) >= n_p, 0, k)  # azimuth is a circle
        out = self.values[i, j, k]
        out[(l[..., 2] <= 0) | (v[..., 2] <= 0)] = np.nan
        return np.asarray(out)

    def samples(self, at: str | tuple[npt.ArrayLike, npt.ArrayLike] = "table") -> Samples:
        """Samples to fit: see Samples.from_merl."""
        if self.file is None:
            raise OptionError("this table has no file", code="argument")
        return Samples.from_merl(self.file, samples=at, bins=self.bins)


def load_merl(path: Path, *, bins: str = "edge") -> MerlTable:
    """A MERL .binary file (also .gz) as an array. `Samples.from_merl` is the way to a fit."""
    choose("bins", bins, ("edge", "centre"))
    name = os.fspath(path)
    try:
        with open(name, "rb") as file:
            raw = file.read()
        if raw[:2] == b"\x1f\x8b":
            raw = gzip.decompress(raw)
    except (OSError, EOFError) as error:
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
