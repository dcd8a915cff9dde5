"""One fit against its reference: errors, and whether anything that is promised does not hold.

SPDX-License-Identifier: MIT
"""
import itertools

import mpmath
from flint import arb

from reference import Model, Problem

U = 2.0 ** -53
GAP, ABSOLUTE_GAP = 1e-3, 1e-12
# |sqrt(e2) - sqrt(E^2)| in units of u sqrt(T): each residual is a datum less three products, each of them rounded
# some four times and with an exponential of 2 u; twice that.
E2_UNITS = 40.0
# A flat sigma is moved to its largest, where E^2 is no more than 1e-12 of itself (1e-28 T) above the minimum.
FLAT, FLAT_OF_DATA = 2e-12, 1e-26
# Columns of a larger condition do not tell their coefficients apart: x and y are not compared one by one.
IDENTIFIED = 1e8
COLUMNS = ("failure", "family", "name", "stop", "certified", "boxes", "share", "e2_relative", "e2_units", "model_units",
           "condition", "excess", "excess_of_data", "sigma_error", "sigma_units", "x_error", "y_error", "own_error",
           "own_units", "margin", "margin_units", "same_bits", "twin_boxes", "basin")


def root(ball):
    """Of a ball around something >= 0; one that reaches 0 is 0 to its hundred digits."""
    return ball.sqrt() if ball > 0 else arb(0)


def relative(found, true):
    """Largest difference, relative to the largest true one."""
    size = max(map(abs, true), default=0.0)
    return max((abs(f - t) for f, t in zip(found, true)), default=0.0) / size if size > 0 else None


def by_lobe(found, true, lobes):
    errors = [relative(found[p::lobes], true[p::lobes]) for p in range(lobes)]
    return max((e for e in errors if e is not None), default=None)


def lowest(problem, answer):
    """The best model of all starts, its curvature, and the best model at the library's own sigma."""
    own = [-2 * arb(s).log() for s in answer["sigma"]]
    at_own = Model(problem, problem.clip(own))
    starts = [own, *problem.starts()]
    if problem.case.truth:
        starts.append([arb(float(s)).log() for s in problem.case.truth])
    best, curvature = problem.polish(starts[0])
    for start in starts[1:]:
        other, bent = problem.polish(start)
        if other.e2.mid() < best.e2.mid() and float((best.e2 - other.e2) / problem.total) > 1e-60:
            best, curvature = other, bent
    return best, curvature, at_own


def failures(answer, problem, best, e2_units, model_units):
    """What is promised and does not hold."""
    bound, e2, total = arb(answer["lower_bound"]), arb(answer["e2"]), problem.total
    for name in ("lower_bound", "tight_bound"):
        if not arb(answer[name]) <= best.e2 and arb(answer[name]) > best.e2.mid():
            yield (f"{'PROVEN' if arb(answer[name]) > best.e2 else 'undecided'}: {name} {answer[name]!r} above E^2 "
                   f"{best.e2.str(25)} at theta {[t.str(20, radius=False) for t in best.theta]}")
    if not bound <= e2:
        yield "the bound is above e2"
    if e2_units > E2_UNITS:
        yield f"e2 {answer['e2']!r} is {e2_units:.3g} u sqrt(T) off the E^2 of its own model"
    if model_units > E2_UNITS:
        yield f"the E^2 of sigma, x and y is {model_units:.3g} u sqrt(T) off e2 {answer['e2']!r}"
    if answer["certified"]:
        slack = arb(E2_UNITS * U) * root(best.e2 * total) + arb(E2_UNITS * U) ** 2 * total
        if e2 > best.e2 * (1 + arb(GAP)) + slack and e2 > best.e2 + arb(ABSOLUTE_GAP) * total + slack:
            yield f"certified, but a model has {best.e2.str(20)}, beyond the gap"
    if not answer["same_bits"]:
        yield "other bits in another floating-point environment"


def model_units(answer, problem):
    """|sqrt(e2) - sqrt(E^2)| of the returned sigma, x and y, beyond what rounding sigma to a double changes."""
    given, total = problem.given(answer["sigma"], answer["x"], answer["y"]), problem.total
    if not total > 0:
        return 0.0
    exponent = max(float(problem.c_min / arb(s) ** 2) for s in answer["sigma"])
    return float(abs(arb(answer["e2"]).sqrt() - root(given)) / (arb(U) * total.sqrt())) / (1 + exponent)


