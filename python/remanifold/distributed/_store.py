# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a run as files that are whole or not there.

Each is written under another name and renamed into place under one that holds a digest of
its content; the record that says which step made it comes last. A run that goes on reads the
records.
"""

from __future__ import annotations

import hashlib
import json
import zipfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.files import complete_file

Arrays = dict[str, NDArray[Any]]


class LostPartError(RuntimeError):
    """A part of a run is missing, or is not what was written."""


def _damaged(path: Path, why: object) -> LostPartError:
    return LostPartError(
        f"{path} is damaged ({why}): delete it and run with resume=True"
    )


def _digest_of(table: NDArray[Any]) -> str:
    flat = np.ascontiguousarray(table).reshape(-1).view(np.uint8)
    return hashlib.blake2b(flat.data if flat.size else b"", digest_size=12).hexdigest()


@dataclass(frozen=True)
class Part:
    """A file of arrays, with what is known of it without reading it."""

    path: str
    size: int
    meta: dict[str, Any] = field(default_factory=dict)


class Store:
    """The directory of a run, as every worker sees it."""

    def __init__(self, root: str) -> None:
        self.root = root

    def put(self, step: str, arrays: Arrays, meta: dict[str, Any]) -> Part:
        """Write the arrays of a step, which has them as a whole or not at all."""
        digest = hashlib.blake2b(digest_size=12)
        for name in sorted(arrays):
            array = np.ascontiguousarray(arrays[name])
            digest.update(f"{name} {array.dtype.str} {array.shape}".encode())
            digest.update(array.reshape(-1).view(np.uint8).data if array.size else b"")
        path = self._path_of(f"{step}-{digest.hexdigest()}.npz")
        with complete_file(path) as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]
        return self._written(path, meta)

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
            raise _damaged(path, error) from None

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
        path = self._path_of(f"{step}-{_digest_of(table)}.npy")
        with complete_file(path) as file:
            np.save(file, table)
        return self._written(path, meta)

    def _path_of(self, name: str) -> Path:
        folder = Path(self.root) / "parts"
        folder.mkdir(parents=True, exist_ok=True)
        return folder / name

    def _written(self, path: Path, meta: dict[str, Any]) -> Part:
        return Part(str(path.relative_to(self.root)), path.stat().st_size, meta)

    def table(self, part: Part) -> NDArray[Any]:
        """Map what `put_table` wrote."""
        path = self._checked(part)
        try:
            table: NDArray[Any] = np.load(path, mmap_mode="r")
        except (OSError, ValueError, EOFError) as error:
            raise _damaged(path, error) from None
        return table

    def check_table(self, part: Part) -> None:
        """Read all that `put_table` wrote, and compare it with its digest."""
        table = self.table(part)
        path = self._checked(part)
        if not path.stem.endswith(_digest_of(table)):
            raise _damaged(path, "its bytes are not those that were written")

    def has(self, part: Part) -> bool:
        """Whether the file is there, as long as it was written."""
        path = Path(self.root) / part.path
        return path.is_file() and path.stat().st_size == part.size

    def write_json(self, name: str, value: Any) -> None:
        """Write a small file, renamed into place."""
        path = Path(self.root) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        with complete_file(path) as file:
            file.write(json.dumps(value, indent=1).encode())

    def put_json(self, step: str, value: Any) -> str:
        """Write a small file whose name, which is returned, says what is in it."""
        digest = hashlib.blake2b(json.dumps(value).encode(), digest_size=12).hexdigest()
        name = f"{step}-{digest}.json"
        self.write_json(name, value)
        return name

    def read_json(self, name: str) -> Any:
        """Read what `write_json` wrote; None where it did not."""
        path = Path(self.root) / name
        if not path.is_file():
            return None
        with path.open() as file:
            return json.load(file)
