# SPDX-License-Identifier: GPL-3.0-or-later
"""Names that had another one before."""

from __future__ import annotations

import warnings
from typing import TypeVar

T = TypeVar("T")


def renamed(old_name: str, old: T, name: str, value: T) -> T:
    """Take what was given by the old name, and say so to whoever called the caller."""
    if old is None:
        return value
    if value is not None:
        msg = f"{old_name} is the old name of {name}: give one of them"
        raise TypeError(msg)
    warnings.warn(
        f"{old_name} is called {name} now; the old name goes with the next version",
        DeprecationWarning,
        stacklevel=3,
    )
    return old
