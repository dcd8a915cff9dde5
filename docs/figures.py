"""Figures of "How the proof works", and the numbers that its text quotes: all of them come from the library as the page is
built. What the page claims of them is asserted here, so that a figure that no longer shows it ends the build.

SPDX-License-Identifier: MIT
"""
import itertools
import json

import matplotlib
import numpy as np
from matplotlib.collections import PolyCollection

import brdffit

matplotlib.use("svg")
import matplotlib.pyplot as plt

ENGINES = ("socp", "moment")
TITLES = {"socp": "first order (engine socp)", "moment": "second order (engine moment)"}
COLOURS = {"socp": "C1", "moment": "C0"}


def profile(samples, sigma):
    """Smallest E² with one lobe at each roughness: a search whose range is that one value."""
    return np.array([brdffit.fit(samples, lobes=1, sigma_range=(s, s)).e2 for s in sigma])


def finish(figure, folder, name):
    figure.savefig(folder / (name + ".svg"), metadata={"Date": None})
    plt.close(figure)


def noisy():
    """The paper's 84 directions, and the example's material with 5 % noise: data with a false valley."""
    light, view = brdffit.protocol84()
    truth = brdffit.fit(brdffit.Samples.example(), lobes=2).predict(light, view)
    return brdffit.Samples.from_arrays(light, view, truth * np.exp(0.05 * np.random.default_rng(3).standard_normal((84, 3))))


# ---- What remains when the coefficients are gone --------------------------------


def columns(samples, sigma):
    """Radiance of the diffuse term and of a lobe of each roughness, with coefficient 1, at the samples that a fit uses; the
    data there, in units of the fit's channel_scale."""
    one = brdffit.fit(samples, lobes=1)
    used = (samples.light[:, 2] >= 0.5 - 1e-12) & (samples.view[:, 2] > 0)

    def column(s, x, y):
        model = brdffit.Fit.from_dict({**one.to_dict(), "sigma": [float(s)], "x": [x], "y": [[y]], "channels": ["one"]})
        return model.predict(samples.light, samples.view, quantity="radiance")[used, 0]

    data = (samples.values * samples.light[:, 2:])[used] / one.channel_scale
    return np.stack([column(1, 1.0, 0.0), *(column(s, 0.0, 1.0) for s in sigma)], 1), data


def surface(samples, sigma):
    """Smallest E² at each pair of roughness, by trying each set of positive coefficients: shares nothing with the search."""
    matrix, data = columns(samples, sigma)
    matrix = matrix / np.linalg.norm(matrix, axis=0)
    gram, right = matrix.T @ matrix, matrix.T @ data
    i, j = np.meshgrid(np.arange(len(sigma)), np.arange(len(sigma)), indexing="ij")
    index = np.stack([0 * i, 1 + i, 1 + j], -1)
    out = np.full(i.shape, np.sum(data * data))
    for k in range(data.shape[1]):
        best = np.zeros(i.shape)
        for support in (s for count in (1, 2, 3) for s in itertools.combinations(range(3), count)):
            chosen = index[..., list(support)]
            # Two equal columns: a smaller support holds the answer, this one must only not divide by zero.
            square = gram[chosen[..., :, None], chosen[..., None, :]] + 1e-13 * np.eye(len(support))
            t = right[chosen, k]
            z = np.linalg.solve(square, t[..., None])[..., 0]
            best = np.where((z >= 0).all(-1), np.maximum(best, (z * t).sum(-1)), best)
        out -= best
    return out


def valleys(height):
    """Indices of the points of a grid that are lower than all of their neighbours, i <= j."""
    n = len(height)
    padded = np.pad(height, 1, constant_values=np.inf)
    low = np.triu(np.ones(height.shape, bool))
    for a, b in itertools.product((0, 1, 2), repeat=2):
        if (a, b) != (1, 1):
            low &= height < padded[a:a + n, b:b + n]
    return np.argwhere(low)


