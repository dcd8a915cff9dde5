"""Fresnel, masking and diffuse terms from Python: fits, files, maps.

SPDX-License-Identifier: MIT
"""
import json
import pickle

import numpy as np
import pytest

import brdffit
import harness
import terms_model
from brdffit.report import _analysis, page

TRUE = {"distributions": ["ggx"], "fresnel": "schlick", "diffuse": "burley", "sigma": [0.2], "x": [0.2, 0.1, 0.3],
        "x_more": [[0.1, 0.05], [0.04, 0.02], [0.2, 0.3]], "y": [[0.3], [0.4], [0.2]], "f0": [[0.04], [1.0], [0.5]]}
ASKED = {"distribution": "ggx", "fresnel": "schlick", "diffuse": "burley"}


@pytest.fixture(scope="module")
def measured():
    light, view = terms_model.geometry(300)
    noise = 1 + 0.01 * np.random.default_rng(4).standard_normal((len(light), 3))
    return brdffit.Samples.from_arrays(light, view, terms_model.radiance(TRUE, light, view) * noise, quantity="radiance")


@pytest.fixture(scope="module")
def fitted(measured):
    return brdffit.fit(measured, **ASKED)


def test_truth_is_found_again(measured):
    exact = brdffit.Samples.from_arrays(measured.light, measured.view, terms_model.radiance(TRUE, measured.light, measured.view),
                                        quantity="radiance")
    fit = brdffit.fit(exact, **ASKED, relative_gap=1e-6, absolute_gap=1e-20)
    assert fit.certified and fit.max_incidence == 90
    np.testing.assert_allclose(fit.f0, TRUE["f0"], atol=1e-9)
    np.testing.assert_allclose(fit.x_more, TRUE["x_more"], atol=1e-7)
    np.testing.assert_allclose(fit.ior[0], (1 + 0.2) / (1 - 0.2), rtol=1e-6)


def test_predictions_are_those_of_the_formula(fitted):
    light, view = terms_model.geometry(50, seed=9)
    np.testing.assert_allclose(fitted.predict(light, view), terms_model.radiance(fitted.to_dict(), light, view), rtol=1e-11,
                               atol=1e-13)


def test_no_two_ways_of_keeping_a_fit_differ(fitted, measured):
    for other in (pickle.loads(pickle.dumps(fitted)), brdffit.Fit.from_json(fitted.to_json())):
        np.testing.assert_array_equal(other.predict_samples(measured), fitted.predict_samples(measured))
        assert other.to_json() == fitted.to_json() and repr(other) == repr(fitted)


def test_the_command_line_says_the_same(tmp_path, measured):
    terms_model.write(tmp_path / "made.csv", measured.light, measured.view, measured.values)
    line = harness.fit("made.csv", "--values", "radiance", "--distribution", "ggx", "--fresnel", "schlick", "--diffuse", "burley",
                       cwd=tmp_path)[0]
    ours = brdffit.fit(brdffit.Samples.from_csv(tmp_path / "made.csv", quantity="radiance"), **ASKED).to_dict()
    assert list(line) == list(ours)
    for name in set(line) - {"seconds", "file"}:
        assert line[name] == json.loads(json.dumps(ours[name])), name


def test_lines_from_before_and_lines_that_are_wrong(fitted, measured):
    plain = brdffit.fit(measured).to_dict()
    old = {name: value for name, value in plain.items() if name not in ("fresnel", "diffuse", "masking")}
    np.testing.assert_array_equal(brdffit.Fit.from_dict(old).predict_samples(measured),
                                  brdffit.Fit.from_dict(plain).predict_samples(measured))
    for change in ({"fresnel": "snell"}, {"masking": "smitten"}, {"f0": None}, {"f0": [[0.1], [0.1], [1.5]]}, {"x_more": [[1, 1]]}):
        with pytest.raises(brdffit.BrdffitError):
            brdffit.Fit.from_dict(fitted.to_dict() | change)


def test_what_is_said(fitted):
    for text in (repr(fitted), fitted._repr_html_()):
        assert "Schlick Fresnel, Burley diffuse" in text and "index n" in text and "by x r" in text
    assert "(Schlick Fresnel, Burley diffuse)" in fitted.certificate


def test_options_that_are_none():
    for name in ("fresnel", "diffuse", "masking"):
        with pytest.raises(brdffit.OptionError, match=name):
            brdffit.Options(**{name: "lambertt"})._struct()
    assert [brdffit.Options(**more).max_incidence for more in (
        {}, {"fresnel": "schlick"}, {"fresnel": "schlick", "max_incidence": 50})] == [60, 90, 50]


def test_f0_that_directions_do_not_tell():
    light, view = terms_model.geometry(300, v_h=0.9)
    values = terms_model.radiance(TRUE, light, view) * (1 + 0.01 * np.random.default_rng(4).standard_normal((len(light), 3)))
    fit = brdffit.fit(brdffit.Samples.from_arrays(light, view, values, quantity="radiance"), distribution="ggx", fresnel="schlick")
    assert "F0 is not identified" in " ".join(repr(fit).split())
    assert np.all(np.diff(fit.f0_interval, axis=-1) >= 0)


