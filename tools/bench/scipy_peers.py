"""SciPy's global optimisers on the reduced problem, as methods of the benchmark.

The objective is the compiled one that NLopt gets (tools/bench/curves_reduced.c, through ctypes), so that Python's part
is SciPy's own; numpy_objective() is the plain vectorised alternative, timed beside it. Seconds are processor time.

Settings, the best of those tried (each with and without the other): u = ln sigma in [1e-3, 6] instead of sigma itself;
local searches by L-BFGS-B with the analytic gradient, after the global part where SciPy has none inside. direct: locally
biased, no tolerances. shgo: Sobol points instead of simplices, which find fewer minima. dual_annealing: as it is, with the
gradient. differential_evolution: whole generations in one call (vectorized), tol 0. SPDX-License-Identifier: MIT
"""
import ctypes
import math
import statistics
import time

import numpy
from scipy import optimize

LOW, HIGH = math.log(1e-3), math.log(6.0)
DOUBLE_2 = ctypes.c_double * 2


class Reduced:
    """E2 over u = ln sigma of one file, compiled."""

    def __init__(self, library, path, lobes):
        self.library = ctypes.CDLL(str(library))
        self.library.curves_reduced_open.restype = ctypes.c_void_p
        for name in ("one", "two", "value", "judge"):
            getattr(self.library, f"curves_reduced_{name}").restype = ctypes.c_double
        self.library.curves_reduced_one.argtypes = [ctypes.c_void_p, ctypes.c_double]
        self.library.curves_reduced_two.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double]
        self.library.curves_reduced_value.argtypes = [ctypes.c_void_p, ctypes.c_int, DOUBLE_2, DOUBLE_2]
        self.library.curves_reduced_batch.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_size_t, ctypes.c_void_p,
                                                      ctypes.c_void_p]
        self.library.curves_reduced_judge.argtypes = [ctypes.c_char_p, ctypes.c_int, DOUBLE_2]
        self.library.curves_reduced_close.argtypes = [ctypes.c_void_p]
        self.path, self.lobes = str(path).encode(), lobes
        self.handle = self.library.curves_reduced_open(self.path)
        if not self.handle:
            raise ValueError(f"{path}: not a file that the peers read")
        self.at, self.slope = DOUBLE_2(), DOUBLE_2()
        self.value = self.one if lobes == 1 else self.two

    def close(self):
        self.library.curves_reduced_close(self.handle)

    def one(self, u):
        return self.library.curves_reduced_one(self.handle, u[0])

    def two(self, u):
        return self.library.curves_reduced_two(self.handle, u[0], u[1])

    def gradient(self, u):
        self.value_and_gradient(u)
        return numpy.array(self.slope[: self.lobes])

    def value_and_gradient(self, u):
        self.at[: self.lobes] = u[: self.lobes]
        e2 = self.library.curves_reduced_value(self.handle, self.lobes, self.at, self.slope)
        return e2, numpy.array(self.slope[: self.lobes])

    def batch(self, u):
        """u: lobes x points, as differential_evolution hands it over."""
        points = numpy.ascontiguousarray(u.T)
        e2 = numpy.empty(len(points))
        self.library.curves_reduced_batch(self.handle, self.lobes, len(points), points.ctypes.data, e2.ctypes.data)
        return e2

    def judge(self, u):
        """E2 from the residuals of the samples, in long double."""
        return self.library.curves_reduced_judge(self.path, self.lobes, DOUBLE_2(*u))


LOCAL = {"method": "L-BFGS-B", "bounds": None, "options": {"ftol": 1e-15, "gtol": 1e-12}}


def polished(problem, u):
    local = LOCAL | {"bounds": [(LOW, HIGH)] * problem.lobes}
    found = optimize.minimize(problem.value_and_gradient, u, jac=True, **local)
    return found.x if found.fun < problem.value(u) else u


def direct(problem, evaluations):
    found = optimize.direct(problem.value, [(LOW, HIGH)] * problem.lobes, maxfun=evaluations, maxiter=evaluations, vol_tol=0.0,
                            len_tol=0.0, locally_biased=True)
    return polished(problem, found.x), found.nfev


def shgo(problem, points):
    bounds = [(LOW, HIGH)] * problem.lobes
    local = LOCAL | {"bounds": bounds, "jac": problem.gradient}
    found = optimize.shgo(problem.value, bounds, n=points, iters=1, sampling_method="sobol", minimizer_kwargs=local,
                          options={"jac": problem.gradient})
    return (found.x if found.x is not None else numpy.full(problem.lobes, 0.5 * (LOW + HIGH))), found.nfev


