"""Which lobes a fit has. What a distribution is called, and by which parameter it is known, the library says.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import ctypes
import functools
import itertools
from collections.abc import Sequence
from typing import Any

from ._arguments import choose
from ._ffi import library
from .errors import OptionError

MOST = 3  # BRDFFIT_MAX_LOBES
_NUMBERS = {1: "one", 2: "two", 3: "three"}


def distributions() -> dict[str, str]:
    """Every distribution, and the parameter that it is known by: "sigma" (roughness) or "exponent"."""
    return {one.name: one.parameter for one in library().distributions}


@functools.lru_cache(maxsize=1)
def _titles() -> dict[str, str]:
    return {one.name: one.title for one in library().distributions}


@functools.lru_cache(maxsize=1)
def _values() -> dict[str, int]:
    return {one.name: value for value, one in enumerate(library().distributions)}


def title(name: str) -> str:
    """As it stands in a sentence: "Ashikhmin-Shirley"."""
    return _titles()[name]


def value(name: str) -> int:
    """Of the enumeration in C."""
    return _values()[name]


def by_exponent(name: str) -> bool:
    return library().distributions[value(name)].parameter == "exponent"


@functools.lru_cache(maxsize=4096)
def parameters(names: tuple[str, ...]) -> tuple[str, ...]:
    """Of each lobe, "sigma" or "exponent"."""
    return tuple("exponent" if by_exponent(name) else "sigma" for name in names)


@functools.lru_cache(maxsize=4096)
def as_c(names: tuple[str, ...]) -> Any:
    """An array of the enumeration, which stays where it is: structures that point to it are kept as bytes."""
    return (ctypes.c_int * len(names))(*map(value, names))


def from_c(address: int, count: int) -> tuple[str, ...]:
    """Names of what a result points to."""
    known = library().distributions
    return tuple(known[at].name for at in (ctypes.c_int * count).from_address(address))


def group(names: Sequence[str]) -> tuple[str, ...]:
    """Lobes of one distribution together, in the order of their first mention: the order of a result."""
    return tuple(sorted(names, key=list(names).index))


def kinds(names: Sequence[str]) -> list[tuple[str, slice]]:
    """Each distribution, and its lobes, of a list in the order of a result."""
    out, first = [], 0
    for name, same in itertools.groupby(names):
        last = first + len(list(same))
        out.append((name, slice(first, last)))
        first = last
    return out


def asked(lobes: Any, distribution: Any) -> tuple[str, ...]:
    """What `Options.lobes` and `Options.distribution` say together, in the order of a result. The names are checked; a
    number that is none, or too large, is for the library to refuse."""
    known = tuple(_values())
    if isinstance(lobes, (list, tuple)):
        for name in lobes:
            choose("lobes", name, known)
        if not 1 <= len(lobes) <= MOST:
            raise OptionError("lobes must be 1 to %d names, not %d" % (MOST, len(lobes)), code="option")
        if distribution is not None:
            raise OptionError("lobes %r says what each lobe is: distribution %r does not go with it, only with a number" % (
                list(lobes), distribution), code="option")
        return group(lobes)
    if distribution is None:
        distribution = library().distributions[library().options().distribution].name
    choose("distribution", distribution, known)
    try:
        count = int(lobes)
    except (TypeError, ValueError, OverflowError) as error:
        raise OptionError("lobes must be a whole number, or a list of names, not %r" % (lobes,), code="option") from error
    return (distribution,) * count if 0 < count <= MOST else (distribution,)


def family(names: Sequence[str]) -> str:
    """ "Beckmann fit with 2 lobes", "fit of one Beckmann and one GGX lobe"."""
    if len(set(names)) == 1:
        return "%s fit with %s" % (title(names[0]), count_word(len(names)))
    return "fit of " + each(names)


def count_word(count: int) -> str:
    return "%d lobe%s" % (count, "" if count == 1 else "s")


def each(names: Sequence[str]) -> str:
    """ "one Beckmann, one GGX and one Ward lobe", "two GGX lobes and one Ward lobe"."""
    parts = [(at.stop - at.start, name) for name, at in kinds(names)]
    out = []
    for i, (count, name) in enumerate(parts):
        # The noun serves the next kind too, if in its number.
        noun = "" if i + 1 < len(parts) and (parts[i + 1][0] == 1) == (count == 1) else " lobe" if count == 1 else " lobes"
        out.append("%s %s%s" % (_NUMBERS[count], title(name), noun))
    return out[0] if len(out) == 1 else ", ".join(out[:-1]) + " and " + out[-1]


def letter(name: str) -> str:
    """Of the parameter."""
    return "n" if by_exponent(name) else "σ"


def letters(names: Sequence[str]) -> str:
    """ "σ", "n", or "σ and n"."""
    return " and ".join(sorted({letter(name) for name in names}, reverse=True))


def each_lobe(names: Sequence[str]) -> list[str]:
    """ "lobe"; "sharper lobe", "wider lobe"; "GGX lobe", "sharper Ward lobe"."""
    sides = {1: ("",), 2: ("sharper ", "wider "), 3: ("sharpest ", "middle ", "widest ")}
    found = kinds(names)
    return [side + ("lobe" if len(found) == 1 else title(name) + " lobe")
            for name, at in found for side in sides[at.stop - at.start]]
