"""Independent judges of the restricted problem and of lower bounds: SciPy and Arb ball arithmetic.

SPDX-License-Identifier: MIT
"""
import itertools
import json
import os
import subprocess

import numpy as np
import pytest
from flint import arb, arb_mat, ctx
from scipy.optimize import nnls

BUILD = os.environ.get("BRDFFIT_BUILD", "build")
ROWS = 12
RECORD = 2 + 3 * ROWS + ROWS + 3 + 2


def run(name, *args):
    program = os.path.join(BUILD, "tests", "ref", name)
    if not os.path.exists(program):
        pytest.fail(f"{program} is missing: build it with `make check`")
    return subprocess.run([program, *args], check=True, capture_output=True).stdout


def test_restricted_problem_against_scipy():
    """100,000 problems: never a larger residual than SciPy's, and the stated residual is true."""
    count = 100_000
    cases = np.frombuffer(run("nnls_cases", str(count))).reshape(count, RECORD)
    worst = 0.0
    for case in cases:
        m, n = int(case[0]), int(case[1])
        a = case[2:2 + 3 * ROWS].reshape(ROWS, 3)[:m, :n]
        data = case[2 + 3 * ROWS:2 + 4 * ROWS][:m]
        z = case[2 + 4 * ROWS:5 + 4 * ROWS][:n]
        rss, kkt = case[-2], case[-1]
        assert (z >= 0).all() and kkt <= 4e-15
        residual = data - a @ z
        size = data @ data
        assert abs(residual @ residual - rss) <= 1e-13 * size
        try:
            reference = nnls(a, data, maxiter=1000)[1] ** 2
        except RuntimeError:  # SciPy itself gives up on some collinear cases
            continue
        assert rss <= reference + 1e-13 * size, (a, data, z, rss, reference)
        worst = max(worst, (rss - reference) / size if size else 0.0)
    print(f"{count} problems, worst excess over SciPy {worst:.2g} of the data")


def numbers(texts):
    return [arb(float.fromhex(t)) for t in texts]


def decided_minimum(columns, data):
    """Enclosure of min ||data - A z||^2 over z >= 0, or None where a sign cannot be decided at this precision."""
    best = None
    for size in range(len(columns) + 1):
        for support in itertools.combinations(range(len(columns)), size):
            residual, feasible = data, True
            if size:
                gram = arb_mat([[sum(p * q for p, q in zip(columns[i], columns[j])) for j in support]
                                for i in support])
                right = arb_mat([[sum(p * q for p, q in zip(columns[i], data))] for i in support])
                try:
                    z = gram.solve(right)
                except ZeroDivisionError:
                    return None
                signs = [z[i, 0] > 0 for i in range(size)]
                decided = [s or z[i, 0] < 0 for i, s in enumerate(signs)]
                if not all(decided):
                    return None
                feasible = all(signs)
                residual = [d - sum(z[i, 0] * columns[j][r] for i, j in enumerate(support))
                            for r, d in enumerate(data)]
            if feasible:
                value = sum((r * r for r in residual), arb(0))
                best = value if best is None else best.min(value)
    return best


def columns_at(case, theta):
    a, b, c = numbers(case["a"]), numbers(case["b"]), numbers(case["c"])
    low = min(float.fromhex(t) for t in case["c"])
    columns = [a]
    for t in theta[:case["lobes"]]:
        s = arb(float.fromhex(t)).exp()
        u = s / (1 + arb(low) * s)
        if case["ggx"]:
            columns.append([bi / (1 + (ci - arb(low)) * u) ** 2 for bi, ci in zip(b, c)])
        else:
            columns.append([bi * (-(ci - arb(low)) * s).exp() for bi, ci in zip(b, c)])
    # A scalar does not change the cone; it keeps the Gram matrix invertible in balls.
    return [[v / max(abs(x) for x in column) for v in column] for column in columns]


