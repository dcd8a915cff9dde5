"""Maps of texels with directions of their own, and the same bits as the command line. SPDX-License-Identifier: MIT"""
import dataclasses

import numpy as np
import pytest

import brdffit
import stacks
from map_case import BAD_VALUE, CERTIFIED, MASKED, NO_SAMPLES, NO_SIGNAL, same


@pytest.fixture(scope="module")
def bent():
    """5 x 4 texels whose normals differ, in a folder: stack, light, view, normals."""
    rng = np.random.default_rng(5)
    normals = rng.standard_normal((5, 4, 3)) * 0.15 + [0, 0, 1]
    normals[1, 1], normals[4, 0] = (0, 0, -1), (0, 0, 3)
    stack, light, view = stacks.make(5, 4, normals=normals / np.linalg.norm(normals, axis=2, keepdims=True))
    stack = stack.astype(np.float32)
    stack[0, 2, 2, 1], stack[:, 3, 3] = np.inf, 0
    return stack, light, view, normals


def command(folder, bent, *options, **arrays):
    stack, light, view, _ = bent
    for name, array in {"stack": stack, "lights": light, "views": view, **arrays}.items():
        np.save(folder / (name + ".npy"), array)
    extra = [word for name in arrays if name not in ("lights", "views", "stack")
             for word in ("--" + name, name + ".npy")]
    stacks.run(folder, "stack.npy", "--lights", "lights.npy", "--views", "views.npy", "-o", "theirs", *extra, *options,
               expect=3)


def equal_files(one, other):
    names = sorted(path.name for path in one.iterdir())
    assert names == sorted(path.name for path in other.iterdir()) and names
    for name in names:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name


@pytest.mark.parametrize("options", [{}, {"lobes": 2, "distribution": "blinn-phong"},
                                     {"relative_gap": 0.003, "max_incidence": 55.1}], ids=str)
def test_the_files_of_the_command_line(bent, tmp_path, options):
    """Shared directions and a mask: byte for byte, as folder and as .npz, with the exponent where there is one."""
    words = [word for key, value in options.items()
             for word in ("--" + {"relative_gap": "gap"}.get(key, key).replace("_", "-"), str(value))]
    mask = np.ones((5, 4))
    mask[0, 1:3] = 0, np.nan
    command(tmp_path, bent, *words, mask=mask)
    stack, light, view, _ = bent
    fits = brdffit.fit_map(stack, light, view, mask=mask, **options)
    assert list(fits.status[0]) == [CERTIFIED, MASKED, MASKED, CERTIFIED] and fits.status[2, 2] == BAD_VALUE
    fits.save(tmp_path / "ours")
    equal_files(tmp_path / "ours", tmp_path / "theirs")
    fits.save(tmp_path / "ours.npz")
    stacks.run(tmp_path, "stack.npy", "--lights", "lights.npy", "--views", "views.npy", "--mask", "mask.npy", "-o",
               "theirs.npz", *words, expect=3)
    with np.load(tmp_path / "ours.npz") as ours, np.load(tmp_path / "theirs.npz") as theirs:
        assert set(ours.files) == {*theirs.files, "map.json"}
        assert all(np.array_equal(ours[name], theirs[name], equal_nan=True) for name in theirs.files)
    fits.save(tmp_path / "images", format="pfm")
    stacks.run(tmp_path, "stack.npy", "--lights", "lights.npy", "--views", "views.npy", "--mask", "mask.npy", "-o",
               "their_images", "--format", "pfm", *words, expect=3)
    equal_files(tmp_path / "images", tmp_path / "their_images")


