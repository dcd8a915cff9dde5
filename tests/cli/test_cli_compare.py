"""compare, --lobes auto and --model: the form that made the data is named, ties are said to be ties, and every figure follows
from the fits' own lines.

SPDX-License-Identifier: MIT
"""
import itertools
import math
import re
import resource
import signal

import numpy as np
import pytest
from scipy.optimize import nnls

import harness
import model
import terms_model
from test_cli_process import reading, start

SINGLES = list(model.DISTRIBUTIONS)
DOZEN = ["beckmann", "ggx", "ward", "blinn-phong", "ashikhmin-shirley", "lafortune", "2beckmann", "2ggx", "beckmann/schlick",
         "2beckmann/schlick", "ggx/smith/schlick", "ggx/smith/schlick/burley", "beckmann/oren-nayar"]
TERMS = {"v-cavity": ("masking", "v-cavity"), "smith": ("masking", "smith"), "no-masking": ("masking", "none"),
         "smith-separable": ("masking", "smith-separable"), "schlick": ("fresnel", "schlick"), "no-fresnel": ("fresnel", "none"),
         "lambert": ("diffuse", "lambert"), "burley": ("diffuse", "burley"), "oren-nayar": ("diffuse", "oren-nayar"),
         "no-diffuse": ("diffuse", "none")}


def compare(*arguments, expect=(0,), **more):
    """The lines of the models, and the verdict. expect: exit codes, 4 where a search may be open."""
    done = harness.run("compare", "--json", *arguments, **more)
    assert done.returncode in expect, done.stderr
    *fits, verdict = harness.lines(done.stdout)
    assert verdict["schema"] == "brdffit.comparison/1"
    return fits, verdict


def ranks(verdict):
    return {one["model"]: one["rank"] for one in verdict["models"]}


def shape_of(name):
    """What the lobes of a model are, of its name alone."""
    return [kind for part in name.split("/")[0].split("+") for kind in
            ([part[1:]] * int(part[0]) if part[0] in "123" else [part])]


def options_of(name):
    """Of `fit`: the same form, but for the limit of incidence."""
    return ["--lobes", ",".join(shape_of(name)),
            *(word for term in name.split("/")[1:] for word in ("--" + TERMS[term][0], TERMS[term][1]))]


def parameters_of(name, channels):
    """All that is fitted: docs/compare.md."""
    terms = dict(TERMS[term] for term in name.split("/")[1:])
    lobes = len(shape_of(name))
    diffuse = {"lambert": 1, "none": 0, "oren-nayar": 2, "burley": 3}[terms.get("diffuse", "lambert")]
    return channels * (diffuse + lobes * (2 if "fresnel" in terms else 1)) + lobes + 1


def angles(lights=(0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60), views=(0, 20, 40, 60), azimuths=(0, 10, 30, 90, 180)):
    return np.array([(ti, pi, to, 180.0) for to, ti, pi in itertools.product(views, lights, azimuths)])


def instrument(path, truth, noise=0.01, seed=1, **directions):
    """A file of a material: truth is a list of (distribution, sigma, y of each of three channels)."""
    at = angles(**directions)
    light, view = model.unit(at[:, 0], at[:, 1]), model.unit(at[:, 2], at[:, 3])
    value = np.full((len(at), 3), [0.30, 0.20, 0.10]) * (light[:, 2] / math.pi)[:, None]
    for distribution, sigma, y in truth:
        _, b, c, _, _ = model.directions_to_abc(light, view, distribution=distribution)
        value += np.outer(b * model.shape(distribution, sigma ** -2, c), y)
    value = value / light[:, 2:] * (1 + noise * np.random.default_rng(seed).standard_normal(value.shape))
    rows = ["%.6g,%.6g,%.6g,%.6g,%.9g,%.9g,%.9g" % (*a, *v) for a, v in zip(at, value)]
    path.write_text("theta_i,phi_i,theta_o,phi_o,r,g,b\n" + "\n".join(rows) + "\n")
    return path


# ---- The truth is named --------------------------------------------------


def test_satin_is_two_beckmann_lobes(instruments):
    """The goniometer's paint, 1 % noise: named, and every other form of the list proven to be behind."""
    fits, verdict = compare("two_lobe_satin.csv", cwd=instruments)
    assert [fit["comparison"]["model"] for fit in fits] == DOZEN
    assert (verdict["verdict"], verdict["best"], verdict["tied"]) == ("one", "2beckmann", [])
    assert set(ranks(verdict).values()) == {"best", "proven_behind"}
    by_name = {one["model"]: one for one in verdict["models"]}
    # The certified statements: the same lobes with Fresnel are the only form that may be better, and by how little.
    for name, one in by_name.items():
        assert (one["lower_bound"] > by_name["2beckmann"]["e2"]) == (name not in ("2beckmann", "2beckmann/schlick"))
    assert by_name["2beckmann/schlick"]["lower_bound"] > 0.99 * by_name["2beckmann"]["e2"]


