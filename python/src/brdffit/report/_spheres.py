"""Spheres lit by one distant light: from the table, from the fit, and their difference. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt

from .._arrays import Floats
from ._analysis import Material
from ._png import data_uri

SIZE, SMALL = 200, 64
GAMMA = 2.2
# Towards the light, 35 degrees from the viewer, up and left.
LIGHT = np.array([-0.42, 0.40, 0.82]) / np.linalg.norm([-0.42, 0.40, 0.82])
VIEW = np.array([0.0, 0.0, 1.0])
UNKNOWN = np.array([0.51, 0.31, 0.87])  # violet: no material's colour


@dataclasses.dataclass
class Spheres:
    """pictures: (address, caption); words: what they show; exposure: linear value of a pixel = radiance x exposure, the
    same in all of them."""

    pictures: list[tuple[str, str]]
    words: list[str]
    exposure: float


def geometry(size: int) -> tuple[npt.NDArray[np.bool_], Floats]:
    """Which pixels see the sphere, and its normals there."""
    span = (np.arange(size) + 0.5) / size * 2.06 - 1.03
    x, y = np.meshgrid(span, -span)
    inside = x * x + y * y < 1
    z = np.sqrt(np.maximum(1 - x * x - y * y, 0))
    return inside, np.stack([x, y, z], -1)[inside]


def _chosen(material: Material) -> list[int]:
    """Channels that become red, green and blue."""
    names = [name.lower() for name in material.samples.channels]
    if len(names) != 3:
        return [0, 0, 0]
    return [names.index(c) for c in "rgb"] if sorted(names) == ["b", "g", "r"] else [0, 1, 2]


def _fitted(material: Material, normal: Floats) -> tuple[Floats, float]:
    """Radiance under a light of irradiance 1 across its direction, and an exposure that suits it."""
    radiance = material.main.predict(LIGHT, VIEW, normal=normal, quantity="radiance")[:, _chosen(material)]
    lit = radiance[normal @ LIGHT > 0].max(1)
    return radiance, 0.9 / max(float(np.quantile(lit, 0.97)), 1e-12)


def thumbnail(material: Material) -> str:
    inside, normal = geometry(SMALL)
    radiance, exposure = _fitted(material, normal)
    return _picture(inside, radiance * exposure)


def render(material: Material) -> Spheres:
    """The measured one and the difference only where there is a whole table."""
    inside, normal = geometry(SIZE)
    fitted, exposure = _fitted(material, normal)
    names = material.samples.channels
    colour = [] if len(names) == 3 else ["Grey: channel %s." % names[0]]
    out = Spheres([(_picture(inside, fitted * exposure), "Rendered from the fit")], colour, exposure)
    if material.table is None:
        out.words.insert(0, "Single directions give no picture of the measurement; a whole table (MERL, RGL) does.")
        return out
    cosine = np.maximum(normal @ LIGHT, 0)[:, None]
    with np.errstate(invalid="ignore"):
        measured = material.table.lookup(_local(normal, LIGHT), _local(normal, VIEW))[:, _chosen(material)] * cosine
    known = ~np.isnan(measured).any(1) | (cosine[:, 0] <= 0)
    measured = np.where(cosine > 0, measured, 0)
    difference = fitted - measured
    out.pictures = [(_picture(inside, measured * exposure, known), "Rendered from the measured table"), *out.pictures,
                    (_picture(inside, np.clip(0.5 + 2 * difference * exposure, 0, 1), known, 1.0),
                     "Fit less measured, four times as strong; mid-grey is equal")]
    out.words.append(_comparison(material, measured[known], fitted[known], int(np.sum(~known)), len(known)))
    return out


def _comparison(material: Material, measured: Floats, fitted: Floats, unknown: int, count: int) -> str:
    pairs = zip(_chosen(material), measured.mean(0), fitted.mean(0))
    words = "The same light and exposure. Mean radiance of the sphere, fit against table: %s." % ", ".join(
        "%s %s" % (material.samples.channels[k], _ratio(float(m), float(f))) for k, m, f in pairs)
    if unknown:
        words += " Violet: not measured, %.2g %% of the sphere." % (100 * unknown / count)
    return words


def _ratio(measured: float, fitted: float) -> str:
    if not measured > 0:
        return "black in the table"
    share = fitted / measured
    return "%.3g times" % share if not 0.5 < share < 2 else "%+.2g %%" % (100 * (share - 1))


def _local(normal: Floats, direction: Floats) -> Floats:
    """`direction` in a frame with each normal as z."""
    side = np.cross(np.array([0.0, 1.0, 0.0]), normal)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-12)
    return np.stack([side @ direction, np.sum(np.cross(normal, side) * direction, 1), normal @ direction], -1)


def _picture(inside: npt.NDArray[np.bool_], values: Floats, known: npt.NDArray[np.bool_] | None = None,
             gamma: float = GAMMA) -> str:
    image = np.zeros((*inside.shape, 4))
    with np.errstate(invalid="ignore"):
        pixels = np.clip(values, 0, 1) ** (1 / gamma)
    image[inside, :3] = pixels if known is None else np.where(known[:, None], pixels, UNKNOWN)
    image[inside, 3] = 1
    return data_uri((image * 255).round().astype(np.uint8))
