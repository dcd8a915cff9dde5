"""Anisotropic lobes in Python. SPDX-License-Identifier: MIT"""
import numpy as np
import pytest

import brdffit


def measured(along, across, count=200):
    rng = np.random.default_rng(2)
    alpha, phi = 0.9 * rng.random(count) * rng.random(count), 2 * np.pi * rng.random(count)
    half = np.stack([np.sin(alpha) * np.cos(phi), np.sin(alpha) * np.sin(phi), np.cos(alpha)], 1)
    tilt, turn = 0.8 * rng.random(count), 2 * np.pi * rng.random(count)
    light = np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], 1)
    view = 2 * np.sum(light * half, 1, keepdims=True) * half - light
    up = view[:, 2] > 0.1
    light, view, half = light[up], view[up], half[up]
    exponent = (half[:, 0] / half[:, 2] / along) ** 2 + (half[:, 1] / half[:, 2] / across) ** 2
    ward = np.sqrt(light[:, 2] / view[:, 2]) / (4 * np.pi) * np.exp(-exponent) / (along * across)
    return brdffit.Samples.from_arrays(light, view, 0.1 * light[:, 2] / np.pi + 0.2 * ward, quantity="radiance")


def test_fit_and_its_json():
    samples = measured(0.12, 0.3)
    fit = brdffit.fit(samples, distribution="ward", anisotropic=True, max_incidence=90)
    assert fit.certified and fit.sigma_xy[0] == pytest.approx([0.12, 0.3], rel=1e-9)
    assert fit.anisotropy[0] == pytest.approx(0.4, rel=1e-9) and fit.azimuth_share is None
    assert "anisotropic" in repr(fit) and "every σ" in fit.certificate
    again = brdffit.Fit.from_json(fit.to_json())
    assert again.predict_samples(samples) == pytest.approx(samples.values, rel=1e-9)
    assert again.to_json() == fit.to_json()


def test_tangents_and_directions():
    samples = measured(0.12, 0.3)
    fit = brdffit.fit(samples, distribution="ward", anisotropic=True, max_incidence=90)
    turned = brdffit.Samples.from_arrays(samples.light, samples.view, samples.values, quantity="radiance",
                                         tangent=(0.0, 1.0, 0.0))
    other = brdffit.fit(turned, distribution="ward", anisotropic=True, max_incidence=90)
    assert other.sigma_xy[0] == pytest.approx([0.3, 0.12], rel=1e-9)
    assert other.predict(samples.light, samples.view, tangent=(0.0, 1.0, 0.0)) == pytest.approx(
        fit.predict(samples.light, samples.view), rel=1e-9)


def test_isotropic_fit_tells_of_the_azimuth():
    fit = brdffit.fit(measured(0.2, 0.3), distribution="ward", max_incidence=90)
    assert fit.azimuth_share > 0.5 and fit.sigma_xy is None
    assert brdffit.fit(measured(0.25, 0.25), distribution="ward", max_incidence=90).azimuth_share < 0.01


def test_maps_refuse():
    with pytest.raises(brdffit.BrdffitError, match="anisotropic"):
        brdffit.fit_map(np.ones((4, 2, 2, 1)), np.tile([0.0, 0.0, 1.0], (4, 1)), np.tile([0.0, 0.1, 1.0], (4, 1)),
                        anisotropic=True)
