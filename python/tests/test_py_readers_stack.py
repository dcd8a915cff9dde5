"""Light position files and stacks of OpenEXR images. SPDX-License-Identifier: MIT"""
import pickle
import struct
import sys
import tracemalloc

import numpy as np
import OpenEXR
import pytest

import brdffit
from brdffit.readers import exr
from brdffit.readers.stack import LazyArray, Stack

LIGHTS = np.array([[0.0, 0, 1], [-0.6, 0, 0.8], [0.5, 0.5, 0.7071]])


def write_lp(tmp_path, text, name="lights.lp"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


# ---- .lp ----------------------------------------------------------------------

ROWS = ["a.exr 0 0 1", "b 1.exr -0.6 0 0.8", "c.exr 0.5 0.5 0.7071"]
NAMES = ("a.exr", "b 1.exr", "c.exr")
PLAIN = "3\n" + "\n".join(ROWS) + "\n"
NUMBERED = "\n".join("%d %s" % (i, row) for i, row in enumerate(ROWS, 1))


@pytest.mark.parametrize("text, lines", [
    (PLAIN, (2, 3, 4)),
    (PLAIN.rstrip("\n"), (2, 3, 4)),
    (PLAIN.replace("\n", "\r\n"), (2, 3, 4)),
    (PLAIN.replace("\n", "\r"), (2, 3, 4)),
    ("\n".join(ROWS), (1, 2, 3)),
    (NUMBERED, (1, 2, 3)),
    (NUMBERED.replace("1 a", "0 a").replace("2 b", "1 b").replace("3 c", "2 c"), (1, 2, 3)),
    ("# by hand\n3\n\n" + PLAIN[2:].replace("\n", "\n// more\n"), (4, 6, 8)),
    (PLAIN.replace(" ", "\t  ").replace("b\t  1", "b 1"), (2, 3, 4)),
    (b"\xef\xbb\xbf" + PLAIN.encode() + b"\x1a", (2, 3, 4)),
    (PLAIN.encode("utf-16"), (2, 3, 4)),
    (PLAIN.replace("b 1.exr", '"b 1.exr"'), (2, 3, 4)),
    (PLAIN.replace("0 0 1", "+0.0 -0e3 1.").replace("3\n", " 3 \n", 1), (2, 3, 4)),
])
def test_variants(tmp_path, text, lines):
    lp = brdffit.load_lp(write_lp(tmp_path, text))
    assert lp.names == NAMES and lp.lines == lines and len(lp) == 3
    assert np.array_equal(lp.positions, LIGHTS)
    assert np.allclose(lp.directions, LIGHTS / np.linalg.norm(LIGHTS, axis=1, keepdims=True), rtol=1e-15)


def test_numbers_and_names(tmp_path):
    # Numbers instead of names, as a dome's own file has them.
    lp = brdffit.load_lp(write_lp(tmp_path, "2\n1 0 0 2\n2 0 3 4\n"))
    assert lp.names == ("", "") and np.allclose(lp.directions, [[0, 0, 1], [0, 0.6, 0.8]])
    with pytest.raises(brdffit.DataError, match=r"lights.lp: line 2: no image is named, only a number"):
        lp.paths()
    # Numbers that do not run are names; so is what a file is called.
    assert brdffit.load_lp(write_lp(tmp_path, "3 a 0 0 1\n7 b 0 0 1")).names == ("3 a", "7 b")
    (tmp_path / "2 b").touch()
    assert brdffit.load_lp(write_lp(tmp_path, "1 a 0 0 1\n2 b 0 0 1")).names == ("1 a", "2 b")
    latin = brdffit.load_lp(write_lp(tmp_path, b"gr\xfcn.exr 0 0 1"))
    (tmp_path / "x").mkdir()
    open(str(tmp_path).encode() + b"/gr\xfcn.exr", "w").close()
    assert latin.paths() == [str(tmp_path / "gr\udcfcn.exr")]


def test_where_images_are(tmp_path):
    (tmp_path / "sub").mkdir()
    for name in ("sub/a.exr", "b.exr", "c.exr"):
        (tmp_path / name).touch()
    lp = brdffit.load_lp(write_lp(tmp_path, f"sub\\a.exr 0 0 1\nC:\\old place\\b.exr 0 0 1\n{tmp_path}/c.exr 0 0 1"))
    assert [p.replace("\\", "/") for p in lp.paths()] == [str(tmp_path / n) for n in ("sub/a.exr", "b.exr", "c.exr")]
    lp = brdffit.load_lp(write_lp(tmp_path, "2\nb.exr 0 0 1\nd.exr 0 0 1"))
    with pytest.raises(brdffit.FileError, match=r"lights.lp: line 3: there is no image '.*d.exr'"):
        lp.paths()


@pytest.mark.parametrize("text, words", [
    ("", "there are no light positions"),
    ("4\n", "there are no light positions"),
    ("# nothing", "there are no light positions"),
    ("4\n" + PLAIN[2:], "line 1: the file announces 4 light positions and has 3"),
    ("3\na.exr 0 0\n", "line 2: expected a file name, x, y and z, not 'a.exr 0 0'"),
    ("3\na.exr 0 0 up\n", "line 2: the line must end with three numbers, not '0 0 up'"),
    ("a.exr 0,5 0,5 0,7\n", "line 1: the line must end with three numbers, not '0,5 0,5 0,7'; the decimal sign is a point"),
    ("a.exr 0 0 1\nb.exr 0 0 0", "line 2: (0, 0, 0) is no direction"),
    ("a.exr 0 nan 1", "line 1: (0, nan, 1) is no direction"),
    ("a.exr 0 inf 1", "line 1: (0, inf, 1) is no direction"),
    ("a.exr 0 0 1\nb.exr 0 0 1\na.exr 0 1 1", "line 3: 'a.exr' stands in line 1 already"),
    (b"a.exr 0 0 1\0", "this is not a text file"),
    (b"\xff\xfea", "the text is not valid UTF-16"),
])
def test_wrong_lp(tmp_path, text, words):
    path = write_lp(tmp_path, text)
    with pytest.raises(brdffit.DataError) as caught:
        brdffit.load_lp(path)
    assert words in str(caught.value) and str(caught.value).startswith(str(path))


def test_broken_lp(tmp_path):
    rng = np.random.default_rng(1)
    whole, survived = NUMBERED.encode() + b"\r\n" + b"4 \"d\" 1 2 3", 0
    for trial in range(600):
        broken = bytearray(whole[:rng.integers(len(whole) + 1)] if trial % 2 else whole)
        for at in rng.integers(0, len(broken), trial % 4) if broken else ():
            broken[at] = rng.integers(256)
        try:
            lp = brdffit.load_lp(write_lp(tmp_path, bytes(broken)))
            assert len(lp) > 0 and np.isfinite(lp.directions).all()
            lp.paths()
        except brdffit.BrdffitError as error:
            assert "lights.lp" in str(error)
            survived += error.code == "open"  # read, but the images are not there
    assert 50 < survived < 550
    with pytest.raises(brdffit.FileError, match="absent.lp: no such file"):
        brdffit.load_lp(tmp_path / "absent.lp")


# ---- Lazy arrays --------------------------------------------------------------


class Known(LazyArray):
    def __init__(self, array):
        super().__init__(array.shape, array.dtype)
        self.array = array

    def _read(self, part):
        assert all(p.step == 1 and 0 <= p.start < p.stop <= n for p, n in zip(part, self.shape))
        return self.array[part]


def test_indexing_is_numpys():
    array = np.arange(4 * 5 * 6 * 3.0).reshape(4, 5, 6, 3)
    lazy, rng = Known(array), np.random.default_rng(2)

    def index(extent):
        kind = rng.integers(4)
        low, high = rng.integers(-extent - 2, extent + 3, 2)
        return [slice(None), slice(low, high), slice(low, high, int(rng.choice([-3, -2, -1, 2, 3]))),
                int(rng.integers(-extent, extent))][kind]

    for _ in range(500):
        key = [index(n) for n in array.shape]
        first, last = sorted(rng.integers(0, 5, 2))
        if rng.integers(2):
            key[first:last] = [...]
        else:
            del key[last:]
        got, want = lazy[tuple(key)], array[tuple(key)]
        assert got.shape == want.shape and (got == want).all(), key
    assert (np.asarray(lazy) == array).all() and np.asarray(lazy, np.float32).dtype == np.float32
    assert len(lazy) == 4 and lazy.nbytes == array.nbytes and (lazy[np.int64(1)] == array[1]).all()
    for wrong in (4, (0, 5), (..., ...), (0,) * 5, [0, 1], 1.5, True, array > 3):
        with pytest.raises(IndexError):
            lazy[wrong]


# ---- OpenEXR ------------------------------------------------------------------


def write_exr(path, channels, tiles=None, window=None, compression=OpenEXR.ZIP_COMPRESSION):
    header = {"compression": compression, "type": OpenEXR.tiledimage if tiles else OpenEXR.scanlineimage}
    if tiles:
        header["tiles"] = OpenEXR.TileDescription()
        header["tiles"].xSize = header["tiles"].ySize = tiles
    if window:
        header["dataWindow"] = tuple(np.array(corner, np.int32) for corner in window)
    OpenEXR.File(header, channels).write(str(path))


@pytest.fixture
def scene(tmp_path):
    """Three images of one rough metal, as radiance, with another light each: stored in three ways."""
    rng = np.random.default_rng(4)
    values = rng.uniform(0, 2, (3, 40, 30, 3)).astype(np.float16).astype(np.float32)
    for name, image, how in zip(NAMES, values, ({}, {"tiles": 16}, {"compression": OpenEXR.PIZ_COMPRESSION})):
        kind = np.float16 if name == "a.exr" else np.float32
        write_exr(tmp_path / name, {c: image[..., k].astype(kind) for k, c in enumerate("RGB")}, **how)
    return write_lp(tmp_path, PLAIN), values


@pytest.mark.parametrize("whole", [False, True], ids=["windows", "whole images"])
def test_exr_stack(scene, monkeypatch, whole):
    path, values = scene
    if whole:  # as when the package has no InputFile any more
        monkeypatch.delattr(OpenEXR, "InputFile")
    stack = brdffit.load_stack(path)
    assert stack.values.shape == (3, 40, 30, 3) and stack.values.dtype == np.float32
    assert stack.channels == ("r", "g", "b") and stack.names == NAMES and stack.quantity == "radiance" and stack.format == "exr"
    assert np.array_equal(stack.values[...], values)
    assert np.array_equal(stack.values[:, 17:19, 5:9], values[:, 17:19, 5:9])
    assert np.array_equal(stack.values[2, -1, ::-7, 1], values[2, -1, ::-7, 1])
    assert np.allclose(np.linalg.norm(stack.light, axis=1), 1) and (stack.view == [0, 0, 1]).all()
    assert repr(stack) == "<Stack: 3 images of 30 x 40 (r, g, b), radiance from %s>" % path
    again = pickle.loads(pickle.dumps(stack))
    assert np.array_equal(again.values[1], values[1])
    texel = stack.texel(3, 4)
    assert np.allclose(texel.values, values[:, 3, 4]) and texel.quantity == "radiance"


def test_exr_channels_and_types(tmp_path):
    counts, depth = np.arange(12, dtype=np.uint32).reshape(3, 4), np.linspace(0, 1, 12, dtype=np.float32).reshape(3, 4)
    write_exr(tmp_path / "a.exr", {"hits": counts, "Z": depth}, window=([10, -20], [13, -18]))
    path = write_lp(tmp_path, "a.exr 0 0 1")
    with pytest.raises(brdffit.OptionError, match="a.exr: the image has no R, G, B; name the channels= .* of Z, hits"):
        brdffit.load_stack(path)
    stack = brdffit.load_stack(path, channels=["hits", "Z"], view=(0, 0.1, 1), quantity="brdf")
    assert stack.channels == ("hits", "Z") and np.array_equal(stack.values[0, 1:], np.stack([counts, depth], -1)[1:])
    assert (stack.view == [[0, 0.1, 1]]).all() and stack.quantity == "brdf"
    with pytest.raises(brdffit.OptionError, match="a.exr: the image has no channel 'G'; it has Z, hits"):
        brdffit.load_stack(path, channels=["G"])
    with pytest.raises(brdffit.OptionError, match="list of names"):
        brdffit.load_stack(path, channels="Z")
    write_exr(tmp_path / "a.exr", {"Y": depth})
    assert brdffit.load_stack(path).channels == ("Y",)


def test_exr_that_disagree(scene, tmp_path):
    path, values = scene
    narrow = {c: np.zeros((40, 29), np.float32) for c in "RGB"}
    write_exr(tmp_path / "c.exr", narrow)
    with pytest.raises(brdffit.DataError, match=r"c.exr: the image has 29 x 40 pixels, .*; .*a.exr has 30 x 40 pixels"):
        brdffit.load_stack(path)
    write_exr(tmp_path / "c.exr", {c: np.zeros((40, 30), np.float32) for c in "RGB"}, window=([1, 0], [30, 39]))
    with pytest.raises(brdffit.DataError, match="c.exr: the image has .* from column 1, line 0 on; .* from column 0"):
        brdffit.load_stack(path)
    write_exr(tmp_path / "c.exr", {c: np.zeros((40, 30), np.float32) for c in "RG"})
    with pytest.raises(brdffit.OptionError, match="c.exr: the image has no channel 'B'; it has G, R"):
        brdffit.load_stack(path)
    (tmp_path / "c.exr").write_bytes(b"not an image")
    with pytest.raises(brdffit.DataError, match="c.exr: this is not an OpenEXR image"):
        brdffit.load_stack(path)
    (tmp_path / "c.exr").unlink()
    with pytest.raises(brdffit.FileError, match="lights.lp: line 4: there is no image '.*c.exr'"):
        brdffit.load_stack(path)
    stack = brdffit.load_stack(path, images=[tmp_path / "a.exr"] * 3)
    assert np.array_equal(stack.values[2], values[0])
    with pytest.raises(brdffit.OptionError, match="2 images for 3 light positions"):
        brdffit.load_stack(path, images=[tmp_path / "a.exr"] * 2)
    stack = brdffit.load_stack(path, images=[tmp_path / "b 1.exr"] * 3)
    write_exr(tmp_path / "b 1.exr", narrow)
    with pytest.raises(brdffit.DataError, match="b 1.exr: the image has changed its size"):
        stack.values[1]


def test_exr_that_break_off(scene, tmp_path):
    path, _ = scene
    whole = (tmp_path / "c.exr").read_bytes()
    for length in (0, 3, 100, len(whole) // 2, len(whole) - 1):
        (tmp_path / "c.exr").write_bytes(whole[:length])
        with pytest.raises(brdffit.DataError, match="c.exr: "):
            np.asarray(brdffit.load_stack(path).values)


def test_other_images(tmp_path, monkeypatch):
    write_exr(tmp_path / "a.exr", {"Y": np.zeros((4, 4), np.float32)})
    with pytest.raises(brdffit.OptionError, match="one image: give the .lp file"):
        brdffit.load_stack(tmp_path / "a.exr")
    with pytest.raises(brdffit.DataError, match="images, not samples of one material: load_stack"):
        brdffit.Samples.from_file(tmp_path / "a.exr")
    path = write_lp(tmp_path, "a.exr 0 0 1")
    with pytest.raises(brdffit.DataError, match="lights.lp: this holds images"):
        brdffit.fit(path)
    with pytest.raises(brdffit.OptionError, match="names= and group= go with HDF5"):
        brdffit.load_stack(path, names={"values": "x"})
    write_exr(tmp_path / "a.exr", {"Y": np.zeros((4, 4), np.float32), "BY": np.zeros((4, 4), np.float32)})
    raw = bytearray((tmp_path / "a.exr").read_bytes())
    at = raw.index(b"BY\0") + 3 + 8  # after the name, the type and a flag: how many columns and rows share a pixel
    assert struct.unpack_from("<2i", raw, at) == (1, 1)
    struct.pack_into("<2i", raw, at, 2, 2)
    (tmp_path / "a.exr").write_bytes(raw)
    with pytest.raises(brdffit.UnsupportedError, match="a.exr: channel BY has fewer pixels"):
        brdffit.load_stack(path)
    monkeypatch.setitem(sys.modules, "OpenEXR", None)
    with pytest.raises(brdffit.UnsupportedError, match=r'pip install "brdffit\[exr\]"'):
        brdffit.load_stack(path)


def test_memory_is_that_of_the_part(tmp_path):
    rng = np.random.default_rng(5)
    image = rng.uniform(0, 1, (512, 512)).astype(np.float32)
    write_exr(tmp_path / "a.exr", dict.fromkeys("RGB", image), compression=OpenEXR.NO_COMPRESSION)
    path = write_lp(tmp_path, "\n".join("%d 0 0 1" % k for k in range(60)))
    stack = brdffit.load_stack(path, images=[tmp_path / "a.exr"] * 60)
    part = 60 * 8 * 512 * 3 * 4
    tracemalloc.start()
    got = stack.values[:, 100:108]
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert got.nbytes == part and stack.values.nbytes == 64 * part
    assert peak < 1.2 * part  # besides the part, one image's window
    assert np.array_equal(got[7, :, :, 2], image[100:108])


def test_texels_are_fitted(tmp_path):
    """Images rendered from a known model: each texel gives its roughness back."""
    light, _ = brdffit.protocol84()
    light = light[light[:, 2] > 0.3][::2]
    truth = brdffit.fit(brdffit.Samples.example(), lobes=1)
    radiance = truth.predict(light, [0, 0, 1], quantity="radiance").astype(np.float32)
    names = ["%02d.exr" % k for k in range(len(light))]
    for name, row in zip(names, radiance):
        write_exr(tmp_path / name, {c: np.full((2, 3), row[k]) for k, c in enumerate("RGB")})
    text = "%d\n" % len(light) + "".join("%s %r %r %r\n" % (n, *map(float, d * 5)) for n, d in zip(names, light))
    stack = brdffit.load_stack(write_lp(tmp_path, text))
    fit = brdffit.fit(stack.texel(1, 2), lobes=1, max_incidence=90)
    assert fit.certified and fit.sigma == pytest.approx(truth.sigma, rel=1e-4)
    assert exr.read_header(str(tmp_path / names[0])).size == (2, 3)
    maps = stack.fit_map(lobes=1, max_incidence=90)
    assert maps.shape == (2, 3) and maps.certified.all() and np.allclose(maps.sigma, truth.sigma, rtol=1e-4)


# ---- Maps ---------------------------------------------------------------------


@pytest.fixture(scope="module")
def texels():
    """20 x 6 texels of different metals under 40 lights, with normals, a mask, and one value that is not finite."""
    rng = np.random.default_rng(6)
    light, _ = brdffit.protocol84()
    light = light[light[:, 2] > 0.5][:40]
    base = brdffit.fit(brdffit.Samples.example(), lobes=1).predict(light, [0, 0, 1], quantity="radiance")
    values = base[:, None, None] * rng.uniform(0.5, 1.5, (len(light), 20, 6, 1))
    values[3, 17, 2, 1] = np.nan
    normal = np.concatenate([rng.uniform(-0.2, 0.2, (20, 6, 2)), np.ones((20, 6, 1))], -1)
    return values.astype(np.float32), light, rng.integers(0, 4, (20, 6)) > 0, normal


ARRAYS = ("sigma", "x", "y", "channel_scale", "e2", "lower_bound", "sum_of_squares", "status", "stop", "where", "boxes")


@pytest.mark.parametrize("turned", [False, True], ids=["", "normals"])
def test_bands_are_the_whole(texels, turned):
    values, light, mask, normal = texels
    normal = normal if turned else None
    stack = Stack(Known(values), light, np.array([0.0, 0, 1]), ("r", "g", "b"), mask=mask, normal=normal)
    want = brdffit.fit_map(values, light, mask=mask, normal=normal, quantity="radiance", lobes=1)
    assert {"certified", "masked", "bad_value"} == {name for name, n in want.counts.items() if n}
    for rows in (1, 7, 20, None):
        moments = []
        got = stack.fit_map(lobes=1, rows=rows, progress=moments.append)
        for name in ARRAYS:
            assert np.array_equal(getattr(got, name), getattr(want, name), equal_nan=name not in ("status", "stop")), name
        assert got.samples_skipped == want.samples_skipped and got.quantity == "radiance" and got.options == want.options
        assert {k: got.stats[k] for k in want.counts} == want.counts and got.stats["texels"] == 120 == moments[-1].total
        done = [moment.done for moment in moments]
        assert done == sorted(done) and done[-1] == 120
        with pytest.raises(ValueError):
            got.e2[0, 0] = 1


def test_bands_stop_and_fail(texels):
    values, light, mask, _ = texels
    read = []

    class Watched(Known):
        def _read(self, part):
            read.append(part[1].start)
            if part[1].start == 16:
                raise brdffit.DataError("broken", code="read", path="img")
            return super()._read(part)

    stack = Stack(Watched(values), light, np.array([0.0, 0, 1]), ("r", "g", "b"), file="stack")
    got = stack.fit_map(lobes=1, rows=4, progress=lambda moment: moment.done >= 30)
    assert read == [0, 4, 8] and (got.status[8:] == got.STATUS.index("not_reached")).all() and got.fitted[:4].all()
    assert np.isnan(got.e2[8:]).all() and got.counts["not_reached"] == got.stats["not_reached"] >= 72
    with pytest.raises(brdffit.DataError, match="img: broken"):
        stack.fit_map(lobes=1, rows=4)
    with pytest.raises(brdffit.BrdffitError) as caught:
        Stack(values, light, np.array([0.0, 0, 1]), ("r", "g", "b"), file="stack").fit_map(lobes=1, rows=4, errors="raise")
    assert caught.value.texel == (17, 2) and caught.value.sample == 3 and "stack" in str(caught.value)
    for wrong in (0, -1, 1.5, True):
        with pytest.raises(brdffit.OptionError, match="rows must be a whole number"):
            stack.fit_map(rows=wrong)


def test_fit_map_takes_lazy_values_and_writes_zarr(texels, tmp_path):
    pytest.importorskip("zarr")
    values, light, mask, normal = texels
    rows = []

    class Watched(Known):
        def _read(self, part):
            rows.append(part[1].stop - part[1].start)
            return super()._read(part)

    want = brdffit.fit_map(values, light, mask=mask, normal=normal, lobes=1)
    here = brdffit.fit_map(Watched(values), light, mask=mask, normal=normal, lobes=1, tile=(3, 6))
    assert max(rows) == 3 and sum(rows) == 20
    stack = Stack(Watched(values), light, np.array([0.0, 0, 1]), ("r", "g", "b"), quantity="brdf", mask=mask, normal=normal)
    stored = stack.fit_map(lobes=1, rows=3, output=tmp_path / "maps.zarr", client=False, threads=2).load()
    for name in ARRAYS:
        for got in (here, stored):
            assert np.array_equal(getattr(got, name), getattr(want, name), equal_nan=name not in ("status", "stop")), name
    with pytest.raises(brdffit.DataError, match="axis 0"):
        brdffit.fit_map(Watched(values), light, sample_axis=1, lobes=1)


def test_dask_takes_lazy_values(scene):
    array = pytest.importorskip("dask.array")
    path, values = scene
    stack = brdffit.load_stack(path)
    lazy = array.from_array(stack.values, chunks=(3, 16, 30, 3))
    assert np.array_equal(lazy[:, 5:33].compute(scheduler="threads"), values[:, 5:33])
