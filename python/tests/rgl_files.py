"""Made-up .bsdf files: a writer of tensor files and a plausible material. SPDX-License-Identifier: MIT"""
import struct

import numpy as np

TYPES = ("u1", "i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f2", "<f4", "<f8")


def tensor_bytes(fields):
    """A tensor file of {name: array}, each field at a multiple of 8."""
    names = [name.encode() for name in fields]
    arrays = [np.ascontiguousarray(value) for value in fields.values()]
    at = 18 + sum(2 + len(name) + 2 + 1 + 8 + 8 * array.ndim for name, array in zip(names, arrays))
    head, body = b"tensor_file\0\1\0" + struct.pack("<I", len(fields)), b""
    for name, array in zip(names, arrays):
        body += b"\0" * (-(at + len(body)) % 8)
        kind = 1 + [np.dtype(kind) for kind in TYPES].index(array.dtype)
        head += struct.pack("<H", len(name)) + name + struct.pack("<HBQ", array.ndim, kind, at + len(body))
        head += struct.pack("<%dQ" % array.ndim, *array.shape)
        body += array.tobytes()
    return head + body


def material(kind="rgb", seed=5):
    """Fields of a rough metal with noise in every table, so that no mistake of an index goes unseen. kind: "rgb", "spectra",
    "plain" (without the factor D/(4 sigma)) or "turned" (two azimuths of light)."""
    rng = np.random.default_rng(seed)
    nodes = 7
    phi = np.array([-np.pi, np.pi] if kind == "turned" else [0.0])
    theta = np.radians(89) * np.linspace(0, 1, nodes) ** 0.7
    rows, columns, side = 32, 40, 10
    u, v = np.linspace(0, 1, columns), np.linspace(0, 1, rows)
    normal, turn = np.pi / 2 * u ** 2, (2 * v[:, None] - 1) * np.pi
    alpha = 0.35
    distribution = alpha ** 2 / (np.pi * (np.cos(normal) ** 2 * (alpha ** 2 - 1) + 1) ** 2)
    cosine = (np.cos(theta)[:, None, None] * np.cos(normal) + np.sin(theta)[:, None, None] * np.sin(normal) * np.cos(turn))
    visible = np.maximum(cosine, 0) * distribution * 2 * np.pi ** 2 * u * np.sin(normal)
    visible = visible * rng.uniform(0.5, 1.5, (len(phi), *visible.shape)) + 1e-3 * rng.uniform(size=(len(phi), *visible.shape))
    waves = 5 if kind == "spectra" else 3
    values = rng.uniform(0.1, 1, (len(phi), nodes, waves, side, side))
    luminance = values.mean(2)
    blind = rng.uniform(size=luminance.shape) < 0.02
    luminance[blind] = 0
    values[np.broadcast_to(blind[:, :, None], values.shape)] = 0
    if kind == "rgb":
        values[:, :, 0, 4, 4] = -0.2  # a colour outside of sRGB
    single = {"phi_i": phi, "theta_i": theta, "ndf": np.stack([distribution] * 2) * [[1.0], [1.1]],
              "sigma": np.stack([0.1 + 0.9 * np.cos(np.pi / 2 * u ** 2)] * 2), "vndf": visible, "luminance": luminance,
              "spectra" if kind == "spectra" else "rgb": values}
    if kind == "spectra":
        single["wavelengths"] = np.array([400.0, 450.0, 530.0, 600.0, 700.0])
    fields = {"description": np.frombuffer(b"made up", np.uint8), "version": np.array([1, 0], np.int32)}
    fields.update({name: array.astype(np.float32) for name, array in single.items()})
    fields["jacobian"] = np.array([kind != "plain"], np.uint8)
    return fields


KINDS = ("rgb", "spectra", "plain", "turned")


def directions(count, seed):
    """Uniform on the upper hemisphere, exact in single precision."""
    d = np.random.default_rng(seed).standard_normal((count, 3))
    d[:, 2] = np.abs(d[:, 2])
    return (d / np.linalg.norm(d, axis=1, keepdims=True)).astype(np.float32).astype(np.float64)
