"""fit(), Fit, progress, errors. SPDX-License-Identifier: MIT"""
import copy
import dataclasses
import json
import os
import pickle
import shutil
import signal
import threading

import numpy as np
import pytest

import brdffit
import harness
import model

CASES = [("two_lobe_satin.csv", {"lobes": 2}), ("ggx_metal.csv", {"distribution": "ggx"}),
         ("matte.csv", {"distribution": "blinn-phong", "lobes": 2}), ("two_lobe_table.binary", {"lobes": 2})]


@pytest.mark.parametrize("name, options", CASES)
def test_the_same_line_as_the_command_line(instruments, name, options):
    arguments = [word for key, value in options.items() for word in ("--" + key, str(value))]
    theirs, = harness.fit(*arguments, instruments / name)
    fit = brdffit.fit(instruments / name, **options)
    ours = json.loads(fit.to_json())
    theirs.pop("seconds"), ours.pop("seconds")
    assert ours == theirs
    assert list(ours) == list(theirs)  # members in the same order, too
    model.check_line(ours, instruments / name)
    assert fit.certified and fit.lower_bound <= fit.e2 == fit.objective


def test_options_default_as_in_c():
    ours, theirs = brdffit.Options()._struct(), brdffit._ffi.library().options()
    for name, _ in ours._fields_:
        if name not in ("progress", "box"):
            assert getattr(ours, name) == getattr(theirs, name), name


def test_every_option_arrives():
    given = brdffit.Options(lobes=2, distribution="ward", norm="l1", engine="socp", normalise="none", sigma_range=(0.1, 2),
                            exponent_range=(3, 4), relative_gap=0.5, absolute_gap=0.25, sigma_resolution=0.125, box_budget=77,
                            max_incidence=45, socp_every_box=True, isa="base")._struct()
    assert [getattr(given, name) for name, _ in given._fields_][1:17] == [
        2, 3, 1, 1, 1, 1, 0.1, 2, 3, 4, 0.5, 0.25, 0.125, 77, 45, 1]


def test_reads_its_own_lines_and_so_does_the_command_line(instruments, tmp_path):
    path = instruments / "two_lobe_satin.csv"
    fit = brdffit.fit(path, lobes=2)
    again = brdffit.Fit.from_json(fit.to_json())
    assert again.to_json() == fit.to_json()
    (tmp_path / "fit.json").write_text(fit.to_json() + "\n")
    done = harness.run("eval", tmp_path / "fit.json", path)
    assert done.returncode == 0, done.stderr
    rows = [line.split(",") for line in done.stdout.splitlines() if not line.startswith("#")]
    fitted = np.array([[float(row[rows[0].index(k + "_fit")]) for k in "rgb"] for row in rows[1:]])
    assert np.array_equal(fitted, again.predict_samples(brdffit.Samples.from_csv(path)))


@pytest.mark.parametrize("change", [{"y": [[0.1]]}, {"y": [0.1, 0.2, 0.3]}, {"x": [1.0]}, {"sigma": [0.1, 0.2]}, {"lobes": 2},
                                    {"lobes": 3}, {"distribution": "phong"}, {"channels": ["r"]}], ids=str)
def test_fits_that_do_not_hold_together(change):
    """C would read past the end of what is too short."""
    fit = brdffit.fit(brdffit.Samples.example())
    with pytest.raises((brdffit.DataError, brdffit.OptionError)):
        brdffit.Fit.from_dict(fit.to_dict() | change)
    with pytest.raises((brdffit.DataError, brdffit.OptionError)):
        dataclasses.replace(fit, **change).predict([0, 0, 1], [0, 0, 1])


def test_a_name_that_is_not_utf8(instruments, tmp_path):
    """Nothing that is written holds its bytes as they are; the JSON does in hexadecimal, as of the command line."""
    name = b"odd\xff\xe2\x82.csv"
    path = os.path.join(tmp_path, os.fsdecode(name))
    shutil.copy(instruments / "matte.csv", path)
    fit = brdffit.fit(path)
    for text in (fit.to_json(), repr(fit), fit._repr_html_(), repr(brdffit.Samples.from_file(path))):
        assert "odd\ufffd\ufffd\ufffd.csv" in text and text.encode()
    (line,) = harness.fit(os.path.join(os.fsencode(tmp_path), name), cwd=tmp_path)
    assert bytes.fromhex(line["file_bytes"]).endswith(name)
    for text in (fit.to_json(), json.dumps(line)):
        again = brdffit.Fit.from_json(text)
        assert (again.file, again.to_dict()["file"], again.to_dict()["file_bytes"]) == (path, line["file"], line["file_bytes"])


