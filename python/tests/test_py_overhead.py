"""tools/bench/python_overhead.py runs and finds the same errors from C and from Python. No times are judged.

SPDX-License-Identifier: MIT
"""
import os
import shlex
import subprocess
import sys

import pytest

from places import BUILD, ROOT, SOURCES

BENCH = ROOT / "tools" / "bench"


@pytest.mark.parametrize("lobes", [1, 2])
def test_the_benchmark_of_python(tmp_path, lobes):
    # Against the shared library: the benchmark links the static one, which a build for coverage or asan may not allow here.
    subprocess.run([*shlex.split(os.environ.get("CC", "cc")), "-std=c11", "-shared", "-fPIC", "-I", str(ROOT / "include"), "-o",
                    "direct.so", str(BENCH / "python_direct.c"), str(BUILD / "libbrdffit.so"), "-Wl,-rpath," + str(BUILD),
                    "-pthread"], cwd=tmp_path, check=True)
    done = subprocess.run([sys.executable, str(BENCH / "python_overhead.py"), "direct.so", "--size", "9", "--repeat", "1",
                           "--times", "2", "--lobes", str(lobes), "--threads", "2", "--csv"], cwd=tmp_path,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={
                              **os.environ, "PYTHONPATH": str(SOURCES), "BRDFFIT_LIBRARY": str(BUILD / "libbrdffit.so")})
    assert done.returncode == 0, done.stderr
    rows = [line.rsplit(",", 6) for line in done.stdout.splitlines()]
    assert [row[0].split(",")[0] for row in rows] == ["fit_map", "fit"]
    assert all(float(figure) >= 0 for row in rows for figure in row[1:])
