"""Maps in a zarr group, written by many processes, and what of them is there already.

    sigma, ... status         the arrays of FitMap; a tile is a chunk of each, so that no two workers share one. Its x and
                              y are named diffuse and specular: dimensions are often named x and y
    tiles/data                a checksum of the values that each tile was fitted to, a chunk of its own
    tiles/done                a row of counts for each tile, a chunk of its own, written last: a tile without is not there
    .attrs["brdffit"]         what is fitted and how; a run that differs may not go on here

Whatever ends a run, a tile is recorded only when all of it is written. What is not there reads as status "not_reached".

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import zlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _lobes
from .. import _structs as structs
from .._version import __version__
from ..errors import DataError, OptionError
from ..maps.results import COUNTS, NOT_REACHED, STATUS, STOP, allocate, blank
from .tiles import Region

SCHEMA = "brdffit.maps/1"
# Of a tile's row: the counts of FitMap.stats, then the skipped samples.
COUNTED = (*COUNTS, *STATUS, "texels")
SKIPPED = tuple(structs.SKIP)

_TRAILING = {"sigma": ("lobe",), "x": ("channel",), "channel_scale": ("channel",), "y": ("channel", "lobe"),
             "f0": ("channel", "lobe"), "x_more": ("channel", "diffuse_column")}


@dataclasses.dataclass(frozen=True)
class Field:
    """An array of the maps: its name in FitMap and in files, what stands behind the spatial axes, and what reads where
    nothing was written."""

    name: str
    stored: str
    dtype: str
    shape: tuple[int, ...]
    dims: tuple[str, ...]
    fill: float
    distributions: tuple[str, ...] = ()  # along its dimension "lobe"


def fields(channels: int, distributions: tuple[str, ...], f0: int = 0, more: int = 0) -> list[Field]:
    one = allocate(1, channels, len(distributions), f0, more)
    blank(one, slice(0, 1), NOT_REACHED)
    return [Field(name, {"x": "diffuse", "y": "specular"}.get(name, name), array.dtype.name, array.shape[1:],
                  _TRAILING.get(name, ()), float("nan") if array.dtype.kind == "f" else int(array.flat[0]),
                  distributions if "lobe" in _TRAILING.get(name, ()) else ())
            for name, array in one.items()]


def field_attributes(field: Field) -> dict[str, Any]:
    """What a reader of the file should know (CF's flags; what each lobe is)."""
    if field.distributions:
        return {"distributions": " ".join(field.distributions), "parameters": " ".join(_lobes.parameters(field.distributions))}
    words = {"status": STATUS, "stop": STOP}.get(field.name)
    if words is None:
        return {}
    return {"flag_values": list(range(len(words))), "flag_meanings": " ".join(word.replace(" ", "_") for word in words)}


def digest(*arrays: npt.NDArray[Any] | None) -> str:
    found = hashlib.blake2b(digest_size=16)
    for array in arrays:
        found.update(b"-" if array is None else repr((array.shape, array.dtype.str)).encode())
        if array is not None:
            found.update(np.ascontiguousarray(array).tobytes())
    return found.hexdigest()


def checksum(values: npt.NDArray[Any]) -> int:
    """Of a tile's values: they are read to be fitted, so that this costs next to nothing."""
    return zlib.crc32(np.ascontiguousarray(values).reshape(-1).view(np.uint8).data, values.itemsize)


# ---- The group -------------------------------------------------------------------------------------------------------


def _group(output: Any, **more: Any) -> Any:
    import zarr

    if isinstance(output, zarr.Group):
        return zarr.open_group(output.store, path=output.path, **more)
    if isinstance(output, (str, os.PathLike)):
        name = os.fspath(output)
        # Workers have folders of their own.
        return zarr.open_group(name if "://" in name else os.path.abspath(name), **more)
    return zarr.open_group(output, **more)


def in_memory(group: Any) -> bool:
    """Whether no other process can see it."""
    return "Memory" in type(group.store).__name__


def holds(group: Any, array: Any) -> bool:
    """Whether a zarr array lies inside the group."""
    ours, its = str(group.store_path).rstrip("/") + "/", str(array.store_path).rstrip("/") + "/"
    return its.startswith(ours)


def _difference(then: Any, now: Any, name: str = "") -> str | None:
    """The first entry in which two manifests differ, in words."""
    if isinstance(then, dict) and isinstance(now, dict):
        for key in sorted({*then, *now}):
            found = _difference(then.get(key), now.get(key), key)
            if found:
                return found
        return None
    return None if then == now else "%s was %s, and is %s" % (name, json.dumps(then), json.dumps(now))


def _names(group: Any) -> set[str]:
    """All that lies in the group's place, also what is not zarr's, but its own metadata."""
    from zarr.core.sync import sync

    async def found() -> list[str]:
        return [name async for name in group.store.list_dir(group.path)]

    return {name.strip("/") for name in sync(found())} - {"zarr.json"}


def _foreign(group: Any) -> list[str]:
    """Of these what is neither an array of maps nor a coordinate of theirs."""
    ours = {field.stored for field in fields(1, ("",), 1, 1)} | {"tiles"} | set(str(group.attrs.get("coordinates", "")).split())
    if "specular" in group:  # which has all dimensions
        ours |= {*(group["specular"].metadata.dimension_names or ()), "diffuse_column"}
    return sorted(_names(group) - ours)


def _check_folder(output: Any) -> None:
    """A folder with files and no group: not even a group is made in it."""
    if not isinstance(output, (str, os.PathLike)) or not os.path.isdir(output or "."):
        return
    there = set(os.listdir(output or "."))
    if there and not there & {"zarr.json", ".zgroup", ".zarray"}:
        raise DataError("output %s holds something else than maps of brdffit" % (os.fspath(output) or "''"), code="argument")


def _manifest_of(group: Any) -> Any:
    try:
        return json.loads(group.attrs["brdffit"])
    except (KeyError, TypeError, ValueError):
        return None


@dataclasses.dataclass(frozen=True)
class Layout:
    """What is to be there: spatial shape, tile, names of the dimensions (spatial, channel, lobe) and the manifest."""

    spatial: tuple[int, ...]
    tile: tuple[int, ...]
    tiles: int
    fields: Sequence[Field]
    dims: tuple[str, ...]
    renamed: Mapping[str, str]
    manifest: Mapping[str, Any]

    def dims_of(self, field: Field) -> tuple[str, ...]:
        return (*self.dims, *(self.renamed.get(name, name) for name in field.dims))


def open_maps(output: Any, layout: Layout, overwrite: bool, stack: Any) -> tuple[Any, bool]:
    """The group, made or found, and whether it was there. Nothing but maps of ours is ever replaced, least of all what
    holds the `stack` (a zarr array, or None)."""
    _check_folder(output)
    group = _group(output, mode="a")
    if stack is not None and holds(group, stack):
        raise DataError("values lie inside output %s" % group.store_path, code="argument")
    manifest = json.loads(json.dumps(layout.manifest))
    if group.metadata.zarr_format != 3:
        raise DataError("output %s is a group of zarr format %s: maps need format 3" % (
            group.store_path, group.metadata.zarr_format), code="argument")
    then = _manifest_of(group)
    if then is None and (len(group.attrs) > 0 or _names(group)):
        raise DataError("output %s holds something else than maps of brdffit" % group.store_path, code="argument")
    if then is not None and not overwrite:
        found = _difference(then, manifest)
        if found is None:
            _make_arrays(group, layout)
            return group, True
        raise DataError("output %s holds maps of another run: %s. Repeat its arguments to go on with it, or replace it "
                        "with overwrite=True" % (group.store_path, found), code="argument")
    if then is not None:
        if _foreign(group):
            raise DataError("output %s holds other things beside maps of brdffit, which overwrite would remove: %s" % (
                group.store_path, ", ".join(_foreign(group)[:4])), code="argument")
        group = _group(output, mode="w")
    # First, so that what is interrupted here is found to be ours; a string, as other formats know no more.
    group.attrs["brdffit"] = json.dumps(manifest)
    _make_arrays(group, layout)
    return group, False


def find_maps(path: Any) -> tuple[Any, dict[str, Any]]:
    """The group of maps that were written, and its manifest."""
    group = _group(path, mode="r")
    found = _manifest_of(group)
    if not isinstance(found, dict) or found.get("schema") != SCHEMA:
        raise DataError("%s holds no maps that this version of brdffit can read" % group.store_path, code="format")
    return group, found


def _make_arrays(group: Any, layout: Layout) -> None:
    """Those that are missing."""
    for field in layout.fields:
        if field.stored not in group:
            group.create_array(field.stored, shape=(*layout.spatial, *field.shape), chunks=(*layout.tile, *field.shape),
                               dtype=field.dtype, fill_value=field.fill, dimension_names=layout.dims_of(field),
                               attributes=field_attributes(field))
    columns = [*COUNTED, *("skipped: " + name for name in SKIPPED)]
    if "tiles/data" not in group:
        group.require_group("tiles").create_array("data", shape=(layout.tiles,), chunks=(1,), dtype="int64", fill_value=-1)
    if "tiles/done" not in group:
        group.require_group("tiles").create_array("done", shape=(layout.tiles, len(columns)), chunks=(1, len(columns)),
                                                  dtype="int64", fill_value=-1, attributes={"columns": columns})


# ---- Tiles -----------------------------------------------------------------------------------------------------------


def counts_of(result: Any) -> list[int]:
    """A tile's row, of its FitMap."""
    return [*(int(result.stats.get(name, 0)) for name in COUNTED),
            *(int(result.samples_skipped.get(name, 0)) for name in SKIPPED)]


def read_counts(group: Any) -> npt.NDArray[np.int64]:
    """tiles x columns; -1 in those that are not there."""
    return np.asarray(group["tiles/done"][:], np.int64)


def recorded(group: Any, tile: int) -> list[int] | None:
    row = [int(number) for number in group["tiles/done"][tile]]
    return None if row[0] < 0 else row


def check_data(group: Any, tile: int, data: int) -> None:
    """That a tile which is there was fitted to values of this checksum."""
    if int(group["tiles/data"][tile]) != data:
        raise DataError("output %s holds maps of other values: those of tile %d differ. Replace it with overwrite=True" % (
            group.store_path, tile), code="argument")


def write_tile(group: Any, tile: int, region: Region, written: Sequence[Field], result: Any, data: int) -> list[int]:
    """All maps of a tile, then its row."""
    for field in written:
        group[field.stored][region] = getattr(result, field.name)
    group["tiles/data"][tile] = data
    row = counts_of(result)
    group["tiles/done"][tile] = np.array(row, np.int64)
    return row


def manifest(options: Mapping[str, Any], **more: Any) -> dict[str, Any]:
    """What two runs must agree in to write one map. isa changes no bit."""
    return {"schema": SCHEMA, "version": __version__, "options": {k: v for k, v in options.items() if k != "isa"}, **more}


def need_shared(group: Any) -> None:
    if in_memory(group):
        raise OptionError("output is in this process's memory, where workers cannot write: give a path or a store that "
                          "they all see", code="option")
