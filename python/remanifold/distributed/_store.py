# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a run as files that are whole or not there.

Each is written under another name and renamed into place under one that holds a digest of
its content; the record that says which step made it comes last. A run that goes on reads the
records.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]


class LostPartError(RuntimeError):
    """A part of a run is missing, or is not what was written."""


@dataclass(frozen=True)
class Part:
    """A file of arrays, with what is known of it without reading it."""

    path: str
    size: int
    meta: dict[str, Any] = field(default_factory=dict)


def _rename_into_place(written: str, path: Path) -> None:
    with open(written, "rb") as file:  # noqa: PTH123
        os.fsync(file.fileno())
    os.replace(written, path)  # noqa: PTH105


class Store:
    """The directory of a run, as every worker sees it."""

    def __init__(self, root: str) -> None:
        self.root = root

    def put(self, step: str, arrays: Arrays, meta: dict[str, Any]) -> Part:
        """Write the arrays of a step, which has them as a whole or not at all."""
        folder = Path(self.root) / "parts"
        folder.mkdir(parents=True, exist_ok=True)
        handle, written = tempfile.mkstemp(dir=folder, suffix=".writing")
        digest = hashlib.blake2b(digest_size=12)
        try:
            with os.fdopen(handle, "wb") as file:
                np.savez(file, **arrays)  # type: ignore[arg-type]
            for name in sorted(arrays):
                array = np.ascontiguousarray(arrays[name])
                digest.update(f"{name} {array.dtype.str} {array.shape}".encode())
                digest.update(
                    array.reshape(-1).view(np.uint8).data if array.size else b""
                )
            path = folder / f"{step}-{digest.hexdigest()}.npz"
            size = Path(written).stat().st_size
            _rename_into_place(written, path)
        except BaseException:
            Path(written).unlink(missing_ok=True)
            raise
        return Part(str(path.relative_to(self.root)), size, meta)

    def get(self, part: Part, *names: str) -> Arrays:
        """Arrays of a part; checked as they are read.

        Raises
        ------
        LostPartError
            It is missing, shorter than written, or damaged.
        """
        path = self._checked(part)
        try:
            with np.load(path) as file:
                return {name: file[name] for name in names or file.files}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
            msg = f"{path} is damaged ({error}): delete it and run with resume=True"
            raise LostPartError(msg) from None

    def _checked(self, part: Part) -> Path:
        path = Path(self.root) / part.path
        try:
            size = path.stat().st_size
        except OSError:
            msg = f"{path} is missing: run again with resume=True to make it anew"
            raise LostPartError(msg) from None
        if size != part.size:
            msg = (
                f"{path} has {size:,} bytes instead of {part.size:,}: run again with "
                "resume=True to make it anew"
            )
            raise LostPartError(msg)
        return path

    def put_table(self, step: str, table: NDArray[Any], meta: dict[str, Any]) -> Part:
        """Write one array that will be read in pieces."""
        folder = Path(self.root) / "parts"
        folder.mkdir(parents=True, exist_ok=True)
        handle, written = tempfile.mkstemp(dir=folder, suffix=".writing")
        try:
            with os.fdopen(handle, "wb") as file:
                np.save(file, table)
            digest = hashlib.blake2b(table.view(np.uint8).data, digest_size=12)
            path = folder / f"{step}-{digest.hexdigest()}.npy"
            size = Path(written).stat().st_size
            _rename_into_place(written, path)
        except BaseException:
            Path(written).unlink(missing_ok=True)
            raise
        return Part(str(path.relative_to(self.root)), size, meta)

    def table(self, part: Part) -> NDArray[Any]:
        """Map what `put_table` wrote."""
        path = self._checked(part)
        table: NDArray[Any] = np.load(path, mmap_mode="r")
        return table

    def has(self, part: Part) -> bool:
        """Whether the file is there, as long as it was written."""
        path = Path(self.root) / part.path
        return path.is_file() and path.stat().st_size == part.size

    def write_json(self, name: str, value: Any) -> None:
        """Write a small file, renamed into place."""
        path = Path(self.root) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, written = tempfile.mkstemp(dir=path.parent, suffix=".writing")
        with os.fdopen(handle, "w") as file:
            json.dump(value, file, indent=1)
        _rename_into_place(written, path)

    def read_json(self, name: str) -> Any:
        """Read what `write_json` wrote; None where it did not."""
        path = Path(self.root) / name
        if not path.is_file():
            return None
        with path.open() as file:
            return json.load(file)
