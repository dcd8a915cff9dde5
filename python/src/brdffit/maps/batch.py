"""The C library's call for many texels of one geometry, on numpy arrays. Plans are kept between calls.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import collections
import ctypes
import hashlib
import threading
from collections.abc import Callable
from ctypes import POINTER, byref
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _structs as structs
from .._arrays import address
from .._ffi import library
from ..errors import from_struct
from ..options import Options
from ..samples import Samples
from .results import COUNTS, Arrays
from .stack import Block, Stack

_TYPES = {np.dtype(name): i for i, name in enumerate(structs.TYPE)}

# Texels of one call where it is not said: some milliseconds of work, so that Ctrl-C is heard soon.
TILE_ONE_LOBE = 4096
TILE_TWO_LOBES = 32
TILE_PROGRAMS = 1
TILE_OWN = 64  # with directions of their own, one lobe

_PLANS_KEPT = 4


def is_fast(options: Options) -> bool:
    """Whether texels take microseconds: what needs linear or cone programs takes milliseconds and more."""
    return options.norm == "l2" and options.engine == "moment"


def default_tile(options: Options, own: bool = False) -> int:
    if not is_fast(options):
        return TILE_PROGRAMS
    if own:
        return TILE_OWN
    return TILE_ONE_LOBE if options.lobes == 1 else TILE_TWO_LOBES


class Plan:
    """A brdffit_plan: never changed, shared by threads. Keeps copies of what it was made from."""

    def __init__(self, geometry: Samples, channels: int, options: Options) -> None:
        core = library().core
        self.samples, self.channels, self.lobes = len(geometry), channels, options.lobes
        self.options = options
        c_options, c_samples = options._struct(), geometry._struct()
        c_samples.channels, c_samples.values = channels, None
        if not is_fast(options):
            check_build(c_options)
        size = core.brdffit_plan_size(byref(c_samples), byref(c_options))
        self._memory = np.empty(max(1, size), np.uint8)
        pointer, error = ctypes.c_void_p(), structs.Error()
        if core.brdffit_plan_init(byref(c_samples), byref(c_options), address(self._memory), size, byref(pointer),
                                  byref(error)) != 0:
            raise from_struct(error, path=geometry.file, lines=geometry.lines)
        self.pointer = pointer
        self.workspace_size = int(core.brdffit_many_workspace_size(pointer))
        self.samples_skipped = self._inspect(c_samples, c_options)

    def _inspect(self, samples: structs.Samples, options: structs.Options) -> dict[str, int]:
        """Samples that no texel uses, by reason."""
        zeros = np.zeros(self.samples)
        samples.channels, samples.values = 1, address(zeros)
        skipped = (ctypes.c_size_t * len(structs.SKIP))()
        library().core.brdffit_inspect(byref(samples), byref(options), None, skipped, len(structs.SKIP), None)
        return {reason: int(skipped[i]) for i, reason in enumerate(structs.SKIP)}


def check_build(options: structs.Options) -> None:
    """Whether this build can fit so at all (without ECOS some options cannot): asked of the smallest problem there is,
    before thousands of texels are refused."""
    core = library().core
    up = np.array([0.0, 0.0, 1.0])
    one = library().samples()
    one.count = one.channels = 1
    one.light = one.view = one.values = address(up)
    result, error = POINTER(structs.Result)(), structs.Error()
    core.brdffit_fit_new(byref(one), byref(options), byref(result), byref(error))
    core.brdffit_result_free(result)
    if error.status == structs.STATUS.index("unsupported"):
        raise from_struct(error)


_plans: collections.OrderedDict[tuple[Any, ...], Plan] = collections.OrderedDict()
_plans_lock = threading.Lock()


def content(geometry: Samples) -> bytes:
    digest = hashlib.blake2b(digest_size=16)
    for name in ("light", "view", "normal", "cos_light", "cos_view", "tan2_half", "cos_difference", "a", "b", "c",
                 "weights"):
        array = getattr(geometry, name)
        digest.update(b"-" if array is None else b"+")
        if array is not None:
            digest.update(array)
    return digest.digest()


def plan_for(geometry: Samples, channels: int, options: Options) -> Plan:
    """The plan of a geometry (a `Samples` whose values are not looked at); the last few are kept."""
    key = (len(geometry), geometry.form, geometry.quantity, content(geometry), channels, bytes(options._struct()))
    with _plans_lock:
        plan = _plans.get(key)
        if plan is None:
            plan = _plans[key] = Plan(geometry, channels, options)
            while len(_plans) > _PLANS_KEPT:
                _plans.popitem(last=False)
        else:
            _plans.move_to_end(key)
    return plan


class Worker:
    """What one thread needs to fit texels of a stack into `results`."""

    def __init__(self, plan: Plan, stack: Stack, results: Arrays, mask: npt.NDArray[np.uint8] | None,
                 scale: float) -> None:
        core = library().core
        self.plan, self.stack, self.mask = plan, stack, mask
        self.workspace = np.empty(max(1, plan.workspace_size), np.uint8)  # its pages exist once they are touched
        self.texels, self.results, self.stats = structs.Texels(), structs.TexelResults(), structs.ManyStats()
        core.brdffit_texels_init_sized(byref(self.texels), ctypes.sizeof(self.texels), plan.pointer)
        core.brdffit_texel_results_init_sized(byref(self.results), ctypes.sizeof(self.results))
        core.brdffit_many_stats_init_sized(byref(self.stats), ctypes.sizeof(self.stats))
        self.texels.scale = scale
        self._to = [(name, int(array.ctypes.data), array.strides[0]) for name, array in results.items()]
        self._keep = results
        self._call: Callable[..., int] = core.brdffit_fit_many
        self._error = structs.Error()

    def fit(self, first: int, count: int) -> bool:
        """Texels [first, first + count). Other threads run meanwhile. True: they are all done."""
        for block in self.stack.blocks(first, count):
            self._fit(block)
        return True

    def _fit(self, block: Block) -> None:
        t, r, values = self.texels, self.results, block.values
        item = values.itemsize
        t.count = block.texels
        t.values, t.type = values.ctypes.data, _TYPES[values.dtype]
        t.sample_stride, t.texel_stride, t.channel_stride = (step // item for step in values.strides)
        t.mask = None if self.mask is None else self.mask.ctypes.data + block.first
        for name, start, step in self._to:
            setattr(r, name, start + block.first * step)
        if self._call(self.plan.pointer, byref(t), byref(r), self.workspace.ctypes.data, self.plan.workspace_size,
                      byref(self.stats), byref(self._error)) != 0:
            raise from_struct(self._error)

    def counts(self) -> dict[str, int]:
        return {name: int(getattr(self.stats, name)) for name in COUNTS}

    def skipped(self) -> dict[str, int]:
        return self.plan.samples_skipped
