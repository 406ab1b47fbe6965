# SPDX-License-Identifier: GPL-3.0-or-later
"""Reconstruction in tiles, by the workers of a Dask cluster."""

from remanifold.distributed._result import (
    DistributedReconstruction,
    DistributedTopology,
)
from remanifold.distributed._run import BeyondTilesError, reconstruct
from remanifold.distributed._sources import ChangedSourceError
from remanifold.distributed._store import LostPartError

__all__ = [
    "BeyondTilesError",
    "ChangedSourceError",
    "DistributedReconstruction",
    "DistributedTopology",
    "LostPartError",
    "reconstruct",
]
