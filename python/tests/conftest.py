"""Tests of the Python package run on its sources and on the library of the build tree, from a fresh clone.

SPDX-License-Identifier: MIT
"""
import os
import sys

import pytest

from places import BUILD, ROOT, SOURCES

os.environ["BRDFFIT_LIBRARY"] = str(BUILD / "libbrdffit.so")
# The independent model and the runner of the command line's tests.
sys.path[:0] = [str(SOURCES), str(ROOT / "tests" / "cli")]


@pytest.fixture(scope="session")
def instruments(tmp_path_factory):
    """The goniometer's files. Read only: shared by all tests."""
    import harness

    folder = tmp_path_factory.mktemp("instruments")
    done = harness.run(folder, "--outliers", "0.1", program=harness.GONIOMETER)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="session")
def hard():
    """Samples whose search takes seconds: one lobe made them, two are fitted, to a gap of 1e-9, with noise."""
    import numpy as np

    import brdffit

    light, view = brdffit.protocol84()
    one = brdffit.fit(brdffit.Samples.example(), lobes=1)
    values = one.predict(light, view) * (1 + 0.05 * np.random.default_rng(1).standard_normal((84, 3)))
    return brdffit.Samples.from_arrays(light, view, values)
