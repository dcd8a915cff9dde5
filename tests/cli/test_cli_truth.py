"""The goniometer's materials: the same bytes from the same seed, and fits that find what they were made from.

SPDX-License-Identifier: MIT
"""
import json

import numpy as np
import pytest

import harness
import model


def truth_of(folder, name):
    truth = json.loads((folder / "truth.json").read_text())
    (entry,) = [entry for entry in truth["files"] if entry["file"] == name]
    return entry


@pytest.mark.parametrize("name", ["two_lobe_exact.csv", "two_lobe_table.binary"])
def test_exact_truth_is_found(instruments, name):
    """Noise-free data give the truth to 1e-9."""
    truth = truth_of(instruments, name)
    (line,) = harness.fit("--lobes", "2", name, cwd=instruments)
    assert line["status"] == "certified"
    assert line["sigma"] == pytest.approx(truth["sigma"], rel=1e-9)
    assert line["x"] == pytest.approx(truth["x"], rel=1e-9)
    assert np.allclose(line["y"], truth["y"], rtol=1e-9)
    assert line["e2"] <= 1e-24 * line["sum_of_squares"]


def test_noisy_truth_is_found(instruments):
    """1 % noise on 260 samples: within three per cent, and the residuals are the noise that was put in."""
    truth = truth_of(instruments, "two_lobe_satin.csv")
    (line,) = harness.fit("--lobes", "2", "two_lobe_satin.csv", cwd=instruments)
    assert line["sigma"] == pytest.approx(truth["sigma"], rel=0.03)
    assert np.allclose(line["y"], truth["y"], rtol=0.03)
    samples = model.Samples(instruments / "two_lobe_satin.csv", "brdf", distributions=["beckmann"] * 2)
    exact = samples.prediction(truth["sigma"], truth["x"], truth["y"])
    noise = np.sqrt(np.mean((samples.radiance - exact) ** 2, 0))
    assert np.all(np.array(line["rms"]) <= noise * (1 + 1e-12))
    assert line["rms"] == pytest.approx(noise, rel=0.1)


def test_fit_is_no_worse_than_truth(instruments):
    """A global optimum lies at or below the E^2 of the truth."""
    truth = truth_of(instruments, "two_lobe_satin.csv")
    (line,) = harness.fit("--lobes", "2", "two_lobe_satin.csv", cwd=instruments)
    samples = model.Samples(instruments / "two_lobe_satin.csv", "brdf", distributions=["beckmann"] * 2)
    e2, _ = samples.figures(dict(line, sigma=truth["sigma"], x=truth["x"], y=truth["y"]))
    assert line["lower_bound"] <= e2
    assert line["e2"] <= (1 + line["relative_gap"]) * e2


def test_instrument_follows_the_model(instruments):
    """The goniometer's formula and the numpy one agree on the exact file to rounding."""
    truth = truth_of(instruments, "two_lobe_exact.csv")
    samples = model.Samples(instruments / "two_lobe_exact.csv", "brdf", max_incidence=90, distributions=["beckmann"] * 2)
    exact = samples.prediction(truth["sigma"], truth["x"], truth["y"])
    assert np.allclose(samples.radiance, exact, rtol=1e-13)


def test_wrong_model_says_so(instruments):
    """GGX data: the right distribution leaves far less than the wrong one, and a matte material no resolved lobe."""
    (wrong,) = harness.fit("ggx_metal.csv", cwd=instruments)
    (right,) = harness.fit("ggx_metal.csv", "--distribution", "ggx", cwd=instruments)
    assert right["lower_bound"] * 10 < wrong["lower_bound"]
    assert right["e2"] < wrong["lower_bound"]
    (matte,) = harness.fit("matte.csv", cwd=instruments)
    assert "at_limit" in matte["warnings"][0] or matte["sigma"][0] > 1


def test_same_seed_same_bytes(instruments, tmp_path):
    for folder, arguments in (("again", ["--seed", "1", "--outliers", "0.1"]), ("other", ["--seed=2"])):
        done = harness.run(folder, *arguments, program=harness.GONIOMETER, cwd=tmp_path)
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    names = sorted(file.name for file in instruments.iterdir())
    assert names == sorted(file.name for file in (tmp_path / "again").iterdir())
    for name in names:
        assert (tmp_path / "again" / name).read_bytes() == (instruments / name).read_bytes()
    other = tmp_path / "other"
    assert not (other / "two_lobe_outliers.csv").exists()
    assert (other / "two_lobe_satin.csv").read_bytes() != (instruments / "two_lobe_satin.csv").read_bytes()

    def strip(path):
        return [line for line in path.read_text().splitlines() if "seed" not in line]

    assert strip(other / "two_lobe_exact.csv") == strip(instruments / "two_lobe_exact.csv")


