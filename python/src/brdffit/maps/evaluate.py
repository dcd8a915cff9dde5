"""Fitted texels under other directions. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import ctypes
import math
from ctypes import byref
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .. import _lobes, _terms
from .. import _structs as structs
from .._arguments import choose
from .._arrays import Floats, address, floats, vectors
from .._ffi import library
from ..errors import DataError, from_struct
from .stack import of_all_samples

if TYPE_CHECKING:
    from .fitmap import FitMap

# Texels whose own directions are laid out at a time.
_CHUNK = 1024


def _stacked(name: str, value: npt.ArrayLike, spatial: tuple[int, ...]) -> Floats:
    """N x 1 ... x 3, or N x S x 3."""
    array = vectors(name, value)
    if array.ndim <= 2:
        return array.reshape(-1, *(1,) * len(spatial), 3)
    if array.ndim == 2 + len(spatial) and all(n in (1, m) for n, m in zip(array.shape[1:], spatial)):
        return array
    raise DataError("%s must have shape (3,), (N, 3)%s, not %s" % (
        name, " or (N, %s3)" % "".join("%d, " % n for n in spatial) if spatial else "", array.shape), code="argument")


def _normal(value: npt.ArrayLike | None, spatial: tuple[int, ...]) -> Floats | None:
    if value is None:
        return None
    array = vectors("normal", value)
    if array.shape not in ((3,), (*spatial, 3)):
        raise DataError("normal must have shape (3,)%s, not %s" % (
            " or %s" % ((*spatial, 3),) if spatial else "", array.shape), code="argument")
    return array.reshape(1, *(array.shape[:-1] or (1,) * len(spatial)), 3)


class _Directions:
    """light, view and normal of texels, as the C library reads them: N x 3 each."""

    def __init__(self, at: structs.Samples, arrays: dict[str, Floats], samples: int, spatial: tuple[int, ...]) -> None:
        self._spatial = spatial
        self._own: dict[str, Floats] = {}
        self._keep: list[Any] = []
        for name, array in arrays.items():
            if math.prod(array.shape[1:-1]) == 1:
                shared = np.ascontiguousarray(np.broadcast_to(array.reshape(-1, 3), (samples, 3)))
                self._keep.append(shared)
                setattr(at, name, address(shared))
            else:
                self._own[name] = np.broadcast_to(array, (samples, *spatial, 3))

    def lay_out(self, first: int, count: int) -> list[tuple[str, int]]:
        """Of `count` texels: where each array of the first one is; the next ones follow."""
        self._chunk = []
        if not self._own:
            return []
        at = of_all_samples(np.unravel_index(np.arange(first, first + count), self._spatial))
        for name, array in self._own.items():
            self._chunk.append((name, floats(name, array[at].swapaxes(0, 1))))
        return [(name, array.ctypes.data) for name, array in self._chunk]


def predict(fits: FitMap, light: npt.ArrayLike, view: npt.ArrayLike, normal: npt.ArrayLike | None,
            quantity: str | None) -> Floats:
    spatial, single = fits.shape, np.ndim(light) == 1 and np.ndim(view) == 1
    arrays = {"light": _stacked("light", light, spatial), "view": _stacked("view", view, spatial)}
    lengths = {len(array) for array in arrays.values()}
    if len(lengths - {1}) > 1:
        raise DataError("light and view have %d and %d directions" % (len(arrays["light"]), len(arrays["view"])),
                        code="argument")
    samples = max(lengths - {1}, default=1) if 0 not in lengths else 0
    up = _normal(normal, spatial)
    if up is not None:
        arrays["normal"] = up
    at = library().samples()
    at.count, at.form = samples, structs.FORM.index("directions")
    at.quantity = choose("quantity", fits.quantity if quantity is None else quantity, structs.QUANTITY)
    out = np.empty((fits.status.size, samples, fits.channels))
    _evaluate(fits, at, _Directions(at, arrays, samples, spatial), out)
    if single:
        return out.reshape(*spatial, fits.channels)
    return np.moveaxis(out.reshape(*spatial, samples, fits.channels), -2, 0)


def _terms_of(fits: FitMap, model: structs.Model) -> list[tuple[int, Floats, int]]:
    """Fresnel, masking and the diffuse term into the model; of their arrays: which word of it, and bytes a texel."""
    options = fits.options
    out: list[tuple[int, Floats, int]] = []
    for kind in _terms.DEFAULTS:
        setattr(model, kind, _terms.check(kind, getattr(options, kind)))
    widths = {"f0": fits.lobes if model.fresnel else 0, "x_more": _terms.more_columns(options.diffuse)}
    for name, width in widths.items():
        array = getattr(fits, name)
        if width and (array is None or array.shape != (*fits.x.shape, width)):
            raise DataError("%s does not belong to these texels and options" % name, code="argument")
        if width:
            fixed = floats(name, array)
            out.append((getattr(structs.Model, name).offset // 8, fixed, 8 * fits.channels * width))
    return out


def _evaluate(fits: FitMap, at: structs.Samples, directions: _Directions, out: Floats) -> None:
    """A call a texel, with as little around it as there can be."""
    call = library().core.brdffit_eval
    sigma, x, y = (floats(name, getattr(fits, name)) for name in ("sigma", "x", "y"))
    fitted = fits.fitted.reshape(-1)
    lobes, channels, width = fits.lobes, fits.channels, 24 * at.count
    if sigma.shape[:-1] != fits.shape or x.shape[:-1] != fits.shape or y.shape != (*x.shape, lobes):
        raise DataError("sigma, x and y of shapes %s, %s and %s do not belong to texels of shape %s" % (
            sigma.shape, x.shape, y.shape, fits.shape), code="argument")
    model = library().model()
    names = _lobes.as_c(fits.distributions)
    if len(names) != lobes:
        raise DataError("sigma of %s does not belong to options of %d" % (_lobes.count_word(lobes), len(names)),
                        code="argument")
    model.distribution, model.lobes, model.distributions = names[0], lobes, ctypes.addressof(names)
    model.channels = channels
    words = np.frombuffer(memoryview(model).cast("B"), np.uintp)
    at_sigma, at_x, at_y = (getattr(structs.Model, name).offset // 8 for name in ("sigma", "x", "y"))
    kept = _terms_of(fits, model)
    terms = [(word, array.ctypes.data, step) for word, array, step in kept]
    error = structs.Error()
    model_argument, at_argument, error_argument = byref(model), byref(at), byref(error)
    sigma_start, x_start, y_start, to = (array.ctypes.data for array in (sigma, x, y, out))
    for first in range(0, len(out), _CHUNK):
        count = min(_CHUNK, len(out) - first)
        own = directions.lay_out(first, count)
        for i in range(count):
            texel = first + i
            if not fitted[texel]:
                out[texel] = np.nan
                continue
            words[at_sigma] = sigma_start + 8 * lobes * texel
            words[at_x] = x_start + 8 * channels * texel
            words[at_y] = y_start + 8 * channels * lobes * texel
            for at_term, start, step in terms:
                words[at_term] = start + step * texel
            for name, start in own:
                setattr(at, name, start + width * i)
            if call(model_argument, at_argument, to + out.strides[0] * texel, error_argument) != 0:
                place = tuple(int(j) for j in np.unravel_index(texel, fits.shape))
                raised = from_struct(error)
                raised.texel = place if own else None
                raise raised
