"""Figures 2-10 of the paper, each from its own CSV file's rows, as SVG and PNG. Needs matplotlib.

SPDX-License-Identifier: MIT
"""
import math

from matplotlib.ticker import FuncFormatter

import arithmetic
from figure_style import plt, save

# Okabe and Ito's colours: told apart by everyone.
INK = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"]
CHANNEL = {"r": "#D55E00", "g": "#009E73", "b": "#0072B2"}
FLOOR = 1e-9  # of logarithmic axes that also have to show zero


def errors(out, rows, distributions):
    """Fig. 2. Rows are sorted by the first distribution's error."""
    figure, axes = plt.subplots(figsize=(6.2, 3.6))
    at = range(1, len(rows) + 1)
    styles = [{"marker": "o", "ms": 2.6, "lw": 1.2, "zorder": 3}, {"marker": "x", "ms": 3.2, "lw": 0}]
    for index, distribution in enumerate(distributions):
        axes.plot(at, [row[f"rms_{distribution}"] for row in rows], color=INK[index], **styles[index],
                  label=distribution.title())
    axes.set(yscale="log", xlabel="material, sorted by error", xlim=(0, len(rows) + 1),
             ylabel="RMS error (channel maximum = 1)", title="One lobe, certified optimum")
    if len(distributions) > 1:
        axes.legend(loc="upper left")
    save(figure, out, "figure02")


def reprojection(out, name, title, rows, channels, caption):
    """Figs 3-7: columns are views; rows are linear, logarithmic, and logarithmic across the plane."""
    views = arithmetic.panels(rows)
    figure, grid = plt.subplots(3, len(views), figsize=(2.1 * len(views) + 0.8, 6.4), sharex="row", sharey="row",
                                squeeze=False)
    floor = 1e-4
    for column, (view, (inside, across)) in enumerate(views.items()):
        for line, (part, scale) in enumerate(((inside, "linear"), (inside, "log"), (across, "log"))):
            axes = grid[line][column]
            lowest = floor if scale == "log" else -math.inf
            for index, channel in enumerate(channels):
                colour = CHANNEL.get(channel, INK[index % len(INK)])
                angle = [a for a, _ in part]
                for fit, style in (("one", {"lw": 1, "ls": (0, (3, 2))}), ("two", {"lw": 1.2})):
                    values = [r[f"{channel}_{fit}"] for _, r in part]
                    axes.plot(angle, [v if v >= lowest else math.nan for v in values], color=colour, **style)
                axes.plot(angle, [max(r[f"{channel}_measured"], lowest) for _, r in part], color=colour, lw=0, marker="o",
                          ms=3)
            axes.set_yscale(scale)
            axes.set_xlabel("incidence in the plane (°)" if line < 2 else "incidence across the plane (°)", fontsize=8)
            if line == 0:
                axes.set_title(f"view {view:g}°", fontsize=9)
            if column == 0:
                axes.set_ylabel("radiance" if scale == "linear" else "radiance ≥ 10⁻⁴")
    handles = [plt.Line2D([], [], color="#444444", lw=0, marker="o", ms=3, label="measured"),
               plt.Line2D([], [], color="#444444", lw=1, ls=(0, (3, 2)), label="one lobe"),
               plt.Line2D([], [], color="#444444", lw=1.2, label="two lobes")]
    handles += [plt.Line2D([], [], color=CHANNEL.get(c, INK[i % len(INK)]), lw=3, label=c)
                for i, c in enumerate(channels)]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    figure.suptitle(f"{title} — {caption}", fontsize=10)
    save(figure, out, name)


def improvements(out, rows, better):
    """Fig. 8."""
    figure, axes = plt.subplots(figsize=(6.2, 3.6))
    floor = 1e-7
    values = [max(row["d12"], floor) for row in rows]
    many = sum(row["d12"] > better for row in rows)
    colours = [INK[0] if row["d12"] > better else "#999999" for row in rows]
    axes.scatter(range(1, len(rows) + 1), values, s=9, c=colours, zorder=3)
    axes.axhline(better, color="#444444", lw=0.8, ls=(0, (3, 2)))
    axes.annotate(f"threshold {better:g}: {many} better, {len(rows) - many} the same", (1, better), xytext=(0, 4),
                  textcoords="offset points", fontsize=8)
    axes.set(yscale="log", xlabel="material, sorted", ylabel="(E₁ − E₂) / E₂", xlim=(0, len(rows) + 1),
             title="What a second lobe gains (below 10⁻⁷: drawn there)")
    save(figure, out, "figure08")


