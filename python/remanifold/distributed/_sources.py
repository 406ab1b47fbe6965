# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the samples come from: read in chunks, by whoever needs them."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.files import complete_file


@dataclass(frozen=True)
class Source:
    """A .npy file of shape (N, D), which workers map into memory."""

    path: str

    def _open(self) -> NDArray[Any]:
        array: NDArray[Any] = np.load(self.path, mmap_mode="r")
        if array.ndim != 2 or array.shape[1] < 1:
            msg = f"{self.path} has shape {array.shape}, expected (N, D)"
            raise ValueError(msg)
        if array.dtype.kind not in "fiu":
            msg = f"{self.path} holds {array.dtype}, expected real numbers"
            raise TypeError(msg)
        return array

    def shape(self) -> tuple[int, int]:
        """Of all samples."""
        rows, columns = self._open().shape
        return int(rows), int(columns)

    def read(self, begin: int, end: int) -> NDArray[np.float64]:
        """Some rows."""
        return np.ascontiguousarray(self._open()[begin:end], dtype=np.float64)

    def identity(self) -> dict[str, Any]:
        """What changes when the samples do."""
        at = Path(self.path).stat()
        return {"path": self.path, "bytes": at.st_size, "modified": at.st_mtime_ns}


def source_of(source: object, work: Path) -> tuple[Source, dict[str, Any]]:
    """The source of what the caller gave, and its identity.

    An array goes into the directory of the run, where workers find it.
    """
    if isinstance(source, (str, Path)):
        path = Path(source).resolve()
        if path.suffix != ".npy":
            msg = f"source is {path.name}, expected a .npy file or an array"
            raise ValueError(msg)
        if not path.is_file():
            msg = f"source {path} is no file"
            raise FileNotFoundError(msg)
        named = Source(str(path))
        return named, named.identity()
    array = np.ascontiguousarray(source, dtype=np.float64)
    if array.ndim != 2:
        msg = f"source has {array.ndim} axes, expected 2: shape (N, D)"
        raise ValueError(msg)
    digest = hashlib.blake2b(
        array.reshape(-1).view(np.uint8).data, digest_size=16
    ).hexdigest()
    path = work / f"source-{digest}.npy"
    if not path.is_file():
        path.parent.mkdir(parents=True, exist_ok=True)
        with complete_file(path) as file:
            np.save(file, array)
    return Source(str(path)), {"digest": digest, "shape": list(array.shape)}