def test_exact_satin_is_two_beckmann_lobes(instruments):
    """Without noise, E^2 of two forms is rounding: the simpler is named."""
    _, verdict = compare("two_lobe_exact.csv", cwd=instruments)
    assert (verdict["verdict"], verdict["best"]) == ("one", "2beckmann")
    assert verdict["models"][1]["model"] == "2beckmann/schlick"


def test_metal_is_ggx_with_smith_and_schlick(instruments):
    """Without a diffuse term, when that is on the list. Both of Smith's maskings are as good at these angles, and that is said;
    GGX alone is proven to leave several times as much."""
    _, verdict = compare("ggx_metal.csv", cwd=instruments)
    assert (verdict["verdict"], verdict["best"]) == ("one", "ggx/smith/schlick")
    by_name = {one["model"]: one for one in verdict["models"]}
    assert by_name["ggx"]["lower_bound"] > 3 * by_name["ggx/smith/schlick"]["e2"]
    models = ["ggx", "ggx/smith", "ggx/schlick", "ggx/smith/schlick", "ggx/smith-separable/schlick/no-diffuse",
              "ggx/smith/schlick/no-diffuse", "beckmann/smith/schlick/no-diffuse"]
    _, verdict = compare("--models", ",".join(models), "ggx_metal.csv", cwd=instruments)
    assert {verdict["best"], *verdict["tied"]} == {"ggx/smith-separable/schlick/no-diffuse", "ggx/smith/schlick/no-diffuse"}


def test_plaster_is_oren_nayar(instruments):
    """Every form has a lobe; what tells is the diffuse term, and of the lobe nothing. Lafortune's may stay open at grazing
    light."""
    _, verdict = compare("matte.csv", cwd=instruments, expect=(0, 4))
    assert (verdict["verdict"], verdict["best"]) == ("one", "beckmann/oren-nayar")
    _, verdict = compare("--models", "beckmann/oren-nayar,ggx/oren-nayar,beckmann,beckmann/burley", "matte.csv", cwd=instruments)
    assert {verdict["best"], *verdict["tied"]} == {"beckmann/oren-nayar", "ggx/oren-nayar"}


def test_plaster_is_none_of_these(instruments):
    """Oren-Nayar is not on the list: the best is on the limit of its range, and that is said."""
    done = harness.run("compare", "--models", "beckmann,ggx,ward", "matte.csv", cwd=instruments)
    assert done.returncode == 0
    assert "perhaps no form of this list is that of the material" in " ".join(done.stdout.split())


@pytest.mark.parametrize("distribution", SINGLES)
def test_each_distribution_is_named(tmp_path, distribution):
    """1 % noise on data that an independent formula made: the truth is best or among the undecided, and with two lobes more
    is not supported."""
    path = instrument(tmp_path / "one.csv", [(distribution, 0.2, [0.05, 0.04, 0.03])])
    _, verdict = compare("--models", ",".join([*SINGLES, "2" + distribution]), "--box-budget", "50000", path, expect=(0, 4))
    assert distribution in (verdict["best"], *verdict["tied"]), verdict
    assert ranks(verdict)["2" + distribution] != "best"
    if distribution != "blinn-phong":  # at these angles hardly any two others are alike
        assert verdict["best"] == distribution


@pytest.mark.parametrize("pair", ["beckmann+ggx", "ggx+ward", "2ggx"])
def test_pairs_are_named(tmp_path, pair):
    first, second = shape_of(pair)
    path = instrument(tmp_path / "two.csv", [(first, 0.1, [0.02, 0.02, 0.02]), (second, 0.5, [0.08, 0.06, 0.05])])
    models = ["beckmann", "ggx", "ward", "2beckmann", "2ggx", "2ward", "beckmann+ggx", "ggx+ward"]
    _, verdict = compare("--models", ",".join(models), path)
    assert (verdict["verdict"], verdict["best"]) == ("one", pair)


def test_the_data_cannot_tell(tmp_path):
    """All samples at two half-vector angles in the same ratio for every lobe: one lobe is as good as the other, exactly."""
    path = tmp_path / "abc.csv"
    noise = np.random.default_rng(3).standard_normal(40)
    rows = ["%g,%g,%g,%.9g" % (0.3, 0.5, c, 0.1 + 0.5 * math.exp(-9 * c) + 0.01 * e)
            for c, e in zip(itertools.cycle([0.0, 0.1]), noise)]
    path.write_text("a,b,c,r\n" + "\n".join(rows) + "\n")
    fits, verdict = compare("--models", "beckmann,ggx,2beckmann", path)
    e2 = [fit["e2"] for fit in fits]
    assert max(e2) <= (1 + 1e-3) * min(e2)
    assert verdict["verdict"] == "cannot_tell"
    assert {verdict["best"], *verdict["tied"]} == {"beckmann", "ggx"}
    assert ranks(verdict)["2beckmann"] == "proven_behind" or verdict["models"][2]["delta"] < 6 + math.log(40)
    done = harness.run("compare", "--models", "beckmann,ggx", path)
    assert "Undecided: the data cannot tell it from" in done.stdout


