"""Damaged input in Python: a fit, a file, a store. What is wrong is a BrdffitError, always, and said without steering the
terminal; maps of other values are not gone on with.

SPDX-License-Identifier: MIT
"""
import contextlib
import json
import random

import numpy as np
import pytest

import brdffit
import harness
import stacks
from brdffit.errors import shown

JUNK = [None, 0, -1, 1.5, 1e300, "x", "", [], [[]], [None], {}, {"a": 1}, True, [1, 2], [[1, 2], [3]], ["a"], 10**400,
        "beckmann", ["beckmann"], float("nan")]


@pytest.fixture(scope="module")
def lines(tmp_path_factory):
    """Fits of all kinds, as JSON has them."""
    folder = tmp_path_factory.mktemp("fits")
    stack, light, view = stacks.make(1, 1)
    stacks.texel_csv(folder / "one.csv", light, view, stack[:, 0, 0])
    kinds = [[], ["--lobes", "beckmann,ggx"], ["--fresnel", "schlick"], ["--diffuse", "burley", "--distribution", "blinn-phong"],
             ["--physical"], ["--norm", "linf"] if harness.has_ecos() else []]
    return [json.loads(harness.run("fit", "--json", "--gap", "0.3", *kind, "one.csv", cwd=folder).stdout) for kind in kinds]


def mutated(rng, line):
    """A copy with one to three members gone, grown or replaced, at any depth."""
    line = json.loads(json.dumps(line))
    for _ in range(rng.choice([1, 1, 2, 3])):
        holder, key = line, rng.choice(sorted(line))
        while isinstance(holder[key], (list, dict)) and holder[key] and rng.random() < 0.5:
            holder = holder[key]
            key = rng.choice(sorted(holder)) if isinstance(holder, dict) else rng.randrange(len(holder))
        junk = json.loads(json.dumps(rng.choice(JUNK)))
        if isinstance(holder, dict) and rng.random() < 0.3:
            del holder[key]
        elif isinstance(holder, list) and rng.random() < 0.3:
            holder.append(junk)
        else:
            holder[key] = junk
        if not line:
            break
    return line


def test_damaged_fits(lines):
    """DataError, or a fit that can be shown, evaluated and written."""
    rng = random.Random(5)
    light, view = brdffit.protocol84()
    refused = 0
    for _ in range(1200):
        text = json.dumps(mutated(rng, rng.choice(lines)))
        try:
            fit = brdffit.Fit.from_json(text)
        except brdffit.DataError as error:
            refused += str(error) != ""
            continue
        assert repr(fit) and fit._repr_html_() and brdffit.Fit.from_json(fit.to_json())
        with contextlib.suppress(brdffit.BrdffitError):  # a model that is none: the library says why
            assert fit.predict(light, view).shape == (84, len(fit.channels))
    assert 400 < refused < 1200


@pytest.mark.parametrize("text", ["", "{", "null", "[" * 100000, '{"schema":"brdffit.fit/1"' + ',"a":[' * 5000, "\0", "{}",
                                  '{"schema":"brdffit.fit/1","status":"error","error":7}'])
def test_no_fits(text):
    with pytest.raises(brdffit.DataError):
        brdffit.Fit.from_json(text)


def test_characters_that_are_cut(lines):
    rng = random.Random(6)
    text = json.dumps(lines[0])
    for _ in range(300):
        at = rng.randrange(len(text))
        damaged = text[:at] + rng.choice(["", chr(rng.randrange(1, 0x300)), "\ud800", '"', "}"]) + text[at + rng.randrange(3):]
        with contextlib.suppress(brdffit.DataError):
            brdffit.Fit.from_json(damaged)


def test_nothing_steers_the_terminal(tmp_path):
    evil = "e\x1b[31m\x9b\u202e\x07"
    path = tmp_path / "evil.csv"
    path.write_text("theta_i,theta_o,%s\n1,2,word\n" % evil)
    with pytest.raises(brdffit.DataError) as caught:
        brdffit.Samples.from_csv(path)
    assert "\x1b" not in str(caught.value) and "\u202e" not in str(caught.value) and "word" not in evil
    with pytest.raises(brdffit.FileError) as caught:
        brdffit.Samples.from_csv(tmp_path / (evil + "\udcff"))
    assert str(caught.value).isprintable()
    assert shown("a\tb\nc\x7f") == "a?b\nc?"


def test_limits(tmp_path):
    import gzip

    path = tmp_path / "big.csv.gz"
    path.write_bytes(gzip.compress(b"theta_i,theta_o,r\n" + b"1,2,3\n" * 50000))
    assert len(brdffit.Samples.from_csv(path)) == 50000
    with pytest.raises(brdffit.DataError, match="max_bytes"):
        brdffit.Samples.from_csv(path, max_bytes=10000)
    with pytest.raises(brdffit.OptionError, match="max_bytes"):
        brdffit.Samples.from_csv(path, max_bytes=-1)