def projection(samples, folder):
    best = brdffit.fit(samples, lobes=1)
    matrix, data = columns(samples, best.sigma)
    scale = best.channel_scale[0]
    figure, (left, right) = plt.subplots(1, 2, figsize=(5.2, 2.9))
    x, y = np.meshgrid(np.linspace(0, 2 * best.x[0], 90), np.linspace(0, 2 * best.y[0, 0], 90))
    model = (matrix[:, 0, None, None] * x + matrix[:, 1, None, None] * y) / scale
    squares = np.sum((data[:, 0, None, None] - model) ** 2, 0)
    left.contour(x, y, squares, levels=squares.min() * np.array([1.1, 2, 4, 8, 16, 32]), linewidths=1.2)
    left.plot(best.x[0], best.y[0, 0], "o", color="C1")
    left.set(xlabel="diffuse x", ylabel="specular y", title="σ held: a bowl")
    sigma = np.geomspace(0.02, 6, 160)
    right.semilogx(sigma, profile(samples, sigma))
    right.plot(best.sigma, [best.e2], "o", color="C1")
    right.set(xlabel="roughness σ", ylabel="smallest E²", title="x, y eliminated: no bowl", ylim=(0, None))
    finish(figure, folder, "projection")


def landscape(samples, found, folder):
    sigma = np.geomspace(0.01, 6, 200)
    height = surface(samples, sigma)
    one, two = np.meshgrid(sigma, sigma, indexing="ij")
    fit, boxes = found["moment"]
    for engine, every in zip(ENGINES, (7, 1)):  # of the many boxes, fewer points
        there = found[engine][1].bound_at(one[::every, ::every], two[::every, ::every])
        assert np.all(there <= height[::every, ::every]), "a bound above the truth"
    assert height.min() >= fit.lower_bound
    false = min((height[i, j], sigma[i], sigma[j]) for i, j in valleys(height) if sigma[j] < 0.2)
    figure, axis = plt.subplots(figsize=(5.2, 4.4))
    shown = np.ma.masked_where(one > two, np.log10(height / fit.e2))
    mesh = axis.pcolormesh(one, two, shown, cmap="viridis_r", rasterized=True)
    axis.contour(one, two, shown, levels=np.arange(0.1, 2.6, 0.2), colors="k", linewidths=0.4, alpha=0.6)
    axis.plot(*fit.sigma, "o", color="w", markeredgecolor="k", markersize=7, label="optimum")
    axis.plot(false[1], false[2], "X", color="w", markeredgecolor="k", markersize=8, label="false valley")
    axis.legend(loc="lower right")
    axis.set(xscale="log", yscale="log", xlabel="σ of the narrower lobe", ylabel="σ of the wider lobe")
    axis.grid(False)
    figure.colorbar(mesh, label="log₁₀ of E² / optimum").outline.set_visible(False)
    finish(figure, folder, "landscape")
    return {"false_ratio": "%.1f" % (false[0] / fit.e2), "false_narrow": "%.2g" % false[1], "false_wide": "%.2g" % false[2]}


# ---- Bounds, level by level -----------------------------------------------------


def steps(boxes, depth, low, high):
    """Edges, and the bound between each two, of the smallest boxes of at most this level."""
    keep = boxes.level <= depth
    lows, highs, bounds, levels = (array[keep] for array in (boxes.sigma_low[:, 0], boxes.sigma_high[:, 0], boxes.lower_bound,
                                                             boxes.level))
    edges = np.unique(np.clip(np.concatenate([[low, high], lows, highs]), low, high))
    middle = np.sqrt(edges[1:] * edges[:-1])
    out = np.zeros(len(middle))
    for i in np.argsort(levels, kind="stable"):
        out[(middle >= lows[i]) & (middle <= highs[i])] = bounds[i]
    return edges, out


