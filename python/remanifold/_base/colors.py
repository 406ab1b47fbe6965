# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors as files and people have them: bytes, shares of one, 16 bits."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def byte_colors(colors: NDArray[Any]) -> NDArray[Any]:
    """Colors as bytes, as viewers want them.

    Of 16 bits, as LAS has them, the high byte counts where any is above 255; shares of
    one are taken times 255. What is none of these stays.
    """
    if colors.dtype == np.uint8 or colors.ndim != 2 or colors.shape[1] not in (3, 4):
        return colors
    if not colors.size or not np.isfinite(colors).all() or colors.min() < 0:
        return colors
    most = colors.max()
    if colors.dtype.kind == "f" and most <= 1:
        return np.asarray(np.rint(colors * 255).astype(np.uint8))
    if most > 65535 or not are_whole(colors):
        return colors
    return np.asarray((colors // 256 if most > 255 else colors).astype(np.uint8))


def are_colors(values: NDArray[Any]) -> bool:
    """Whether these are colors, each of three numbers or four."""
    width = values.shape[1] if values.ndim == 2 else 0
    return width in (3, 4) and byte_colors(values).dtype == np.uint8


def are_whole(values: NDArray[Any]) -> bool:
    """Whether all numbers are whole."""
    if values.dtype.kind in "biu":
        return True
    return bool((np.isfinite(values) & (np.trunc(values) == values)).all())
