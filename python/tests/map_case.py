"""A small map with one of everything that can happen to a texel. SPDX-License-Identifier: MIT"""
import numpy as np
import pytest

import brdffit
import stacks

ARRAYS = ("sigma", "x", "y", "channel_scale", "e2", "lower_bound", "sum_of_squares", "status", "stop", "where", "boxes")
CERTIFIED, OPEN, NO_SIGNAL, MASKED, BAD_VALUE, REFUSED, NO_SAMPLES, NOT_REACHED = range(8)


def same(a, b, index=...):
    return all(np.array_equal(getattr(a, name)[index], getattr(b, name), equal_nan=True) for name in ARRAYS)


@pytest.fixture(scope="session")
def desk():
    """84 x 9 x 7 x 3 float32, light, view: with a masked texel, bad ones, one without signal, two that are equal, one
    that is refused, and zero and equal channels."""
    stack, light, view = stacks.make(9, 7)
    stack = stack.astype(np.float32)
    used = np.flatnonzero(light[:, 2] > 0.6)
    stack[used[5], 2, 3, 1] = np.nan
    stack[used[3], 4, 4, 2] = np.inf
    stack[:, 5, 5] = 0
    stack[:, 6, 1] = stack[:, 6, 0]
    stack[:, 7, 2, 1] = 0
    stack[:, 7, 3, 2] = stack[:, 7, 3, 0]
    return stack, light, view


@pytest.fixture(scope="session")
def mask():
    mask = np.ones((9, 7), bool)
    mask[0, 6] = mask[8, 0] = False
    return mask


@pytest.fixture(scope="session")
def whole(desk, mask):
    return brdffit.fit_map(*desk, mask=mask)
