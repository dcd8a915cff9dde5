"""What Python costs: brdffit.fit_map and brdffit.fit against the same calls of the library from C.

    python_overhead.py DIRECT.so [--size N] [--lobes 1|2] [--threads N] [--repeat N] [--csv]

A stack of 84 x N x N x 3 float32 with smooth parameters and 2 % noise is made in memory. Then, in turn, in one process
and on that memory: C (tools/bench/python_direct.c: plan, results, threads that take tiles of the same size) and
brdffit.fit_map; medians, by the clock and by processor time, and the median of the ratios of neighbours. The same for
one texel's fit. Both sides must find the same E^2, or this ends with exit code 1. SPDX-License-Identifier: MIT
"""
import argparse
import ctypes
import os
import statistics
import sys
import time

import numpy as np

import brdffit
from brdffit.maps import batch


class DirectMap(ctypes.Structure):
    _fields_ = [("values", ctypes.c_void_p), ("light", ctypes.c_void_p), ("view", ctypes.c_void_p),
                ("samples", ctypes.c_size_t), ("texels", ctypes.c_size_t), ("channels", ctypes.c_size_t),
                ("lobes", ctypes.c_int), ("threads", ctypes.c_int), ("tile", ctypes.c_size_t)]


def make_stack(size, light, view, seed=1):
    """BRDF values as a camera sees them: diffuse and one lobe of 64 roughnesses, both varying over the image."""
    import dataclasses

    random = np.random.default_rng(seed)
    fit = brdffit.fit(brdffit.Samples.example())
    diffuse = dataclasses.replace(fit, x=np.ones(1), y=np.zeros((1, 1)), channels=("",)).predict(light, view)
    lobes = [dataclasses.replace(fit, sigma=np.array([s]), x=np.zeros(1), y=np.ones((1, 1)), channels=("",)).predict(
        light, view) for s in np.geomspace(0.08, 0.5, 64)]
    lobes = np.array(lobes)[..., 0].T  # samples x 64
    u, v = np.meshgrid(np.linspace(0, 1, size), np.linspace(0, 1, size))
    which = np.minimum(63, (64 * (0.5 + 0.5 * np.sin(6 * u + 4 * v))).astype(int))
    x = (0.05 + 0.3 * v)[..., None] * [1, 0.8, 0.6]
    y = (0.02 + 0.05 * u)[..., None] * [1, 1, 0.9]
    stack = np.empty((len(light), size, size, 3), np.float32)
    for i in range(len(light)):
        stack[i] = diffuse[i] * x + lobes[i, which][..., None] * y
        stack[i] *= 1 + 0.02 * random.standard_normal(stack[i].shape, np.float32)
    return stack


def measure(direct, ours, repeat):
    """Pairs in turn: seconds by the clock and of the processor, for each side."""
    direct(), ours()  # pages, caches, and what is made once
    rows = []
    for _ in range(repeat):
        row = []
        for side in (direct, ours):
            clock, processor = time.perf_counter(), time.process_time()
            side()
            row += [time.perf_counter() - clock, time.process_time() - processor]
        rows.append(row)
    return rows


def report(name, rows, unit, scale, csv):
    middle = [statistics.median(column) * scale for column in zip(*rows)]
    clock, processor = (statistics.median(row[2 + i] / row[i] for row in rows) for i in (0, 1))
    if csv:
        print("%s,%.9g,%.9g,%.9g,%.9g,%.6g,%.6g" % (name, *(middle[i] / scale for i in (0, 2, 1, 3)), clock, processor))
        return
    print("%s" % name)
    for i, word in ((0, "clock"), (1, "processor")):
        print("  %-9s  C %9.4g %s   Python %9.4g %s   ratio of neighbours, median: %+.2f %%" % (
            word, middle[i], unit, middle[2 + i], unit, 100 * ((clock, processor)[i] - 1)))


def maps(library, arguments, light, view):
    stack = make_stack(arguments.size, light, view)
    tile = batch.default_tile(brdffit.Options(lobes=arguments.lobes))
    given = DirectMap(stack.ctypes.data, light.ctypes.data, view.ctypes.data, len(light), arguments.size ** 2, 3,
                      arguments.lobes, arguments.threads, tile)
    found = {}

    def direct():
        total = ctypes.c_double()
        if library.direct_fit_map(ctypes.byref(given), ctypes.byref(total)) != 1:
            sys.exit("the call from C failed")
        found["C"] = total.value

    def ours():
        e2 = brdffit.fit_map(stack, light, view, lobes=arguments.lobes, threads=arguments.threads, tile=tile).e2
        # C adds them up one after the other, too.
        found["Python"] = float(np.add.accumulate(e2.reshape(-1))[-1])

    rows = measure(direct, ours, arguments.repeat)
    report("fit_map, %d x %d texels, lobes %d, threads %d" % (arguments.size, arguments.size, arguments.lobes,
                                                             arguments.threads), rows, "s", 1, arguments.csv)
    return found["C"] == found["Python"], stack[:, 0, 0].astype(float)


def singles(library, arguments, light, view, values):
    samples = brdffit.Samples.from_arrays(light, view, values)
    struct, found, times = samples._struct(), {}, arguments.times

    def direct():
        e2 = ctypes.c_double()
        if library.direct_fit(ctypes.byref(struct), arguments.lobes, times, ctypes.byref(e2)) != 1:
            sys.exit("the call from C failed")
        found["C"] = e2.value

    def ours():
        for _ in range(times):
            found["Python"] = brdffit.fit(samples, lobes=arguments.lobes).e2

    rows = measure(direct, ours, arguments.repeat)
    report("fit, one texel, lobes %d" % arguments.lobes, rows, "us", 1e6 / times, arguments.csv)
    return found["C"] == found["Python"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("direct", help="the library of python_direct.c")
    parser.add_argument("--size", type=int, default=512, help="texels a side")
    parser.add_argument("--lobes", type=int, default=1, choices=(1, 2))
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--repeat", type=int, default=9)
    parser.add_argument("--times", type=int, default=500, help="single fits a measurement")
    parser.add_argument("--csv", action="store_true", help="name, seconds by the clock (C, Python), of the processor, ratios")
    arguments = parser.parse_args()
    library = ctypes.CDLL(os.path.abspath(arguments.direct))
    light, view = brdffit.protocol84()
    same_maps, values = maps(library, arguments, light, view)
    same_fits = singles(library, arguments, light, view, values)
    if not (same_maps and same_fits):
        sys.exit("C and Python found other errors")


if __name__ == "__main__":
    main()
