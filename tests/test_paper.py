"""The paper's experiments (tools/paper): their arithmetic, on the goniometer's data and on rows made up here.

What needs build/peers (`make peers`: levmar, Ceres) skips where that was not built. SPDX-License-Identifier: MIT
"""
import csv
import json
import math
import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = (ROOT / os.environ.get("BRDFFIT_BUILD", "build")).resolve()
PEERS = BUILD / "peers"
sys.path.insert(0, str(ROOT / "tools" / "paper"))

import arithmetic  # noqa: E402
import paper  # noqa: E402
import programs  # noqa: E402
import results  # noqa: E402


@pytest.fixture(scope="module")
def instruments(tmp_path_factory):
    for part in ("goniometer", "brdffit", "tests/ref/brute"):
        if not (BUILD / part).exists():
            pytest.fail(f"{BUILD / part} is not built: run make check, or set BRDFFIT_BUILD", pytrace=False)
    folder = tmp_path_factory.mktemp("goniometer")
    subprocess.run([BUILD / "goniometer", folder], check=True, capture_output=True)
    return folder


@pytest.fixture(scope="module")
def truth(instruments):
    files = json.loads((instruments / "truth.json").read_text())["files"]
    return {pathlib.Path(file["file"]).stem: file for file in files}


@pytest.fixture(scope="module")
def fitted(instruments, tmp_path_factory):
    """Samples and certified fits of the goniometer's CSV files."""
    runner = programs.Programs(BUILD, tmp_path_factory.mktemp("paper"))
    samples = runner.prepare(instruments)
    return runner, samples, {p: runner.fit(samples, p, "beckmann", paper.GAP) for p in (1, 2)}


def row(material, lobes, first, last, e2, **more):
    return {"material": material, "lobes": str(lobes), "first": str(first), "last": str(last), "best_e2": str(e2),
            "seconds": "0.5", "reached": "1"} | more


def fit(e2, lower_bound=None, sum_of_squares=1.0, **more):
    return {"e2": e2, "lower_bound": e2 if lower_bound is None else lower_bound, "sum_of_squares": sum_of_squares} | more


# ---- Numbers ---------------------------------------------------------------------------------------------------------


def test_d12_is_of_rms_errors():
    assert arithmetic.d12(fit(4.0, sum_of_squares=10.0), fit(1.0, sum_of_squares=10.0)) == 1.0
    assert arithmetic.d12(fit(1.0), fit(1.0)) == 0.0


def test_d12_of_exact_fits():
    assert arithmetic.d12(fit(1e-14), fit(1e-20)) == 0.0
    assert arithmetic.d12(fit(0.5), fit(0.0)) == math.inf


def test_starts_are_chained_without_holes_and_counted_once():
    peer = arithmetic.Peer([row("m", 1, 0, 1, 9.0), row("m", 1, 1, 10, 5.0), row("m", 1, 1, 2, 7.0),
                            row("m", 1, 20, 50, 1.0)])
    assert peer.best("m", 1, 1) == 9.0
    assert peer.best("m", 1, 2) == 7.0
    assert peer.best("m", 1, 10) == 5.0
    assert peer.best("m", 1, 50) == 5.0  # starts 10 to 20 are missing, so 20 to 50 do not count
    assert peer.total("seconds", ["m"], 1, 10) == 1.0
    assert peer.complete("m", 1, 10) and not peer.complete("m", 1, 50)
    assert peer.milestones(["m"], 1, 100) == [1, 2, 10]


def test_engines_are_compared_relatively_but_for_exact_fits():
    assert arithmetic.relative_difference(fit(1.0), fit(1.5)) == 0.5
    assert arithmetic.relative_difference(fit(1e-14), fit(1e-20)) == 0.0


def test_supervision_takes_the_better_one_lobe_answer():
    peer = arithmetic.Peer([row("m", 1, 0, 10, 2.0), row("m", 2, 0, 10, 3.0)])
    assert peer.best("m", 2, 10) == 2.0
    assert peer.best("m", 2, 10, supervised=False) == 3.0
    assert arithmetic.count_at_optimum(peer, {"m": fit(2.0)}, ["m"], 2, 10) == 1
    assert arithmetic.count_at_optimum(peer, {"m": fit(2.0)}, ["m"], 2, 10, supervised=False) == 0


