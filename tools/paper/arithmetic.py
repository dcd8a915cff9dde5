"""The arithmetic of the paper's experiments: from results of programs to the numbers of figures and tables.

Pure Python; reads nothing, draws nothing. E is the root mean square error in normalised units, E2 its sum of squares.
SPDX-License-Identifier: MIT
"""
import math

# Two lobes count as better than one when they lower E by more than this fraction of it. The paper names no threshold.
BETTER = 1e-3
# A local solver is at the optimum when its E2 is this close to the certified one; rounding is a fraction of the data's
# sum of squares, which matters for exact fits only.
REACHED = 1e-6
NEAR = 1e-3
ROUNDING = 1e-12


def d12(fit_one, fit_two):
    """(E1 - E2) / E2 of the paper's Fig. 8 from two JSON fits of one material; 0 when both are exact."""
    one, two = math.sqrt(fit_one["e2"]), math.sqrt(fit_two["e2"])
    if two * two <= ROUNDING * fit_two["sum_of_squares"]:
        return 0.0 if one * one <= ROUNDING * fit_one["sum_of_squares"] else math.inf
    return (one - two) / two


def count_better(differences, threshold=BETTER):
    return sum(1 for d in differences if d > threshold)


def geometric_mean(values):
    values = list(values)
    return math.exp(sum(map(math.log, values)) / len(values))


def median(values):
    values = sorted(values)
    middle = len(values) // 2
    return values[middle] if len(values) % 2 else 0.5 * (values[middle - 1] + values[middle])


def at_optimum(e2, certified, sum_of_squares, tolerance=REACHED):
    return e2 <= certified * (1 + tolerance) + ROUNDING * sum_of_squares


def excess(e2, certified, sum_of_squares):
    """E2 over the certified optimum, minus 1; 0 for exact fits."""
    return 0.0 if at_optimum(e2, certified, sum_of_squares, 0.0) else e2 / certified - 1


def relative_difference(one, two):
    """Of two E2 of the same data, but for rounding of exact fits."""
    apart = abs(one["e2"] - two["e2"])
    return 0.0 if apart <= ROUNDING * one["sum_of_squares"] else apart / min(one["e2"], two["e2"])


class Peer:
    """One setting of one local solver on all materials: the rows of the cache that belong to it."""

    def __init__(self, rows):
        self.blocks = {}  # (material, lobes) -> rows
        for row in rows:
            self.blocks.setdefault((row["material"], int(row["lobes"])), []).append(row)

    def upto(self, material, lobes, starts):
        """The rows of the first `starts` starts, each start once; fewer when the cache lacks some."""
        return chain([row for row in self.blocks.get((material, lobes), []) if int(row["last"]) <= starts])

    def complete(self, material, lobes, starts):
        """Whether these starts are all there, and those of fewer lobes, which supervision needs."""
        ends = [self.upto(material, p, starts)[-1:] for p in range(1, lobes + 1)]
        return all(rows and int(rows[0]["last"]) == starts for rows in ends)

    def best(self, material, lobes, starts, supervised=True):
        """Smallest E2 after `starts` starts. The paper's supervision takes the one-lobe answer when it is better."""
        found = min((float(row["best_e2"]) for row in self.upto(material, lobes, starts)), default=math.inf)
        return min(found, self.best(material, 1, starts)) if supervised and lobes > 1 else found

    def total(self, column, materials, lobes, starts):
        return sum(float(row[column]) for m in materials for row in self.upto(m, lobes, starts))

    def milestones(self, materials, lobes, most):
        """Numbers of starts at which a rate can be told for all of `materials`."""
        ends = {int(row["last"]) for m in materials for row in self.blocks.get((m, lobes), [])}
        return sorted(n for n in ends if n <= most and all(self.complete(m, lobes, n) for m in materials))