def objective(case, theta):
    """Arb enclosure of the objective at one point, at the precision that decides every sign."""
    channels = case["channels"]
    for precision in (200, 800, 3200):
        ctx.prec = precision
        columns = columns_at(case, theta)
        total, undecided = arb(0), False
        for k in range(channels):
            scale = arb(float.fromhex(case["scale"][k]))
            data = [v / scale for v in numbers(case["values"][k::channels])]
            value = decided_minimum(columns, data)
            if value is None:
                undecided = True
                break
            total += value
        if not undecided:
            return total
    return None


def test_bounds_against_ball_arithmetic():
    """2,000 points of 400 random boxes, half of them near optima: the objective, as a ball, is never below its box's bound."""
    lines = run("bound_cases", "400").decode().splitlines()
    assert len(lines) == 400
    points = undecided = useful = 0
    for line in lines:
        case = json.loads(line)
        bound = arb(float.fromhex(case["bound"]))
        useful += bound > 0
        for p in range(len(case["theta"]) // 2):
            value = objective(case, case["theta"][2 * p:2 * p + 2])
            if value is None:  # collinear columns or exact zeros: no precision decides the sign of 0
                undecided += 1
                continue
            points += 1
            assert bound == 0 or value >= bound, f"objective {value} not certainly above bound {bound}: {line}"
    print(f"{points} points in {len(lines)} boxes ({useful} with a positive bound), {undecided} undecided")
    assert points >= 1600 and useful >= 200


def list_columns(case, theta):
    """a and the lobes at theta, each times a positive number; without those that no sample sees."""
    columns = [numbers(case["a"])]
    for lobe, t in zip(case["lobes"], theta):
        b, c = numbers(lobe["b"]), numbers(lobe["c"])
        seen = [float.fromhex(x) for x, y in zip(lobe["c"], lobe["b"]) if float.fromhex(y) > 0]
        if not seen:
            continue
        low, s = arb(min(seen)), arb(float.fromhex(t)).exp()
        if lobe["ggx"]:
            u = s / (1 + low * s)
            column = [bi / (1 + (ci - low) * u) ** 2 for bi, ci in zip(b, c)]
        else:
            column = [bi * (-(ci - low) * s).exp() if bi > 0 else arb(0) for bi, ci in zip(b, c)]
        columns.append(column)
    return columns


def list_objective(case, theta):
    """Arb enclosure of the weighted objective of a list of lobes at one point, or None where no precision decides."""
    weights = case["weights"] or ["0x1p0"] * len(case["a"])
    for precision in (200, 800, 3200):
        ctx.prec = precision
        roots = [(arb(float.fromhex(w)) / arb(float.fromhex(case["weight_scale"]))).sqrt() for w in weights]
        columns = [[root * v for root, v in zip(roots, column)] for column in list_columns(case, theta)]
        columns = [[v / max(abs(x) for x in column) for v in column] for column in columns]
        total = arb(0)
        for k, scale in enumerate(numbers(case["scale"])):
            unit = scale * arb(float.fromhex(case["value_scale"]))
            values = numbers(case["values"][k::case["channels"]])
            value = decided_minimum(columns, [root * v / unit for root, v in zip(roots, values)])
            if value is None:
                break
            total += value
        else:
            return total
    return None


def test_bounds_of_lists_against_ball_arithmetic():
    """Boxes of two and three lobes, alike and of several distributions and geometries, with weights of any size."""
    lines = run("bound_lobes_cases", "240").decode().splitlines()
    assert len(lines) == 240
    points = undecided = useful = three = mixed = 0
    for line in lines:
        case = json.loads(line)
        bound, lobes = arb(float.fromhex(case["bound"])), len(case["lobes"])
        useful += bound > 0
        for p in range(len(case["theta"]) // lobes):
            value = list_objective(case, case["theta"][lobes * p:lobes * p + lobes])
            if value is None:
                undecided += 1
                continue
            points += 1
            three += lobes == 3
            mixed += any(lobe["c"] != case["lobes"][0]["c"] for lobe in case["lobes"])
            assert bound == 0 or value >= bound, f"objective {value} not certainly above bound {bound}: {line}"
    print(f"{points} points ({three} of three lobes, {mixed} of several geometries) in {len(lines)} boxes ({useful} with a "
          f"positive bound), {undecided} undecided")
    assert points >= 360 and three >= 120 and mixed >= 100 and useful >= 80
