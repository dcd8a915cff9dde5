"""What samples count for: solid angles against a program of their own and on real measurements. SPDX-License-Identifier: MIT"""
import json
import os
import pathlib

import numpy as np
import pytest

import brdffit
import rgl_files
from brdffit import report
from places import ROOT

DATA = pathlib.Path(os.environ.get("BRDFFIT_DATA", ROOT.parent / "shared" / "data"))


def uniform(count, rng):
    d = rng.standard_normal((count, 3))
    d[:, 2] = np.abs(d[:, 2])
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def about_the_mirror(light, sigma, rng):
    """Half vectors by Beckmann's distribution; a view below the horizon is one anywhere instead."""
    tangent, turn = sigma * np.sqrt(-np.log(rng.uniform(size=len(light)))), rng.uniform(0, 2 * np.pi, len(light))
    half = np.stack([tangent * np.cos(turn), tangent * np.sin(turn), np.ones(len(light))], 1)
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    view = 2 * np.sum(light * half, 1, keepdims=True) * half - light
    return np.where(view[:, 2:] > 0, view, uniform(len(light), rng))


def shares(light, view):
    """The k-d tree of src/weight/cells.c, by recursion over arrays: as plain as it can be, and N log^2 N."""
    dot, cross = light[:, 0] * view[:, 0] + light[:, 1] * view[:, 1], light[:, 0] * view[:, 1] - light[:, 1] * view[:, 0]
    at = np.stack([np.sqrt(1 - light[:, 2]), np.sqrt(1 - view[:, 2]), np.abs(np.arctan2(cross, dot)) / np.pi], 1)
    out = np.zeros(len(at))

    def cut(inside, low, high):
        points = at[inside]
        extent = np.ptp(points, axis=0)
        extent[2] *= 0.5 * np.pi * (points[:, 1].min() + points[:, 1].max())
        for side in np.argsort(-extent, kind="stable"):
            order = np.argsort(points[:, side], kind="stable")
            sorted_ = points[order, side]
            gaps = np.flatnonzero(np.diff(sorted_) > 1e-8) + 1
            if len(gaps) == 0:
                continue
            middle = len(inside) // 2
            below = min(gaps, key=lambda k: (abs(k - middle), k))
            at_cut = 0.5 * (sorted_[below - 1] + sorted_[below])
            for part, ends in ((order[:below], (low, np.where(np.arange(3) == side, at_cut, high))),
                               (order[below:], (np.where(np.arange(3) == side, at_cut, low), high))):
                cut(inside[part], *ends)
            return
        out[inside] = (high[0]**2 - low[0]**2) * (high[1]**2 - low[1]**2) * (high[2] - low[2]) / len(inside)

    cut(np.arange(len(at)), np.zeros(3), np.ones(3))
    return out * len(at)


@pytest.mark.parametrize("seed", range(4))
def test_solid_angles_by_another_program(seed):
    rng = np.random.default_rng(seed)
    light = uniform(700, rng)
    light[::3] = light[:1]  # a scan among scattered ones
    view = about_the_mirror(light, 0.2, rng)
    light[-50:], view[-50:] = light[:50], view[:50]  # twice
    s = brdffit.Samples.from_arrays(light, view, np.ones(700)).weighted("solid-angle")
    assert s.weighting == "solid-angle" and s.weights.sum() == pytest.approx(700, rel=1e-12)
    # Coordinates differ by half the digits of 1 - cos near the normal, shares by that over the width of a piece.
    assert np.median(np.abs(s.weights / shares(light, view) - 1)) < 1e-10
    assert np.abs(s.weights / shares(light, view) - 1).max() < 1e-4


def test_other_weights():
    s = brdffit.Samples.example()
    assert s.weighting == "none" and s.weights is None and not s.crowded()
    assert np.allclose(s.weighted("cosine").weights, s.light[:, 2] / np.linalg.norm(s.light, axis=1), rtol=1e-14)
    radiance = s.values * s.light[:, 2:] / np.linalg.norm(s.light, axis=1, keepdims=True)
    m = np.sqrt(((radiance / np.abs(radiance).max(0))**2).mean(1))
    assert np.allclose(s.weighted("relative", floor=0.05).weights, 1 / np.maximum(m, 0.05)**2, rtol=1e-12)
    zero = brdffit.Samples.from_arrays(s.light, s.view, s.values, weights=np.arange(len(s)) % 2)
    assert zero.weighting == "column" and zero.weighted("column") is zero
    for weight in ("none", "cosine", "solid-angle", "relative"):
        assert ((zero.weighted(weight).weights == 0) == (zero.weights == 0)).all()
    assert s.weighted("cosine").weighted("none").weights is None
    with pytest.raises(brdffit.OptionError, match="weight must be one of 'none', 'column'"):
        s.weighted("solid")
    with pytest.raises(brdffit.BrdffitError, match="no weights of their own"):
        s.weighted("column")
    with pytest.raises(brdffit.BrdffitError, match="floor"):
        s.weighted("relative", floor=0)


