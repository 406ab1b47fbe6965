# SPDX-License-Identifier: GPL-3.0-or-later
"""Results whose arrays cannot be written to by mistake."""

from __future__ import annotations

from typing import Any

import numpy as np


class ReadOnlyArrays:
    """Base of dataclasses whose arrays, also in tuples and dictionaries, are read-only."""

    def __post_init__(self) -> None:
        for value in vars(self).values():
            held = [*value.values()] if isinstance(value, dict) else value
            for array in held if isinstance(held, tuple | list) else (held,):
                if isinstance(array, np.ndarray):
                    array.flags.writeable = False

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self.__post_init__()
