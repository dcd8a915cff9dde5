"""brdffit eval: a fit beside its data, from the recorded line and the file alone.

SPDX-License-Identifier: MIT
"""
import csv
import io
import json
import re

import numpy as np
import pytest

import harness
import model


def table(text):
    rows = list(csv.reader(io.StringIO(text)))
    return rows[0], np.array([[float(x) for x in row] for row in rows[1:]])


def figures(stderr):
    """E^2 (or what the norm minimises) here and as recorded, RMS a channel."""
    here, there = re.search(r"(?:E²|absolute residuals?) (\S+) here, (\S+) in fit", stderr).groups()
    rms = re.search(r"RMS (.*)$", stderr, re.M)[1]
    return float(here), float(there), [float(number) for number in re.findall(r" ([-+.e0-9]+)(?:, |$)", rms)]


def save(folder, *lines):
    (folder / "fits.json").write_text("".join(json.dumps(line) + "\n" for line in lines))


@pytest.mark.parametrize("options", [
    ["two_lobe_satin.csv", "--norm", "l1"], ["mis.csv", "--norm", "linf", "--normalise", "none"],
    ["two_lobe_satin.csv"], ["two_lobe_satin.csv", "--lobes", "2"], ["ggx_metal.csv", "--distribution", "ggx"],
    ["two_lobe_satin.csv", "--distribution", "lafortune", "--lobes", "2"], ["matte.csv", "--lobes", "3"],
    ["two_lobe_satin.csv", "--lobes", "ward,blinn-phong"], ["two_lobe_table.binary", "--lobes", "beckmann,ggx"],
    ["two_lobe_table.binary", "--lobes", "blinn-phong,ggx,blinn-phong", "--gap", "0.1"],
    ["two_lobe_table.binary", "--distribution", "ashikhmin-shirley"],
    ["matte.csv", "--normalise", "none"], ["two_lobe_satin.csv", "--max-incidence", "off"],
    ["two_lobe_satin.csv", "--values", "radiance"], ["mis.csv", "--lobes", "2"], ["mixed.csv"], ["vectors.csv"],
    ["single.csv"], ["zero.csv"], ["two_lobe_table.binary"], ["two_lobe_table.binary", "--merl-bins", "centre"],
    ["two_lobe_table.binary", "--merl-samples", "84"],
    ["two_lobe_table.binary", "--merl-samples", "two_lobe_satin.csv", "--lobes", "2"],
])
def test_e2_comes_back(desk, options):
    """What eval finds is what the line says, to rounding, whatever the settings of the fit were."""
    if "--norm" in options and not harness.has_ecos():
        pytest.skip("this build is without ECOS")
    (line,) = harness.fit(*options, cwd=desk)
    save(desk, line)
    (desk / "two_lobe_satin.csv").rename(desk / "moved.csv") if "--merl-samples" in options else None
    done = harness.run("eval", "fits.json", options[0], cwd=desk)
    assert done.returncode == 0, done.stderr
    here, there, rms = figures(done.stderr)
    assert there == pytest.approx(line["e2"], rel=1e-14)
    assert here == pytest.approx(line["e2"], rel=1e-12, abs=1e-24 * line["sum_of_squares"])
    largest = max(line["channel_scale"]) if line["normalise"] == "max" else 1
    assert rms == pytest.approx(line["rms"], rel=1e-12, abs=1e-12 * largest)
    assert "other data" not in done.stderr
    header, rows = table(done.stdout)
    # Entries that the reader dropped are in no table; what a fit skips is.
    skipped = line["samples_skipped"]
    assert len(rows) == line["samples_used"] + sum(skipped[k] for k in skipped
                                                   if k not in ("masked", "absent", "cell_below_horizon"))
    for name in line["channels"]:
        fitted, measured, residual = (rows[:, header.index(name + tail)] for tail in ("_fit", "_measured", "_residual"))
        assert np.array_equal(measured - fitted, residual)


def test_fitted_values_are_the_models(desk):
    (line,) = harness.fit("two_lobe_satin.csv", "--lobes", "2", cwd=desk)
    save(desk, line)
    header, rows = table(harness.run("eval", "fits.json", "two_lobe_satin.csv", cwd=desk).stdout)
    names, original = model.read_text(desk / "two_lobe_satin.csv")
    assert header[:4] == names[:4]
    tilted = original[:, 0] > 0
    assert np.array_equal(rows[tilted, :2], original[tilted, :2])  # angles read as they were written
    assert np.allclose(rows[:, 0], original[:, 0], atol=1e-12)
    a, b, c, nl, _ = model.directions_to_abc(model.unit(*original[:, :2].T), model.unit(*original[:, 2:4].T))
    for k, name in enumerate(line["channels"]):
        s = 1 / np.array(line["sigma"]) ** 2
        f_r = (a * line["x"][k] + sum(line["y"][k][p] * b * s[p] * np.exp(-c * s[p]) for p in range(2))) / nl
        assert np.allclose(rows[:, header.index(name + "_fit")], f_r, rtol=1e-12)


