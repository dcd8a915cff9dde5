"""Packages that only one reader needs. SPDX-License-Identifier: MIT"""
from __future__ import annotations

import importlib
from typing import Any

from ..errors import UnsupportedError


def need(module: str, extra: str, what: str) -> Any:
    """An optional package, or an error that says how to have it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise UnsupportedError('reading %s needs the package %s: pip install "brdffit[%s]" (%s)' % (
            what, module, extra, error), code="unsupported") from error
