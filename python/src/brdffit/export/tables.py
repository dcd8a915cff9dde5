"""Fits as tables of values: MERL's layout, and tensor files of the RGL database. SPDX-License-Identifier: MIT

RGL (Dupuy and Jakob 2018): u = sqrt(2 theta_h / pi) and the half vector's azimuth less the light's, for each angle of light. With
`vndf` constant these are the coordinates of the values themselves, and with `jacobian` 0 a value is f_r (n.o). No measurement was
made, and nothing is warped: narrow lobes have u, which is fine where they are.
"""
from __future__ import annotations

import os
import struct

import numpy as np
import numpy.typing as npt

from .._arrays import Floats
from ..errors import FileError
from ..merl import MerlTable, cell_directions
from .fitted import Fit

_MERL = (90, 90, 180)
_RGL = (16, 72, 72)  # angles of light, azimuths, tilts: readers want the last two alike


def merl(fit: Fit, chosen: list[int], path: str) -> None:
    """Every entry at the edge of its bin, as the database's readers take it; below the horizon it is masked."""
    rows = []
    for row in range(_MERL[0]):
        light, view = cell_directions(_MERL, "edge", row)
        values = fit.predict(light, view, quantity="brdf")[..., chosen]
        values[(light[..., 2] <= 0) | (view[..., 2] <= 0)] = np.nan
        rows.append(values)
    MerlTable(np.stack(rows)).save(path)


def rgl(fit: Fit, chosen: list[int], path: str, comment: str) -> None:
    """An isotropic .bsdf file."""
    lights, azimuths, tilts = _RGL
    theta_i = np.radians(88) * np.linspace(0, 1, lights)
    theta_h, phi = np.pi / 2 * np.linspace(0, 1, tilts) ** 2, np.pi * np.linspace(-1, 1, azimuths)
    half = np.stack(np.broadcast_arrays(np.sin(theta_h) * np.cos(phi[:, None]), np.sin(theta_h) * np.sin(phi[:, None]),
                                        np.cos(theta_h)), -1)
    values = np.empty((lights, azimuths, tilts, 3))
    for i, theta in enumerate(theta_i):
        light = np.array([np.sin(theta), 0.0, np.cos(theta)])
        view = 2 * (half @ light)[..., None] * half - light
        values[i] = _above(fit, light, view)[..., chosen]
    slices = np.moveaxis(values, -1, 1)[None]
    fields: dict[str, npt.NDArray[np.generic]] = {
        "description": np.frombuffer(comment.encode(), np.uint8), "version": np.array([1, 0], np.int32),
        "phi_i": np.zeros(1, np.float32), "theta_i": theta_i.astype(np.float32), "ndf": np.ones((2, 2), np.float32),
        "sigma": np.ones((2, 2), np.float32), "vndf": np.ones((1, lights, 2, 2), np.float32),
        "luminance": np.maximum(slices.mean(2), 1e-12).astype(np.float32), "rgb": slices.astype(np.float32),
        "jacobian": np.zeros(1, np.uint8)}
    _write(path, _tensor(fields))


def _above(fit: Fit, light: Floats, view: Floats) -> Floats:
    """f_r (n.v) at each viewer; below the horizon that of the horizon itself, for those who interpolate across it."""
    up = np.concatenate([view[..., :2], np.maximum(view[..., 2:], 1e-3)], -1)
    up /= np.linalg.norm(up, axis=-1, keepdims=True)
    return np.asarray(fit.predict(light, up, quantity="brdf") * up[..., 2:])


_KINDS = ("u1", "i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f2", "<f4", "<f8")


def _tensor(fields: dict[str, npt.NDArray[np.generic]]) -> bytes:
    """The container of readers/_tensor.py."""
    names = [name.encode() for name in fields]
    arrays = [np.ascontiguousarray(value) for value in fields.values()]
    at = 18 + sum(2 + len(name) + 2 + 1 + 8 + 8 * array.ndim for name, array in zip(names, arrays))
    head, body = b"tensor_file\0\1\0" + struct.pack("<I", len(fields)), b""
    for name, array in zip(names, arrays):
        body += b"\0" * (-(at + len(body)) % 8)
        kind = 1 + [np.dtype(one) for one in _KINDS].index(array.dtype)
        head += struct.pack("<H", len(name)) + name + struct.pack("<HBQ", array.ndim, kind, at + len(body))
        head += struct.pack("<%dQ" % array.ndim, *array.shape)
        body += array.tobytes()
    return head + body


def _write(path: str, data: bytes) -> None:
    """Whole or not at all."""
    partial = "%s.%d.part" % (path, os.getpid())
    try:
        with open(partial, "wb") as file:
            file.write(data)
        os.replace(partial, path)
    except OSError as error:
        raise FileError("cannot be written: %s" % error.strerror, code="open", path=path) from error


def write_text(path: str, text: str) -> None:
    """Whole or not at all."""
    _write(path, text.encode("utf-8"))
