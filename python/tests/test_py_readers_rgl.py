"""RGL's .bsdf files: values against Mitsuba's, the format's every bound, tables, fits. SPDX-License-Identifier: MIT"""
import csv
import importlib.util
import os
import pathlib
import struct

import numpy as np
import pytest

import brdffit
import rgl_files
import rgl_reference
from brdffit.merl import cell_directions
from brdffit.report import main as report
from places import ROOT
from rgl_files import directions, material, tensor_bytes

DATA = pathlib.Path(os.environ.get("BRDFFIT_DATA", ROOT.parent / "shared" / "data")).resolve()
REFERENCE = pathlib.Path(__file__).parent / "data" / "rgl_mitsuba.csv"


def load(tmp_path, fields, name="made_up.bsdf"):
    path = tmp_path / name
    path.write_bytes(fields if isinstance(fields, bytes) else tensor_bytes(fields))
    return brdffit.load_rgl(path)


def compare(got, want, light, kind):
    """Within what single precision does to a value: of 2,000 samples, the median differs by 3e-7 of its largest channel, the
    worst, whose half vector is on a steep flank, by 1.4e-5."""
    if kind == "turned":
        # Mitsuba folds these azimuths of light into a part of the circle, powitacq does not: where both agree.
        here = (light[:, 0] < 0) & (light[:, 1] < 0)
        got, want = got[here], want[here]
    assert len(got) > 10
    assert (np.abs(got - want) < 3e-5 * np.abs(want).max(1, keepdims=True)).all()
    assert np.median(np.abs(got - want) / np.abs(want).max(1, keepdims=True)) < 1e-6


def choice(kind):
    return (0, 1, 2, 4) if kind == "spectra" else None


@pytest.mark.parametrize("kind", rgl_files.KINDS)
def test_values_are_mitsubas(tmp_path, kind):
    with open(REFERENCE) as file:
        rows = [row for row in csv.DictReader(line for line in file if line[0] != "#") if row["kind"] == kind]
    want = np.array([[float(row["v%d" % k]) for k in range(4) if row["v%d" % k]] for row in rows])
    light, view = directions(rgl_reference.COUNT, 1), directions(rgl_reference.COUNT, 2)
    m = load(tmp_path, material(kind))
    compare(m.eval(light, view, clip=False, channels=choice(kind)) * view[:, 2:], want, light, kind)


@pytest.mark.parametrize("kind", rgl_files.KINDS)
def test_values_are_those_of_the_mitsuba_that_is_installed(tmp_path, kind):
    mi = pytest.importorskip("mitsuba")
    light, view = directions(500, 3), directions(500, 4)
    m = load(tmp_path, material(kind, seed=11))
    want = rgl_reference.values(mi, kind, tmp_path / "made_up.bsdf", light, view)
    compare(m.eval(light, view, clip=False, channels=choice(kind)) * view[:, 2:], want, light, kind)


def real_files():
    files = sorted((DATA / "rgl").glob("*_rgb.bsdf"))
    if not files:
        pytest.skip(f"no RGL files in {DATA}: set BRDFFIT_DATA")
    return files


def test_real_materials_as_another_decoder_reads_them():
    decoder = DATA.parent / "tools" / "rgl_decode.py"
    files = real_files()
    if not decoder.exists():
        pytest.skip(f"no {decoder}")
    spec = importlib.util.spec_from_file_location("rgl_decode", decoder)
    other = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(other)
    light, view = directions(1500, 5), directions(1500, 6)
    light /= np.linalg.norm(light, axis=1, keepdims=True)
    view /= np.linalg.norm(view, axis=1, keepdims=True)
    for file in files:
        want = other.RGL(file).fr(light, view)
        # Both in double precision: only rounding, which the warp may magnify.
        assert np.abs(brdffit.load_rgl(file).eval(light, view) - want).max() < 1e-9 * want.max(), file


