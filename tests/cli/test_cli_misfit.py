"""How good an answer is: R^2 and what neighbours foretell, from the definition; and that a model which does not describe its
data is said not to, by what brdffit_quality() calls a misfit.

SPDX-License-Identifier: MIT
"""
import csv
import io

import numpy as np
import pytest

import harness
import model

MATCHED = [("two_lobe_satin.csv", ["--lobes", "2"]), ("two_lobe_exact.csv", ["--lobes", "2"]),
           ("ggx_metal.csv", ["--model", "principled"]), ("matte.csv", ["--diffuse", "oren-nayar"])]
MISMATCHED = [("two_lobe_satin.csv", []), ("two_lobe_exact.csv", []), ("two_lobe_satin.csv", ["--distribution", "ggx"]),
              ("two_lobe_satin.csv", ["--model", "principled"]), ("ggx_metal.csv", []), ("matte.csv", []),
              ("matte.csv", ["--lobes", "2"]), ("two_lobe_outliers.csv", ["--lobes", "2"])]


def residuals(desk, line, path):
    """Radiance and residuals of the samples that were used, in units of each channel's largest, from `eval`; their places."""
    (desk / "line.json").write_text(harness.json.dumps(line))
    table = list(csv.DictReader(io.StringIO(harness.run("eval", "-q", "line.json", path, cwd=desk).stdout)))
    angles = np.array([[float(row[n]) for n in ("theta_i", "phi_i", "theta_o", "phi_o")] for row in table])
    nl = np.cos(np.radians(angles[:, 0]))
    used = (angles[:, 0] <= line["max_incidence"] + 1e-9) & (angles[:, 2] < 90)
    measured, fitted = (np.array([[float(row[c + what]) for c in line["channels"]] for row in table]) * nl[:, None]
                        for what in ("_measured", "_fit"))
    measured, fitted, angles = measured[used], fitted[used], angles[used]
    largest = np.abs(measured).max(0)
    return measured / largest, (measured - fitted) / largest, angles


def foreseen(r, angles):
    """By the four nearest samples, weighted by 1 / distance."""
    light, view = model.unit(angles[:, 0], angles[:, 1]), model.unit(angles[:, 2], angles[:, 3])
    sl, sv = (np.hypot(d[:, 0], d[:, 1]) for d in (light, view))
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = np.where(sl * sv > 0, (light[:, :2] * view[:, :2]).sum(1) / (sl * sv), 1.0).clip(-1, 1)
    at = np.stack([sl, sv * cosine, sv * np.sqrt(1 - cosine ** 2)], 1)
    distance2 = ((at[:, None] - at[None]) ** 2).sum(2)
    np.fill_diagonal(distance2, np.inf)
    near = np.argsort(np.round(distance2, 12), axis=1, kind="stable")[:, :4]
    weight = 1 / np.sqrt(np.take_along_axis(distance2, near, 1) + 1e-6)
    foretold = np.einsum("ik,ikc->ic", weight / weight.sum(1, keepdims=True), r[near])
    return 1 - ((r - foretold) ** 2).sum() / (r ** 2).sum()


@pytest.mark.parametrize("name, options", [case for case in MATCHED + MISMATCHED if case[0] != "two_lobe_exact.csv"])
def test_figures_are_their_definition(desk, name, options):
    (line,) = harness.fit(name, *options, cwd=desk)
    value, r, angles = residuals(desk, line, name)
    spread = ((value - value.mean(0)) ** 2).sum(0)
    assert line["r2"] == pytest.approx(1 - (r ** 2).sum(0) / spread, abs=1e-9)
    assert line["r2_total"] == pytest.approx(1 - (r ** 2).sum() / spread.sum(), abs=1e-9)
    assert line["relative_rms"] == pytest.approx(np.sqrt((r ** 2).sum() / (value ** 2).sum()), rel=1e-7)
    assert line["foreseen"] == pytest.approx(foreseen(r, angles), abs=0.02)  # equal distances may come in another order


@pytest.mark.parametrize("name, options", MATCHED)
def test_a_model_that_describes_its_data(desk, name, options):
    (line,) = harness.fit(name, *options, cwd=desk)
    assert line["misfit"] == [] and min(line["r2"]) > 0.99


@pytest.mark.parametrize("name, options", MISMATCHED)
def test_a_model_that_does_not(desk, name, options):
    done = harness.run("fit", "--json", name, *options, cwd=desk)
    (line,) = harness.lines(done.stdout)
    assert line["misfit"], (line["r2_total"], line["relative_rms"], line["foreseen"])
    assert "warning: misfit: this model does not describe these data" in done.stderr
    assert "Warning, misfit: this model does not describe" in harness.run("fit", name, *options, cwd=desk).stdout


def test_noise_of_other_seeds(tmp_path):
    """The verdict does not hang on one draw of the noise."""
    for seed in ("2", "3", "4"):
        assert harness.run(tmp_path, "--seed", seed, program=harness.GONIOMETER).returncode == 0
        for cases, wanted in ((MATCHED, False), (MISMATCHED, True)):
            for name, options in cases:
                if name != "two_lobe_outliers.csv":
                    (line,) = harness.fit(name, *options, cwd=tmp_path)
                    assert bool(line["misfit"]) == wanted, (seed, name, options, line["foreseen"])


def test_too_few_values(desk):
    done = harness.run("fit", "single.csv", cwd=desk)
    assert "1 value for 3 parameters" in done.stdout.replace("\n  ", " ")
