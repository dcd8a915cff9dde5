"""Light position files (.lp) of RTI and PTM image stacks. SPDX-License-Identifier: MIT

A line with the number of images, then for each its file name and the direction of its light:

    3
    images/left 01.exr  -0.71  0.02  0.70
    images/right.exr     0.64 -0.10  0.76
    images/top.exr       0.01  0.72  0.69

x is to the right of the image, y up, z towards the camera. Variants that exist and are read: no count; a running number
before each name, or instead of it; names with spaces, in quotes, or with another machine's folders; comment lines that
begin with # or //; empty lines; any line ends; positions instead of unit vectors; a byte order mark.
"""
from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .._arguments import Path
from .._arrays import Floats, freeze
from ..errors import DataError, FileError

_SHOWN = 60  # characters of a wrong line


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class LightPositions:
    """names: of the images, as written, "" where the file has numbers alone; positions: N x 3, as written; lines: of each in
    the file, from 1."""

    names: tuple[str, ...]
    positions: Floats
    lines: tuple[int, ...]
    file: str

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        return "<LightPositions: %d from %s>" % (len(self), self.file)

    @property
    def directions(self) -> Floats:
        """Unit vectors towards the light, N x 3."""
        return freeze(self.positions / np.linalg.norm(self.positions, axis=1, keepdims=True))

    def paths(self) -> list[str]:
        """Where the images are: as named, or relative to this file's folder, or there without the named folder (which was
        another machine's). An error names the line of the first that is nowhere."""
        folder, out = os.path.dirname(self.file), []
        for name, line in zip(self.names, self.lines):
            if not name:
                raise DataError("no image is named, only a number: give the images' paths", code="format", path=self.file,
                                line=line)
            plain = name.replace("\\", "/")
            tries = [os.path.join(folder, n) for n in (name, plain, os.path.basename(plain))]
            found = next((path for path in tries if os.path.isfile(path)), None)
            if found is None:
                raise FileError("there is no image %r, nor %r" % (tries[0], tries[-1]), code="open", path=self.file, line=line)
            out.append(found)
        return out


class _Row(NamedTuple):
    line: int
    name: str
    position: tuple[float, float, float]


def load_lp(path: Path) -> LightPositions:
    """An .lp file; see the module's text for its form."""
    file = os.fspath(path)
    lines = [(number, line.strip()) for number, line in enumerate(_text(file).splitlines(), 1)]
    lines = [(number, line) for number, line in lines if line and not line.startswith(("#", "//"))]
    count = None
    if lines and re.fullmatch(r"\d{1,9}", lines[0][1]):
        count = int(lines[0][1])
    rows = [_row(file, number, line) for number, line in lines[count is not None:]]
    if not rows:
        raise DataError("there are no light positions in this file", code="format", path=file)
    if count is not None and count != len(rows):
        raise DataError("the file announces %d light positions and has %d" % (count, len(rows)), code="format", path=file,
                        line=lines[0][0])
    rows = _without_index(rows, os.path.dirname(file))
    seen: dict[str, int] = {}
    for row in rows:
        if row.name and row.name in seen:
            raise DataError("%r stands in line %d already" % (row.name, seen[row.name]), code="format", path=file, line=row.line)
        seen[row.name] = row.line
    return LightPositions(tuple(row.name for row in rows), freeze(np.array([row.position for row in rows])),
                          tuple(row.line for row in rows), file)


def _text(file: str) -> str:
    try:
        with open(file, "rb") as stream:
            raw = stream.read()
    except OSError as error:
        missing = isinstance(error, FileNotFoundError)
        raise FileError("no such file" if missing else str(error.strerror), code="open" if missing else "read",
                        path=file) from error
    try:
        if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
            return raw.decode("utf-16")
        if b"\0" in raw:
            raise DataError("this is not a text file: it holds a zero byte", code="format", path=file)
        # Names in an old encoding stay what the file system calls them.
        return raw.decode("utf-8-sig", "surrogateescape").rstrip("\x1a")
    except UnicodeDecodeError as error:
        raise DataError("the text is not valid UTF-16", code="format", path=file) from error


def _row(file: str, number: int, line: str) -> _Row:
    """The last three words are the position, whatever stands before them the name."""
    words = line.split()
    shown = line if len(line) <= _SHOWN else line[:_SHOWN] + "..."
    if len(words) < 4:
        raise DataError("expected a file name, x, y and z, not %r" % shown, code="format", path=file, line=number)
    try:
        x, y, z = (float(word) for word in words[-3:])
    except ValueError as error:
        hint = "; the decimal sign is a point" if any("," in word for word in words[-3:]) else ""
        raise DataError("the line must end with three numbers, not %r%s" % (" ".join(words[-3:])[:_SHOWN], hint),
                        code="format", path=file, line=number) from error
    length = np.sqrt(x * x + y * y + z * z) if max(abs(x), abs(y), abs(z)) < 1e150 else np.inf
    if not 0 < length < np.inf:
        raise DataError("(%g, %g, %g) is no direction" % (x, y, z), code="value", path=file, line=number)
    name = line
    for _ in range(3):
        name = re.sub(r"\s*\S+$", "", name)
    return _Row(number, _unquoted(name), (x, y, z))


def _unquoted(name: str) -> str:
    return name[1:-1] if len(name) > 2 and name[0] == name[-1] and name[0] in "\"'" else name


def _without_index(rows: Sequence[_Row], folder: str) -> list[_Row]:
    """Rows without the running numbers (from 0 or 1) that some programs write before the names, or instead of them. A file
    that is called by the whole of it has that name."""
    split = [re.fullmatch(r"(\d{1,9})(?:\s+(.+))?", row.name) for row in rows]
    numbers = [int(match.group(1)) for match in split if match is not None]
    if len(numbers) < len(rows) or numbers[0] not in (0, 1) or numbers != list(range(numbers[0], numbers[0] + len(rows))):
        return list(rows)
    if any(os.path.isfile(os.path.join(folder, row.name)) for row in rows):
        return list(rows)
    return [row._replace(name=_unquoted((match.group(2) or "") if match else row.name)) for row, match in zip(rows, split)]
