"""The wheel, the types, the lint. SPDX-License-Identifier: MIT"""
import os
import re
import subprocess
import sys
import zipfile

import pytest

import brdffit
from places import BUILD, ROOT


def run(*command, cwd=None, **env):
    kept = {k: v for k, v in os.environ.items() if k not in ("BRDFFIT_LIBRARY", "PYTHONPATH")}
    return subprocess.run(command, cwd=cwd, env={**kept, **env}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          timeout=600)


@pytest.fixture(scope="session")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    done = run(sys.executable, "-m", "pip", "wheel", "--no-build-isolation", "--no-deps", "--no-index", "-w", str(folder),
               str(ROOT / "python"), THIRD_PARTY=os.environ.get("THIRD_PARTY", str(BUILD / "third_party")),
               BRDFFIT_PYTHON_BUILD=str(BUILD))  # whose objects serve: only the library is linked
    assert done.returncode == 0, done.stdout
    found, = folder.glob("*.whl")
    return found


def test_wheel(wheel, tmp_path):
    assert re.fullmatch(r"brdffit-%s-py3-none-\w+\.whl" % re.escape(brdffit.__version__), wheel.name)
    names = zipfile.ZipFile(wheel).namelist()
    assert {"brdffit/_lib/libbrdffit.so", "brdffit/py.typed", "brdffit/two_lobe_satin.csv", "brdffit/LICENSE",
            "brdffit/_shade/lobes.h"} <= set(names)
    done = run(sys.executable, "-m", "pip", "install", "--no-deps", "--no-index", "--target", str(tmp_path / "site"), str(wheel))
    assert done.returncode == 0, done.stdout
    # Outside of the tree, without a compiler or make on the path.
    program = ("import brdffit\nprint(brdffit.fit(brdffit.Samples.example(), lobes=2))\nprint(brdffit.library_path())\n"
               "import shutil; print(shutil.which('cc'), shutil.which('gcc'), shutil.which('make'))")
    done = run(sys.executable, "-c", program, cwd=tmp_path, PYTHONPATH=str(tmp_path / "site"), PATH="")
    assert done.returncode == 0, done.stdout
    assert "Proven: no Beckmann fit with 2 lobes" in done.stdout and "None None None" in done.stdout
    assert str(tmp_path / "site" / "brdffit" / "_lib" / "libbrdffit.so") in done.stdout


def test_sdist_has_all_that_make_needs(tmp_path):
    """Unpacked, `make` finds a rule for every source. `make check-package` really builds it."""
    done = run(sys.executable, "-m", "hatchling", "build", "-t", "sdist", "-d", str(tmp_path), cwd=ROOT / "python")
    assert done.returncode == 0, done.stdout
    archive, = tmp_path.glob("brdffit-*.tar.gz")
    assert run("tar", "-xzf", str(archive), "-C", str(tmp_path)).returncode == 0
    inside = tmp_path / archive.name.removesuffix(".tar.gz")
    sources = sorted(p.relative_to(ROOT) for p in ROOT.glob("src/**/*.c"))
    assert all((inside / "c" / p).read_bytes() == (ROOT / p).read_bytes() for p in sources)
    assert not list(inside.rglob("*.so")) and not list(inside.rglob("__pycache__"))
    kept = dict.fromkeys(("MAKEFLAGS", "MFLAGS", "MAKELEVEL"), "")
    done = run("make", "-n", "ECOS=0", "BUILD=out", "V=1", "out/whole/libbrdffit.so", cwd=inside / "c", **kept)
    assert done.returncode == 0, done.stdout
    compiled = set(re.findall(r"-c (src/\S+\.c)", done.stdout))
    assert compiled == {str(p) for p in sources} - {"src/solve/conic/ecos_memory.c"} and "-shared" in done.stdout
    assert (inside / "README.md").exists() and (inside / "src" / "brdffit" / "py.typed").exists()


