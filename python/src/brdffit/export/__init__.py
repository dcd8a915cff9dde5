"""Fits as materials of renderers: `Fit.export`. SPDX-License-Identifier: MIT

`conventions` has what each target means by its numbers, `refit` what it can show, and one module each how it is written.
"""
from __future__ import annotations

import dataclasses
import os
import re

from .._arguments import Path
from ..errors import OptionError, UnsupportedError
from ..samples import Samples
from . import graphs, scenes, shaders, sums, tables
from .conventions import TARGETS, Target
from .fitted import Fit
from .places import channels, places
from .principled import Gltf, OpenPbr, Usd
from .refit import Again, Shown, shown, stretched
from .spaces import Conductors, Free, Sum
from .words import lines

__all__ = ["TARGETS", "Exported", "Target", "export"]


@dataclasses.dataclass(frozen=True)
class Exported:
    """What was written.

    path: the file; target: its kind, as `export` takes it
    exact: whether the target has the fit's model, so that values are the fit's but for rounding
    certified: whether what is shown is proven to be the best of the target's form, for the measurement or for the fit
    error: relative RMS of radiance from the measurement, or from the fit where none was given; fit_error: the fit's own;
        from_fit: from the fit. By the target's published formulas
    lines: the same in words, as the file has them
    """

    path: str
    target: str
    exact: bool
    certified: bool
    error: float
    fit_error: float
    from_fit: float
    lines: tuple[str, ...]
    shown: Shown | None = dataclasses.field(default=None, repr=False)


def export(fit: Fit, target: str, path: Path, samples: Samples | None, names: tuple[str, ...] | None, scene: bool,
           again: Again) -> Exported:
    """See `Fit.export`. again: brdffit.fit."""
    if target not in TARGETS:
        raise OptionError("target must be one of %s, not %r" % (", ".join(TARGETS), target), code="option")
    if scene and target not in ("mitsuba", "blender"):
        raise OptionError("a scene can be had for mitsuba and blender, not for %s" % target, code="option")
    to, file = TARGETS[target], os.fspath(path)
    if to.space in ("code", "table") and stretched(fit):
        raise UnsupportedError("the fit has an anisotropic lobe, which %s has not; fit without --anisotropic (anisotropic=)" % (
            to.title), code="unsupported")
    chosen = channels(fit, names)
    at = places(fit, samples, chosen)
    found = None if to.space in ("code", "table") else shown(fit, to, at, chosen, again)
    said = lines(fit, to, found, at.measured)
    name = re.sub(r"\W+", "_", os.path.basename(file).split(".")[0]) or "material"
    if target == "merl":
        tables.merl(fit, chosen, file)
    elif target == "rgl":
        tables.rgl(fit, chosen, file, "; ".join(said))
    else:
        tables.write_text(file, _text(fit, to, found, chosen, name if not name[0].isdigit() else "m" + name, said, scene))
    if found is None:
        error = at.rms(at.fitted, at.values)
        return Exported(file, target, True, fit.certified, error, error, 0.0, tuple(said))
    return Exported(file, target, found.exact, found.certified, found.error, found.fit_error, found.from_fit, tuple(said), found)


def _text(fit: Fit, to: Target, found: Shown | None, chosen: list[int], name: str, said: list[str], scene: bool) -> str:
    if found is None:
        return shaders.code(fit, chosen, to.name, said)
    space, p = found.space, found.parameters
    if to.name == "osl":
        assert isinstance(space, Free)
        if stretched(fit):  # the closures' own isotropic lobes
            return "/* %s */\n%s" % ("\n * ".join(said), shaders.closures(space, p, name))
        return shaders.code(fit, chosen, "osl", said) + "\n" + shaders.closures(space, p, name)
    if isinstance(space, Sum):
        if to.name == "mitsuba":
            return _xml(scenes.mitsuba(sums.mitsuba(space, p, name), name, scene), said)
        if to.name == "cycles":
            return _xml("<cycles>\n%s\n</cycles>\n" % sums.cycles(space, p, name), said)
        doc = "\n".join(said).replace("\\", "/").replace('"', "'")
        return '"""%s"""\n%s' % (doc, scenes.blender(sums.blender(space, p, name), scene))
    if isinstance(space, Conductors):
        return "".join("# %s\n" % line for line in said) + sums.pbrt(space, p, name) + "\n"
    if isinstance(space, Free):
        return graphs.materialx(space, p, name, said)
    if isinstance(space, Gltf):
        return graphs.gltf(space, p, name, said)
    if isinstance(space, Usd):
        return graphs.usd(space, p, name, said)
    assert isinstance(space, OpenPbr)
    return graphs.openpbr(space, p, name, said)


def _xml(text: str, said: list[str]) -> str:
    return "<!--\n%s\n-->\n%s" % ("\n".join("  " + line for line in said), text)
