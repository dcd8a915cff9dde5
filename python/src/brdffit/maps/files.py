"""Maps in files, as `brdffit map` writes them. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import functools
import io
import json
import os
import pathlib
import tempfile
import zipfile
from collections.abc import Callable
from typing import IO, TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .. import _terms
from .._arguments import choose
from .._arrays import Floats, freeze
from .._version import __version__
from ..errors import DataError, FileError, OptionError
from ..options import Options
from .results import NO_STOP, STATUS

if TYPE_CHECKING:
    from .fitmap import FitMap

SCHEMA = "brdffit.map/1"
_DESCRIPTION = "map.json"
# Members of map.json that are options of the same name, behind the ranges.
_ASKED = ("relative_gap", "absolute_gap", "sigma_resolution", "box_budget", "max_incidence")
_FURTHER = ("f0", "x_more")
_REQUIRED = ("sigma", "x", "y", "e2", "lower_bound", "status")


def _fields(fits: FitMap) -> dict[str, npt.NDArray[Any]]:
    exponent = fits.exponent
    further = {name: array for name, array in (("f0", fits.f0), ("x_more", fits.x_more)) if array is not None}
    return {"sigma": fits.sigma, **({} if exponent is None else {"exponent": exponent}), "x": fits.x, "y": fits.y,
            "e2": fits.e2, "lower_bound": fits.lower_bound, **further, "status": fits.status}


def describe(fits: FitMap) -> dict[str, Any]:
    """map.json: nothing in it depends on threads, tiles or time."""
    counts = fits.counts
    known = [name for name in STATUS if name != "not_reached" or counts[name]]
    size = {"height": fits.shape[0], "width": fits.shape[1]} if len(fits.shape) == 2 else {"shape": list(fits.shape)}
    o = fits.options
    ranges = {"sigma_range": o.sigma_searched, **({"exponent_range": o.exponent_range} if "exponent" in o.parameters else {})}
    names = list(o.distributions)
    one = names[0] if len(set(names)) == 1 else None
    return {"schema": SCHEMA, "version": __version__, "samples": fits.samples, **size, "channels": fits.channels,
            "lobes": fits.lobes, "distribution": one, "distributions": names,
            **{kind: getattr(o, kind) for kind in _terms.DEFAULTS}, "norm": o.norm, "normalise": o.normalise,
            **{name: list(ends) for name, ends in ranges.items()}, **{name: getattr(o, name) for name in _ASKED},
            "quantity": fits.quantity,
            "status": {str(STATUS.index(name)): name for name in known},
            "texels": {name: counts[name] for name in known}}


def _text(value: Any) -> str:
    """JSON as the command line writes it: numbers with 17 digits."""
    if isinstance(value, dict):
        return "{%s}" % ",".join("%s:%s" % (json.dumps(key), _text(one)) for key, one in value.items())
    if isinstance(value, list):
        return "[%s]" % ",".join(map(_text, value))
    return "%.17g" % value if isinstance(value, float) else json.dumps(value)


def _json(fits: FitMap) -> bytes:
    return (_text(describe(fits)) + "\n").encode()


def _replace(path: pathlib.Path, write: Callable[[IO[bytes]], None]) -> None:
    """A file that appears whole or not at all."""
    handle, name = tempfile.mkstemp(prefix="." + path.name, dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            write(file)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def save(fits: FitMap, path: str | os.PathLike[str], format: str) -> None:
    target = pathlib.Path(path)
    choose("format", format, ("npy", "pfm"))
    try:
        if target.suffix == ".npz":
            if format != "npy":
                raise OptionError("format %r needs a folder, not %s" % (format, target), code="option")
            _replace(target, lambda file: _write_npz(fits, file))
            return
        if format == "pfm" and len(fits.shape) != 2:
            raise OptionError("format 'pfm' needs two spatial axes, not shape %s" % (fits.shape,), code="option")
        target.mkdir(exist_ok=True)
        for name, array in _fields(fits).items():
            if format == "pfm":
                _write_pfms(target, name, array)
            else:
                _replace(target / (name + ".npy"), functools.partial(np.save, arr=array))
        _replace(target / _DESCRIPTION, lambda file: _write(file, _json(fits)))
    except OSError as error:
        if isinstance(error, FileError):
            raise
        raise FileError("cannot write (%s)" % (error.strerror or error), code="open", path=str(target)) from error


def _write(file: IO[bytes], data: bytes) -> None:
    file.write(data)


def _write_npz(fits: FitMap, file: IO[bytes]) -> None:
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for name, array in _fields(fits).items():
            with archive.open(name + ".npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.ascontiguousarray(array))
        archive.writestr(_DESCRIPTION, _json(fits))


# ---- PFM -------------------------------------------------------------------


def _directed(name: str, array: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """float32, e2 not below and lower_bound not above what they were."""
    with np.errstate(over="ignore"):
        near = array.astype(np.float32)
    wide = near.astype(np.float64)
    if name == "e2":
        near = np.where(wide < array, np.nextafter(near, np.float32(np.inf)), near)
    elif name == "lower_bound":
        near = np.where(wide > array, np.nextafter(near, np.float32(0)), near)
    return near


def _write_pfms(folder: pathlib.Path, name: str, array: npt.NDArray[Any]) -> None:
    """Three channels are a colour image; otherwise each has a file, counted from 1."""
    values = _directed(name, array)
    colour = (name == "x" or array.ndim == 4) and array.shape[2] == 3
    images: dict[str, npt.NDArray[np.float32]] = {}
    if values.ndim == 2 or colour and name == "x":
        images[name] = values
    elif colour:
        images.update({"%s_%d" % (name, p + 1): values[..., p] for p in range(values.shape[3])})
    elif values.ndim == 4:
        images.update({"%s_%d_%d" % (name, k + 1, p + 1): values[..., k, p] for k in range(values.shape[2])
                       for p in range(values.shape[3])})
    elif values.shape[2] == 1:
        images[name] = values[..., 0]
    else:
        images.update({"%s_%d" % (name, i + 1): values[..., i] for i in range(values.shape[2])})
    for stem, image in images.items():
        header = "%s\n%d %d\n-1.0\n" % ("PF" if image.ndim == 3 else "Pf", image.shape[1], image.shape[0])
        data = header.encode() + np.ascontiguousarray(image[::-1], dtype="<f4").tobytes()
        _replace(folder / (stem + ".pfm"), functools.partial(_write, data=data))


# ---- Read ------------------------------------------------------------------


def _read(path: pathlib.Path) -> tuple[dict[str, npt.NDArray[Any]], dict[str, Any]]:
    if path.suffix == ".npz":
        with zipfile.ZipFile(path) as archive:
            if _DESCRIPTION not in archive.namelist():
                raise DataError("it has no %s, which says what the maps are: load the folder that `brdffit map` writes"
                                % _DESCRIPTION, code="format", path=str(path))
            members = {name[:-4]: np.load(io.BytesIO(archive.read(name)), allow_pickle=False)
                       for name in archive.namelist() if name.endswith(".npy")}
            return members, json.loads(archive.read(_DESCRIPTION))
    about = json.loads((path / _DESCRIPTION).read_text())
    names = (*_REQUIRED, *(name for name in _FURTHER if (path / (name + ".npy")).exists()))
    return {name: np.load(path / (name + ".npy"), allow_pickle=False) for name in names}, about


def load(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The members of a FitMap."""
    target = pathlib.Path(path)
    try:
        arrays, about = _read(target)
    except OSError as error:
        raise FileError("cannot open (%s)" % error.strerror, code="open", path=str(error.filename)) from error
    except (zipfile.BadZipFile, ValueError, EOFError) as error:
        if isinstance(error, DataError):
            raise
        raise DataError("these are no maps (%s)" % error, code="format", path=str(target)) from error
    return _members(arrays, about, target)


