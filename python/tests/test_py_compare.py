"""compare() against the command line's, and what it shows. SPDX-License-Identifier: MIT"""
import math
import re

import numpy as np
import pytest

import brdffit
import harness
from brdffit import compare as compare_function
from brdffit._forms import MODELS, PRESETS, Form, named
from brdffit.compare import Criteria, effective_observations

SOME = ["2beckmann", "ggx", "lafortune", "beckmann+ggx", "ashikhmin-shirley+2ward"]
TERMS = ["ggx", "disney", "2beckmann/schlick/smith-separable", "ward/oren-nayar", "ggx/no-diffuse/no-masking"]


def command_line(*arguments, cwd):
    done = harness.run("compare", "--json", *arguments, cwd=cwd)
    assert done.returncode in (0, 4), done.stderr
    return harness.lines(done.stdout)


def close(a, b):
    """The same but for the last digits of sums and logarithms."""
    assert type(a) is type(b) or {type(a), type(b)} <= {int, float}, (a, b)
    if isinstance(a, dict):
        assert a.keys() == b.keys()
        for key in a:
            close(a[key], b[key])
    elif isinstance(a, list):
        assert len(a) == len(b)
        for one, other in zip(a, b):
            close(one, other)
    elif isinstance(a, float):
        assert a == pytest.approx(b, rel=1e-9, abs=1e-6)
    else:
        assert a == b


@pytest.mark.parametrize("models", [SOME, TERMS])
@pytest.mark.parametrize("file, more, options", [
    ("two_lobe_satin.csv", [], {}), ("two_lobe_outliers.csv", ["--criterion", "aicc"], {"criterion": "aicc"}),
    ("ggx_metal.csv", ["--observations", "all", "--max-incidence", "off"], {"observations": "all", "max_incidence": 90.0}),
    ("two_lobe_exact.csv", ["--threshold", "20"], {"threshold": 20})])
def test_the_command_line_says_the_same(instruments, file, more, options, models):
    """The verdict member for member, and every fit."""
    *fits, verdict = command_line("--models", ",".join(models), "--gap", "0.01", *more, file, cwd=instruments)
    found = brdffit.compare(instruments / file, models, relative_gap=0.01, **options)
    close({**found.to_dict(), "file": file}, verdict)
    for fit in fits:
        row = found[fit["comparison"]["model"]]
        assert row.fit.to_dict()["e2"] == fit["e2"] and row.fit.lower_bound == fit["lower_bound"]
        assert np.array_equal(row.fit.sigma, fit["sigma"]) and row.parameters == fit["comparison"]["parameters"]
        assert row.r2 == pytest.approx(fit["comparison"]["r2"], rel=1e-12)
        close(row.effective_observations, fit["comparison"]["effective_observations"])


def test_the_lists_are_the_same(instruments):
    *fits, _ = command_line("--gap", "0.5", "two_lobe_satin.csv", cwd=instruments)
    assert tuple(fit["comparison"]["model"] for fit in fits) == MODELS
    for fit in fits:
        form = named(fit["comparison"]["model"])
        assert list(form.distributions) == fit["distributions"] and form.title == fit["comparison"]["title"]
        assert {kind: fit[kind] for kind in ("masking", "fresnel", "diffuse")} == {
            "masking": form.masking, "fresnel": form.fresnel, "diffuse": form.diffuse}


def test_the_presets_are_the_same(instruments):
    """Names, forms, what else they stand for: of each, the line that `fit --model` writes."""
    text = harness.run("fit", "--help").stdout.partition("Presets of --model:\n")[2].partition("\n\n")[0]
    assert re.findall(r"(?m)^  (\S+)", text) == list(PRESETS)
    for name in PRESETS:
        for file in ("two_lobe_satin.csv", "two_lobe_table.binary"):
            if file.endswith("binary") and name in ("principled", "disney"):
                continue  # as the first does
            (line,) = harness.fit("--model", name, "--gap", "0.1", file, cwd=instruments)
            fit = brdffit.fit(instruments / file, model=name, relative_gap=0.1)
            for member in ("distributions", "masking", "fresnel", "diffuse", "samples_used", "max_incidence", "merl_samples"):
                assert fit.to_dict().get(member) == line.get(member), (name, file, member)
            assert (fit.e2, fit.lower_bound) == pytest.approx((line["e2"], line["lower_bound"]), rel=1e-6, abs=1e-18)


