# SPDX-License-Identifier: GPL-3.0-or-later
"""Parquet, tables of data science, by pyarrow."""

from __future__ import annotations

import io
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.optional import load
from remanifold.formats._columns import mesh_of_table
from remanifold.formats._mesh import FileMesh, Table
from remanifold.formats._source import Source
from remanifold.formats._tables import columns_of


def read_parquet(source: Source, with_fields: bool) -> FileMesh:  # noqa: ARG001  fields come along
    """Read all columns of numbers and words; lists of one length are several columns."""
    parquet = load("pyarrow.parquet", "parquet")
    try:
        table = table_of_arrow(source, parquet.read_table(io.BytesIO(source.data)))
    except (KeyboardInterrupt, SystemExit, MemoryError):
        raise
    except BaseException as error:  # noqa: BLE001  whatever stumbles over damage first
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        source.fail(f"is damaged, truncated or no Parquet file ({reason})", error)
    return mesh_of_table(source, table)


def table_of_arrow(source: Source, content: Any) -> Table:
    """Columns of a table of Arrow."""
    arrays = [(name, _array(content.column(name))) for name in content.column_names]
    table = Table([], [])
    assert table.names is not None
    for name, array in arrays:
        if array is None:
            source.note(f"the column {name!r} is left out: neither numbers nor words")
            continue
        flat = array.reshape(len(array), -1)
        width = flat.shape[1]
        table.names += [name] if width == 1 else [f"{name}_{i}" for i in range(width)]
        table.columns += [*flat.T]
    return table


def _array(column: Any) -> NDArray[Any] | None:
    """Numbers, words, or rows of numbers; nulls are NaN. None for all else."""
    values = column.to_numpy()
    if values.dtype.kind == "O" and len(values):
        try:
            if all(isinstance(value, np.ndarray) for value in values):
                values = np.stack([*values])
            elif all(isinstance(v, bool | int | float | type(None)) for v in values):
                values = np.array([np.nan if v is None else v for v in values])
            elif all(isinstance(value, str | type(None)) for value in values):
                values = np.array(["" if v is None else v for v in values])
        except ValueError:  # rows of different lengths
            return None
    if values.dtype.kind == "M":
        return np.asarray(values.astype("datetime64[us]").astype(np.int64))
    return values if values.dtype.kind in "biufU" else None


def write_parquet(file: IO[bytes], mesh: FileMesh) -> None:
    """Write a column for each coordinate and field."""
    arrow, parquet = load("pyarrow", "parquet"), load("pyarrow.parquet", "parquet")
    names, columns = columns_of(mesh)
    table = arrow.table(
        dict(zip(names, map(np.ascontiguousarray, columns), strict=True))
    )
    parquet.write_table(table, file)
