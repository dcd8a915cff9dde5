"""The one call for maps: looks at the values and the output, and leaves the work to who can do it.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

import numpy.typing as npt

from ..options import FitOptions
from ..outofcore.arrays import MapArrays
from ..outofcore.bands import fit_bands
from ..outofcore.fit import fit_map as fit_scaled
from ..outofcore.sources import is_scaled, kind
from .arguments import LabelledArray, MapOptions, TileArgument, TiledArray
from .fitmap import FitMap
from .geometry import DirectionsLike
from .memory import fit_array
from .pool import MapProgressArgument

if TYPE_CHECKING:
    import xarray
    from typing_extensions import Unpack


@overload
def fit_map(values: LabelledArray, light: DirectionsLike, view: npt.ArrayLike | None = None, *, output: Any = None,
            **options: Unpack[MapOptions]) -> xarray.Dataset: ...


@overload
def fit_map(values: TiledArray, light: DirectionsLike, view: npt.ArrayLike | None = None, *, output: Any = None,
            **options: Unpack[MapOptions]) -> MapArrays: ...


@overload
def fit_map(values: npt.ArrayLike, light: DirectionsLike, view: npt.ArrayLike | None = None, *, output: None = None,
            **options: Unpack[MapOptions]) -> FitMap: ...


@overload
def fit_map(values: npt.ArrayLike, light: DirectionsLike, view: npt.ArrayLike | None = None, *, output: Any,
            **options: Unpack[MapOptions]) -> MapArrays: ...


def fit_map(values: npt.ArrayLike | LabelledArray | TiledArray, light: DirectionsLike, view: npt.ArrayLike | None = None, *,
            normal: npt.ArrayLike | None = None, weights: npt.ArrayLike | None = None,
            mask: npt.ArrayLike | None = None, quantity: str | None = None, scale: float = 1.0,
            sample_axis: int | str = 0, channel_axis: int | str | None = -1, threads: int | None = None,
            tile: TileArgument = None, errors: str = "status", progress: MapProgressArgument = None, output: Any = None,
            client: Any = None, overwrite: bool = False, retries: int = 3,
            **options: Unpack[FitOptions]) -> FitMap | MapArrays | xarray.Dataset:
    """Fit every texel of a stack of images, each with its own proof.

    values: samples x S x channels, where S is any number of axes (height x width of images). float64, float32 and uint16
        of the machine's byte order are read where they lie, whatever their strides, and also memory-mapped
        (`np.load(..., mmap_mode="r")`); other numbers are converted tile by tile. Each is multiplied by `scale`.
    sample_axis, channel_axis: which axes of `values` these are, if not the first and last; channel_axis None: there is
        none (samples x S), and the results have one channel
    light, view: towards light and viewer, around the normal: N x 3 for N samples, one vector, or N x S x 3
        (broadcast) where texels differ; any length but zero. view None: +z. Or light is a `Samples` (its values are
        not looked at) or the path of a CSV file as of `brdffit map --geometry`: its directions, angles or coefficients,
        weights and quantity hold for all texels.
    normal: one vector, or S x 3: a normal map in the frame of the directions; None: +z
    weights: N, multiply squared residuals; a sample of weight 0 is not looked at
    mask: S; texels where it is 0, False or NaN are skipped
    quantity: "brdf" (f_r in 1/sr, the default) or "radiance" (f_r n.l)
    threads: at a time; None: as many as there are processors for this process
    tile: texels of one call of the C library. Progress and Ctrl-C wait for it; None: some milliseconds' worth
    errors: "status": a texel that cannot be fitted has a status that says why; "raise" a `BrdffitError` for the first
        that is met, with `texel`, `sample` and `channel`
    progress: called in this thread about ten times a second with a `MapProgress` (done, total, rate), and once at the
        end; a true return value stops the run, and texels that it did not reach have status "not_reached". True shows
        a bar (tqdm's, when it is installed).

    and the options of a fit: see `Options`.

    The values of `load_stack` are read and fitted a band of rows at a time; tile may be a shape there, whose rows make one.

    Arrays of zarr, Dask and xarray, and any with output (a zarr store) or client (of dask.distributed), go the way of
    `brdffit.dask.fit_map`: tile by tile, in this process or on many machines, into arrays of their own kind. output,
    client, overwrite and retries are explained there.

    Returns a `FitMap`; a `brdffit.dask.MapArrays` for arrays of zarr and Dask, and where there is an output; for a DataArray
    an xarray Dataset.

    Threads, tiles, types and strides change no bit of the results: each is the same as of the texel alone. Directions,
    normals or views of a texel's own make it a fit by itself, as by `fit` (many times slower than shared ones).

    Raises `OptionError` and `DataError` for arguments, shapes and directions that cannot be used, `UnsupportedError` for
    what needs ECOS in a build without. An exception in `progress`, or Ctrl-C, ends the call within a tile.
    """
    array: Any = values
    given: dict[str, Any] = {
        "normal": normal, "weights": weights, "mask": mask, "quantity": quantity, "scale": scale, "sample_axis": sample_axis,
        "channel_axis": channel_axis, "threads": threads, "tile": tile, "errors": errors, "progress": progress}
    if output is not None or client or is_scaled(values):
        scaled: MapArrays | xarray.Dataset = fit_scaled(array, light, view, output=output, client=client, overwrite=overwrite,
                                                        retries=retries, **given, **options)
        return scaled
    if kind(values) == "brdffit":
        return fit_bands(array, light, view, options=options, **given)
    return fit_array(array, light, view, **given, **options)