@pytest.mark.parametrize("given, same", [
    ({"model": "principled"}, {"distribution": "ggx", "masking": "smith", "fresnel": "schlick"}),
    ({"model": "principled", "lobes": 2}, {"lobes": 2, "distribution": "ggx", "masking": "smith", "fresnel": "schlick"}),
    ({"model": "disney", "diffuse": "lambert"}, {"model": "ggx/schlick/smith"}),
    ({"model": "disney", "fresnel": "none"}, {"distribution": "ggx", "masking": "smith", "diffuse": "burley"}),
    ({"model": "paper", "distribution": "ward"}, {"lobes": 2, "distribution": "ward"}),
    ({"model": "paper", "lobes": np.int64(1)}, {}),
    ({"model": "paper", "fresnel": "schlick"}, {"lobes": 2, "fresnel": "schlick", "max_incidence": 60}),
    ({"model": "beckmann+ggx"}, {"lobes": ["beckmann", "ggx"]}), ({"model": "ggx+beckmann", "lobes": 1}, {"distribution": "ggx"}),
    ({"model": "paper", "lobes": ["ggx", "ward"]}, {"lobes": ["ggx", "ward"]}), ({"model": None}, {})])
def test_a_model_stands_for_options(given, same):
    one, other = (brdffit.fit(brdffit.Samples.example(), relative_gap=0.05, **options).to_dict() for options in (given, same))
    assert {**one, "seconds": None} == {**other, "seconds": None}


@pytest.mark.parametrize("arguments", [{"model": "foo"}, {"model": "ggx/foo"}, {"model": ""}, {"model": "principled/burley"},
                                       {"model": 2}, {"model": "beckmann+ggx", "distribution": "ward"}])
def test_wrong_models(arguments):
    with pytest.raises(brdffit.OptionError):
        brdffit.fit(brdffit.Samples.example(), **arguments)


@pytest.mark.parametrize("given, name, title", [
    ("ggx/schlick/smith", "ggx/smith/schlick", "GGX, Smith, Schlick"), ("1ggx/lambert", "ggx", "GGX"),
    ("ggx+beckmann+ggx/no-diffuse/no-masking", "2ggx+beckmann/no-masking/no-diffuse", "2 GGX + Beckmann, no masking, no diffuse"),
    ("2ward/burley", "2ward/burley", "2 Ward, Burley"), ("paper", "paper", "2 Beckmann")])
def test_names(given, name, title):
    form = named(given)
    assert (form.name, form.title) == (name, title)
    if given != "paper":
        assert Form.of(form.distributions, masking=form.masking, fresnel=form.fresnel, diffuse=form.diffuse) == form == named(name)


def test_all_forms_see_the_same_samples():
    example = brdffit.Samples.example()
    for models, options, used in ((["ggx", "ward"], {}, 260), (["ggx", "beckmann/schlick"], {}, 300),
                                  (["ggx", "beckmann/schlick"], {"max_incidence": 60}, 260)):
        found = brdffit.compare(example, models, relative_gap=0.1, **options)
        assert {row.fit.samples_used for row in found} == {found.samples_used} == {used}
        assert ("light from everywhere" in repr(found)) == (used == 300)


def test_forms_that_cannot_be_are_rows():
    found = brdffit.compare(brdffit.Samples.example(), ["ggx", "ward/smith", "3ggx/schlick/burley"], relative_gap=0.1)
    assert [row.model for row in found] == ["ggx", "ward/smith", "3ggx/schlick/burley"]
    assert "masking" in str(found[1].error) and "columns" in str(found[2].error) and found.best is found["ggx"]


def test_forms_are_counted():
    """The row says the whole form; K (D + F P) coefficients, P roughnesses, the noise."""
    found = brdffit.compare(brdffit.Samples.example(), ["2ggx/smith/schlick/burley", "beckmann/no-diffuse"], relative_gap=0.1)
    row = found["2ggx/smith/schlick/burley"]
    assert (row.masking, row.fresnel, row.diffuse, row.distributions) == ("smith", "schlick", "burley", ("ggx", "ggx"))
    assert row.parameters == 3 * (3 + 2 * 2) + 2 + 1 and found["beckmann/no-diffuse"].parameters == 3 + 1 + 1


@pytest.fixture(scope="module")
def satin(instruments):
    return brdffit.compare(instruments / "two_lobe_satin.csv", ["ggx", "2beckmann", ["beckmann"] * 3])


def test_rows(satin):
    assert len(satin) == 3 and satin[0] is satin.best is satin["2beckmann"] is satin.simplest and satin.tied == ()
    assert [row.rank for row in satin] == ["best", "proven_behind", "proven_behind"] and satin.verdict == "one"
    assert satin[1:] == tuple(satin)[1:] and [row.model for row in satin] == ["2beckmann", "3beckmann", "ggx"]
    assert satin["ggx"].cannot_reach(satin.best) and not satin["3beckmann"].cannot_reach(satin.best)
    assert satin.observations == 780 and 100 < satin.effective_observations < 400
    with pytest.raises(KeyError):
        satin["ward"]
    with pytest.raises(IndexError):
        satin[3]


