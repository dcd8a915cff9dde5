"""Every distribution through the command line, against formulas written from the literature and nothing else.

Samples of a known lobe are made here with numpy, from vectors, as f_r without a shared (a, b, c); `fit --json` has to
find the truth with proof, and what it recorded has to give its E^2 and `eval`'s table again by the same formulas.
SPDX-License-Identifier: MIT
"""
import csv
import io
import json
import math
import os
import pathlib
import subprocess

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
BRDFFIT = pathlib.Path(os.environ.get("BRDFFIT_BUILD", ROOT / "build")).resolve() / "brdffit"


class Geometry:
    """The vectors that the formulas need, under the normal +z."""

    def __init__(self, light, view):
        half = light + view
        half = half / np.linalg.norm(half, axis=1, keepdims=True)
        self.nl, self.nv, self.nh = light[:, 2], view[:, 2], half[:, 2]
        self.vh = np.sum(view * half, 1)
        self.apart = np.linalg.norm(light - view, axis=1)
        self.alpha = np.arctan2(np.hypot(half[:, 0], half[:, 1]), half[:, 2])
        mirrored = np.stack([-light[:, 0], -light[:, 1], light[:, 2]], 1)
        self.cos_mirror = np.maximum(np.sum(mirrored * view, 1), 0)
        self.masking = np.minimum(1, np.minimum(2 * self.nh * self.nv / self.vh, 2 * self.nh * self.nl / self.vh))


def beckmann(g, m):
    return g.masking / (math.pi * g.nl * g.nv) * np.exp(-(np.tan(g.alpha) / m) ** 2) / (m ** 2 * np.cos(g.alpha) ** 4)


def ggx(g, m):
    """Walter et al. 2007, eq. 33 without chi+, times pi; in the paper's scaling."""
    return g.masking / (math.pi * g.nl * g.nv) * m ** 2 / (np.cos(g.alpha) ** 4 * (m ** 2 + np.tan(g.alpha) ** 2) ** 2)


def torrance_sparrow(g, m):
    return g.masking / (math.pi * g.nl * g.nv) * np.exp(-(g.alpha / m) ** 2)


def ward(g, m):
    return np.exp(-(np.tan(g.alpha) / m) ** 2) / (4 * math.pi * m ** 2 * np.sqrt(g.nl * g.nv))


def blinn_phong(g, n):
    return (n + 2) / (2 * math.pi) * np.cos(g.alpha) ** n


def ashikhmin_shirley(g, n):
    """Ashikhmin and Shirley 2000, eq. 4 with n_u = n_v = n and F = 1."""
    return math.sqrt((n + 1) * (n + 1)) / (8 * math.pi) * np.cos(g.alpha) ** n / (g.vh * np.maximum(g.nl, g.nv))


def lafortune(g, n):
    return (n + 2) / (2 * math.pi) * g.cos_mirror ** n


def retro(g, m):
    return np.exp(-(g.apart / m) ** 2) / (math.pi * m ** 2)


# f_r of a lobe with y = 1, the name of its parameter, and true values: two lobes, and a narrow one.
LOBES = {
    "beckmann": (beckmann, "sigma", [0.07, 0.35], 0.012),
    "ggx": (ggx, "sigma", [0.07, 0.35], 0.012),
    "torrance-sparrow": (torrance_sparrow, "sigma", [0.07, 0.35], 0.012),
    "ward": (ward, "sigma", [0.07, 0.35], 0.012),
    "blinn-phong": (blinn_phong, "exponent", [300.0, 14.5], 12345.0),
    "ashikhmin-shirley": (ashikhmin_shirley, "exponent", [300.0, 14.5], 12345.0),
    "lafortune": (lafortune, "exponent", [300.0, 14.5], 12345.0),
    "retro": (retro, "sigma", [0.07, 0.35], 0.012),
}
DIFFUSE = np.array([0.3, 0.2, 0.05])
SPECULAR = np.array([[0.02, 0.1], [0.03, 0.06], [0.01, 0.2]])  # channel x lobe, of the lobe's peak near the mirror