@pytest.mark.parametrize("values, weight", [(1e150, 1), (1e-150, 1), (1, 1e120), (1, 1e-120), (1e100, 1e100)])
def test_units_do_not_matter_to_how_f0_is_told(measured, fitted, values, weight):
    other = brdffit.Samples.from_arrays(measured.light, measured.view, measured.values * values, quantity="radiance",
                                        weights=np.full(len(measured), float(weight)))
    np.testing.assert_allclose(brdffit.fit(other, **ASKED).f0_interval, fitted.f0_interval, rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("own", [False, True], ids=["shared", "own directions"])
def test_maps_are_the_fits_of_their_texels(tmp_path, measured, own):
    stack = measured.values[:, None, None] * np.linspace(0.5, 2, 4).reshape(2, 2, 1)
    normal = np.broadcast_to([0.0, 0.0, 1.0], (2, 2, 3)) if own else None
    maps = brdffit.fit_map(stack, measured.light, measured.view, normal=normal, quantity="radiance", **ASKED)
    for at in np.ndindex(2, 2):
        one = brdffit.fit(brdffit.Samples.from_arrays(measured.light, measured.view, stack[:, at[0], at[1]],
                                                      quantity="radiance"), **ASKED)
        for name in ("sigma", "x", "y", "f0", "x_more", "e2"):
            np.testing.assert_array_equal(getattr(maps, name)[at], getattr(one, name), name)
        np.testing.assert_array_equal(maps.predict(measured.light, measured.view)[:, at[0], at[1]], one.predict_samples(measured))
    maps.save(tmp_path / "maps")
    maps.save(tmp_path / "maps.npz")
    for kept in (brdffit.FitMap.load(tmp_path / "maps"), brdffit.FitMap.load(tmp_path / "maps.npz")):
        assert kept.options.fresnel == "schlick" and kept.options.diffuse == "burley"
        np.testing.assert_array_equal(kept.predict(measured.light, measured.view), maps.predict(measured.light, measured.view))
    maps.save(tmp_path / "pfm", format="pfm")
    assert {"f0_1.pfm", "x_more_1.pfm", "x_more_2.pfm"} <= {path.name for path in (tmp_path / "pfm").iterdir()}
    (tmp_path / "maps" / "f0.npy").unlink()
    with pytest.raises(brdffit.DataError, match="f0"):
        brdffit.FitMap.load(tmp_path / "maps")


def test_masked_texels_have_none(measured):
    stack = np.repeat(measured.values[:, None], 2, 1)
    maps = brdffit.fit_map(stack, measured.light, measured.view, quantity="radiance", mask=[True, False], **ASKED)
    assert np.all(np.isnan(maps.f0[1])) and np.all(np.isnan(maps.x_more[1])) and np.all(np.isfinite(maps.f0[0]))


def test_maps_in_zarr_know_them(tmp_path, measured):
    zarr = pytest.importorskip("zarr")
    pytest.importorskip("dask")
    values = np.repeat(measured.values[:, None, None], 4, 1)
    stack = zarr.create_array(tmp_path / "stack.zarr", data=values, chunks=(len(measured), 2, 1, 3))
    asked = {"quantity": "radiance", "output": tmp_path / "maps.zarr", "tile": (2, 1)}
    maps = brdffit.fit_map(stack, measured.light, measured.view, **asked, **ASKED).load()
    one = brdffit.fit(measured, **ASKED)
    np.testing.assert_array_equal(maps.f0, np.broadcast_to(one.f0, (4, 1, 3, 1)))
    np.testing.assert_array_equal(maps.x_more, np.broadcast_to(one.x_more, (4, 1, 3, 2)))
    with pytest.raises(brdffit.DataError, match="diffuse"):
        brdffit.fit_map(stack, measured.light, measured.view, **asked, **(ASKED | {"diffuse": "lambert"}))


@pytest.mark.parametrize("more", [{"diffuse": "burley"}, {"diffuse": "none"}, {"diffuse": "oren-nayar", "fresnel": "none"}])
def test_the_reports_own_profile(measured, more):
    """By plain least squares, independent of the search: no lower than what is proven, and the fit's own at its sigma."""
    material = _analysis.measure("made", measured, ASKED | more, 1)
    fit = material.main
    at_fit = _analysis.objective(material, fit.sigma, 1)
    np.testing.assert_allclose(at_fit, fit.e2, rtol=1e-9)
    assert np.all(_analysis.objective(material, np.geomspace(0.01, 3, 40), 1) >= fit.lower_bound * (1 - 1e-9))
    if more == {"diffuse": "burley"}:
        assert "index n" in page(measured, "made", lobes=1, **(ASKED | more))
