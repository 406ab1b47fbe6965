# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading points, complexes and values at the vertices; the suffix names the format."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from remanifold.io._las import read_las
from remanifold.io._mesh import FileMesh, choose_simplices, without_degenerate
from remanifold.io._obj import read_obj
from remanifold.io._off import read_off
from remanifold.io._ply import read_ply
from remanifold.io._source import (
    FloatArray,
    Source,
    StrPath,
    described,
    is_standard,
    suffix_of,
)
from remanifold.io._stl import read_stl
from remanifold.io._tables import read_csv, read_numpy, read_table
from remanifold.io._vtk import read_vtk
from remanifold.io._vtu import read_vtu

if TYPE_CHECKING:
    from remanifold.complex.simplicial_complex import SimplicialComplex

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


def read_complex(
    path: StrPath, dim: int | None = None, *, format: str | None = None
) -> SimplicialComplex:
    """Read vertices and simplices from a file.

    Parameters
    ----------
    path : str or path-like
        A file that `write_complex` can write, by remanifold or another program:
        ``.npz``, ``.ply``, ``.obj``, ``.off``, ``.stl``, ``.vtk`` or ``.vtu``. "-" is
        standard input.
    dim : int, optional
        Dimension of the simplices to read. By default the highest in the file; all
        others must then be faces of these.
    format : str, optional
        The format by its suffix, such as "ply", whatever the name of the file.

    Returns
    -------
    SimplicialComplex
        All vertices, in the order of the file, and the simplices.

    Raises
    ------
    FileNotFoundError, IsADirectoryError, OSError
        If the file cannot be opened.
    ValueError
        If its suffix is unknown, its content is not what the suffix says, it has no
        simplices, or cells that are neither simplices nor polygons.

    Warns
    -----
    FileWarning
        Simplices with a vertex twice, or repeated ones, were left out.

    Notes
    -----
    Polygons are cut into triangles, each from its first corner or, where that does not
    see all others, from one that does; a polygon without such a corner is refused.

    Examples
    --------
    >>> import remanifold as rm
    >>> mesh = rm.io.read_complex("mesh.ply")  # doctest: +SKIP
    """
    from remanifold.complex.simplicial_complex import SimplicialComplex

    source, mesh = read_file(path, format, cells=True, known=WITH_SIMPLICES)
    simplices = without_degenerate(source, choose_simplices(source, mesh, dim))
    try:
        return SimplicialComplex(mesh.points, simplices.astype(np.int32))
    except (ValueError, TypeError) as error:
        source.fail(str(error), error)


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
