"""Directions of a stack: shared by all texels, or each texel's own. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import os
from typing import Union

import numpy as np
import numpy.typing as npt

from .._arrays import Floats, column, vectors
from ..errors import DataError
from ..samples import Samples
from .stack import of_all_samples

DirectionsLike = Union[npt.ArrayLike, Samples, "os.PathLike[str]"]


@dataclasses.dataclass(frozen=True)
class Geometry:
    """shared: what all texels have in common; its values are not looked at.
    light, view: samples x spatial shape x 3 (broadcast), or None where they are shared; normal: spatial shape x 3"""

    shared: Samples
    light: Floats | None = None
    view: Floats | None = None
    normal: Floats | None = None

    @property
    def own(self) -> bool:
        """Whether a texel has directions of its own."""
        return self.light is not None or self.view is not None or self.normal is not None

    def at(self, texel: tuple[int, ...]) -> Samples:
        """Of one texel."""
        changes: dict[str, Floats] = {}
        for name in ("light", "view"):
            own = getattr(self, name)
            if own is not None:
                changes[name] = own[of_all_samples(texel)]
        if self.normal is not None:
            changes["normal"] = np.broadcast_to(self.normal[texel], (len(self.shared), 3))
        return dataclasses.replace(self.shared, **changes)  # type: ignore[arg-type]


def geometry(light: DirectionsLike, view: npt.ArrayLike | None, normal: npt.ArrayLike | None,
             weights: npt.ArrayLike | None, quantity: str | None, samples: int, spatial: tuple[int, ...]) -> Geometry:
    """Of the arguments of `fit_map`."""
    if isinstance(light, (str, os.PathLike)):
        light = Samples._places(light, quantity)
    if isinstance(light, Samples):
        return _of_samples(light, view, normal, weights, quantity, samples, spatial)
    wide = (samples, *spatial, 3)
    lights, light_map = _directions("light", light, wide)
    views, view_map = _directions("view", (0.0, 0.0, 1.0) if view is None else view, wide)
    normals, normal_map = _normals(normal, samples, spatial)
    shared = Samples(values=np.zeros((samples, 1)), channels=("",), light=lights, view=views, normal=normals,
                     quantity="brdf" if quantity is None else quantity, weights=_weights(weights, samples))
    return Geometry(shared, light_map, view_map, normal_map)


def _of_samples(data: Samples, view: npt.ArrayLike | None, normal: npt.ArrayLike | None,
                weights: npt.ArrayLike | None, quantity: str | None, samples: int,
                spatial: tuple[int, ...]) -> Geometry:
    if view is not None:
        raise DataError("the geometry is given twice, as Samples and as view", code="argument")
    if normal is not None and (data.form != "directions" or data.normal is not None):
        raise DataError("normal needs directions without normals of their own", code="argument")
    if len(data) != samples:
        raise DataError("values have %d samples, and the geometry has %d" % (samples, len(data)), code="argument")
    normals, normal_map = _normals(normal, samples, spatial)
    return Geometry(dataclasses.replace(
        data, values=np.zeros((samples, 1)), channels=("",), quantity=data.quantity if quantity is None else quantity,
        normal=data.normal if normals is None else normals,
        weights=data.weights if weights is None else _weights(weights, samples)), None, None, normal_map)


def _weights(weights: npt.ArrayLike | None, samples: int) -> Floats | None:
    return None if weights is None else column("weights", weights, samples)


def _directions(name: str, value: npt.ArrayLike, wide: tuple[int, ...]) -> tuple[Floats, Floats | None]:
    """What is shared, samples x 3, and each texel's own, if it has."""
    array = vectors(name, value)
    if array.shape in ((3,), (1, 3), (wide[0], 3)):
        return np.ascontiguousarray(np.broadcast_to(array, (wide[0], 3))), None
    if array.ndim == len(wide) and array.ndim > 2:
        try:
            own = np.broadcast_to(array, wide)
        except ValueError:
            pass
        else:
            # Placeholders, which keep the struct whole: each texel's own stand in for them.
            return np.broadcast_to((0.0, 0.0, 1.0), (wide[0], 3)), own
    raise DataError("%s must have shape (3,), (%d, 3)%s, not %s" % (
        name, wide[0], "" if len(wide) == 2 else " or %s" % (wide,), array.shape), code="argument")


def _normals(value: npt.ArrayLike | None, samples: int,
             spatial: tuple[int, ...]) -> tuple[Floats | None, Floats | None]:
    if value is None:
        return None, None
    array = vectors("normal", value)
    if array.shape == (3,):
        return np.ascontiguousarray(np.broadcast_to(array, (samples, 3))), None
    if spatial and array.shape == (*spatial, 3):
        return None, array
    raise DataError("normal must have shape (3,)%s, not %s" % (
        " or %s" % ((*spatial, 3),) if spatial else "", array.shape), code="argument")
