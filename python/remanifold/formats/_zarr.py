# SPDX-License-Identifier: GPL-3.0-or-later
"""Zarr, arrays in a folder or a ZIP archive, by the library of that name."""

from __future__ import annotations

import contextlib
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.optional import load
from remanifold.formats._columns import mesh_of_table
from remanifold.formats._mesh import FileMesh, Table
from remanifold.formats._source import Source
from remanifold.formats._tables import mesh_of_arrays


def read_zarr(source: Source, with_fields: bool) -> FileMesh:
    """Read an array of two dimensions, or a group with one, as from an archive."""
    zarr = load("zarr", "zarr")
    arrays: dict[str, NDArray[Any]] = {}
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
            if hasattr(content, "arrays"):
                arrays = {
                    name: np.asarray(array[...]) for name, array in content.arrays()
                }
            else:
                arrays = {"": np.asarray(content[...])}
        except (KeyboardInterrupt, SystemExit, MemoryError):
            raise
        except BaseException as error:  # noqa: BLE001  whatever stumbles over it first
            reason = " ".join(str(error).split())[:200] or type(error).__name__
            source.fail(f"is damaged or no array of Zarr ({reason})", error)
    if "" not in arrays:
        return mesh_of_arrays(source, arrays, with_fields)
    array = arrays[""]
    if array.ndim != 2 or array.dtype.kind not in "biuf":
        what = f"holds {array.dtype} of shape {array.shape}"
        source.fail(f"{what}, expected numbers of shape (N, D)")
    return mesh_of_table(source, Table([*array.T]))
