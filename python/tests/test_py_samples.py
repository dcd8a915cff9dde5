"""Samples, MERL tables, many fits. SPDX-License-Identifier: MIT"""
import gc
import gzip
import pickle

import numpy as np
import pytest

import brdffit
import harness
import model
from brdffit.readers import native


def test_the_shipped_example_is_the_goniometers(instruments):
    from places import SOURCES

    assert (instruments / "two_lobe_satin.csv").read_bytes() == (SOURCES / "brdffit" / "two_lobe_satin.csv").read_bytes()


def test_csv(instruments):
    path = instruments / "two_lobe_satin.csv"
    samples = brdffit.Samples.from_csv(path)
    names, rows = model.read_text(path)
    assert np.array_equal(samples.values, rows[:, 4:]) and samples.channels == ("r", "g", "b")
    assert np.allclose(samples.light, model.unit(rows[:, 0], rows[:, 1]), atol=1e-15)
    assert np.allclose(samples.view, model.unit(rows[:, 2], rows[:, 3]), atol=1e-15)
    assert samples.quantity == "brdf" and samples.format == "csv" and len(samples.lines) == len(samples) == len(rows)
    assert brdffit.Samples.from_csv(path, quantity="radiance").quantity == "radiance"
    with pytest.raises(ValueError):
        samples.values[0, 0] = 1


def test_arrays_outlive_their_table():
    values = brdffit.Samples.example().values  # the Samples itself is gone
    copy = values.copy()
    for _ in range(50):
        brdffit.Samples.example()
    gc.collect()
    assert np.array_equal(values, copy)
    assert np.array_equal(pickle.loads(pickle.dumps(brdffit.Samples.example())).values, copy)


def test_arrays_and_files_give_the_same_fit():
    file = brdffit.Samples.example()
    arrays = brdffit.Samples.from_arrays(2 * file.light, file.view.tolist(), np.asfortranarray(file.values), normal=[0, 0, 3])
    a, b = brdffit.fit(file, lobes=2), brdffit.fit(arrays, lobes=2)
    assert np.allclose(a.sigma, b.sigma, rtol=1e-9) and np.isclose(a.e2, b.e2, rtol=1e-9)
    l, v = file.light, file.view
    a, b, c, nl, nv = model.directions_to_abc(l, v)
    used = nl >= 0.5 - 1e-9
    coefficients = brdffit.Samples.from_coefficients(a[used], b[used], c[used], (file.values * nl[:, None])[used])
    assert np.allclose(brdffit.fit(coefficients, lobes=2).sigma, brdffit.fit(file, lobes=2).sigma, rtol=1e-6)
    half = (l + v) / np.linalg.norm(l + v, axis=1, keepdims=True)
    angles = brdffit.Samples.from_angles(nl, nv, c, np.sum(v * half, 1), file.values)
    assert np.allclose(brdffit.fit(angles, lobes=2).sigma, brdffit.fit(file, lobes=2).sigma, rtol=1e-6)
    one = brdffit.Samples.from_arrays(l, v, file.values[:, 0], weights=np.ones(len(l)))
    assert one.channels == ("channel1",) and brdffit.fit(one).x.shape == (1,)


def test_angles_that_do_not_belong_together():
    """Angles for cosines, half angles for their tangents: whatever was mixed up is said, not fitted."""
    file = brdffit.Samples.example()
    half = (file.light + file.view) / np.linalg.norm(file.light + file.view, axis=1, keepdims=True)
    nl, nv, vh = file.light[:, 2], file.view[:, 2], np.sum(file.view * half, 1)
    tan2 = 1 / half[:, 2] ** 2 - 1
    assert len(brdffit.Samples.from_angles(nl, nv, tan2, vh, file.values)) == len(file)
    for wrong in ((nl, nv, np.sqrt(tan2), vh), (nl, nv, vh, tan2), (np.arccos(nl), np.arccos(nv), tan2, vh),
                  (nl, nv, tan2, np.arccos(vh))):
        with pytest.raises(brdffit.DataError, match="any two directions"):
            brdffit.Samples.from_angles(*wrong, file.values)


def test_notes_and_reading(tmp_path):
    path = tmp_path / "paint.csv"
    path.write_text("alpha;Viewing zenith;value;note\n" + "".join(
        "%d;%d;%s;a\n" % (t, t + 5, "0,%d" % (30 - t)) for t in range(20)))
    with pytest.raises(brdffit.DataError, match="theta_i"):
        brdffit.Samples.from_csv(path)
    samples = brdffit.Samples.from_csv(path, columns={"theta_i": "alpha"}, missing=0.12, saturated=0.3)
    assert any("decimal comma" in note for note in samples.notes) and any("note is left out" in note for note in samples.notes)
    assert (samples.dropped["absent"], samples.dropped["saturated"]) == (1, 1)
    fit = brdffit.fit(samples)
    assert fit.notes == samples.notes and fit.reading == {"column": "theta_i=alpha", "missing": "0.12", "saturated": 0.3}
    assert brdffit.Fit.from_json(fit.to_json()).reading == fit.reading
    path.write_text("theta_i,theta_o,r\n0,0,abc\n")
    with pytest.raises(brdffit.DataError, match="not a number: 'abc'"):
        brdffit.Samples.from_csv(path)
    assert "azimuth" in brdffit.column_words() and "phi" in brdffit.column_words()["azimuth"]


@pytest.mark.parametrize("arguments", [
    ([[0, 0, 1]], [[0, 0, 1]], [[1.0], [2.0]]), ([[0, 1]], [[0, 0, 1]], [[1.0]]), ([[0, 0, 1]], [[0, 0, 1]], [["a"]]),
    ([[0, 0, 1]], [[0, 0, 1]], [[[1.0]]])])