def test_fit_says_its_weights():
    s = brdffit.Samples.example()
    fit = brdffit.fit(s, weight="solid-angle", relative_gap=0.01)
    same = brdffit.fit(s.weighted("solid-angle"), relative_gap=0.01)
    assert "weighted by the solid angle" in " ".join(str(fit).split()) and "weighted" not in str(brdffit.fit(s, relative_gap=0.01))
    assert fit.weighting == "solid-angle" and fit.e2 == same.e2 and fit.e2 != brdffit.fit(s, relative_gap=0.01).e2
    assert json.loads(fit.to_json())["weighting"] == "solid-angle"
    assert brdffit.Fit.from_json(fit.to_json()).weighting == "solid-angle"


def test_crowded():
    """Uniform sets never warn, those of an instrument that follows the lobe always, grids of angles not either."""
    lobe = brdffit.fit(brdffit.Samples.example(), relative_gap=0.01)
    for seed in range(5):
        rng = np.random.default_rng(seed)
        light = uniform(2000, rng)
        for view, expected in ((uniform(2000, rng), False), (about_the_mirror(light, 0.1, rng), True)):
            assert brdffit.Samples.from_arrays(light, view, lobe.predict(light, view)).crowded() == expected
    light, view = brdffit.protocol84()
    assert not brdffit.Samples.from_arrays(light, view, lobe.predict(light, view)).crowded()
    few = brdffit.Samples.from_arrays(light[:15], view[:15], np.ones(15))
    assert not few.crowded()


def test_report_warns(tmp_path):
    path = tmp_path / "made_up.bsdf"
    path.write_bytes(rgl_files.tensor_bytes(rgl_files.material()))
    words = "crowd where the material is bright"
    s = brdffit.Samples.from_file(path)
    rng = np.random.default_rng(1)
    light = uniform(500, rng)
    view = about_the_mirror(light, 0.1, rng)
    lobe = brdffit.fit(brdffit.Samples.example(), relative_gap=0.01)
    crowd = brdffit.Samples.from_arrays(light, view, lobe.predict(light, view))
    quick = {"lobes": 1, "relative_gap": 0.1}
    assert s.weighting == "solid-angle" and words not in report.page(s, "weighted", **quick)
    assert "weighted by the solid angle" in report.page(s, "weighted", **quick)
    assert words in report.page(crowd, "plain", **quick)
    assert words not in report.page(crowd.weighted("solid-angle"), "weighted", **quick)


def test_equal_directions_are_one_sample(tmp_path):
    path = tmp_path / "made_up.bsdf"
    path.write_bytes(rgl_files.tensor_bytes(rgl_files.material()))
    s = brdffit.Samples.from_rgl(path)
    both = np.hstack([s.light, s.view])
    assert s.dropped["repeated"] > 0 and len(np.unique(np.round(both, 5), axis=0)) == len(s)
    assert s.weights.mean() == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("name", ["cc_ibiza_sunset_rgb", "vch_silk_blue_rgb"])
def test_real_measurements_as_if_taken_uniformly(name):
    """The median factor between model and material over 6,000 uniform directions is that of a fit to uniform directions,
    10 % allowed; without weights it is not, and the samples say so."""
    path = DATA / "rgl" / (name + ".bsdf")
    if not path.exists():
        pytest.skip(f"no {path}: set BRDFFIT_DATA")
    rng = np.random.default_rng(20)
    material = brdffit.load_rgl(path)
    light, view = uniform(26000, rng), uniform(26000, rng)
    truth = material.lookup(light, view)
    seen = (light[:, 2] >= 0.5) & (truth > 0).all(1)  # up to 60 degrees, what was fitted; NaN is not above 0
    light, view, truth = light[seen][:6000], view[seen][:6000], truth[seen][:6000]
    assert len(light) == 6000

    def factor(samples, **more):
        fit = brdffit.fit(samples, lobes=2, distribution="ggx", relative_gap=0.01, **more)
        ratio = np.maximum(fit.predict(light, view), 1e-300) / truth
        return np.median(np.maximum(ratio, 1 / ratio))

    measured = material.samples()
    reference = factor(material.samples((uniform(12000, rng), uniform(12000, rng))))
    assert factor(measured) <= 1.1 * reference
    assert factor(measured, weight="none") > 1.1 * reference
    assert measured.weighting == "solid-angle" and measured.weighted("none").crowded()
