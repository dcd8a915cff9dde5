"""Lists of lobes: what a fit, a map and their files say of each. SPDX-License-Identifier: MIT"""
import dataclasses
import inspect
import json

import numpy as np
import pytest

import brdffit
import harness
import model
from brdffit import _ffi, _lobes
from map_case import CERTIFIED, desk, same  # noqa: F401 (one is a fixture)

LISTS = [["ggx", "blinn-phong"], ["beckmann", "ggx"], ["ward", "ggx", "ward"], ["lafortune", "torrance-sparrow"],
         ["ashikhmin-shirley"] * 2, ["ggx"]]


def test_the_library_names_them():
    """In the order of the enumeration; what the package says of one it has from there."""
    core = _ffi.library().core
    for value, (name, parameter) in enumerate(brdffit.distributions().items()):
        assert core.brdffit_distribution_string(value).decode() == name and _lobes.value(name) == value
        assert core.brdffit_parameter_string(value).decode() == parameter
        assert core.brdffit_distribution_title(value).decode() == _lobes.title(name)
    assert list(brdffit.distributions()) == list(model.DISTRIBUTIONS)
    assert [name for name, by in brdffit.distributions().items() if by == "exponent"] == list(model.EXPONENTS)


@pytest.mark.parametrize("names", LISTS, ids=",".join)
def test_a_fit_says_what_each_lobe_is(names):
    fit = brdffit.fit(brdffit.Samples.example(), lobes=names, relative_gap=0.02)
    assert fit.certified and fit.lobes == len(names)
    assert fit.distributions == tuple(sorted(names, key=names.index))
    assert fit.distribution == (names[0] if len(set(names)) == 1 else None)
    assert fit.parameters == tuple(brdffit.distributions()[name] for name in fit.distributions)
    by_n = np.array([name == "exponent" for name in fit.parameters])
    assert (fit.exponent is None) == (fit.exponent_interval is None) == (fit.exponent_range is None) == (not by_n.any())
    if by_n.any():
        assert np.array_equal(np.isnan(fit.exponent), ~by_n) and np.array_equal(np.isnan(fit.exponent_interval[:, 1]), ~by_n)
        assert np.allclose(fit.exponent[by_n], fit.sigma[by_n] ** -2, rtol=1e-14)
    assert np.array_equal(fit.values, np.where(by_n, fit.exponent if by_n.any() else 0, fit.sigma))
    for first, second in zip(range(fit.lobes), range(1, fit.lobes)):
        assert fit.distributions[first] != fit.distributions[second] or fit.sigma[first] <= fit.sigma[second]
    # The model by formulas of its own.
    samples = brdffit.Samples.example()
    expected = samples.light[:, 2:] / np.pi * fit.x
    for p, name in enumerate(fit.distributions):
        _, b, c, _, _ = model.directions_to_abc(samples.light, samples.view, distribution=name)
        expected = expected + (b * model.shape(name, fit.sigma[p] ** -2, c))[:, None] * fit.y[:, p]
    assert np.allclose(fit.predict_samples(samples, quantity="radiance"), expected, rtol=1e-10)


@pytest.mark.parametrize("names", LISTS, ids=",".join)
def test_lines_of_the_command_line_and_back(instruments, tmp_path, names):
    """The same fit, member for member; each reads what the other wrote."""
    path = instruments / "two_lobe_satin.csv"
    fit = brdffit.fit(path, lobes=names, relative_gap=0.05)
    (line,) = harness.fit(str(path), "--lobes", ",".join(names), "--gap", "0.05")
    ours = json.loads(fit.to_json())
    assert list(ours) == list(line)
    assert {k: v for k, v in ours.items() if k != "seconds"} == {k: v for k, v in line.items() if k != "seconds"}
    again = brdffit.Fit.from_dict(line)
    assert dataclasses.replace(again, seconds=fit.seconds).to_dict() == fit.to_dict()
    assert again.certificate == fit.certificate and repr(again) == repr(fit)
    (tmp_path / "fit.json").write_text(fit.to_json() + "\n")
    done = harness.run("eval", tmp_path / "fit.json", path)
    assert done.returncode == 0 and "other data" not in done.stderr
    table = np.genfromtxt(done.stdout.splitlines(), delimiter=",", names=True)
    fitted = np.stack([table[name + "_fit"] for name in fit.channels], 1)
    assert np.allclose(again.predict_samples(brdffit.Samples.from_file(path)), fitted, rtol=1e-15)


def test_words_are_those_of_the_command_line(instruments):
    path = str(instruments / "two_lobe_satin.csv")
    for names in LISTS:
        fit = brdffit.fit(path, lobes=names, relative_gap=0.05)
        done = harness.run("fit", "--lobes", ",".join(names), "--gap", "0.05", path)
        assert " ".join(fit.certificate.split()) in " ".join(done.stdout.split())


def test_lines_without_a_list():
    fit = brdffit.fit(brdffit.Samples.example(), lobes=2, distribution="ggx")
    line = fit.to_dict()
    del line["distributions"]
    assert brdffit.Fit.from_dict(line).to_json() == fit.to_json()
    with pytest.raises(brdffit.DataError, match="distributions"):
        brdffit.Fit.from_dict({**line, "distribution": None})