# ---- Figures -------------------------------------------------------------


def criteria_of(e2, n, p):
    """Written from docs/compare.md."""
    likelihood = -n / 2 * math.log(2 * math.pi * e2 / n) - n / 2
    constant = n * (1 + math.log(2 * math.pi))  # that the program leaves out
    return {"aic": -2 * likelihood + 2 * p - constant, "bic": -2 * likelihood + p * math.log(n) - constant,
            "aicc": -2 * likelihood + 2 * p + 2 * p * (p + 1) / (n - p - 1) - constant}


@pytest.mark.parametrize("name, columns", [("beckmann/schlick", 3), ("ggx/smith/schlick/burley", 5), ("beckmann/no-diffuse", 1),
                                           ("beckmann/smith-separable/oren-nayar", 3)])
def test_bic_of_forms_with_terms(instruments, name, columns):
    """Recomputed from the file alone: the columns at the roughness found, non-negative least squares, and a count by hand of
    what is fitted."""
    fits, verdict = compare("--models", name, "--observations", "all", "--max-incidence", "off", "ggx_metal.csv", cwd=instruments)
    (fit,), (one,) = fits, verdict["models"]
    light, view, radiance, _ = everything(instruments / "ggx_metal.csv")
    parts = columns_of(name, shape_of(name)[0], fit["sigma"][0], light, view)
    assert parts.shape == (300, columns)
    scaled = radiance / np.array(fit["channel_scale"])
    e2 = sum(nnls(parts, scaled[:, k])[1] ** 2 for k in range(3))
    assert one["e2"] == pytest.approx(e2, rel=1e-8)
    n, p = 3 * 300, 3 * columns + 1 + 1
    assert (verdict["effective_observations"], one["parameters"]) == (n, p) and p == parameters_of(name, 3)
    assert one["criteria"] == pytest.approx(criteria_of(e2, n, p), rel=1e-7)


def columns_of(name, kind, sigma, light, view):
    """Of one lobe and the diffuse term of a form's name, by terms_model.py: 300 x columns."""
    terms = dict(TERMS[term] for term in name.split("/")[1:])
    _, b, c, _, _ = model.directions_to_abc(light, view, distribution=kind)
    lobe = terms_model.masked(kind, terms.get("masking", "v-cavity"), sigma, light, view, b) * model.shape(kind, sigma ** -2, c)
    half = light + view
    half = half / np.linalg.norm(half, axis=1, keepdims=True)
    out = [lobe] if "fresnel" not in terms else [lobe, lobe * (1 - np.sum(view * half, 1)) ** 5]
    diffuse = terms.get("diffuse", "lambert")
    if diffuse != "none":
        out = [*terms_model.diffuse_columns(diffuse, light, view).T, *out]
    return np.stack(out, -1)


def weigh(path):
    """A copy with weights, some of them 0."""
    rows = [line for line in path.read_text().splitlines() if line[0] != "#"]
    out = path.with_name("weighted.csv")
    out.write_text("\n".join([rows[0] + ",weight", *("%s,%g" % (row, i % 7 / 2) for i, row in enumerate(rows[1:]))]) + "\n")
    return out.name


