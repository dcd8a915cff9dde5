"""Samples and stacks in HDF5 files and zarr groups, by h5py and zarr. SPDX-License-Identifier: MIT

Data sets, in a group of the file, by these names or by others that the caller gives:

    values              N x K or N (samples), S x H x W x K or S x H x W (stacks); NaN in a sample: absent, left out
    light, view         N x 3; any length
    theta_i, phi_i      N, instead of light, in degrees (attribute "units" beginning with "rad": in radians); phi_i may be
    theta_o, phi_o      absent only together with phi_o, and means 0 and 180 then, as in CSV files; likewise for view
    normal              N x 3 (samples), H x W x 3 (stacks)
    weights             N
    mask                H x W (stacks)
    cos_light, cos_view, tan2_half, cos_difference, or a, b, c: N, instead of directions (samples)

Attributes of `values`, or else of its group: "quantity" ("brdf" or "radiance") and "channels" (names).

Known limit: flipped bits in an HDF5 file can crash or hang inside of libhdf5, where nothing here can catch it.
"""
from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .._arguments import Path
from .._arrays import Floats
from ..errors import BrdffitError, DataError, FileError, OptionError
from ._extra import need
from .lazy import LazyArray, Names, Part

NAMES = ("values", "light", "view", "theta_i", "phi_i", "theta_o", "phi_o", "normal", "weights", "mask", "cos_light", "cos_view",
         "tan2_half", "cos_difference", "a", "b", "c")
_FORMS = {"angles": ("cos_light", "cos_view", "tan2_half", "cos_difference"), "coefficients": ("a", "b", "c")}


def open_group(file: str, kind: str, group: str | None) -> Any:
    """An h5py or zarr group."""
    package = need("h5py" if kind == "hdf5" else "zarr", kind, "HDF5 files" if kind == "hdf5" else "zarr groups")
    if not os.path.exists(file):
        raise FileError("no such file", code="open", path=file)
    try:
        if kind == "hdf5":
            root = package.File(file, "r")
        else:
            root = package.open(package.storage.ZipStore(file, mode="r") if os.path.isfile(file) else file, mode="r")
        found = root if group is None else root[group]
    except KeyError as error:
        raise DataError("there is no group %r" % group, code="format", path=file) from error
    except Exception as error:  # h5py's and zarr's kinds of error differ with the fault and the version
        raise DataError("this cannot be opened as %s (%s)" % ("HDF5" if kind == "hdf5" else "zarr", error), code="format",
                        path=file) from error
    if not hasattr(found, "keys"):
        raise DataError("%s is an array; a group of arrays was expected" % (group or "the root"), code="format", path=file)
    return found


class StoreArray(LazyArray):
    """Data sets of a file as one array. Opened when it is first read, so that it can be sent to other processes."""

    def __init__(self, file: str, kind: str, group: str | None, names: Sequence[str], channels: Sequence[int],
                 datasets: Sequence[Any]) -> None:
        count = datasets[0].shape[3] if datasets[0].ndim == 4 else len(datasets)
        kinds = [np.dtype(one.dtype) for one in datasets]
        single = all(d.itemsize <= (4 if d.kind == "f" else 2) for d in kinds)
        super().__init__((*datasets[0].shape[:3], len(channels)), np.float32 if single else np.float64)
        self.file, self.names = file, tuple(names)
        self._kind, self._group, self._channels, self._count = kind, group, tuple(channels), count
        self._open: list[Any] | None = list(datasets)
        self.rows_together = (getattr(datasets[0], "chunks", None) or (1, 1))[1]

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_open": None}

    def _datasets(self) -> list[Any]:
        if self._open is None:
            group = open_group(self.file, self._kind, self._group)
            self._open = [group[name] for name in self.names]
        return self._open

    def _read(self, part: Part) -> npt.NDArray[Any]:
        space, channels = part[:3], self._channels[part[3]]
        try:
            datasets = self._datasets()
            if datasets[0].ndim == 4:
                low, high = min(channels), max(channels) + 1
                place = (*space, slice(low, high))
                whole = np.asarray(datasets[0][place], self.dtype)
                return whole[..., [k - low for k in channels]]
            return np.stack([np.asarray(datasets[k][space], self.dtype) for k in channels], -1)
        except BrdffitError:
            raise
        except Exception as error:
            raise DataError("%s cannot be read (%s)" % (", ".join(self.names), error), code="read", path=self.file) from error


