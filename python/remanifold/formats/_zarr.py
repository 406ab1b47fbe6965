# SPDX-License-Identifier: GPL-3.0-or-later
"""Zarr, arrays in a folder or a ZIP archive, by the library of that name."""

from __future__ import annotations

import contextlib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.optional import load
from remanifold.formats._arrays import Held
from remanifold.formats._columns import mesh_of_table
from remanifold.formats._mesh import FileMesh, Table
from remanifold.formats._packed import MOST_PER_BYTE
from remanifold.formats._source import Source
from remanifold.formats._tables import mesh_of_arrays

_SMALL = 1 << 26  # bytes that are no harm, whatever the file


def read_zarr(source: Source, with_fields: bool) -> FileMesh:
    """Read an array of two dimensions, or a group with one, as from an archive."""
    zarr = load("zarr", "zarr")
    with contextlib.ExitStack() as stack, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            path = stack.enter_context(source.on_disk())
            if path.is_dir():
                content = zarr.open(str(path), mode="r")
            else:
                if not source.data.startswith(b"PK"):  # or the store is left half made
                    msg = "neither a folder nor a ZIP archive"
                    raise ValueError(msg)
                store = zarr.storage.ZipStore(str(path), mode="r")
                stack.callback(store.close)
                content = zarr.open(store, mode="r")
            size = _stored(path)
            if hasattr(content, "arrays"):
                arrays = {name: _held(source, a, size) for name, a in content.arrays()}
                return mesh_of_arrays(source, arrays, with_fields)
            array = _held(source, content, size)
            matrix = array.ndim == 2 and array.dtype.kind in "biuf"
            columns = [*array.read().T] if matrix else []
        except (KeyboardInterrupt, SystemExit, MemoryError):
            raise
        except BaseException as error:  # whatever stumbles over it first
            if str(error).startswith(source.name):  # said already
                raise
            reason = " ".join(str(error).split())[:200] or type(error).__name__
            source.fail(f"is damaged or no array of Zarr ({reason})", error)
    if not matrix:
        what = f"holds {array.dtype} of shape {array.shape}"
        source.fail(f"{what}, expected numbers of shape (N, D)")
    return mesh_of_table(source, Table(columns))


def _stored(path: Path) -> int:
    """Bytes of a store."""
    if path.is_file():
        return path.stat().st_size
    return sum(one.stat().st_size for one in path.rglob("*") if one.is_file())


def _held(source: Source, array: Any, stored: int) -> Held:
    """One array; what is not stored is filled in, so that its shape may be anything."""

    def read() -> NDArray[Any]:
        shapes = (array.shape, array.chunks)
        size = max(Held(shape, array.dtype, read).nbytes for shape in shapes)
        if size > max(_SMALL, MOST_PER_BYTE * stored):
            what = f"{array.shape} in chunks of {array.chunks}"
            source.fail(f"is damaged: it promises {what}, and holds {stored} bytes")
        return np.asarray(array[...])

    return Held(array.shape, array.dtype, read)