def levels(samples, folder):
    low, high, floor = 0.02, 6.0, 0.02
    sigma = np.geomspace(low, high, 240)
    curve = profile(samples, sigma)
    figure, axes = plt.subplots(4, 2, figsize=(5.2, 6.8), sharex=True, sharey=True)
    counts = {}
    for column, engine in enumerate(ENGINES):
        fit, boxes = brdffit.fit_boxes(samples, lobes=1, engine=engine)
        counts["one_" + engine] = len(boxes)
        assert np.all(boxes.bound_at(sigma) <= curve), "a bound above the truth"
        for row, depth in enumerate((0, 2, 4, 99)):
            axis = axes[row, column]
            edges, bound = steps(boxes, depth, low, high)
            axis.stairs(np.maximum(bound, floor), edges, baseline=floor, fill=True, color=COLOURS[engine], alpha=0.3)
            axis.stairs(np.maximum(bound, floor), edges, color=COLOURS[engine], linewidth=1, baseline=None)
            axis.loglog(sigma, curve, color="#787878", linewidth=1.4)
            axis.minorticks_off()
            axis.axhline(fit.e2, color="C2", linewidth=1, linestyle="--")
            many = int(np.sum(boxes.level <= depth))
            after = {0: "first boxes", 99: "the end"}.get(depth, "halved %d times" % depth)
            axis.set_title("%s%s: %d" % (TITLES[engine] + "\n" if row == 0 else "", after, many), fontsize=9)
    axes[0, 0].set(xlim=(low, high), ylim=(floor, 40))
    for axis in axes[:, 0]:
        axis.set_ylabel("E²")
    for axis in axes[-1]:
        axis.set_xlabel("roughness σ")
    finish(figure, folder, "levels")
    return counts


# ---- How far a bound is below the truth ------------------------------------------


def overshoot(samples, engine):
    """Widths in ln σ of boxes that hold the optimum or lie next to it, and how far below the smallest E² of the box its bound
    is, relative to the optimum. Boxes that close are left out: they are not bounded any tighter than that takes, and say
    nothing about the order."""
    best = brdffit.fit(samples, lobes=1, relative_gap=1e-9)
    out = []
    for width, part in itertools.product(np.geomspace(2e-3, 3, 40), (0.15, 0.4, 0.6, 0.85)):
        low = float(best.sigma[0] * np.exp(-part * width))
        high = low * float(np.exp(width))
        _, boxes = brdffit.fit_boxes(samples, lobes=1, engine=engine, sigma_range=(low, high), relative_gap=1e-9, box_budget=8)
        for a, b, bound in zip(boxes.sigma_low[:, 0], boxes.sigma_high[:, 0], boxes.lower_bound):
            if 0 < bound < best.e2:
                inside = (max(low, float(a)), min(high, float(b)))
                truth = brdffit.fit(samples, lobes=1, sigma_range=inside, relative_gap=1e-9).e2
                out.append((np.log(b / a), (truth - bound) / best.e2))
    width, below = np.array(out).T
    assert np.all(below >= 0), "a bound above the truth"
    return width, below


def order(samples, folder):
    figure, axis = plt.subplots(figsize=(5.2, 3.6))
    numbers = {}
    for engine, power in (("socp", 1), ("moment", 2)):
        width, below = overshoot(samples, engine)
        axis.loglog(width, below, "os"[power - 1], color=COLOURS[engine], markersize=3.5, label=TITLES[engine])
        small = width < 2e-3
        slope, at = np.polyfit(np.log(width[small]), np.log(below[small]), 1)
        assert abs(slope - power) < 0.15, (engine, slope)
        numbers["order_" + engine] = "%.2f" % slope
        span = np.array([1.6e-4, 0.4])
        axis.loglog(span, np.exp(at) * 1e-3**(slope - power) * span**power, "--", color="#787878", linewidth=1)
        axis.annotate("∝ width" + ("²" if power == 2 else ""), (1.6e-4, np.exp(at) * 1e-3**(slope - power) * 1.6e-4**power),
                      xytext=(2, -16), textcoords="offset points", fontsize=9)
    axis.set(xlabel="width of the box in ln σ", ylabel="(truth − bound) / optimum")
    axis.set_ylim(1e-9, None)
    axis.legend()
    finish(figure, folder, "order")
    return numbers


# ---- Two lobes -------------------------------------------------------------------


def corners(low, high):
    return np.stack([np.stack([a, b], -1) for a, b in ((low[:, 0], low[:, 1]), (high[:, 0], low[:, 1]),
                                                       (high[:, 0], high[:, 1]), (low[:, 0], high[:, 1]))], 1)


def shapes(boxes, floor):
    """Corners of each box; of one on the diagonal, the triangle of pairs in ascending order."""
    low = np.maximum(boxes.sigma_low, floor)
    out = corners(low, boxes.sigma_high)
    diagonal = (boxes.sigma_low[:, 0] == boxes.sigma_low[:, 1]) & (boxes.sigma_high[:, 0] == boxes.sigma_high[:, 1])
    out[diagonal, 1] = out[diagonal, 0]
    return out


