"""The class of fits, for types: its method calls this package. SPDX-License-Identifier: MIT"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..fit import Fit
else:
    Fit = Any

__all__ = ["Fit"]