def test_real_measurements_are_where_the_interpolant_passes_through():
    for file in real_files():
        m = brdffit.load_rgl(file)
        s = m.samples()
        entries, repeated = m._values[..., 0].size, s.dropped["repeated"]
        assert len(s) + repeated + s.dropped["masked"] == entries and len(s) + repeated > 0.74 * entries
        back = m.lookup(s.light, s.view)
        known = ~np.isnan(back).any(1)  # on a blind cell's very edge, rounding decides
        assert known.mean() > 0.99
        difference = np.abs(back - s.values)[known].max(1) / (np.abs(s.values[known]).max(1) + 1e-6 * s.values.max())
        # In the plane of the seam and in the mirror direction a sample is the mean of several, up to 20 % apart.
        alone = np.abs(s.view[known, 1]) > 1e-3
        assert np.median(difference) < 1e-12 and difference.max() < 0.2, file
        assert alone.mean() > 0.8 and difference[alone].max() < 1e-3, file


def test_measurements_are_the_files_own(tmp_path):
    fields = material("plain")
    m = load(tmp_path, fields)
    s = m.samples(clip=False)
    values, theta = fields["rgb"][0], np.degrees(fields["theta_i"].astype(float))
    angle = np.degrees(np.arccos(s.light[:, 2]))
    assert s.format == "rgl" and s.quantity == "brdf" and s.channels == ("r", "g", "b")
    assert set(np.round(angle, 3)) == set(np.round(theta, 3)) and (s.light[:, 1] == 0).all() and (s.view[:, 2] > 0).all()
    assert len(s) + s.dropped["repeated"] + s.dropped["masked"] == values[:, 0].size
    # Without the factor D/(4 sigma), f_r cos is the table's entry, and each seen entry appears once, or in a mean of those
    # whose directions are the same: the seven mirror directions and the seam.
    flat = values.transpose(0, 2, 3, 1).reshape(-1, 3)
    product = s.values * s.view[:, 2:]
    distance = np.abs(flat[:, None, :] - product[None, :, :]).max(2)
    alone = distance.min(0) < 1e-6
    assert len(set(distance.argmin(0)[alone])) == alone.sum() and 0 < len(s) - alone.sum() <= s.dropped["repeated"]
    # And there the interpolant gives the entry back, except on the rim, where directions coincide.
    inner = np.zeros(values[:, 0].shape, bool)
    inner[:, 1:-1, 1:-1] = True
    inner = inner.ravel()[distance.argmin(0)] & alone
    back = m.eval(s.light, s.view, clip=False)
    assert inner.sum() > 200
    assert (np.abs(back - s.values)[inner] < 1e-6 * s.values.max(1)[inner, None]).all()


def test_turning_both_directions_changes_nothing(tmp_path):
    m = load(tmp_path, material())
    light, view = directions(300, 7), directions(300, 8)
    turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    a, b = m.eval(light, view), m.eval(light @ turn.T * 3, view @ turn.T * 0.1)
    assert np.allclose(a, b, rtol=1e-9, atol=0)
    # Half vectors at the normal have no azimuth: the answer may not depend on rounding.
    mirror = np.array([[np.cos(p) * 0.6, np.sin(p) * 0.6, 0.8] for p in np.linspace(0, 6, 50)])
    value = m.eval(mirror, mirror * [-1, -1, 1])
    assert np.allclose(value, value[0], rtol=1e-6)


def test_what_was_not_measured(tmp_path):
    m = load(tmp_path, material())
    light, view = directions(400, 9), directions(400, 10)
    seen, values, looked = m.measured(light, view), m.eval(light, view), m.lookup(light, view)
    assert 0.7 < seen.mean() < 1 and (np.isnan(looked).all(1) == ~seen).all() and (looked[seen] == values[seen]).all()
    s = m.samples((light, view))
    assert len(s) == seen.sum() and s.dropped["masked"] == (~seen).sum() and (s.light == light[seen]).all()
    # Changing what is blind changes no value that counts as measured.
    fields = material()
    blind = np.broadcast_to((fields["luminance"] == 0)[:, :, None], fields["rgb"].shape)
    fields["rgb"] = np.where(blind, np.float32(7), fields["rgb"])
    other = load(tmp_path, fields).eval(light, view)
    assert (other[seen] == values[seen]).all() and (other[~seen] != values[~seen]).any(1).all()
    down = np.array([[0.6, 0, -0.8], [0.6, 0, 0.8], [1, 0, 0], [0, 0, 0]])
    assert (m.eval(down, down[[1, 0, 1, 1]]) == 0).all() and not m.measured(down, down[[1, 0, 1, 1]]).any()
    with pytest.raises(brdffit.DataError, match="none of these directions"):
        m.samples((down[:1], down[1:2]))


