# SPDX-License-Identifier: GPL-3.0-or-later
"""The distinct values of an array."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_Value = TypeVar("_Value", bound=np.generic)


def distinct(values: NDArray[_Value]) -> NDArray[_Value]:
    """As np.unique(values), which imports numpy.ma: 0.05 s of the first reconstruction."""
    ascending = np.sort(values, axis=None)
    first = np.ones(len(ascending), dtype=bool)
    first[1:] = ascending[1:] != ascending[:-1]
    return ascending[first]