def test_version_is_the_headers():
    header = (ROOT / "include" / "brdffit.h").read_text()
    assert re.search(r'BRDFFIT_VERSION_STRING "(.*)"', header).group(1) == brdffit.__version__


def test_types(tmp_path):
    done = run(sys.executable, "-m", "mypy", "--cache-dir", str(BUILD / "mypy_cache"), cwd=ROOT / "python")
    assert done.returncode == 0, done.stdout


USER = """
import dask.array, numpy as np, numpy.typing as npt, xarray, zarr
from typing import Any
from typing_extensions import assert_type
import brdffit, brdffit.dask

Light = npt.NDArray[np.float64]

def in_memory(values: npt.NDArray[np.float32], stack: brdffit.Stack, light: Light) -> None:
    assert_type(brdffit.fit_map(values, light, lobes=2), brdffit.FitMap)
    assert_type(brdffit.fit_map([[[0.5]]], light, mask=[1]), brdffit.FitMap)
    assert_type(brdffit.fit_map(stack.values, light, output=None), brdffit.FitMap)
    assert_type(stack.fit_map(rows=3), brdffit.FitMap)
    assert_type(brdffit.fit_map(values, light, output="m.zarr"), brdffit.dask.MapArrays)
    assert_type(stack.fit_map(output="m.zarr"), brdffit.dask.MapArrays)

def elsewhere(stored: zarr.Array[Any], delayed: dask.array.Array, light: Light) -> None:
    assert_type(brdffit.fit_map(stored, light), brdffit.dask.MapArrays)
    assert_type(brdffit.fit_map(stored, light, output="m.zarr", client=None), brdffit.dask.MapArrays)
    assert_type(brdffit.fit_map(delayed, light), brdffit.dask.MapArrays)
    assert_type(brdffit.dask.fit_map(delayed, light), brdffit.dask.MapArrays)

def labelled(scan: xarray.DataArray, light: Light) -> None:
    assert_type(brdffit.fit_map(scan, light, sample_axis="light"), xarray.Dataset)
    assert_type(brdffit.fit_map(scan, light, output="m.zarr"), xarray.Dataset)
    assert_type(brdffit.dask.fit_map(scan, light), xarray.Dataset)
"""


def test_types_are_true_for_users(tmp_path):
    """What fit_map returns depends on what it is given, and a type checker knows."""
    (tmp_path / "user.py").write_text(USER + "\nbrdffit.fit_map([[[0.5]]], [0, 0, 1], lobe=2)\n")
    done = run(sys.executable, "-m", "mypy", "--strict", "--follow-imports", "silent", "--cache-dir",
               str(BUILD / "mypy_cache_user"), "user.py", cwd=tmp_path, MYPYPATH=str(ROOT / "python" / "src"))
    errors = re.findall(r"user.py:\d+: error: (.*)", done.stdout)
    assert len(errors) == 2 and "did you mean" in errors[0] and "No overload" in errors[1], done.stdout  # of the last line


def test_lint():
    done = run(sys.executable, "-m", "ruff", "check", "--cache-dir", str(BUILD / "ruff_cache"), "python", cwd=ROOT)
    assert done.returncode == 0, done.stdout


def test_only_numpy_is_needed():
    program = ("import sys\nfor name in ('sklearn', 'tqdm', 'scipy', 'matplotlib', 'OpenEXR', 'h5py', 'zarr',\n"
               "             'dask', 'distributed', 'xarray'): sys.modules[name] = None\n"
               "from brdffit import *\nimport brdffit, brdffit.report\n"
               "f = brdffit.fit(brdffit.Samples.example(), progress=True); print(f.status)")
    done = run(sys.executable, "-c", program, PYTHONPATH=str(ROOT / "python" / "src"), BRDFFIT_LIBRARY=str(BUILD / "libbrdffit.so"))
    assert done.returncode == 0 and "certified" in done.stdout, done.stdout
