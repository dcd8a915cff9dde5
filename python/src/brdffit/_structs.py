"""The structures and enumerations of include/brdffit.h and include/brdffit_io.h, and nothing else.

Every field stands in the header's order. tests/test_py_layout.py compiles a C program that prints the offset of each
field and compares. A later library of the same version number may know more fields: it goes by struct_size.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import ctypes
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_ssize_t, c_uint, c_void_p

NONE = ctypes.c_size_t(-1).value  # BRDFFIT_NONE: "does not apply"

# Enumerations: the position of a name is its value. Names are those of the C library's strings and of its JSON. What
# distributions there are is asked of the library (_ffi).
STATUS = ("ok", "argument", "option", "unsupported", "workspace", "value", "no_samples", "memory", "open", "read",
          "format")
FORM = ("directions", "angles", "coefficients")
QUANTITY = ("brdf", "radiance")
WEIGHTING = ("none", "column", "cosine", "solid-angle", "relative")
SKIP = ("zero_weight", "light_below_horizon", "view_below_horizon", "incidence")
NORM = ("l2", "l1", "linf")
ENGINE = ("moment", "socp")
ISA = ("auto", "base", "avx2", "avx512")
NORMALISE = ("max", "none")
PHASE = ("reduced", "search")
STOP = ("relative_gap", "absolute_gap", "resolution", "rounding", "budget", "memory", "cancelled",
        "contradiction")
DROP = ("masked", "absent", "cell_below_horizon", "saturated")
MISSING = ("marked", "value", "negative", "none")
VALUES = ("plain", "ccbrdf", "reflectance-factor")
DIRECTIONS = ("degrees", "radians", "elevation", "mirror-at-0", "light-travels", "y-up", "as-written")  # bits 1, 2, 4, ...
MISFIT = ("poor", "patterned")  # bits 1, 2
FORMAT = ("auto", "csv", "merl")
MERL_BINS = ("edge", "centre")
MERL_SAMPLING = ("table", "84", "directions")
TYPE = ("float64", "float32", "uint16")  # brdffit_type, in numpy's words
TEXEL_STATUS = ("certified", "open", "no_signal", "masked", "bad_value", "refused")
WARNINGS = ("unresolved", "flat", "unused", "at_limit")  # bits 1, 2, 4, 8


class Error(ctypes.Structure):
    """brdffit_error"""

    _fields_ = [
        ("status", c_int),
        ("message", c_char_p),
        ("sample", c_size_t),
        ("channel", c_size_t),
        ("line", c_size_t),
        ("column", c_size_t),
        ("value", c_double),
    ]


class Samples(ctypes.Structure):
    """brdffit_samples; arrays as bare addresses"""

    _fields_ = [
        ("struct_size", c_size_t),
        ("count", c_size_t),
        ("channels", c_size_t),
        ("form", c_int),
        ("quantity", c_int),
        ("light", c_void_p),
        ("view", c_void_p),
        ("normal", c_void_p),
        ("cos_light", c_void_p),
        ("cos_view", c_void_p),
        ("tan2_half", c_void_p),
        ("cos_difference", c_void_p),
        ("a", c_void_p),
        ("b", c_void_p),
        ("c", c_void_p),
        ("values", c_void_p),
        ("weights", c_void_p),
        ("tangent", c_void_p),
    ]


class Progress(ctypes.Structure):
    """brdffit_progress"""

    _fields_ = [("phase", c_int), ("boxes", c_size_t), ("e2", c_double), ("lower_bound", c_double)]


ProgressFunction = ctypes.CFUNCTYPE(c_int, c_void_p, POINTER(Progress))


class Box(ctypes.Structure):
    """brdffit_box"""

    _fields_ = [
        ("lobes", c_int),
        ("level", c_int),
        ("sigma_low", POINTER(c_double)),
        ("sigma_high", POINTER(c_double)),
        ("lower_bound", c_double),
    ]


BoxFunction = ctypes.CFUNCTYPE(None, c_void_p, POINTER(Box))


class Options(ctypes.Structure):
    """brdffit_options"""

    _fields_ = [
        ("struct_size", c_size_t),
        ("lobes", c_int),
        ("distribution", c_int),
        ("norm", c_int),
        ("normalise", c_int),
        ("engine", c_int),
        ("socp_every_box", c_int),
        ("sigma_min", c_double),
        ("sigma_max", c_double),
        ("exponent_min", c_double),
        ("exponent_max", c_double),
        ("relative_gap", c_double),
        ("absolute_gap", c_double),
        ("sigma_resolution", c_double),
        ("box_budget", c_size_t),
        ("max_incidence", c_double),
        ("isa", c_int),
        ("progress", ProgressFunction),
        ("progress_user", c_void_p),
        ("box", BoxFunction),
        ("box_user", c_void_p),
        ("distributions", c_void_p),
        ("fresnel", c_int),
        ("diffuse", c_int),
        ("masking", c_int),
        ("physical", c_int),
        ("anisotropic", c_int),
        ("anisotropy", c_double),
        ("tangent_angle", c_double),
        ("memory", c_size_t),
    ]


class Model(ctypes.Structure):
    """brdffit_model; arrays as bare addresses"""

    _fields_ = [
        ("struct_size", c_size_t),
        ("distribution", c_int),
        ("lobes", c_int),
        ("channels", c_size_t),
        ("sigma", c_void_p),
        ("x", c_void_p),
        ("y", c_void_p),
        ("distributions", c_void_p),
        ("fresnel", c_int),
        ("diffuse", c_int),
        ("f0", c_void_p),
        ("x_more", c_void_p),
        ("masking", c_int),
        ("anisotropy", c_void_p),
        ("tangent_angle", c_void_p),
    ]


class Lobe(ctypes.Structure):
    """brdffit_lobe"""

    _fields_ = [
        ("sigma", c_double),
        ("sigma_low", c_double),
        ("sigma_high", c_double),
        ("exponent", c_double),
        ("exponent_low", c_double),
        ("exponent_high", c_double),
        ("weight", c_double),
        ("effective_samples", c_double),
        ("warnings", c_uint),
        ("sigma_floor", c_double),
        ("sigma_x", c_double),
        ("sigma_y", c_double),
        ("tangent_angle", c_double),
    ]


class Result(ctypes.Structure):
    """brdffit_result; arrays as bare addresses"""

    _fields_ = [
        ("model", POINTER(Model)),
        ("lobe", POINTER(POINTER(Lobe))),
        ("channel_scale", c_void_p),
        ("rms", c_void_p),
        ("rms_total", c_double),
        ("e2", c_double),
        ("e2_error", c_double),
        ("lower_bound", c_double),
        ("gap", c_double),
        ("sum_of_squares", c_double),
        ("sigma_floor", c_double),
        ("sigma_tail", c_double),
        ("kkt_residual", c_double),
        ("stop", c_int),
        ("certified", c_int),
        ("boxes", c_size_t),
        ("nodes", c_size_t),
        ("programs_solved", c_size_t),
        ("programs_refused", c_size_t),
        ("programs_decided", c_size_t),
        ("distinct_c", c_size_t),
        ("channels_zero", c_size_t),
        ("channels_identical", c_size_t),
        ("samples_used", c_size_t),
        ("samples_skipped", POINTER(c_size_t)),
        ("e2_free", c_double),
        ("channels_at_limit", c_size_t),
        ("at_limit", c_void_p),
    ]


class Verification(ctypes.Structure):
    """brdffit_verification"""

    _fields_ = [
        ("level", c_double),
        ("proven", c_int),
        ("stop", c_int),
        ("boxes", c_size_t),
        ("leaves", c_size_t),
        ("solved", c_size_t),
        ("refused", c_size_t),
        ("decided", c_size_t),
        ("unproven", c_double),
    ]


class IntervalOptions(ctypes.Structure):
    """brdffit_interval_options"""

    _fields_ = [
        ("struct_size", c_size_t),
        ("level", c_double),
        ("noise", c_double),
        ("eta", c_double),
        ("tolerance", c_double),
        ("box_budget", c_size_t),
    ]


class Range(ctypes.Structure):
    """brdffit_range"""

    _fields_ = [("low", c_double), ("high", c_double), ("inner_low", c_double), ("inner_high", c_double), ("flags", c_size_t)]


class IntervalResult(ctypes.Structure):
    """brdffit_interval_result; arrays as bare addresses"""

    _fields_ = [
        ("threshold", c_double),
        ("e2", c_double),
        ("level", c_double),
        ("noise", c_double),
        ("degrees", c_double),
        ("sigma", c_void_p),
        ("exponent", c_void_p),
        ("x", c_void_p),
        ("y", c_void_p),
        ("f0", c_void_p),
        ("boxes", c_size_t),
        ("lobes", c_int),
        ("diffuse_columns", c_int),
        ("channels", c_size_t),
        ("complete", c_int),
        ("stopped", c_int),
    ]


class Texels(ctypes.Structure):
    """brdffit_texels; arrays as bare addresses"""

    _fields_ = [
        ("struct_size", c_size_t),
        ("count", c_size_t),
        ("values", c_void_p),
        ("type", c_int),
        ("scale", c_double),
        ("texel_stride", c_ssize_t),
        ("sample_stride", c_ssize_t),
        ("channel_stride", c_ssize_t),
        ("mask", c_void_p),
    ]


class TexelResults(ctypes.Structure):
    """brdffit_texel_results; arrays as bare addresses"""

    _fields_ = [
        ("struct_size", c_size_t),
        ("sigma", c_void_p),
        ("x", c_void_p),
        ("y", c_void_p),
        ("channel_scale", c_void_p),
        ("e2", c_void_p),
        ("lower_bound", c_void_p),
        ("sum_of_squares", c_void_p),
        ("status", c_void_p),
        ("stop", c_void_p),
        ("where", c_void_p),
        ("boxes", c_void_p),
        ("sigma_floor", c_void_p),
        ("f0", c_void_p),
        ("x_more", c_void_p),
    ]


class ManyStats(ctypes.Structure):
    """brdffit_many_stats"""

    _fields_ = [
        ("struct_size", c_size_t),
        ("texels", c_size_t),
        ("certified", c_size_t),
        ("open", c_size_t),
        ("masked", c_size_t),
        ("no_signal", c_size_t),
        ("bad_value", c_size_t),
        ("refused", c_size_t),
        ("equal", c_size_t),
        ("general", c_size_t),
        ("zero_channels", c_size_t),
        ("equal_channels", c_size_t),
        ("boxes", c_size_t),
        ("nodes", c_size_t),
        ("one_lobe_enough", c_size_t),
    ]


class IoOptions(ctypes.Structure):
    """brdffit_io_options"""

    _fields_ = [
        ("struct_size", c_size_t),
        ("format", c_int),
        ("quantity_set", c_int),
        ("quantity", c_int),
        ("merl_bins", c_int),
        ("merl_sampling", c_int),
        ("directions_only", c_int),
        ("directions", POINTER(Samples)),
        ("max_bytes", c_size_t),
        ("channels", c_char_p),
        ("columns", c_char_p),
        ("missing", c_int),
        ("values", c_int),
        ("directions_as", c_uint),
        ("reserved", c_int),
        ("missing_value", c_double),
        ("saturated", c_double),
        ("fault", c_char_p),
        ("fault_size", c_size_t),
    ]


class Note(ctypes.Structure):
    """brdffit_io_note"""

    _fields_ = [("text", c_char_p), ("warning", c_size_t)]


class Table(ctypes.Structure):
    """brdffit_table"""

    _fields_ = [
        ("samples", POINTER(Samples)),
        ("channel_names", POINTER(c_char_p)),
        ("lines", POINTER(c_size_t)),
        ("format", c_int),
        ("compressed", c_int),
        ("dropped", POINTER(c_size_t)),
        ("negative", c_size_t),
        ("dims", c_size_t * 3),
        ("rows", c_size_t),
        ("merl_bins", c_int),
        ("merl_sampling", c_int),
        ("sums", c_void_p),
        ("notes", POINTER(POINTER(Note))),
        ("note_count", c_size_t),
    ]


# Name in C of each structure, for the test of the layout.
C_NAMES = {
    "brdffit_error": Error,
    "brdffit_samples": Samples,
    "brdffit_progress": Progress,
    "brdffit_box": Box,
    "brdffit_options": Options,
    "brdffit_model": Model,
    "brdffit_lobe": Lobe,
    "brdffit_result": Result,
    "brdffit_verification": Verification,
    "brdffit_interval_options": IntervalOptions,
    "brdffit_range": Range,
    "brdffit_interval_result": IntervalResult,
    "brdffit_texels": Texels,
    "brdffit_texel_results": TexelResults,
    "brdffit_many_stats": ManyStats,
    "brdffit_io_options": IoOptions,
    "brdffit_io_note": Note,
    "brdffit_table": Table,
}
