# SPDX-License-Identifier: GPL-3.0-or-later
"""PCD, the files of the Point Cloud Library: text, binary and compressed."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._columns import mesh_of_table
from remanifold.formats._mesh import FileMesh, Table
from remanifold.formats._source import Source

_MOST = 2**40  # bytes of a record or points of a file, which none has
_KINDS = {"I": "i", "U": "u", "F": "f"}


@dataclass
class _Header:
    fields: list[str] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    kinds: list[str] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)
    width: int = 0
    height: int = 1
    points: int = -1
    data: str = ""


def read_pcd(source: Source, with_fields: bool) -> FileMesh:  # noqa: ARG001  fields come along
    """Read points with all fields; points that were not seen are NaN."""
    header, start, line = _header(source)
    dtype, names = _record(source, header)
    if header.data == "ascii":
        columns = _ascii(source, header, source.data[start:], line)
    else:
        columns = _binary(source, header, dtype, source.data[start:])
    table = Table([], [])
    assert table.names is not None
    for name, values in zip(names, columns, strict=True):
        if name == "_":  # fills up to a multiple of some bytes
            continue
        flat = values.reshape(header.points, -1)
        if (
            name in ("rgb", "rgba")
            and flat.shape[1] == 1
            and values.dtype.itemsize == 4
        ):
            for part, bits in _packed(flat[:, 0], name):
                table.names.append(part)
                table.columns.append(bits)
            continue
        width = flat.shape[1]
        table.names += [name] if width == 1 else [f"{name}_{i}" for i in range(width)]
        table.columns += [*flat.T]
    if header.height > 1:
        source.note(f"is an image of {header.width:,} by {header.height:,} points")
    return mesh_of_table(source, table)


def _packed(values: NDArray[Any], name: str) -> list[tuple[str, NDArray[np.uint8]]]:
    """Colors that PCL packs into the bits of one number."""
    bits = values.view(np.uint32)
    parts = [("red", 16), ("green", 8), ("blue", 0)]
    parts += [("alpha", 24)] if name == "rgba" else []
    return [(part, (bits >> shift & 255).astype(np.uint8)) for part, shift in parts]


def _header(source: Source) -> tuple[_Header, int, int]:
    """What the header says, where the data begin, and the number of lines before."""
    header = _Header()
    position = line = 0
    data = source.data
    while not header.data:
        end = data.find(b"\n", position)
        if end < 0 or end - position > 1 << 16:
            source.fail("expected a PCD file, whose header ends with a line 'DATA ...'")
        words = data[position:end].decode("ascii", "replace").split()
        position = end + 1
        line += 1
        if not words or words[0].startswith("#"):
            continue
        _take(source, header, words, line)
    if header.points < 0:
        header.points = header.width * header.height
    if header.points == 0:
        source.fail("holds no points")
    if not header.fields:
        source.fail("expected a line 'FIELDS ...' in the header")
    header.counts = header.counts or [1] * len(header.fields)
    lengths = {len(x) for x in (header.sizes, header.kinds, header.counts)}
    if lengths != {len(header.fields)}:
        source.fail(f"FIELDS, SIZE, TYPE and COUNT differ in length{_of(header)}")
    if header.height > 1 and header.width * header.height != header.points:
        size = f"{header.width:,} by {header.height:,}"
        source.fail(f"has {header.points:,} points in an image of {size}")
    return header, position, line


def _of(header: _Header) -> str:
    return f": {len(header.fields)} fields are {', '.join(header.fields[:12])}"


def _take(source: Source, header: _Header, words: list[str], line: int) -> None:
    match words:
        case ["VERSION" | "VIEWPOINT", *_]:
            pass
        case ["FIELDS" | "COLUMNS", *names]:
            header.fields = names
        case ["SIZE", *sizes]:
            header.sizes = [source.count(line, size) for size in sizes]
        case ["TYPE", *kinds]:
            header.kinds = kinds
        case ["COUNT", *counts]:
            header.counts = [source.count(line, count) for count in counts]
        case ["WIDTH", count]:
            header.width = source.count(line, count)
        case ["HEIGHT", count]:
            header.height = source.count(line, count)
        case ["POINTS", count]:
            header.points = source.count(line, count)
        case ["DATA", kind] if kind in ("ascii", "binary", "binary_compressed"):
            header.data = kind
        case _:
            shown = " ".join(words)[:60]
            source.fail(f"no valid line of a PCD header: {shown!r}", line=line)


def _record(source: Source, header: _Header) -> tuple[np.dtype[Any], list[str]]:
    parts = []
    for i, (name, kind, size, count) in enumerate(
        zip(header.fields, header.kinds, header.sizes, header.counts, strict=True)
    ):
        known = kind in _KINDS and size in ((4, 8) if kind == "F" else (1, 2, 4, 8))
        if not known or not 0 < count < 1 << 20:
            what = f"{name!r} is {count} of type {kind!r} and {size} bytes"
            source.fail(f"the field {what}, which is none of PCD's")
        parts.append((f"f{i}", f"<{_KINDS[kind]}{size}", (count,)))
    return np.dtype(parts), header.fields


def _binary(
    source: Source, header: _Header, dtype: np.dtype[Any], body: bytes
) -> list[NDArray[Any]]:
    count = header.points
    expected = count * dtype.itemsize
    if header.data == "binary_compressed":
        if len(body) < 8:
            source.fail(f"is truncated: expected {count:,} points, found none")
        packed, size = (int.from_bytes(body[i : i + 4], "little") for i in (0, 4))
        if size != expected:
            what = f"{count:,} points take {expected:,} bytes, it has {size:,}"
            source.fail(f"is damaged: {what}")
        _more(source, header, body[8 + packed :], 1)
        if len(body) - 8 < packed:
            rest = f"{len(body) - 8:,} of {packed:,} compressed bytes"
            source.fail(f"is truncated: expected {count:,} points, found {rest}")
        # A byte stands for at most 264 / 3.
        if size > 100 * packed:
            source.fail(f"is damaged: {packed:,} bytes cannot hold {count:,} points")
        body = _lzf(source, memoryview(body)[8 : 8 + packed], size)
        # One field after the other, each of all points.
        columns: list[NDArray[Any]] = []
        place = 0
        for key in dtype.names or ():
            base, width = dtype[key].base, math.prod(dtype[key].shape)
            part = np.frombuffer(body, base, count * width, place)
            place += part.nbytes
            columns.append(part.reshape(count, width))
        return columns
    if len(body) < expected:
        found = len(body) // dtype.itemsize
        source.fail(f"is truncated: expected {count:,} points, found {found:,}")
    _more(source, header, body[expected:], dtype.itemsize)
    records = np.frombuffer(body, dtype, count)
    return [np.ascontiguousarray(records[name]) for name in dtype.names or ()]


def _more(source: Source, header: _Header, rest: bytes, size: int) -> None:
    """Say so where there is more than the header tells of; some programs fill up."""
    if len(rest) < size or not rest.strip(b"\r\n\0 "):
        return
    more = f"{len(rest):,} more bytes"
    if size > 1:
        more = f"{len(rest) // size:,} more points"
    source.guess(
        f"holds {more} than the {header.points:,} points that its header tells of, "
        "which were not read: if the header is wrong, mend its POINTS and WIDTH"
    )


def _lzf(source: Source, packed: memoryview, size: int) -> bytes:
    """Undo the compression of LibLZF: runs of bytes, and repeats of earlier ones."""
    out = bytearray()
    i, end = 0, len(packed)
    while i < end:
        control = packed[i]
        i += 1
        if control < 32:
            out += packed[i : i + control + 1]
            i += control + 1
            continue
        length = control >> 5
        if length == 7:
            if i >= end:
                break
            length += packed[i]
            i += 1
        if i >= end:
            break
        start = len(out) - ((control & 31) << 8) - packed[i] - 1
        i += 1
        length += 2
        if start < 0 or len(out) > size:
            source.fail("is damaged: its compressed points make no sense")
        if start + length <= len(out):
            out += out[start : start + length]
        else:  # what is repeated goes on into itself
            part = bytes(out[start:])
            out += (part * (length // len(part) + 1))[:length]
    if len(out) != size:
        what = f"expected {size:,} bytes of points, found {len(out):,}"
        source.fail(f"is damaged or truncated: {what}")
    return bytes(out)


def _ascii(
    source: Source, header: _Header, body: bytes, line: int
) -> list[NDArray[Any]]:
    width = sum(header.counts)
    rows: list[list[str]] = []
    for number, text in enumerate(
        body.decode("ascii", "replace").splitlines(), line + 1
    ):
        words = text.split()
        if not words:
            continue
        if len(rows) == header.points:
            _more(source, header, b"\n".join(body.splitlines()[number - line - 1 :]), 1)
            break
        if len(words) != width:
            what = f"expected {width} numbers, found {len(words)}"
            source.fail(what, line=number)
        source.floats(number, words, width)
        rows.append(words)
    if len(rows) < header.points:
        what = f"expected {header.points:,} points, found {len(rows):,}"
        source.fail(f"is truncated: {what}")
    columns: list[NDArray[Any]] = []
    place = 0
    kinds = zip(header.kinds, header.sizes, header.counts, header.fields, strict=True)
    for kind, size, count, name in kinds:
        cells = [row[place : place + count] for row in rows]
        place += count
        columns.append(_parsed(cells, f"{_KINDS[kind]}{size}", name))
    return columns


def _parsed(words: list[list[str]], kind: str, name: str) -> NDArray[Any]:
    """Numbers of the type of the field, or doubles where that has no room for them."""
    numbers = np.array(words, dtype=np.float64)
    packed = name in ("rgb", "rgba")
    if kind[0] == "f":
        if packed and (np.abs(numbers) >= 1).all():  # bits written as a whole number
            return numbers.astype(np.uint32)
        # The digits of a coordinate say more than its type.
        return numbers.astype(np.float32) if packed else numbers
    if np.isfinite(numbers).all():
        try:
            return np.array([[int(w) for w in row] for row in words], dtype=kind)
        except (ValueError, OverflowError):
            pass
    return numbers
