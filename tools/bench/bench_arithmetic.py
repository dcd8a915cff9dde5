"""The arithmetic of `make bench`: from rows of programs to curves, ratios and targets. Pure: reads nothing, draws nothing.

A row is a dict of strings as build/curves prints it. E is the root of E2, so that the error (E - E*) / E* of a method is
sqrt(E2 / E2*) - 1, with E2* of the certified fit at the smallest gap. SPDX-License-Identifier: MIT
"""
import collections
import math

# A method has found the optimum of a file when its error is below this.
FOUND = 1e-6
# Rounding of E2, as a fraction of the data's sum of squares: no answer can be told from another below it.
ROUNDING = 1e-13
# Smaller errors than this are drawn here: the certificate of the optimum itself is no finer.
FLOOR = 1e-12
# The gap that fits are made with unless asked otherwise.
GAP = 1e-3

Point = collections.namedtuple("Point", "knob seconds median worst found files")


def median(values):
    values = sorted(values)
    middle = len(values) // 2
    return values[middle] if len(values) % 2 else 0.5 * (values[middle - 1] + values[middle])


def identity(row):
    return row["set"], row["file"], row["lobes"]


def optima(rows):
    """(set, file, lobes) -> the certified row of engine moment with the smallest gap."""
    best = {}
    for row in rows:
        if row["method"] != "moment" or row["certified"] != "1":
            continue
        if identity(row) not in best or float(row["knob"]) < float(best[identity(row)]["knob"]):
            best[identity(row)] = row
    return best


def excess(e2, optimum, rounding=0.0):
    """(E - E*) / E*; 0 when it is below, or when both are at rounding level."""
    if e2 - optimum <= rounding:
        return 0.0
    if optimum <= 0.0 or math.isinf(e2):
        return math.inf
    return math.sqrt(e2 / optimum) - 1.0


def contradictions(rows, best):
    """Rows below a proven bound by more than rounding: there must be none."""
    wrong = []
    for row in rows:
        if identity(row) in best:
            proof = best[identity(row)]
            if float(row["e2"]) < float(proof["lower_bound"]) - ROUNDING * float(proof["sum_of_squares"]):
                wrong.append(row)
    return wrong


def curve(rows, best, files):
    """Points of one method over its knob, as many files each; a knob that some file did not get is left out."""
    by_knob = collections.defaultdict(dict)
    for row in rows:
        if identity(row) in best:
            by_knob[float(row["knob"])][identity(row)] = row
    points = []
    for knob, found in by_knob.items():
        if len(found) == files:
            errors = [excess(float(row["e2"]), float(best[key]["e2"]), ROUNDING * float(best[key]["sum_of_squares"]))
                      for key, row in found.items()]
            points.append(Point(knob, median(float(row["seconds"]) for row in found.values()), median(errors), max(errors),
                                sum(error <= FOUND for error in errors) / files, files))
    return sorted(points, key=lambda point: point.seconds)


def curves(rows, best):
    """(set, lobes, method) -> points, with set "all" over every file."""
    groups, files = collections.defaultdict(list), collections.defaultdict(set)
    for key in best:
        for name in (key[0], "all"):
            files[name, key[2]].add(key)
    for row in rows:
        for name in (row["set"], "all"):
            groups[name, row["lobes"], row["method"]].append(row)
    found = {key: curve(group, best, len(files[key[:2]])) for key, group in groups.items()}
    return {key: points for key, points in found.items() if points}


def cheapest(points, share=1.0):
    """The first point, in time, at which at least this share of the files is solved; None when there is none."""
    return next((point for point in points if point.found >= share), None)


def pick(rows, method, lobes, knob=None, name=None):
    """(set, file, lobes) -> row of a method, of one lobe count, knob and set."""
    return {identity(row): row for row in rows if row["method"] == method and row["lobes"] == str(lobes) and
            (knob is None or math.isclose(float(row["knob"]), knob)) and (name is None or row["set"] == name)}


def start_seconds(rows, method, lobes, name=None):
    """(set, file, lobes) -> mean seconds of one start of a local solver: from the row with the most starts."""
    most = {}
    for row in rows:
        if row["method"] != method or row["lobes"] != str(lobes) or name not in (None, row["set"]):
            continue
        if identity(row) not in most or float(row["knob"]) > float(most[identity(row)]["knob"]):
            most[identity(row)] = row
    return {key: float(row["seconds"]) / float(row["knob"]) for key, row in most.items()}


def ratios(numerator, denominator):
    """Ratios of two dicts file by file, where both have the file."""
    return [numerator[key] / denominator[key] for key in numerator if key in denominator and denominator[key] > 0.0]


def seconds_of(picked, field="seconds"):
    return {key: float(row[field]) for key, row in picked.items()}


def slope(points):
    """Least-squares exponent of y = x^slope over (x, y) pairs; None without two different x."""
    points = [(math.log(x), math.log(y)) for x, y in points if x > 0.0 and y > 0.0]
    if len({x for x, _ in points}) < 2:
        return None
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)