def test_a_table_as_geometry(bent, tmp_path):
    stack, light, view, normals = bent
    stacks.vectors_csv(tmp_path / "geometry.csv", light, view)
    expected = brdffit.fit_map(stack, light, view)
    for path in (tmp_path / "geometry.csv", str(tmp_path / "geometry.csv")):
        assert same(expected, brdffit.fit_map(stack, path))
    assert same(brdffit.fit_map(stack, light, view, normal=normals), brdffit.fit_map(stack, path, normal=normals))
    assert same(brdffit.fit_map(stack, light, view, quantity="radiance"), brdffit.fit_map(stack, path, quantity="radiance"))
    (tmp_path / "abc.csv").write_text("a,b,c\n" + "0.5,0.25,0.125\n1,1,0.5\n1,1,3\n")
    assert brdffit.fit_map(np.ones((3, 2, 1)), tmp_path / "abc.csv").quantity == "radiance"
    with pytest.raises(brdffit.DataError, match="geometry has 83|has 84"):
        brdffit.fit_map(stack[:83], path)
    with pytest.raises(brdffit.FileError):
        brdffit.fit_map(stack, tmp_path / "absent.csv")
    with pytest.raises(brdffit.DataError, match="twice"):
        brdffit.fit_map(stack, path, view)
    (tmp_path / "bad.csv").write_text("lx,ly,lz,vx,vy,vz\n0,0,1,0,0,1\n0,0,0,0,0,1\n")
    with pytest.raises(brdffit.DataError, match="line 3"):
        brdffit.fit_map(np.ones((2, 1, 1)), tmp_path / "bad.csv")


def test_a_normal_map_as_the_command_line(bent, tmp_path):
    stack, light, view, normals = bent
    command(tmp_path, bent, normals=normals)
    fits = brdffit.fit_map(stack, light, view, normal=normals, threads=2)
    fits.save(tmp_path / "ours")
    equal_files(tmp_path / "ours", tmp_path / "theirs")
    assert fits.status[1, 1] == NO_SAMPLES and fits.status[2, 2] == BAD_VALUE and fits.status[3, 3] == NO_SIGNAL
    assert fits.where[2, 2] == 1 and fits.stats["no_samples"] == 1 and fits.stats["general"] == 17
    assert fits.samples_skipped["incidence"] > 0


def test_own_lights_and_views_as_the_command_line(bent, tmp_path):
    stack, light, view, _ = bent
    rng = np.random.default_rng(6)
    lights = light[:, None, None] + 0.03 * rng.standard_normal((84, 5, 4, 3))
    views = view[:, None, None] + 0.03 * rng.standard_normal((84, 5, 4, 3))
    lights[3, 1, 2] = np.nan
    lights[:, 4, 3, 2] = -1
    command(tmp_path, bent, lights=lights, views=views)
    fits = brdffit.fit_map(stack, lights, views)
    fits.save(tmp_path / "ours")
    equal_files(tmp_path / "ours", tmp_path / "theirs")
    assert fits.status[4, 3] == NO_SAMPLES and fits.status[1, 2] == BAD_VALUE and fits.where[1, 2] == 9


def test_each_texel_has_the_bits_of_fit(bent):
    stack, light, view, normals = bent
    for options in ({"lobes": 2}, {"distribution": "lafortune", "relative_gap": 1e-5}):
        fits = brdffit.fit_map(stack, light, view, normal=normals, **options)
        for place in ((0, 0), (2, 1), (4, 0)):
            fit = brdffit.fit(brdffit.Samples.from_arrays(
                light, view, stack[(slice(None), *place)], normal=normals[place]), **options)
            for name in ("sigma", "x", "y", "channel_scale", "e2", "lower_bound", "sum_of_squares", "boxes"):
                assert np.array_equal(getattr(fit, name), getattr(fits, name)[place]), name
            assert fits.STOP[fits.stop[place]] == fit.stop and fits.status[place] == CERTIFIED


def test_threads_tiles_and_layouts_change_nothing(bent):
    stack, light, view, normals = bent
    mask = np.arange(20).reshape(5, 4) % 7 != 3
    whole = brdffit.fit_map(stack, light, view, normal=normals, mask=mask)
    assert (whole.status[~mask] == MASKED).all()
    for threads in (1, 2, 7):
        for tile in (1, 3, 100):
            assert same(whole, brdffit.fit_map(stack, light, view, normal=normals, mask=mask, threads=threads, tile=tile))
    turned = np.s_[::-1, 1:4]
    assert same(whole, brdffit.fit_map(stack[:, ::-1, 1:4], light, view, normal=normals[turned], mask=mask[turned]), turned)
    assert same(whole, brdffit.fit_map(stack.astype(">f8"), light, view, normal=np.asfortranarray(normals), mask=mask))
    wide = np.broadcast_to(view[:, None, None], (84, 5, 4, 3))
    assert same(whole, brdffit.fit_map(stack, light, wide, normal=normals, mask=mask))
    assert same(whole, brdffit.fit_map(stack, light, wide[:, :1, :1], normal=normals, mask=mask))