def test_light_along_the_surface_was_not_measured(tmp_path):
    fields = material()
    fields["theta_i"][-1] = np.radians(89.99)
    free = load(tmp_path, fields)
    for name in ("rgb", "luminance", "vndf"):
        fields[name] = fields[name].copy()
        fields[name][:, -1] = fields[name][:, -2]
    m = load(tmp_path, fields)
    light, view = directions(400, 9), directions(400, 10)
    beyond = np.arccos(light[:, 2]) > fields["theta_i"][-2]
    assert 20 < beyond.sum() and not m.measured(light, view)[beyond].any() and free.measured(light, view)[beyond].mean() > 0.5
    assert (m.measured(light, view)[~beyond] == free.measured(light, view)[~beyond]).all()
    assert m.samples().light[:, 2].min() > 0.1 and free.samples().light[:, 2].min() < 1e-3
    for file in real_files():
        real = brdffit.load_rgl(file)
        assert np.degrees(np.arccos(real.samples().light[:, 2].min())) < 82, file


def test_shapes_channels_and_clipping(tmp_path):
    m = load(tmp_path, material())
    light, view = directions(12, 1).reshape(3, 4, 3), directions(4, 2)
    assert m.eval(light, view).shape == (3, 4, 3) and m.measured(light, view).shape == (3, 4)
    assert m.eval(light[0, 0], view[0]).shape == (3,) and m.eval(light[:0], view).shape == (0, 4, 3)
    assert (m.eval(light, view, channels=["b", 0]) == m.eval(light, view)[..., [2, 0]]).all()
    many = directions(70000, 3)  # more than one part
    assert (m.eval(many, many[::-1])[69000:] == m.eval(many[69000:], many[:1000][::-1])).all()
    with pytest.raises(brdffit.DataError, match=r"shapes \(3, 4, 3\) and \(5, 3\) do not go together"):
        m.eval(light, directions(5, 2))
    s = m.samples(clip=False)
    assert s.values.min() < 0 and m.samples().values.min() == 0
    for wrong in (["x"], [3], [-1]):
        with pytest.raises(brdffit.OptionError, match="there is no channel .*; the file has r, g, b"):
            m.eval(light, view, channels=wrong)
    with pytest.raises(brdffit.OptionError, match="'measured', '84'"):
        m.samples("table")
    spectral = load(tmp_path, material("spectra"))
    assert spectral.channels == ("400nm", "450nm", "530nm", "600nm", "700nm") and spectral.wavelengths[2] == 530
    assert spectral.samples("84", channels=["600nm"]).channels == ("600nm",)
    with pytest.raises(brdffit.OptionError, match="choose three of the file's 5"):
        spectral.to_merl()
    with pytest.raises(brdffit.UnsupportedError, match="two azimuths"):
        load(tmp_path, material("turned")).samples()


def test_merl_layout(tmp_path):
    m = load(tmp_path, material())
    table = m.to_merl(tmp_path / "made_up.binary", bins="centre")
    for row in (0, 37, 80):
        light, view = cell_directions((90, 90, 180), "centre", row)
        here, there = m.lookup(light, view), m.lookup(view, light)
        known = ~np.isnan(here).any(-1) & ~np.isnan(there).any(-1)
        assert known.any() and np.allclose(table.values[row][known], 0.5 * (here + there)[known], rtol=1e-12)
        either = ~np.isnan(here).any(-1) | ~np.isnan(there).any(-1)
        assert (np.isnan(table.values[row]).any(-1) == ~either).all()
        # The cell is where MERL's own look-up finds these directions.
        up = (light[..., 2] > 0) & (view[..., 2] > 0)
        assert np.array_equal(table.lookup(light, view)[up], table.values[row][up], equal_nan=True)
    again = brdffit.load_merl(table.file, bins="centre")
    assert np.allclose(again.values, table.values, rtol=1e-15, equal_nan=True)
    s = table.samples()  # the C library's reader
    there = table.values[~np.isnan(table.values[..., 0])]
    assert len(s) == len(there) and np.allclose(np.sort(s.values, 0), np.sort(there, 0), rtol=1e-15, atol=0)
    with pytest.raises(brdffit.FileError, match="cannot be written"):
        table.save(tmp_path / "nowhere" / "a.binary")


