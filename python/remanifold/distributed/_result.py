# SPDX-License-Identifier: GPL-3.0-or-later
"""What a distributed reconstruction leaves: a manifest, and what it says."""

from __future__ import annotations

import bisect
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold.distributed._sources import Source
from remanifold.distributed._store import Arrays, Part, Store
from remanifold.distributed._writing import write_ply

# Simplices, and samples, that are put in order or written at once.
ROWS = 1_000_000


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


def _first_from(table: NDArray[np.int64], vertex: int, begin: int) -> int:
    """The first row of a sorted table, from one on, that has no lower vertex."""

    def lowest(row: int) -> int:
        return int(table[row].min())

    return bisect.bisect_left(range(len(table)), vertex, begin, key=lowest)


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

    def _parts(self) -> list[Part]:
        return [Part(**said) for said in self.manifest["simplices"]]

    def simplex_parts(self) -> Iterator[NDArray[np.int64]]:
        """Arrays of shape (M, K+1), int64, one a part; a simplex is in one of them."""
        for part in self._parts():
            self._store.check_table(part)
            yield np.array(self._store.table(part))

    def simplex_blocks(self) -> Iterator[NDArray[np.int64]]:
        """All simplices in the order of `simplices`, a million or so at once."""
        for part in self._parts():
            self._store.check_table(part)
        tables = [self._store.table(part) for part in self._parts()]
        num_samples = self.manifest["num_samples"]
        begins, vertex = [0] * len(tables), 0
        left = sum(map(len, tables))
        # Rows of a part are in order, so that those with a low first vertex lead.
        step = max(1, num_samples * ROWS // max(left, 1))
        while left:
            vertex += step
            ends = [
                _first_from(table, vertex, begin)
                for table, begin in zip(tables, begins, strict=True)
            ]
            block = np.concatenate(
                [t[b:e] for t, b, e in zip(tables, begins, ends, strict=True)]
            )
            left -= len(block)
            begins = ends
            yield block[np.lexsort(np.sort(block, axis=1).T[::-1])]

    @property
    def simplices(self) -> NDArray[np.int32] | NDArray[np.int64]:
        """All of them, in order: those of `remanifold.reconstruct`, to the byte."""
        fits = self.manifest["num_samples"] <= np.iinfo(np.int32).max
        blocks = [np.empty((0, self.dim + 1), dtype=np.int64), *self.simplex_blocks()]
        return np.concatenate(blocks).astype(np.int32 if fits else np.int64)

    @property
    def source(self) -> Source:
        """Where the samples are; its ``read`` and ``attributes`` give rows of them."""
        return Source.of(self.manifest["source"])

    @property
    def vertices(self) -> NDArray[np.float64]:
        """All samples, read from the source."""
        return self.source.read(0, self.manifest["num_samples"])

    def attributes(self, begin: int = 0, end: int | None = None) -> Arrays:
        """What the source says of some samples besides where they are.

        Parameters
        ----------
        begin, end : int
            Numbers of samples; by default of all.

        Returns
        -------
        dict of str to numpy.ndarray
            Intensity, colors and so on, one row a sample.
        """
        rows = self.manifest["num_samples"]
        return self.source.attributes(begin, rows if end is None else min(end, rows))

    def write(self, path: str | Path, *, attributes: bool = True) -> None:
        """Write a .ply file, piece by piece: nothing is in memory as a whole.

        Parameters
        ----------
        path : str or Path
            Where to; written under another name and renamed into place.
        attributes : bool
            Whether to write what the source says of each sample besides.
        """
        write_ply(
            Path(path),
            self.source,
            self.manifest["num_samples"],
            self.dim,
            self.manifest["num_simplices"],
            self.simplex_blocks(),
            with_attributes=attributes,
        )