@pytest.mark.parametrize("file", ["two_lobe_satin.csv", "two_lobe_outliers.csv", "weighted.csv"])
def test_figures(desk, file):
    """Every fit is what `fit` makes of that form, to the bit; its criteria are those of its E^2 and its bound."""
    weigh(desk / "ggx_metal.csv")
    names = ("beckmann", "2ggx", "blinn-phong+ward", "ggx/smith/schlick", "beckmann/oren-nayar")
    models, effective = ("--models", ",".join(names), "--gap", "0.01"), {}
    fits, verdict = compare(*models, file, cwd=desk)
    for fit in fits:
        extra = fit.pop("comparison")
        (alone,) = harness.fit(*options_of(extra["model"]), "--gap", "0.01", "--max-incidence", "off", file, cwd=desk)
        assert {**fit, "seconds": None} == {**alone, "seconds": None}
        channels = len(fit["channels"])
        n, p = channels * fit["samples_used"], parameters_of(extra["model"], channels)
        assert (extra["observations"], extra["parameters"]) == (n, p) and verdict["observations"] == n
        assert extra["r2"] == pytest.approx(1 - fit["e2"] / fit["sum_of_squares"], rel=1e-14)
        effective[fit["e2"]] = extra["effective_observations"]
        assert extra["effective_observations"] == pytest.approx(min(n, uneven(fit, desk / file)), rel=1e-6)
    assert verdict["effective_observations"] == effective[min(effective)]
    for arguments, n in (((), verdict["effective_observations"]), (("--observations", "all"), verdict["observations"])):
        again, verdict = compare(*models, *arguments, file, cwd=desk)
        assert verdict["effective_observations"] == n
        for one in verdict["models"]:
            floor = 1e-12 * fits[0]["sum_of_squares"]
            for key, e2 in (("criteria", one["e2"]), ("criteria_bound", one["lower_bound"])):
                assert one[key] == pytest.approx(criteria_of(max(e2, floor), n, one["parameters"]), rel=1e-11, abs=1e-9)
        check_verdict(again, verdict, dict(zip(names, fits)))


def everything(path):
    """Light, view, radiance and weights of a goniometer's file, whatever the incidence."""
    header, rows = model.read_text(path)
    column = dict(zip(header, rows.T))
    light, view = (model.unit(column["theta_" + x], column["phi_" + x]) for x in "io")
    radiance = np.stack([column[name] for name in "rgb"], -1) * light[:, 2:]
    return light, view, radiance, column.get("weight", np.ones(len(rows)))


def uneven(fit, path):
    """How many Gaussian residuals would be as uneven as these, by the kurtosis of all channels' together."""
    light, view, radiance, weights = everything(path)
    residual = (radiance - terms_model.radiance(fit, light, view))[weights > 0]
    r = (np.sqrt(weights[weights > 0])[:, None] * residual / np.array(fit["channel_scale"])).ravel()
    return 3 * len(r) / (np.mean(r ** 4) / np.mean(r ** 2) ** 2)


def check_verdict(fits, verdict, by_name):
    deltas = [one["delta"] for one in verdict["models"] if "delta" in one]
    assert deltas == sorted(deltas) and deltas[0] == 0 and verdict["models"][0]["model"] == verdict["best"]
    for one in verdict["models"]:
        assert one["e2"] == by_name[one["model"]]["e2"] and one["lower_bound"] == by_name[one["model"]]["lower_bound"]
        assert one["delta_proven"] <= one["delta"]
        if one["rank"] != "best":
            expected = ("tied" if one["delta"] < verdict["threshold"] else
                        "proven_behind" if one["delta_proven"] >= verdict["threshold"] else "behind")
            assert one["rank"] == expected


@pytest.mark.parametrize("name", ["ward", "ggx", "lafortune"])
def test_no_parameters_refute_what_is_proven(instruments, name):
    """Plain least squares at many roughnesses: none has a BIC nearer to the best than is proven."""
    fits, verdict = compare("--models", "2beckmann," + name, "two_lobe_satin.csv", cwd=instruments)
    best, found = ([one for one in verdict["models"] if one["model"] == which][0] for which in ("2beckmann", name))
    samples = model.Samples(instruments / "two_lobe_satin.csv", "brdf", distributions=[name])
    scaled = samples.radiance / np.array(fits[1]["channel_scale"])
    for sigma in np.geomspace(1e-2, 3, 400):
        columns = np.stack([samples.a, samples.b[0] * model.shape(name, sigma ** -2, samples.c[0])], -1)
        e2 = sum(nnls(columns, scaled[:, k])[1] ** 2 for k in range(3))
        bic = criteria_of(e2, verdict["effective_observations"], found["parameters"])["bic"]
        assert bic - best["criteria"]["bic"] >= found["delta_proven"] - 1e-6


def test_criterion_and_threshold(instruments):
    """A threshold of 300 leaves two forms undecided; AIC counts parameters less."""
    _, verdict = compare("--threshold", "300", "--models", "ggx,ward,2beckmann,3beckmann,beckmann+ggx", "two_lobe_satin.csv",
                         cwd=instruments)
    assert (verdict["verdict"], verdict["tied"]) == ("cannot_tell", ["3beckmann", "beckmann+ggx"])
    assert verdict["simplest"] == "2beckmann"
    deltas = {}
    for criterion in ("bic", "aicc", "aic"):
        _, verdict = compare("--criterion", criterion, "--models", "2beckmann,3beckmann", "two_lobe_satin.csv", cwd=instruments)
        by_name = {one["model"]: one for one in verdict["models"]}
        deltas[criterion] = by_name["3beckmann"]["delta"] - by_name["2beckmann"]["delta"]
    assert deltas["aic"] < deltas["aicc"] < deltas["bic"]