@pytest.mark.parametrize("distribution", model.DISTRIBUTIONS)
def test_predict(distribution):
    fit = brdffit.fit(brdffit.Samples.example(), lobes=2, distribution=distribution)
    random = np.random.default_rng(3)
    light, view = random.standard_normal((2, 40, 3))
    light[:, 2], view[:, 2] = np.abs(light[:, 2]) + 0.1, np.abs(view[:, 2]) + 0.1
    l, v = (d / np.linalg.norm(d, axis=1, keepdims=True) for d in (light, view))
    a, b, c, nl, _ = model.directions_to_abc(l, v, distribution=distribution)
    expected = a[:, None] * fit.x
    for p in range(2):
        expected = expected + (b * model.shape(distribution, 1 / fit.sigma[p] ** 2, c))[:, None] * fit.y[:, p]
    assert np.allclose(fit.predict(light, view, quantity="radiance"), expected, rtol=1e-9, atol=1e-12)
    assert np.allclose(fit.predict(light, view), expected / nl[:, None], rtol=1e-9, atol=1e-12)
    # Any shape; one direction against many; another normal turns everything.
    assert np.array_equal(fit.predict(light.reshape(8, 5, 3), view.reshape(8, 5, 3)), fit.predict(light, view).reshape(8, 5, 3))
    assert fit.predict([0, 0, 2], view).shape == (40, 3)
    turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], float)
    assert np.allclose(fit.predict(light @ turn, view @ turn, normal=np.array([0, 0, 1.0]) @ turn), fit.predict(light, view),
                       rtol=1e-9)
    assert not fit.predict([0, 0, -1], view).any()


def test_a_fit_is_frozen_and_travels():
    fit = brdffit.fit(brdffit.Samples.example(), lobes=2)
    with pytest.raises(dataclasses.FrozenInstanceError):
        fit.e2 = 0
    with pytest.raises(ValueError):
        fit.sigma[0] = 1
    for again in (pickle.loads(pickle.dumps(fit)), copy.deepcopy(fit)):
        assert again.to_json() == fit.to_json() and not again.sigma.flags.writeable
    boxes = copy.deepcopy(brdffit.fit_boxes(brdffit.Samples.example())[1])
    samples = pickle.loads(pickle.dumps(brdffit.Samples.example()))
    assert not (boxes.lower_bound.flags.writeable or samples.values.flags.writeable)
    assert brdffit.fit(samples, lobes=2).to_dict()["x"] == fit.to_dict()["x"]


def test_what_people_read():
    fit = brdffit.fit(brdffit.Samples.example(), lobes=2)
    text = repr(fit)
    assert "0.11976493" in text and "Proven: no Beckmann fit with 2 lobes" in text and "40 lit from beyond 60°" in text
    assert max(map(len, text.splitlines()[1:])) <= 79
    html = dataclasses.replace(fit, file="<script>")._repr_html_()
    assert "<script>" not in html and "&lt;script&gt;" in html and html.count("<table>") == 2
    rough = brdffit.fit(brdffit.Samples.example(), lobes=2, box_budget=5)
    assert rough.status == "gap_open" and rough.stop == "budget" and "NOT proven" in repr(rough)
    assert rough.lower_bound <= fit.e2 <= rough.e2 * (1 + 1e-12)


@pytest.mark.parametrize("value, digits, up", [(0.99961, 2, True), (0.99961, 2, False), (123456.7, 3, True), (1e-300, 5, False)])
def test_claims_are_rounded_to_their_safe_side(value, digits, up):
    from brdffit._words import directed

    shown = float(directed(value, digits, up))
    assert shown >= value if up else shown <= value
    assert abs(shown - value) <= 10.0 ** (1 - digits) * abs(value)


@pytest.mark.parametrize("options, kind, code", [
    ({"lobes": 3}, brdffit.OptionError, "option"), ({"norm": "l7"}, brdffit.OptionError, "option"),
    ({"verify": "much"}, brdffit.OptionError, "option"), ({"verify": 1}, brdffit.OptionError, "option"),
    ({"sigma_range": (0, 1)}, brdffit.OptionError, "option"), ({"sigma_range": 3}, brdffit.OptionError, "option"),
    ({"relative_gap": float("nan")}, brdffit.OptionError, "option"), ({"relative_gap": "x"}, brdffit.OptionError, "option"),
    ({"box_budget": -1}, brdffit.OptionError, "option"), ({"box_budget": 2.5}, brdffit.OptionError, "option"),
    ({"lobes": 2**40}, brdffit.OptionError, "option")])
def test_bad_options(options, kind, code):
    with pytest.raises(kind) as caught:
        brdffit.fit(brdffit.Samples.example(), **options)
    assert caught.value.code == code and isinstance(caught.value, ValueError)


def test_errors_say_where(tmp_path):
    values = np.ones((2, 3))
    values[1, 2] = np.inf
    with pytest.raises(brdffit.DataError) as caught:
        brdffit.fit(brdffit.Samples.from_arrays([[0, 0, 1]] * 2, [[0, 0, 1]] * 2, values))
    error = caught.value
    assert (error.code, error.sample, error.channel, error.value) == ("value", 1, 2, np.inf)
    assert "sample 1, channel 2 (b)" in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error) and str(again) == str(error)
    file = tmp_path / "broken.csv"
    file.write_text("theta_i,theta_o,r\n0,10,1\n0,20,oops\n")
    with pytest.raises(brdffit.DataError) as caught:
        brdffit.fit(file)
    assert (caught.value.line, caught.value.column, caught.value.path) == (3, 3, str(file))
    with pytest.raises(OSError) as caught:
        brdffit.fit(tmp_path / "absent.csv")
    assert isinstance(caught.value, brdffit.FileError) and caught.value.code == "open"
    with pytest.raises(brdffit.DataError) as caught:
        brdffit.fit(brdffit.Samples.from_arrays([[0, 0, -1]], [[0, 0, 1]], [[1.0]]))
    assert caught.value.code == "no_samples"


