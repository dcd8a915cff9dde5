"""What a fit of many texels takes, in types. SPDX-License-Identifier: MIT

Arrays of other packages are told by what they can do, so that a type checker needs none of these packages.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy.typing as npt

from ..options import FitOptions
from .pool import MapProgressArgument

TileArgument = int | Sequence[int] | None


class MapOptions(FitOptions, total=False):
    """Keyword arguments of `fit_map` that have no say in what it returns."""

    normal: npt.ArrayLike | None
    weights: npt.ArrayLike | None
    mask: npt.ArrayLike | None
    quantity: str | None
    scale: float
    sample_axis: int | str
    channel_axis: int | str | None
    threads: int | None
    tile: TileArgument
    errors: str
    progress: MapProgressArgument
    client: Any
    overwrite: bool
    retries: int


class LabelledArray(Protocol):
    """A DataArray of xarray."""

    @property
    def dims(self) -> Any: ...

    @property
    def coords(self) -> Any: ...


class StoredArray(Protocol):
    """An Array of zarr."""

    @property
    def store_path(self) -> Any: ...


class DelayedArray(Protocol):
    """An Array of Dask."""

    def to_delayed(self) -> Any: ...


TiledArray = StoredArray | DelayedArray