def test_each_range_is_its_parameters():
    samples = brdffit.Samples.example()
    fit = brdffit.fit(samples, lobes=["beckmann", "lafortune"], sigma_range=(0.3, 1), exponent_range=(0.2, 5))
    assert fit.sigma_range == (0.3, 1) and fit.exponent_range == (0.2, 5)
    assert 0.3 <= fit.sigma[0] <= 1 and 0.2 <= fit.exponent[1] <= 5
    assert "σ in [0.3, 1] and n in [0.2, 5]" in fit.certificate


def test_options():
    Options = brdffit.Options
    assert Options(lobes=["ggx", "ward", "ggx"]).distributions == ("ggx", "ggx", "ward")
    assert Options(lobes=2).distributions == ("beckmann", "beckmann") and Options().lobe_count == 1
    assert Options(lobes=("ggx", "ggx"))._plain() == Options(lobes=2, distribution="ggx")._plain()
    mixed = Options(lobes=["ward", "lafortune"])
    assert mixed.parameters == ("sigma", "exponent") and mixed._plain().lobes == ("ward", "lafortune")
    assert bytes(mixed._struct()) == bytes(Options(lobes=("ward", "lafortune"))._struct())
    assert mixed.replace(lobes=1).distributions == ("beckmann",) and hash(mixed) == hash(Options(lobes=("ward", "lafortune")))
    # None: what the form says, or else as Options has it.
    assert inspect.signature(brdffit.fit).parameters["lobes"].default is None
    assert inspect.signature(brdffit.fit).parameters["distribution"].default == Options().distribution


@pytest.mark.parametrize("names", [["ggx", "blinn-phong"], ["ward", "ggx", "ward"]], ids=",".join)
def test_maps(desk, tmp_path, names):
    """Files of maps, ours and the command line's, say which lobe is which; what is read back predicts the same."""
    stack, light, view = desk
    stack = stack[:, :2, :3]
    fits = brdffit.fit_map(stack, light, view, lobes=names, relative_gap=0.1)
    assert (fits.status == CERTIFIED).all() and fits.distributions == tuple(sorted(names, key=names.index))
    np.save(tmp_path / "stack.npy", stack)
    np.save(tmp_path / "light.npy", light)
    np.save(tmp_path / "view.npy", view)
    done = harness.run("map", "stack.npy", "--lights", "light.npy", "--views", "view.npy", "--lobes", ",".join(names), "--gap",
                       "0.1", "-o", "theirs", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    fits.save(tmp_path / "ours")
    for file in (tmp_path / "theirs").iterdir():
        assert file.read_bytes() == (tmp_path / "ours" / file.name).read_bytes(), file.name
    again = brdffit.FitMap.load(tmp_path / "theirs")
    assert again.options == fits.options and repr(again).splitlines()[2:] == [
        line for line in repr(fits).splitlines() if not line.startswith("  Run")][2:]
    assert np.array_equal(again.predict(light, view), fits.predict(light, view))
    one = brdffit.fit(brdffit.Samples.from_arrays(light, view, stack[:, 1, 2]), lobes=names, relative_gap=0.1)
    assert np.array_equal(fits.predict(light, view)[:, 1, 2], one.predict(light, view))
    if fits.exponent is not None:
        assert np.isnan(fits.exponent[..., 0]).all() and np.allclose(fits.exponent[..., 1], fits.sigma[..., 1] ** -2)
    own = brdffit.fit_map(stack, light, view, lobes=names, relative_gap=0.1, normal=np.broadcast_to([0.0, 0, 1], (2, 3, 3)))
    assert all(np.array_equal(getattr(own, name), getattr(fits, name)) for name in ("sigma", "x", "y"))


def test_maps_out_of_core(desk, tmp_path):
    zarr = pytest.importorskip("zarr")
    stack, light, view = desk
    ask = {"lobes": ["ward", "blinn-phong"], "relative_gap": 0.1}
    fits = brdffit.fit_map(stack[:, :2, :2], light, view, **ask)
    stored = brdffit.fit_map(stack[:, :2, :2], light, view, output=tmp_path / "m.zarr", tile=1, **ask)
    from brdffit.dask import open_maps

    for maps in (stored, open_maps(tmp_path / "m.zarr")):
        assert maps.options == fits.options and same(maps.load(), fits)
    group = zarr.open_group(str(tmp_path / "m.zarr"), mode="r")
    assert dict(group["sigma"].attrs) == {"distributions": "ward blinn-phong", "parameters": "sigma exponent"}
    brdffit.fit_map(stack[:, :2, :2], light, view, output=tmp_path / "m.zarr", tile=1, **ask)  # goes on
    with pytest.raises(brdffit.DataError, match="lobes was"):
        brdffit.fit_map(stack[:, :2, :2], light, view, output=tmp_path / "m.zarr", tile=1, **{**ask, "lobes": ["ward", "ggx"]})


def test_boxes_of_lobes_that_differ():
    """The search orders lobes of one distribution and no others: the bound holds at each combination."""
    samples = brdffit.Samples.example()
    for names in (["ggx", "beckmann"], ["ward", "ggx", "ward"]):
        fit, boxes = brdffit.fit_boxes(samples, lobes=names, relative_gap=0.1)
        assert boxes.distributions == fit.distributions
        assert 0 < boxes.bound_at(*fit.sigma) <= fit.e2
        if len(names) == 3:
            assert boxes.bound_at(fit.sigma[1], fit.sigma[0], fit.sigma[2]) == boxes.bound_at(*fit.sigma)
        else:
            assert boxes.bound_at(*fit.sigma[::-1]) > boxes.bound_at(*fit.sigma)