def test_repeated_and_empty_channels_are_no_evidence(tmp_path, instruments):
    """A grey file three times, and a channel of zeros: as many observations as with one channel."""
    rows = [line.split(",") for line in (instruments / "two_lobe_satin.csv").read_text().splitlines() if line[0] != "#"]
    wide = tmp_path / "wide.csv"
    wide.write_text("\n".join(",".join([*row[:4], row[4], *([name, "z"] if i == 0 else [row[4], "0"])])
                              for i, (row, name) in enumerate(zip(rows, itertools.repeat("again")))) + "\n")
    narrow = tmp_path / "narrow.csv"
    narrow.write_text("\n".join(",".join(row[:5]) for row in rows) + "\n")
    (fits, one), (again, many) = (compare("--models", "2beckmann,ggx", path) for path in (narrow, wide))
    assert one["observations"] == many["observations"] == 260
    assert [fit["comparison"]["parameters"] for fit in fits] == [fit["comparison"]["parameters"] for fit in again] == [6, 4]
    for a, b in zip(one["models"], many["models"]):
        assert a["delta"] == pytest.approx(b["delta"], rel=1e-2, abs=1)  # both are optima to a gap of 1e-3


# ---- What cannot be ranked, read or fitted ---------------------------------


def test_nothing_to_rank(desk):
    _, verdict = compare("--models", "beckmann,ggx", "zero.csv", cwd=desk)
    assert (verdict["verdict"], verdict["best"], verdict["observations"]) == ("none", None, 0)
    assert set(ranks(verdict).values()) == {"unranked"}
    assert "the data are all zero" in harness.run("compare", "--models", "ggx", "zero.csv", cwd=desk).stdout
    few = desk / "few.csv"
    few.write_text("\n".join((desk / "two_lobe_satin.csv").read_text().splitlines()[:11]) + "\n")
    fits, verdict = compare("--models", "beckmann,2beckmann", "--box-budget", "100", few, expect=(0, 4))
    assert len(fits) == 2 and {one["criteria"]["bic"] is None for one in verdict["models"]} == {True, False}
    for one in verdict["models"]:
        assert (one["criteria"]["bic"] is None) == (one["parameters"] >= verdict["effective_observations"])


def test_a_bad_file_stops_nothing(desk):
    done = harness.run("compare", "--json", "--models", "ggx,ward", "infinite.csv", "missing.csv", "mixed.csv", cwd=desk)
    assert done.returncode == 1 and "infinite.csv" in done.stderr and "missing.csv" in done.stderr
    lines = harness.lines(done.stdout)
    assert [line["schema"].split("/")[0] for line in lines] == [
        "brdffit.comparison", "brdffit.comparison", "brdffit.fit", "brdffit.fit", "brdffit.comparison"]
    assert [line.get("verdict") for line in lines][:2] == ["error", "error"]
    assert lines[0]["error"]["code"] == "value" and lines[1]["error"]["code"] == "open"
    assert harness.run("compare", "--quiet", "--models", "ggx", "infinite.csv", cwd=desk).returncode == 3


def test_a_model_without_memory_is_a_line(desk):
    """Three lobes ask for more than there is; the others are compared all the same."""
    if b"__asan_init" in harness.BRDFFIT.read_bytes():
        pytest.skip("the sanitizer needs the address space")

    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (50 << 20, 50 << 20))

    fits, verdict = compare("--models", "ggx,3ggx,ward", "two_lobe_satin.csv", cwd=desk, expect=(1,), preexec_fn=limit)
    assert [fit["status"] for fit in fits] == ["certified", "error", "certified"]
    assert fits[1]["error"]["code"] == "memory" and ranks(verdict)["3ggx"] == "error"
    assert verdict["best"] == "ggx" and verdict["verdict"] == "one"
    done = harness.run("compare", "--models", "ggx,3ggx,ward", "two_lobe_satin.csv", cwd=desk, preexec_fn=limit)
    assert re.search(r"3 GGX +not fitted: \w+", done.stdout)


def test_an_open_search_is_not_called_proven(desk):
    fits, verdict = compare("--models", "ggx,2beckmann,beckmann", "--box-budget", "8", "two_lobe_satin.csv", cwd=desk, expect=(4,))
    check_verdict(fits, verdict, {fit["comparison"]["model"]: fit for fit in fits})
    assert all(fit["status"] == "gap_open" for fit in fits) and "behind" in ranks(verdict).values()
    done = harness.run("compare", "--models", "ggx,2beckmann,beckmann", "--box-budget", "8", "two_lobe_satin.csv", cwd=desk)
    assert done.returncode == 4 and "NOT proven: a better fit than was found is not ruled out" in " ".join(done.stdout.split())