def test_words(satin):
    text = repr(satin)
    assert "780 observations, counted as" in text and "  *  2 Beckmann" in text
    words = " ".join(satin.words)
    assert re.search(r"Best: 2 Beckmann has the least BIC, [\d.]+ less than the next: 3 Beckmann\.", words)
    assert "Proven: no fit of these forms, whatever its parameters, reaches the E² of this 2 Beckmann" in words
    assert "3 Beckmann (4 more; proven: at most" in words and all(len(line) <= 100 for line in text.splitlines()[1:])
    page = satin._repr_html_()
    assert page.count("<tr>") == 4 and "2 Beckmann *" in page


def test_words_of_the_command_line(instruments, satin):
    """The same paragraphs."""
    done = harness.run("compare", "--models", "ggx,2beckmann,3beckmann", "two_lobe_satin.csv", cwd=instruments)
    printed = " ".join(done.stdout.split())
    for paragraph in satin.words:
        assert " ".join(paragraph.split()) in printed


def test_noise_is_counted_whole():
    """Gaussian residuals of one variance: the effective number is that of the observations, to its own scatter."""
    light, view = brdffit.protocol84()
    one = brdffit.fit(brdffit.Samples.example(), lobes=1)
    values = one.predict(light, view, quantity="radiance")
    values = values + values.max(0) * 0.01 * np.random.default_rng(5).standard_normal(values.shape)
    samples = brdffit.Samples.from_arrays(light, view, values, quantity="radiance")
    fit = brdffit.fit(samples)
    n = fit.samples_used * len(fit.channels)
    assert n * (1 - 5 * math.sqrt(24 / n)) <= effective_observations(fit, samples) <= n


def test_criteria():
    found = Criteria.of(2.0, 10, 4)
    deviance = 10 * math.log(0.2)
    assert (found.aic, found.bic) == (deviance + 8, deviance + 4 * math.log(10))
    assert found.aicc == pytest.approx(found.aic + 2 * 4 * 5 / 5, rel=1e-15)
    assert all(math.isnan(v) for v in (Criteria.of(2.0, 4, 4).bic, Criteria.of(0.0, 9, 4).aic, Criteria.of(1.0, 5, 4).aicc))


def test_a_model_that_cannot_be_fitted_is_a_row(monkeypatch):
    import sys

    module = sys.modules["brdffit.compare"]
    run = module.run

    def refuse(samples, options, *rest):
        if len(options.distributions) == 2:
            raise brdffit.UnsupportedError("not this one", code="unsupported")
        return run(samples, options, *rest)

    monkeypatch.setattr(module, "run", refuse)
    found = brdffit.compare(brdffit.Samples.example(), ["beckmann", "2ggx", "ward"])
    assert found["2ggx"].fit is None and found[2] is found["2ggx"] and str(found["2ggx"].error) == "not this one"
    assert found.best is not None and "not fitted: not this one" in repr(found)
    assert found.to_dict()["models"][2]["rank"] == "error"


def test_nothing_to_rank():
    light, view = brdffit.protocol84()
    found = brdffit.compare(brdffit.Samples.from_arrays(light, view, np.zeros((84, 2))), ["ggx"])
    assert (found.verdict, found.best, found.simplest, found.observations) == ("none", None, None, 0)
    assert "the data are all zero" in repr(found)


@pytest.mark.parametrize("arguments", [
    {"models": ["foo"]}, {"models": []}, {"models": ["ggx", ["ggx"]]}, {"models": ["4ggx"]}, {"models": ["2ggx+2ward"]},
    {"models": ["ggx+"]}, {"models": ["ggx/"]}, {"models": ["ggx/smith/smith"]}, {"models": ["ggx/smith/no-masking"]},
    {"models": ["ggx/smith/schlick", "ggx/schlick/smith"]}, {"models": ["/smith"]}, {"models": [3]}, {"criterion": "hq"},
    {"threshold": 0}, {"observations": "some"}, {"relative_gap": -1.0}])
def test_wrong_arguments(arguments):
    with pytest.raises(brdffit.OptionError):
        brdffit.compare(brdffit.Samples.example(), **arguments)


def test_wrong_data_raise(instruments):
    with pytest.raises(brdffit.FileError):
        compare_function(instruments / "missing.csv")


def test_a_section_of_the_report(instruments, tmp_path):
    from brdffit import report

    file = instruments / "two_lobe_satin.csv"
    code = report.main(["-o", str(tmp_path), "--quiet", "--lobes", "1", "--models", "ggx,2beckmann", str(file)])
    (page,) = tmp_path.glob("*.html")
    text = page.read_text(encoding="utf-8")
    assert code == report.CERTIFIED and text.count("<h2>Which model</h2>") == 1 and "2 Beckmann *" in text
    assert "Best: 2 Beckmann has the least BIC" in text and "780 observations, counted as" in text
    assert "Which model" not in report.page(brdffit.Samples.from_file(file), "satin", lobes=1)
    assert report.main(["-o", str(tmp_path), "--quiet", "--models", "nothing", str(file)]) == report.USAGE