def test_optimum_is_relative_but_for_exact_fits():
    assert arithmetic.at_optimum(1.0 + 0.9e-6, 1.0, 2.0)
    assert not arithmetic.at_optimum(1.0 + 1.1e-6, 1.0, 2.0)
    assert arithmetic.at_optimum(1e-13, 1e-30, 1.0)
    assert arithmetic.excess(1e-13, 1e-30, 1.0) == 0.0
    assert arithmetic.excess(1.5, 1.0, 1.0) == 0.5


def test_an_answer_below_the_bound_is_found():
    peer = arithmetic.Peer([row("m", 1, 0, 1, 0.9)])
    assert len(arithmetic.below_bound([peer], {1: {"m": fit(1.0, 0.99)}})) == 1
    assert arithmetic.below_bound([peer], {1: {"m": fit(1.0, 0.9)}}) == []


def test_brute_force_can_disagree():
    ours = fit(1.0, 0.999, sigma=[0.1])
    same = arithmetic.compare_brute(ours, {"e2": 1.1, "sigma": [0.1004]}, 2.0 ** -11)
    assert same["same"] and not same["above"] and not same["disproved"] and math.isclose(same["ratio"], 0.1)
    assert not arithmetic.compare_brute(ours, {"e2": 1.1, "sigma": [0.101]}, 2.0 ** -11)["same"]
    assert arithmetic.compare_brute(ours, {"e2": 0.9995, "sigma": [0.1]}, 2.0 ** -11)["above"]
    assert arithmetic.compare_brute(ours, {"e2": 0.99, "sigma": [0.1]}, 2.0 ** -11)["disproved"]


def test_plots_show_five_different_materials():
    one = {f"m{i}": fit(1.0 + i, rms_total=0.1 * i, x=[9.0 - i], channel_scale=[1.0], sum_of_squares=20.0)
           for i in range(7)}
    two = {m: fit(one[m]["e2"] / (4 if m == "m2" else 1), sum_of_squares=20.0) for m in one}
    assert [m for m, _ in arithmetic.choose_plots(one, two)] == ["m0", "m3", "m6", "m5", "m2"]


def test_panels_split_views_and_planes():
    rows = [{"theta_i": t, "phi_i": p, "theta_o": v, "phi_o": 0.0} for v in (0.0, 20.0) for t in (0.0, 30.0)
            for p in (0.0, 90.0, 180.0)]
    views = arithmetic.panels(rows)
    assert list(views) == [0.0, 20.0]
    inside, across = views[20.0]
    assert sorted({angle for angle, _ in inside}) == [-30.0, 0.0, 30.0]
    assert [angle for angle, _ in across if angle > 0] == [30.0]


def test_results_replace_their_own_section_only(tmp_path):
    path = tmp_path / "RESULTS.md"
    path.write_text("# Results\n\nmine\n")
    for text in ("first", "second"):
        results.put(path, f"<b>\n{text}\n<e>\n", "<b>", "<e>")
    path.write_text(path.read_text() + "\nlast\n")
    results.put(path, "<b>\nthird\n<e>\n", "<b>", "<e>")
    assert path.read_text() == "# Results\n\nmine\n\n<b>\nthird\n<e>\n\nlast\n"


# ---- Goniometer ------------------------------------------------------------------------------------------------------


def test_two_lobe_truth_gains_and_one_lobe_truth_does_not(fitted):
    _, samples, fits = fitted
    gain = {m: arithmetic.d12(fits[1][m], fits[2][m]) for m in samples}
    assert gain["two_lobe_exact"] == math.inf
    assert gain["two_lobe_satin"] > 0.1
    assert all(value >= 0.0 for value in gain.values())
    assert arithmetic.count_better(gain.values()) >= 2


def test_merl_tables_become_84_samples_of_the_truth(fitted, truth):
    _, samples, _ = fitted
    path = samples["two_lobe_table"]
    table = json.loads(path.with_suffix(".json").read_text())  # the look-up's fit: a cell below the horizon is masked
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == table["samples_used"]
    assert len(rows) + sum(table["samples_skipped"].values()) == 84
    flat = next(r for r in rows if float(r["theta_i"]) == 0 and float(r["theta_o"]) == 0)
    material = truth["two_lobe_table"]
    for k, channel in enumerate("rgb"):  # at the mirror direction f_r is x/pi + sum y / (pi sigma^2)
        peak = sum(y / s ** 2 for y, s in zip(material["y"][k], material["sigma"]))
        assert math.isclose(float(flat[channel]), (material["x"][k] + peak) / math.pi, rel_tol=1e-9)