def rates(out, rows, labels, counts):
    """Fig. 9: rows are (setting, scope, lobes, starts, materials, reached, near). `counts`: scope -> materials."""
    scopes = [s for s in ("all", "subset") if any(row["scope"] == s for row in rows)]
    figure, grid = plt.subplots(len(scopes), 2, figsize=(7.4, 3.0 * len(scopes) + 0.7), sharey=True, sharex=True,
                                squeeze=False)
    for line, scope in enumerate(scopes):
        for lobes in (1, 2):
            axes = grid[line][lobes - 1]
            for index, label in enumerate(labels):
                part = [r for r in rows if (r["setting"], r["lobes"], r["scope"]) == (label, lobes, scope)]
                axes.plot([r["starts"] for r in part], [100 * r["reached"] / r["materials"] for r in part],
                          color=INK[index], lw=1.4, marker="o", ms=2.5, label=label, clip_on=False)
            if lobes == 2 and scope == "all":
                axes.plot([100, 5000], [51, 60], color="black", lw=0, marker="D", ms=5, label="the paper's report")
            axes.set(xscale="log", ylim=(0, 100), title=f"{lobes} lobe{'s' * (lobes > 1)}, {counts[scope]} materials")
            axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
            axes.xaxis.set_tick_params(labelbottom=True)
            if line == len(scopes) - 1:
                axes.set_xlabel("random starts")
            if lobes == 1:
                axes.set_ylabel("% of materials at the optimum")
    handles, names = grid[0][1].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=3)
    save(figure, out, "figure09")


def excesses(out, rows, labels, counts):
    """Fig. 10: rows are (setting, scope, starts, rank, excess), two lobes."""
    scopes = [s for s in ("all", "subset") if any(row["scope"] == s for row in rows)]
    figure, grid = plt.subplots(1, len(scopes), figsize=(7.4, 3.8), sharey=True, squeeze=False)
    for axes, scope in zip(grid[0], scopes):
        for index, label in enumerate(labels):
            part = [r for r in rows if (r["setting"], r["scope"]) == (label, scope)]
            axes.plot([r["rank"] for r in part], [max(r["excess"], FLOOR) for r in part], color=INK[index], lw=1.2,
                      marker="o", ms=2, label=label)
        starts = next(r["starts"] for r in rows if r["scope"] == scope)
        axes.set(yscale="log", ylim=(FLOOR / 2, None), xlabel="material, sorted",
                 title=f"{starts:,} starts, {counts[scope]} materials")
    grid[0][0].set_ylabel("E² / certified E² − 1, two lobes\n(below 10⁻⁹: drawn there)")
    handles, names = grid[0][0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=3)
    save(figure, out, "figure10")


def levels(out, rows):
    """Boxes at each level: where bounds of first order cluster, and those of second order do not."""
    figure, grid = plt.subplots(1, 2, figsize=(7.4, 3.6), sharey=True)
    for axes, lobes in zip(grid, (1, 2)):
        for index, engine in enumerate(("moment", "socp")):
            part = [r for r in rows if (r["engine"], r["lobes"]) == (engine, lobes) and r["boxes"]]
            axes.plot([r["level"] / lobes for r in part], [r["boxes"] / r["materials"] for r in part], color=INK[index],
                      lw=1.4, marker="o", ms=2.5, label=f"engine {engine}")
        axes.set(yscale="log", xlabel="halvings of a side (ln σ), mean over lobes",
                 title=f"{lobes} lobe{'s' * (lobes > 1)}, {part[0]['materials']} materials")
    grid[0].set_ylabel("boxes a material")
    grid[0].legend(loc="upper right")
    save(figure, out, "boxes")
