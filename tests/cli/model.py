"""The model and its error, from the definition and nothing else.

Written from the equations (include/brdffit.h, theory 1), vectorised with numpy, sharing no code with the library:
what a JSON line claims is checked here from the line and the file alone.

SPDX-License-Identifier: MIT
"""
import csv
import gzip
import math
import pathlib
import struct

import numpy as np


def unit(theta, phi):
    theta, phi = np.radians(theta), np.radians(phi)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)


EXPONENTS = ("blinn-phong", "ashikhmin-shirley", "lafortune")
DISTRIBUTIONS = ("beckmann", "ggx", "torrance-sparrow", "ward", *EXPONENTS, "retro")


def directions_to_abc(light, view, normal=(0.0, 0.0, 1.0), distribution="beckmann"):
    """a, b, c, n.l, n.v of unit vectors; b times n.l, as for radiance."""
    half = light + view
    half = half / np.linalg.norm(half, axis=1, keepdims=True)
    normal = np.broadcast_to(np.asarray(normal, float), light.shape)
    nl, nv, nh = (np.sum(normal * d, 1) for d in (light, view, half))
    vh = np.sum(view * half, 1)
    sine2 = np.sum(np.cross(normal, half) ** 2, 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        shadow = np.minimum(1, np.minimum(2 * nh * nv / vh, 2 * nh * nl / vh))
        tan2, alpha = sine2 / nh ** 2, np.arctan2(np.sqrt(sine2), nh)
        # The mirrored light; |r - v|^2 / 2 = 1 - r.v without its cancellation.
        off = np.sum((2 * nl[:, None] * normal - light - view) ** 2, 1) / 2
        b, c = {
            "beckmann": (shadow / (math.pi * nv * nh ** 4), tan2),
            "ggx": (shadow / (math.pi * nv * nh ** 4), tan2),
            "torrance-sparrow": (shadow / (math.pi * nv), alpha ** 2),
            "ward": (nl / (4 * math.pi * np.sqrt(nl * nv)), tan2),
            "blinn-phong": (nl, np.log1p(tan2) / 2),
            "ashikhmin-shirley": (nl / (vh * np.maximum(nl, nv)), np.log1p(tan2) / 2),
            "retro": (nl, np.sum((light - view) ** 2, 1)),
            "lafortune": (np.where(off < 1, nl, 0), np.where(off < 1, -np.log1p(-off), 0)),
        }[distribution]
        return nl / math.pi, b, c, nl, nv


def shape(distribution, s, c):
    """lambda(s) exp(-c s), or GGX's: what y b multiplies."""
    if distribution == "ggx":
        return s / (1 + c * s) ** 2
    factor = {"beckmann": s, "ward": s, "torrance-sparrow": 1, "ashikhmin-shirley": (s + 1) / (8 * math.pi),
              "retro": s / math.pi}
    return factor.get(distribution, (s + 2) / (2 * math.pi)) * np.exp(-c * s)


def read_text(path):
    """Column names and rows of a comma-separated file; an empty field is NaN."""
    with open(path, newline="") as file:
        rows = list(csv.reader(line for line in file if line.strip() and not line.startswith("#")))
    return rows[0], np.array([[float(x) if x else math.nan for x in row] for row in rows[1:]])


def half_difference(h, d, p):
    """Unit light and view of Rusinkiewicz angles in radians (half vector at azimuth 0)."""
    local = np.stack([np.sin(d) * np.cos(p), np.sin(d) * np.sin(p), np.cos(d)], -1)
    half = np.stack([np.sin(h), 0 * h, np.cos(h)], -1)
    side = np.stack([np.cos(h), 0 * h, -np.sin(h)], -1)
    light = local[:, :1] * side + local[:, 1:2] * np.array([0.0, 1.0, 0.0]) + local[:, 2:] * half
    return light, 2 * local[:, 2:] * half - light


def read_merl(path, bins):
    """Light, view, values of the cells that were measured."""
    raw = pathlib.Path(path).read_bytes()
    if raw[:2] == b"\x1f\x8b":
        raw = gzip.decompress(raw)
    nh, nd, np_ = struct.unpack("<3i", raw[:12])
    values = np.frombuffer(raw, "<f8", 3 * nh * nd * np_, 12).reshape(3, -1)
    i, j, k = (g.ravel() for g in np.meshgrid(np.arange(nh), np.arange(nd), np.arange(np_), indexing="ij"))
    shift = 0.5 if bins == "centre" else 0.0
    light, view = half_difference(math.pi / 2 * ((i + shift) / nh) ** 2, math.pi / 2 * (j + shift) / nd,
                                  math.pi * (k + shift) / np_)
    keep = np.all(values >= 0, 0)
    return light[keep], view[keep], (values * np.array([[1], [1.15], [1.66]]) / 1500)[:, keep].T


class Samples:
    """Radiance, weights and (a, b, c) of the samples that a fit with these settings uses; b and c of each lobe."""

    def __init__(self, path, quantity, max_incidence=60.0, merl_bins=None, distributions=("beckmann",)):
        def coefficients(*vectors):
            every = [directions_to_abc(*vectors, distribution=d) for d in distributions]
            a, _, _, nl, nv = every[0]
            return a, [one[1] for one in every], [one[2] for one in every], nl, nv

        if merl_bins is not None:
            light, view, values = read_merl(path, merl_bins)
            names, weights = ["r", "g", "b"], np.ones(len(light))
            a, b, c, nl, nv = coefficients(light, view)
        else:
            header, rows = read_text(path)
            column = {name: rows[:, i] for i, name in enumerate(header)}
            weights = column.pop("weight", np.ones(len(rows)))
            if "a" in column:
                a, b, c = (column.pop(k) for k in "abc")
                b, c = ([one] * len(distributions) for one in (b, c))
                nl = nv = np.ones(len(rows))
            elif "lx" in column:
                vectors = [np.stack([column.pop(x + k) for k in "xyz"], -1) for x in "lvn" if x + "x" in column]
                vectors = [v / np.linalg.norm(v, axis=1, keepdims=True) for v in vectors]
                a, b, c, nl, nv = coefficients(*vectors)
            else:
                ti, to = column.pop("theta_i"), column.pop("theta_o")
                pi, po = column.pop("phi_i", 0 * ti), column.pop("phi_o", 0 * to + 180)
                a, b, c, nl, nv = coefficients(unit(ti, pi), unit(to, po))
            names, values = list(column), np.stack(list(column.values()), -1)
        # Exactly 60 degrees belongs to 60; the cosine's rounding does not decide.
        limit = 0.0 if max_incidence >= 90 else math.cos(math.radians(max_incidence)) - 1e-9
        used = ~np.isnan(values).any(1) & (weights > 0) & (nl > 1e-15) & (nv > 1e-15) & (nl >= limit)
        self.names, self.used, self.total = names, int(used.sum()), len(used)
        self.a, self.weights, self.distributions = a[used], weights[used], distributions
        self.b, self.c = ([one[used] for one in every] for every in (b, c))
        self.radiance = values[used] * (nl[used, None] if quantity == "brdf" else 1.0)

    def prediction(self, sigma, x, y):
        """Radiance, used samples x channels."""
        out = self.a[:, None] * np.asarray(x)[None, :]
        for p, roughness in enumerate(sigma):
            lobe = self.b[p] * shape(self.distributions[p], 1 / roughness ** 2, self.c[p])
            out = out + lobe[:, None] * np.asarray(y)[None, :, p]
        return out

    def figures(self, line):
        """What the norm minimises, in the units that were minimised; RMS a channel in the data's."""
        residual = self.radiance - self.prediction(line["sigma"], line["x"], line["y"])
        squares = np.array([math.fsum(self.weights * r * r) for r in residual.T])
        scale = np.array(line["channel_scale"])
        absolute = np.abs(residual) / scale
        objective = {"l2": math.fsum(squares / scale ** 2), "linf": absolute.max(),
                     "l1": math.fsum((self.weights[:, None] * absolute).ravel())}[line["norm"]]
        return objective, np.sqrt(squares / math.fsum(self.weights))


def check_line(line, path):
    """Everything in a line of a finished fit that its file can confirm."""
    samples = Samples(path, line["quantity"], line["max_incidence"], line["merl_bins"], line["distributions"])
    assert line["channels"] == samples.names
    assert line["samples_used"] == samples.used
    e2, rms = samples.figures(line)
    # At rounding level E^2 is noise: residuals are compared with the data instead.
    noise = (1e-24 if line["norm"] == "l2" else 1e-12) * line["sum_of_squares"]
    assert abs(e2 - line["e2"]) <= 1e-10 * line["e2"] + noise, (e2, line["e2"])
    assert np.allclose(rms, line["rms"], rtol=1e-10, atol=1e-12 * np.abs(samples.radiance).max())
    zero = dict(line, x=[0] * len(rms), y=[[0] * line["lobes"]] * len(rms))
    assert math.isclose(samples.figures(zero)[0], line["sum_of_squares"], rel_tol=1e-10)
    if line["normalise"] == "max":
        largest = samples.radiance.max(0)
        assert np.allclose(line["channel_scale"], np.where(largest > 0, largest, 1), rtol=1e-12)
    else:
        assert line["channel_scale"] == [1] * len(rms)
    return samples
