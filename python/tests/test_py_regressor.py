"""BRDFRegressor as scikit-learn sees it. SPDX-License-Identifier: MIT"""
import numpy as np
import pytest
from sklearn.base import clone
from sklearn.model_selection import GridSearchCV
from sklearn.utils.estimator_checks import check_estimator

import brdffit


def fold(X):
    """Any columns to directions within 60 degrees, so that scikit-learn's own data can be fitted."""
    a = np.tanh(X[:, 0]) * 0.9
    b = np.tanh(X[:, -1]) * 0.9
    return (np.stack([np.sin(a), 0 * a, np.cos(a)], 1), np.stack([np.sin(b), 0 * b, np.cos(b)], 1))


def test_check_estimator():
    """Every check of scikit-learn passes on columns of any number. With `features` a word, X has 6, 4 or 3 columns and
    others are refused: the only deviation, and it is why a function is given here."""
    done = check_estimator(brdffit.BRDFRegressor(features=fold), on_skip=None)
    bad = [(c["check_name"], c["status"]) for c in done if c["status"] not in ("passed", "skipped")]
    assert not bad and sum(c["status"] == "passed" for c in done) > 40


def test_directions_and_angles():
    samples = brdffit.Samples.example()
    X = np.hstack([samples.light, samples.view])
    regressor = brdffit.BRDFRegressor(lobes=2).fit(X, samples.values)
    direct = brdffit.fit(samples, lobes=2)
    assert np.array_equal(regressor.sigma_, direct.sigma)
    assert np.array_equal(regressor.predict(X), direct.predict_samples(samples)) and regressor.score(X, samples.values) > 0.95
    degrees = np.degrees([[np.arccos(np.clip(d[2], -1, 1)), np.arctan2(d[1], d[0])] for d in samples.light]), \
        np.degrees([[np.arccos(np.clip(d[2], -1, 1)), np.arctan2(d[1], d[0])] for d in samples.view])
    by_angles = brdffit.BRDFRegressor(features="angles", lobes=2).fit(np.hstack(degrees), samples.values)
    assert np.allclose(by_angles.sigma_, direct.sigma, rtol=1e-6)
    with pytest.raises(ValueError, match="needs 6"):
        clone(regressor).fit(X[:, :5], samples.values)
    with pytest.raises(ValueError, match="features"):
        brdffit.BRDFRegressor(features="words").fit(X, samples.values)
    search = GridSearchCV(brdffit.BRDFRegressor(), {"lobes": [1, 2]}, cv=3).fit(X, samples.values)
    assert search.best_params_ == {"lobes": 2}