def test_outliers(instruments, tmp_path):
    """Exactly the fraction asked for is spoilt; the rest follows the model to the noise."""
    truth = truth_of(instruments, "two_lobe_outliers.csv")
    samples = model.Samples(instruments / "two_lobe_outliers.csv", "brdf", max_incidence=90, distributions=["beckmann"] * 2)
    exact = samples.prediction(truth["sigma"], truth["x"], truth["y"])
    assert len(truth["outliers"]) == round(0.1 * samples.total) == len(set(truth["outliers"]))
    good = np.ones(samples.total, bool)
    good[truth["outliers"]] = False
    deviation = np.abs(samples.radiance - exact) / (0.01 * exact + 5e-4)
    assert deviation[good].max() < 6
    assert np.mean(deviation[~good] > 6) > 0.9


@pytest.mark.parametrize("arguments, code, words", [
    ([], 2, "OUTDIR"), (["a", "b"], 2, "only one OUTDIR"), (["a", "--seed"], 2, "--seed"), (["a", "--seed", "-1"], 2, "--seed"),
    (["a", "--seed", "1x"], 2, "'1x'"), (["a", "--outliers", "1"], 2, "--outliers"), (["a", "--outliers=nan"], 2, "'nan'"),
    (["a", "--sede", "1"], 2, "--sede"), (["missing/a"], 1, "missing/a"), (["file"], 1, "file"),
])
def test_goniometer_refuses(tmp_path, arguments, code, words):
    (tmp_path / "file").write_text("in the way")
    done = harness.run(*arguments, program=harness.GONIOMETER, cwd=tmp_path)
    assert done.returncode == code
    assert words in done.stderr and done.stdout == ""
    assert [file.name for file in tmp_path.iterdir()] == ["file"]


def test_goniometer_help():
    done = harness.run("--help", program=harness.GONIOMETER)
    assert done.returncode == 0 and done.stderr == ""
    for word in ("--seed", "--outliers", "two_lobe_table.binary", "truth.json"):
        assert word in done.stdout


@pytest.fixture(scope="module")
def bright(tmp_path_factory):
    """Light that a surface could not send back: x = 1.2 in one channel, 0.5 in the other, and a lobe."""
    folder = tmp_path_factory.mktemp("bright")
    lines = ["theta_i,phi_i,theta_o,phi_o,r,g"]
    for light in range(0, 61, 10):
        for view in (0, 20, 40):
            for azimuth in (0, 90, 180):
                half = abs(light - view) / 2 if azimuth == 180 else (light + view) / 2
                peak = 0.05 * np.exp(-np.tan(np.radians(half)) ** 2 / 0.04)
                lines.append("%d,%d,%d,0,%.17g,%.17g" % (light, azimuth, view, 1.2 / np.pi + peak, 0.5 / np.pi + peak))
    (folder / "bright.csv").write_text("\n".join(lines) + "\n")
    (folder / "dim.csv").write_text("\n".join([lines[0]] + [
        ",".join(line.split(",")[:4] + ["%.17g" % (0.25 * float(v)) for v in line.split(",")[4:]]) for line in lines[1:]]) + "\n")
    return folder


def reflected(line):
    return [x + sum(4 * v for v in y) for x, y in zip(line["x"], line["y"])]


def test_physical_bounds(bright):
    """They hold where the data break them, cost what is said, and say where they bind."""
    (free,) = harness.fit("bright.csv", cwd=bright)
    (line,) = harness.fit("--physical", "bright.csv", cwd=bright)
    assert max(reflected(free)) > 1.1 and max(reflected(line)) <= 1
    assert line["status"] == "certified" and line["physical"] == {"channels_at_limit": 1, "e2_free": free["e2"]}
    assert free["lower_bound"] < line["lower_bound"] <= line["e2"]
    said = harness.run("fit", "--physical", "bright.csv", cwd=bright).stdout
    assert "bind in channel r:" in " ".join(said.split())
    assert "%.3g %% above" % (100 * (line["e2"] / free["e2"] - 1)) in " ".join(said.split())


def test_physical_bounds_that_do_not_bind(bright):
    """The bits of the free fit."""
    (free,), (line,) = (harness.fit(*more, "dim.csv", cwd=bright) for more in ((), ("--physical",)))
    assert line.pop("physical") == {"channels_at_limit": 0, "e2_free": free["e2"]}
    assert {k: v for k, v in line.items() if k != "seconds"} == {k: v for k, v in free.items() if k != "seconds"}
    assert "bind nowhere" in harness.run("fit", "--physical", "dim.csv", cwd=bright).stdout


@pytest.mark.parametrize("more", [("--norm", "l1"), ("--engine", "socp"), ("--distribution", "torrance-sparrow")])
def test_physical_bounds_are_refused(bright, more):
    done = harness.run("fit", "--physical", *more, "bright.csv", cwd=bright)
    assert done.returncode != 0 and "physical bounds" in done.stderr