def test_interrupt(desk):
    """Interrupted while it reads: the models and files that were not begun say so, and the lines are whole."""
    process = start("compare", "--json", "--models", "2ggx,ggx", "--gap", "1e-9", "-", "two_lobe_exact.csv", cwd=desk)
    reading(process)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate((desk / "two_lobe_satin.csv").read_bytes(), harness.PATIENCE)
    fit, one, two = harness.lines(out.decode())
    assert process.returncode == 4 and b"1 file was not begun" in err
    assert (fit["status"], fit["stop"]) == ("gap_open", "cancelled")
    assert ranks(one) == {"2ggx": "best", "ggx": "interrupted"}
    assert (two["verdict"], two["error"]["code"]) == ("error", "interrupted")


@pytest.mark.parametrize("models, culprit", [("foo", "foo"), ("ggx,4ggx", "4ggx"), ("ggx,,ward", ""), ("ggx,1ggx", "1ggx"),
                                             ("2ggx+2ward", "2ggx+2ward"), ("ggx+", "ggx+"), ("", ""), ("GGX", "GGX"),
                                             ("ggx/", "ggx/"), ("ggx//smith", "ggx//smith"), ("/smith", "/smith"),
                                             ("ggx/foo", "ggx/foo"), ("ggx/none", "ggx/none"), ("ggx/smi", "ggx/smi"),
                                             ("ggx/smith/smith", "ggx/smith/smith"),
                                             ("ggx/smith/no-masking", "ggx/smith/no-masking"),
                                             ("ggx/smith/schlick,ggx/schlick/smith", "ggx/schlick/smith"),
                                             ("paper/schlick", "paper/schlick"), ("ggx/lambert,ggx", "ggx")])
def test_bad_lists(desk, models, culprit):
    done = harness.run("compare", "--models", models, "mixed.csv", cwd=desk)
    assert done.returncode == 2 and done.stdout == ""
    assert "--models does not take '%s'" % culprit in done.stderr


@pytest.mark.parametrize("given, name, title", [
    ("ggx/schlick/smith", "ggx/smith/schlick", "GGX, Smith, Schlick"),
    ("2beckmann/burley/schlick/smith-separable", "2beckmann/smith-separable/schlick/burley",
     "2 Beckmann, separable Smith, Schlick, Burley"),
    ("ggx+beckmann+ggx/no-diffuse", "2ggx+beckmann/no-diffuse", "2 GGX + Beckmann, no diffuse"),
    ("1ggx/lambert/v-cavity/no-fresnel", "ggx", "GGX"), ("ward/oren-nayar", "ward/oren-nayar", "Ward, Oren-Nayar"),
    ("beckmann/no-masking", "beckmann/no-masking", "Beckmann, no masking"), ("disney", "disney", "GGX, Smith, Schlick, Burley")])
def test_names(instruments, given, name, title):
    """Terms come in any order and are printed in one; a preset keeps its name."""
    (fit,), verdict = compare("--models", given, "--gap", "0.5", "two_lobe_satin.csv", cwd=instruments)
    assert verdict["best"] == fit["comparison"]["model"] == name and fit["comparison"]["title"] == title
    if given != "disney":
        assert fit["distributions"] == shape_of(name)
        terms = {"masking": "v-cavity", "fresnel": "none", "diffuse": "lambert", **dict(TERMS[t] for t in name.split("/")[1:])}
        assert {kind: fit[kind] for kind in terms} == terms


def test_a_term_that_a_distribution_has_not_is_a_line(instruments):
    fits, verdict = compare("--models", "ward/smith,ggx", "two_lobe_satin.csv", cwd=instruments, expect=(2,))
    assert fits[0]["error"]["code"] == "unsupported" and ranks(verdict) == {"ggx": "best", "ward/smith": "error"}
    name = "3ggx/schlick/burley"  # 9 columns
    fits, verdict = compare("--models", "ggx," + name, "two_lobe_satin.csv", cwd=instruments, expect=(2,))
    assert "columns" in fits[1]["error"]["message"] and ranks(verdict) == {"ggx": "best", name: "error"}


@pytest.mark.parametrize("models, options, used", [
    ("ggx,2beckmann", [], 260), ("ggx,beckmann/schlick", [], 300), ("beckmann/schlick,ggx", ["--max-incidence", "60"], 260),
    ("ggx", ["--max-incidence", "off"], 300), ("ggx/smith/burley", [], 260), ("principled,paper", [], 300)])
