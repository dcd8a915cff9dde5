"""Fresnel and diffuse terms on the command line: an independent formula gives what `eval` gives, truth is found again, and
what was fitted is said.

SPDX-License-Identifier: MIT
"""
import csv
import io
import json

import numpy as np
import pytest

import harness
import model
import stacks
import terms_model

F0 = [[0.04, 0.3], [0.08, 0.1], [0.9, 0.5]]
X_MORE = {"oren-nayar": [[0.06], [0.02], [0.1]], "burley": [[0.1, 0.05], [0.04, 0.02], [0.2, 0.3]]}
# The four microfacet-like distributions and the three of an exponent; a pair of one kind, a pair of two.
LOBES = [(name,) for name in model.DISTRIBUTIONS] + [("beckmann", "beckmann"), ("ggx", "ward")]


def truth(distributions, fresnel="schlick", diffuse="lambert"):
    lobes = len(distributions)
    out = {"distributions": list(distributions), "fresnel": fresnel, "diffuse": diffuse, "sigma": [0.15, 0.4][:lobes],
           "x": [0.2, 0.1, 0.3] if diffuse != "none" else [0, 0, 0], "y": [[0.3, 0.5][:lobes]] * 3,
           "x_more": X_MORE.get(diffuse)}
    if fresnel == "schlick":
        out["f0"] = [row[:lobes] for row in F0]
    return out


def measure(folder, true, **more):
    light, view = terms_model.geometry(400, **more)
    terms_model.write(folder / "made.csv", light, view, terms_model.radiance(true, light, view))
    return light, view


def fit(folder, true, *options, expect=0):
    names = ["--lobes", ",".join(true["distributions"]), "--fresnel", true["fresnel"], "--diffuse", true["diffuse"]]
    return harness.fit("made.csv", "--values", "radiance", *names, *options, cwd=folder, expect=expect)[0]


def evaluated(folder, line):
    """What `eval` writes for a fit's line, N x K."""
    (folder / "fit.json").write_text(json.dumps(line))
    done = harness.run("eval", "fit.json", "made.csv", cwd=folder)
    assert done.returncode == 0, done.stderr
    rows = list(csv.DictReader(io.StringIO(done.stdout)))
    return np.array([[float(row[name + "_fit"]) for name in "rgb"] for row in rows])


# Where a retro lobe is, v.h is nearly 1 and w nothing: these directions, about the mirror, do not tell its F0.
@pytest.mark.parametrize("distributions", [d for d in LOBES if "retro" not in d], ids=",".join)
def test_f0_is_found_again(tmp_path, distributions):
    true = truth(distributions)
    light, view = measure(tmp_path, true)
    line = fit(tmp_path, true, "--gap", "1e-6", "--absolute-gap", "1e-20" if len(distributions) == 1 else "1e-9")
    assert line["fresnel"] == "schlick" and line["max_incidence"] == 90 and line["status"] == "certified"
    if len(distributions) == 1:  # two lobes are certified before they are found to the last digit
        np.testing.assert_allclose(line["f0"], true["f0"], atol=1e-9, rtol=0)
        root = np.sqrt(true["f0"])
        np.testing.assert_allclose(line["ior"], (1 + root) / (1 - root), rtol=1e-7)
    assert np.all((np.array(line["f0_interval"])[..., 0] <= line["f0"]) & (np.array(line["f0_interval"])[..., 1] >= line["f0"]))
    np.testing.assert_allclose(evaluated(tmp_path, line), terms_model.radiance(line, light, view), rtol=1e-11, atol=1e-13)


@pytest.mark.parametrize("fresnel", ["none", "schlick"])
@pytest.mark.parametrize("diffuse", ["none", "lambert", "oren-nayar", "burley"])
def test_diffuse_terms_are_found_again(tmp_path, diffuse, fresnel):
    true = truth(("ggx",), fresnel, diffuse)
    light, view = measure(tmp_path, true)
    line = fit(tmp_path, true, "--gap", "1e-6", "--absolute-gap", "1e-20", "--max-incidence", "off")
    np.testing.assert_allclose(line["x"], true["x"], atol=1e-9, rtol=0)
    assert ("x_more" in line) == (diffuse in X_MORE) and ("f0" in line) == (fresnel == "schlick")
    if diffuse in X_MORE:
        np.testing.assert_allclose(line["x_more"], X_MORE[diffuse], atol=1e-8, rtol=0)
    np.testing.assert_allclose(evaluated(tmp_path, line), terms_model.radiance(line, light, view), rtol=1e-11, atol=1e-13)
    report = harness.run("fit", "made.csv", "--values", "radiance", "--distribution", "ggx", "--fresnel", fresnel,
                         "--diffuse", diffuse, "--max-incidence", "off", cwd=tmp_path).stdout
    assert ("roughness" in report) == (diffuse == "oren-nayar") and ("by x r" in report) == (diffuse == "burley")


