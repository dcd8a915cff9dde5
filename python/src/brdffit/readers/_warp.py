"""Warps of the unit square by a bilinear density. SPDX-License-Identifier: MIT

A density d(u, v) is given on a grid, once for each node of the parameters phi and theta, and is bilinear between grid
points. Let C_j(u) be the integral of row j from 0 to u, and M(v) that of the rows' totals R(v), both linear in the row
between grid points. The warp takes (u, v) to

    x = C_v(u) / R(v),    y = M(v) / M(1),

which is uniform when (u, v) follows d. Between nodes of the parameters, d, C and M are mixed linearly, each normalised
first: what Dupuy and Jakob 2018 do, and what the files are made for. With M(1) = 1 the mixture's is 1, too.
"""
from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .._arrays import Floats

Index = npt.NDArray[np.intp]
_EDGE = 2.0 ** -24  # the reference keeps this far from the corners, where the inverse is not unique


class Mix(NamedTuple):
    """For each of n points, the slices around its parameters and their weights: n x m each."""

    slices: Index
    weights: Floats

    def of(self, table: npt.NDArray[Any], *index: Index) -> Floats:
        """table[slice, *index], mixed: n, or n x K when the table has a dimension more."""
        total: Floats | None = None
        for slices, weight in zip(self.slices.T, self.weights.T):
            place = (slices, *index)
            values = table[place]
            part = weight.reshape(-1, *[1] * (values.ndim - 1)) * values
            total = part if total is None else total + part
        assert total is not None
        return total


def mix(phi_nodes: Floats, theta_nodes: Floats, phi: Floats, theta: Floats) -> Mix:
    """Slices are numbered phi first. Outside of the nodes the nearest counts."""
    pairs = [_bracket(nodes, at) for nodes, at in ((phi_nodes, phi), (theta_nodes, theta))]
    slices, weights = [], []
    for p, p_weight in pairs[0]:
        for t, t_weight in pairs[1]:
            slices.append(p * len(theta_nodes) + t)
            weights.append(p_weight * t_weight)
    return Mix(np.stack(slices, 1), np.stack(weights, 1))


def _bracket(nodes: Floats, at: Floats) -> list[tuple[Index, Floats]]:
    if len(nodes) == 1:
        return [(np.zeros(at.shape, np.intp), np.ones(at.shape))]
    low = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    weight = np.clip((at - nodes[low]) / (nodes[low + 1] - nodes[low]), 0, 1)
    return [(low, 1 - weight), (low + 1, weight)]


class Cell(NamedTuple):
    """The grid cell of points of the unit square, and where they lie in it."""

    column: Index
    row: Index
    a: Floats
    b: Floats


def cell(shape: tuple[int, ...], u: Floats, v: Floats) -> Cell:
    """In a grid of `shape` (..., rows, columns)."""
    rows, columns = shape[-2:]
    x, y = u * (columns - 1), v * (rows - 1)
    i, j = np.minimum(x.astype(np.intp), columns - 2), np.minimum(y.astype(np.intp), rows - 2)
    return Cell(i, j, x - i, y - j)


def bilinear(table: npt.NDArray[Any], at: Cell, mixed: Mix | None = None) -> Floats:
    """Of slices x rows x columns [x K], or of rows x columns without `mixed`."""
    corners = []
    for j, i in ((0, 0), (0, 1), (1, 0), (1, 1)):
        index = (at.row + j, at.column + i)
        corners.append(table[index].astype(np.float64) if mixed is None else mixed.of(table, *index))
    extra = [1] * (corners[0].ndim - 1)
    a, b = at.a.reshape(-1, *extra), at.b.reshape(-1, *extra)
    return np.asarray((1 - b) * ((1 - a) * corners[0] + a * corners[1]) + b * ((1 - a) * corners[2] + a * corners[3]))


def _solve(start: Floats, end: Floats, area: Floats) -> Floats:
    """t in [0, 1] with start t + (end - start) t^2/2 = area, without cancellation; 0 where nothing is to be had."""
    root = np.sqrt(np.maximum(start * start + 2 * area * (end - start), 0))
    below = start + root
    return np.asarray(np.clip(np.divide(2 * area, below, out=np.zeros_like(area), where=below > 0), 0, 1))


class Warp:
    """density: slices x rows x columns; not negative, none all zero."""

    def __init__(self, density: npt.NDArray[Any]) -> None:
        d = density.astype(np.float64)
        count, rows, columns = d.shape
        inside = np.zeros((count, rows, columns))
        np.cumsum(0.5 * (d[:, :, 1:] + d[:, :, :-1]), 2, out=inside[:, :, 1:])
        total = inside[:, :, -1]
        above = np.zeros((count, rows))
        np.cumsum(0.5 * (total[:, 1:] + total[:, :-1]), 1, out=above[:, 1:])
        scale = 1 / above[:, -1]
        self.density = d * scale[:, None, None]
        self.conditional = inside * scale[:, None, None]
        self.marginal = above * scale[:, None]

    def invert(self, u: Floats, v: Floats, mixed: Mix) -> tuple[Floats, Floats, npt.NDArray[np.bool_]]:
        """(x, y) of (u, v), and whether there is any density in the row of v: x is 0 where not."""
        i, j, a, b = cell(self.density.shape, u, v)
        d = self.density
        c0 = (1 - b) * mixed.of(d, j, i) + b * mixed.of(d, j + 1, i)
        c1 = (1 - b) * mixed.of(d, j, i + 1) + b * mixed.of(d, j + 1, i + 1)
        before = (1 - b) * mixed.of(self.conditional, j, i) + b * mixed.of(self.conditional, j + 1, i)
        r0, r1 = mixed.of(self.conditional[:, :, -1], j), mixed.of(self.conditional[:, :, -1], j + 1)
        whole = (1 - b) * r0 + b * r1
        some = whole > 0
        x = np.divide(a * (c0 + 0.5 * a * (c1 - c0)) + before, whole, out=np.zeros_like(whole), where=some)
        y = b * (r0 + 0.5 * b * (r1 - r0)) + mixed.of(self.marginal, j)
        return np.clip(x, 0, 1), np.clip(y, 0, 1), some

    def sample(self, x: Floats, y: Floats, slices: Index) -> tuple[Floats, Floats]:
        """(u, v) of (x, y) at nodes of the parameters: the inverse of `invert`."""
        x, y = np.clip(x, _EDGE, 1 - _EDGE), np.clip(y, _EDGE, 1 - _EDGE)
        rows, columns = self.density.shape[1:]
        j = np.clip((self.marginal[slices] < y[:, None]).sum(1) - 1, 0, rows - 2)
        low, high = self.conditional[slices, j], self.conditional[slices, j + 1]
        b = _solve(low[:, -1], high[:, -1], y - self.marginal[slices, j])
        along = (1 - b)[:, None] * low + b[:, None] * high
        target = x * along[:, -1]
        i = np.clip((along < target[:, None]).sum(1) - 1, 0, columns - 2)
        d, each = self.density, np.arange(len(x))
        c0, c1 = ((1 - b) * d[slices, j, i + k] + b * d[slices, j + 1, i + k] for k in (0, 1))
        a = _solve(c0, c1, target - along[each, i])
        return (i + a) / (columns - 1), (j + b) / (rows - 1)
