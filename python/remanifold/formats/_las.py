# SPDX-License-Identifier: GPL-3.0-or-later
"""LAS and LAZ, the files of airborne and terrestrial scanners, by laspy."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from remanifold.formats._columns import gathered
from remanifold.formats._mesh import FileMesh
from remanifold.formats._source import Source

_HINT = "reading .las and .laz needs laspy and lazrs: pip install remanifold[las]"
_CHUNK = 1_000_000  # points that are decompressed together


def read_las(source: Source, with_fields: bool) -> FileMesh:
    """Read points, scaled and moved as the header says, and all that goes with them."""
    try:
        import laspy
        import lazrs  # noqa: F401  laspy finds it by itself
    except ImportError as error:
        raise ImportError(_HINT) from error
    check_las(source)
    chunks: list[dict[str, Any]] = []
    try:
        # Chunk by chunk, for a damaged header may promise more than there is memory;
        # and one after the other, for the parallel reader believes the table of chunks.
        with (
            source.open() as file,
            laspy.open(file, closefd=False, laz_backend=laspy.LazBackend.Lazrs) as las,
        ):
            expected = int(las.header.point_count)
            names = [*las.header.point_format.dimension_names] if with_fields else []
            for part in las.chunk_iterator(_CHUNK):
                axes = [np.asarray(getattr(part, a), dtype=np.float64) for a in "xyz"]
                chunk: dict[str, Any] = {"": np.column_stack(axes)}
                chunk |= {n: np.array(part[n]) for n in names if n not in "XYZ"}
                chunks.append(chunk)
    # A damaged file is reported by whatever stumbles over it first; lazrs, written in
    # Rust, panics.
    except (KeyboardInterrupt, SystemExit, MemoryError):
        raise
    except BaseException as error:  # noqa: BLE001
        reason = str(error) or type(error).__name__
        source.fail(f"is damaged, truncated or no LAS file ({reason})", error)
    found = sum(len(chunk[""]) for chunk in chunks)
    if found < expected:
        source.fail(f"is truncated: expected {expected} points, found {found}")
    if not chunks:
        return FileMesh(np.empty((0, 3)))
    arrays = {name: np.concatenate([c[name] for c in chunks]) for name in chunks[0]}
    mesh = FileMesh(arrays.pop(""))
    mesh.fields = gathered(arrays)
    if np.ptp(mesh.fields.get("colors", np.ones(1)), axis=None) == 0:
        # Files of formats with colors often have none: all black or all white.
        mesh.fields.pop("colors", None)
    return mesh


def check_las(source: Source) -> None:
    """Refuse counts that the file has no room for, which laspy would believe."""
    with source.open() as file:
        head = file.read(375)
        size = file.seek(0, 2)
    if head[:4] != b"LASF":
        source.fail("expected a LAS file, which begins with 'LASF'")
    if len(head) < 227:
        source.fail(f"is truncated: expected a LAS header, found {len(head):,} bytes")
    header_size, start, records = struct.unpack_from("<HII", head, 94)
    kind, length, count = struct.unpack_from("<BHI", head, 104)
    more = 0
    if head[25] >= 4 and len(head) >= 255:
        more, count = struct.unpack_from("<IQ", head, 243)
    if not 227 <= header_size <= start <= size or 54 * records > start - header_size:
        source.fail("is damaged or truncated: its header does not fit the file")
    if 60 * more > size:
        source.fail(f"is damaged or truncated: it has no room for {more:,} records")
    if kind & 0xC0:
        _check_chunks(source, start, size)
    elif count * length > size - start:
        found = (size - start) // max(length, 1)
        source.fail(f"is truncated: expected {count:,} points, found {found:,}")


def _check_chunks(source: Source, start: int, size: int) -> None:
    """Refuse a table of more chunks than there are bytes: lazrs would make room."""
    with source.open() as file:
        file.seek(start)
        place = int.from_bytes(file.read(8), "little", signed=True)
        if place == -1:  # written as a stream, with the place at the end
            file.seek(max(size - 8, 0))
            place = int.from_bytes(file.read(8), "little", signed=True)
        if not start <= place <= size - 8:
            source.fail("is damaged or truncated: its table of chunks is missing")
        file.seek(place)
        _, chunks = struct.unpack("<II", file.read(8))
    if chunks > size:
        source.fail(f"is damaged or truncated: it has no room for {chunks:,} chunks")