def test_arrays_that_do_not_fit_together(arguments):
    with pytest.raises(brdffit.DataError):
        brdffit.Samples.from_arrays(*arguments)


def test_masks_are_not_dropped():
    """Of a masked array the data would be fitted, masked ones included."""
    light, view = brdffit.protocol84()
    values = np.full((84, 3), 0.5)

    def hidden(array):
        return np.ma.masked_array(array, np.arange(array.size).reshape(array.shape) == 5)

    for arguments in ((hidden(light), view, values), (light, hidden(view), values), (light, view, hidden(values))):
        with pytest.raises(brdffit.DataError, match="masked entries"):
            brdffit.Samples.from_arrays(*arguments)
    with pytest.raises(brdffit.DataError, match="weights is an array with masked"):
        brdffit.Samples.from_arrays(light, view, values, weights=hidden(np.ones(84)))
    whole = brdffit.Samples.from_arrays(light, view, np.ma.masked_array(values))  # nothing is masked
    assert np.array_equal(whole.values, values)
    with pytest.raises(brdffit.DataError, match="mask is an array with masked"):
        brdffit.fit_map(values[:, None], light, view, mask=np.ma.masked_array([1], [True]))


@pytest.mark.parametrize("bins", ["edge", "centre"])
def test_merl(instruments, tmp_path, bins):
    path = instruments / "two_lobe_table.binary"
    table = brdffit.load_merl(path, bins=bins)
    light, view, values = model.read_merl(path, bins)
    every = brdffit.Samples.from_merl(path, bins=bins)
    assert np.count_nonzero(~np.isnan(table.values[..., 0])) == len(values)
    assert sum(every.dropped.values()) + len(every) == table.values[..., 0].size
    seen = (light[:, 2] > 1e-6) & (view[:, 2] > 1e-6)
    if bins == "centre":  # with edges, rounding decides
        found = table.lookup(light[seen], view[seen])
        assert np.allclose(found, values[seen], rtol=1e-12)
    # The C library looks up the paper's directions alike.
    at = brdffit.protocol84()
    c = brdffit.Samples.from_merl(path, samples="84", bins=bins)
    mine = table.lookup(*at)
    mine = mine[~np.isnan(mine).any(1)]
    assert np.allclose(mine, c.values, rtol=1e-12)
    by_hand = brdffit.Samples.from_merl(path, samples=at, bins=bins)
    assert np.array_equal(by_hand.values, c.values)
    (tmp_path / "t.binary.gz").write_bytes(gzip.compress(path.read_bytes()))
    assert np.array_equal(brdffit.load_merl(tmp_path / "t.binary.gz", bins=bins).values, table.values, equal_nan=True)
    for light in ([0, 0, 0], [np.nan, 0, 1], [np.inf, 0, 1]):
        found = table.lookup([light, [0, 0, 1]], [0, 0, 1])
        assert np.isnan(found[0]).all() and np.array_equal(found[1], table.lookup([0, 0, 1], [0, 0, 1]))
    packed = bytearray(gzip.compress(path.read_bytes()))
    packed[12:40] = b"\xff" * 28
    (tmp_path / "damaged.binary.gz").write_bytes(packed)
    with pytest.raises(brdffit.FileError):
        brdffit.load_merl(tmp_path / "damaged.binary.gz")
    (tmp_path / "short.binary").write_bytes(path.read_bytes()[:-1])
    with pytest.raises(brdffit.DataError):
        brdffit.load_merl(tmp_path / "short.binary")


def test_many(instruments, tmp_path):
    items = [instruments / name for name in ("two_lobe_satin.csv", "ggx_metal.csv", "matte.csv")] * 4
    items.append(brdffit.Samples.example())
    fits = brdffit.fit_many(items, lobes=2, threads=4)
    for item, many in zip(items, fits):
        one, many = brdffit.fit(item, lobes=2).to_dict(), many.to_dict()
        one.pop("seconds"), many.pop("seconds")
        assert one == many
    broken = tmp_path / "absent.csv"
    with pytest.raises(brdffit.FileError):
        brdffit.fit_many([*items, broken])
    out = brdffit.fit_many([broken, items[0]], errors="return")
    assert isinstance(out[0], brdffit.FileError) and isinstance(out[1], brdffit.Fit)
    with pytest.raises(brdffit.OptionError):
        brdffit.fit_many([], lobes="two")


def test_reads_lines_of_directions(instruments, tmp_path):
    """A fit of looked-up directions carries them, and the command line's eval takes it."""
    at = tuple(d[:40] for d in brdffit.protocol84())
    path = instruments / "two_lobe_table.binary"
    fit = brdffit.fit(brdffit.Samples.from_merl(path, samples=at))
    (tmp_path / "fit.json").write_text(fit.to_json() + "\n")
    done = harness.run("eval", tmp_path / "fit.json", path)
    assert done.returncode == 0, done.stderr


def test_a_format_that_only_the_library_knows(tmp_path, monkeypatch):
    """A library newer than this package: its word is missing here, the samples are not."""
    (tmp_path / "s.csv").write_text("a,b,c,v\n0.3,0.2,0.1,1\n0.2,0.3,0.4,2\n")
    monkeypatch.setattr(native.structs, "FORMAT", ("auto",))
    members = native.read(tmp_path / "s.csv")
    assert members["format"] == "unknown" and members["merl_bins"] is None and members["values"].tolist() == [[1], [2]]
    with pytest.raises(brdffit.OptionError, match="format must be one of 'auto', not 'ply'"):
        native.read(tmp_path / "s.csv", "ply")