def test_scale_and_weights(bent):
    stack, light, view, normals = bent
    weights = np.linspace(0, 1, 84)
    counts = np.round(np.clip(stack[:, :2], 0, 6) * 8192).astype(np.uint16)
    fits = brdffit.fit_map(counts, light, view, normal=normals[:2], weights=weights, scale=1 / 8192)
    assert same(fits, brdffit.fit_map(counts / 8192, light, view, normal=normals[:2], weights=weights))


@pytest.mark.parametrize("options, words", [({"normal": np.zeros((5, 5, 3))}, "normal must have shape"),
                                            ({"view": np.zeros((84, 5, 5, 3))}, "view must have shape"),
                                            ({"weights": -np.ones(84)}, "sample 0"),
                                            ({"view": np.zeros(3)}, "sample 0"), ({"sigma_range": (3, 1)}, "sigma")])
def test_bad_arguments(bent, options, words):
    stack, light, view, normals = bent
    with pytest.raises(brdffit.BrdffitError, match=words):
        brdffit.fit_map(stack, light, **{"view": view, "normal": normals, **options})


def test_errors_that_are_raised(bent):
    stack, light, view, normals = bent
    with pytest.raises(brdffit.DataError) as caught:
        brdffit.fit_map(stack, light, view, normal=normals, errors="raise", tile=2, threads=1)
    # With more threads, the first that any of them met: (2, 2) may be before (1, 1).
    assert (caught.value.code, caught.value.texel) == ("no_samples", (1, 1))
    with pytest.raises(brdffit.DataError) as caught:
        brdffit.fit_map(stack[:, 2:], light, view, normal=normals[2:], errors="raise")
    error = caught.value
    assert (error.code, error.texel, error.sample, error.channel) == ("value", (0, 2), 0, 1) and error.value == np.inf


# ---- Files, and models elsewhere


@pytest.mark.parametrize("options", [
    {"sigma_range": (0.05, 0.5), "absolute_gap": 1e-9, "max_incidence": 50.0, "normalise": "none"},
    {"distribution": "lafortune", "exponent_range": (1.0, 1e5), "lobes": 2, "box_budget": 77, "sigma_resolution": 1e-9}], ids=str)
def test_what_is_read_again_claims_no_more(bent, tmp_path, options):
    """The range that was searched comes back: the proof holds there and nowhere else."""
    fits = brdffit.fit_map(bent[0], *bent[1:3], **options)
    fits.save(tmp_path / "m")
    again = brdffit.FitMap.load(tmp_path / "m")
    assert again.options == fits.options
    assert repr(again).partition("Proven")[2] == repr(fits).partition("Proven")[2] != ""


def test_read_again(bent, tmp_path):
    stack, light, view, _ = bent
    fits = brdffit.fit_map(stack, light, view, quantity="radiance", distribution="ggx", relative_gap=1e-4)
    fits.save(tmp_path / "m")
    fits.save(tmp_path / "m.npz")
    fits.save(tmp_path / "m")  # in its own place
    assert sorted(path.name for path in tmp_path.iterdir()) == ["m", "m.npz"]
    for path in (tmp_path / "m", tmp_path / "m.npz"):
        again = brdffit.FitMap.load(path)
        for name in ("sigma", "x", "y", "e2", "lower_bound", "status"):
            assert np.array_equal(getattr(again, name), getattr(fits, name), equal_nan=True)
        assert (again.quantity, again.options.distribution, again.options.relative_gap, again.samples) == (
            "radiance", "ggx", 1e-4, 84)
        assert again.counts == fits.counts and np.array_equal(again.predict(light, view), fits.predict(light, view),
                                                              equal_nan=True)
        assert "certified" in repr(again)
    line = brdffit.fit_map(stack[:, 0], light, view)
    line.save(tmp_path / "line.npz")
    assert brdffit.FitMap.load(tmp_path / "line.npz").shape == (4,)
    with pytest.raises(brdffit.OptionError, match="two spatial axes"):
        line.save(tmp_path / "line", format="pfm")
    with pytest.raises(brdffit.OptionError, match="folder"):
        fits.save(tmp_path / "images.npz", format="pfm")
    with pytest.raises(brdffit.FileError):
        fits.save(tmp_path / "absent" / "m")