def test_other_directions(desk):
    """A fit of one file at the directions of another, whose channels are not its own."""
    (line,) = harness.fit("two_lobe_satin.csv", cwd=desk)
    save(desk, line)
    (desk / "elsewhere.csv").write_text("theta_i,theta_o,visible\n15,15,1\n15,100,1\n")
    done = harness.run("eval", "fits.json", "elsewhere.csv", cwd=desk)
    assert done.returncode == 0
    header, rows = table(done.stdout)
    assert header == ["theta_i", "phi_i", "theta_o", "phi_o", "r_fit", "g_fit", "b_fit"]
    assert rows[0, 4:].min() > 0 and np.array_equal(rows[1, 4:], [0, 0, 0])
    assert "no E^2" in done.stderr
    done = harness.run("eval", "fits.json", "ggx_metal.csv", cwd=desk)
    assert done.returncode == 0 and "other data" in done.stderr


def test_channels_are_matched_by_name(desk):
    (line,) = harness.fit("two_lobe_satin.csv", cwd=desk)
    save(desk, dict(line, file="turned.csv"))
    names, rows = model.read_text(desk / "two_lobe_satin.csv")
    with open(desk / "turned.csv", "w") as out:
        out.write("b,theta_o,phi_o,g,r,theta_i,phi_i\n")
        for ti, pi, to, po, r, g, b in rows:
            out.write(",".join("%.17g" % v for v in (b, to, po, g, r, ti, pi)) + "\n")
    here, _, _ = figures(harness.run("eval", "fits.json", "turned.csv", cwd=desk).stderr)
    assert here == pytest.approx(line["e2"], rel=1e-12)


def test_which_line(desk):
    lines = harness.fit("matte.csv", "infinite.csv", "two_lobe_satin.csv", "./ggx_metal.csv", cwd=desk, expect=3)
    save(desk, *lines)
    for file, number in (("matte.csv", 1), ("two_lobe_satin.csv", 3), ("ggx_metal.csv", 4), (str(desk / "matte.csv"), 1)):
        done = harness.run("eval", "fits.json", file, cwd=desk)
        assert done.returncode == 0 and "in fit %d;" % number in done.stderr
    done = harness.run("eval", "fits.json", "--select", "3", "matte.csv", cwd=desk)
    assert done.returncode == 0 and "in fit 3;" in done.stderr
    for arguments, words in ((["infinite.csv"], "fit 2 failed"), (["vectors.csv"], "--select"),
                             (["matte.csv", "--select", "9"], "only 4")):
        done = harness.run("eval", "fits.json", *arguments, cwd=desk)
        assert done.returncode == 3 and words in done.stderr and done.stdout == ""


def test_standard_input(desk):
    fitted = harness.run("fit", "--json", "matte.csv", cwd=desk).stdout
    direct = harness.run("eval", "-", "matte.csv", cwd=desk, stdin=fitted.encode())
    (desk / "fits.json").write_text(fitted)
    other = harness.run("eval", "fits.json", "-", cwd=desk, stdin=(desk / "matte.csv").read_bytes())
    assert direct.returncode == other.returncode == 0
    assert direct.stdout == other.stdout


def test_pretty_printed(desk):
    """What a JSON tool has laid out over lines is still the fit."""
    (line,) = harness.fit("matte.csv", cwd=desk)
    (desk / "pretty.json").write_text(json.dumps(line, indent=2))
    assert harness.run("eval", "pretty.json", "matte.csv", cwd=desk).returncode == 0


def test_contract_alone_is_enough(desk):
    """The members that the contract names, without our additions."""
    (line,) = harness.fit("two_lobe_satin.csv", "--lobes", "2", cwd=desk)
    keep = ["schema", "file", "status", "distribution", "norm", "lobes", "sigma", "x", "y", "channel_scale", "e2", "lower_bound",
            "gap", "rms", "samples_used", "samples_skipped", "boxes", "nodes", "seconds"]
    save(desk, {name: line[name] for name in keep})
    here, _, _ = figures(harness.run("eval", "fits.json", "two_lobe_satin.csv", cwd=desk).stderr)
    assert here == pytest.approx(line["e2"], rel=1e-12)