def draw_boxes(axis, boxes, low, high, norm):
    """Boxes that reach into the window from `low` to `high`, both a pair."""
    seen = np.flatnonzero(np.all((boxes.sigma_high > low) & (boxes.sigma_low < high), axis=1))
    seen = seen[np.argsort(boxes.level[seen], kind="stable")]  # small ones on top
    faces = PolyCollection(shapes(boxes, 1e-3)[seen], array=boxes.level[seen].astype(float), norm=norm,
                           edgecolors="#ffffff70", linewidths=0.25, rasterized=True)
    axis.add_collection(faces)
    axis.set(xscale="log", yscale="log", xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="σ of the narrower lobe")
    axis.minorticks_off()
    axis.grid(False)
    return faces


def pairs(folder, found):
    fit, boxes = found["moment"]
    norm = matplotlib.colors.Normalize(0, boxes.level.max())
    figure, axis = plt.subplots(figsize=(5.2, 4.4))
    faces = draw_boxes(axis, boxes, (0.004, 0.004), (6, 6), norm)
    axis.plot(fit.sigma[0], fit.sigma[1], "o", markersize=9, markerfacecolor="none", markeredgecolor="C1", markeredgewidth=2)
    axis.set_ylabel("σ of the wider lobe")
    figure.colorbar(faces, label="times halved").outline.set_visible(False)
    finish(figure, folder, "map")

    figure, axes = plt.subplots(1, 2, figsize=(5.2, 3.0), sharey=True)
    spread, norm = 1.22, matplotlib.colors.Normalize(0, found["socp"][1].level.max())
    for axis, engine in zip(axes, ENGINES):
        draw_boxes(axis, found[engine][1], fit.sigma / spread, fit.sigma * spread, norm)
        axis.set_title(TITLES[engine].replace(" (", "\n("), fontsize=9)
        axis.set_xticks([0.1, 0.12, 0.14], ["0.10", "0.12", "0.14"])
    axes[0].set_yticks([0.4, 0.45, 0.5], ["0.40", "0.45", "0.50"])
    axes[0].set_ylabel("σ of the wider lobe")
    finish(figure, folder, "zoom")


def per_level(samples, folder, found):
    figure, axes = plt.subplots(2, 1, figsize=(5.2, 5.0))
    one = {engine: brdffit.fit_boxes(samples, lobes=1, engine=engine, relative_gap=1e-5) for engine in ENGINES}
    for axis, source, title in ((axes[0], one, "one lobe, gap 0.001 %"), (axes[1], found, "two lobes, gap 1 %")):
        for engine in ENGINES:
            count = np.bincount(source[engine][1].level)
            axis.semilogy(np.arange(len(count)), count, "o-", markersize=3.5, color=COLOURS[engine], label=TITLES[engine])
        axis.set(title=title, xlabel="times halved", ylabel="boxes")
    axes[0].legend()
    finish(figure, folder, "per_level")
    return {"deep_" + engine: len(one[engine][1]) for engine in ENGINES}


def draw(folder):
    folder.mkdir(parents=True)
    dense, sparse = brdffit.Samples.example(), noisy()
    numbers = {}
    projection(dense, folder)
    numbers.update(levels(dense, folder))
    numbers.update(order(dense, folder))
    found = {engine: brdffit.fit_boxes(sparse, lobes=2, engine=engine, relative_gap=1e-2) for engine in ENGINES}
    assert all(fit.certified for fit, _ in found.values())
    numbers.update(landscape(sparse, found, folder))
    pairs(folder, found)
    numbers.update(per_level(dense, folder, found))
    numbers.update({"two_" + engine: len(found[engine][1]) for engine in ENGINES})
    one, two = brdffit.fit(dense, lobes=1), brdffit.fit(dense, lobes=2)
    assert one.lower_bound > two.e2
    numbers.update(ratio=int(one.lower_bound / two.e2), boxes=two.boxes, certificate=two.certificate)
    words = {name: format(value, ",") if isinstance(value, int) else value for name, value in numbers.items()}
    (folder / "numbers.json").write_text(json.dumps(words, ensure_ascii=False), encoding="utf-8")