def test_all_forms_see_the_same_samples(instruments, models, options, used):
    """Without a limit of incidence where a form has Fresnel, unless there is one given; and it is said."""
    fits, verdict = compare("--models", models, *options, "two_lobe_satin.csv", cwd=instruments)
    assert {fit["samples_used"] for fit in fits} == {verdict["samples_used"]} == {used}
    report = " ".join(harness.run("compare", "--models", models, *options, "two_lobe_satin.csv", cwd=instruments).stdout.split())
    fresnel = "schlick" in models or "principled" in models
    assert ("All forms are fitted to light from everywhere" in report) == (fresnel and used == 300)
    assert "%d of 300 samples used" % used in report


# ---- Tables, standard input ------------------------------------------------


@pytest.mark.parametrize("names", ["beckmann,2beckmann,ggx,beckmann+ggx,lafortune,ggx+ward",
                                   "beckmann,2beckmann,ggx/oren-nayar,ggx,beckmann/schlick"])
def test_a_table_is_read_as_often_as_it_takes(instruments, names):
    """A MERL table is fitted from sums of one distribution; standard input, and a list with further terms, from samples. All say
    the same."""
    models = ("--models", names)
    fits, one = compare(*models, "two_lobe_table.binary", cwd=instruments)
    again, two = compare(*models, "-", stdin=(instruments / "two_lobe_table.binary").read_bytes())
    for a, b in zip(fits, again):
        e2 = sorted((a["e2"], b["e2"]))
        bounds = max(a["lower_bound"], b["lower_bound"])
        assert bounds <= e2[0] + a["e2_error"] + b["e2_error"]
        assert e2[1] <= (1 + 2e-3) * e2[0] + 2e-12 * a["sum_of_squares"]
    assert one["best"] == two["best"] == "2beckmann"
    assert [m["model"] for m in one["models"]] == [m["model"] for m in two["models"]]


def test_every_line_can_be_evaluated(instruments, tmp_path):
    path = tmp_path / "fits.json"
    done = harness.run("compare", "--json", "--models", "ggx,2beckmann", "-o", path, "two_lobe_satin.csv", cwd=instruments)
    assert done.returncode == 0 and done.stdout == ""
    done = harness.run("eval", "--select", "2", path, "two_lobe_satin.csv", cwd=instruments)
    assert done.returncode == 0 and len(done.stdout.splitlines()) > 260


def test_the_table_fits_its_columns(desk):
    """100 columns, whatever the lobes; as many numbers a line as there are heads."""
    done = harness.run("compare", "--models", "3ggx,ashikhmin-shirley+torrance-sparrow,3lafortune,2ward,2beckmann/schlick,"
                       "2ggx/smith-separable/no-diffuse", "--gap", "0.1", "two_lobe_satin.csv", "two_lobe_exact.csv", cwd=desk)
    assert all(len(line) <= 100 for line in done.stdout.splitlines())
    table = [line for line in done.stdout.splitlines() if re.search(r" m?s$", line)]
    assert len(table) == 12
    for line in table:
        assert re.search(r" \d+ +[\d.e+-]+ +[01]\.\d{6} +[\d.e+]+ +(-?[\d.e+]+ +)?-?[\d.e+]+ +[\d.]+ m?s$", line), line
    ascii_only = harness.run("compare", "--models", "ggx,ward", "mixed.csv", cwd=desk, env=harness.environment(LC_ALL="C"))
    assert ascii_only.stdout.isascii()


# ---- --lobes auto ----------------------------------------------------------


@pytest.mark.parametrize("file, distribution, lobes", [("two_lobe_satin.csv", "beckmann", 2), ("two_lobe_exact.csv", "beckmann", 2),
                                                       ("ggx_metal.csv", "ggx", 1), ("matte.csv", "beckmann", 1)])
def test_fewest_lobes(instruments, file, distribution, lobes):
    (line,) = harness.fit("--lobes", "auto", "--distribution", distribution, file, cwd=instruments)
    (alone,) = harness.fit("--lobes", str(lobes), "--distribution", distribution, file, cwd=instruments)
    auto = line.pop("lobes_auto")
    assert {**line, "seconds": None} == {**alone, "seconds": None}
    trials = auto["trials"]
    assert [one["lobes"] for one in trials] == list(range(1, lobes + 2)) and auto["proven"]
    for fewer, more in itertools.pairwise(trials):
        e2, least, before = (max(e2, 1e-12 * line["sum_of_squares"])
                             for e2 in (more["e2"], more["lower_bound"], fewer["e2"]))
        n, p = more["effective_observations"], [3 * (1 + one["lobes"]) + one["lobes"] + 1 for one in (fewer, more)]
        for key, after in (("gain", e2), ("gain_most", least)):
            gain = criteria_of(before, n, p[0])["bic"] - criteria_of(after, n, p[1])["bic"]
            assert more[key] == pytest.approx(gain, rel=1e-6, abs=1e-6)
        kept = more is not trials[-1]
        assert (more["gain"] >= auto["threshold"]) == kept and (kept or more["gain_most"] < auto["threshold"])
    report = harness.run("fit", "--lobes", "auto", "--distribution", distribution, file, cwd=instruments)
    assert "Lobes: %d, the fewest that the data support" % lobes in report.stdout


