"""The true minimum of a case, to 100 digits in Arb balls, with a second opinion in 50-digit mpmath.

Shares nothing with the library. E^2(theta), theta = ln s, is exact nonnegative least squares by enumeration of
supports; its gradient is that of the envelope theorem, 2 sum_k y_kp r_k . g_p'; Newton's method with differences of
the gradient ends where that gradient vanishes to some 30 digits. Starts: the library's answer, the truth that made the
data, and the best places of a scan over the whole domain in double precision, so that a wrong basin shows.

A value here is a ball around E^2 of one explicit model with coefficients >= 0. So "the bound is above it" is a proof
that the bound is wrong. SPDX-License-Identifier: MIT
"""
import itertools

import mpmath
import numpy as np
from flint import arb, arb_mat, ctx

from cases import EXPONENT_RANGE, SIGMA_RANGE, by_exponent, shape

BITS = 400
STEP = arb(2) ** -120  # of differences: the gradient has some 390 bits
NEWTON = 50
SCAN = {1: 400, 2: 72}


def point(ball):
    """The middle of a ball, exactly."""
    return ball.mid()


class Model:
    """What a theta gives: the columns, the best coefficients of each channel, and E^2 of them as a ball."""

    def __init__(self, problem, theta):
        self.problem, self.theta = problem, theta
        lobes = [problem.lobe(t) for t in theta]
        self.columns = [problem.a, *(g for g, _ in lobes)]
        self.slopes = [d for _, d in lobes]
        matrix = arb_mat([list(row) for row in zip(*self.columns)])
        turned = matrix.transpose()
        self.gram, right = turned * matrix, turned * problem.data
        self.z = [self.restricted(right, k) for k in range(problem.channels)]
        fitted = matrix * arb_mat([[self.z[k][j] for k in range(problem.channels)] for j in range(len(self.columns))])
        self.residual = problem.data - fitted
        self.e2 = sum((r * r for r in self.residual.entries()), arb(0))

    def restricted(self, right, k):
        """Best z >= 0 of channel k; a support with a coefficient of undecided sign is left to smaller ones."""
        n = len(self.columns)
        best, best_gain = [arb(0)] * n, arb(0)
        for size in range(1, n + 1):
            for support in itertools.combinations(range(n), size):
                try:
                    z = arb_mat([[self.gram[i, j] for j in support] for i in support]).solve(
                        arb_mat([[right[i, k]] for i in support]))
                except ZeroDivisionError:
                    continue
                if not all(z[i, 0] > 0 for i in range(size)):
                    continue
                gain = sum((z[i, 0] * right[j, k] for i, j in enumerate(support)), arb(0))
                if gain.mid() > best_gain.mid():
                    best, best_gain = [arb(0)] * n, gain
                    for i, j in enumerate(support):
                        best[j] = point(z[i, 0])
        return best

    def gradient(self):
        p, out = self.problem, []
        for lobe, slope in enumerate(self.slopes):
            total = arb(0)
            for k in range(p.channels):
                if self.z[k][1 + lobe] > 0:
                    total -= 2 * self.z[k][1 + lobe] * sum((self.residual[i, k] * s for i, s in enumerate(slope)), arb(0))
            out.append(point(total))
        return out


