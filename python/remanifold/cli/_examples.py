# SPDX-License-Identifier: GPL-3.0-or-later
"""What the help of all commands has."""

from __future__ import annotations


def examples(*lines: str) -> str:
    """Give what the help of a command ends with; its lines stay as they are."""
    return "\n".join(["\b", "Examples:", *(f"  {line}" for line in lines)])
