"""One measurement of a known material, written in every way that people and instruments write such tables.

SPDX-License-Identifier: MIT
"""
import math

import numpy as np

import model

SIGMA = 0.22
ALBEDO, F = np.array([0.12, 0.08, 0.05]), 0.015


def _measure():
    places = [(ti, 0.0, to, po) for ti in (0, 15, 30, 45) for to in range(0, 80, 5) for po in (180, 150) if to or po == 180]
    angles = np.array(places, float)
    light, view = model.unit(angles[:, 0], angles[:, 1]), model.unit(angles[:, 2], angles[:, 3])
    a, b, c, nl, _ = model.directions_to_abc(light, view)
    radiance = a[:, None] * ALBEDO + (F * b * np.exp(-c / SIGMA ** 2) / SIGMA ** 2)[:, None]
    noise = np.random.RandomState(1).standard_normal(radiance.shape)
    return angles, light, view, radiance / nl[:, None] * (1 + 0.01 * noise)


ANGLES, LIGHT, VIEW, VALUES = _measure()
ROWS = [[*("%g" % a for a in angles), *("%.6g" % v for v in values)] for angles, values in zip(ANGLES, VALUES)]
NAMES = ["theta_i", "phi_i", "theta_o", "phi_o", "r", "g", "b"]


def lines(names=NAMES, rows=ROWS, by=",", end="\n", above=(), below_header=(), before="", after=""):
    """The table: names and rows joined by `by`, lines above, lines below the header, text around."""
    body = [*above, by.join(names), *below_header, *(by.join(row) for row in rows)]
    return before + "".join(line + end for line in body) + after


def column(rows, at, change):
    """Rows with `change` of their field."""
    return [[*row[:at], change(row[at]), *row[at + 1:]] for row in rows]


def fields(change, first=0, last=7):
    """All fields from first to last changed."""
    return [[change(f) if first <= k < last else f for k, f in enumerate(row)] for row in ROWS]


def with_column(name, values, at=7):
    """Names and rows with one column more."""
    return [*NAMES[:at], name, *NAMES[at:]], [[*row[:at], str(v), *row[at:]] for row, v in zip(ROWS, values)]


def cell(rows, line, at, text):
    """One field of one row replaced."""
    rows = [list(row) for row in rows]
    rows[line][at] = text
    return rows


def vectors(light=LIGHT, view=VIEW):
    names = ["lx", "ly", "lz", "vx", "vy", "vz", "r", "g", "b"]
    return names, [["%.9f" % x for x in (*a, *b)] + row[4:] for a, b, row in zip(light, view, ROWS)]


def relative():
    """theta_i, theta_o, the azimuth between."""
    return ["theta_i", "theta_o", "phi", "r", "g", "b"], [[r[0], r[2], r[3], *r[4:]] for r in ROWS]


def in_plane(negative_back=True):
    """Only samples in the plane of incidence, and some towards the light with a sign."""
    return ["theta_i", "theta_o", "r"], [[r[0], r[2], r[4]] for r in ROWS if r[3] == "180"]


def half_angles():
    """theta_h, theta_d, phi_d of the same samples."""
    out = []
    for light, view, row in zip(LIGHT, VIEW, ROWS):
        h = light + view
        h = h / np.linalg.norm(h)
        th, ph = math.acos(min(1, h[2])), math.atan2(h[1], h[0])
        turn_z = np.array([[math.cos(ph), math.sin(ph), 0], [-math.sin(ph), math.cos(ph), 0], [0, 0, 1]])
        turn_y = np.array([[math.cos(th), 0, -math.sin(th)], [0, 1, 0], [math.sin(th), 0, math.cos(th)]])
        d = turn_y @ turn_z @ light
        out.append(["%.9f" % math.degrees(x) for x in (th, math.acos(min(1, d[2])), math.atan2(d[1], d[0]))] + row[4:])
    return ["theta_h", "theta_d", "phi_d", "r", "g", "b"], out


def long_table(words="wavelength", order=(650, 550, 450)):
    rows = [[*row[:4], str(w), row[4 + (650, 550, 450).index(w)]] for row in ROWS for w in order]
    return [*NAMES[:4], words, "value"], rows
