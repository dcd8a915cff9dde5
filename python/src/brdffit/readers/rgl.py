"""Materials of the EPFL RGL database, for users: `_rgl` reads and evaluates them. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .._arguments import Path, choose
from .._arrays import Floats, freeze
from ..errors import OptionError
from ..merl import MerlTable, cell_directions
from ..samples import Samples
from ._rgl import Channels, Mask, Measurement
from ._tensor import TensorFile

MERL_SHAPE = (90, 90, 180)


class RGLMaterial(Measurement):
    """An isotropic measured material; make one with `load_rgl`.

    channels: ("r", "g", "b") (linear sRGB), or wavelengths such as "400nm"
    wavelengths: in nm, or None for an RGB file
    theta_i: the angles of light that were measured, radians
    description: what the file says of itself
    """

    def __repr__(self) -> str:
        return "<RGLMaterial %s: %s, %d channels, light at %s degrees>" % (
            self.file, self.description, len(self.channels), ", ".join("%.3g" % t for t in np.degrees(self.theta_i)))

    # ---- Anywhere

    def eval(self, light: npt.ArrayLike, view: npt.ArrayLike, *, clip: bool = True, channels: Channels = None) -> Floats:
        """f_r in 1/sr at directions ... x 3 around +z (broadcast against each other, of any length): ... x K. 0 on and
        below the horizon. Where the instrument saw nothing this is what the reference makes of its zeros: `measured`
        tells. clip: colours outside of sRGB have negative channels; raise them to 0, as the reference does."""
        return self._evaluate(light, view, clip, channels)

    def measured(self, light: npt.ArrayLike, view: npt.ArrayLike) -> Mask:
        """Whether everything that `eval` interpolates at these directions (... x 3) was measured; not below the horizon."""
        return np.asarray(~np.isnan(self.lookup(light, view, channels=[0])[..., 0]))

    def lookup(self, light: npt.ArrayLike, view: npt.ArrayLike, *, clip: bool = True, channels: Channels = None) -> Floats:
        """`eval`, but NaN below the horizon and where nothing was measured, as MerlTable.lookup."""
        return self._known(light, view, clip, channels)

    # ---- As samples and as tables

    def samples(self, at: str | tuple[npt.ArrayLike, npt.ArrayLike] = "measured", *, clip: bool = True,
                channels: Channels = None) -> Samples:
        """Samples to fit. at: "measured" (the instrument's own directions, nothing interpolated, each once; they crowd where
        the material reflects most, so their weights are the solid angles that they stand for: `Samples.weighted` changes
        that), "84" (the paper's directions), or (light, view). What was not measured is left out and counted in `dropped`,
        as are repetitions."""
        return Samples(**self._members(at, clip=clip, channels=channels))

    def to_merl(self, path: Path | None = None, *, bins: str = "edge", channels: Channels = None,
                reciprocal: bool = True) -> MerlTable:
        """The material resampled to MERL's layout, 90 x 90 x 180 x 3, NaN where nothing was measured; written to `path`
        when one is given. bins: which angle an entry stands for. channels: three indices; a spectral file needs them.
        reciprocal: MERL's layout takes f_r(i, o) = f_r(o, i) for granted and a measurement is not quite so; take the mean
        of both where both were measured (otherwise, and with False where it is there, the first)."""
        chosen = self._chosen(channels)
        if len(chosen) != 3:
            raise OptionError("MERL's layout has 3 channels: choose three of the file's %d with channels=" %
                              len(self.channels), code="option", path=self.file)
        choose("bins", bins, ("edge", "centre"))
        values = np.empty((*MERL_SHAPE, 3))
        for row in range(MERL_SHAPE[0]):
            light, view = cell_directions(MERL_SHAPE, bins, row)
            here = self.lookup(light, view, channels=chosen)
            there = self.lookup(view, light, channels=chosen)
            both = 0.5 * (here + there) if reciprocal else here
            values[row] = np.where(np.isnan(both), np.where(np.isnan(here), there, here), both)
        table = MerlTable(freeze(values), bins)
        return table if path is None else table.save(path)


def load_rgl(path: Path) -> RGLMaterial:
    """An isotropic .bsdf file of the RGL database, RGB or spectral."""
    return RGLMaterial(TensorFile(path))
