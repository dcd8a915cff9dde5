"""Stacks of images, one a light, read as far as they are needed. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import dataclasses
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np
import numpy.typing as npt

from .._arguments import Path, choose, count_of
from .._arrays import Floats, column, freeze, vectors
from ..errors import BrdffitError, DataError, OptionError
from ..maps import FitMap, fit_map
from ..maps.arguments import MapOptions
from ..outofcore.arrays import MapArrays
from ..samples import Samples
from ._detect import kind_of
from .exr import exr_stack
from .lazy import LazyArray, Names
from .lp import load_lp
from .store import Store

if TYPE_CHECKING:
    from typing_extensions import Unpack

Values = LazyArray | npt.NDArray[Any]


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

    @overload
    def fit_map(self, *, rows: int | None = None, output: None = None, **options: Unpack[MapOptions]) -> FitMap: ...

    @overload
    def fit_map(self, *, rows: int | None = None, output: Any, **options: Unpack[MapOptions]) -> MapArrays: ...

    def fit_map(self, *, rows: int | None = None, **options: Any) -> FitMap | MapArrays:
        """Every texel fitted: `brdffit.fit_map` with this stack's values, directions, weights, normal, mask and quantity. What
        is in files is read a band of `rows` rows at a time, of which two are in memory (None: as many as 128 MB hold). options:
        the others of fit_map, output and client among them."""
        if rows is not None:
            rows = count_of("rows", rows, 1)
            if isinstance(self.values, LazyArray):
                options["tile"] = (rows, self.values.shape[2])
        options.setdefault("weights", self.weights)
        try:
            out: FitMap | MapArrays = fit_map(self.values, self.light, self.view, normal=self.normal, mask=self.mask,
                                              quantity=self.quantity, **options)
        except BrdffitError as error:
            error.path = error.path or self.file
            raise
        return out


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
    file, kind = os.fspath(path), kind_of(path)
    if light is not None and isinstance(light, (str, os.PathLike)):
        light = load_lp(light).directions
    if kind in ("hdf5", "zarr"):
        if images is not None:
            raise OptionError("images= goes with an .lp file", code="option", path=file)
        return Stack(**Store(file, kind, names, group).stack(light, view, channels, quantity))
    if names is not None or group is not None:
        raise OptionError("names= and group= go with HDF5 and zarr", code="option", path=file)
    if kind == "exr":
        raise OptionError("this is one image: give the .lp file that names the images and their lights", code="option",
                          path=file)
    return Stack(**exr_stack(file, images, light, view, channels, quantity or "radiance"))
