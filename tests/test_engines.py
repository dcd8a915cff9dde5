"""The two engines against each other on the development data: the same optima, and bounds of engine moment proven again.

SPDX-License-Identifier: MIT
"""
import subprocess

import pytest

from test_data import DATA, data, fit, program  # noqa: F401  (data is a fixture)

GAP = 1e-6


@pytest.fixture(scope="module", autouse=True)
def ecos():
    done = subprocess.run([program("brdffit"), "fit", "--quiet", "--engine", "socp", DATA / "hard" / "one.csv"],
                          capture_output=True, text=True, check=False)
    if "ECOS" in done.stderr:
        pytest.skip("this build is without ECOS")


def materials(folder):
    files = sorted((folder / "merl84").glob("*.csv"))
    assert len(files) == 100
    return files


def test_same_optimum_on_every_material(data):
    """One lobe, both proven to 1e-6: the same E^2, and neither bound above the other's optimum."""
    files = materials(data)
    moment = fit(files, "--gap", GAP)
    socp = fit(files, "--gap", GAP, "--engine", "socp")
    for a, b in zip(moment, socp):
        assert a["status"] == b["status"] == "certified", a["file"]
        assert (a["engine"], b["engine"]) == ("moment", "socp") and a["socp"] is None
        assert b["socp"]["solved"] + b["socp"]["decided"] == b["boxes"]
        assert b["e2"] == pytest.approx(a["e2"], rel=1e-6)
        if not a["warnings"][0]:
            assert b["sigma"] == pytest.approx(a["sigma"], rel=1e-6)
        assert a["lower_bound"] <= b["e2"] and b["lower_bound"] <= a["e2"]


@pytest.mark.parametrize("lobes, margin", [(1, 1e-3), (2, 0.1)])
def test_bounds_are_proven_again(data, lobes, margin):
    """Every leaf of a covering is discarded with a certificate, at the bound less the margin; all materials.

    Two lobes at a margin of 10 %: at 1 % a first-order bound takes about 25 times as many boxes.
    """
    for line in fit(materials(data), "--lobes", lobes, "--verify", "socp=%g" % margin):
        verify = line["verify"]
        assert verify["proven"] is True and verify["unproven"] == 0 and verify["stop"] is None, line["file"]
        assert verify["level"] == pytest.approx(line["lower_bound"] * (1 - margin), rel=1e-12)
        assert 0 < verify["leaves"] < verify["boxes"] == verify["solved"] + verify["decided"]
        assert verify["refused"] <= verify["solved"]


def test_two_lobes_agree_to_the_gap(data):
    """Ten materials, two lobes, a gap that first-order bounds can close; and as the paper does it, every box to ECOS."""
    files = materials(data)[::10]
    moment = fit(files, "--lobes", 2, "--gap", GAP)
    for more in ([], ["--socp-every-box"]):
        for a, b in zip(moment, fit(files, "--lobes", 2, "--gap", 0.05, "--engine", "socp", *more)):
            assert a["status"] == b["status"] == "certified", a["file"]
            assert a["lower_bound"] <= b["e2"] <= 1.05 * a["e2"]
            assert b["lower_bound"] <= a["e2"]
            assert (b["socp"]["decided"] == 0) == bool(more)
