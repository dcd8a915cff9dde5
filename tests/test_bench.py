"""`make bench` (tools/bench): the arithmetic of its report, and what its programs print. No times are judged.

What needs build/curves or build/kernel (`make bench-programs`: levmar, Ceres, NLopt) skips where that was not built.
SPDX-License-Identifier: MIT
"""
import csv
import ctypes
import math
import os
import pathlib
import random
import subprocess
import sys
import types

import numpy
import pytest
from scipy import optimize

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = (ROOT / os.environ.get("BRDFFIT_BUILD", "build")).resolve()
HARD = ROOT / "tests" / "data" / "hard"
sys.path.insert(0, str(ROOT / "tools" / "bench"))

import bench_arithmetic as a  # noqa: E402
import bench_programs as programs  # noqa: E402
import bench_text  # noqa: E402
import scipy_peers  # noqa: E402

SANITIZED = "asan" in BUILD.name  # shadow memory counts there

needs_curves = pytest.mark.skipif(not (BUILD / "curves").exists(), reason="build/curves is not there (make bench-programs)")


def run(program, *arguments, code=0):
    done = subprocess.run([BUILD / program, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stderr
    return done.stdout


def row(method, knob, e2, file="f", lobes=1, seconds=1.0, bound=0.0, certified=0, work=1.0, name="s"):
    return {"method": method, "knob": str(knob), "set": name, "file": file, "data": "0", "lobes": str(lobes),
            "seconds": str(seconds), "search": str(0.5 * seconds), "e2": repr(e2), "lower_bound": repr(bound),
            "certified": str(certified), "work": str(work), "nodes": "0", "sum_of_squares": "10"}


def proof(e2, **more):
    return row("moment", 1e-12, e2, bound=e2, certified=1, **more)


# ---- Arithmetic ------------------------------------------------------------------------------------------------------


def test_optimum_is_the_certified_row_of_the_smallest_gap():
    rows = [row("moment", 1e-3, 1.1, certified=1), row("moment", 1e-9, 1.0, certified=1), row("moment", 1e-12, 0.9),
            row("grid", 1e-15, 0.5, certified=1)]
    assert a.optima(rows)["s", "f", "1"]["e2"] == "1.0"


def test_error_is_of_the_root():
    assert a.excess(4.0, 1.0) == 1.0
    assert a.excess(0.99, 1.0) == 0.0
    assert a.excess(1e-14, 1e-30, rounding=1e-13) == 0.0
    assert a.excess(1.0, 0.0) == math.inf
    assert a.excess(math.inf, 1.0) == math.inf


def test_curves_take_only_knobs_that_every_file_has():
    rows = [proof(1.0), proof(1.0, file="g")]
    best = a.optima(rows)
    rows += [row("grid", 0.5, 4.0, seconds=2.0), row("grid", 0.5, 1.0, file="g", seconds=4.0), row("grid", 0.25, 1.0)]
    points = a.curves(rows, best)["s", "1", "grid"]
    assert points == [a.Point(0.5, 3.0, 0.5, 1.0, 0.5, 2)]
    assert a.curves(rows, best)["all", "1", "grid"] == points


def test_points_run_in_time_and_the_cheapest_is_found():
    best = a.optima([proof(1.0)])
    points = a.curve([row("x", 1, 1.0, seconds=5.0), row("x", 2, 9.0, seconds=1.0)], best, 1)
    assert [point.seconds for point in points] == [1.0, 5.0]
    assert a.cheapest(points).knob == 1.0
    assert a.cheapest(points[:1]) is None


def test_an_answer_below_the_bound_is_found():
    best = a.optima([proof(1.0)])
    assert a.contradictions([row("x", 1, 1.0 - 1e-11)], best)
    assert not a.contradictions([row("x", 1, 1.0 - 1e-13), row("x", 1, 1.0)], best)


def test_ratios_are_file_by_file_and_starts_are_means():
    rows = [row("levmar", 1, 1.0, seconds=9.0), row("levmar", 10, 1.0, seconds=20.0),
            row("levmar", 10, 1.0, file="g", seconds=50.0)]
    starts = a.start_seconds(rows, "levmar", 1)
    assert starts == {("s", "f", "1"): 2.0, ("s", "g", "1"): 5.0}
    assert a.ratios(starts, {("s", "f", "1"): 0.5, ("s", "h", "1"): 1.0}) == [4.0]


def test_growth_is_an_exponent():
    assert math.isclose(a.slope([(1, 3.0), (10, 300.0), (100, 30000.0)]), 2.0)
    assert a.slope([(1, 3.0)]) is None


def test_the_paper_pairs_count_what_was_cut_short():
    rows = [row("moment", 0.1, 1.0, work=10.0, seconds=1.0, certified=1),
            row("socp-gap", 0.1, 1.0, work=5000.0, seconds=100.0)]
    assert bench_text.paper_pairs(types.SimpleNamespace(paper=rows), 1, "socp-gap") == [(0.1, 0, 1, 500.0, 100.0)]


def test_annotations_of_callgrind_are_read():
    text = """--------
Ir
--------
12,000 (100.0%)  PROGRAM TOTALS
8,000 (66.67%)  src/bound_moment_two.c:brdffit_bound_moment_two [/x/bench_fit]
2,000 (16.67%)  /a/b/src/moments.c:brdffit_moments_node'2 [/x/bench_fit]
3,000 (25.00%)  src/moments.c:brdffit_moments_node [/x/bench_fit]
9,000 (75.00%)  src/fit.c:brdffit_fit [/x/bench_fit]
"""
    counts = programs.parse_annotation(text)
    assert counts["brdffit_moments_node"] == 3000
    found = programs.instructions_of("reduction 1 ms; 50 boxes, 10 nodes", counts, 2, 2)
    assert found == {"node": 300.0, "box": 100.0, "fit": 4500.0, "boxes": 25.0, "nodes": 5.0}
    assert programs.instructions_of("5 boxes, 1 nodes", {}, 1, 1) is None


def test_the_cache_knows_key_and_bytes(tmp_path):
    data, made = tmp_path / "data.csv", []

    def make():
        made.append(1)
        return [row("grid", 1, 1.0)]

    data.write_text("1")
    for key, runs in (("k", 1), ("k", 1), ("other", 2)):
        assert programs.Cache(tmp_path / "cache.csv", key).get(data, make)[0]["e2"] == "1.0"
        assert len(made) == runs
    with open(tmp_path / "cache.csv", "a", encoding="utf-8") as cut:
        cut.write("k,01")  # as an interruption leaves it
    data.write_text("2")
    programs.Cache(tmp_path / "cache.csv", "k").get(data, make)
    assert len(made) == 3


def test_units_and_errors_are_written_short():
    assert [bench_text.seconds(v) for v in (2.0, 1.5e-3, 9.87e-6, 3e-10)] == ["2 s", "1.5 ms", "9.87 µs", "0.3 ns"]
    assert bench_text.error(1e-13) == "≤ 1e-12" and bench_text.error(2.34e-3) == "2.3e-3"
    assert bench_text.knob("grid", 2.0 ** -11) == "step 2^-11" and bench_text.knob("moment", 1e-3) == "gap 1e-3"


# ---- Programs ----------------------------------------------------------------------------------------------------------


def test_families_are_the_same_from_the_same_seed(tmp_path):
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        run("families", tmp_path / name, "--seed", seed, "--members", 2)
    files = sorted(p.relative_to(tmp_path / "a") for p in (tmp_path / "a").rglob("*.csv"))
    assert [str(f) for f in files] == [f"{family}/0{i}.csv" for family in ("narrow", "near", "single") for i in (1, 2)]
    for file in files:
        text = [(tmp_path / name / file).read_text() for name in "abc"]
        assert text[0] == text[1] != text[2]
        assert len(text[0].splitlines()) == 85
    assert "usage" in subprocess.run([BUILD / "families"], capture_output=True, text=True, check=False).stderr


def test_scaling_prints_one_row_with_its_own_peak():
    ballast = bytearray(b"x" * 50_000_000)  # this process's own peak must not be in it
    texts = [run("scaling", "--samples", n, "--channels", 2, "--lobes", 1, "--repeat", 1) for n in (100, 20000)]
    small, large = (list(csv.DictReader(text.splitlines())) for text in texts)
    for rows, n in ((small, 100), (large, 20000)):
        assert len(rows) == 1 and int(rows[0]["distinct_c"]) == n and rows[0]["certified"] == "1"
        assert 0.0 < float(rows[0]["search"]) <= float(rows[0]["seconds"])
    assert int(large[0]["peak_kib"]) > int(large[0]["data_kib"]) > int(small[0]["data_kib"])
    if not SANITIZED:
        assert int(large[0]["peak_kib"]) < len(ballast) / 1024


def test_the_peak_of_a_program_is_its_own():
    assert 0 < int(run("scaling", "--peak", BUILD / "scaling", "--samples", 100, "--repeat", 1))
    assert "failed" in subprocess.run([BUILD / "scaling", "--peak", "/nonexistent"], capture_output=True, text=True,
                                      check=False).stderr


@pytest.fixture(scope="module")
def hard_rows():
    text = run("curves", "--set", "hard", "--starts", 2, "--evaluations", 50, "--grid", "6,4", "--width", "3,2", "--repeat", 1,
               HARD / "two.csv", HARD / "one.csv")
    return list(csv.DictReader(text.splitlines()))


@needs_curves
def test_every_method_prints_rows_for_both_lobe_counts(hard_rows):
    methods = [line.split(",")[1] for line in run("curves", "--list").splitlines() if line.startswith("method") and
               not line.endswith("variant")]
    for method in methods:
        for lobes in "12":
            knobs = [float(r["knob"]) for r in hard_rows if r["method"] == method and r["lobes"] == lobes and r["file"] == "two"]
            assert knobs and len(set(knobs)) == len(knobs), method
    assert list(hard_rows[0]) == programs.COLUMNS


@needs_curves
def test_no_method_is_below_the_bound_and_the_known_optimum_comes_out(hard_rows):
    best = a.optima(hard_rows)
    assert len(best) == 4 and not a.contradictions(hard_rows, best)
    for (file, lobes), e2 in {("two", "1"): 0.2257618848, ("two", "2"): 0.0024511502, ("one", "1"): 0.004602608774,
                              ("one", "2"): 0.0043487938}.items():  # tests/data/hard/README.md
        assert math.isclose(float(best["hard", file, lobes]["e2"]), e2, rel_tol=1e-7)


@needs_curves
def test_the_reduced_objective_is_the_residuals(tmp_path):
    if not (BUILD / "libcurves_reduced.so").exists():
        pytest.skip("build/libcurves_reduced.so is not there (make bench-programs)")
    draw = random.Random(1)
    run("families", tmp_path, "--members", 1)
    for path in (HARD / "mis.csv", HARD / "one.csv", tmp_path / "near" / "01.csv"):
        for lobes in (1, 2):
            problem = scipy_peers.Reduced(BUILD / "libcurves_reduced.so", path, lobes)
            total = problem.judge([math.log(1e-3)] * 2)
            for _ in range(100):
                u = [draw.uniform(scipy_peers.LOW, scipy_peers.HIGH) for _ in range(lobes)]
                if lobes == 2 and draw.random() < 0.3:
                    u[1] = u[0] + draw.uniform(-1, 1) * 10.0 ** draw.uniform(-6, -1)
                # 1e-11: rounding of sums over 84 samples, beside E2 of one dead lobe
                assert abs(problem.value(u) - problem.judge(u)) <= 1e-11 * max(total, 1.0), (path, u)
            problem.close()


@needs_curves
def test_the_gradient_is_that_of_the_objective():
    if not (BUILD / "libcurves_reduced.so").exists():
        pytest.skip("build/libcurves_reduced.so is not there (make bench-programs)")
    problem, step = scipy_peers.Reduced(BUILD / "libcurves_reduced.so", HARD / "mis.csv", 2), 1e-5
    for u in ([-4.0, -1.5], [-2.5, -1.0], [-3.0, 0.5]):
        _, slope = problem.value_and_gradient(u)
        for j in (0, 1):
            ends = [problem.value([v + sign * step * (i == j) for i, v in enumerate(u)]) for sign in (1, -1)]
            # central difference: step^2 times a third derivative of a few, and rounding over step
            assert math.isclose(slope[j], (ends[0] - ends[1]) / (2 * step), rel_tol=1e-5, abs_tol=1e-8)
    problem.close()


# ---- Variable projection against derivatives of the samples' own residuals -----------------------------------------------

KAUFMAN, GOLUB_PEREYRA, NEWTON = range(3)


def samples_of(path):
    """a, b, c and the channels, each divided by its largest value."""
    table = numpy.loadtxt(path, delimiter=",", skiprows=1)
    return table[:, 0], table[:, 1], table[:, 2], table[:, 3:] / table[:, 3:].max(axis=0)


def columns_at(a, b, c, u):
    return numpy.column_stack([a, *(b * numpy.exp(-(c - c.min()) * math.exp(-2.0 * v)) for v in u)])


def supports_at(path, u):
    a, b, c, values = samples_of(path)
    return [optimize.nnls(columns_at(a, b, c, u), values[:, k])[0] for k in range(values.shape[1])]


def residuals_at(path, u, coefficients):
    """Of all channels, the coefficients of the given supports being optimal without a sign."""
    a, b, c, values = samples_of(path)
    columns, left = columns_at(a, b, c, u), []
    for k, z in enumerate(coefficients):
        q, _ = numpy.linalg.qr(columns[:, z > 0])
        left.append(values[:, k] - q @ (q.T @ values[:, k]))
    return numpy.concatenate(left)


def shifted(u, j, step):
    return [v + step * (i == j) for i, v in enumerate(u)]


def kaufman_at(path, u, coefficients):
    """2 J^T J with J_p = -P dPhi_p z, P from a QR factorisation and dPhi from its formula."""
    a, b, c, _ = samples_of(path)
    columns, c = columns_at(a, b, c, u), c - c.min()
    moved = numpy.column_stack([2.0 * c * math.exp(-2.0 * v) * columns[:, 1 + p] for p, v in enumerate(u)])
    jacobian = []
    for z in coefficients:
        q, _ = numpy.linalg.qr(columns[:, z > 0])
        part = moved * z[1:]
        jacobian.append(part - q @ (q.T @ part))
    jacobian = numpy.concatenate(jacobian)
    return 2.0 * jacobian.T @ jacobian


def half_gradient_at(path, u, coefficients, step=1e-4):
    """J^T r by differences of E2."""
    ends = [[numpy.sum(residuals_at(path, shifted(u, j, sign * step), coefficients) ** 2) for sign in (1, -1)]
            for j in range(len(u))]
    return numpy.array([(plus - minus) / (4 * step) for plus, minus in ends])


def projected(problem, u, kind):
    """(gradient, matrix, Kaufman's matrix) of tools/bench/curves_projected.c."""
    lobes = len(u)
    call = problem.library.curves_projected
    call.restype = None
    call.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_double * 2, ctypes.c_int, ctypes.c_double * 2,
                     *[ctypes.c_double * 4] * 2]
    at, gradient, matrix, safe = (ctypes.c_double * 2)(*u), (ctypes.c_double * 2)(), (ctypes.c_double * 4)(), \
        (ctypes.c_double * 4)()
    problem.value(u)
    call(problem.handle, lobes, at, kind, gradient, matrix, safe)
    return (numpy.array(gradient[:lobes]), *(numpy.array(m[: lobes * lobes]).reshape(lobes, lobes) for m in (matrix, safe)))


# Where supports stay as they are a step away: no coefficient near 0, no other one about to enter.
PLACES = [("mis.csv", [-1.0]), ("two.csv", [-1.5]), ("one.csv", [-0.7]), ("mis.csv", [-2.5, -1.0]), ("two.csv", [-2.6, -1.2]),
          ("one.csv", [-1.0, -0.2]), ("mis.csv", [-1.4, -0.6])]  # the last: one lobe has no coefficient


@needs_curves
@pytest.mark.parametrize(("file", "u"), PLACES)
def test_projected_derivatives_are_those_of_the_samples(file, u):
    if not (BUILD / "libcurves_reduced.so").exists():
        pytest.skip("build/libcurves_reduced.so is not there (make bench-programs)")
    path, step, lobes = HARD / file, 1e-4, len(u)
    problem, z = scipy_peers.Reduced(BUILD / "libcurves_reduced.so", path, lobes), supports_at(HARD / file, u)
    assert any(z_k[1:].any() for z_k in z)  # else all is 0
    gradient, newton, safe = projected(problem, u, NEWTON)
    _, turned, _ = projected(problem, u, GOLUB_PEREYRA)
    kaufman = projected(problem, u, KAUFMAN)[1]
    ends = [[residuals_at(path, shifted(u, j, sign * step), z) for sign in (1, -1)] for j in range(lobes)]
    jacobian = numpy.column_stack([(plus - minus) / (2 * step) for plus, minus in ends])
    # central differences: step^2 times third derivatives of a few tens
    scale = numpy.abs(newton).max() + numpy.abs(kaufman).max()
    assert numpy.allclose(gradient, 2 * jacobian.T @ residuals_at(path, u, z), rtol=1e-6, atol=1e-6 * scale)
    assert numpy.allclose(turned, 2 * jacobian.T @ jacobian, rtol=1e-6, atol=1e-6 * scale)
    assert numpy.allclose(kaufman, kaufman_at(path, u, z), rtol=1e-11, atol=1e-11 * scale)  # no differences: rounding
    assert numpy.array_equal(kaufman, safe)
    for j in range(lobes):
        slopes = [2 * half_gradient_at(path, shifted(u, j, sign * step), z) for sign in (1, -1)]
        assert numpy.allclose(newton[:, j], (slopes[0] - slopes[1]) / (2 * step), rtol=1e-5, atol=1e-5 * scale)
    problem.close()


@needs_curves
def test_every_matrix_of_variable_projection_finds_the_known_optima():
    text = run("curves", "--set", "hard", "--methods", "moment,varpro,varpro:kaufman,varpro:golub-pereyra", "--starts", 5,
               "--repeat", 1, HARD / "two.csv", HARD / "one.csv", HARD / "mis.csv")
    rows = list(csv.DictReader(text.splitlines()))
    best = a.optima(rows)
    assert len(best) == 6 and not a.contradictions(rows, best)
    for method in ("varpro", "varpro:kaufman", "varpro:golub-pereyra"):
        for key, proof_row in best.items():
            found = [float(r["e2"]) for r in rows if r["method"] == method and a.identity(r) == key]
            # 1, 2, 5 ... 100 starts, which are the same ones; a start ends within 1e-8
            assert len(found) == 7 and all(x <= y * (1.0 + 1e-7) for x, y in zip(found[1:], found))
            assert a.excess(found[-1], float(proof_row["e2"])) <= a.FOUND, (method, key)


@needs_curves
def test_recursion_takes_whole_rounds_and_ends(hard_rows):
    rows = [r for r in hard_rows if r["method"].startswith("recursive")]
    assert {r["method"] for r in rows} == {"recursive", "recursive-box"}
    for r in rows:
        rounds = float(r["nodes"]) / float(r["knob"])
        # the second round is the first that can find nothing better
        assert rounds == int(rounds) and 2 <= rounds <= 10, r


@needs_curves
def test_every_method_has_a_name_and_a_knob():
    import bench_labels

    listing = run("curves", "--list").splitlines()
    methods = {line.split(",")[1] for line in listing if line.startswith("method,") and not line.endswith(",variant")}
    assert methods <= set(bench_labels.LABELS) and methods <= set(bench_labels.KNOBS)
    assert {"varpro", "recursive", "recursive-box"} <= methods
    assert bench_text.knob("varpro", 1000.0) == "1,000 starts"
    assert bench_text.knob("recursive", 5.0) == "5 starts a round"


@pytest.mark.skipif(not (BUILD / "kernel").exists(), reason="build/kernel is not there (make bench-programs)")
def test_the_kernel_counts_its_operations():
    rows = list(csv.DictReader(run("kernel").splitlines()))
    assert rows
    for r in rows:
        # 50 an entry and 7 for each of 1 + 3 functionals; printed with four digits
        assert math.isclose(float(r["node_flops"]) * float(r["node_seconds"]), 78.0 * float(r["distinct_c"]), rel_tol=2e-3)
        assert math.isclose(float(r["fraction"]) * float(r["peak_flops"]), float(r["node_flops"]), rel_tol=2e-3)