def test_a_line_without_a_list(desk):
    """Lines of a time before lists had one distribution for all lobes."""
    (line,) = harness.fit("two_lobe_satin.csv", "--lobes", "2", "--distribution", "blinn-phong", cwd=desk)
    del line["distributions"]
    save(desk, line)
    here, _, _ = figures(harness.run("eval", "fits.json", "two_lobe_satin.csv", cwd=desk).stderr)
    assert here == pytest.approx(line["e2"], rel=1e-12)


def spoil(line, name, value):
    return dict(line, **{name: value})


@pytest.mark.parametrize("name, value", [
    ("schema", "brdffit.fit/2"), ("lobes", 0), ("lobes", 4), ("lobes", "1"), ("sigma", [0]), ("sigma", [-1]), ("sigma", []),
    ("sigma", None),
    ("x", []), ("x", [1, 2, "3"]), ("x", [1, 2, -3]), ("y", [[1], [1]]), ("y", [[1], [1], [1, 2]]), ("y", [[1], [1], [1e999]]),
    ("channel_scale", [1, 1]), ("channel_scale", [1, 1, 0]), ("e2", None), ("e2", -1), ("rms", "none"), ("distribution", "phong"),
    ("distribution", 7), ("distributions", "ggx"), ("distributions", []), ("distributions", ["beckmann", "ggx"]),
    ("distributions", ["phong"]), ("distributions", [None]), ("distributions", ["ggx"]), ("channels", ["r"]),
    ("channels", [1, 2, 3]), ("quantity", "flux"), ("merl_bins", "middle"),
    ("merl_samples", "gone.csv"), ("max_incidence", 0), ("max_incidence", "off"),
])
def test_damaged_lines(desk, name, value):
    (line,) = harness.fit("matte.csv", cwd=desk)
    (desk / "fits.json").write_text(json.dumps(spoil(line, name, value)).replace("Infinity", "1e999"))
    done = harness.run("eval", "fits.json", "matte.csv", cwd=desk)
    assert done.returncode == 3
    assert done.stdout == "" and done.stderr.startswith("brdffit: fits.json: ")
    assert name == "schema" or name in done.stderr or name == "merl_samples"


@pytest.mark.parametrize("text", ["", "\n\n", "{", "[]", "7", "null", '"fit"', "{}", '{"schema": 1}', "\0\0", "[" * 5000,
                                  "theta_i,r\n1,2\n"])
def test_files_that_hold_no_fit(desk, text):
    (desk / "fits.json").write_text(text)
    done = harness.run("eval", "fits.json", "matte.csv", cwd=desk)
    assert done.returncode == 3 and done.stdout == "" and "fits.json" in done.stderr


def test_every_truncation(desk):
    """A line cut anywhere is refused, never half used."""
    done = harness.run("fit", "--json", "single.csv", cwd=desk)
    text = done.stdout.rstrip("\n")
    for size in range(0, len(text), 7):
        (desk / "fits.json").write_text(text[:size])
        assert harness.run("eval", "fits.json", "single.csv", cwd=desk).returncode == 3


def test_missing_files(desk):
    for arguments in (["gone.json", "matte.csv"], [".", "matte.csv"]):
        assert harness.run("eval", *arguments, cwd=desk).returncode == 1
    save(desk, *harness.fit("matte.csv", cwd=desk))
    assert harness.run("eval", "fits.json", "gone.csv", cwd=desk).returncode == 1
    assert harness.run("eval", "fits.json", "ragged.csv", cwd=desk).returncode == 3


def test_directions_without_channels(tmp_path):
    """A file that only names places is enough to evaluate at."""
    places = tmp_path / "places.csv"
    places.write_text("theta_i,phi_i,theta_o,phi_o\n10,0,20,180\n30,0,30,180\n")
    measured = tmp_path / "measured.csv"
    measured.write_text("theta_i,phi_i,theta_o,phi_o,r\n" + "".join(
        f"{i},0,{o},180,{0.1 + 0.01 * abs(i - o)}\n" for i in range(0, 60, 10) for o in (5, 25, 45)))
    fit = tmp_path / "fit.json"
    fit.write_text(harness.run("fit", "--json", str(measured)).stdout)
    done = harness.run("eval", str(fit), str(places))
    assert done.returncode == 0
    lines = done.stdout.splitlines()
    assert lines[0] == "theta_i,phi_i,theta_o,phi_o,r_fit"
    assert len(lines) == 3 and float(lines[2].split(",")[-1]) > 0
