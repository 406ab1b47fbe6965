# SPDX-License-Identifier: GPL-3.0-or-later
"""Warning classes, all under one base so that they can be filtered together."""

__all__ = [
    "DimensionWarning",
    "FileWarning",
    "ManifoldWarning",
    "RecallWarning",
    "RemanifoldWarning",
]


class RemanifoldWarning(UserWarning):
    """Base of all warnings of this package."""


class RecallWarning(RemanifoldWarning):
    """The approximate neighbor search missed neighbors."""


class DimensionWarning(RemanifoldWarning):
    """The dimension that was found from the samples is uncertain."""


class ManifoldWarning(RemanifoldWarning):
    """The result is not the manifold that was asked for; `repair` says where."""


class FileWarning(RemanifoldWarning):
    """Something in a file was left out, or it was guessed what its columns are."""