class Problem:
    def __init__(self, case, scale, floor):
        ctx.prec = BITS
        keep = [i for i in range(len(case.a)) if case.weights is None or case.weights[i] > 0]
        self.case, self.keep, self.lobes, self.channels = case, keep, case.lobes, case.values.shape[1]
        self.root = [arb(1) if case.weights is None else arb(float(case.weights[i])).sqrt() for i in keep]
        self.scale = [arb(s) for s in scale]
        self.a = [arb(float(case.a[i])) * r for i, r in zip(keep, self.root)]
        self.b = [arb(float(case.b[i])) * r for i, r in zip(keep, self.root)]
        self.c = [arb(float(case.c[i])) for i in keep]
        self.c_min = arb(float(min(case.c[i] for i in keep)))
        self.data = arb_mat([[arb(float(v)) * r / s for v, s in zip(case.values[i], self.scale)]
                             for i, r in zip(keep, self.root)])
        self.total = sum((d * d for d in self.data.entries()), arb(0))
        self.low, self.high = self.domain(floor)

    def domain(self, floor):
        """theta of the options' range, less the lobes that the result says are outside of the model; None: all are."""
        if floor is None:
            return None, None
        if by_exponent(self.case.distribution):
            low, high = (arb(v).log() for v in EXPONENT_RANGE)
        else:
            low, high = (-2 * arb(v).log() for v in reversed(SIGMA_RANGE))
        return point(low), point(high.min(-2 * arb(floor).log()))

    def clip(self, theta):
        return [point(t.max(self.low).min(self.high)) for t in theta]

    def lobe(self, theta):
        """The column and its derivative by theta, both without the scalar lambda(s)."""
        s = theta.exp()
        products = [c * s for c in self.c]
        if self.case.distribution == "ggx":
            g = [b / (1 + p) ** 2 for b, p in zip(self.b, products)]
            return g, [-2 * v * p / (1 + p) for v, p in zip(g, products)]
        low = self.c_min * s
        g = [b * (low - p).exp() for b, p in zip(self.b, products)]
        return g, [-v * p for v, p in zip(g, products)]

    def hessian(self, model, gradient, free):
        rows = []
        for p in free:
            moved = list(model.theta)
            moved[p] = moved[p] + STEP
            other = Model(self, moved).gradient()
            rows.append([point((other[q] - gradient[q]) / STEP) for q in free])
        return rows

    def newton_step(self, model, gradient):
        """Step of theta, and the curvature (smallest eigenvalue of the Hessian over what may move)."""
        free = [p for p in range(self.lobes) if gradient[p] != 0 and
                not (gradient[p] > 0 and model.theta[p] <= self.low) and
                not (gradient[p] < 0 and model.theta[p] >= self.high)]
        step = [arb(0)] * self.lobes
        if not free:
            return step, None
        h = self.hessian(model, gradient, free)
        small = h[0][0]
        if len(free) == 2:
            middle, off = (h[0][0] + h[1][1]) / 2, (h[0][1] + h[1][0]) / 2
            small = point(middle - (((h[0][0] - h[1][1]) / 2) ** 2 + off ** 2).sqrt())
        lift = arb(0) if small > 0 else 2 * abs(small) + arb(2) ** -300
        if len(free) == 1:
            moves = [-gradient[free[0]] / (h[0][0] + lift)]
        else:
            a, b, d = h[0][0] + lift, off, h[1][1] + lift
            u, v = (gradient[p] for p in free)
            moves = [-(d * u - b * v) / (a * d - b * b), -(a * v - b * u) / (a * d - b * b)]
        for p, move in zip(free, moves):
            step[p] = point(move) if move.is_finite() else -gradient[p]
        longest = max(abs(s) for s in step)
        if longest > 1:
            step = [point(s / longest) for s in step]
        return step, small

    def polish(self, theta):
        model, curvature = Model(self, self.clip(theta)), None
        for _ in range(NEWTON):
            step, curvature = self.newton_step(model, model.gradient())
            factor = arb(1)
            for _ in range(30):
                moved = self.clip([t + factor * s for t, s in zip(model.theta, step)])
                other = Model(self, moved)
                if other.e2.mid() < model.e2.mid():
                    break
                factor /= 4
            else:
                break
            size = max(abs(p - q) for p, q in zip(moved, model.theta))
            model = other
            if size < arb(10) ** -40:
                break
        return model, curvature

    def given(self, sigma, x, y):
        """E^2 of a model as the library returns it, doubles and all."""
        rows = []
        lobes = []
        for value in sigma:
            s = 1 / arb(value) ** 2
            factor = (s + 2) / (2 * arb.pi()) if by_exponent(self.case.distribution) else s
            if self.case.distribution == "ggx":
                lobes.append([b * factor / (1 + c * s) ** 2 for b, c in zip(self.b, self.c)])
            else:
                lobes.append([b * factor * (-c * s).exp() for b, c in zip(self.b, self.c)])
        for k in range(self.channels):
            for i, a in enumerate(self.a):
                fitted = a * arb(x[k]) + sum((arb(y[k * self.lobes + p]) * g[i] for p, g in enumerate(lobes)), arb(0))
                rows.append(self.data[i, k] - fitted / self.scale[k])
        return sum((r * r for r in rows), arb(0))

    def physical(self, model):
        """x and y of a model in the data's units, y in the library's scaling."""
        x = [float((model.z[k][0] * self.scale[k]).mid()) for k in range(self.channels)]
        y = []
        for k in range(self.channels):
            for p, theta in enumerate(model.theta):
                y.append(float((model.z[k][1 + p] * self.scale[k] / self.factor(theta)).mid()))
        return x, y

    def factor(self, theta):
        """What the library's y multiplies beside the column of lobe()."""
        s = theta.exp()
        factor = (s + 2) / (2 * arb.pi()) if by_exponent(self.case.distribution) else s
        if self.case.distribution != "ggx":
            factor *= (-self.c_min * s).exp()
        return factor

    def coefficient_error(self, model, x, y):
        """Largest difference of a term's length from the best one, relative to the data's; its unit; and k.

        The unit is what least squares may lose by rounding: u (k + k^2 |r| / |I|), k the condition of the columns, and
        2 c_min s u, what exp(-c_min s) in y changes by when sigma is rounded to a double.
        """
        error, factors = arb(0), [arb(1), *(self.factor(t) for t in model.theta)]
        lengths = [sum((v * v for v in column), arb(0)).sqrt() for column in model.columns]
        for k in range(self.channels):
            size = sum((self.data[i, k] * self.data[i, k] for i in range(len(self.a))), arb(0)).sqrt()
            mine = [x[k], *y[k * self.lobes:(k + 1) * self.lobes]]
            for j, length in enumerate(lengths):
                if size > 0:
                    error = error.max(abs(arb(mine[j]) * factors[j] / self.scale[k] - model.z[k][j]) * length / size)
        used = [j for j, own in enumerate([x, *(y[p::self.lobes] for p in range(self.lobes))])
                if lengths[j] > 0 and (any(z[j] > 0 for z in model.z) or any(v > 0 for v in own))]
        if not used:
            return float(error), None, 1.0
        with mpmath.workdps(100):
            gram = mpmath.matrix([[mpmath.mpf((model.gram[i, j] / (lengths[i] * lengths[j])).str(90, radius=False))
                                   for j in used] for i in used])
            least = max(min(mpmath.eigsy(gram, eigvals_only=True)), mpmath.mpf(10) ** -60)
        condition = float(1 / mpmath.sqrt(least))
        share = float((model.e2.mid() / self.total).sqrt()) if self.total > 0 else 0.0
        exponent = 2 * max(float(self.c_min * t.exp()) for t in model.theta)
        return float(error), 2.0 ** -53 * (condition + condition ** 2 * share + exponent), condition

    # ---- Second opinion ----------------------------------------------------------------------------------------------

    def again(self, theta):
        """E^2 at theta in 50-digit mpmath: other exponentials, other arithmetic, orthogonalised columns."""
        with mpmath.workdps(50):
            def mp(ball):
                man, exp = ball.mid().man_exp()
                return mpmath.ldexp(mpmath.mpf(int(man)), int(exp))

            s = [mpmath.exp(mp(t)) for t in theta]
            columns, least = [[mp(v) for v in self.a]], min(mp(c) for c in self.c)
            for one in s:
                columns.append([mp(b) * ((1 + mp(c) * one) ** -2 if self.case.distribution == "ggx" else
                                         mpmath.exp((least - mp(c)) * one)) for b, c in zip(self.b, self.c)])
            total = mpmath.mpf(0)
            for k in range(self.channels):
                data = [mp(self.data[i, k]) for i in range(len(self.a))]
                total += min(v for size in range(len(columns) + 1)
                             for support in itertools.combinations(range(len(columns)), size)
                             for v in [left_over([columns[j] for j in support], data)] if v is not None)
            return total

    # ---- Scan --------------------------------------------------------------------------------------------------------

    def starts(self):
        """Local minima of E^2 on a grid over the part of the domain where a lobe changes, in double precision."""
        case, keep = self.case, self.keep
        c = case.c[keep]
        spread = c[c > c.min()] - c.min() if (c > c.min()).any() else np.array([1.0])
        low = max(float(self.low), -np.log(max(c.max(), 1e-290)) - 8)
        high = min(float(self.high), -np.log(spread.min()) + (12 if case.distribution == "ggx" else 4.5))
        if not low < high:
            return [[self.low] * self.lobes, [self.high] * self.lobes]
        grid = np.unique(np.concatenate([[float(self.low)], np.linspace(low, high, SCAN[self.lobes]), [float(self.high)]]))
        root = np.array([float(r) for r in self.root])
        root /= root.max()

        def unit(v):
            return v / max(np.linalg.norm(v), 1e-300)

        a = unit(case.a[keep] / max(case.a[keep].max(), 1e-300) * root)
        b = case.b[keep] / max(case.b[keep].max(), 1e-300) * root
        g = np.array([unit(b * shape(case.distribution, c - c.min(), np.exp(t)) if case.distribution != "ggx" else
                           b * shape("ggx", c, np.exp(t)) * min(1 + c.min() * np.exp(t), 1e150) ** 2) for t in grid])
        data = case.values[keep] / np.abs(case.values[keep]).max(0).clip(1e-300) * root[:, None]
        value = scan(a, g, data, self.lobes)
        order = np.argsort(value, axis=None)
        places = [np.unravel_index(i, value.shape) for i in order[:4000]]
        chosen = []
        for place in places:
            around = tuple(slice(max(i - 1, 0), i + 2) for i in place)
            if value[place] <= value[around].min() and np.isfinite(value[place]):
                chosen.append([arb(float(grid[i])) for i in place])
            if len(chosen) == 4:
                break
        return chosen


