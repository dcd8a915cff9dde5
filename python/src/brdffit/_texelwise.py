"""Texels with directions of their own: each is a fit by itself, as in `brdffit map`. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import ctypes
from ctypes import byref
from typing import Any, Callable

import numpy as np
import numpy.typing as npt

from . import _batch
from . import _structs as structs
from ._arrays import Floats, floats
from ._batch import Arrays
from ._ffi import library
from ._geometry import Geometry
from ._stack import Stack, of_all_samples
from .errors import DataError, from_struct
from .options import Options

_OK, _VALUE, _NO_SAMPLES = (structs.STATUS.index(word) for word in ("ok", "value", "no_samples"))


def check(given: Geometry, samples: int, channels: int, options: Options) -> None:
    """Options and sizes that no texel could be fitted with fail here, once."""
    core = library().core
    c_options = options._struct()
    _batch.check_build(c_options)
    if core.brdffit_workspace_size(samples, channels, byref(c_options)) == 0:
        # Which of the two it is, is for the library to say.
        c_samples, error = given.shared._struct(), structs.Error()
        c_samples.channels = channels
        if core.brdffit_inspect(byref(c_samples), byref(c_options), None, None, byref(error)) != 0:
            raise from_struct(error)
        raise DataError("%d samples and %d channels cannot be fitted" % (samples, channels), code="argument")


def _at(structure: type[ctypes.Structure], *names: str) -> int:
    """Which 8-byte word of the structure a field is."""
    offset = 0
    inner: Any = structure
    for name in names:
        offset += getattr(inner, name).offset
        inner = dict((field[0], field[1]) for field in inner._fields_)[name]
    return offset // 8


_SIGMA, _X, _Y = (_at(structs.Result, "model", name) for name in ("sigma", "x", "y"))
_SCALE, _E2, _BOUND, _SQUARES = (_at(structs.Result, name)
                                 for name in ("channel_scale", "e2", "lower_bound", "sum_of_squares"))


class Worker:
    """What one thread needs to fit texels of a stack, each with its own directions, into `results`.

    cancelled: asked before each texel and every 256 boxes of a search; true ends it
    """

    def __init__(self, given: Geometry, options: Options, stack: Stack, results: Arrays,
                 mask: npt.NDArray[np.uint8] | None, scale: float, cancelled: Callable[[], bool]) -> None:
        core = library().core
        self.given, self.stack, self.mask, self.scale = given, stack, mask, scale
        self.to, self.lobes = results, options.lobes
        self.options, self.cancelled = options._struct(), cancelled
        self._progress = structs.ProgressFunction(lambda user, progress: int(cancelled()))
        self.options.progress = self._progress
        self.samples = given.shared._struct()
        self.samples.channels = stack.channels
        size = core.brdffit_workspace_size(stack.samples, stack.channels, byref(self.options))
        self.workspace = np.empty(size // 8 + 2)  # doubles, so that results in it are elements
        self.result, self.error = structs.Result(), structs.Error()
        self._words = np.frombuffer(memoryview(self.result).cast("B"), np.uintp, ctypes.sizeof(self.result) // 8)
        self._doubles = self._words.view(np.float64)
        self._call: Callable[..., int] = core.brdffit_fit
        self._counts = dict.fromkeys((*_batch.COUNTS, "no_samples"), 0)
        self._skipped = dict.fromkeys(structs.SKIP, 0)

    def fit(self, first: int, count: int) -> bool:
        """Texels [first, first + count), and whether they are all done. Other threads run meanwhile."""
        arrays = {"values": self._values(first, count), **self._own(first, count)}
        base = {name: array.ctypes.data for name, array in arrays.items()}
        step = {name: array.strides[0] for name, array in arrays.items()}
        for i in range(count):
            if self.cancelled():
                return False
            if self.mask is not None and not self.mask[first + i]:
                self._skip(first + i, _batch.MASKED)
                continue
            for name, start in base.items():
                setattr(self.samples, name, start + i * step[name])
            self._one(first + i)
        return not self.cancelled()

    def _values(self, first: int, count: int) -> Floats:
        """texel x sample x channel"""
        out = np.empty((count, self.stack.samples, self.stack.channels))
        for block in self.stack.blocks(first, count):
            at = block.first - first
            np.multiply(block.values.swapaxes(0, 1), self.scale, out=out[at:at + block.texels], dtype=np.float64)
        return out

    def _own(self, first: int, count: int) -> dict[str, Floats]:
        """texel x sample x 3, of those that are not shared"""
        at = np.unravel_index(np.arange(first, first + count), self.stack.spatial)
        index: tuple[Any, ...] = tuple(at)
        out = {}
        for name in ("light", "view"):
            own = getattr(self.given, name)
            if own is not None:
                out[name] = floats(name, own[of_all_samples(index)].swapaxes(0, 1))
        if self.given.normal is not None:
            normal = self.given.normal[index][:, np.newaxis]
            out["normal"] = floats("normal", np.broadcast_to(normal, (count, self.stack.samples, 3)))
        return out

    def _skip(self, texel: int, status: int) -> None:
        _batch.blank(self.to, slice(texel, texel + 1), status)
        self._counts["texels"] += 1
        self._counts[_batch.STATUS[status]] += 1

    def _one(self, texel: int) -> None:
        status = self._call(byref(self.samples), byref(self.options), self.workspace.ctypes.data,
                            self.workspace.nbytes, byref(self.result), byref(self.error))
        if status == _OK:
            self._publish(texel)
        elif status == _NO_SAMPLES:
            self._skip(texel, _batch.NO_SAMPLES)
        elif status == _VALUE and self.error.sample != structs.NONE:
            self._skip(texel, _batch.BAD_VALUE)
            channel = 0 if self.error.channel == structs.NONE else self.error.channel
            self.to["where"][texel] = self.error.sample * self.stack.channels + channel
        elif status == _VALUE:
            self._skip(texel, _batch.REFUSED)
        else:
            raise from_struct(self.error)

    def _publish(self, texel: int) -> None:
        r, doubles, counts = self.result, self._doubles, self._counts
        squares = doubles[_SQUARES]
        status = _batch.NO_SIGNAL if not squares > 0 else _batch.CERTIFIED if r.certified else _batch.OPEN
        to = self.to
        to["sigma"][texel] = doubles[_SIGMA:_SIGMA + self.lobes]
        to["x"][texel] = self._array(_X, self.stack.channels)
        to["y"][texel] = self._array(_Y, self.stack.channels * self.lobes).reshape(-1, self.lobes)
        to["channel_scale"][texel] = self._array(_SCALE, self.stack.channels)
        to["e2"][texel], to["lower_bound"][texel] = doubles[_E2], doubles[_BOUND]
        to["sum_of_squares"][texel] = squares
        to["status"][texel], to["stop"][texel] = status, r.stop if status != _batch.NO_SIGNAL else _batch.NO_STOP
        to["where"][texel], to["boxes"][texel] = -1, r.boxes
        counts["texels"] += 1
        counts[_batch.STATUS[status]] += 1
        counts["general"] += status != _batch.NO_SIGNAL
        counts["boxes"] += r.boxes
        counts["nodes"] += r.nodes
        for i, reason in enumerate(structs.SKIP):
            self._skipped[reason] += r.samples_skipped[i]

    def _array(self, pointer: int, count: int) -> Floats:
        """What a pointer of the result points to: doubles inside of the workspace."""
        at = (int(self._words[pointer]) - self.workspace.ctypes.data) // 8
        return self.workspace[at:at + count]

    def counts(self) -> dict[str, int]:
        return self._counts

    def skipped(self) -> dict[str, int]:
        """Samples that fitted texels did not use, by reason."""
        return self._skipped
