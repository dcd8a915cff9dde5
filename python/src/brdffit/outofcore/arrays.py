"""Maps that are not in memory: written, or still to be computed. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from .._arrays import freeze
from ..maps.fitmap import FitMap
from ..maps.results import allocate, terms_of
from ..options import Options
from . import store


class MapArrays(Mapping[str, Any]):
    """The arrays of a `FitMap` by name, which are not in memory: zarr arrays that were written, or Dask arrays that fit
    when they are computed (all together: `dask.compute(*maps.values())`; each alone would fit everything again).

    group: the zarr group, or None; options, quantity, samples: as of FitMap
    """

    def __init__(self, arrays: Mapping[str, Any], rows: Any, about: Mapping[str, Any], group: Any = None) -> None:
        self._arrays, self._rows, self._about, self.group = dict(arrays), rows, about, group
        self.options: Options = about["options"]
        self.quantity: str = about["quantity"]
        self.samples: int = about["samples"]

    def __getitem__(self, name: str) -> Any:
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_") and name in self._arrays:
            return self._arrays[name]
        raise AttributeError("MapArrays has no attribute %r" % name)

    def __repr__(self) -> str:
        where = "in %s" % self.group.store_path if self.group is not None else "to be computed"
        return "<MapArrays %s: %s>" % (where, ", ".join("%s %s" % (n, tuple(a.shape)) for n, a in self.items()))

    def load(self) -> FitMap:
        """Read, or compute, all of them into memory. seconds are those of a computation, 0 when they are read."""
        began = time.perf_counter()
        if self.group is not None:
            arrays = {name: np.asarray(array[...]) for name, array in self.items()}
            rows, seconds = store.read_counts(self.group), 0.0
        else:
            import dask

            parts, found = dask.compute(self._arrays, self._rows)
            arrays, rows = parts, np.array(found, np.int64)
            seconds = time.perf_counter() - began
        rows = rows[rows[:, 0] >= 0]
        names = store.COUNTED
        total = [int(n) for n in rows.sum(axis=0)]
        skipped = total[len(names):] if self._about["own"] or not len(rows) else [int(n) for n in rows[0, len(names):]]
        allocated = allocate(0, 1, 1, **terms_of(self.options))
        shaped: dict[str, Any] = {name: freeze(np.ascontiguousarray(arrays[name], dtype=allocated[name].dtype))
                                  for name in allocated}
        out = FitMap(**shaped, samples=self.samples, samples_skipped=dict(zip(store.SKIPPED, skipped)),
                     quantity=self.quantity, options=self.options, stats={}, seconds=seconds)
        stats = dict(zip(names, total)) | out.counts | {"texels": int(out.status.size)}
        return dataclasses.replace(out, stats=stats)


def open_maps(path: Any) -> MapArrays:
    """What `fit_map` wrote to an output, finished or not: a path, URL, zarr store or group. xarray.open_zarr opens it too.

    Raises `DataError` when it holds something else, and zarr's own errors when there is nothing.
    """
    need("zarr")
    group, about = store.find_maps(path)
    asked: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value for name, value in about["options"].items()}
    options = Options(**asked)
    named = {field.name: group[field.stored] for field in store.fields(
        about["channels"], options.distributions, **terms_of(options))}
    return MapArrays(named, None, {"options": options, "quantity": about["quantity"],
                                   "samples": about["samples"], "own": about["own"]}, group)


def need(package: str) -> None:
    try:
        __import__(package)
    except ImportError as error:
        raise ImportError("%s is needed here: pip install 'brdffit[dask]'" % package) from error
