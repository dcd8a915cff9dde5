"""Stacks of images, one a light, read as far as they are needed. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import os
from typing import TYPE_CHECKING, Any, Mapping, Sequence, Union

import numpy as np
import numpy.typing as npt

from .._arrays import Floats, column, freeze, vectors
from .._pool import count_of
from ..errors import BrdffitError, DataError, OptionError
from ..samples import Path, Samples, choose

if TYPE_CHECKING:
    from ..maps import FitMap

Part = tuple[slice, slice, slice, slice]
Names = Mapping[str, Union[str, Sequence[str]]]


class LazyArray:
    """samples x height x width x channels in files. Indexing with numbers, slices (of any step) and `...` reads what is
    asked for, as float32 or float64; `numpy.asarray` reads all. A base: `_read` knows the format."""

    ndim = 4
    rows_together = 32  # rows of an image that are stored as one block, or close to it

    def __init__(self, shape: tuple[int, int, int, int], dtype: npt.DTypeLike) -> None:
        self.shape = shape
        self.dtype: np.dtype[Any] = np.dtype(dtype)

    def _read(self, part: Part) -> npt.NDArray[Any]:
        """part: slices with start, stop and step of 1, inside of the shape and not empty."""
        raise NotImplementedError

    @property
    def size(self) -> int:
        return int(np.prod(self.shape))

    @property
    def nbytes(self) -> int:
        return self.size * self.dtype.itemsize

    def __len__(self) -> int:
        return self.shape[0]

    def __repr__(self) -> str:
        return "<%s: %s, %s>" % (type(self).__name__, " x ".join(map(str, self.shape)), self.dtype)

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if copy is False:
            raise ValueError("the values are in files: an array of them is a copy")
        array = self[...]
        return array if dtype is None else array.astype(dtype)

    def __getitem__(self, key: Any) -> npt.NDArray[Any]:
        part: list[slice] = []
        after: list[slice | int] = []
        for index, extent in zip(self._complete(key), self.shape):
            if isinstance(index, slice):
                chosen = range(*index.indices(extent))
                low, high = (min(chosen[0], chosen[-1]), max(chosen[0], chosen[-1])) if chosen else (0, -1)
                part.append(slice(low, high + 1, 1))
                after.append(slice(None, None, chosen.step))
            else:
                at = index + extent if index < 0 else index
                if not 0 <= at < extent:
                    raise IndexError("index %d is out of bounds for %d" % (index, extent))
                part.append(slice(at, at + 1, 1))
                after.append(0)
        shape = tuple(one.stop - one.start for one in part)
        if 0 in shape:
            return np.empty(shape, self.dtype)[tuple(after)]
        return self._read((part[0], part[1], part[2], part[3]))[tuple(after)]

    def _complete(self, key: Any) -> list[Any]:
        """One index a dimension, integers or slices."""
        given = list(key) if isinstance(key, tuple) else [key]
        dots = [at for at, index in enumerate(given) if index is Ellipsis]
        if len(dots) > 1:
            raise IndexError("only one ... may stand in an index")
        if not dots:
            given.append(Ellipsis)
        at = dots[0] if dots else len(given) - 1
        if len(given) - 1 > self.ndim:
            raise IndexError("%d indices for %d dimensions" % (len(given) - 1, self.ndim))
        given[at:at + 1] = [slice(None)] * (self.ndim - len(given) + 1)
        return [index if isinstance(index, slice) else _integer(index) for index in given]


def _integer(index: Any) -> int:
    if isinstance(index, bool) or not isinstance(index, (int, np.integer)):
        raise IndexError("a stack is indexed with numbers, slices and ..., not %s" % type(index).__name__)
    return int(index)


Values = Union[LazyArray, npt.NDArray[Any]]


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Stack:
    """Images of one surface under different lights: what fit_map takes. Make one with `load_stack`.

    values: samples x height x width x channels; read from the files as it is indexed
    light, view: samples x 3, of any length (x to the right, y up, z towards the camera)
    channels: K names
    quantity: what the values are, "radiance" (proportional to f_r (n.l)) or "brdf"
    normal: height x width x 3, or None for +z
    mask: height x width, true where a texel is to be fitted, or None for everywhere
    names: of the samples, or None
    weights: samples, multiply squared residuals, or None
    """

    values: Values
    light: Floats
    view: Floats
    channels: tuple[str, ...]
    quantity: str = "radiance"
    normal: Floats | None = None
    mask: npt.NDArray[np.bool_] | None = None
    names: tuple[str, ...] | None = None
    file: str | None = None
    format: str | None = None
    weights: Floats | None = None

    def __post_init__(self) -> None:
        count, height, width, channels = self.values.shape
        if len(self.channels) != channels:
            raise self._wrong("%d channel names for %d channels" % (len(self.channels), channels))
        choose("quantity", self.quantity, ("brdf", "radiance"))
        for name, shape in (("light", (count, 3)), ("view", (count, 3)), ("normal", (height, width, 3))):
            given = getattr(self, name)
            if given is not None:
                array = vectors(name, given)
                if name == "view" and array.shape == (3,):
                    array = np.broadcast_to(array, shape)
                if array.shape != shape:
                    raise self._wrong("%s must have shape %s, not %s" % (name, shape, array.shape))
                object.__setattr__(self, name, freeze(array))
        if self.mask is not None:
            if np.shape(self.mask) != (height, width):
                raise self._wrong("the mask must have shape %s, not %s" % ((height, width), np.shape(self.mask)))
            mask = np.asarray(self.mask)
            object.__setattr__(self, "mask", freeze((mask > 0) | (mask < 0)))  # not where it is NaN, as of fit_map
        if self.weights is not None:
            object.__setattr__(self, "weights", freeze(column("weights", self.weights, count)))

    def _wrong(self, message: str) -> DataError:
        return DataError(message, code="argument", path=self.file)

    def __repr__(self) -> str:
        return "<Stack: %d images of %d x %d (%s), %s from %s>" % (
            self.values.shape[0], self.values.shape[2], self.values.shape[1], ", ".join(self.channels), self.quantity, self.file)

    def texel(self, row: int, column: int) -> Samples:
        """One texel as samples to fit."""
        normal = None if self.normal is None else self.normal[row, column]
        return Samples.from_arrays(self.light, self.view, np.asarray(self.values[:, row, column]), normal=normal,
                                   channels=self.channels, quantity=self.quantity, weights=self.weights)

    def fit_map(self, *, rows: int | None = None, **options: Any) -> FitMap:
        """Every texel fitted: `brdffit.fit_map` with this stack's values, directions, weights, normal, mask and quantity. What
        is in files is read a band of `rows` rows at a time, of which two are in memory (None: as many as 128 MB hold). options:
        the others of fit_map, output and client among them."""
        from ..maps import fit_map

        if rows is not None:
            rows = count_of("rows", rows, 1)
            if isinstance(self.values, LazyArray):
                options["tile"] = (rows, self.values.shape[2])
        options.setdefault("weights", self.weights)
        try:
            return fit_map(self.values, self.light, self.view, normal=self.normal, mask=self.mask, quantity=self.quantity,
                           **options)
        except BrdffitError as error:
            error.path = error.path or self.file
            raise


def load_stack(path: Path, *, light: npt.ArrayLike | Path | None = None, view: npt.ArrayLike | None = None,
               channels: Sequence[str] | None = None, quantity: str | None = None, images: Sequence[Path] | None = None,
               names: Names | None = None, group: str | None = None) -> Stack:
    """A stack of images with its lights. Of the images only the headers are read here, the rest by `values` as it is indexed.

    path: an .lp file that names OpenEXR images, an HDF5 file, or a zarr group
    light: samples x 3, or an .lp file, instead of what the file holds
    view: towards the camera, one vector or one a sample; None: what the file says, else +z
    channels: which, by name; None: of EXR images R, G, B or the only one there is, of the others all
    quantity: "radiance" or "brdf"; None: what the file says, else "radiance"
    images: for an .lp file, the images' paths in its order instead of those that it names
    names, group: for HDF5 and zarr: see Samples.from_hdf5; data sets besides those are values (samples x height x width
        [x channels]), normal (height x width x 3) and mask (height x width)
    """
    from ._detect import kind_of

    file, kind = os.fspath(path), kind_of(path)
    if light is not None and isinstance(light, (str, os.PathLike)):
        from .lp import load_lp

        light = load_lp(light).directions
    if kind in ("hdf5", "zarr"):
        if images is not None:
            raise OptionError("images= goes with an .lp file", code="option", path=file)
        from .store import Store

        return Store(file, kind, names, group).stack(light, view, channels, quantity)
    if names is not None or group is not None:
        raise OptionError("names= and group= go with HDF5 and zarr", code="option", path=file)
    if kind == "exr":
        raise OptionError("this is one image: give the .lp file that names the images and their lights", code="option",
                          path=file)
    from .exr import exr_stack

    return exr_stack(file, images, light, view, channels, quantity or "radiance")
