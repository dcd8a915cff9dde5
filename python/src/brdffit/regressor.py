"""The fit as a scikit-learn regressor. SPDX-License-Identifier: MIT"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import _check_sample_weight, check_is_fitted, validate_data

from ._arrays import Floats
from .fit import run
from .options import Options
from .samples import Samples

if TYPE_CHECKING:
    from typing_extensions import Self

Directions = tuple[Floats, Floats]
Features = str | Callable[[Floats], Directions]

_WIDTHS = {"directions": 6, "angles": 4, "coefficients": 3}


class BRDFRegressor(RegressorMixin, BaseEstimator):  # type: ignore[misc]  # scikit-learn has no types
    """Reflectance from directions.

    features: what the columns of X are
        "directions": lx, ly, lz, vx, vy, vz around the normal +z
        "angles": theta_i, phi_i, theta_o, phi_o in degrees
        "coefficients": the model's a, b, c; y is radiance then
        a function of X (n x anything) that returns light and view, n x 3 each
    quantity: what y is, "brdf" (f_r) or "radiance" (f_r n.l)
    lobes and everything after it: see brdffit.Options

    After `fit`: fit_ (the brdffit.Fit with its certificate), sigma_, n_features_in_.
    """

    def __init__(self, *, features: Features = "directions", quantity: str = "brdf",
                 lobes: int | Sequence[str] = 1, distribution: str | None = None, norm: str = "l2", engine: str = "moment",
                 normalise: str = "max",
                 sigma_range: tuple[float, float] = (1e-12, 6.0), exponent_range: tuple[float, float] = (0.1, 1e7),
                 relative_gap: float = 1e-3, absolute_gap: float = 1e-12, box_budget: int = 1_000_000,
                 max_incidence: float | None = None, fresnel: str = "none", diffuse: str = "lambert",
                 masking: str = "v-cavity") -> None:
        self.features = features
        self.quantity = quantity
        self.lobes = lobes
        self.distribution = distribution
        self.norm = norm
        self.engine = engine
        self.normalise = normalise
        self.sigma_range = sigma_range
        self.exponent_range = exponent_range
        self.relative_gap = relative_gap
        self.absolute_gap = absolute_gap
        self.box_budget = box_budget
        self.max_incidence = max_incidence
        self.fresnel = fresnel
        self.diffuse = diffuse
        self.masking = masking

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.target_tags.multi_output = True
        # Coefficients are not negative: a target that is mostly below zero is fitted by 0.
        tags.regressor_tags.poor_score = True
        return tags

    def fit(self, X: npt.ArrayLike, y: npt.ArrayLike, sample_weight: npt.ArrayLike | None = None) -> Self:
        """Fit, and prove. X: n x columns, as `features` says; y: n, or n x channels, which share the roughness.
        sample_weight: n, multiplies squared residuals."""
        data, target = validate_data(self, X, y, dtype=np.float64, multi_output=True, y_numeric=True)
        weights = None
        if sample_weight is not None:
            weights = _check_sample_weight(sample_weight, data, dtype=np.float64, ensure_non_negative=True)
        self._one_channel = target.ndim == 1
        self.fit_ = run(self._samples(data, np.asarray(target, dtype=np.float64), weights), self._options(), None, None, {})
        self.sigma_ = self.fit_.sigma
        return self

    def predict(self, X: npt.ArrayLike) -> Floats:
        """The fitted model at X: n, or n x channels, in the quantity of y. 0 on and below the horizon."""
        check_is_fitted(self)
        data = validate_data(self, X, dtype=np.float64, reset=False)
        samples = self._samples(data, np.zeros((len(data), len(self.fit_.channels))), None)
        out = self.fit_.predict_samples(samples)
        return out[:, 0] if self._one_channel else out

    def _options(self) -> Options:
        return Options(self.lobes, self.distribution, self.norm, self.engine, self.normalise, self.sigma_range,
                       self.exponent_range, self.relative_gap, self.absolute_gap, 0.0, self.box_budget,
                       self.max_incidence, fresnel=self.fresnel, diffuse=self.diffuse, masking=self.masking)

    def _samples(self, data: Floats, values: Floats, weights: Floats | None) -> Samples:
        if not callable(self.features):
            width = _WIDTHS.get(self.features)
            if width is None:
                raise ValueError("features must be one of %s or a function, not %r" % (
                    ", ".join(map(repr, _WIDTHS)), self.features))
            if data.shape[1] != width:
                raise ValueError("X has %d columns; features %r needs %d" % (data.shape[1], self.features, width))
        if self.features == "coefficients":
            return Samples.from_coefficients(data[:, 0], data[:, 1], data[:, 2], values, weights=weights)
        if callable(self.features):
            light, view = self.features(data)
        elif self.features == "angles":
            light, view = _unit(data[:, 0], data[:, 1]), _unit(data[:, 2], data[:, 3])
        else:
            light, view = data[:, :3], data[:, 3:]
        return Samples.from_arrays(light, view, values, weights=weights, quantity=self.quantity)


def _unit(theta: Floats, phi: Floats) -> Floats:
    theta, phi = np.radians(theta), np.radians(phi)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
