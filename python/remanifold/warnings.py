# SPDX-License-Identifier: GPL-3.0-or-later
"""Warning classes, all under one base so that they can be filtered together."""

__all__ = ["RecallWarning", "RemanifoldWarning"]


class RemanifoldWarning(UserWarning):
    """Base of all warnings of this package."""


class RecallWarning(RemanifoldWarning):
    """The approximate neighbor search missed neighbors."""