def test_progress(hard):
    seen = []
    fit = brdffit.fit(hard, lobes=2, relative_gap=1e-8, box_budget=3000, progress=seen.append)
    assert [p.phase for p in seen[:2]] == ["reduced", "search"]
    assert len(seen) >= fit.boxes // 256
    assert all(a.lower_bound <= b.lower_bound and a.e2 >= b.e2 for a, b in zip(seen[1:], seen[2:]))
    stopped = brdffit.fit(hard, lobes=2, relative_gap=1e-8, progress=lambda now: now.boxes >= 512)
    assert stopped.stop == "cancelled" and stopped.status == "gap_open" and stopped.boxes < 1100


def test_an_exception_in_the_callback_ends_the_call(hard):
    def fail(now):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        brdffit.fit(hard, lobes=2, relative_gap=1e-8, progress=fail)


def test_interrupts_end_a_long_search(hard):
    class Alarm(Exception):
        pass

    def ring(number, frame):
        raise Alarm

    assert threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(Alarm):
            for _ in range(1000):  # whichever it is in
                brdffit.fit(hard, lobes=2, relative_gap=1e-12, absolute_gap=0, box_budget=10**7)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_a_bar(hard, capsys):
    brdffit.fit(hard, lobes=2, relative_gap=1e-8, box_budget=2000, progress=True)
    assert "box" in capsys.readouterr().err


def test_verify():
    samples = brdffit.Samples.example()
    try:
        fit = brdffit.fit(samples, verify=0.2)
    except brdffit.UnsupportedError:
        pytest.skip("this build has no ECOS")
    assert fit.verify["proven"] and fit.verify["level"] == fit.lower_bound * 0.8
    assert brdffit.fit(samples, norm="linf").engine is None


def test_threads_give_the_same_bits():
    samples = brdffit.Samples.example()
    expected = brdffit.fit(samples, lobes=2).to_dict()
    expected.pop("seconds")
    start, results = threading.Barrier(100), []

    def work():
        start.wait()
        line = brdffit.fit(samples, lobes=2).to_dict()
        line.pop("seconds")
        results.append(line == expected)

    threads = [threading.Thread(target=work) for _ in range(100)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [True] * 100


def test_memory_stays_flat():
    """A thousandth of a leak would show: 300 fits and 300 reads after 100 to warm up. The README has 1e5."""
    def resident():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * 4096

    samples = brdffit.Samples.example()
    workspace = brdffit._ffi.library().core.brdffit_workspace_size(
        len(samples), 3, brdffit.Options()._struct())
    for _ in range(100):
        brdffit.fit(samples), brdffit.Samples.example()
    before = resident()
    for _ in range(300):
        brdffit.fit(samples), brdffit.Samples.example()
    # One lost workspace's touched pages, or 300 lost tables of 300 x 10 doubles, would be more than 2 MB.
    assert workspace > 0 and resident() - before < 2**21


@pytest.mark.parametrize("options", [{"lobes": 2}, {"distribution": "lafortune", "lobes": 2}, {"norm": "linf"}], ids=str)
def test_a_fit_has_every_member(options):
    """fit() fills Fit's members in by itself: all of them, in shapes that from_dict gives, and none can be written to."""
    try:
        fit = brdffit.fit(brdffit.Samples.example(), **options)
    except brdffit.UnsupportedError:
        pytest.skip("this build has no ECOS")
    names = [field.name for field in dataclasses.fields(brdffit.Fit)]
    assert sorted(vars(fit)) == sorted(names)
    again = brdffit.Fit.from_json(fit.to_json())
    for name in names:
        ours, theirs = getattr(fit, name), getattr(again, name)
        assert type(ours) is type(theirs), name
        if isinstance(ours, np.ndarray):
            assert np.array_equal(ours, theirs) and ours.shape == theirs.shape and not ours.flags.writeable, name
    assert dataclasses.replace(fit) is not fit and dataclasses.replace(fit).to_json() == fit.to_json()


@pytest.mark.parametrize("wrong", ["bar", 3, [print]])
def test_progress_is_no_other_thing(wrong):
    samples = brdffit.Samples.example()
    with pytest.raises(brdffit.OptionError, match="progress must be"):
        brdffit.fit(samples, progress=wrong)
    with pytest.raises(brdffit.OptionError, match="progress must be"):
        brdffit.fit_map(samples.values[:, None], samples.light, samples.view, progress=wrong)
