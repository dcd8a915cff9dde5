"""Anisotropic lobes on the command line: truth is found again, `eval` gives what an independent formula gives, isotropic fits of
such data say so and others do not.

SPDX-License-Identifier: MIT
"""
import csv
import io
import json

import numpy as np
import pytest

import harness
import terms_model


def radiance(name, along, across, light, view):
    """Of a lobe with y = 1 (docs/theory.md 7.4), from its formula."""
    half = light + view
    half = half / np.linalg.norm(half, axis=1, keepdims=True)
    nh, nl, nv, vh = half[:, 2], light[:, 2], view[:, 2], np.sum(view * half, 1)
    x, y = (half[:, 0] / nh) ** 2, (half[:, 1] / nh) ** 2
    exponent = x / along ** 2 + y / across ** 2
    if name == "ward":
        return np.sqrt(nl / nv) / (4 * np.pi) * np.exp(-exponent) / (along * across)
    masking = np.minimum(1, 2 * nh * np.minimum(nv, nl) / vh) / (np.pi * nv * nh ** 4)
    shape = np.exp(-exponent) if name == "beckmann" else (1 + exponent) ** -2
    return masking * shape / (along * across)


def measure(folder, name, along, across, noise=0.0):
    light, view = terms_model.geometry(300, seed=11)
    x, y = np.array([0.2, 0.1, 0.05]), np.array([0.02, 0.03, 0.01])
    values = light[:, 2:] / np.pi * x + radiance(name, along, across, light, view)[:, None] * y
    values = values * (1 + noise * np.random.default_rng(5).standard_normal(values.shape))
    terms_model.write(folder / "made.csv", light, view, values)
    return values


@pytest.mark.parametrize("name", ["beckmann", "ggx", "ward"])
def test_truth_is_found_and_evaluated(tmp_path, name):
    values = measure(tmp_path, name, 0.1, 0.4)
    line = harness.fit("made.csv", "--values", "radiance", "--distribution", name, "--anisotropic", "--max-incidence", "off",
                       cwd=tmp_path)[0]
    assert line["status"] == "certified"
    assert line["sigma_xy"][0] == pytest.approx([0.1, 0.4], rel=1e-9)
    assert line["anisotropy"][0] == pytest.approx(0.25, rel=1e-9) and line["tangent_angle"] == [0]
    (tmp_path / "fit.json").write_text(json.dumps(line))
    done = harness.run("eval", "fit.json", "made.csv", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = list(csv.DictReader(io.StringIO(done.stdout)))
    found = np.array([[float(row[channel + "_fit"]) for channel in "rgb"] for row in rows])
    assert found == pytest.approx(values, rel=1e-9)


def test_isotropic_fit_of_such_data_says_so(tmp_path):
    measure(tmp_path, "beckmann", 0.15, 0.3, 0.01)
    options = ("--values", "radiance", "--max-incidence", "off", "--gap", "1e-2")
    line = harness.fit("made.csv", *options, cwd=tmp_path)[0]
    assert line["azimuth_share"] > 0.5 and "anisotropy" not in line
    said = harness.run("fit", *options, "made.csv", cwd=tmp_path).stdout
    assert "vary with the azimuth" in " ".join(said.split()) and "--anisotropic" in said
    two = harness.fit("made.csv", *options, "--anisotropic", cwd=tmp_path)[0]
    assert "azimuth_share" not in two and two["e2"] < (1 - line["azimuth_share"]) * line["e2"]
    report = harness.run("fit", *options, "--anisotropic", "made.csv", cwd=tmp_path).stdout
    assert "along" in report and "across" in report and "vary with the azimuth" not in " ".join(report.split())


def test_isotropic_data_are_not_accused(tmp_path):
    for sigma in (0.1, 0.35):
        measure(tmp_path, "ggx", sigma, sigma, 0.02)
        line = harness.fit("made.csv", "--values", "radiance", "--distribution", "ggx", cwd=tmp_path)[0]
        assert line["azimuth_share"] < 0.1


def test_a_given_ratio_and_angle(tmp_path):
    measure(tmp_path, "beckmann", 0.1, 0.4)
    options = ("--values", "radiance", "--max-incidence", "off")
    given = harness.fit("made.csv", *options, "--anisotropy", "0.25", cwd=tmp_path)[0]
    assert given["sigma_xy"][0] == pytest.approx([0.1, 0.4], rel=1e-9)
    turned = harness.fit("made.csv", *options, "--tangent-angle", "90", cwd=tmp_path)[0]
    assert turned["sigma_xy"][0] == pytest.approx([0.4, 0.1], rel=1e-9) and turned["tangent_angle"] == [90]


@pytest.mark.parametrize("options, words", [
    (("--distribution", "lafortune"), "Beckmann, GGX, Ward or Ashikhmin-Shirley"),
    (("--masking", "smith"), "masking v-cavity or none"),
    (("--norm", "l1"), "norm l2")])
def test_what_does_not_go_with_it(tmp_path, options, words):
    measure(tmp_path, "beckmann", 0.1, 0.4)
    done = harness.run("fit", "--anisotropic", *options, "made.csv", cwd=tmp_path)
    assert done.returncode == 2 and words in done.stderr


def test_angles_have_no_azimuth(tmp_path):
    (tmp_path / "angles.csv").write_text("a,b,c,r\n0.3,0.2,0.01,1\n0.3,0.2,0.2,0.5\n")
    done = harness.run("fit", "--anisotropic", "angles.csv", cwd=tmp_path)
    assert done.returncode == 2 and "anisotrop" in done.stderr


def test_tangents_of_a_table(tmp_path):
    """The same samples in frames of their own: a normal and a tangent a row."""
    light, view = terms_model.geometry(200, seed=11)
    values = light[:, 2:] / np.pi * 0.2 + 0.02 * radiance("beckmann", 0.1, 0.4, light, view)[:, None]
    rng = np.random.default_rng(1)
    frames = np.linalg.qr(rng.standard_normal((len(light), 3, 3)))[0]
    frames[:, :, 2] *= np.linalg.det(frames)[:, None]
    turned = [np.einsum("nij,nj->ni", frames, d) for d in (light, view)]
    table = np.hstack([*turned, frames[:, :, 2], 2 * frames[:, :, 0] + 0.3 * frames[:, :, 2], values])
    names = "lx,ly,lz,vx,vy,vz,nx,ny,nz,tangent_x,tangent_y,tangent_z,r"
    (tmp_path / "made.csv").write_text(names + "\n" + "\n".join(",".join("%.17g" % x for x in row) for row in table) + "\n")
    options = ("--values", "radiance", "--max-incidence", "off", "--anisotropic")
    line = harness.fit("made.csv", *options, cwd=tmp_path)[0]
    assert line["channels"] == ["r"] and line["sigma_xy"][0] == pytest.approx([0.1, 0.4], rel=1e-9)
    (tmp_path / "none.csv").write_text(names.replace("tangent", "u") + "\n" + "\n".join(
        ",".join("%.17g" % x for x in row) for row in table) + "\n")
    done = harness.run("fit", *options, "none.csv", cwd=tmp_path)
    assert done.returncode == 3 and "tangent" in done.stderr