class Store:
    """A group of a file and what its data sets are called."""

    def __init__(self, file: str, kind: str, names: Names | None, group: str | None) -> None:
        self.file, self.kind, self.group = file, kind, group
        self._group = open_group(file, kind, group)
        for name in names or ():
            if name not in NAMES:
                raise OptionError("names= has %r; only these can be named: %s" % (name, ", ".join(NAMES)), code="option", path=file)
        self._names = dict(names or {})

    def _wrong(self, message: str) -> DataError:
        return DataError(message, code="format", path=self.file)

    @contextlib.contextmanager
    def _reading(self, what: str) -> Iterator[None]:
        """What h5py and zarr raise differs with the fault and the version: here it becomes one error."""
        try:
            yield
        except BrdffitError:
            raise
        except Exception as error:
            raise self._wrong("%s cannot be read (%s)" % (what, error)) from error

    def _called(self, name: str) -> list[str]:
        called = self._names.get(name, name)
        if not isinstance(called, str) and name != "values":
            raise OptionError("names=: only values may be several data sets, not %s" % name, code="option", path=self.file)
        return [called] if isinstance(called, str) else list(called)

    def _has(self, name: str) -> bool:
        """Whether it is there, or was asked for by name."""
        with self._reading("data set %r" % name):
            return name in self._names or self._called(name)[0] in self._group

    def _dataset(self, called: str) -> Any:
        with self._reading("data set %r" % called):
            if called not in self._group:
                raise self._wrong("there is no data set %r; there are %s" % (called, self._listing()))
            found = self._group[called]
            if hasattr(found, "shape") and np.dtype(found.dtype).kind in "fiub":
                return found
        raise self._wrong("%r is not a data set of numbers" % called)

    def _listing(self) -> str:
        with self._reading("the list of data sets"):
            return ", ".join(sorted(str(name) for name in self._group)) or "none"

    def _array(self, name: str, *shapes: tuple[int, ...]) -> Floats:
        """All of a small data set."""
        called, = self._called(name)
        found = self._dataset(called)
        if tuple(found.shape) not in shapes:
            raise self._wrong("data set %r must have shape %s, not %s" % (called, " or ".join(map(str, shapes)),
                                                                          tuple(found.shape)))
        return self._all(found, called)

    def _all(self, found: Any, called: str) -> Floats:
        with self._reading("data set %r" % called):
            return np.asarray(found[...], np.float64)

    # ---- Directions

    def _directions(self, count: int, name: str, end: str) -> Floats | None:
        """Vectors `name`, or those of the angles theta_`end`, phi_`end`; None where there is neither."""
        if self._has(name):
            return self._array(name, (count, 3), *[(3,)] if name == "view" else [])
        if not self._has("theta_" + end):
            return None
        theta = self._angle("theta_" + end, count)
        if self._has("phi_" + end):
            phi = self._angle("phi_" + end, count)
        elif self._has("phi_o" if end == "i" else "phi_i"):
            raise self._wrong("there is no data set %r, though the other azimuth is there" % self._called("phi_" + end)[0])
        else:
            phi = np.full(count, 0.0 if end == "i" else np.pi)
        return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], 1)

    def _angle(self, name: str, count: int) -> Floats:
        angle = self._array(name, (count,))
        called, = self._called(name)
        units = _text(self._attribute("units", self._dataset(called)) or "degrees")
        return angle if units.lower().startswith("rad") else np.radians(angle)

    # ---- Values

    def _values(self) -> tuple[list[str], list[Any]]:
        called = self._called("values")
        if not called:
            raise OptionError("names=: values must be one data set or more", code="option", path=self.file)
        found = [self._dataset(one) for one in called]
        for one, name in zip(found, called):
            if one.shape != found[0].shape:
                raise self._wrong("data sets %r and %r differ in shape" % (called[0], name))
            if 0 in one.shape:
                raise self._wrong("data set %r is empty" % name)
        return called, found

    def _attribute(self, name: str, *holders: Any) -> Any:
        """Of the first of them that has it, or None."""
        with self._reading("attribute %r" % name):
            return next((holder.attrs[name] for holder in holders if name in holder.attrs), None)

    def _quantity(self, asked: str | None, found: Any, default: str) -> str:
        said = self._attribute("quantity", found, self._group)
        chosen = asked if asked is not None else default if said is None else _text(said)
        if chosen not in ("brdf", "radiance"):
            if asked is not None:
                raise OptionError('quantity must be "brdf" or "radiance", not %r' % asked, code="option", path=self.file)
            raise self._wrong('attribute "quantity" must be "brdf" or "radiance", not %r' % chosen)
        return chosen

    def _channels(self, called: list[str], found: Any, count: int) -> tuple[str, ...]:
        said = self._attribute("channels", found, self._group)
        if said is not None and len(called) == 1:
            names = tuple(_text(one) for one in (_text(said).split(",") if isinstance(said, (str, bytes)) else said))
            if len(names) != count:
                raise self._wrong('attribute "channels" names %d, but there are %d' % (len(names), count))
            return tuple(name.strip() for name in names)
        if len(called) > 1:
            return tuple(name.rsplit("/", 1)[-1] for name in called)
        return ("r", "g", "b") if count == 3 else tuple("channel%d" % (k + 1) for k in range(count))

    # ---- Results

    def samples(self, quantity: str | None) -> dict[str, Any]:
        """The members of `Samples`."""
        called, found = self._values()
        dimensions = len(found[0].shape)
        if dimensions not in (1, 2) or (len(found) > 1 and dimensions != 1):
            raise self._wrong("data set %r has %d dimensions; samples have N x K or N%s" % (
                called[0], dimensions, ": load_stack reads stacks of images" if dimensions > 2 else ""))
        values = np.stack([self._all(one, name) for one, name in zip(found, called)], -1) if dimensions == 1 else \
            self._all(found[0], called[0])
        count = len(values)
        form = next((form for form, names in _FORMS.items() if all(self._has(name) for name in names)), "directions")
        data: dict[str, Any] = {}
        if form == "directions":
            data = {"light": self._directions(count, "light", "i"), "view": self._directions(count, "view", "o")}
            for name, angle in (("light", "theta_i"), ("view", "theta_o")):
                if data[name] is None:
                    raise self._wrong("there is neither %r nor %r; there are %s" % (
                        self._called(name)[0], self._called(angle)[0], self._listing()))
                data[name] = np.broadcast_to(data[name], (count, 3))
            if self._has("normal"):
                data["normal"] = np.broadcast_to(self._array("normal", (count, 3), (3,)), (count, 3))
        else:
            data = {name: self._array(name, (count,)) for name in _FORMS[form]}
        if self._has("weights"):
            data["weights"] = self._array("weights", (count,))
        there = ~np.isnan(values).any(1)
        if not there.any():
            raise DataError("every sample has a channel that is absent (NaN)", code="no_samples", path=self.file)
        return {"values": values[there], "channels": self._channels(called, found[0], values.shape[1]), "form": form,
                "quantity": self._quantity(quantity, found[0], "radiance" if form == "coefficients" else "brdf"),
                "file": self.file, "format": self.kind, "dropped": {"absent": int((~there).sum())},
                **{name: array[there] for name, array in data.items()}}

    def _mask(self, pixels: tuple[int, int]) -> npt.NDArray[np.bool_] | None:
        if not self._has("mask"):
            return None
        mask = self._array("mask", pixels)
        return np.asarray((mask > 0) | (mask < 0))  # not where it is NaN

    def stack(self, light: npt.ArrayLike | None, view: npt.ArrayLike | None, channels: Sequence[str] | None,
              quantity: str | None) -> dict[str, Any]:
        """The members of a `Stack`."""
        called, found = self._values()
        shape = tuple(found[0].shape)
        if len(shape) not in (3, 4) or (len(found) > 1 and len(shape) != 3):
            raise self._wrong("data set %r has %d dimensions; a stack has samples x height x width x channels%s" % (
                called[0], len(shape), ": Samples.from_file reads samples" if len(shape) < 3 else ""))
        names = self._channels(called, found[0], shape[3] if len(shape) == 4 else len(found))
        chosen = list(range(len(names)))
        if channels is not None:
            for name in channels:
                if name not in names:
                    raise OptionError("there is no channel %r; there are %s" % (name, ", ".join(names)), code="option",
                                      path=self.file)
            chosen = [names.index(name) for name in channels]
        towards = self._directions(shape[0], "light", "i") if light is None else np.asarray(light)
        if towards is None:
            raise self._wrong("there is neither %r nor %r: give light=; there are %s" % (
                self._called("light")[0], self._called("theta_i")[0], self._listing()))
        from_where = self._directions(shape[0], "view", "o") if view is None else np.asarray(view)
        pixels = (shape[1], shape[2])
        return {"values": StoreArray(self.file, self.kind, self.group, called, chosen, found), "light": towards,
                "view": np.array([0.0, 0.0, 1.0]) if from_where is None else from_where,
                "channels": tuple(names[k] for k in chosen), "quantity": self._quantity(quantity, found[0], "radiance"),
                "normal": self._array("normal", (*pixels, 3)) if self._has("normal") else None,
                "mask": self._mask(pixels), "file": self.file, "format": self.kind,
                "weights": self._array("weights", (shape[0],)) if self._has("weights") else None}


def read(path: Path, kind: str, *, names: Names | None = None, group: str | None = None,
         quantity: str | None = None) -> dict[str, Any]:
    """The members of `Samples`, of a file or folder."""
    return Store(os.fspath(path), kind, names, group).samples(quantity)


def _text(value: Any) -> str:
    """An attribute that should be text, however it is stored."""
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.reshape(-1)[0]
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
