"""Stacks of OpenEXR images, by the OpenEXR project's own package. SPDX-License-Identifier: MIT

Its class InputFile reads some scanlines; File, which replaces it in time, only whole images. Where there is an InputFile,
`values[:, 100:116]` decompresses 16 lines of each image (and the rest of their blocks), otherwise each image as a whole,
one after another. Either way the memory is that of the part that was asked for and of one image.
"""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .._arguments import Path
from ..errors import BrdffitError, DataError, FileError, OptionError, OutOfMemoryError, UnsupportedError
from ._extra import need
from .lazy import LazyArray, Part
from .lp import load_lp

_TYPES = {"HALF": "f2", "FLOAT": "f4", "UINT": "u4"}


class Header(NamedTuple):
    window: tuple[int, int, int, int]  # of the data: left, top, right, bottom, all inside
    channels: tuple[str, ...]

    @property
    def size(self) -> tuple[int, int]:
        left, top, right, bottom = self.window
        return bottom - top + 1, right - left + 1


class ExrArray(LazyArray):
    """float32, whatever the files hold."""

    def __init__(self, files: Sequence[str], header: Header, channels: Sequence[str]) -> None:
        super().__init__((len(files), *header.size, len(channels)), np.float32)
        self.files, self.channels, self._header = tuple(files), tuple(channels), header

    def _read(self, part: Part) -> npt.NDArray[Any]:
        samples, rows, columns, which = part
        names = self.channels[which]
        shape = tuple(one.stop - one.start for one in part)
        try:
            out = np.empty(shape, np.float32)
        except MemoryError as error:
            raise OutOfMemoryError("no memory for %s values of these images" % " x ".join(map(str, shape)), code="memory",
                                   path=self.files[samples.start]) from error
        for at, file in enumerate(self.files[samples]):
            try:
                _read_rows(file, self._header, names, rows, columns, out[at])
            except BrdffitError:
                raise
            except Exception as error:  # what the package raises depends on its version and on the fault
                raise DataError("the image cannot be read (%s)" % error, code="read", path=file) from error
        return out


def _read_rows(file: str, header: Header, names: Sequence[str], rows: slice, columns: slice, out: npt.NDArray[Any]) -> None:
    package = need("OpenEXR", "exr", "OpenEXR images")
    height, width = header.size
    if not hasattr(package, "InputFile"):
        pixels = package.File(file, separate_channels=True).channels()
        for k, name in enumerate(names):
            out[..., k] = pixels[name].pixels[rows, columns]
        return
    image = package.InputFile(file)
    try:
        if _window(image.header()["dataWindow"]) != header.window:
            raise DataError("the image has changed its size since the stack was loaded", code="format", path=file)
        kinds = [_TYPES[str(image.header()["channels"][name].type)] for name in names]
        top = header.window[1]
        lines = image.channels(list(names), scanLine1=top + rows.start, scanLine2=top + rows.stop - 1)
        for k, (kind, raw) in enumerate(zip(kinds, lines)):
            out[..., k] = np.frombuffer(raw, kind).reshape(-1, width)[:, columns]
    finally:
        image.close()


def _window(box: Any) -> tuple[int, int, int, int]:
    """Of either class of the package."""
    low, high = (box.min, box.max) if hasattr(box, "min") else box
    corners = [(point.x, point.y) if hasattr(point, "x") else (point[0], point[1]) for point in (low, high)]
    return int(corners[0][0]), int(corners[0][1]), int(corners[1][0]), int(corners[1][1])


def read_header(file: str) -> Header:
    """Of the first part of an image, its pixels left alone."""
    package = need("OpenEXR", "exr", "OpenEXR images")
    if not os.path.isfile(file):
        raise FileError("no such file", code="open", path=file)
    try:
        header = package.File(file, header_only=True).header()
        found = Header(_window(header["dataWindow"]), tuple(str(channel.name) for channel in header["channels"]))
        kind = str(header.get("type", ""))
        sampled = [c.name for c in header["channels"] if (c.xSampling, c.ySampling) != (1, 1)]
    except Exception as error:
        raise DataError("this is not an OpenEXR image that can be read (%s)" % error, code="format", path=file) from error
    if "deep" in kind:
        raise UnsupportedError("deep images are not supported", code="unsupported", path=file)
    if sampled:
        raise UnsupportedError("channel %s has fewer pixels than the image (luminance and chroma): convert it to R, G, B" %
                               sampled[0], code="unsupported", path=file)
    return found


def choose_channels(header: Header, asked: Sequence[str] | None, file: str) -> tuple[str, ...]:
    there = ", ".join(header.channels) or "none"
    if asked is None:
        if {"R", "G", "B"} <= set(header.channels):
            return ("R", "G", "B")
        if len(header.channels) == 1:
            return header.channels
        raise OptionError("the image has no R, G, B; name the channels= that are wanted, of %s" % there, code="option",
                          path=file)
    if isinstance(asked, str) or not asked:
        raise OptionError("channels must be a list of names", code="option", path=file)
    for name in asked:
        if name not in header.channels:
            raise OptionError("the image has no channel %r; it has %s" % (name, there), code="option", path=file)
    return tuple(asked)


def exr_stack(path: str, images: Sequence[Path] | None, light: npt.ArrayLike | None, view: npt.ArrayLike | None,
              channels: Sequence[str] | None, quantity: str) -> dict[str, Any]:
    """The members of a `Stack` of the images that an .lp file names."""
    lights = load_lp(path)
    files = lights.paths() if images is None else [os.fspath(image) for image in images]
    if len(files) != len(lights):
        raise OptionError("%d images for %d light positions" % (len(files), len(lights)), code="option", path=path)
    first = read_header(files[0])
    chosen = choose_channels(first, channels, files[0])
    for file in files[1:]:
        header = read_header(file)
        if header.window != first.window:
            raise DataError("the image has %s; %s has %s" % (_words(header), files[0], _words(first)), code="format", path=file)
        choose_channels(header, chosen, file)
    colours = {"R": "r", "G": "g", "B": "b"}
    return {"values": ExrArray(files, first, chosen), "light": lights.directions if light is None else np.asarray(light),
            "view": np.asarray((0.0, 0.0, 1.0) if view is None else view),
            "channels": tuple(colours.get(name, name) for name in chosen), "quantity": quantity,
            "names": tuple(os.path.basename(file) for file in files), "file": path, "format": "exr"}


def _words(header: Header) -> str:
    left, top, right, bottom = header.window
    return "%d x %d pixels, from column %d, line %d on" % (right - left + 1, bottom - top + 1, left, top)
