"""Texels with directions of their own: each is a fit by itself, as in `brdffit map`. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import ctypes
from collections.abc import Callable
from ctypes import byref
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _structs as structs
from .._arrays import Floats, floats
from .._ffi import library
from ..errors import DataError, from_struct
from ..options import Options
from . import results as texels
from .batch import check_build
from .geometry import Geometry
from .results import Arrays
from .stack import Stack, of_all_samples

_OK, _VALUE, _NO_SAMPLES = (structs.STATUS.index(word) for word in ("ok", "value", "no_samples"))


def check(given: Geometry, samples: int, channels: int, options: Options) -> None:
    """Options, sizes, and weights and directions of all texels that cannot be used fail here, once."""
    core = library().core
    c_options, c_samples, error = options._struct(), given.shared._struct(), structs.Error()
    check_build(c_options)
    # Having no sample left is no failure yet: a texel's own directions may leave some.
    if core.brdffit_inspect(byref(c_samples), byref(c_options), None, None, 0, byref(error)) not in (_OK, _NO_SAMPLES):
        raise from_struct(error, path=given.shared.file, lines=given.shared.lines)
    if core.brdffit_workspace_size(samples, channels, byref(c_options)) == 0:
        raise DataError("%d samples and %d channels cannot be fitted" % (samples, channels), code="argument")


def _at(structure: type[ctypes.Structure], name: str) -> int:
    """Which 8-byte word of the structure a field is."""
    return int(getattr(structure, name).offset) // 8


_SIGMA, _X, _Y = (_at(structs.Model, name) for name in ("sigma", "x", "y"))
_TERMS = tuple((name, _at(structs.Model, name)) for name in ("f0", "x_more"))
_MODEL, _SCALE, _BOXES, _NODES, _SKIPPED = (_at(structs.Result, name) for name in (
    "model", "channel_scale", "boxes", "nodes", "samples_skipped"))
_NUMBERS = tuple((name, _at(structs.Result, name)) for name in ("e2", "lower_bound", "sum_of_squares",
                                                                     "sigma_floor"))
_SQUARES = _NUMBERS[2][1]

# As structs.ProgressFunction, without an object for what is not looked at.
_CancelFunction = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)


class Worker:
    """What one thread needs to fit texels of a stack, each with its own directions, into `results`.

    cancelled: asked before each texel and every 256 boxes of a search; true ends it
    """

    def __init__(self, given: Geometry, options: Options, stack: Stack, results: Arrays,
                 mask: npt.NDArray[np.uint8] | None, scale: float, cancelled: Callable[[], bool]) -> None:
        core = library().core
        self.given, self.stack, self.mask, self.scale = given, stack, mask, scale
        self.to, self.lobes = results, options.lobe_count
        self.options, self.cancelled = options._struct(), cancelled
        self._progress = _CancelFunction(lambda user, progress: cancelled())
        self.options.progress = ctypes.cast(self._progress, structs.ProgressFunction)
        self.samples = given.shared._struct()
        self.samples.channels = stack.channels
        size = core.brdffit_workspace_size(stack.samples, stack.channels, byref(self.options))
        self.workspace = np.empty(max(1, size), np.uint8)  # its pages exist once they are touched
        self._pointer, self.error = ctypes.c_void_p(), structs.Error()  # the result lies in the workspace
        self._arguments = (byref(self.samples), byref(self.options), self.workspace.ctypes.data, size,
                           byref(self._pointer), byref(self.error))
        # Copies of the result and its model, as numbers: an element is read and written much faster than through
        # ctypes or numpy.
        self.result, self._model = structs.Result(), structs.Model()
        whole = memoryview(self.result).cast("B")
        self._words, self._doubles = whole.cast("P"), whole.cast("d")
        self._model_words = memoryview(self._model).cast("B").cast("P")
        self._counted = (ctypes.c_size_t * len(structs.SKIP))()
        self._out: dict[str, Any] = {name: array.data for name, array in results.items() if array.ndim == 1}
        row = 8 * options.lobe_count
        self._rows = tuple((results[name].ctypes.data, width, words, pointer) for name, width, words, pointer in (
            ("sigma", row, self._model_words, _SIGMA), ("x", 8 * stack.channels, self._model_words, _X),
            ("y", row * stack.channels, self._model_words, _Y),
            ("channel_scale", 8 * stack.channels, self._words, _SCALE),
            *((name, results[name].strides[0], self._model_words, at) for name, at in _TERMS if name in results)))
        self._call: Callable[..., int] = core.brdffit_fit
        self._counts = dict.fromkeys((*texels.COUNTS, "no_samples"), 0)
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
                self._skip(first + i, texels.MASKED)
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
            with np.errstate(all="ignore"):  # what overflows is a bad value
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
        texels.blank(self.to, slice(texel, texel + 1), status)
        self._counts["texels"] += 1
        self._counts[texels.STATUS[status]] += 1

    def _one(self, texel: int) -> None:
        status = self._call(*self._arguments)
        if status == _OK:
            self._publish(texel)
        elif status == _NO_SAMPLES:
            self._skip(texel, texels.NO_SAMPLES)
        elif status == _VALUE and self.error.sample != structs.NONE:
            self._skip(texel, texels.BAD_VALUE)
            channel = 0 if self.error.channel == structs.NONE else self.error.channel
            self.to["where"][texel] = self.error.sample * self.stack.channels + channel
        elif status == _VALUE:
            self._skip(texel, texels.REFUSED)
        else:
            raise from_struct(self.error)

    def _publish(self, texel: int) -> None:
        words, doubles, out, counts = self._words, self._doubles, self._out, self._counts
        ctypes.memmove(byref(self.result), self._pointer, ctypes.sizeof(self.result))
        ctypes.memmove(byref(self._model), words[_MODEL], ctypes.sizeof(self._model))
        ctypes.memmove(self._counted, words[_SKIPPED], ctypes.sizeof(self._counted))
        status = (texels.NO_SIGNAL if not doubles[_SQUARES] > 0 else
                  texels.CERTIFIED if self.result.certified else texels.OPEN)
        for to, width, source, pointer in self._rows:
            ctypes.memmove(to + width * texel, source[pointer], width)
        for name, at in _NUMBERS:
            out[name][texel] = doubles[at]
        out["status"][texel] = status
        out["stop"][texel] = texels.NO_STOP if status == texels.NO_SIGNAL else self.result.stop
        out["where"][texel], out["boxes"][texel] = -1, words[_BOXES]
        counts["texels"] += 1
        counts[texels.STATUS[status]] += 1
        counts["general"] += status != texels.NO_SIGNAL
        counts["boxes"] += words[_BOXES]
        counts["nodes"] += words[_NODES]
        for i, reason in enumerate(structs.SKIP):
            self._skipped[reason] += self._counted[i]

    def counts(self) -> dict[str, int]:
        return self._counts

    def skipped(self) -> dict[str, int]:
        """Samples that fitted texels did not use, by reason."""
        return self._skipped
