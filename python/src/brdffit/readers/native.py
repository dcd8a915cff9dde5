"""Files that the C library reads: CSV and MERL. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import ctypes
import math
import os
from collections.abc import Mapping, Sequence
from ctypes import POINTER, byref, pointer
from typing import Any

import numpy as np

from .. import _structs as structs
from .._arguments import Path, choose, count_of
from .._arrays import Floats, from_address
from .._ffi import library
from ..errors import from_struct

_VECTORS = ("light", "view", "normal", "tangent")
_COLUMNS = ("cos_light", "cos_view", "tan2_half", "cos_difference", "a", "b", "c", "weights")


class _Table:
    """Owns a brdffit_table; freed with the last array that looks into it."""

    def __init__(self, table: Any) -> None:
        self._table = table
        self._free = library().io.brdffit_io_free

    def __del__(self) -> None:
        self._free(self._table)


def read(path: Path, kind: str | None = None, *, quantity: str | None = None, directions_only: bool = False,
         samples: str | structs.Samples | None = None, bins: str | None = None, channels: Sequence[str] | None = None,
         columns: Mapping[str, str] | None = None, missing: float | str | None = None, saturated: float | None = None,
         directions: str | Sequence[str] | None = None, max_bytes: int = 0) -> dict[str, Any]:
    """The members of `Samples`. kind: "csv" or "merl"; None: by content.

    directions_only: no channel is needed; samples, bins, max_bytes: as of `Samples.from_merl`, directions as C has them; the rest
        as of `Samples.from_csv`
    """
    options = library().io_options()
    if kind is not None:
        options.format = choose("format", kind, structs.FORMAT)
    options.directions_only = int(directions_only)
    options.max_bytes = max_bytes and count_of("max_bytes", max_bytes, 1)
    if bins is not None:
        options.merl_bins = choose("bins", bins, structs.MERL_BINS)
    if isinstance(samples, structs.Samples):
        options.merl_sampling = structs.MERL_SAMPLING.index("directions")
        options.directions = pointer(samples)
    elif samples is not None:
        options.merl_sampling = choose("samples", samples, structs.MERL_SAMPLING[:2])
    reading = _text_options(options, quantity, channels, columns, missing, saturated, directions)
    fault = ctypes.create_string_buffer(80)
    options.fault, options.fault_size = ctypes.cast(fault, ctypes.c_char_p), len(fault)
    name = os.fspath(path)
    table = POINTER(structs.Table)()
    error = structs.Error()
    if library().io.brdffit_io_read(os.fsencode(name), byref(options), byref(table), byref(error)) != 0:
        raise from_struct(error, path=name, text=fault.value)
    return {**_members(table.contents, _Table(table), name), "reading": reading or None}


def _text_options(options: structs.IoOptions, quantity: str | None, channels: Sequence[str] | None,
                  columns: Mapping[str, str] | None, missing: float | str | None, saturated: float | None,
                  directions: str | Sequence[str] | None) -> dict[str, Any]:
    """Into the library's options; what was given, as the JSON of a fit has it."""
    reading: dict[str, Any] = {}
    if quantity is not None:
        options.quantity_set = 1
        if quantity in structs.VALUES[1:]:
            options.values = structs.VALUES.index(quantity)
            reading["values"] = quantity
        else:
            options.quantity = choose("quantity", quantity, (*structs.QUANTITY, *structs.VALUES[1:]))
    if channels is not None:
        reading["channels"] = ",".join([channels] if isinstance(channels, str) else channels)
        options.channels = reading["channels"].encode()
    if columns is not None:
        reading["column"] = ",".join("%s=%s" % item for item in columns.items())
        options.columns = reading["column"].encode()
    if missing is not None:
        reading["missing"] = missing if isinstance(missing, str) else "%.17g" % missing
        options.missing, options.missing_value = _missing(missing)
    if saturated is not None:
        options.saturated = reading["saturated"] = float(saturated)
    if directions is not None:
        words = directions.split(",") if isinstance(directions, str) else list(directions)
        reading["directions"] = ",".join(words)
        options.directions_as = sum({1 << choose("directions", word, structs.DIRECTIONS) for word in words})
    return reading


def _missing(missing: float | str) -> tuple[int, float]:
    if isinstance(missing, str):
        return choose("missing", missing, structs.MISSING[2:]) + 2, 0.0
    value = float(missing)
    return structs.MISSING.index("none" if math.isnan(value) else "value"), 0.0 if math.isnan(value) else value


def _notes(table: structs.Table, warning: bool) -> tuple[str, ...]:
    return tuple(table.notes[i].contents.text.decode("utf-8", "replace") for i in range(table.note_count)
                 if bool(table.notes[i].contents.warning) == warning)


def _word(words: Sequence[str], at: int) -> str:
    """A library that is newer than this package may have more of them."""
    return words[at] if 0 <= at < len(words) else "unknown"


def _members(table: structs.Table, owner: _Table, name: str) -> dict[str, Any]:
    data = table.samples.contents
    count, channels = data.count, data.channels
    kind = _word(structs.FORMAT, table.format)
    merl = kind == "merl"
    return {
        "values": from_address(data.values, (count, channels), owner) if channels else np.zeros((count, 0)),
        "channels": tuple(table.channel_names[k].decode("utf-8", "replace") for k in range(channels)),
        "form": structs.FORM[data.form], "quantity": structs.QUANTITY[data.quantity], "file": name,
        "format": kind,
        "lines": np.ctypeslib.as_array(table.lines, (count,)).astype(np.uintp) if table.lines else None,
        "merl_bins": structs.MERL_BINS[table.merl_bins] if merl else None,
        "merl_samples": structs.MERL_SAMPLING[table.merl_sampling] if merl else None,
        "dropped": {reason: int(table.dropped[i]) for i, reason in enumerate(structs.DROP)},
        "notes": _notes(table, False), "data_warnings": _notes(table, True),
        **{key: from_address(getattr(data, key), (count,), owner) for key in _COLUMNS},
        **{key: from_address(getattr(data, key), (count, 3), owner) for key in _VECTORS}}


def protocol84() -> tuple[Floats, Floats]:
    """The paper's 84 light and view directions."""
    light, view = np.empty((84, 3)), np.empty((84, 3))
    library().io.brdffit_io_protocol84(light.ctypes.data, view.ctypes.data)
    return light, view


def column_words() -> dict[str, tuple[str, ...]]:
    """The words that names of columns are made of, by what they mean: those that `Samples.from_csv` understands."""
    words: dict[str, tuple[str, ...]] = {}
    what = ctypes.c_char_p()
    while (found := library().io.brdffit_io_column_words(len(words), byref(what))) is not None:
        words[(what.value or b"").decode()] = tuple(found.decode().split())
    return words
