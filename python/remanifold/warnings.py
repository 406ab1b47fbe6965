# SPDX-License-Identifier: GPL-3.0-or-later
"""Warning classes, all under one base so that they can be filtered together."""

__all__ = [
    "DimensionWarning",
    "DoubtWarning",
    "DroppedWarning",
    "FileWarning",
    "ManifoldWarning",
    "MatrixWarning",
    "MissingWarning",
    "RecallWarning",
    "RemanifoldWarning",
    "TransposedWarning",
]


class RemanifoldWarning(UserWarning):
    """Base of all warnings of this package."""


class RecallWarning(RemanifoldWarning):
    """The approximate neighbor search missed neighbors."""


class DimensionWarning(RemanifoldWarning):
    """The dimension does not look right, or what was found for it is uncertain."""


class ManifoldWarning(RemanifoldWarning):
    """The result is not the manifold that was asked for; `repair` says where."""


class FileWarning(RemanifoldWarning):
    """Something in a file was left out, or it was guessed what its columns are."""


class DoubtWarning(RemanifoldWarning):
    """The samples do not determine the result; `quality` says more, and looks closer.

    It is given for what shows without further work: few samples, close decisions about
    openings, parts far from all others, many disputed simplices. Whenever it is given,
    `quality` is not ok; the converse does not hold.
    """


class DroppedWarning(RemanifoldWarning):
    """Samples were left out as outliers, which nobody asked for."""


class MatrixWarning(RemanifoldWarning):
    """What was given as points is a matrix of inner products or of distances."""


class MissingWarning(RemanifoldWarning):
    """Many samples lie at one position, as those do that mark missing ones."""


class TransposedWarning(RemanifoldWarning):
    """The array looks as if its rows were its columns."""


def __dir__() -> list[str]:
    """Public names only."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})


# Filters and messages name them by where users find them, whatever else is loaded.
for _name in __all__:
    globals()[_name].__module__ = "remanifold"
