"""The figures of `make bench`: run time against error, as SVG and PNG. Needs matplotlib. SPDX-License-Identifier: MIT"""
import math

import bench_arithmetic as a
from figure_style import plt, save

# Method -> label, colour, marker, line. Ours in black and grey; local solvers warm; NLopt blue; SciPy green and purple.
STYLE = {
    "moment": ("brdffit, moment (gap)", "#000000", "o", "-"),
    "socp": ("brdffit, socp (box width)", "#777777", "s", "-"),
    "grid": ("brute force (step)", "#E69F00", "v", "-"),
    "levmar": ("levmar (starts)", "#D55E00", "^", "-"),
    "levmar-box": ("levmar in a box (starts)", "#D55E00", "x", "--"),
    "ceres": ("Ceres (starts)", "#CC79A7", "^", "-"),
    "varpro": ("variable projection (starts)", "#882255", "*", "-"),
    "recursive": ("recursive multi-start (starts a round)", "#999933", "h", "-"),
    "recursive-box": ("recursive multi-start in a box", "#999933", "x", "--"),
    "nlopt-direct-l": ("NLopt DIRECT-L (evaluations)", "#0072B2", "D", "-"),
    "nlopt-mlsl": ("NLopt MLSL (evaluations)", "#0072B2", "x", "--"),
    "nlopt-stogo": ("NLopt StoGO (evaluations)", "#56B4E9", "D", "-"),
    "nlopt-crs": ("NLopt CRS (evaluations)", "#56B4E9", "x", "--"),
    "scipy-direct": ("SciPy direct", "#009E73", "P", "-"),
    "scipy-shgo": ("SciPy shgo", "#009E73", "x", "--"),
    "scipy-dual-annealing": ("SciPy dual annealing", "#8A5FBF", "P", "-"),
    "scipy-differential-evolution": ("SciPy differential evolution", "#8A5FBF", "x", "--"),
}


def draw_panel(axes, found, name, lobes, measure):
    """One line a method. Errors below the certificate's own are on the floor, infinite ones are left out."""
    lines = {}
    for method, (label, colour, marker, line) in STYLE.items():
        points = found.get((name, str(lobes), method), [])
        shown = [(p.seconds, max(getattr(p, measure), a.FLOOR)) for p in points if math.isfinite(getattr(p, measure))]
        if shown:
            ours = method == "moment"
            lines[label], = axes.plot(*zip(*shown), color=colour, marker=marker, ls=line, ms=6 if ours else 3.5,
                                      lw=2.4 if ours else 1.0, zorder=4 if ours else 2)
    axes.set(xscale="log", yscale="log")
    axes.set_ylim(0.3 * a.FLOOR, 30)
    return lines


def overview(out, found, files):
    """All files: median and worst error, one and two lobes."""
    figure, grid = plt.subplots(2, 2, figsize=(10.5, 7.6), sharey=True)
    lines = {}
    for row, lobes in enumerate((1, 2)):
        for column, measure in enumerate(("median", "worst")):
            axes = grid[row][column]
            lines |= draw_panel(axes, found, "all", lobes, measure)
            axes.set_title(f"{lobes} lobe{'s' * (lobes > 1)}, {measure} of {files} files")
            axes.set_xlabel("seconds a file (median)")
        grid[row][0].set_ylabel("(E − E*) / E*")
    figure.legend(lines.values(), lines.keys(), loc="outside lower center", ncols=4, fontsize=8)
    save(figure, out, "bench")


def by_set(out, found, names):
    """Worst error of each data set."""
    figure, grid = plt.subplots(2, len(names), figsize=(2.9 * len(names) + 0.5, 6.2), sharey=True, squeeze=False)
    lines = {}
    for column, name in enumerate(names):
        for row, lobes in enumerate((1, 2)):
            axes = grid[row][column]
            lines |= draw_panel(axes, found, name, lobes, "worst")
            axes.set_title(f"{name}, {lobes} lobe{'s' * (lobes > 1)}, worst", fontsize=8)
            axes.set_xlabel("seconds a file")
    for row in (0, 1):
        grid[row][0].set_ylabel("(E − E*) / E*")
    figure.legend(lines.values(), lines.keys(), loc="outside lower center", ncols=7, fontsize=8)
    save(figure, out, "bench_sets")


def scaling(out, panels):
    """panels: (title, x label, {label: [(x, seconds)]})."""
    figure, grid = plt.subplots(1, len(panels), figsize=(3.6 * len(panels), 3.2), squeeze=False)
    for axes, (title, label, series) in zip(grid[0], panels):
        for name, points in series.items():
            axes.plot(*zip(*points), marker="o", ms=3.5, lw=1.2, label=name)
        axes.set(xscale="log", yscale="log", title=title, xlabel=label)
        axes.legend(fontsize=7)
    grid[0][0].set_ylabel("seconds a fit")
    save(figure, out, "bench_costs")