def dual_annealing(problem, iterations):
    bounds = [(LOW, HIGH)] * problem.lobes
    local = LOCAL | {"bounds": bounds, "jac": problem.gradient}
    found = optimize.dual_annealing(problem.value, bounds, maxiter=iterations, rng=1, minimizer_kwargs=local)
    return found.x, found.nfev


def differential_evolution(problem, generations):
    found = optimize.differential_evolution(problem.batch, [(LOW, HIGH)] * problem.lobes, maxiter=generations, tol=0.0,
                                            rng=1, vectorized=True, updating="deferred", polish=False)
    return polished(problem, found.x), found.nfev


METHODS = {
    "scipy-direct": (direct, (20, 50, 100, 200, 500, 1000, 2000)),
    "scipy-shgo": (shgo, (8, 16, 32, 64, 128, 256)),
    "scipy-dual-annealing": (dual_annealing, (5, 10, 20, 50, 100, 200, 500)),
    "scipy-differential-evolution": (differential_evolution, (2, 5, 10, 20, 50, 100)),
}


def rows(library, path, name, lobes, digest, quick, repeat=3):
    """One row per method and knob, as build/curves prints them."""
    problem = Reduced(library, path, lobes)
    found = []
    shgo(problem, 8)  # SciPy prepares its Sobol numbers once a process
    for method, (run, knobs) in METHODS.items():
        for knob in knobs[::2] if quick else knobs:
            seconds = []
            for _ in range(1 if quick else repeat):
                begun = time.thread_time()
                u, evaluations = run(problem, knob)
                seconds.append(time.thread_time() - begun)
                if seconds[-1] > 0.03:
                    break
            found.append({"method": method, "knob": str(knob), "set": name[0], "file": name[1], "data": digest,
                          "lobes": str(lobes), "seconds": f"{statistics.median(seconds):.9g}",
                          "search": f"{statistics.median(seconds):.9g}", "e2": repr(problem.judge(u)), "lower_bound": "0",
                          "certified": "0", "work": str(evaluations), "nodes": "0", "sum_of_squares": ""})
    problem.close()
    return found


# ---- What an evaluation costs -----------------------------------------------------------------------------------------


class NumpyReduced:
    """The same function in numpy, vectorised over samples and channels: one lobe, one point a call."""

    def __init__(self, a, b, c, values):
        self.b2, self.ab, self.c = b * b, a * b, c - c.min()
        self.ib = values * b[:, None]
        self.norm_a = math.sqrt(a @ a)
        self.omega = values.T @ a / self.norm_a
        self.total = (values * values).sum()

    def value(self, u):
        e = numpy.exp(self.c * -math.exp(-2.0 * u[0]))
        norm = math.sqrt(self.b2 @ (e * e))
        kappa = self.ab @ e / (norm * self.norm_a)
        tau, omega = e @ self.ib / norm, self.omega
        both = omega * omega + (tau - kappa * omega) ** 2 / (1.0 - kappa * kappa)
        single = numpy.maximum(numpy.maximum(omega, 0.0) ** 2, numpy.maximum(tau, 0.0) ** 2)
        inside = (omega > kappa * tau) & (tau > kappa * omega)
        return self.total - numpy.where(inside, both, single).sum()


def cost(function, calls):
    begun = time.thread_time()
    for _ in range(calls):
        function()
    return (time.thread_time() - begun) / calls


def evaluation_costs(library, path):
    """Seconds an evaluation, by "where, lobes"; in numpy with the samples as they are, in C with equal c merged."""
    found = {}
    for lobes in (1, 2):
        problem = Reduced(library, path, lobes)
        u = numpy.tile(numpy.array([-2.0, -1.0][:lobes])[:, None], 10000)
        found[f"C, {lobes}"] = cost(lambda p=problem, u=u: p.batch(u), 3) / 10000
        found[f"ctypes, {lobes}"] = cost(lambda p=problem: p.value((-2.0, -1.0)), 20000)
        problem.close()
    draw = numpy.random.default_rng(1)
    table = draw.random((84, 6))
    plain = NumpyReduced(table[:, 0], table[:, 1], table[:, 2], table[:, 3:])
    found["numpy, 1"] = cost(lambda: plain.value((-2.0,)), 3000)
    return found
