"""Files: their samples as plain arrays, whatever the format. SPDX-License-Identifier: MIT

What is here knows no `Samples` and no maps, since both begin with it: `native` (the C library's formats), `store` (HDF5,
zarr), `exr`, `lp`, `lazy` (arrays that are read as they are indexed), `_rgl`. `rgl` and `stack` put classes for users on
top of `Samples` and of `fit_map`.
"""
from __future__ import annotations

import os
from typing import Any

from .._arguments import Path
from ..errors import DataError
from . import _rgl, native, store
from ._detect import kind_of

__all__ = ["load"]


def load(path: Path, kind: str | None = None, **how: Any) -> dict[str, Any]:
    """The members of the `Samples` in a file.

    kind: "csv", "merl", "rgl", "hdf5" or "zarr"; None: by its content (.lp and files that cannot be opened by their name)
    how: what `Samples.from_csv` and its siblings take for that kind
    """
    found = kind_of(path) if kind is None else kind
    if found == "rgl":
        return _rgl.read(path, **how)
    if found in ("hdf5", "zarr"):
        return store.read(path, found, **how)
    if found in ("exr", "lp"):
        raise DataError("this holds images, not samples of one material: load_stack reads them", code="format",
                        path=os.fspath(path))
    return native.read(path, found, **how)
