"""Mitsuba's values of the made-up materials: an independent implementation, by an author of the format.

    python -m venv scratch && scratch/bin/pip install mitsuba==3.9.1
    scratch/bin/python python/tests/rgl_reference.py > python/tests/data/rgl_mitsuba.csv

f_r cos(theta_o) at 60 random pairs of directions for each kind of file, in single precision. The directions are those of
rgl_files.directions(60, 1 and 2). SPDX-License-Identifier: MIT
"""
import pathlib
import sys
import tempfile

import numpy as np

import rgl_files

COUNT = 60


def values(mi, kind, path, light, view):
    """f_r cos(theta_o), at four of the five wavelengths of a spectral file. Mitsuba's wi is the file's."""
    mi.set_variant("scalar_spectral" if kind == "spectra" else "scalar_rgb")
    bsdf, context, at = mi.load_dict({"type": "measured", "filename": str(path)}), mi.BSDFContext(), mi.SurfaceInteraction3f()
    if kind == "spectra":
        at.wavelengths = [400.0, 450.0, 530.0, 700.0]
    out = []
    for l, v in zip(light, view):
        at.wi = mi.Vector3f(*map(float, l))
        out.append(np.array(bsdf.eval(context, at, mi.Vector3f(*map(float, v)))))
    return np.array(out)


def main():
    import mitsuba as mi

    light, view = rgl_files.directions(COUNT, 1), rgl_files.directions(COUNT, 2)
    print("# f_r cos(theta_o) by mitsuba %s: written by rgl_reference.py" % mi.__version__)
    print("kind,pair,v0,v1,v2,v3")
    for kind in rgl_files.KINDS:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "made_up.bsdf"
            path.write_bytes(rgl_files.tensor_bytes(rgl_files.material(kind)))
            for pair, row in enumerate(values(mi, kind, path, light, view)):
                print(",".join([kind, str(pair), *("%.9g" % value for value in row), *([""] if len(row) == 3 else [])]))


if __name__ == "__main__":
    sys.exit(main())
