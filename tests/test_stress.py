"""Members of every family of `make stress`, judged by 50-digit references; and whether that judge would notice.

SPDX-License-Identifier: MIT
"""
import dataclasses
import math
import os
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools" / "stress"))

from cases import FAMILIES, make  # noqa: E402
from judge import judge  # noqa: E402
from stress import run, stress  # noqa: E402

PROGRAM = pathlib.Path(os.environ.get("BRDFFIT_BUILD", ROOT / "build")).resolve() / "stress_fit"

# Two lobes of these need up to a million boxes; `make stress` runs them.
SLOW_WITH_TWO = {"kappa", "near_exact", "weights", "mirror"}


@pytest.fixture(autouse=True)
def program():
    if not PROGRAM.exists():
        pytest.fail(f"{PROGRAM} is missing: build it with `make check`")


def members(family):
    quick = (1,) if family in SLOW_WITH_TWO else (1, 2)
    return [case for distribution in ("beckmann", "ggx" if family in ("roughness", "kappa") else "blinn-phong")
            for case in make([family], 3, quick, (distribution,))]


@pytest.mark.parametrize("family", FAMILIES)
def test_family(tmp_path, family):
    rows = stress(PROGRAM, members(family), tmp_path)
    assert not [row["name"] + ": " + row["failure"] for row in rows if row["failure"]]
    for row in rows:
        assert row["e2_units"] is not None, row  # judged, not skipped
        # Coefficients to what the condition of their columns allows, with room for three columns and an exponential.
        assert row["own_units"] is None or row["own_units"] <= 100, row
        # sigma to where E^2 shows a change: its own rounding is up to 1 unit, a refinement stops a little earlier.
        assert row["sigma_units"] is None or row["sigma_units"] <= 100, row


def test_judge_notices(tmp_path):
    """One ulp above the true minimum is a wrong bound; so are a missed optimum, a wrong E^2 and other bits."""
    case = make(["ordinary"], 1, (1,), ("beckmann",))[0]
    answer = run(PROGRAM, [case], tmp_path)[case.name]
    assert judge(case, answer)["failure"] == ""
    found = answer["e2"]
    wrong = math.nextafter(math.nextafter(found, math.inf), math.inf)
    assert "PROVEN: tight" in judge(case, {**answer, "tight_bound": wrong})["failure"]
    assert "PROVEN" in judge(case, {**answer, "lower_bound": wrong, "e2": 2 * found})["failure"]
    assert "PROVEN" not in judge(case, {**answer, "lower_bound": found * (1 - 1e-9)})["failure"]
    assert "above e2" in judge(case, {**answer, "lower_bound": wrong})["failure"]
    assert "off the E^2" in judge(case, {**answer, "e2": found * (1 + 1e-9)})["failure"]
    elsewhere = judge(case, {**answer, "sigma": [2 * answer["sigma"][0]], "e2": 1.01 * found})["failure"]
    assert "beyond the gap" in elsewhere
    assert "other bits" in judge(case, {**answer, "same_bits": 0})["failure"]


def test_reference_finds_the_other_basin(tmp_path):
    """Two lobes in the data, one fitted: from a poor start the scan finds what the library found."""
    case = make(["ordinary"], 1, (2,), ("ggx",))[0]
    case = dataclasses.replace(case, lobes=1, truth=(), name="single")
    answer = run(PROGRAM, [case], tmp_path)[case.name]
    row = judge(case, {**answer, "sigma": [5.9]})
    good = judge(case, answer)
    assert good["failure"] == "" and good["basin"] == "same"
    assert row["basin"] == "another" and row["share"] == pytest.approx(good["share"], rel=1e-12)