def test_resume_looks_at_every_texel(tmp_path):
    """A stack that differs in texels that nobody marked is not taken for the one before."""
    pytest.importorskip("zarr")
    stack, light, view = stacks.make(8, 8)
    stack = stack.astype("f4")
    first = brdffit.fit_map(stack, light, view, output=tmp_path / "m.zarr", tile=16)
    again = brdffit.fit_map(stack, light, view, output=tmp_path / "m.zarr", tile=16)
    assert np.array_equal(first["sigma"][...], again["sigma"][...])
    stack[:, 1, 2] *= 1.5
    with pytest.raises(brdffit.DataError, match="maps of other values.*overwrite=True"):
        brdffit.fit_map(stack, light, view, output=tmp_path / "m.zarr", tile=16)
    brdffit.fit_map(stack, light, view, output=tmp_path / "m.zarr", tile=16, overwrite=True)


# ---- Files that Python reads: every mutant is read, or refused as what it is ---------------------------------------


def mutants(rng, raw, count):
    for _ in range(count):
        data = bytearray(raw)
        for _ in range(rng.choice([1, 1, 2, 4])):
            at = rng.randrange(len(data)) if rng.random() < 0.5 else rng.randrange(min(len(data), 200))
            kind = rng.randrange(5)
            if kind == 0:
                data[at] ^= 1 << rng.randrange(8)
            elif kind == 1:
                data[at:at + 4] = rng.choice([b"\xff" * 4, b"\0" * 4, b"\xff\xff\xff\x7f", b"\x01\0\0\0"])
            elif kind == 2:
                del data[at:at + rng.randrange(1, 9)]
            elif kind == 3:
                data[at:at] = rng.choice([b"nan", b"1e999", b"\n", b",", b'"', b"\xff\xfe", data[at:at + 16]])
            else:
                del data[at:]
            if not data:
                data = bytearray(b"x")
        yield bytes(data)


def survive(path, raw, read, count, seed):
    rng, read_well = random.Random(seed), 0
    for data in mutants(rng, raw, count):
        path.write_bytes(data)
        try:
            read(path)
            read_well += 1
        except brdffit.BrdffitError as error:
            assert str(error)
    return read_well


def test_lp(tmp_path):
    raw = b"3\nimages/left 01.exr -0.71 0.02 0.70\n1 images/right.exr 0.64 -0.10 0.76\n\"top.exr\" 0.01 0.72 0.69\n"
    assert survive(tmp_path / "m.lp", raw, lambda path: brdffit.load_lp(path).directions, 600, 1) > 50


def test_rgl(tmp_path):
    import rgl_files

    path = tmp_path / "m.bsdf"
    raw = rgl_files.tensor_bytes(rgl_files.material())
    survive(path, raw, lambda path: brdffit.Samples.from_rgl(path), 150, 2)


def test_hdf5(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "m.h5"
    stack, light, view = stacks.make(1, 1)
    with h5py.File(path, "w") as file:
        file["values"], file["light"], file["view"] = stack[:, 0, 0], light, view
        file["values"].attrs["channels"] = "r,g,b"
    survive(path, path.read_bytes(), lambda path: brdffit.Samples.from_hdf5(path), 300, 3)


def test_zarr_metadata(tmp_path):
    zarr = pytest.importorskip("zarr")
    stack, light, view = stacks.make(1, 1)
    group = zarr.open_group(tmp_path / "m.zarr", mode="w")
    for name, values in (("values", stack[:, 0, 0]), ("light", light), ("view", view)):
        group.create_array(name, data=values)
    for name in ("zarr.json", "values/zarr.json"):
        path = tmp_path / "m.zarr" / name
        raw = path.read_bytes()
        survive(path, raw, lambda _: brdffit.Samples.from_zarr(tmp_path / "m.zarr"), 150, 4)
        path.write_bytes(raw)


def test_exr(tmp_path):
    openexr = pytest.importorskip("OpenEXR")
    image = np.random.default_rng(1).random((6, 5, 3)).astype("f4")
    path = tmp_path / "m.exr"
    openexr.File({"compression": openexr.ZIP_COMPRESSION, "type": openexr.scanlineimage}, {"RGB": image}).write(str(path))
    raw = path.read_bytes()
    (tmp_path / "m.lp").write_text("m.exr 0 0 1\n")

    def read(_):
        return np.asarray(brdffit.load_stack(tmp_path / "m.lp").values)

    assert np.array_equal(read(path)[0], image)
    survive(path, raw, read, 120, 5)