def unit(theta, phi):
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)


def directions(name=""):
    """Angles in degrees, as a file holds them: lights 0 to 75 degrees, viewers on and around the mirror direction (of a retro
    lobe: around the light)."""
    rows = []
    for i, theta in enumerate(np.linspace(0, 75, 11)):
        for distance in np.concatenate([[0], np.geomspace(0.1, 60, 13)]):
            for turn in (0, 90, 200):
                out = np.clip(theta + distance * math.cos(math.radians(turn)), 0, 80)
                azimuth = 7.0 * i if name == "retro" else 187.0 * i % 360 + 180
                rows.append((theta, 7.0 * i, out, azimuth + distance * math.sin(math.radians(turn))))
    return np.array(rows)


def truth(name, lobes):
    function, _, pair, narrow = LOBES[name]
    values = pair if lobes == 2 else [narrow]
    at_mirror = Geometry(unit(np.zeros(1), 0.0), unit(np.zeros(1), 0.0))
    return values, SPECULAR[:, :lobes] / [function(at_mirror, value)[0] for value in values]


def reflectance(name, g, values, x, y):
    """`name`: of every lobe, or a list."""
    names = [name] * len(values) if isinstance(name, str) else name
    out = np.outer(np.ones(len(g.nl)), x) / math.pi
    for p, value in enumerate(values):
        out += np.outer(LOBES[names[p]][0](g, value), np.asarray(y)[:, p])
    return out