def _options(about: dict[str, Any], lobes: int, path: pathlib.Path) -> Options:
    """What was asked for: where the proof holds is among it."""
    try:
        ranges: dict[str, Any] = {name: tuple(about[name]) for name in ("sigma_range", "exponent_range") if name in about}
        names = about.get("distributions") or [about["distribution"]] * lobes  # maps from before there were lists
        options = Options(lobes=names, **{name: about[name] for name in ("norm", "normalise", *_ASKED)}, **ranges,
                          **{kind: about.get(kind, name) for kind, name in _terms.DEFAULTS.items()})
        if options.lobe_count != lobes:
            raise ValueError("%d lobes, and the distributions of %d" % (lobes, options.lobe_count))
        if "sigma" not in options.parameters:  # its range is that of the exponent in other words
            options = options.replace(sigma_range=Options().sigma_range)
        return options._plain()
    except (KeyError, TypeError, ValueError, OptionError) as error:
        raise DataError("%s does not say what was asked for (%s)" % (_DESCRIPTION, error), code="format",
                        path=str(path)) from error


def _further(options: Options, channels: int, lobes: int) -> dict[str, tuple[int, int]]:
    """Maps that the model has beside the required ones, and their depth."""
    more = _terms.more_columns(options.diffuse)
    return {**({"f0": (channels, lobes)} if options.fresnel != "none" else {}),
            **({"x_more": (channels, more)} if more else {})}


def _members(arrays: dict[str, npt.NDArray[Any]], about: dict[str, Any], path: pathlib.Path) -> dict[str, Any]:
    missing = [name for name in _REQUIRED if name not in arrays]
    if about.get("schema") != SCHEMA or missing:
        raise DataError("this is not a map of schema %s" % SCHEMA if not missing else "it has no %s" % missing[0],
                        code="format", path=str(path))
    spatial, channels, lobes = arrays["status"].shape, int(about["channels"]), int(about["lobes"])
    options = _options(about, lobes, path)
    further = _further(options, channels, lobes)
    for name, depth in (("sigma", (lobes,)), ("x", (channels,)), ("y", (channels, lobes)), ("e2", ()),
                        ("lower_bound", ()), *further.items()):
        if name not in arrays:
            raise DataError("it has no %s" % name, code="format", path=str(path))
        if arrays[name].shape != (*spatial, *depth) or arrays[name].dtype != np.float64:
            raise DataError("%s is %s of shape %s, not float64 of %s" % (
                name, arrays[name].dtype, arrays[name].shape, (*spatial, *depth)), code="format", path=str(path))
    nothing: Floats = np.full(spatial, np.nan)
    kept = {name: arrays[name] for name in (*_REQUIRED, *further)}
    kept.update(channel_scale=np.full((*spatial, channels), np.nan), sum_of_squares=nothing,
                stop=np.full(spatial, NO_STOP, np.uint8), where=np.full(spatial, -1, np.intp),
                boxes=np.zeros(spatial, np.intp), sigma_floor=nothing)
    return {**{name: freeze(array) for name, array in kept.items()}, "samples": int(about["samples"]),
            "samples_skipped": {}, "quantity": str(about["quantity"]), "options": options,
            "stats": {name: int(count) for name, count in about["texels"].items()}, "seconds": 0.0}
