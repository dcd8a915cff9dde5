"""Names of the axes of maps, and the coordinates that stay: from an xarray DataArray to a Dataset.

SPDX-License-Identifier: MIT
"""
from __future__ import annotations

import dataclasses
import json
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

from ..errors import DataError
from . import store
from .sources import Source


@dataclasses.dataclass(frozen=True)
class Labels:
    """Names of the spatial dimensions and of the others, and the coordinates to keep (an xarray Dataset, or None)."""

    spatial: tuple[str, ...]
    renamed: Mapping[str, str]
    coords: Any = None

    def check(self, fields: Sequence[store.Field]) -> None:
        """Names that would mean two things."""
        used = {*self.spatial, *self.renamed.values(), *(() if self.coords is None else map(str, self.coords.variables))}
        for name in sorted(used & {"tiles", *(field.stored for field in fields)}):
            raise DataError("values have a dimension or coordinate %r, as a map is called: rename it" % name,
                            code="argument")

    def write(self, group: Any) -> None:
        """The coordinates, where they are not there yet."""
        if self.coords is None or not self.coords.variables or all(name in group for name in self.coords.variables):
            return
        with warnings.catch_warnings():  # strings have no type in zarr's specification yet
            warnings.simplefilter("ignore")
            # It replaces the group's attributes by those of the Dataset: they have to be the same.
            self.coords.assign_attrs(dict(group.attrs)).to_zarr(
                group.store, group=group.path, mode="a", zarr_format=group.metadata.zarr_format, consolidated=False)


def plain(source: Source) -> Labels:
    dims = ("row", "column") if len(source.spatial) == 2 else tuple("dim_%d" % i for i in range(len(source.spatial)))
    return Labels(dims, {})


def axis_of(name: str, axis: Any, dims: tuple[str, ...]) -> Any:
    """An axis by number or by its dimension's name."""
    if isinstance(axis, str):
        if axis not in dims:
            raise DataError("%s: values have dimensions %s, and none named %r" % (name, dims, axis), code="argument")
        return dims.index(axis)
    return axis


def of_xarray(values: Any, source: Source) -> Labels:
    dims = tuple(str(dim) for dim in values.dims)
    renamed = {} if source.channel_axis is None else {"channel": dims[source.channel_axis]}
    renamed["lobe"] = "lobe" if "lobe" not in dims else "brdffit_lobe"
    coords = values.coords.to_dataset()
    kept = coords.drop_vars([name for name in coords.variables if dims[source.sample_axis] in coords[name].dims])
    return Labels(tuple(dims[a] for a in source.axes), renamed, kept)


def dataset(maps: Any, fields: Sequence[store.Field], labels: Labels, manifest: Any) -> Any:
    """Maps (a MapArrays or FitMap) as an xarray Dataset, with the coordinates of the stack."""
    import xarray

    group = getattr(maps, "group", None)
    if group is not None:
        return xarray.open_zarr(group.store, group=group.path, consolidated=False, chunks={}).unify_chunks()
    layout = store.Layout((), (), 0, (), labels.spatial, labels.renamed, {})
    found = {field.stored: (layout.dims_of(field), getattr(maps, field.name), store.field_attributes(field.name))
             for field in fields}
    out = xarray.Dataset(found, coords=labels.coords.variables, attrs={"brdffit": json.dumps(manifest)})
    return out.unify_chunks()  # coordinates may have chunks of their own
