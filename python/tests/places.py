"""Where things are, for the tests of the package. SPDX-License-Identifier: MIT"""
import os
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = (ROOT / os.environ.get("BRDFFIT_BUILD", "build")).resolve()
SOURCES = ROOT / "python" / "src"
