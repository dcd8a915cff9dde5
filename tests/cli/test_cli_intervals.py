"""--confidence. SPDX-License-Identifier: MIT"""
import numpy as np
import pytest

import harness


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """A lobe over a dull ground, with 1 % noise."""
    rng = np.random.default_rng(11)
    light, view = (rng.standard_normal((80, 3)) for _ in range(2))
    for d in (light, view):
        d[:, 2] = np.abs(d[:, 2]) + 1
        d /= np.linalg.norm(d, axis=1, keepdims=True)
    tilt = (light + view)[:, 2] / np.linalg.norm(light + view, axis=1)
    values = (0.1 + 2 * np.exp(-(1 / tilt**2 - 1) / 0.04)) * (1 + 0.01 * rng.standard_normal(80))
    path = tmp_path_factory.mktemp("intervals") / "lobe.csv"
    np.savetxt(path, np.column_stack([light, view, values]), "%.17g", ",", header="lx,ly,lz,vx,vy,vz,f", comments="")
    return path


def test_json(file):
    (line,) = harness.fit(file, "--confidence", "95")
    found = line["intervals"]
    assert found["level"] == pytest.approx(0.95) and found["complete"]
    assert found["degrees"] == line["samples_used"] - 3
    assert found["threshold"] == pytest.approx(line["e2"] * (1 + 3.841458820694124 / found["degrees"]), rel=1e-12)
    for (low, high), value in ((found["sigma"][0], line["sigma"][0]), (found["x"][0][0], line["x"][0]),
                               (found["y"][0][0], line["y"][0][0])):
        assert low < value < high
    assert "intervals" not in harness.fit(file)[0]


def test_wider_with_the_level(file):
    width = [np.diff(harness.fit(file, "--confidence", level)[0]["intervals"]["sigma"][0])[0] for level in ("68", "95", "99.9")]
    assert width[0] < width[1] < width[2]


def test_report(file):
    done = harness.run("fit", file, "--confidence", "95")
    assert done.returncode == 0 and "95 % interval" in done.stdout and "Intervals: proven" in done.stdout


@pytest.mark.parametrize("wrong", [["0"], ["100"], ["x"], ["95", "--norm", "l1"], ["95", "--engine", "socp"]])
def test_usage(file, wrong):
    assert harness.run("fit", file, "--confidence", *wrong).returncode == 2
