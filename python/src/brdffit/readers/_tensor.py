"""Tensor files: the container of RGL's .bsdf. SPDX-License-Identifier: MIT

Little-endian: "tensor_file\\0", version 1.0 (two bytes), the number of fields (uint32); for each field the length of its
name (uint16), the name, its number of dimensions (uint16), type (uint8), offset in the file (uint64) and size in each
dimension (uint64); then the data, each field in C order at its offset.
"""
from __future__ import annotations

import os
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .._arguments import Path
from ..errors import DataError, FileError

MAGIC = b"tensor_file\0"
TYPES = (None, "u1", "i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f2", "<f4", "<f8")
_MOST_DIMENSIONS = 32  # NumPy's own limit for years; RGL uses 5


class Field(NamedTuple):
    dtype: np.dtype[Any]
    offset: int
    shape: tuple[int, ...]


class TensorFile:
    """The table of fields, every bound checked; `read` copies one field out of the file."""

    def __init__(self, path: Path) -> None:
        self.file = os.fspath(path)
        self._at = 0
        try:
            self._size = os.stat(self.file).st_size
        except OSError as error:
            missing = isinstance(error, FileNotFoundError)
            raise FileError("no such file" if missing else str(error), code="open", path=self.file) from error
        if self._take(len(MAGIC), "its first bytes") != MAGIC:
            raise self.wrong("this is not a tensor file: it does not begin with \"tensor_file\"")
        version = tuple(self._take(2, "the version"))
        if version != (1, 0):
            raise self.wrong("version %d.%d of tensor files is not known, only 1.0" % version)
        self.fields: dict[str, Field] = {}
        for _ in range(self._number(4, "the number of fields")):
            self._field()
        for name, field in self.fields.items():
            if field.offset < self._at:
                raise self.wrong("field %r begins at byte %d, inside the header" % (name, field.offset))

    def wrong(self, message: str) -> DataError:
        return DataError(message, code="format", path=self.file)

    def _take(self, count: int, what: str) -> bytes:
        if count > self._size - self._at:
            raise self.wrong("the file ends at byte %d, inside %s" % (self._size, what))
        self._at += count
        return self._bytes(self._at - count, count)

    def _bytes(self, offset: int, count: int) -> bytes:
        """Read, not mapped: a file that is cut short meanwhile would be the end of the process."""
        try:
            with open(self.file, "rb") as file:
                file.seek(offset)
                found = file.read(count)
        except OSError as error:
            raise FileError(str(error), code="read", path=self.file) from error
        if len(found) < count:
            raise FileError("the file became shorter while it was read", code="read", path=self.file)
        return found

    def _number(self, size: int, what: str) -> int:
        return int.from_bytes(self._take(size, what), "little")

    def _field(self) -> None:
        at = "the field at byte %d" % self._at
        raw = self._take(self._number(2, at), "the name of " + at)
        try:
            name = raw.decode("utf-8")
        except UnicodeDecodeError as error:
            raise self.wrong("the name of %s is not UTF-8" % at) from error
        if name in self.fields:
            raise self.wrong("there are two fields %r" % name)
        dimensions = self._number(2, "field %r" % name)
        kind = self._number(1, "field %r" % name)
        if not 1 <= kind < len(TYPES):
            raise self.wrong("field %r has the unknown type %d" % (name, kind))
        if dimensions > _MOST_DIMENSIONS:
            raise self.wrong("field %r has %d dimensions, more than %d" % (name, dimensions, _MOST_DIMENSIONS))
        offset = self._number(8, "field %r" % name)
        shape = tuple(self._number(8, "the size of field %r" % name) for _ in range(dimensions))
        dtype = np.dtype(TYPES[kind])
        size = dtype.itemsize
        for extent in shape:
            size *= extent
        if max(shape, default=0) > self._size or size > self._size - offset:
            raise self.wrong("field %r (%s) needs %d bytes from byte %d on; the file has %d" % (
                name, _times(shape), size, offset, self._size))
        self.fields[name] = Field(dtype, offset, shape)

    def read(self, name: str, dtype: str, dimensions: int) -> npt.NDArray[Any]:
        """A copy of a field that must be there, of this type, with that many dimensions."""
        if name not in self.fields:
            raise self.wrong("there is no field %r; the fields are %s" % (name, ", ".join(sorted(self.fields)) or "none"))
        kind, offset, shape = self.fields[name]
        if kind != np.dtype(dtype) or len(shape) != dimensions:
            raise self.wrong("field %r must be %s with %d dimensions, not %s, %s" % (
                name, np.dtype(dtype).name, dimensions, kind.name, _times(shape)))
        count = int(np.prod(shape))
        return np.frombuffer(self._bytes(offset, count * kind.itemsize), kind).reshape(shape)


def _times(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape)) or "scalar"
