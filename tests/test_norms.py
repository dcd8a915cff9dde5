"""Norms l1 and linf: SciPy's linear programs (HiGHS) as judge of the restricted problem, and outliers.

SPDX-License-Identifier: MIT
"""
import json
import os
import subprocess

import numpy as np
import pytest
from scipy.optimize import linprog

BUILD = os.environ.get("BRDFFIT_BUILD", "build")


def run(name, *arguments, **more):
    program = os.path.abspath(os.path.join(BUILD, name))
    if not os.path.exists(program):
        pytest.fail(f"{program} is missing: build it with `make`")
    return subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, timeout=300, **more).stdout


def fit(path, *options):
    (line,) = [json.loads(line) for line in run("brdffit", "fit", "--json", *options, path).splitlines()]
    return line


@pytest.fixture(scope="module", autouse=True)
def needs_ecos(tmp_path_factory):
    path = tmp_path_factory.mktemp("probe") / "one.csv"
    path.write_text("a,b,c,red\n0.3,0.5,0.1,1\n")
    done = subprocess.run([os.path.abspath(os.path.join(BUILD, "brdffit")), "fit", "--norm", "l1", path], capture_output=True)
    if b"ECOS" in done.stderr:
        pytest.skip("this build is without ECOS")


def highs(norm, columns, data, weights):
    """min |data - columns z| over z >= 0."""
    rows, count = columns.shape
    if norm == "l1":
        height, cost = np.eye(rows), np.r_[np.zeros(count), weights]
    else:
        height, cost = np.ones((rows, 1)), np.r_[np.zeros(count), 1.0]
    sides = np.block([[-columns, -height], [columns, -height]])
    options = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    answer = linprog(cost, sides, np.r_[-data, data], bounds=(0, None), method="highs", options=options)
    assert answer.status == 0, answer.message
    return answer.fun


def make_problem(seed, path):
    """Coefficients, weights and values of a random problem, written as CSV."""
    rng = np.random.default_rng(seed)
    count, channels = int(rng.integers(6, 60)), int(rng.integers(1, 4))
    a, b = rng.uniform(0.05, 0.32, count), rng.uniform(0.2, 2, count)
    c = np.tan(rng.uniform(0, 1.2, count)) ** 2
    weights = rng.choice([0.0, 0.5, 1.0, 3.0], count, p=[0.1, 0.3, 0.3, 0.3])
    weights[:3] = 1
    s = 1 / rng.uniform(0.1, 0.8, 2) ** 2
    truth = np.outer(a, rng.uniform(0.1, 1, channels))
    for p in range(2):
        truth += np.outer(b * s[p] * np.exp(-c * s[p]), rng.uniform(0, 0.1, channels))
    values = truth * (1 + rng.choice([0.0, 0.02, 0.3]) * rng.standard_normal(truth.shape))
    names = ["red", "green", "blue"][:channels]
    with open(path, "w") as file:
        file.write(",".join(["a", "b", "c", "weight", *names]) + "\n")
        for row in np.column_stack([a, b, c, weights, values]):
            file.write(",".join("%.17g" % x for x in row) + "\n")
    used = weights > 0
    return a[used], b[used], c[used], weights[used], values[used]


@pytest.mark.parametrize("norm", ["l1", "linf"])
@pytest.mark.parametrize("seed", range(40))
def test_restricted_problem_against_highs(tmp_path, norm, seed):
    lobes = 1 + seed % 2
    a, b, c, weights, values = make_problem(seed, tmp_path / "data.csv")
    line = fit(tmp_path / "data.csv", "--norm", norm, "--lobes", lobes, "--gap", "1e-2")
    assert line["norm"] == norm and line["status"] == "certified"
    assert line["objective"] == line["e2"]
    # Columns up to a factor each, which z takes up.
    columns = [a] + [b * np.exp(-(c - c.min()) / sigma ** 2) for sigma in line["sigma"]]
    columns = np.stack([x / x.max() for x in columns], 1)
    optima = [highs(norm, columns, values[:, k] / line["channel_scale"][k], weights) for k in range(values.shape[1])]
    best = sum(optima) if norm == "l1" else max(optima)
    assert abs(line["objective"] - best) <= 1e-7 * best + 1e-9 * line["sum_of_squares"]
    assert line["lower_bound"] <= best + 1e-9 * line["sum_of_squares"]
    assert 0 <= line["kkt_residual"] <= 1e-7


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_l1_recovers_roughness_beside_outliers(tmp_path, seed):
    """The goniometer spoils 10 % of its samples: l1 is within 2 % of both roughnesses, l2 misses by more than 10 %."""
    run("goniometer", tmp_path / "lab", "--seed", seed, "--outliers", "0.1")
    truth = {entry["file"]: entry for entry in json.loads((tmp_path / "lab" / "truth.json").read_text())["files"]}
    name = "two_lobe_outliers.csv"
    errors = {}
    for norm in ("l1", "l2"):
        line = fit(tmp_path / "lab" / name, "--norm", norm, "--lobes", 2, "--gap", "1e-2")
        assert line["status"] == "certified"
        errors[norm] = np.abs(np.array(line["sigma"]) / np.array(truth[name]["sigma"]) - 1)
    print("relative errors of sigma:", errors)
    assert errors["l1"].max() <= 0.02
    assert errors["l2"].min() > 0.1
