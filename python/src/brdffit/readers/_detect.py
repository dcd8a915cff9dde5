"""What a file is: by its content where that tells, by its name otherwise. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import os

from .._arguments import Path
from ._tensor import MAGIC

_BY_NAME = {".lp": "lp", ".bsdf": "rgl", ".h5": "hdf5", ".hdf5": "hdf5", ".he5": "hdf5", ".exr": "exr", ".zarr": "zarr"}
_BY_CONTENT = ((MAGIC, "rgl"), (b"\x89HDF\r\n\x1a\n", "hdf5"), (b"v/1\x01", "exr"))
_ZARR_MARKS = ("zarr.json", ".zgroup", ".zarray", ".zmetadata")


def kind_of(path: Path) -> str | None:
    """"rgl", "hdf5", "zarr", "exr" or "lp"; None for what the C library reads, or tells the fault of."""
    name = os.path.normpath(os.fspath(path))
    if os.path.isdir(name):
        marked = any(os.path.exists(os.path.join(name, mark)) for mark in _ZARR_MARKS)
        return "zarr" if marked or name.lower().endswith(".zarr") else None
    try:
        with open(name, "rb") as file:
            start = file.read(16)
    except OSError:
        start = b""  # the reader says it better
    for magic, kind in _BY_CONTENT:
        if start.startswith(magic):
            return kind
    if name.lower().endswith(".zarr.zip"):
        return "zarr"
    return _BY_NAME.get(os.path.splitext(name)[1].lower())
