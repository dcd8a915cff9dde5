"""Measurements of the EPFL RGL database: isotropic .bsdf files. SPDX-License-Identifier: MIT

Dupuy and Jakob, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering", 2018. With m the half
vector, theta in [0, pi/2] mapped to u = sqrt(2 theta/pi) and phi to v = (phi + pi)/(2 pi):

    f_r(i, o) cos(theta_o) = S(x, y; theta_i) D(m) / (4 sigma(i)),   (x, y) = warp(u_m, v_m - v_i; theta_i)

where the warp (_warp.py) is that of the visible normals at theta_i, D the distribution of normals, sigma the projected
area of the microsurface, and S what was measured, on a grid of (x, y). i is the light, o the viewer. Files without the
factor D/(4 sigma) say so (field "jacobian"). A grid point of luminance 0 was not measured: the detector cannot see it. Nor
was the last angle of light of the database's files, 90 degrees: it is a copy of the one before, about 80 degrees.

The reference (powitacq) gives f_r cos(theta_o), in single precision; this is f_r, in double.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .._arguments import Path, choose
from .._arrays import Floats, freeze, vectors
from .._weights import solid_angles
from ..errors import DataError, OptionError, UnsupportedError
from ._tensor import TensorFile
from ._warp import Mix, Warp, bilinear, cell, mix
from .native import protocol84

_CHUNK = 1 << 15  # directions at a time
_GRAZING = np.radians(89.9)
_POLE = 1e-12  # half vectors this close to the normal have no azimuth
Channels = Sequence[int | str] | None
Mask = npt.NDArray[np.bool_]


class Measurement:
    """What an isotropic file holds, evaluated anywhere: `RGLMaterial` without what other modules make of it."""

    def __init__(self, tensor: TensorFile) -> None:
        self.file = tensor.file
        self.description = tensor.read("description", "u1", 1).tobytes().decode("utf-8", "replace")
        self.theta_i, self._phi_i = (freeze(_nodes(tensor, name)) for name in ("theta_i", "phi_i"))
        if len(self._phi_i) > 2:
            raise UnsupportedError("this material is anisotropic (measured at %d azimuths of light); only isotropic ones can "
                                   "be fitted" % len(self._phi_i), code="unsupported", path=self.file)
        self._jacobian = bool(_whole(tensor, "jacobian", (1,))[0])
        self._normals, self._area = (_grid(tensor, name, 2) for name in ("ndf", "sigma"))
        if not (self._area > 0).all():
            raise tensor.wrong("field 'sigma' has values that are not above 0")
        slices = (len(self._phi_i), len(self.theta_i))
        visible = _grid(tensor, "vndf", 4, slices)
        if not (visible.max((1, 2)) > 0).all():
            raise tensor.wrong("field 'vndf' is 0 throughout for an angle of light")
        self._warp = Warp(visible)
        self._blind = (_grid(tensor, "luminance", 4, slices, signed=True) == 0).astype(np.float64)
        self.wavelengths, self.channels = _spectrum(tensor)
        name = "rgb" if self.wavelengths is None else "spectra"
        values = _grid(tensor, name, 5, (*slices, len(self.channels)), signed=True)
        if values.shape[-2:] != self._blind.shape[-2:]:
            raise tensor.wrong("fields %r and 'luminance' differ in their last two dimensions" % name)
        # slices x rows x columns x channels: a point's channels lie side by side
        self._values = np.ascontiguousarray(np.moveaxis(values, 1, -1))
        self._mark_copies(slices)

    def _mark_copies(self, slices: tuple[int, ...]) -> None:
        """Light along the surface measures nothing."""
        if slices[1] > 1 and self.theta_i[-1] > _GRAZING:
            by_phi = self._values.reshape(*slices, -1)
            copied = (by_phi[:, -1] == by_phi[:, -2]).all(1)
            self._blind.reshape(*slices, -1)[copied, -1] = 1

    # ---- Anywhere

    def _evaluate(self, light: npt.ArrayLike, view: npt.ArrayLike, clip: bool, channels: Channels) -> Floats:
        """f_r, 0 below the horizon."""
        return self._each(light, view, lambda l, v: self._fr(l, v, channels)[0], clip)

    def _known(self, light: npt.ArrayLike, view: npt.ArrayLike, clip: bool, channels: Channels) -> Floats:
        """f_r, NaN below the horizon and where nothing was measured."""
        def known(l: Floats, v: Floats) -> Floats:
            values, seen = self._fr(l, v, channels)
            values[~seen] = np.nan
            return values

        return self._each(light, view, known, clip)

    def _each(self, light: npt.ArrayLike, view: npt.ArrayLike, function: Callable[[Floats, Floats], Floats],
              clip: bool) -> Floats:
        """`function` of unit directions n x 3, a part at a time: intermediate results are wide."""
        l, v = _together(light, view)
        parts = []
        flat = [d.reshape(-1, 3) for d in (l, v)]
        for first in range(0, max(len(flat[0]), 1), _CHUNK):
            with np.errstate(invalid="ignore", divide="ignore"):
                units = [d[first:first + _CHUNK] / np.linalg.norm(d[first:first + _CHUNK], axis=1, keepdims=True)
                         for d in flat]
            parts.append(function(*units))
        out = np.concatenate(parts)
        if clip:
            np.maximum(out, 0, out=out)  # NaN stays
        return out.reshape(*l.shape[:-1], out.shape[1])

    def _chosen(self, channels: Channels) -> list[int]:
        """Positions of channels, which may be named."""
        count = len(self.channels)
        if channels is None:
            return list(range(count))
        out = []
        for one in channels:
            at = self.channels.index(one) if isinstance(one, str) and one in self.channels else one
            if isinstance(at, str) or not 0 <= at < count:
                raise OptionError("there is no channel %r; the file has %s" % (one, ", ".join(self.channels)), code="option",
                                  path=self.file)
            out.append(int(at))
        return out

    def _of(self, channels: Channels) -> npt.NDArray[np.float32]:
        return self._values if channels is None else self._values[..., self._chosen(channels)]

    def _fr(self, light: Floats, view: Floats, channels: Channels) -> tuple[Floats, Mask]:
        """f_r, n x K, and whether it was measured."""
        values = self._of(channels)
        out, seen = np.zeros((len(light), values.shape[-1])), np.zeros(len(light), bool)
        up = (light[:, 2] > 0) & (view[:, 2] > 0)  # NaN is not up
        l, v = light[up], view[up]
        theta, phi = _elevation(l), np.arctan2(l[:, 1], l[:, 0])
        half = l + v
        half /= np.linalg.norm(half, axis=1, keepdims=True)
        u = np.sqrt(_elevation(half) * (2 / np.pi))
        turn = np.where(np.hypot(half[:, 0], half[:, 1]) > _POLE, np.arctan2(half[:, 1], half[:, 0]) - phi, 0)
        turn = (turn + np.pi) / (2 * np.pi)
        turn -= np.floor(turn)
        mixed = mix(self._phi_i, self.theta_i, phi, theta)
        x, y, some = self._warp.invert(u, turn, mixed)
        at = cell(values.shape[:-1], x, y)
        out[up] = bilinear(values, at, mixed) * (self._factor(u, turn, theta, phi) / v[:, 2])[:, None]
        seen[up] = some & self._seen(at, mixed)
        return out, seen

    def _factor(self, u: Floats, v: Floats, theta: Floats, phi: Floats) -> Floats:
        """D(m) / (4 sigma(i)), or 1."""
        if not self._jacobian:
            return np.ones_like(u)
        area = bilinear(self._area, cell(self._area.shape, np.sqrt(theta * (2 / np.pi)), (phi + np.pi) / (2 * np.pi)))
        return bilinear(self._normals, cell(self._normals.shape, u, v)) / (4 * area)

    def _seen(self, at: Any, mixed: Mix) -> Mask:
        """Whether no unmeasured grid point has weight, rounding apart."""
        return np.asarray(bilinear(self._blind, at, mixed) < 1e-9)

    # ---- Where it was measured

    def _members(self, samples: str | tuple[npt.ArrayLike, npt.ArrayLike] = "measured", *, clip: bool = True,
                 channels: Channels = None) -> dict[str, Any]:
        """The members of `Samples`: see `RGLMaterial.samples`."""
        names = tuple(self.channels[k] for k in self._chosen(channels))
        if isinstance(samples, str):
            choose("samples", samples, ("measured", "84"))
            if samples == "measured":
                light, view, values = self._measurements(channels)
                if clip:
                    values = np.maximum(values, 0)
            else:
                light, view = protocol84()
                values = self._known(light, view, clip, channels)
        else:
            light, view = _together(*samples)
            values = self._known(light, view, clip, channels)
        light, view, values = light.reshape(-1, 3), view.reshape(-1, 3), values.reshape(-1, len(names))
        seen = ~np.isnan(values).any(1)
        if not seen.any():
            raise DataError("none of these directions was measured", code="no_samples", path=self.file)
        members: dict[str, Any] = {"channels": names, "file": self.file, "format": "rgl", "dropped": {"masked": int((~seen).sum())}}
        light, view, values = light[seen], view[seen], values[seen]
        if isinstance(samples, str) and samples == "measured":
            light, view, values = _merged(light, view, values)
            members["dropped"]["repeated"] = int(seen.sum()) - len(values)
            members.update(weights=solid_angles(light, view), weighting="solid-angle")
        return {"values": values, "light": light, "view": view, **members}

    def _measurements(self, channels: Channels) -> tuple[Floats, Floats, Floats]:
        """Light, view and f_r of each grid point, NaN where it is blind; azimuth 0."""
        if len(self._phi_i) > 1:
            raise UnsupportedError("the file holds two azimuths of light: name the directions of the samples",
                                   code="unsupported", path=self.file)
        count, rows, columns, _ = self._values.shape
        slices, j, i = (g.ravel() for g in np.meshgrid(*map(np.arange, (count, rows, columns)), indexing="ij"))
        u, v = self._warp.sample(i / (columns - 1), j / (rows - 1), slices)
        theta, zero = self.theta_i[slices], np.zeros(len(slices))
        light = np.stack([np.sin(theta), zero, np.cos(theta)], 1)
        tilt, turn = u * u * (np.pi / 2), (2 * v - 1) * np.pi
        half = np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], 1)
        view = 2 * np.sum(half * light, 1, keepdims=True) * half - light
        values = self._of(channels).reshape(len(slices), -1).astype(np.float64)
        with np.errstate(divide="ignore", invalid="ignore"):
            values *= (self._factor(u, v, theta, zero) / view[:, 2])[:, None]
        values[(self._blind.ravel() > 0) | ~(view[:, 2] > 0) | ~(light[:, 2] > 0)] = np.nan
        return light, view, values


_SAME = 1e-5  # single precision moves directions that repeat by up to 1e-6; others are further apart


def _merged(light: Floats, view: Floats, values: Floats) -> tuple[Floats, Floats, Floats]:
    """One sample of each pair of directions, the mean of those that repeat it: the mirror direction, where half vectors of
    every azimuth are the normal, and the seam of the azimuths."""
    first = np.arange(len(values))  # of each sample, the one that it repeats
    for offset in (0.0, 0.31, 0.64):  # what one grid tells apart at the border of its cells another does not
        keys = np.round(np.hstack([light, view])[first] / _SAME + offset).astype(np.int64)
        _, place, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        first = first[place[group.ravel()]]
    kept, group = np.unique(first, return_inverse=True)
    count = np.bincount(group)[:, None]
    means = np.stack([np.bincount(group, column) for column in values.T], 1) / count
    return light[kept], view[kept], means


def read(path: Path, *, samples: str | tuple[npt.ArrayLike, npt.ArrayLike] = "measured", clip: bool = True) -> dict[str, Any]:
    """The members of `Samples`, of a file."""
    return Measurement(TensorFile(path))._members(samples, clip=clip)


def _together(light: npt.ArrayLike, view: npt.ArrayLike) -> tuple[Floats, Floats]:
    """Both ... x 3, broadcast against each other."""
    l, v = vectors("light", light), vectors("view", view)
    try:
        both = np.broadcast_arrays(l, v)
    except ValueError as error:
        raise DataError("light and view of shapes %s and %s do not go together" % (l.shape, v.shape), code="argument") from error
    return both[0], both[1]


def _elevation(d: Floats) -> Floats:
    """The angle from +z, to rounding even close to it."""
    return np.asarray(2 * np.arcsin(np.minimum(0.5 * np.sqrt(d[:, 0] ** 2 + d[:, 1] ** 2 + (d[:, 2] - 1) ** 2), 1)))


def _whole(tensor: TensorFile, name: str, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    array = tensor.read(name, "u1", len(shape))
    if array.shape != shape:
        raise tensor.wrong("field %r must hold %d value, not %d" % (name, int(np.prod(shape)), array.size))
    return array


def _nodes(tensor: TensorFile, name: str) -> Floats:
    """Where the slices stand: one or more, ascending."""
    nodes = np.asarray(tensor.read(name, "f4", 1), np.float64)
    low, high = (0.0, 1.6) if name == "theta_i" else (-6.3, 6.3)
    if not (len(nodes) > 0 and (nodes >= low).all() and (nodes <= high).all() and (np.diff(nodes) > 0).all()):
        raise tensor.wrong("field %r must hold ascending angles in radians" % name)
    return nodes


def _grid(tensor: TensorFile, name: str, dimensions: int, leading: tuple[int, ...] = (), *,
          signed: bool = False) -> npt.NDArray[np.float32]:
    """Finite values on a grid of two points a side or more; the first two dimensions (slices) made one."""
    array = tensor.read(name, "f4", dimensions)
    if array.shape[:len(leading)] != leading or min(array.shape[-2:]) < 2 or 0 in array.shape:
        raise tensor.wrong("field %r has shape %s; %s and two dimensions of 2 or more were expected" % (
            name, array.shape, leading if leading else "nothing"))
    if not np.isfinite(array).all():
        raise tensor.wrong("field %r has values that are not finite" % name)
    if not signed and not (array >= 0).all():
        raise tensor.wrong("field %r has negative values" % name)
    return np.asarray(array if dimensions == 2 else array.reshape(-1, *array.shape[2:]), np.float32)


def _spectrum(tensor: TensorFile) -> tuple[Floats | None, tuple[str, ...]]:
    if "rgb" in tensor.fields or "spectra" not in tensor.fields:
        return None, ("r", "g", "b")
    nodes = np.asarray(tensor.read("wavelengths", "f4", 1), np.float64)
    if not (len(nodes) > 0 and (nodes > 0).all() and np.isfinite(nodes).all() and (np.diff(nodes) > 0).all()):
        raise tensor.wrong("field 'wavelengths' must hold ascending wavelengths in nm")
    return freeze(nodes), tuple("%.6gnm" % node for node in nodes)
