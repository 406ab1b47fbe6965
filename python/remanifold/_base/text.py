# SPDX-License-Identifier: GPL-3.0-or-later
"""Results as one line of text."""

from __future__ import annotations

import math


def one_line(result: object, **values: object) -> str:
    """Text for ``repr``: the class and what matters, without what is None."""
    said = (f"{name}={value!r}" for name, value in values.items() if value is not None)
    return f"{type(result).__name__}({', '.join(said)})"


def rounded(value: float) -> float:
    """Four digits of a number, for people."""
    return float(f"{value:.4g}")


def two_digits(number: float) -> int:
    """Round a number of samples up to two digits: it is a guess."""
    unit = int(10 ** max(0, math.floor(math.log10(number)) - 1))
    return math.ceil(number / unit) * unit


def besides(verdict: str, answer: str) -> str:
    """A verdict without the reason that an answer ends with; empty if that is all of it."""
    _, doubt, reason = answer.partition("in doubt: ")
    reason = reason.partition("; what was made is")[0]
    if verdict.lower() in answer.lower():
        return ""
    return verdict.replace(f": {reason}", "", 1) if doubt and reason else verdict
