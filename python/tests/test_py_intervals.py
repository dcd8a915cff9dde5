"""Intervals of every parameter. SPDX-License-Identifier: MIT"""
import itertools

import numpy as np
import pytest

import brdffit


@pytest.fixture(scope="module")
def samples():
    return brdffit.Samples.example()


def columns(fit, samples, sigma):
    """Radiance of each column at the samples, by evaluation."""
    out = []
    for c in range(1 + fit.lobes):
        x, y = np.zeros(len(fit.channels)), np.zeros((len(fit.channels), fit.lobes))
        if c == 0:
            x[:] = 1
        else:
            y[:, c - 1] = 1
        one = brdffit.Fit.from_dict({**fit.to_dict(), "sigma": list(sigma), "x": x.tolist(), "y": y.tolist()})
        out.append(one.predict_samples(samples, quantity="radiance")[:, 0])
    return np.array(out).T


def test_none_outside(samples):
    """Non-negative least squares on a grid of roughness: what comes within the threshold is inside."""
    optimize = pytest.importorskip("scipy.optimize")
    fit = brdffit.fit(samples, lobes=2)
    found = fit.intervals(samples, eta=2.0)
    assert found.threshold == pytest.approx(3 * fit.e2) and found.complete
    values = samples.values * (np.asarray(samples.light)[:, 2:3] if samples.quantity == "brdf" else 1)
    used = np.asarray(samples.light)[:, 2] > np.cos(np.radians(60)) - 1e-9
    inside = 0
    grids = [np.geomspace(low / 1.02, high * 1.02, 13) for low, high in found.sigma]
    for sigma in itertools.product(*grids):
        a = columns(fit, samples, sigma) * used[:, None]
        fitted = [optimize.nnls(a, v * used) for v in values.T]
        if sum((r / s) ** 2 for (_, r), s in zip(fitted, fit.channel_scale)) <= found.threshold:
            inside += 1
            z = np.array([z for z, _ in fitted])
            assert np.all(found.sigma[:, 0] <= sigma) and np.all(sigma <= found.sigma[:, 1])
            assert np.all(found.x[:, 0] <= z[:, 0]) and np.all(z[:, 0] <= found.x[:, 1])
            assert np.all(found.y[..., 0] <= z[:, 1:]) and np.all(z[:, 1:] <= found.y[..., 1])
    assert inside > 10


def test_threshold_and_shape(samples):
    fit = brdffit.fit(samples, lobes=2)
    found = fit.intervals(samples)
    k, p = fit.y.shape
    assert found.sigma.shape == (p, 2) and found.x.shape == (k, 2) and found.y.shape == (k, p, 2)
    assert found.exponent is None and found.f0 is None
    stats = pytest.importorskip("scipy.stats")
    assert found.degrees == fit.samples_used * k - (k * (1 + p) + p)
    assert found.noise == pytest.approx(np.sqrt(fit.e2 / found.degrees), rel=1e-12)
    assert found.threshold == pytest.approx(fit.e2 + stats.chi2.ppf(0.95, 1) * found.noise ** 2, rel=1e-12)
    for name, value in (("sigma", fit.sigma), ("x", fit.x), ("y", fit.y)):
        outer, inner = getattr(found, name), found.inner[name]
        assert np.all(outer[..., 0] <= inner[..., 0]) and np.all(inner[..., 0] <= value * (1 + 1e-12))
        assert np.all(value * (1 - 1e-12) <= inner[..., 1]) and np.all(inner[..., 1] <= outer[..., 1])
    wider = fit.intervals(samples, level=0.999)
    assert np.all(wider.sigma[:, 0] < found.sigma[:, 0]) and np.all(wider.sigma[:, 1] > found.sigma[:, 1])
    assert "95 %" in repr(found)


def test_exponents(samples):
    fit = brdffit.fit(samples, distribution="blinn-phong")
    found = fit.intervals(samples, noise=0.01)
    assert found.exponent is not None
    assert found.exponent[0, 0] <= fit.exponent[0] <= found.exponent[0, 1]
    np.testing.assert_allclose(found.exponent[0], 1 / found.sigma[0, ::-1] ** 2, rtol=1e-12)


def test_errors(samples):
    fit = brdffit.fit(samples)
    for wrong in ({"level": 0}, {"level": 1}, {"noise": -1}, {"eta": np.nan}, {"tolerance": 2}):
        with pytest.raises(brdffit.BrdffitError):
            fit.intervals(samples, **wrong)
