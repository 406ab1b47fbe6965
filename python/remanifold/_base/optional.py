# SPDX-License-Identifier: GPL-3.0-or-later
"""Packages that only some functions need, imported when these are called."""

from __future__ import annotations

import importlib
from typing import Any


def load(package: str, extra: str) -> Any:
    """Import a module, or say which extra of this package has it."""
    try:
        return importlib.import_module(package)
    except ImportError as error:
        msg = f"{error}; this needs `pip install remanifold[{extra}]`"
        raise ImportError(msg, name=error.name) from error