def chain(rows):
    """Blocks [first, last) that follow each other from 0; where two begin at one place, the longer one."""
    follows = {}
    for row in rows:
        first = int(row["first"])
        if first not in follows or int(row["last"]) > int(follows[first]["last"]):
            follows[first] = row
    found, at = [], 0
    while at in follows:
        found.append(follows[at])
        at = int(follows[at]["last"])
    return found


def count_at_optimum(peer, certified, materials, lobes, starts, tolerance=REACHED, supervised=True):
    """How many of `materials` the peer has solved after `starts` starts. `certified`: material -> JSON fit."""
    return sum(1 for m in materials if at_optimum(peer.best(m, lobes, starts, supervised), certified[m]["e2"],
                                                  certified[m]["sum_of_squares"], tolerance))


def below_bound(peers, bounds, margin=1e-9):
    """Rows that contradict a proof: an E2 below the proven lower bound by more than rounding. Must be empty."""
    wrong = []
    for peer in peers:
        for (material, lobes), rows in peer.blocks.items():
            fit = bounds[lobes][material]
            floor = fit["lower_bound"] * (1 - margin) - ROUNDING * fit["sum_of_squares"]
            wrong += [row for row in rows if float(row["best_e2"]) < floor]
    return wrong


def compare_brute(fit, brute, step):
    """What an exhaustive search over multiples of `step` says of a fit.

    The optimum lies between the grid's points, so the fit may be lower; it must not be higher. `same` is the paper's
    "identical": every roughness within one step, or the difference too small to matter (E2 to 1e-6).
    """
    allowance = ROUNDING * fit["sum_of_squares"]
    near = all(abs(a - b) <= step for a, b in zip(fit["sigma"], brute["sigma"]))
    return {
        "ratio": brute["e2"] / fit["e2"] - 1 if fit["e2"] > allowance else 0.0,  # exact fits have none
        "above": fit["e2"] > brute["e2"] * (1 + REACHED) + allowance,
        "disproved": brute["e2"] < fit["lower_bound"] * (1 - 1e-9) - allowance,
        "same": near or abs(brute["e2"] - fit["e2"]) <= REACHED * fit["e2"] + allowance,
    }


def choose_plots(one, two):
    """Five materials for Figs 3-7: best and median and worst fitted, least diffuse, most improved by a second lobe."""
    names = sorted(one)
    order = sorted(names, key=lambda m: (one[m]["rms_total"], m))
    diffuse = {m: sum(one[m]["x"][k] / one[m]["channel_scale"][k] for k in range(len(one[m]["x"]))) for m in names}
    wanted = [
        ("best fitted by one lobe", order),
        ("median of one lobe's errors", sorted(order, key=lambda m: abs(order.index(m) - len(order) // 2))),
        ("worst fitted by one lobe", order[::-1]),
        ("least diffuse", sorted(names, key=lambda m: (diffuse[m], m))),
        ("most improved by a second lobe", sorted(names, key=lambda m: (-d12(one[m], two[m]), m))),
    ]
    chosen = []
    for why, candidates in wanted:
        name = next((m for m in candidates if m not in [c for c, _ in chosen]), None)
        if name:
            chosen.append((name, why))
    return chosen


def panels(rows):
    """View angle -> (rows in the plane of incidence, rows across it); the signed angle grows towards the mirror side."""
    views = {}
    for row in rows:
        view = round(row["theta_o"], 6)
        turn = (row["phi_i"] - row["phi_o"]) % 360
        inside, across = views.setdefault(view, ([], []))
        if row["theta_i"] < 1e-6 or abs(turn) < 1e-6 or abs(turn - 180) < 1e-6:
            inside.append((row["theta_i"] if abs(turn - 180) < 1e-6 else -row["theta_i"], row))
        if row["theta_i"] < 1e-6 or abs(turn - 90) < 1e-6:
            across.append((row["theta_i"], row))
    return {view: tuple(sorted(part, key=lambda pair: pair[0]) for part in views[view]) for view in sorted(views)}