def left_over(columns, data):
    """Squared distance of the data from the span, None if a coefficient is negative or the columns are dependent."""
    basis, upper, rest = [], [], list(data)

    def dot(p, q):
        return mpmath.fsum(u * v for u, v in zip(p, q))

    projections = []
    for column in columns:
        v, row = list(column), []
        for q in basis:
            t = dot(q, v)
            row.append(t)
            v = [x - t * y for x, y in zip(v, q)]
        length = mpmath.sqrt(dot(v, v))
        if length <= mpmath.mpf(10) ** -45 * mpmath.sqrt(dot(column, column)):
            return None
        basis.append([x / length for x in v])
        upper.append([*row, length])
        t = dot(basis[-1], rest)
        projections.append(t)
        rest = [x - t * y for x, y in zip(rest, basis[-1])]
    z = [mpmath.mpf(0)] * len(columns)
    for j in reversed(range(len(columns))):
        z[j] = (projections[j] - sum(upper[i][j] * z[i] for i in range(j + 1, len(columns)))) / upper[j][j]
    return dot(rest, rest) if all(v >= 0 for v in z) else None


def scan(a, g, data, lobes):
    """E^2 on the grid (pairs for two lobes, upper triangle) by enumeration of supports of normalised columns."""
    n = len(g)
    w, t, kappa = a @ data, g @ data, g @ a  # K, n x K, n
    gain = np.maximum(w, 0)[None, :] ** 2
    single = np.maximum(t, 0) ** 2
    if lobes == 1:
        best = np.maximum(np.maximum(gain, single), pair_gain(w[None, :], t, kappa[:, None]))
        return (data ** 2).sum() - best.sum(1)
    mu = g @ g.T
    value = np.full((n, n), np.inf)
    with_a = np.maximum(np.maximum(gain, single), pair_gain(w[None, :], t, kappa[:, None]))
    for i in range(n):
        j = np.arange(i, n)
        best = np.maximum(with_a[i], with_a[j])
        best = np.maximum(best, pair_gain(t[i][None, :], t[j], mu[i, j][:, None]))
        m = np.empty((len(j), 3, 3))
        m[:] = np.eye(3)
        m[:, 0, 1] = m[:, 1, 0] = kappa[i]
        m[:, 0, 2] = m[:, 2, 0] = kappa[j]
        m[:, 1, 2] = m[:, 2, 1] = mu[i, j]
        usable = np.linalg.det(m) > 1e-12
        if usable.any():
            right = np.stack([np.broadcast_to(w, t[j].shape), np.broadcast_to(t[i], t[j].shape), t[j]], 1)[usable]
            z = np.linalg.solve(m[usable], right)
            best[usable] = np.maximum(best[usable], np.where((z > 0).all(1), (z * right).sum(1), 0))
        value[i, j] = (data ** 2).sum() - best.sum(1)
    return value


def pair_gain(u, v, kappa):
    new = np.maximum(1 - kappa ** 2, 1e-12)
    inside = (u - kappa * v > 0) & (v - kappa * u > 0) & (1 - kappa ** 2 > 1e-12)
    return np.where(inside, u ** 2 + (v - kappa * u) ** 2 / new, 0)