@pytest.mark.parametrize("masking", ["smith", "smith-separable", "none"])
@pytest.mark.parametrize("name", ["ggx", "beckmann"])
def test_maskings_are_found_again(tmp_path, name, masking):
    true = truth((name,)) | {"masking": masking}
    light, view = measure(tmp_path, true)
    line = fit(tmp_path, true, "--gap", "1e-6", "--absolute-gap", "1e-20", "--masking", masking)
    assert line["masking"] == masking
    np.testing.assert_allclose(line["f0"], true["f0"], atol=1e-8, rtol=0)
    np.testing.assert_allclose(line["sigma"], true["sigma"], rtol=1e-8)
    np.testing.assert_allclose(evaluated(tmp_path, line), terms_model.radiance(line, light, view), rtol=1e-11, atol=1e-13)


def test_oren_nayars_roughness_is_told(tmp_path):
    s2 = 0.3 ** 2
    a, b = 1 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09)
    true = truth(("ggx",), "none", "oren-nayar") | {"x": [0.2 * a] * 3, "x_more": [[0.2 * b]] * 3}
    measure(tmp_path, true)
    report = harness.run("fit", "made.csv", "--values", "radiance", "--distribution", "ggx", "--diffuse", "oren-nayar",
                         "--max-incidence", "off", "--absolute-gap", "1e-20", cwd=tmp_path).stdout
    assert "(Oren-Nayar diffuse)" in " ".join(report.split())
    table = report[report.index("x A"):].splitlines()[1:4]
    assert [row.split()[-1] for row in table] == ["0.3"] * 3


def interval(line, light, view, values, k):
    """F0 of a one-lobe fit's channel k that raise its E^2 by no more than allowed: a scan over F0, each time by NNLS."""
    nnls = pytest.importorskip("scipy.optimize").nnls
    one = dict(line, x=[1.0], x_more=None, y=[[0.0]], f0=[[0.0]])
    diffuse = terms_model.radiance(one, light, view)
    data, e2 = values[:, k], []
    grid = np.linspace(0, 1, 2001)
    for f0 in [line["f0"][k][0], *grid]:
        lobe = terms_model.radiance(dict(one, x=[0.0], y=[[1.0]], f0=[[f0]]), light, view)
        e2.append(nnls(np.hstack([diffuse, lobe]), data)[1] ** 2)
    inside = grid[np.array(e2[1:]) <= e2[0] * (1 + 4 / (len(data) - 3))]
    return inside.min(), inside.max()


@pytest.mark.parametrize("v_h, told", [(None, True), (0.9, False)])
def test_f0_that_directions_do_not_tell(tmp_path, v_h, told):
    true = truth(("beckmann",))
    light, view = terms_model.geometry(400, v_h=v_h)
    values = terms_model.radiance(true, light, view)
    values = values * (1 + 0.01 * np.random.default_rng(1).standard_normal(values.shape))
    terms_model.write(tmp_path / "made.csv", light, view, values)
    line = fit(tmp_path, true)
    for k in range(3):
        np.testing.assert_allclose(line["f0_interval"][k][0], interval(line, light, view, values, k), atol=6e-4)
    report = harness.run("fit", "made.csv", "--values", "radiance", "--fresnel", "schlick", cwd=tmp_path).stdout
    assert ("F0 is not identified" in " ".join(report.split())) == (not told)


def test_what_is_proven_is_named(tmp_path):
    measure(tmp_path, truth(("beckmann",)))
    report = harness.run("fit", "made.csv", "--values", "radiance", "--lobes", "ggx,beckmann", "--fresnel", "schlick",
                         "--diffuse", "burley", "--absolute-gap", "1e-4", cwd=tmp_path).stdout
    assert "one GGX and one Beckmann lobe (Schlick Fresnel, Burley diffuse) with" in " ".join(report.split())


def test_the_incidence_limit_is_off_with_fresnel(tmp_path):
    measure(tmp_path, truth(("beckmann",)))
    assert [fit(tmp_path, truth(("beckmann",), fresnel), *more)["max_incidence"] for fresnel, more in (
        ("none", ()), ("schlick", ()), ("schlick", ("--max-incidence", "60")))] == [60, 90, 60]


@pytest.mark.parametrize("member, value", [("fresnel", "snell"), ("diffuse", 1), ("masking", "smitten"), ("f0", [[0.1]]),
                                           ("f0", [[0.1], [1.1], [0.1]]), ("f0", None), ("x_more", [[1], [2]])])
def test_lines_that_are_wrong_are_refused(tmp_path, member, value):
    true = truth(("beckmann",), diffuse="oren-nayar")
    measure(tmp_path, true)
    (tmp_path / "fit.json").write_text(json.dumps(fit(tmp_path, true) | {member: value}))
    done = harness.run("eval", "fit.json", "made.csv", cwd=tmp_path)
    assert done.returncode == 3 and '"%s" is missing or wrong' % member in done.stderr


def test_lines_from_before_there_were_any_are_read(tmp_path):
    true = truth(("beckmann",), "none")
    measure(tmp_path, true)
    line = fit(tmp_path, true)
    old = {name: value for name, value in line.items() if name not in ("fresnel", "diffuse", "masking")}
    np.testing.assert_array_equal(evaluated(tmp_path, old), evaluated(tmp_path, line))