def test_files_that_are_no_maps(tmp_path, bent):
    with pytest.raises(brdffit.FileError):
        brdffit.FitMap.load(tmp_path / "absent")
    with pytest.raises(brdffit.FileError):
        brdffit.FitMap.load(tmp_path / "absent.npz")
    (tmp_path / "file").write_text("")
    with pytest.raises(brdffit.FileError, match="file"):
        brdffit.FitMap.load(tmp_path / "file")
    (tmp_path / "text.npz").write_text("text")
    np.savez(tmp_path / "other.npz", sigma=np.zeros(3))
    for name in ("text.npz", "other.npz"):
        with pytest.raises(brdffit.DataError, match=name):
            brdffit.FitMap.load(tmp_path / name)
    brdffit.fit_map(bent[0], *bent[1:3]).save(tmp_path / "m")
    np.save(tmp_path / "m" / "x.npy", np.zeros((5, 4, 2)))
    with pytest.raises(brdffit.DataError, match="x is float64 of shape"):
        brdffit.FitMap.load(tmp_path / "m")
    (tmp_path / "m" / "map.json").write_text('{"schema": "else"}')
    with pytest.raises(brdffit.DataError, match="schema"):
        brdffit.FitMap.load(tmp_path / "m")


@pytest.mark.parametrize("options", [{}, {"distribution": "lafortune", "lobes": 2, "quantity": "radiance"}], ids=str)
def test_predict(bent, options):
    """The bits of Fit.predict, for every shape of directions."""
    stack, light, view, normals = bent
    fits = brdffit.fit_map(stack, light, view, **options)
    one = {key: value for key, value in options.items() if key != "quantity"}
    model = brdffit.fit(brdffit.Samples.from_arrays(light, view, stack[:, 0, 0], quantity=options.get("quantity", "brdf")),
                        **one)
    at_all = fits.predict(light, view)
    bent_too = fits.predict(light, view, normal=normals)
    own = light[:7, None, None] + 0.1 * np.random.default_rng(3).standard_normal((7, 5, 4, 3))
    by_own = fits.predict(own, view[:7], normal=normals, quantity="brdf")
    single, broadcast = fits.predict(light[9], view[9]), fits.predict(light, view[0])
    assert at_all.shape == bent_too.shape == (84, 5, 4, 3) and single.shape == (5, 4, 3) and by_own.shape == (7, 5, 4, 3)
    assert np.isnan(at_all[:, 2, 2]).all() and not at_all[:, 3, 3].any()
    for place in ((0, 0), (4, 3), (1, 1)):
        here = dataclasses.replace(model, sigma=fits.sigma[place], x=fits.x[place], y=fits.y[place])
        there = (slice(None), *place)
        assert np.array_equal(here.predict(light, view), at_all[there])
        assert np.array_equal(here.predict(light[9], view[9]), single[place])
        assert np.array_equal(here.predict(light, view[0]), broadcast[there])
        assert np.array_equal(here.predict(light, view, normal=normals[place]), bent_too[there])
        assert np.array_equal(here.predict(own[there], view[:7], normal=normals[place], quantity="brdf"), by_own[there])
    assert fits.predict(np.zeros((0, 3)), view[0]).shape == (0, 5, 4, 3)
    for change in ({"y": fits.y[:, :, :1]}, {"x": fits.x[:1]}, {"sigma": fits.sigma[:2]}):
        with pytest.raises(brdffit.DataError, match="do not belong"):
            dataclasses.replace(fits, **change).predict(light, view)


@pytest.mark.parametrize("arguments, words", [
    ((np.zeros((3, 2)), [0, 0, 1]), "3 components"), ((np.ones((3, 3)), np.ones((4, 3))), "3 and 4 directions"),
    ((np.ones((3, 5, 5, 3)), [0, 0, 1]), "light must have shape"), (([0, 0, 0], [0, 0, 1]), "sample 0"),
    (([0, 0, 1], [0, 0, np.nan]), "sample 0")])
def test_bad_directions(bent, arguments, words):
    fits = brdffit.fit_map(*bent[:3])
    with pytest.raises(brdffit.DataError, match=words):
        fits.predict(*arguments)
    with pytest.raises(brdffit.DataError, match="normal must have shape"):
        fits.predict([0, 0, 1], normal=np.zeros((4, 5, 3)))
    with pytest.raises(brdffit.OptionError, match="quantity"):
        fits.predict([0, 0, 1], quantity="x")
