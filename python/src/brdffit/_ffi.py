"""The shared library: where it is, whether it is the right one, and the types of its functions.

Looked for in this order: the environment's BRDFFIT_LIBRARY (a path), the library inside this package (wheels and
editable installations), the system's. One that was found but does not fit is an error, never a reason to look on:
what runs must be what was asked for.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import ctypes
import ctypes.util
import functools
import importlib.resources
import os
import pathlib
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_void_p
from typing import Any, NamedTuple

from . import _structs as structs
from ._version import __version__

ENVIRONMENT = "BRDFFIT_LIBRARY"
_LIBRARY_NAMES = ("libbrdffit.so", "libbrdffit.dylib", "brdffit.dll")


class LibraryError(ImportError):
    """The C library is missing or is not the one that this package was written for."""


def _in_package() -> str | None:
    # A package is a directory on disk or nothing can be loaded from it.
    folder = importlib.resources.files(__package__) / "_lib"
    for name in _LIBRARY_NAMES:
        path = pathlib.Path(str(folder / name))
        if path.is_file():
            return str(path)
    return None


def find() -> str:
    """Path (or system name) of the library that is to be loaded."""
    path = os.environ.get(ENVIRONMENT) or _in_package() or ctypes.util.find_library("brdffit")
    if path is None:
        raise LibraryError(
            "the C library of brdffit was found neither in this package nor on the system; install the package with "
            "pip, or set %s to the path of libbrdffit.so" % ENVIRONMENT)
    return path


def _open(path: str) -> ctypes.CDLL:
    try:
        return ctypes.CDLL(path)
    except OSError as error:
        raise LibraryError("cannot load the C library of brdffit: %s" % error) from error


def _open_io(core: ctypes.CDLL, path: str) -> ctypes.CDLL:
    """File readers: in the same library (wheels), or in the one that lies beside it."""
    if hasattr(core, "brdffit_io_read"):
        return core
    beside = path.replace("libbrdffit.", "libbrdffit_io.")
    if beside != path and os.path.exists(beside):
        return _open(beside)
    name = ctypes.util.find_library("brdffit_io")
    if name is None:
        raise LibraryError("%s has no file readers, and libbrdffit_io is not beside it" % path)
    return _open(name)


_PROTOTYPES: dict[str, tuple[Any, list[Any]]] = {
    "brdffit_version": (c_char_p, []),
    "brdffit_status_string": (c_char_p, [c_int]),
    "brdffit_skip_string": (c_char_p, [c_int]),
    "brdffit_distribution_string": (c_char_p, [c_int]),
    "brdffit_distribution_title": (c_char_p, [c_int]),
    "brdffit_parameter_string": (c_char_p, [c_int]),
    "brdffit_norm_string": (c_char_p, [c_int]),
    "brdffit_engine_string": (c_char_p, [c_int]),
    "brdffit_isa_string": (c_char_p, [c_int]),
    "brdffit_fresnel_string": (c_char_p, [c_int]),
    "brdffit_diffuse_string": (c_char_p, [c_int]),
    "brdffit_masking_string": (c_char_p, [c_int]),
    "brdffit_diffuse_columns": (c_int, [c_int]),
    "brdffit_isa_supported": (c_int, [c_int]),
    "brdffit_stop_string": (c_char_p, [c_int]),
    "brdffit_weighting_string": (c_char_p, [c_int]),
    "brdffit_weights_size": (c_size_t, [c_size_t, c_size_t, c_int]),
    "brdffit_weights": (c_int, [POINTER(structs.Samples), c_int, c_double, c_void_p, c_size_t, c_void_p,
                                POINTER(structs.Error)]),
    "brdffit_weights_effective": (c_double, [c_void_p, c_size_t]),
    "brdffit_weights_crowded": (c_int, [POINTER(structs.Samples), c_void_p, c_void_p, c_size_t]),
    "brdffit_samples_init_sized": (None, [c_void_p, c_size_t]),
    "brdffit_options_init_sized": (None, [c_void_p, c_size_t]),
    "brdffit_model_init_sized": (None, [c_void_p, c_size_t]),
    "brdffit_workspace_size": (c_size_t, [c_size_t, c_size_t, POINTER(structs.Options)]),
    "brdffit_fit": (c_int, [POINTER(structs.Samples), POINTER(structs.Options), c_void_p, c_size_t,
                            POINTER(c_void_p), POINTER(structs.Error)]),
    "brdffit_fit_new": (c_int, [POINTER(structs.Samples), POINTER(structs.Options),
                                POINTER(POINTER(structs.Result)), POINTER(structs.Error)]),
    "brdffit_result_free": (None, [POINTER(structs.Result)]),
    "brdffit_verify": (c_int, [POINTER(structs.Samples), POINTER(structs.Options), c_double, c_void_p, c_size_t,
                               POINTER(POINTER(structs.Verification)), POINTER(structs.Error)]),
    "brdffit_intervals_workspace_size": (c_size_t, [c_size_t, c_size_t, POINTER(structs.Options)]),
    "brdffit_intervals": (c_int, [POINTER(structs.Samples), POINTER(structs.Options), POINTER(structs.Model), c_double,
                                  POINTER(structs.IntervalOptions), c_void_p, c_size_t,
                                  POINTER(POINTER(structs.IntervalResult)), POINTER(structs.Error)]),
    "brdffit_inspect": (c_int, [POINTER(structs.Samples), POINTER(structs.Options), POINTER(c_size_t),
                                POINTER(c_size_t), c_size_t, POINTER(structs.Error)]),
    "brdffit_eval": (c_int, [POINTER(structs.Model), POINTER(structs.Samples), c_void_p, POINTER(structs.Error)]),
    "brdffit_quality": (c_int, [POINTER(structs.Samples), POINTER(structs.Options), c_void_p, c_void_p, c_void_p, c_void_p,
                                POINTER(structs.Error)]),
    "brdffit_azimuth_share": (c_int, [POINTER(structs.Samples), POINTER(structs.Options), POINTER(structs.Model), c_void_p,
                                      POINTER(c_double), POINTER(structs.Error)]),
    "brdffit_f0_interval": (c_int, [POINTER(structs.Samples), POINTER(structs.Options), POINTER(structs.Model), c_void_p,
                                    c_void_p, POINTER(structs.Error)]),
    "brdffit_texel_status_string": (c_char_p, [c_int]),
    "brdffit_plan_size": (c_size_t, [POINTER(structs.Samples), POINTER(structs.Options)]),
    "brdffit_plan_init": (c_int, [POINTER(structs.Samples), POINTER(structs.Options), c_void_p, c_size_t,
                                  POINTER(c_void_p), POINTER(structs.Error)]),
    "brdffit_many_workspace_size": (c_size_t, [c_void_p]),
    "brdffit_texels_init_sized": (None, [c_void_p, c_size_t, c_void_p]),
    "brdffit_texel_results_init_sized": (None, [c_void_p, c_size_t]),
    "brdffit_many_stats_init_sized": (None, [c_void_p, c_size_t]),
    "brdffit_fit_many": (c_int, [c_void_p, POINTER(structs.Texels), POINTER(structs.TexelResults), c_void_p, c_size_t,
                                 POINTER(structs.ManyStats), POINTER(structs.Error)]),
}
_IO_PROTOTYPES: dict[str, tuple[Any, list[Any]]] = {
    "brdffit_io_drop_string": (c_char_p, [c_int]),
    "brdffit_io_options_init_sized": (None, [c_void_p, c_size_t]),
    "brdffit_io_read": (c_int, [c_char_p, POINTER(structs.IoOptions), POINTER(POINTER(structs.Table)),
                                POINTER(structs.Error)]),
    "brdffit_io_free": (None, [POINTER(structs.Table)]),
    "brdffit_io_protocol84": (None, [c_void_p, c_void_p]),
    "brdffit_io_column_words": (c_char_p, [c_size_t, POINTER(c_char_p)]),
}


def _declare(library: ctypes.CDLL, prototypes: dict[str, tuple[Any, list[Any]]], path: str) -> None:
    for name, (result, arguments) in prototypes.items():
        try:
            function = getattr(library, name)
        except AttributeError as error:
            raise LibraryError("%s is not the library of brdffit %s: it has no %s" % (path, __version__, name)) from error
        function.restype = result
        function.argtypes = arguments


def _check_version(core: ctypes.CDLL, path: str) -> None:
    version = core.brdffit_version().decode()
    if version.split(".")[:2] != __version__.split(".")[:2]:
        raise LibraryError("%s is version %s; this package needs %s" % (path, version, __version__))


class Distribution(NamedTuple):
    """What the library says of one."""

    name: str
    title: str
    parameter: str


def _distributions(core: ctypes.CDLL) -> tuple[Distribution, ...]:
    """In the order of brdffit_distribution, up to the one that is "unknown"."""
    out: list[Distribution] = []
    while True:
        one = Distribution(*(function(len(out)).decode() for function in (
            core.brdffit_distribution_string, core.brdffit_distribution_title, core.brdffit_parameter_string)))
        if one.name == "unknown":
            return tuple(out)
        out.append(one)


def _names(string: Any) -> tuple[str, ...]:
    """In the order of an enumeration, up to the one that is "unknown"."""
    out: list[str] = []
    while (name := string(len(out)).decode()) != "unknown":
        out.append(name)
    return tuple(out)


class Library:
    """The loaded library: `core` (brdffit.h) and `io` (brdffit_io.h), which may be one."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.core = _open(path)
        self.io = _open_io(self.core, path)
        _declare(self.core, _PROTOTYPES, path)
        _declare(self.io, _IO_PROTOTYPES, path)
        _check_version(self.core, path)
        self.distributions = _distributions(self.core)
        self.terms = {kind: _names(getattr(self.core, "brdffit_%s_string" % kind)) for kind in ("fresnel", "diffuse", "masking")}

    @property
    def version(self) -> str:
        return str(self.core.brdffit_version().decode())

    def options(self) -> structs.Options:
        out = structs.Options()
        self.core.brdffit_options_init_sized(byref(out), ctypes.sizeof(out))
        return out

    def samples(self) -> structs.Samples:
        out = structs.Samples()
        self.core.brdffit_samples_init_sized(byref(out), ctypes.sizeof(out))
        return out

    def model(self) -> structs.Model:
        out = structs.Model()
        self.core.brdffit_model_init_sized(byref(out), ctypes.sizeof(out))
        return out

    def io_options(self) -> structs.IoOptions:
        out = structs.IoOptions()
        self.io.brdffit_io_options_init_sized(byref(out), ctypes.sizeof(out))
        return out


@functools.lru_cache(maxsize=1)
def library() -> Library:
    """The library, loaded once."""
    return Library(find())