def test_fit_and_report(tmp_path, capsys):
    load(tmp_path, material())
    path = tmp_path / "made_up.bsdf"
    fit = brdffit.fit(path, lobes=1)
    assert fit.certified and fit.format == "rgl" and fit.weighting == "solid-angle"
    repeated = brdffit.Samples.from_file(path).dropped["repeated"]
    assert repeated > 0 and fit.samples_used + sum(fit.samples_skipped.values()) + repeated == 700
    assert brdffit.Fit.from_json(fit.to_json()).sigma == fit.sigma
    assert "masked (not measured)" in str(fit)
    assert report([str(path), "-o", str(tmp_path / "pages"), "--lobes", "1"]) == 0
    page = (tmp_path / "pages" / "made_up.html").read_text()
    for words in ("Rendered from the measured table", "Rendered from the fit", "Fit less measured", "samples of 3 channels"):
        assert words in page
    spectral = tmp_path / "spectral.bsdf"
    spectral.write_bytes(tensor_bytes(material("spectra")))
    assert report([str(spectral), "-o", str(tmp_path / "pages"), "--lobes", "1", "--merl-samples", "table"]) == 0
    assert "Rendered from the measured table" in (tmp_path / "pages" / "spectral.html").read_text()
    (tmp_path / "broken.bsdf").write_bytes(path.read_bytes()[:5000])
    assert report([str(tmp_path / "broken.bsdf"), "-o", str(tmp_path / "pages")]) == 3
    assert "broken.bsdf: field 'vndf'" in capsys.readouterr().err


# ---- The container ------------------------------------------------------------


def change(**fields):
    out = material()
    for name, value in fields.items():
        if value is None:
            del out[name]
        else:
            out[name] = value
    return out


def poked(name, index, value):
    fields = material()
    fields[name] = fields[name].copy()
    fields[name][index] = value
    return fields


MISSING = [(change(**{name: None}), "there is no field %r; the fields are" % name)
           for name in ("description", "phi_i", "theta_i", "ndf", "sigma", "vndf", "luminance", "rgb", "jacobian")]
F = np.float32
WRONG = MISSING + [
    (change(theta_i=np.zeros(7)), "field 'theta_i' must be float32 with 1 dimensions, not float64, 7"),
    (change(theta_i=np.zeros(7, F)), "'theta_i' must hold ascending angles"),
    (change(theta_i=np.zeros(0, F)), "'theta_i' must hold ascending angles"),
    (poked("theta_i", 3, np.nan), "'theta_i' must hold ascending angles"),
    (poked("theta_i", 6, 2), "'theta_i' must hold ascending angles"),
    (change(theta_i=np.array([0, 1], F)), "field 'vndf' has shape"),
    (poked("vndf", (0, 1, 2, 3), -1), "'vndf' has negative values"),
    (poked("vndf", (0, 1, 2, 3), np.inf), "'vndf' has values that are not finite"),
    (poked("vndf", (0, 1), 0), "'vndf' is 0 throughout"),
    (poked("sigma", (0, 1), 0), "'sigma' has values that are not above 0"),
    (poked("rgb", (0, 1, 2, 3), np.nan), "'rgb' has values that are not finite"),
    (poked("ndf", (0, 1), -1), "'ndf' has negative values"),
    (change(ndf=np.ones((1, 40), F)), "'ndf' has shape"),
    (change(ndf=np.ones(40, F)), "must be float32 with 2 dimensions, not float32, 40"),
    (change(luminance=np.ones((1, 7, 9, 10), F)), "'rgb' and 'luminance' differ"),
    (change(rgb=np.ones((1, 7, 2, 10, 10), F)), "'rgb' has shape"),
    (change(jacobian=np.ones(2, np.uint8)), "'jacobian' must hold 1 value, not 2"),
    (change(rgb=None, spectra=np.ones((1, 7, 4, 10, 10), F)), "there is no field 'wavelengths'"),
    (change(rgb=None, spectra=np.ones((1, 7, 2, 10, 10), F), wavelengths=np.array([5, 4], F)), "ascending wavelengths"),
]


