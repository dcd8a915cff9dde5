"""A call of `fit_map` for a stack in tiles: its arguments once they are checked, and what of them each tile needs.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .._arguments import positive
from ..maps import texelwise
from ..maps.arguments import TileArgument
from ..maps.batch import content, plan_for
from ..maps.geometry import DirectionsLike, Geometry, geometry
from ..maps.results import terms_of
from ..maps.stack import texel_mask
from ..options import Options
from . import store, tiles
from .job import Tile
from .sources import Source
from .tiles import Region


@dataclasses.dataclass(frozen=True)
class Call:
    """What was asked for, checked."""

    source: Source
    given: Geometry
    options: Options
    mask: npt.NDArray[np.uint8] | None
    scale: float
    errors: str
    tile: tuple[int, ...]
    regions: Sequence[Region]
    fields: Sequence[store.Field]

    def arguments(self) -> dict[str, Any]:
        """Of `brdffit.fit_map`, for all tiles."""
        shared = self.given.shared
        where: dict[str, Any] = {"light": shared}
        if self.given.own:
            where = {"weights": shared.weights, "quantity": shared.quantity}
            for name in ("light", "view"):
                if getattr(self.given, name) is None:
                    where[name] = getattr(shared, name)
            if self.given.normal is None and shared.normal is not None:
                where["normal"] = shared.normal[0]
        asked = {field.name: getattr(self.options, field.name) for field in dataclasses.fields(self.options)}
        return {**where, "scale": self.scale, "sample_axis": self.source.sample_axis,
                "channel_axis": self.source.channel_axis, "errors": self.errors, **asked}

    def tile_of(self, number: int) -> Tile:
        """With the arguments that are its own."""
        region, given = self.regions[number], self.given
        mask = None if self.mask is None else self.mask.reshape(self.source.spatial)
        own = {"light": tiles.part(given.light, 1, region), "view": tiles.part(given.view, 1, region),
               "normal": tiles.part(given.normal, 0, region), "mask": tiles.part(mask, 0, region)}
        return Tile(number, region, {name: array for name, array in own.items() if array is not None})

    def about(self) -> dict[str, Any]:
        return {"options": self.options, "quantity": self.given.shared.quantity, "samples": self.source.samples,
                "own": self.given.own}

    def manifest(self, mark: bool) -> dict[str, Any]:
        s, shared = self.source, self.given.shared
        return store.manifest(
            dataclasses.asdict(self.options), spatial=list(s.spatial), samples=s.samples, channels=s.channels,
            type=s.dtype.str, tile=list(self.tile), quantity=shared.quantity, scale=self.scale, own=self.given.own,
            directions=content(shared).hex() + store.digest(self.given.light, self.given.view, self.given.normal),
            mask=store.digest(self.mask), **({"values": store.digest(*s.marks())} if mark else {}))


def _check(source: Source, given: Geometry, options: Options) -> None:
    """What no tile could do fails here, before any is sent."""
    if given.own:
        texelwise.check(given, source.samples, source.channels, options)
    else:
        plan_for(given.shared, source.channels, options)


def prepare(source: Source, light: DirectionsLike, view: Any, normal: Any, weights: Any, mask: Any,
            quantity: str | None, scale: float, errors: str, tile: TileArgument, options: Options) -> Call:
    given = geometry(light, view, normal, weights, quantity, source.samples, source.spatial)
    flags = texel_mask(mask, source.spatial)
    _check(source, given, options)
    shape = source.cut(tile)
    return Call(source, given, options, flags, positive("scale", scale), errors, shape,
                tiles.regions(source.spatial, shape), store.fields(source.channels, options.distributions, **terms_of(options)))
