"""Arguments that several calls share: what they may be, and a clear error for what they may not. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Union

from .errors import OptionError

Path = Union[str, "os.PathLike[str]"]


def choose(name: str, value: str, choices: Sequence[str]) -> int:
    """Position of a word; a clear error for any other."""
    if not isinstance(value, str) or value not in choices:
        raise OptionError("%s must be one of %s, not %r" % (name, ", ".join(map(repr, choices)), value), code="option")
    return choices.index(value)


def positive(name: str, value: float) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError) as error:
        raise OptionError("%s must be a number, not %r" % (name, value), code="option") from error
    if not 0 < number < float("inf"):
        raise OptionError("%s must be finite and above 0, not %r" % (name, value), code="option")
    return number


def count_of(name: str, value: int | None, default: int) -> int:
    if value is None:
        return default
    if isinstance(value, bool) or not isinstance(value, int) and not hasattr(value, "__index__"):
        raise OptionError("%s must be a whole number of at least 1, not %r" % (name, value), code="option")
    number = value.__index__()
    if number < 1:
        raise OptionError("%s must be a whole number of at least 1, not %r" % (name, value), code="option")
    return number


def processors() -> int:
    """How many this process may use: the default number of threads."""
    try:
        return max(1, len(os.sched_getaffinity(0)))
    except AttributeError:  # not Linux
        return os.cpu_count() or 1
