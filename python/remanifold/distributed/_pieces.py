# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that samples are in: how many, and any rows of them, without reading the rest."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.optional import load
from remanifold.distributed._store import Arrays
from remanifold.formats._columns import by_name, gathered
from remanifold.formats._las import check_las
from remanifold.formats._parquet import table_of_arrow
from remanifold.formats._source import Source as File

Points = NDArray[np.float64]


@dataclass(frozen=True)
class Layout:
    """What one file holds."""

    rows: int
    axes: tuple[str, ...]  # columns that are coordinates; or as many words
    attributes: tuple[str, ...]


@dataclass(frozen=True)
class Format:
    """Reads one kind of file; `read` gives points, and attributes where these are asked."""

    layout: Callable[[str], Layout]
    read: Callable[[str, Layout, int, int, bool], tuple[Points, Arrays]]


# ----------------------------------------------------------------------------- .npy


def _npy(path: str) -> NDArray[Any]:
    array: NDArray[Any] = np.load(path, mmap_mode="r")
    _check_matrix(path, array)
    return array


def _check_matrix(name: str, array: Any) -> None:
    if array.ndim != 2 or array.shape[1] < 1:
        msg = f"{name} has shape {array.shape}, expected (N, D)"
        raise ValueError(msg)
    if array.dtype.kind not in "fiu":
        msg = f"{name} holds {array.dtype}, expected real numbers"
        raise TypeError(msg)


def _npy_layout(path: str) -> Layout:
    rows, columns = _npy(path).shape
    return Layout(int(rows), ("",) * int(columns), ())


def _npy_read(
    path: str, _layout: Layout, begin: int, end: int, _with_attributes: bool
) -> tuple[Points, Arrays]:
    return np.ascontiguousarray(_npy(path)[begin:end], dtype=np.float64), {}


# ------------------------------------------------------------------------ .las, .laz


@contextmanager
def _las(path: str) -> Iterator[Any]:
    laspy = load("laspy", "las")
    load("lazrs", "las")
    check_las(File(path, Path(path).suffix.lower()))
    try:
        with laspy.open(path, laz_backend=laspy.LazBackend.Lazrs) as las:
            yield las
    except (KeyboardInterrupt, SystemExit, MemoryError):
        raise
    except BaseException as error:  # noqa: BLE001  lazrs, written in Rust, panics
        msg = f"{path} is damaged, truncated or no LAS file ({error})"
        raise ValueError(msg) from None


def _las_layout(path: str) -> Layout:
    with _las(path) as las:
        names = [n for n in las.header.point_format.dimension_names if n not in "XYZ"]
        return Layout(int(las.header.point_count), (*"xyz",), (*names,))


def _las_read(
    path: str, layout: Layout, begin: int, end: int, with_attributes: bool
) -> tuple[Points, Arrays]:
    with _las(path) as las:
        las.seek(begin)
        part = las.read_points(end - begin)
        points = np.column_stack(
            [np.asarray(getattr(part, axis), dtype=np.float64) for axis in layout.axes]
        )
        if len(points) != end - begin:
            msg = f"expected {layout.rows:,} points, found {begin + len(points):,}"
            raise ValueError(msg)
        names = layout.attributes if with_attributes else ()
        return points, {name: np.array(part[name]) for name in names}


# --------------------------------------------------------------------------- .parquet


def _parquet(path: str) -> Any:
    return load("pyarrow.parquet", "parquet").ParquetFile(path)


def _parquet_layout(path: str) -> Layout:
    with _parquet(path) as file:
        some = next(file.iter_batches(batch_size=16), None)
        rows = int(file.metadata.num_rows)
    if some is None:
        return Layout(0, (), ())
    source = File(path, ".parquet")
    table = table_of_arrow(
        source, load("pyarrow", "parquet").Table.from_batches([some])
    )
    choice = by_name(source, table)
    if choice is None or choice.guessed:
        msg = (
            f"{path} has the columns {', '.join(table.names or ())}, whose names do not "
            "tell which are coordinates: call these x, y, z"
        )
        raise ValueError(msg)
    names = table.names or []
    axes = tuple(names[i] for i in choice.axes)
    # Words have numbers by all that there are.
    numbers = {
        n for n, c in zip(names, table.columns, strict=True) if c.dtype.kind in "biuf"
    }
    return Layout(rows, axes, tuple(n for n in names if n in numbers and n not in axes))


def _parquet_read(
    path: str, layout: Layout, begin: int, end: int, with_attributes: bool
) -> tuple[Points, Arrays]:
    arrow = load("pyarrow", "parquet")
    with _parquet(path) as file:
        groups: list[Any] = []
        first = row = 0
        for group in range(file.metadata.num_row_groups):
            next_row = row + file.metadata.row_group(group).num_rows
            if row < end and next_row > begin:
                first = first if groups else row
                groups.append(file.read_row_group(group))
            row = next_row
    content = arrow.concat_tables(groups).slice(begin - first, end - begin)
    table = table_of_arrow(File(path, ".parquet"), content)
    columns = dict(zip(table.names or (), table.columns, strict=True))
    points = np.column_stack([columns[a].astype(np.float64) for a in layout.axes])
    names = layout.attributes if with_attributes else ()
    return points, {name: columns[name] for name in names}


# ------------------------------------------------------------------------------ .zarr


def _zarr(path: str) -> tuple[Any, dict[str, Any]]:
    """Array of the points, and those that go with it."""
    zarr = load("zarr", "zarr")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            content = zarr.open(path, mode="r")
            held = dict(content.arrays()) if hasattr(content, "arrays") else None
        except (OSError, ValueError, KeyError) as error:
            msg = f"{path} is damaged or no array of Zarr ({error})"
            raise ValueError(msg) from None
    if held is None:
        _check_matrix(path, content)
        return content, {}
    flat = [name for name, array in held.items() if array.ndim == 2]
    name = "points" if "points" in flat else flat[0] if len(flat) == 1 else None
    if name is None:
        found = ", ".join(f"{key} {array.shape}" for key, array in held.items())
        msg = f"{path} has {found or 'no arrays'}, expected points of shape (N, D)"
        raise ValueError(msg)
    points = held.pop(name)
    _check_matrix(f"{path}/{name}", points)
    return points, {
        key: array
        for key, array in held.items()
        if array.shape[:1] == points.shape[:1] and array.dtype.kind in "biuf"
    }


def _zarr_layout(path: str) -> Layout:
    points, others = _zarr(path)
    return Layout(int(points.shape[0]), ("",) * int(points.shape[1]), (*others,))


def _zarr_read(
    path: str, _layout: Layout, begin: int, end: int, with_attributes: bool
) -> tuple[Points, Arrays]:
    points, others = _zarr(path)
    rows = np.ascontiguousarray(points[begin:end], dtype=np.float64)
    others = others if with_attributes else {}
    return rows, {name: np.asarray(array[begin:end]) for name, array in others.items()}


FORMATS = {
    ".npy": Format(_npy_layout, _npy_read),
    ".las": Format(_las_layout, _las_read),
    ".laz": Format(_las_layout, _las_read),
    ".parquet": Format(_parquet_layout, _parquet_read),
    ".zarr": Format(_zarr_layout, _zarr_read),
}


def fields_of(attributes: Arrays) -> Arrays:
    """Columns that belong together as one: red, green and blue are colors."""
    return gathered(attributes)
