"""Fixtures of the command-line tests. SPDX-License-Identifier: MIT"""
import shutil

import pytest

import harness


@pytest.fixture(scope="session", autouse=True)
def programs():
    for program in (harness.BRDFFIT, harness.GONIOMETER):
        if not program.exists():
            pytest.fail("%s is not built: run make first, or set BRDFFIT_BUILD" % program, pytrace=False)


@pytest.fixture(scope="session")
def instruments(tmp_path_factory):
    """The goniometer's files. Read only: shared by all tests."""
    folder = tmp_path_factory.mktemp("instruments")
    done = harness.run(folder, "--outliers", "0.1", program=harness.GONIOMETER)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture
def desk(tmp_path, instruments):
    """A folder of one's own with the goniometer's files and the small ones of data/."""
    for file in [*instruments.iterdir(), *harness.DATA.iterdir()]:
        shutil.copy(file, tmp_path)
    return tmp_path