@pytest.mark.parametrize("case", range(len(WRONG)))
def test_wrong_content(tmp_path, case):
    fields, words = WRONG[case]
    with pytest.raises(brdffit.DataError) as caught:
        load(tmp_path, fields)
    assert words in str(caught.value) and str(tmp_path / "made_up.bsdf") in str(caught.value)


def test_anisotropic_is_refused(tmp_path):
    fields = material()
    fields["phi_i"] = np.array([0, 1, 2], np.float32)
    with pytest.raises(brdffit.UnsupportedError, match=r"made_up.bsdf: this material is anisotropic \(measured at 3 azimuths"):
        load(tmp_path, fields)
    with pytest.raises(brdffit.UnsupportedError, match="anisotropic"):
        brdffit.Samples.from_file(tmp_path / "made_up.bsdf")


def header(name=b"a", dimensions=1, kind=10, offset=64, shape=(2,), count=1, version=b"\1\0", magic=b"tensor_file\0", after=64):
    raw = magic + version + struct.pack("<I", count) + struct.pack("<H", len(name)) + name
    return raw + struct.pack("<HBQ", dimensions, kind, offset) + struct.pack("<%dQ" % len(shape), *shape) + b"\0" * after


@pytest.mark.parametrize("raw, words", [
    (b"", "the file ends at byte 0, inside its first bytes"),
    (b"tensor_fil", "the file ends at byte 10, inside its first bytes"),
    (header(magic=b"tensor_fool\0"), "this is not a tensor file"),
    (header(version=b"\2\0"), "version 2.0 of tensor files is not known"),
    (header()[:16], "the file ends at byte 16, inside the number of fields"),
    (header(kind=0), "field 'a' has the unknown type 0"),
    (header(kind=12), "field 'a' has the unknown type 12"),
    (header(dimensions=33), "field 'a' has 33 dimensions, more than 32"),
    (header(shape=(2 ** 63,)), "field 'a' (9223372036854775808) needs"),
    (header(dimensions=3, shape=(2 ** 40, 2 ** 40, 0)), "field 'a' (1099511627776 x 1099511627776 x 0) needs 0 bytes"),
    (header(offset=2 ** 64 - 1), "needs 8 bytes from byte 18446744073709551615 on; the file has"),
    (header(offset=10), "field 'a' begins at byte 10, inside the header"),
    (header(name=b"\xff"), "the name of the field at byte 18 is not UTF-8"),
    (header(count=2 ** 32 - 1, offset=40, shape=(0,), after=0), "the file ends at byte 40, inside the field at byte 40"),
    (header(count=2, after=0) + header(after=99)[18:], "there are two fields 'a'"),
    (header(), "there is no field 'description'; the fields are a"),
])
def test_wrong_containers(tmp_path, raw, words):
    with pytest.raises(brdffit.DataError) as caught:
        load(tmp_path, raw)
    assert words in str(caught.value)


def use(path):
    """Everything that looks at the values; only the package's own errors may come of a broken file."""
    try:
        m = brdffit.load_rgl(path)
        light, view = directions(20, 1), directions(20, 2)
        assert not np.isnan(m.eval(light, view)).any()
        m.samples()
        return True
    except brdffit.BrdffitError as error:
        assert str(path) in str(error)
        return False


def test_truncated_and_flipped(tmp_path):
    whole = tensor_bytes(material())
    path = tmp_path / "broken.bsdf"
    table = 18 + sum(13 + len(name) + 8 * value.ndim for name, value in material().items())
    rng = np.random.default_rng(3)
    for length in [*range(0, table, 3), *rng.integers(table, len(whole) - 1, 60)]:
        path.write_bytes(whole[:length])
        assert not use(path), length
    survived = 0
    for trial in range(700):
        broken = bytearray(whole)
        # The table three times as often as the data.
        for at in rng.integers(0, table if trial % 4 else len(whole), 1 + trial % 3):
            broken[at] ^= 1 << int(rng.integers(8))
        path.write_bytes(broken)
        survived += use(path)
    assert 0 < survived < 700
    assert not use(tmp_path / "absent.bsdf")
    with pytest.raises(brdffit.FileError, match="absent.bsdf: no such file"):
        brdffit.Samples.from_file(tmp_path / "absent.bsdf")