def test_brute_force_agrees_with_the_certified_fit(fitted):
    runner, samples, fits = fitted
    some = {m: samples[m] for m in ("two_lobe_satin", "ggx_metal")}
    for _ in range(2):  # the second time from the cache
        answers = runner.brute(some, 1, 9)
        for m in some:
            judged = arithmetic.compare_brute(fits[1][m], answers[m], 2.0 ** -9)
            assert judged["same"] and not judged["above"] and not judged["disproved"], m
    assert len([line for line in (runner.out / "brute.jsonl").read_text().splitlines() if line]) == len(some)


def test_reprojection_rows_are_the_fits_residuals(fitted):
    runner, samples, fits = fitted
    e = object.__new__(paper.Experiments)
    e.programs, e.out, e.samples = runner, runner.out, samples
    e.fits = {("beckmann", p): fits[p] for p in (1, 2)}
    rows, channels = e.reprojection_rows("ggx_metal")
    used = [r for r in rows if r["theta_i"] <= 60.0 + 1e-9]
    for lobes, name in ((1, "one"), (2, "two")):
        e2 = sum((r[f"{c}_{name}"] - r[f"{c}_measured"]) ** 2 for r in used for c in channels)
        assert math.isclose(e2, fits[lobes]["ggx_metal"]["e2"], rel_tol=1e-9)


def test_unusable_folders_say_why(tmp_path):
    with pytest.raises(programs.Failure, match="holds no"):
        programs.find_files(tmp_path)
    (tmp_path / "a.csv").write_text("")
    (tmp_path / "a.binary.gz").write_text("")
    with pytest.raises(programs.Failure, match="more than one file for a"):
        programs.find_files(tmp_path)
    with pytest.raises(programs.Failure, match="not a directory"):
        programs.find_files(tmp_path / "absent")


# ---- Local solvers ---------------------------------------------------------------------------------------------------

needs_peers = pytest.mark.skipif(not PEERS.exists(), reason="build/peers is not there (make peers)")


def peers(*arguments):
    done = subprocess.run([PEERS, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@needs_peers
@pytest.mark.parametrize("chart", ["plain", "log", "squares"])
def test_peers_find_the_truth_from_nearby(instruments, truth, chart):
    sigma = truth["two_lobe_exact"]["sigma"]
    start = f"{0.9 * sigma[0]},{1.1 * sigma[1]}"
    for solver in peers("--list").splitlines():
        line = peers("--peer", solver.split(",")[0], "--chart", chart, "--lobes", 2, "--from", start, "--quiet",
                     instruments / "two_lobe_exact.csv").strip().split(",")
        assert float(line[-4]) < 1e-15, line
        assert [float(s) for s in line[-3:-1]] == pytest.approx(sigma, rel=1e-7), line


@needs_peers
def test_peers_resume_where_they_stopped(instruments, tmp_path):
    file = instruments / "two_lobe_satin.csv"
    common = ["--lobes", 1, "--chart", "squares", "--quiet"]

    def rows(path):
        with open(path, newline="") as text:
            return [(r["first"], r["last"], r["best_e2"], r["reached"]) for r in csv.DictReader(text) if r["end"] == "."]

    peers(*common, "--starts", 5, "--cache", tmp_path / "resumed.csv", file)
    with open(tmp_path / "resumed.csv", "a") as cut:
        cut.write("two_lobe_satin,01234567")  # as an interruption leaves it
    peers(*common, "--starts", 20, "--cache", tmp_path / "resumed.csv", file)
    peers(*common, "--starts", 20, "--cache", tmp_path / "fresh.csv", file)
    assert rows(tmp_path / "resumed.csv") == rows(tmp_path / "fresh.csv")
    assert [last for _, last, _, _ in rows(tmp_path / "fresh.csv")] == ["1", "2", "5", "10", "20"]


@needs_peers
def test_peers_and_fit_agree_on_the_optimum(fitted):
    runner, samples, fits = fitted
    some = {m: samples[m] for m in ("two_lobe_satin", "ggx_metal")}
    settings = ("best", "levmar", "squares", "nnls", "log")
    runner.peers(some, 20, settings, 1)
    peer = arithmetic.Peer(runner.peer_rows(some, settings, 1))
    assert arithmetic.below_bound([peer], fits) == []
    for m in some:
        assert arithmetic.at_optimum(peer.best(m, 1, 20), fits[1][m]["e2"], fits[1][m]["sum_of_squares"]), m
