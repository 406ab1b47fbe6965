# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the samples come from: one file or many, read in chunks by whoever needs them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.files import complete_file
from remanifold.distributed._pieces import FORMATS, Layout, fields_of
from remanifold.distributed._store import Arrays


class ChangedSourceError(RuntimeError):
    """A file of the source is no longer what it was when the run began."""


@dataclass(frozen=True)
class Piece:
    """One file, with what it was when the run began."""

    path: str
    layout: Layout
    size: int  # bytes
    modified: int  # nanoseconds

    def check(self) -> None:
        """Refuse to read what has changed since."""
        if stamp_of(Path(self.path)) != (self.size, self.modified):
            msg = f"{self.path} has changed since the run began: take another work"
            raise ChangedSourceError(msg)


@dataclass(frozen=True)
class Source:
    """Files one after the other; a sample is known by its row among all."""

    pieces: tuple[Piece, ...]

    @classmethod
    def of(cls, said: dict[str, Any]) -> Source:
        """As it stands in a manifest."""
        return cls(
            tuple(
                Piece(
                    **piece
                    | {
                        "layout": Layout(
                            piece["layout"]["rows"],
                            tuple(piece["layout"]["axes"]),
                            tuple(piece["layout"]["attributes"]),
                        )
                    }
                )
                for piece in said["pieces"]
            )
        )

    def shape(self) -> tuple[int, int]:
        """Of all samples."""
        rows = sum(piece.layout.rows for piece in self.pieces)
        return rows, len(self.pieces[0].layout.axes)

    def _ranges(self, begin: int, end: int) -> Iterator[tuple[Piece, int, int]]:
        first = 0
        for piece in self.pieces:
            last = first + piece.layout.rows
            if max(begin, first) < min(end, last):
                piece.check()
                yield piece, max(begin, first) - first, min(end, last) - first
            first = last

    def read(self, begin: int, end: int) -> NDArray[np.float64]:
        """Some rows."""
        parts = [
            _format_of(piece.path).read(piece.path, piece.layout, first, last, False)[0]
            for piece, first, last in self._ranges(begin, end)
        ]
        return np.ascontiguousarray(
            np.concatenate([np.empty((0, self.shape()[1])), *parts])
        )

    def attributes(self, begin: int, end: int) -> Arrays:
        """What all files say of their samples besides, of some rows."""
        names = self.attribute_names()
        parts = [
            _format_of(piece.path).read(piece.path, piece.layout, first, last, True)[1]
            for piece, first, last in self._ranges(begin, end)
        ]
        return fields_of(
            {name: np.concatenate([part[name] for part in parts]) for name in names}
        )

    def attribute_names(self) -> list[str]:
        """As columns, of those that every file has."""
        first, *others = (piece.layout.attributes for piece in self.pieces)
        return [name for name in first if all(name in other for other in others)]

    def identity(self) -> dict[str, Any]:
        """What changes when the samples do."""
        return {
            "files": [
                {"path": p.path, "bytes": p.size, "modified": p.modified}
                for p in self.pieces
            ]
        }

    def said(self) -> dict[str, Any]:
        """For a manifest."""
        return asdict(self)


def stamp_of(path: Path) -> tuple[int, int]:
    """Bytes, and when they were changed last; of all that a folder holds."""
    files = (
        [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file())
    )
    found = [file.stat() for file in files]
    return sum(at.st_size for at in found), max(
        (at.st_mtime_ns for at in found), default=0
    )


def _format_of(path: str) -> Any:
    return FORMATS[Path(path).suffix.lower()]


def source_of(source: object, work: Path) -> tuple[Source, dict[str, Any]]:
    """The source of what the caller gave, and its identity.

    An array goes into the directory of the run, where workers find it.
    """
    if isinstance(source, (str, Path)):
        named = source_of_files(Path(source))
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
    return Source((_piece(path),)), {"digest": digest, "shape": list(array.shape)}


def source_of_files(path: Path) -> Source:
    """A file, or those of a folder, which have to hold the same coordinates."""
    source = Source(tuple(_piece(file) for file in _files(path.resolve())))
    _check_alike(source)
    return source


def _files(path: Path) -> list[Path]:
    """A file, or those of a folder that can be read, by their names."""
    known = ", ".join(FORMATS)
    if not path.exists():
        msg = f"source {path}: no such file or folder"
        raise FileNotFoundError(msg)
    if path.suffix.lower() in FORMATS:
        return [path]
    if not path.is_dir():
        msg = f"source is {path.name}, expected {known}, a folder of these or an array"
        raise ValueError(msg)
    files = [p for p in sorted(path.iterdir()) if p.suffix.lower() in FORMATS]
    if not files:
        msg = f"source {path} is a folder without a file of {known}"
        raise FileNotFoundError(msg)
    return files


def _piece(path: Path) -> Piece:
    return Piece(str(path), _format_of(str(path)).layout(str(path)), *stamp_of(path))


def _check_alike(source: Source) -> None:
    first, *others = source.pieces
    for piece in others:
        if len(piece.layout.axes) != len(first.layout.axes):
            msg = (
                f"{piece.path} has {len(piece.layout.axes)} coordinates, and "
                f"{first.path} {len(first.layout.axes)}"
            )
            raise ValueError(msg)
