# SPDX-License-Identifier: GPL-3.0-or-later
"""What a distributed reconstruction leaves: a manifest, and what it says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold.distributed._sources import Source
from remanifold.distributed._store import Part, Store


@dataclass(frozen=True)
class DistributedTopology:
    """What the complex is, counted over all tiles."""

    num_simplices: tuple[int, ...]
    euler_characteristic: int
    components: int
    orientable: bool
    closed: bool
    manifold: bool
    num_open_faces: int
    num_callous_faces: int
    num_singular_vertices: int


class DistributedReconstruction:
    """Simplices in parts, read when they are asked for.

    Attributes
    ----------
    directory : str
        Where the run and its manifest, ``manifest.json``, are.
    manifest : dict
        What the manifest says: parts with their rows and bytes, and how they came about.
    """

    def __init__(self, directory: str) -> None:
        self.directory = directory
        store = Store(directory)
        manifest = store.read_json("manifest.json")
        if manifest is None:
            msg = f"{directory} holds no manifest.json: no finished run"
            raise FileNotFoundError(msg)
        self.manifest: dict[str, Any] = manifest
        self._store = store

    def __repr__(self) -> str:
        count = self.manifest["num_simplices"]
        return (
            f"<DistributedReconstruction: {count:,} simplices of dimension {self.dim}, "
            f"{self.manifest['num_samples']:,} samples, in "
            f"{len(self.manifest['simplices'])} parts>"
        )

    @property
    def dim(self) -> int:
        """K."""
        return int(self.manifest["dim"])

    @property
    def topology(self) -> DistributedTopology:
        """Counts of faces, components and so on: exact, of the whole."""
        said = dict(self.manifest["topology"])
        said["num_simplices"] = tuple(said["num_simplices"])
        return DistributedTopology(**said)

    def simplex_parts(self) -> Any:
        """Arrays of shape (M, K+1), int64, one a part; a simplex is in one of them."""
        for said in self.manifest["simplices"]:
            yield self._store.get(Part(**said))["simplices"]

    @property
    def simplices(self) -> NDArray[np.int32] | NDArray[np.int64]:
        """All of them, in order: those of `remanifold.reconstruct`, to the byte."""
        rows = np.concatenate(list(self.simplex_parts()))
        order = np.lexsort(np.sort(rows, axis=1).T[::-1])
        fits = self.manifest["num_samples"] <= np.iinfo(np.int32).max
        return rows[order].astype(np.int32 if fits else np.int64)

    @property
    def vertices(self) -> NDArray[np.float64]:
        """All samples, read from the source."""
        source = Source(**self.manifest["source"])
        return source.read(0, self.manifest["num_samples"])