def write(path, angles, values):
    with open(path, "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["theta_i", "phi_i", "theta_o", "phi_o", "r", "g", "b"])
        out.writerows(["%.17g" % number for number in row] for row in np.hstack([angles, values]))


def run(*arguments):
    done = subprocess.run([BRDFFIT, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("lobes", [1, 2])
@pytest.mark.parametrize("name", LOBES)
def test_truth_is_recovered(tmp_path, name, lobes):
    angles = directions(name)
    g = Geometry(*(unit(*np.radians(angles[:, k:k + 2]).T) for k in (0, 2)))
    values, y = truth(name, lobes)
    file, fits = tmp_path / "made.csv", tmp_path / "fits.json"
    made = reflectance(name, g, values, DIFFUSE, y)
    write(file, angles, made)
    fits.write_text(run("fit", "--json", "--max-incidence", "off", "--distribution", name, "--lobes", lobes, file))
    line = json.loads(fits.read_text())
    assert (line["status"], line["distribution"], line["samples_used"]) == ("certified", name, len(angles))
    found = line[LOBES[name][1]]
    assert found == pytest.approx(values, rel=1e-9)
    assert line["x"] == pytest.approx(DIFFUSE, rel=1e-8)
    assert np.allclose(line["y"], y, rtol=1e-8)
    assert line["warnings"] == [[]] * lobes
    # The recorded parameters in the formulas of this file, beside the table that eval writes.
    again = reflectance(name, g, found, line["x"], line["y"])
    rows = list(csv.DictReader(io.StringIO(run("eval", "--quiet", fits, file))))
    table = np.array([[float(row[channel + "_fit"]) for channel in "rgb"] for row in rows])
    assert np.allclose(table, again, rtol=1e-10)
    assert np.allclose(table, made, rtol=1e-7)


# Each distribution beside another one; a sharp lobe and a wide one.
PAIRS = [*zip(LOBES, [*LOBES][1:] + [*LOBES][:1])]


@pytest.mark.parametrize("pair", PAIRS, ids=",".join)
def test_truth_of_a_list_is_recovered(tmp_path, pair):
    """A lobe of each, by its own parameter; the line in the formulas of this file is the table that eval writes."""
    angles = directions()
    g = Geometry(*(unit(*np.radians(angles[:, k:k + 2]).T) for k in (0, 2)))
    values = [LOBES[name][2][p] for p, name in enumerate(pair)]
    at_mirror = Geometry(unit(np.zeros(1), 0.0), unit(np.zeros(1), 0.0))
    y = SPECULAR / [LOBES[name][0](at_mirror, value)[0] for name, value in zip(pair, values)]
    file, fits = tmp_path / "made.csv", tmp_path / "fits.json"
    made = reflectance(pair, g, values, DIFFUSE, y)
    write(file, angles, made)
    fits.write_text(run("fit", "--json", "--max-incidence", "off", "--lobes", ",".join(pair), file))
    line = json.loads(fits.read_text())
    assert (line["status"], line["distributions"], line["samples_used"]) == ("certified", [*pair], len(angles))
    found = [line[LOBES[name][1]][p] for p, name in enumerate(pair)]
    assert found == pytest.approx(values, rel=1e-7)
    assert line["x"] == pytest.approx(DIFFUSE, rel=1e-6)
    assert np.allclose(line["y"], y, rtol=1e-6)
    again = reflectance(pair, g, found, line["x"], line["y"])
    rows = list(csv.DictReader(io.StringIO(run("eval", "--quiet", fits, file))))
    table = np.array([[float(row[channel + "_fit"]) for channel in "rgb"] for row in rows])
    assert np.allclose(table, again, rtol=1e-10)
    # Either distribution alone leaves more than the list does, proven, and no line of it is read as the other's.
    for name in pair:
        alone = json.loads(run("fit", "--json", "--max-incidence", "off", "--lobes", 2, "--gap", "0.1", "--distribution", name,
                               file))
        assert alone["lower_bound"] > line["e2"]


@pytest.mark.parametrize("name", LOBES)
def test_e2_of_noisy_data(tmp_path, name):
    """With 2 % noise: E^2 of the recorded model by these formulas, and no better model among the truth's neighbours."""
    angles = directions()
    g = Geometry(*(unit(*np.radians(angles[:, k:k + 2]).T) for k in (0, 2)))
    values, y = truth(name, 2)
    noise = np.random.default_rng(5).normal(size=(len(angles), 3))
    exact = reflectance(name, g, values, DIFFUSE, y)
    made = exact + 0.02 * exact.max(0) * noise
    file = tmp_path / "noisy.csv"
    write(file, angles, made)
    line = json.loads(run("fit", "--json", "--max-incidence", "off", "--distribution", name, "--lobes", 2, file))
    assert line["status"] == "certified"
    scale = (made * g.nl[:, None]).max(0)

    def e2(values, x, y):
        return np.sum(((made - reflectance(name, g, values, x, y)) * g.nl[:, None] / scale) ** 2)

    assert e2(line[LOBES[name][1]], line["x"], line["y"]) == pytest.approx(line["e2"], rel=1e-9)
    assert line["lower_bound"] <= line["e2"] <= e2(values, DIFFUSE, y) * (1 + line["relative_gap"])
    for a in np.linspace(0.8, 1.25, 7):
        for b in np.linspace(0.8, 1.25, 7):
            assert e2([values[0] * a, values[1] * b], DIFFUSE, y) >= line["lower_bound"]


def test_the_data_choose_their_distribution(tmp_path):
    """A broad lobe: of all distributions only the true one fits, and the bounds of the others prove it."""
    angles = directions()
    g = Geometry(*(unit(*np.radians(angles[:, k:k + 2]).T) for k in (0, 2)))
    for name in LOBES:
        values, y = [LOBES[name][2][1]], np.array([[0.5], [0.4], [0.3]])
        file = tmp_path / (name + ".csv")
        write(file, angles, reflectance(name, g, values, DIFFUSE, y))
        for other in LOBES:
            line = json.loads(run("fit", "--json", "--max-incidence", "off", "--distribution", other, file))
            share = line["e2"] / line["sum_of_squares"]
            proven = line["lower_bound"] / line["sum_of_squares"]
            assert share < 1e-20 if other == name else proven > 1e-7, (name, other, share, proven)
