# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading points, simplices and values at the vertices; the suffix names the format."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.files import StrPath
from remanifold.formats._las import read_las
from remanifold.formats._mesh import FileMesh
from remanifold.formats._obj import read_obj
from remanifold.formats._off import read_off
from remanifold.formats._ply import read_ply
from remanifold.formats._source import (
    FloatArray,
    Source,
    described,
    is_standard,
    suffix_of,
)
from remanifold.formats._stl import read_stl
from remanifold.formats._tables import read_csv, read_numpy, read_table
from remanifold.formats._vtk import read_vtk
from remanifold.formats._vtu import read_vtu

# Each takes whether simplices and fields are wanted as well.
READERS: dict[str, Callable[[Source, bool], FileMesh]] = {
    ".npy": read_numpy,
    ".npz": read_numpy,
    ".csv": read_csv,
    ".txt": read_table,
    ".xyz": read_table,
    ".ply": read_ply,
    ".obj": read_obj,
    ".off": read_off,
    ".stl": read_stl,
    ".vtk": read_vtk,
    ".vtu": read_vtu,
    ".las": read_las,
    ".laz": read_las,
}
WITH_SIMPLICES = (".npz", ".ply", ".obj", ".off", ".stl", ".vtk", ".vtu")


def read_points(path: StrPath, *, format: str | None = None) -> FloatArray:
    """Read points from a file.

    Parameters
    ----------
    path : str or path-like
        The file; its suffix names the format. "-" is standard input.

        ``.npy``, ``.npz``
            A two-dimensional array; complex numbers count as two real ones. Of an
            archive the array called ``points`` is read, or else the only array of two
            dimensions.
        ``.csv``, ``.txt``, ``.xyz``
            One point a line, separated by commas (``.csv``) or blanks. Every column
            is a coordinate. The first line may name the columns; blank lines and
            lines that begin with ``#`` are skipped.
        ``.ply``, ``.obj``, ``.off``, ``.vtk``, ``.vtu``
            All vertices, whether any face uses them or not. OFF may be of any
            dimension (``nOFF``); ``.vtu`` needs at least one cell.
        ``.stl``
            The corners of the facets; corners with the same coordinates become one
            point.
        ``.las``, ``.laz``
            Scaled and moved as the header says. Needs ``pip install remanifold[las]``.
    format : str, optional
        The format by its suffix, such as "csv", whatever the name of the file.

    Returns
    -------
    ndarray of shape (N, D)
        The points as float64, in the order of the file.

    Raises
    ------
    FileNotFoundError, IsADirectoryError, OSError
        If the file cannot be opened.
    ValueError
        If its suffix is unknown or its content is not what the suffix says. The
        message names the file, and the line where there are lines.
    ImportError
        If the format needs a package that is not installed.

    Examples
    --------
    >>> import remanifold as rm
    >>> points = rm.io.read_points("scan.ply")  # doctest: +SKIP
    """
    return read_file(path, format, cells=False)[1].points


def read_fields(path: StrPath, *, format: str | None = None) -> dict[str, NDArray[Any]]:
    """Read the values that a file gives at its vertices.

    Parameters
    ----------
    path : str or path-like
        The file: ``.npz``, ``.ply``, ``.vtk``, ``.vtu``, ``.las`` or ``.laz``; other
        formats have no fields. "-" is standard input.
    format : str, optional
        The format by its suffix, such as "ply", whatever the name of the file.

    Returns
    -------
    dict of str to ndarray
        Arrays of N rows by their names. What was written as bool comes back as uint8
        except from ``.npz``. In PLY the properties nx, ny and nz are the field
        ``normals``, red, green, blue and alpha are ``colors``.

    Raises
    ------
    FileNotFoundError, IsADirectoryError, OSError
        If the file cannot be opened.
    ValueError
        If its suffix is unknown or its content is not what the suffix says.

    Examples
    --------
    >>> import remanifold as rm
    >>> fields = rm.io.read_fields("mesh.ply")  # doctest: +SKIP
    """
    return read_file(path, format, cells=True)[1].fields


def read_file(
    path: StrPath,
    format: str | None,
    *,
    cells: bool,
    known: tuple[str, ...] = tuple(READERS),
) -> tuple[Source, FileMesh]:
    """Read all that a file holds, or its points only."""
    if not is_standard(path) and Path(path).is_dir():
        msg = f"{path}: is a directory, expected a file with points"
        raise IsADirectoryError(msg)
    suffix = suffix_of(path, format, known)
    if suffix not in known:
        what = "points" if known == tuple(READERS) else "simplices"
        msg = (
            f"{path}: cannot read {what} from {described(suffix)}; "
            f"use one of {', '.join(known)}"
        )
        raise ValueError(msg)
    if not is_standard(path) and not Path(path).exists():
        msg = f"{path}: no such file"
        raise FileNotFoundError(msg)
    source = Source(path, suffix)
    mesh = READERS[suffix](source, cells)
    mesh.points = np.ascontiguousarray(mesh.points, dtype=np.float64)
    if mesh.points.size == 0:
        source.fail("holds no points")
    return source, mesh
