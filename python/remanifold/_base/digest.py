# SPDX-License-Identifier: GPL-3.0-or-later
"""Digests of arrays: the same numbers have the same one on any machine."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_CHUNK = 1 << 22  # bytes read at once


def digest(*arrays: NDArray[Any]) -> str:
    """SHA-256 of arrays: of each its dtype, its shape and its bytes in little endian."""
    total = hashlib.sha256()
    for array in arrays:
        little = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
        shape = ",".join(map(str, array.shape))
        total.update(f"{little.dtype.str.replace('|', '<')} {shape}\n".encode())
        total.update(little.reshape(-1).view(np.uint8).data)
    return f"sha256:{total.hexdigest()}"


def digest_of_file(path: Path) -> str:
    """SHA-256 of a file, as ``sha256sum`` says it."""
    total = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK):
            total.update(chunk)
    return f"sha256:{total.hexdigest()}"