def test_names_that_are_none(tmp_path):
    for option in ("--fresnel", "--diffuse", "--masking"):
        done = harness.run("fit", option, "lambertt", "made.csv", cwd=tmp_path)
        assert done.returncode == 2 and "valid values" in done.stderr


@pytest.mark.parametrize("own", [False, True], ids=["shared", "own directions"])
def test_maps_are_the_fits_of_their_texels(tmp_path, own):
    true = truth(("beckmann",), diffuse="oren-nayar")
    light, view = measure(tmp_path, true, seed=5)
    values = terms_model.radiance(true, light, view)[:, None, None] * np.linspace(0.5, 2, 6).reshape(2, 3)[..., None]
    values = values * (1 + 0.01 * np.random.default_rng(2).standard_normal(values.shape))
    np.save(tmp_path / "stack.npy", values)
    np.save(tmp_path / "normals.npy", np.broadcast_to([0.0, 0.0, 1.0], (2, 3, 3)))
    stacks.vectors_csv(tmp_path / "geometry.csv", light, view)
    options = ["--values", "radiance", "--fresnel", "schlick", "--diffuse", "oren-nayar"]
    where = ["stack.npy", "-g", "geometry.csv", *(["--normals", "normals.npy"] if own else [])]
    done = harness.run("map", *where, *options, "-o", "maps", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = {name: np.load(tmp_path / "maps" / (name + ".npy")) for name in ("sigma", "x", "y", "f0", "x_more", "e2")}
    about = json.loads((tmp_path / "maps" / "map.json").read_text())
    assert (about["fresnel"], about["diffuse"], about["masking"]) == ("schlick", "oren-nayar", "v-cavity")
    for i, j in np.ndindex(2, 3):
        terms_model.write(tmp_path / "made.csv", light, view, values[:, i, j])
        line = harness.fit("made.csv", *options, cwd=tmp_path)[0]
        for name, array in found.items():
            np.testing.assert_array_equal(array[i, j], line[name], name)


def test_parts_of_maps_with_other_terms_do_not_mix(tmp_path):
    true = truth(("beckmann",))
    light, view = measure(tmp_path, true)
    np.save(tmp_path / "stack.npy", np.broadcast_to(terms_model.radiance(true, light, view)[:, None, None], (len(light), 4, 1, 3)))
    stacks.vectors_csv(tmp_path / "geometry.csv", light, view)
    part = ["map", "stack.npy", "-g", "geometry.csv", "--values", "radiance", "--fresnel", "schlick", "--tile", "1", "-o", "maps"]
    assert harness.run(*part, "--shard", "1/2", cwd=tmp_path).returncode == 0
    for other in (["--diffuse", "burley"], ["--fresnel", "none", "--max-incidence", "off"]):
        done = harness.run(*part, *other, "--shard", "2/2", cwd=tmp_path)
        assert done.returncode == 2 and "differs" in done.stderr
    assert harness.run(*part, "--shard", "2/2", cwd=tmp_path).returncode == 0
    done = harness.run("merge", "maps", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "maps" / "map.json").read_text())["fresnel"] == "schlick"
    np.testing.assert_allclose(np.load(tmp_path / "maps" / "f0.npy"), np.broadcast_to(true["f0"], (4, 1, 3, 1)), atol=1e-5)


def test_maps_as_images(tmp_path):
    true = truth(("beckmann", "ggx"))
    light, view = measure(tmp_path, true)
    values = terms_model.radiance(true, light, view)[:, None, None]
    np.save(tmp_path / "stack.npy", values)
    stacks.vectors_csv(tmp_path / "geometry.csv", light, view)
    done = harness.run("map", "stack.npy", "-g", "geometry.csv", "--values", "radiance", "--fresnel", "schlick", "--lobes",
                       "beckmann,ggx", "--format", "pfm", "--absolute-gap", "1e-5", "-o", "maps", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert {"f0_1.pfm", "f0_2.pfm"} <= {path.name for path in (tmp_path / "maps").iterdir()}
    assert stacks.read_pfm(tmp_path / "maps" / "f0_1.pfm").shape == (1, 1, 3)


def test_shards_of_fits_with_other_terms_do_not_mix(tmp_path):
    true = truth(("beckmann",))
    measure(tmp_path, true)
    (tmp_path / "copy.csv").write_bytes((tmp_path / "made.csv").read_bytes())
    for number, fresnel in ((1, "schlick"), (2, "none")):
        done = harness.run("fit", "made.csv", "copy.csv", "--json", "--values", "radiance", "--max-incidence", "off", "--fresnel",
                           fresnel, "--shard", "%d/2" % number, "-o", "part%d.json" % number, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    assert harness.run("merge", "part1.json", "part2.json", cwd=tmp_path).returncode != 0


@pytest.mark.parametrize("command", ["fit", "map"])
def test_the_help_and_the_manual_have_each_name(command):
    text = " ".join(harness.run(command, "--help").stdout.split())
    manual = (harness.ROOT / "tools" / "brdffit" / "brdffit.1").read_text().replace("\\-", "-")
    for name in ("schlick", "lambert", "oren-nayar", "burley", "v-cavity", "smith", "smith-separable"):
        assert name in text and name in manual, name