def sigma_error(answer, best):
    """Largest relative error of sigma over the lobes that are used; inside a flat interval there is none."""
    true = [float((-t / 2).exp()) if any(z[1 + p] > 0 for z in best.z) else None for p, t in enumerate(best.theta)]
    if not any(true):
        return None

    def error(sigma, found, interval):
        if sigma is None or interval[0] < interval[1] and interval[0] <= sigma * (1 + 1e-9) <= interval[1] * (1 + 2e-9):
            return 0.0
        return abs(found / sigma - 1)

    return min(max(map(error, order, answer["sigma"], answer["interval"])) for order in itertools.permutations(true))


def ordered(problem, model):
    """x, y of a model with lobes by ascending sigma."""
    x, y = problem.physical(model)
    lobes = problem.lobes
    order = sorted(range(lobes), key=lambda p: -float(model.theta[p]))
    return x, [y[k * lobes + p] for k in range(problem.channels) for p in order]


def judge(case, answer, twin=None):
    row = dict.fromkeys(COLUMNS)
    row.update(family=case.family, name=case.name, failure="")
    if "error" in answer:
        row.update(stop=answer["error"], failure="refused: " + answer["error"])
        return row
    row.update({key: answer[key] for key in ("stop", "certified", "boxes", "same_bits")})
    row["twin_boxes"] = twin["boxes"] if twin else None
    problem = Problem(case, answer["scale"], answer["sigma_floor"])
    if problem.low is None:
        row["stop"] += " (no lobe has finite y)"
        return row
    best, curvature, at_own = lowest(problem, answer)
    e2, total = arb(answer["e2"]), problem.total
    units = abs(e2.sqrt() - root(at_own.e2)) / (arb(U) * total.sqrt()) if total > 0 else arb(0)
    row["e2_units"] = float(units)
    assert row["e2_units"] >= 0  # NaN would pass for small
    row["share"] = float(best.e2 / total) if total > 0 else 0.0
    row["excess_of_data"] = float((at_own.e2 - best.e2) / total) if total > 0 else 0.0
    row["same_bits"] = answer["same_bits"]
    row["model_units"] = model_units(answer, problem)
    row["failure"] = "; ".join(failures(answer, problem, best, row["e2_units"], row["model_units"]))
    second_opinion(problem, best, row)
    if row["share"] > 1e-24:
        row["e2_relative"] = float(abs(e2 / at_own.e2 - 1))
        row["excess"] = float(at_own.e2 / best.e2 - 1)
        row["margin"] = float(1 - arb(max(answer["lower_bound"], answer["tight_bound"])) / best.e2)
        if max(answer["lower_bound"], answer["tight_bound"]) > 0:
            row["margin_units"] = float((best.e2 - arb(max(answer["lower_bound"], answer["tight_bound"]))) / (arb(U) * total))
    row["own_error"], unit, row["condition"] = problem.coefficient_error(at_own, answer["x"], answer["y"])
    row["own_units"] = row["own_error"] / unit if unit else None
    row["basin"] = "same" if row["excess_of_data"] <= max(FLAT * row["share"], FLAT_OF_DATA) else "another"
    if row["basin"] == "same":
        row["sigma_error"] = sigma_error(answer, best)
        if row["sigma_error"] is not None and curvature is not None and curvature > 0:
            noise = arb(U) * root(best.e2 * total) + arb(U) ** 2 * total
            row["sigma_units"] = row["sigma_error"] / float((noise / curvature).mid().sqrt())
        x, y = ordered(problem, best)
        if row["condition"] <= IDENTIFIED:
            row["x_error"] = relative(answer["x"], x)
        if row["condition"] <= IDENTIFIED and all(low == high for low, high in answer["interval"]):  # y(sigma) is one
            row["y_error"] = by_lobe(answer["y"], y, case.lobes)
    return row


def second_opinion(problem, best, row):
    """mpmath has to agree with Arb about the minimum to its own 50 digits."""
    again = problem.again(best.theta)
    with mpmath.workdps(50):
        man, exp = best.e2.mid().man_exp()
        first = mpmath.ldexp(mpmath.mpf(int(man)), int(exp))
        man, exp = problem.total.mid().man_exp()
        total = mpmath.ldexp(mpmath.mpf(int(man)), int(exp))
        if total > 0 and abs(again - first) > mpmath.mpf(10) ** -30 * total:
            row["failure"] += f"; references disagree: Arb {best.e2.str(20)}, mpmath {mpmath.nstr(again, 20)}"
