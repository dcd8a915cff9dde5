"""Maps of stacks that are not in memory: zarr, Dask and xarray arrays, and images in files.

    sources         the stack, told by its kind; `tiles` cuts it up
    call            the arguments, checked; what of them a tile needs
    job             one tile, from its values to the maps; `run` has all of them done, in threads or by a client
    store           maps in a zarr group; `write` fits into one what is missing
    lazy            maps as Dask arrays that fit when computed
    arrays          MapArrays, what comes back; `labels` makes an xarray Dataset of it
    fit             fit_map for all of these but files, which `bands` fits a band of rows at a time

Tiles are fitted by brdffit.maps.memory. brdffit.dask has the names for users. SPDX-License-Identifier: MIT
"""