def test_lobes_auto_of_a_table(instruments):
    (line,) = harness.fit("--lobes", "auto", "two_lobe_table.binary", cwd=instruments)
    assert line["lobes"] == 2 and line["status"] == "certified"


def test_lobes_auto_where_it_does_not_apply(desk):
    for arguments, words in ((("fit", "--norm", "l1"), "is for --norm l2"), (("map", "-g", "g.csv"), "does not take 'auto'")):
        done = harness.run(*arguments, "--lobes", "auto", "mixed.csv", cwd=desk)
        assert done.returncode == 2 and words in done.stderr


def test_lobes_auto_is_another_run(desk):
    """Parts of a run with it and of one without are not merged."""
    for i, lobes in enumerate(("auto", "1"), 1):
        done = harness.run("fit", "--json", "--shard", "%d/2" % i, "--lobes", lobes, "-o", "part%d.json" % i, "mixed.csv",
                           "vectors.csv", cwd=desk)
        assert done.returncode == 0
    done = harness.run("merge", "part1.json", "part2.json", cwd=desk)
    assert done.returncode != 0 and "run" in done.stderr


# ---- --model ----------------------------------------------------------------


@pytest.mark.parametrize("given, same", [
    (["--model", "paper"], ["--lobes", "2"]),
    (["--model", "paper", "--lobes", "1"], []),
    (["--distribution", "ward", "--model", "paper"], ["--lobes", "2", "--distribution", "ward"]),
    (["--model", "paper", "--lobes", "ggx,ward"], ["--lobes", "ggx,ward"]),
    (["--max-incidence", "off", "--model=paper"], ["--lobes", "2", "--max-incidence", "off"]),
    (["--model", "beckmann+ggx"], ["--lobes", "beckmann,ggx"]),
    (["--model", "ward+2ggx"], ["--lobes", "ward,ggx,ggx"]),
    (["--model", "phong"], ["--distribution", "lafortune"]),
    (["--model", "cook-torrance"], []),
    (["--model", "principled"], ["--distribution", "ggx", "--masking", "smith", "--fresnel", "schlick"]),
    (["--model", "disney"], ["--model", "principled", "--diffuse", "burley"]),
    (["--model", "disney", "--diffuse", "lambert"], ["--model", "ggx/schlick/smith"]),
    (["--lobes", "2", "--model", "principled"], ["--model", "2ggx/smith/schlick"]),
    (["--model", "2beckmann/schlick", "--fresnel", "none"], ["--model", "paper"]),
    (["--model", "principled", "--max-incidence", "60"], ["--model", "ggx/smith/schlick", "--max-incidence", "60"]),
    (["--model", "ggx+beckmann/no-diffuse"], ["--lobes", "ggx,beckmann", "--diffuse", "none"]),
])
def test_a_model_stands_for_options(instruments, given, same):
    lines = [harness.fit(*options, "--gap", "0.05", "two_lobe_satin.csv", cwd=instruments)[0] for options in (given, same)]
    assert {**lines[0], "seconds": None} == {**lines[1], "seconds": None}


def test_paper_takes_84_directions(instruments):
    (line,) = harness.fit("--model", "paper", "two_lobe_table.binary", cwd=instruments)
    assert line["merl_samples"] == "84" and line["lobes"] == 2
    (line,) = harness.fit("--model", "paper", "--merl-samples", "table", "two_lobe_table.binary", cwd=instruments)
    assert line["merl_samples"] == "table"


def test_bad_models(desk):
    for name in ("foo", "4ggx", "", "ggx,ward", "ggx/foo", "principled/burley"):
        done = harness.run("fit", "--model", name, "mixed.csv", cwd=desk)
        assert done.returncode == 2 and "--model does not take '%s'" % name in done.stderr
    done = harness.run("fit", "--model", "beckmann+ggx", "--distribution", "ward", "mixed.csv", cwd=desk)
    assert done.returncode == 2


def test_the_help_and_the_manual_have_every_preset():
    text = harness.run("fit", "--help").stdout.partition("Presets of --model:\n")[2].partition("\n\n")[0]
    names = re.findall(r"(?m)^  (\S+)", text)
    manual = (harness.ROOT / "tools" / "brdffit" / "brdffit.1").read_text().replace("\\-", "-")
    assert names[:1] == ["paper"] and all(re.search(r"\.B %s\b" % re.escape(name), manual) for name in names)
    usage = " ".join(harness.run("compare", "--help").stdout.split())
    assert ", ".join(DOZEN) in usage
