"""Errors: the C library's code, message and position. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from . import _structs as structs

# What would steer a terminal: controls (but line ends), those that turn the direction of writing, halves of characters.
_STEERING = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")


def shown(text: str) -> str:
    """A text that has words of files in it, for people: what could steer a terminal is "?"."""
    return _STEERING.sub("?", text)


class BrdffitError(Exception):
    """A call failed.

    code: the C library's word for it ("option", "value", "no_samples", "format", ...; as in its JSON)
    message: what is wrong, without the place
    texel: of a map, its indices from 0, or None
    sample, channel: indices from 0, or None where they do not apply
    line, column: of a text file, from 1, or None
    value: the offending value, or None
    text: what stands in the field of the file, or None
    path: the file, or None
    """

    def __init__(self, message: str, *, code: str = "argument", sample: int | None = None, channel: int | None = None,
                 line: int | None = None, column: int | None = None, value: float | None = None,
                 path: str | None = None, channel_name: str | None = None, texel: tuple[int, ...] | None = None,
                 text: str | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.sample = sample
        self.channel = channel
        self.line = line
        self.column = column
        self.value = value
        self.text = text
        self.path = path
        self.channel_name = channel_name
        self.texel = texel

    def __str__(self) -> str:
        places = []
        if self.line is not None:
            places.append("line %d" % self.line)
        if self.column is not None:
            places.append("field %d" % self.column)
        if self.texel is not None:
            places.append("texel (%s)" % ", ".join(map(str, self.texel)))
        if self.sample is not None:
            places.append("sample %d" % self.sample)
        if self.channel is not None:
            name = "" if self.channel_name is None else " (%s)" % self.channel_name
            places.append("channel %d%s" % (self.channel, name))
        parts = [part for part in (self.path, ", ".join(places)) if part]
        value = "" if self.value is None else ": %.17g" % self.value
        return shown(": ".join([*parts, self.message]) + value + ("" if not self.text else ": '%s'" % self.text))

    def __reduce__(self) -> tuple[object, ...]:
        return (_rebuild, (type(self), self.message, self.__dict__.copy()))


def _rebuild(kind: type[BrdffitError], message: str, state: dict[str, object]) -> BrdffitError:
    error = kind(message)
    error.__dict__.update(state)
    return error


class OptionError(BrdffitError, ValueError):
    """An option is out of its range."""


class DataError(BrdffitError, ValueError):
    """The samples, or the file's content, cannot be used."""


class UnsupportedError(BrdffitError, NotImplementedError):
    """A combination that this build of the library cannot fit."""


class FileError(BrdffitError, OSError):
    """A file cannot be opened or read."""


class OutOfMemoryError(BrdffitError, MemoryError):
    """The C library could not allocate."""


_KINDS: dict[str, type[BrdffitError]] = {
    "option": OptionError, "argument": OptionError, "unsupported": UnsupportedError, "value": DataError,
    "no_samples": DataError, "format": DataError, "open": FileError, "read": FileError, "memory": OutOfMemoryError,
}
def _place(value: int) -> int | None:
    return None if value == structs.NONE else value


def from_struct(error: structs.Error, *, path: str | None = None, channels: Sequence[str] = (),
                lines: npt.NDArray[np.uintp] | None = None, text: bytes = b"") -> BrdffitError:
    """The exception for a filled-in brdffit_error; `lines` gives a sample's line of the text file, `text` is the fault's."""
    code = structs.STATUS[error.status]
    sample, channel, line = _place(error.sample), _place(error.channel), _place(error.line)
    if line is None and sample is not None and lines is not None and sample < len(lines):
        line = int(lines[sample])
    name = channels[channel] if channel is not None and channel < len(channels) else None
    # 0 also means "does not apply"; a zero that is itself wrong is rare and its place is given anyway.
    value = error.value if error.value != 0 else None
    return _KINDS.get(code, BrdffitError)(
        error.message.decode("utf-8", "replace") if error.message else code, code=code, sample=sample, channel=channel,
        line=line, column=_place(error.column), value=value, path=None if code == "option" else path, channel_name=name,
        text=text.decode("utf-8", "replace") or None)
