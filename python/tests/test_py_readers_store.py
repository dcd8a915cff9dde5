"""Samples and stacks in HDF5 files and zarr groups. SPDX-License-Identifier: MIT"""
import pickle
import shutil
import sys

import h5py
import numpy as np
import pytest
import zarr

import brdffit
from brdffit.report import main as report

KINDS = ("hdf5", "zarr", "zip", "zarr2")


def write(tmp_path, kind, data, attributes=(), name="data"):
    """data: {path: array or (array, attributes)}; attributes: of the root."""
    path = tmp_path / (name + {"hdf5": ".h5", "zarr": ".zarr", "zip": ".zarr.zip", "zarr2": ".zarr"}[kind])
    if kind == "hdf5":
        root = h5py.File(path, "w")
    elif kind in ("zarr", "zarr2"):
        root = zarr.open_group(path, mode="w", zarr_format=2 if kind == "zarr2" else 3)
    else:
        path.unlink(missing_ok=True)
        store = zarr.storage.ZipStore(path, mode="w")
        root = zarr.create_group(store, attributes=dict(attributes))
    for key, value in data.items():
        array, attrs = value if isinstance(value, tuple) else (np.asarray(value), {})
        if kind == "hdf5":
            made = root.create_dataset(key, data=array)
        else:
            made = root.create_array(key, shape=array.shape, dtype=array.dtype, chunks=tuple(max(1, n // 2) for n in array.shape),
                                     attributes=attrs)
            made[...] = array
        if kind == "hdf5":
            made.attrs.update(attrs)
    if kind != "zip":  # which cannot write a file twice
        root.attrs.update(dict(attributes))
    if kind == "hdf5":
        root.close()
    elif kind == "zip":
        store.close()
    return path


def read(path, kind, **options):
    return (brdffit.Samples.from_hdf5 if kind == "hdf5" else brdffit.Samples.from_zarr)(path, **options)


@pytest.fixture(scope="module")
def example():
    return brdffit.Samples.example()


def directions(samples):
    return {"values": samples.values, "light": samples.light * 3, "view": samples.view}


@pytest.mark.parametrize("kind", KINDS)
def test_samples(tmp_path, kind, example):
    want = brdffit.fit(example, lobes=1)
    path = write(tmp_path, kind, directions(example))
    s = brdffit.Samples.from_file(path)
    assert s.format == ("hdf5" if kind == "hdf5" else "zarr") and s.file == str(path) and s.channels == ("r", "g", "b")
    assert s.form == "directions" and s.quantity == "brdf" and len(s) == len(example) and s.weights is None
    assert brdffit.fit(path, lobes=1).e2 == pytest.approx(want.e2, rel=1e-9)
    angles = {}
    for end, d in (("i", example.light), ("o", example.view)):
        angles["theta_" + end] = np.degrees(np.arctan2(np.hypot(d[:, 0], d[:, 1]), d[:, 2]))
        angles["phi_" + end] = (np.arctan2(d[:, 1], d[:, 0]), {"units": "radian"})
    data = {**angles, "values": (example.values, {"channels": ["p", "q", "s"], "quantity": "radiance"}),
            "weights": np.arange(len(example)) + 1.0, "normal": np.tile([0.0, 0, 2], (len(example), 1))}
    s = brdffit.Samples.from_file(write(tmp_path, kind, data, {"quantity": "brdf"}))
    for mine, theirs in ((s.light, example.light), (s.view, example.view)):
        assert np.abs(mine - theirs / np.linalg.norm(theirs, axis=1, keepdims=True)).max() < 1e-14
    assert s.channels == ("p", "q", "s") and s.quantity == "radiance" and s.weights[4] == 5 and s.normal[0, 2] == 2


@pytest.mark.parametrize("kind", KINDS)
def test_names_and_groups(tmp_path, kind, example):
    n = len(example)
    data = {"run/red": example.values[:, 0], "run/blue": example.values[:, 2].astype(np.float32), "run/geo/in": example.light,
            "run/geo/out": example.view}
    path = write(tmp_path, kind, data, {"quantity": "radiance"})
    names = {"values": ["red", "blue"], "light": "geo/in", "view": "geo/out"}
    s = read(path, kind, group="run", names=names)
    assert s.channels == ("red", "blue") and (s.values[:, 0] == example.values[:, 0]).all() and s.quantity == "brdf"
    s = read(path, kind, names={k: ["run/" + x for x in v] if k == "values" else "run/" + v for k, v in names.items()},
             quantity="brdf")
    assert s.channels == ("red", "blue") and s.quantity == "brdf"
    assert read(path, kind, group="run", names={**names, "values": "red"}).values.shape == (n, 1)
    for options, words in (({}, "there is no data set 'values'; there are run"),
                           ({"group": "ruin"}, "there is no group 'ruin'"),
                           ({"group": "run/red"}, "run/red is an array"),
                           ({"group": "run", "names": {**names, "weights": "w"}}, "there is no data set 'w'"),
                           ({"group": "run", "names": {**names, "values": "geo"}}, "'geo' is not a data set of numbers"),
                           ({"group": "run", "names": {"values": "red"}}, "there is neither 'light' nor 'theta_i'")):
        with pytest.raises(brdffit.DataError) as caught:
            read(path, kind, **options)
        assert words in str(caught.value) and str(path) in str(caught.value)
    for options, words in (({"names": {"value": "red"}}, "names= has 'value'"),
                           ({"names": {"light": ["a", "b"], "values": "run/red"}}, "only values may be several"),
                           ({"names": {"values": []}}, "values must be one data set or more"),
                           ({"group": "run", "names": names, "quantity": "bright"}, 'quantity must be "brdf" or "radiance"')):
        with pytest.raises(brdffit.OptionError, match=words):
            read(path, kind, **options)


@pytest.mark.parametrize("kind", KINDS[:2])
def test_other_forms_and_gaps(tmp_path, kind):
    rng = np.random.default_rng(1)
    columns = {name: rng.uniform(0.1, 1, 50) for name in ("cos_light", "cos_view", "tan2_half", "cos_difference")}
    values = rng.uniform(0, 1, (50, 2))
    values[[3, 7], 1] = np.nan
    s = brdffit.Samples.from_file(write(tmp_path, kind, {**columns, "values": values}))
    assert s.form == "angles" and len(s) == 48 and s.dropped == {"absent": 2} and s.cos_view[3] == columns["cos_view"][4]
    fit = brdffit.fit(s, lobes=1)
    assert fit.samples_skipped["absent"] == 2
    s = brdffit.Samples.from_file(write(tmp_path, kind, {"a": values[:, 0], "b": values[:, 0], "c": values[:, 0],
                                                         "values": values[:, 0]}))
    assert s.form == "coefficients" and s.quantity == "radiance" and s.values.shape == (50, 1) and s.channels == ("channel1",)
    plane = {"theta_i": np.linspace(-60, 60, 50), "theta_o": np.full(50, 30.0), "values": values[:, 0]}
    s = brdffit.Samples.from_file(write(tmp_path, kind, plane))
    assert s.light[0] == pytest.approx([-np.sqrt(0.75), 0, 0.5]) and s.view[0] == pytest.approx([-0.5, 0, np.sqrt(0.75)])
    with pytest.raises(brdffit.DataError, match="no data set 'phi_o', though the other azimuth is there"):
        brdffit.Samples.from_file(write(tmp_path, kind, {**plane, "phi_i": plane["theta_i"]}))


WRONG = [
    ({"values": np.zeros((4, 2, 2))}, {}, "'values' has 3 dimensions; samples have N x K or N: load_stack"),
    ({"values": np.zeros((0, 3))}, {}, "data set 'values' is empty"),
    ({"values": np.full((4, 1), np.nan)}, {}, "every sample has a channel that is absent"),
    ({"values": np.zeros(4, complex)}, {}, "'values' is not a data set of numbers"),
    ({"light": np.zeros((3, 3))}, {}, "data set 'light' must have shape (4, 3), not (3, 3)"),
    ({"weights": np.zeros((4, 1))}, {}, "data set 'weights' must have shape (4,), not (4, 1)"),
    ({}, {"quantity": "bright"}, "attribute \"quantity\" must be \"brdf\" or \"radiance\", not 'bright'"),
    ({}, {"channels": ["a", "b"]}, 'attribute "channels" names 2, but there are 1'),
]


@pytest.mark.parametrize("kind", KINDS[:2])
@pytest.mark.parametrize("case", range(len(WRONG)))
def test_wrong_content(tmp_path, kind, case):
    data, attributes, words = WRONG[case]
    base = {"values": np.zeros((4, 1)), "light": np.ones((4, 3)), "view": np.ones((4, 3))}
    with pytest.raises(brdffit.DataError) as caught:
        brdffit.Samples.from_file(write(tmp_path, kind, {**base, **data}, attributes))
    assert words in str(caught.value) and str(tmp_path) in str(caught.value)


def test_broken_files(tmp_path, example, monkeypatch):
    path = write(tmp_path, "hdf5", directions(example))
    whole = path.read_bytes()
    rng = np.random.default_rng(2)
    for length in [0, 5, 8, 100, *rng.integers(100, len(whole) - 1, 60)]:
        path.write_bytes(whole[:length])
        with pytest.raises(brdffit.BrdffitError, match="data.h5: "):
            brdffit.Samples.from_file(path)
    zipped = write(tmp_path, "zip", directions(example))
    whole = zipped.read_bytes()
    for length in [0, 5, 100, *rng.integers(100, len(whole) - 1, 40)]:
        zipped.write_bytes(whole[:length])
        with pytest.raises(brdffit.BrdffitError, match="data.zarr.zip: "):
            brdffit.Samples.from_file(zipped)
    folder = write(tmp_path, "zarr", directions(example))
    survived = 0
    files = sorted(p for p in folder.rglob("*") if p.is_file())
    for file in files:
        whole = file.read_bytes()
        for _ in range(6):
            broken = bytearray(whole[:rng.integers(len(whole))])
            if broken:
                broken[rng.integers(len(broken))] ^= 255
            file.write_bytes(broken)
            try:
                brdffit.Samples.from_file(folder)
                survived += 1
            except brdffit.BrdffitError as error:
                assert "data.zarr" in str(error)
        file.write_bytes(whole)
    assert survived < 3 * len(files)
    for name in ("absent.h5", "absent.zarr"):
        with pytest.raises(brdffit.FileError, match=name + ": no such file"):
            brdffit.Samples.from_file(tmp_path / name)
    for module, kept, extra in (("h5py", path, "hdf5"), ("zarr", folder, "zarr")):
        monkeypatch.setitem(sys.modules, module, None)
        kept.touch()
        with pytest.raises(brdffit.UnsupportedError, match=r'pip install "brdffit\[%s\]"' % extra):
            read(kept, "hdf5" if extra == "hdf5" else "zarr")


def test_report(tmp_path, example):
    paths = [write(tmp_path, kind, directions(example), name="paint_" + kind) for kind in ("hdf5", "zarr")]
    assert report([*map(str, paths), "-o", str(tmp_path / "pages"), "--lobes", "1", "--values", "radiance"]) == 0
    page = (tmp_path / "pages" / "paint_hdf5.html").read_text()
    assert "300 samples of 3 channels" in page and (tmp_path / "pages" / "paint_zarr.html").exists()


# ---- Stacks -------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_stack(tmp_path, kind):
    rng = np.random.default_rng(3)
    values = rng.uniform(0, 1, (5, 12, 9, 4)).astype(np.float32)
    light, mask = rng.uniform(0.1, 1, (5, 3)), rng.integers(0, 2, (12, 9)).astype(np.uint8)
    normal = rng.uniform(0.1, 1, (12, 9, 3))
    attributes = {"channels": ["450", "550", "650", "nir"], "quantity": "brdf"}
    path = write(tmp_path, kind, {"values": (values, attributes), "light": light, "mask": mask, "normal": normal,
                                  "view": np.array([0.0, 0.6, 0.8])})
    stack = brdffit.load_stack(path)
    assert stack.values.shape == values.shape and stack.values.dtype == np.float32
    assert stack.format == ("hdf5" if kind == "hdf5" else "zarr")
    assert stack.channels == ("450", "550", "650", "nir") and stack.quantity == "brdf"
    assert np.array_equal(stack.values[1:4, ::5, 2, 1:], values[1:4, ::5, 2, 1:]) and np.array_equal(stack.values, values)
    assert np.array_equal(stack.light, light) and np.array_equal(stack.mask, mask != 0) and np.array_equal(stack.normal, normal)
    assert (stack.view == [0, 0.6, 0.8]).all() and stack.view.shape == (5, 3)
    some = brdffit.load_stack(path, channels=["nir", "550"], view=[0, 0, 2], quantity="radiance", light=light[::-1])
    assert some.channels == ("nir", "550") and np.array_equal(some.values[2:], values[2:][..., [3, 1]])
    assert np.array_equal(some.light, light[::-1]) and (some.view == [0, 0, 2]).all() and some.quantity == "radiance"
    again = pickle.loads(pickle.dumps(some))  # to another process
    assert np.array_equal(again.values[1, :, 3:5], values[1, :, 3:5][..., [3, 1]])
    texel = stack.texel(2, 3)
    assert (texel.values == values[:, 2, 3]).all() and (texel.normal == normal[2, 3]).all() and texel.quantity == "brdf"
    with pytest.raises(brdffit.OptionError, match="no channel 'x'; there are 450, 550, 650, nir"):
        brdffit.load_stack(path, channels=["x"])
    with pytest.raises(brdffit.DataError, match="light must have shape"):
        brdffit.load_stack(path, light=light[1:])
    with pytest.raises(brdffit.OptionError, match="images= goes with an .lp file"):
        brdffit.load_stack(path, images=["a.exr"])
    with pytest.raises(brdffit.DataError, match="'values' has 4 dimensions; samples have"):
        brdffit.Samples.from_file(path)


def test_the_weights_and_the_mask_of_a_stack(tmp_path):
    """Weights were read of samples alone, and NaN in a mask was taken for true."""
    rng = np.random.default_rng(8)
    light, view = brdffit.protocol84()
    values, weights = rng.uniform(0.5, 1, (84, 2, 3, 3)), rng.uniform(0, 2, 84)
    mask = np.array([[1, 0, np.nan], [1, 2, -1]])
    data = {"values": values, "light": light, "view": view, "weights": weights, "mask": mask}
    stack = brdffit.load_stack(write(tmp_path, "hdf5", data))
    expected = brdffit.fit_map(values, light, view, weights=weights, mask=mask, quantity="radiance")
    assert expected.counts["masked"] == 2
    for maps in (stack.fit_map(), stack.fit_map(rows=1), pickle.loads(pickle.dumps(stack)).fit_map()):
        assert np.array_equal(maps.x, expected.x, equal_nan=True) and np.array_equal(maps.e2, expected.e2, equal_nan=True)
    assert brdffit.fit(stack.texel(1, 1)).e2 == pytest.approx(expected.e2[1, 1], rel=1e-2)
    assert not np.array_equal(stack.fit_map(weights=None).e2, expected.e2, equal_nan=True)
    with pytest.raises(brdffit.DataError, match="weights"):
        brdffit.load_stack(write(tmp_path, "hdf5", {"values": values, "light": light, "weights": weights[1:]}, name="short"))


@pytest.mark.parametrize("kind", KINDS[:2])
def test_stacks_of_other_forms(tmp_path, kind):
    rng = np.random.default_rng(4)
    left, right = rng.integers(0, 9, (2, 3, 6, 5))
    path = write(tmp_path, kind, {"in/left": left, "in/right": right, "theta_i": np.array([0.0, 30, 60]), "thin": np.zeros((3, 1))})
    (tmp_path / "lights.lp").write_text("a 0 0 1\nb 0 3 4\nc 0 5 12\n")
    stack = brdffit.load_stack(path, names={"values": ["in/right", "in/left"], "theta_i": "theta_i"})
    assert stack.channels == ("right", "left") and stack.values.dtype == np.float64 and stack.mask is None
    assert np.array_equal(stack.values[..., 2:4, :, :], np.stack([right, left], -1)[..., 2:4, :, :])
    assert stack.light[1] == pytest.approx([0.5, 0, np.sqrt(0.75)]) and (stack.view == [0, 0, 1]).all()
    one = brdffit.load_stack(path, names={"values": "in/left"}, light=tmp_path / "lights.lp")
    assert one.values.shape == (3, 6, 5, 1) and np.array_equal(one.values[..., 0], left) and one.channels == ("channel1",)
    assert one.light[1] == pytest.approx([0, 0.6, 0.8]) and one.quantity == "radiance"
    again = pickle.loads(pickle.dumps(stack))
    shutil.rmtree(path) if kind == "zarr" else path.unlink()
    with pytest.raises(brdffit.FileError, match="no such file"):
        again.values[0]
    path = write(tmp_path, kind, {"values": left})
    with pytest.raises(brdffit.DataError, match="neither 'light' nor 'theta_i': give light=; there are values"):
        brdffit.load_stack(path)
    path = write(tmp_path, kind, {"values": np.zeros((3, 1)), "light": np.ones((3, 3))})
    with pytest.raises(brdffit.DataError, match="has 2 dimensions; a stack has .*: Samples.from_file reads samples"):
        brdffit.load_stack(path)
