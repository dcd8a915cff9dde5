"""Spheres lit by one distant light: from the table, from the fit, and their difference. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .._arrays import Floats
from ._analysis import Material
from ._png import data_uri

SIZE = 200
# Towards the light, 35 degrees from the viewer, up and left.
LIGHT = np.array([-0.42, 0.40, 0.82]) / np.linalg.norm([-0.42, 0.40, 0.82])
VIEW = np.array([0.0, 0.0, 1.0])


def geometry() -> tuple[npt.NDArray[np.bool_], Floats]:
    """Which pixels see the sphere, and its normals there."""
    span = (np.arange(SIZE) + 0.5) / SIZE * 2.06 - 1.03
    x, y = np.meshgrid(span, -span)
    inside = x * x + y * y < 1
    z = np.sqrt(np.maximum(1 - x * x - y * y, 0))
    return inside, np.stack([x, y, z], -1)[inside]


def render(material: Material) -> list[tuple[str, str]]:
    """(address of the picture, caption); the measured ones only where there is a whole table."""
    channels = len(material.samples.channels)
    chosen = [0, 1, 2] if channels == 3 else [0, 0, 0]
    inside, normal = geometry()
    cosine = np.maximum(normal @ LIGHT, 0)[:, None]
    fitted = material.main.predict(LIGHT, VIEW, normal=normal, quantity="brdf")[:, chosen] * cosine
    exposure = 0.9 / max(float(np.quantile(fitted[cosine[:, 0] > 0].max(1), 0.97)), 1e-12)
    words = "rendered from the fit" + ("" if channels in (1, 3) else ", channel %s" % material.samples.channels[0])
    out = [(_picture(inside, fitted * exposure), words[0].upper() + words[1:])]
    if material.table is None:
        return out
    light, view = _local(normal, LIGHT), _local(normal, VIEW)
    with np.errstate(invalid="ignore"):
        measured = material.table.lookup(light, view)[:, chosen] * cosine
    known = ~np.isnan(measured).any(1) | (cosine[:, 0] <= 0)
    measured = np.where(np.isnan(measured), 0, measured)
    difference = np.where(known[:, None], fitted - measured, 0)
    out.insert(0, (_picture(inside, measured * exposure, known), "Rendered from the measured table" + (
        "" if known.all() else "; holes were not measured")))
    shade = np.clip(0.5 + 2 * difference * exposure, 0, 1)
    out.append((_picture(inside, shade, known, 1.0), "Fit less measured, four times as strong; mid-grey is equal"))
    return out


def _local(normal: Floats, direction: Floats) -> Floats:
    """`direction` in a frame with each normal as z."""
    side = np.cross(np.array([0.0, 1.0, 0.0]), normal)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-12)
    return np.stack([side @ direction, np.sum(np.cross(normal, side) * direction, 1), normal @ direction], -1)


def _picture(inside: npt.NDArray[np.bool_], values: Floats, known: npt.NDArray[np.bool_] | None = None,
             gamma: float = 2.2) -> str:
    image = np.zeros((SIZE, SIZE, 4))
    image[inside, :3] = np.clip(values, 0, 1) ** (1 / gamma)
    image[inside, 3] = 1 if known is None else known
    return data_uri((image * 255).round().astype(np.uint8))
