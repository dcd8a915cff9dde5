"""What the figures of `make paper` and `make bench` have in common. Needs matplotlib. SPDX-License-Identifier: MIT"""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

plt.rcParams.update({
    "font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#dddddd",
    "grid.linewidth": 0.6, "axes.axisbelow": True, "legend.frameon": False, "svg.hashsalt": "brdffit",
    "figure.constrained_layout.use": True,
})


def save(figure, out, name):
    """name.svg, with the same bytes each time, and name.png."""
    figure.savefig(out / f"{name}.svg", metadata={"Date": None})
    figure.savefig(out / f"{name}.png", dpi=200)
    plt.close(figure)
