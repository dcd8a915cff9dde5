"""Evaluation of every model against formulas in 50 digits, written from the literature and nothing else.

brdffit_eval() is called by ctypes with the structures of brdffit.h written out here: Schlick 1994, Smith's masking (Walter et
al. 2007, Heitz 2014), Oren and Nayar's qualitative model 1994 and Burley 2012. SPDX-License-Identifier: MIT
"""
import ctypes
import itertools
import os
import pathlib
import random

import pytest

mpmath = pytest.importorskip("mpmath")
mp = mpmath.mp.clone()
mp.dps = 50

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIBRARY = pathlib.Path(os.environ.get("BRDFFIT_BUILD", ROOT / "build")).resolve() / "libbrdffit.so"
P, SIZE, INT = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
BECKMANN, GGX = range(2)
V_CAVITY, SMITH, SEPARABLE, NO_MASKING = range(4)
LAMBERT, NONE, OREN_NAYAR, BURLEY = range(4)
COLUMNS = {LAMBERT: 1, NONE: 1, OREN_NAYAR: 2, BURLEY: 3}


class Samples(ctypes.Structure):
    _fields_ = [("struct_size", SIZE), ("count", SIZE), ("channels", SIZE), ("form", INT), ("quantity", INT)] + [
        (name, P) for name in ("light", "view", "normal", "cos_light", "cos_view", "tan2_half", "cos_difference", "a", "b",
                               "c", "values", "weights")]


class Model(ctypes.Structure):
    _fields_ = [("struct_size", SIZE), ("distribution", INT), ("lobes", INT), ("channels", SIZE), ("sigma", P), ("x", P),
                ("y", P), ("distributions", P), ("fresnel", INT), ("diffuse", INT), ("f0", P), ("x_more", P),
                ("masking", INT), ("padding", INT)]


def smith_lambda(distribution, sigma, tangent):
    if tangent == 0:
        return mp.mpf(0)
    if distribution == GGX:
        return (-1 + mp.sqrt(1 + (sigma * tangent) ** 2)) / 2
    a = 1 / (sigma * tangent)
    return (mp.erf(a) - 1) / 2 + mp.exp(-a * a) / (2 * a * mp.sqrt(mp.pi))


class Place:
    """Unit vectors under +z, as the doubles say them."""

    def __init__(self, light, view):
        self.l, self.v = ([mp.mpf(x) / mp.sqrt(sum(mp.mpf(y) ** 2 for y in w)) for x in w] for w in (light, view))
        half = [x + y for x, y in zip(self.l, self.v)]
        length = mp.sqrt(sum(x * x for x in half))
        self.nl, self.nv, self.nh = self.l[2], self.v[2], half[2] / length
        self.vh = sum(x * y for x, y in zip(self.v, half)) / length
        self.lv = sum(x * y for x, y in zip(self.l, self.v))
        self.tan_half = mp.hypot(half[0], half[1]) / half[2]

    def tangent(self, w):
        return mp.hypot(w[0], w[1]) / w[2]

    def azimuths(self):
        cross = [mp.hypot(w[0], w[1]) for w in (self.l, self.v)]
        if 0 in cross:
            return mp.mpf(0)
        return (self.l[0] * self.v[0] + self.l[1] * self.v[1]) / (cross[0] * cross[1])

    def masking(self, kind, distribution, sigma):
        if kind == V_CAVITY:
            return min(mp.mpf(1), 2 * self.nh * self.nv / self.vh, 2 * self.nh * self.nl / self.vh)
        if kind == NO_MASKING:
            return mp.mpf(1)
        a, b = (smith_lambda(distribution, sigma, self.tangent(w)) for w in (self.l, self.v))
        return 1 / (1 + a + b) if kind == SMITH else 1 / (1 + a) / (1 + b)

    def lobe(self, distribution, masking, sigma):
        c = (self.tan_half / sigma) ** 2
        shape = mp.exp(-c) if distribution == BECKMANN else 1 / (1 + c) ** 2
        return self.masking(masking, distribution, sigma) * shape / (mp.pi * self.nv * sigma ** 2 * self.nh ** 4)

    def diffuse(self, kind):
        a = self.nl / mp.pi
        if kind == OREN_NAYAR:
            angles = sorted(mp.acos(min(mp.mpf(1), w)) for w in (self.nl, self.nv))
            product = max(mp.mpf(0), self.azimuths()) * mp.sin(angles[1]) * mp.tan(angles[0])
            return [a, a * product if product >= mp.mpf("1e-12") else mp.mpf(0)]
        if kind == BURLEY:
            light, view = ((1 - w) ** 5 for w in (self.nl, self.nv))
            out = []
            for r in (0, 1, -1):  # the polynomial in the roughness, from its values
                grazing = mp.mpf("0.5") + 2 * r * self.vh ** 2
                out.append(a * (1 + (grazing - 1) * light) * (1 + (grazing - 1) * view))
            return [out[0], (out[1] - out[2]) / 2, (out[1] + out[2]) / 2 - out[0]]
        return [a if kind == LAMBERT else mp.mpf(0)]


