"""--weight, and the column of uncertainties. SPDX-License-Identifier: MIT"""
import numpy as np
import pytest

import harness

RNG = np.random.default_rng(4)


def unit(d):
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def scene(count, crowded):
    """A lobe about the mirror direction over a dull ground, and where an instrument may look at it."""
    light, view, half = (RNG.standard_normal((count, 3)) for _ in range(3))
    for d in (light, view):
        d[:, 2] = np.abs(d[:, 2]) + 0.1
    light, view = unit(light), unit(view)
    if crowded:
        half = unit(half * [0.05, 0.05, 0] + [0, 0, 1])
        mirrored = 2 * np.sum(light * half, 1, keepdims=True) * half - light
        view = np.where(mirrored[:, 2:] > 0.05, mirrored, view)
    tilt = unit(light + view)[:, 2]
    return light, view, 0.1 + 20 * np.exp(-(1 / tilt**2 - 1) / 0.01)


def table(path, light, view, values, **more):
    columns = np.column_stack([light, view, values, *more.values()])
    np.savetxt(path, columns, "%.17g", ",", header=",".join(["lx,ly,lz,vx,vy,vz,f", *more]), comments="")
    return path


def same(a, b):
    names = ("e2", "lower_bound", "sigma", "x", "y", "rms")
    return all(np.allclose(a[name], b[name], rtol=1e-9, atol=0) for name in names)


@pytest.mark.parametrize("name", ["uncertainty", "stddev", "std"])
def test_uncertainty_is_a_weight_of_radiance(tmp_path, name):
    light, view, f = scene(200, False)
    u = RNG.uniform(0.01, 2, 200)
    by_f = harness.fit(table(tmp_path / "f.csv", light, view, f, **{name: u}))[0]
    wanted = harness.fit(table(tmp_path / "w.csv", light, view, f, weight=1 / (u * light[:, 2]) ** 2))[0]
    assert by_f["weighting"] == "column" and same(by_f, wanted)
    radiance = ("--values", "radiance")
    by_radiance = harness.fit(table(tmp_path / "r.csv", light, view, f, **{name: u}), *radiance)[0]
    assert same(by_radiance, harness.fit(table(tmp_path / "v.csv", light, view, f, weight=1 / u**2), *radiance)[0])
    both = harness.fit(table(tmp_path / "b.csv", light, view, f, weight=u, **{name: u}), *radiance)[0]
    assert same(both, harness.fit(table(tmp_path / "o.csv", light, view, f, weight=1 / u), *radiance)[0])


@pytest.mark.parametrize("value", ["0", "-1", "1e-200", "1e300"])
def test_uncertainty_that_is_none(tmp_path, value):
    path = tmp_path / "bad.csv"
    path.write_text("theta_i,theta_o,f,uncertainty\n10,20,1,1\n20,30,1,%s\n" % value)
    done = harness.run("fit", path)
    assert done.returncode == 3 and "uncertainty" in done.stderr and "line 3" in done.stderr


def test_columns_of_weights(tmp_path):
    light, view, f = scene(200, False)
    plain, weighted = tmp_path / "plain.csv", tmp_path / "weighted.csv"
    table(plain, light, view, f)
    table(weighted, light, view, f, weight=RNG.uniform(0.5, 2, 200))
    assert harness.fit(plain)[0]["weighting"] == "none" and harness.fit(weighted)[0]["weighting"] == "column"
    assert same(harness.fit(plain)[0], harness.fit(weighted, "--weight", "none")[0])
    done = harness.run("fit", plain, "--weight", "column")
    assert done.returncode == 3 and "there is no column weight or uncertainty" in done.stderr


@pytest.mark.parametrize("weight", ["cosine", "solid-angle", "relative"])
def test_eval_weighs_as_the_fit_did(tmp_path, weight):
    path = table(tmp_path / "a.csv", *scene(300, True))
    line = tmp_path / "fit.json"
    harness.run("fit", path, "--weight", weight, "--json", "-o", line)
    assert harness.lines(line.read_text())[0]["weighting"] == weight
    done = harness.run("eval", line, path)
    assert done.returncode == 0 and "not the E^2" not in done.stderr and "E² " in done.stderr


def test_text_says_which_and_warns(tmp_path):
    uniform, crowd = (table(tmp_path / name, *scene(1500, name == "crowd.csv")) for name in ("uniform.csv", "crowd.csv"))
    assert "crowd where the material is bright" in " ".join(harness.run("fit", crowd).stdout.split())
    for options in ((uniform,), (crowd, "--weight", "solid-angle")):
        assert "crowd where" not in harness.run("fit", *options).stdout
    assert "Weights: the solid angle" in harness.run("fit", crowd, "--weight", "solid-angle").stdout


def test_coefficients(tmp_path):
    """They have values and no directions."""
    path = tmp_path / "abc.csv"
    path.write_text("a,b,c,f\n" + "".join("0.3,0.2,%g,%g\n" % (0.01 * i, 1 / (1 + i)) for i in range(20)))
    done = harness.run("fit", path, "--weight", "solid-angle")
    assert done.returncode == 2 and "no directions" in done.stderr
    assert harness.fit(path, "--weight", "relative")[0]["weighting"] == "relative"