def directions():
    """Anywhere above the horizon; retro, upright, mirrored and grazing ones."""
    draw, out = random.Random(5), []
    for kind in range(60):
        theta, phi = draw.uniform(0, 1.5), draw.uniform(0, 6.28)
        light = [float(x) for x in (mp.sin(theta) * mp.cos(phi), mp.sin(theta) * mp.sin(phi), mp.cos(theta))]
        theta, phi = draw.uniform(0, 1.5), draw.uniform(0, 6.28)
        view = [float(x) for x in (mp.sin(theta) * mp.cos(phi), mp.sin(theta) * mp.sin(phi), mp.cos(theta))]
        if kind % 10 == 0:
            view = list(light)
        elif kind % 10 == 1:
            view = [-light[0], -light[1], light[2]]
        elif kind % 10 == 2:
            light = [0.0, 0.0, 1.0]
        elif kind % 10 == 3:
            view = [view[0], view[1], 1e-3 * (kind + 1)]
        out.append((light, view))
    return out


def pointer(numbers):
    array = (ctypes.c_double * len(numbers))(*numbers)
    return array, ctypes.cast(array, P)


def evaluate(places, distribution, masking, fresnel, diffuse, sigma, x, y, f0):
    library = ctypes.CDLL(str(LIBRARY))
    samples, model, kept = Samples(), Model(), []

    def keep(numbers):
        array, address = pointer(numbers)
        kept.append(array)
        return address

    samples.struct_size, samples.count, samples.channels, samples.quantity = ctypes.sizeof(samples), len(places), 1, 1
    samples.light = keep([v for light, _ in places for v in light])
    samples.view = keep([v for _, view in places for v in view])
    model.struct_size, model.distribution, model.lobes, model.channels = ctypes.sizeof(model), distribution, 1, 1
    model.sigma, model.x, model.y = keep([sigma]), keep(x[:1]), keep([y])
    model.fresnel, model.diffuse, model.masking = fresnel, diffuse, masking
    model.f0 = keep([f0]) if fresnel else None
    model.x_more = keep(x[1:]) if len(x) > 1 else None
    out = (ctypes.c_double * len(places))()
    status = library.brdffit_eval(ctypes.byref(model), ctypes.byref(samples), out, None)
    assert status == 0
    return list(out)


@pytest.mark.parametrize("diffuse", COLUMNS)
@pytest.mark.parametrize("fresnel", (0, 1))
def test_evaluation_against_50_digits(fresnel, diffuse):
    places, f0, y = directions(), 0.04, 0.35
    exact = [Place(light, view) for light, view in places]
    for distribution, masking, sigma in itertools.product((BECKMANN, GGX), range(4), (0.02, 0.3, 2.0)):
        x = [0.5, 0.25, 0.125][:COLUMNS[diffuse]]
        got = evaluate(places, distribution, masking, fresnel, diffuse, sigma, x, y, f0)
        for at, (light, view), value in zip(exact, places, got):
            lobe = y * at.lobe(distribution, masking, mp.mpf(sigma))
            scale = lobe * (1 + (at.tan_half / sigma) ** 2)  # an error of the half angle counts with the exponent
            if fresnel:
                reflectance = f0 + (1 - mp.mpf(f0)) * (1 - at.vh) ** 5
                lobe, scale = lobe * reflectance, scale * reflectance
            columns = [a * c for a, c in zip(x, at.diffuse(diffuse))]
            truth = lobe + sum(columns)
            allowed = 1e-13 * (scale + sum(columns)) / min(1, at.nl, at.nv) + mp.mpf(2) ** -1074  # a double's underflow
            assert abs(value - truth) <= allowed, (light, view, masking, sigma)
