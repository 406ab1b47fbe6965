# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading points, simplices and values at the vertices; the suffix names the format."""

from __future__ import annotations

import contextlib
import struct
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from remanifold._base.files import StrPath
from remanifold.formats._columns import check_columns, take_columns
from remanifold.formats._e57 import read_e57
from remanifold.formats._gltf_in import read_glb, read_gltf
from remanifold.formats._las import read_las
from remanifold.formats._mesh import FileMesh
from remanifold.formats._obj import read_obj
from remanifold.formats._off import read_off
from remanifold.formats._packed import inner_name
from remanifold.formats._parquet import read_parquet
from remanifold.formats._pcd import read_pcd
from remanifold.formats._ply import read_ply
from remanifold.formats._ptx import read_ptx
from remanifold.formats._seems import advice
from remanifold.formats._source import (
    FloatArray,
    Source,
    described,
    is_standard,
    suffix_of,
)
from remanifold.formats._stl import read_stl
from remanifold.formats._tables import (
    read_asc,
    read_csv,
    read_numpy,
    read_table,
    read_tsv,
    read_xyz,
)
from remanifold.formats._vtk import read_vtk
from remanifold.formats._vtk_xml import read_vtp, read_vtu
from remanifold.formats._zarr import read_zarr
from remanifold.warnings import FileWarning

# Each takes whether fields are wanted as well; of simplices the source knows.
READERS: dict[str, Callable[[Source, bool], FileMesh]] = {
    ".npy": read_numpy,
    ".npz": read_numpy,
    ".csv": read_csv,
    ".tsv": read_tsv,
    ".txt": read_table,
    ".xyz": read_xyz,
    ".asc": read_asc,
    ".pts": read_table,
    ".ptx": read_ptx,
    ".pcd": read_pcd,
    ".ply": read_ply,
    ".obj": read_obj,
    ".off": read_off,
    ".stl": read_stl,
    ".vtk": read_vtk,
    ".vtu": read_vtu,
    ".vtp": read_vtp,
    ".glb": read_glb,
    ".gltf": read_gltf,
    ".las": read_las,
    ".laz": read_las,
    ".e57": read_e57,
    ".parquet": read_parquet,
    ".zarr": read_zarr,
}
WITH_SIMPLICES = (
    *(".npz", ".ply", ".obj", ".off", ".stl", ".vtk", ".vtu", ".vtp", ".glb", ".gltf"),
)
_FEW_ROWS, _MANY_COLUMNS = 4, 12  # of what was most likely meant the other way round
_FOLDERS = (".zarr",)  # formats that are folders
# Tables have no NaN of their own, and programs write one of these instead: surveys, rasters,
# SAS, Surfer, NetCDF, and the largest number of single precision.
_NO_DATA = (
    *(-999.0, -9999.0, -99999.0, -999999.0, -9999.99, -999.25, 9999.0, 99999.0),
    *(-32768.0, -32767.0, -2147483648.0, 999999.0, 1e20, 1e30, -1e30, 1e36, 1.70141e38),
    *(-3.4028234663852886e38, 3.4028234663852886e38, 9.969209968386869e36),
)
_TABLES = (
    *(".csv", ".tsv", ".txt", ".xyz", ".asc", ".pts", ".pcd"),
    ".parquet",
    ".npy",
)
Columns = str | Sequence[int | str]


class PointCloud(NamedTuple):
    """Points of a file, and what it says about each of them.

    Attributes
    ----------
    points : ndarray of shape (N, D), float64
        In the order of the file; rows may hold NaN where it has no point.
    attributes : dict of str to ndarray
        Arrays of N rows by their names, as `read_fields` describes them.
    """

    points: FloatArray
    attributes: dict[str, NDArray[Any]]


def read(
    path: StrPath, *, columns: Columns | None = None, format: str | None = None
) -> PointCloud:
    """Read points, and all that a file says about each of them.

    Parameters
    ----------
    path, columns, format
        As in `read_points`.

    Returns
    -------
    PointCloud
        Two things: ``points, attributes = rm.io.read(path)``.

    Raises
    ------
    FileNotFoundError, IsADirectoryError, OSError, ValueError, ImportError
        As in `read_points`.

    Warns
    -----
    FileWarning
        It was guessed which columns are coordinates.

    Examples
    --------
    >>> import remanifold as rm
    >>> points, attributes = rm.io.read("scan.las")  # doctest: +SKIP
    >>> rec = rm.reconstruct(points, 2, attributes=attributes)  # doctest: +SKIP
    >>> rec.write("mesh.ply")  # with colors and all else  # doctest: +SKIP
    """
    mesh = read_file(path, format, columns=columns)[1]
    return PointCloud(mesh.points, mesh.fields)


def read_points(
    path: StrPath, *, columns: Columns | None = None, format: str | None = None
) -> FloatArray:
    """Read points from a file.

    Parameters
    ----------
    path : str or path-like
        The file; its suffix names the format. "-" is standard input.

        ``.npy``, ``.npz``
            A two-dimensional array; complex numbers count as two real ones. Of an
            archive the array called ``points`` is read, or else the only array of two
            dimensions, or arrays ``x``, ``y``, ``z``.
        ``.csv``, ``.tsv``, ``.txt``, ``.xyz``, ``.asc``, ``.pts``
            One point a line; cells are separated by commas, semicolons, tabs or blanks,
            decimals may be written with commas. The first line may name the columns,
            or say how many points there are; blank lines and comments (``#``, ``//``,
            ``%``) are skipped. Empty cells are NaN. ``.xyz`` may be a molecule,
            ``.asc`` a grid of heights.
        ``.ply``, ``.obj``, ``.off``, ``.vtk``, ``.vtu``, ``.vtp``, ``.glb``, ``.gltf``
            All vertices, whether any face uses them or not. OFF may be of any
            dimension (``nOFF``).
        ``.stl``
            The corners of the facets; corners with the same coordinates become one
            point.
        ``.pcd``, ``.ptx``
            Points that a scanner did not see are NaN.
        ``.las``, ``.laz``, ``.e57``, ``.parquet``, ``.zarr``
            By libraries made for them: ``pip install remanifold[las]``, ``[e57]``,
            ``[parquet]``, ``[zarr]``. COPC is LAZ.
    columns : str or sequence of int and str, optional
        Which columns are the coordinates, by name or by number from 0: "x,y,z",
        ``[2, 0, 1]``. Without it names decide: x, y, z in any case, x1, x2, ...,
        easting and northing. Where there are none it is guessed from what the columns
        hold, which a warning says.
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

    Warns
    -----
    FileWarning
        It was guessed which columns are coordinates.

    Examples
    --------
    >>> import remanifold as rm
    >>> points = rm.io.read_points("scan.ply")  # doctest: +SKIP
    """
    return read_file(path, format, fields=False, columns=columns)[1].points


def read_fields(
    path: StrPath, *, columns: Columns | None = None, format: str | None = None
) -> dict[str, NDArray[Any]]:
    """Read the values that a file gives at its vertices.

    Parameters
    ----------
    path : str or path-like
        The file. "-" is standard input.
    columns : str or sequence of int and str, optional
        Which columns are coordinates, and so no fields, as in `read_points`.
    format : str, optional
        The format by its suffix, such as "ply", whatever the name of the file.

    Returns
    -------
    dict of str to ndarray
        Arrays of N rows by their names. What was written as bool comes back as uint8
        except from ``.npz``, ``.parquet`` and ``.zarr``. Columns nx, ny and nz are the
        field ``normals``; red, green, blue and alpha, or r, g, b, are ``colors``.
        Words are numbered in alphabetical order.

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
    return read_file(path, format, columns=columns)[1].fields


def read_file(
    path: StrPath,
    format: str | None,
    *,
    fields: bool = True,
    cells: bool = False,
    known: tuple[str, ...] = tuple(READERS),
    columns: Columns | None = None,
    warn: bool = True,
) -> tuple[Source, FileMesh]:
    """Read points, and fields and simplices if wanted.

    What was guessed is a warning, unless the caller says it otherwise.
    """
    asked = check_columns(columns)
    suffix = _checked_suffix(path, format, known)
    source = Source(path, suffix, asked, cells)
    try:
        # Casts of signaling NaN are invalid to the processor, and NaN all the same.
        with _damage(source), np.errstate(invalid="ignore"):
            mesh = READERS[suffix](source, fields or asked is not None)
            mesh.points = np.ascontiguousarray(mesh.points, dtype=np.float64)
        if mesh.points.size == 0:
            source.fail("holds no points")
        if source.columns is not None:
            take_columns(source, mesh)
        if suffix in _TABLES:
            _mark_missing(source, mesh)
        _look_at_shape(source, mesh)
    except ValueError as error:
        more = advice(source)
        if not more and "truncated" in str(error):
            more = "copy or export it again"
        if not more:
            raise
        msg = f"{error}; {more}"
        raise ValueError(msg) from error
    for what in source.guesses if warn else ():
        text = what.replace("COLUMNS", "columns=")
        warnings.warn(f"{source}: {text}", FileWarning, stacklevel=3)
    return source, mesh


@contextlib.contextmanager
def _damage(source: Source) -> Iterator[None]:
    """Refuse what a reader stumbles over: bytes of a damaged file may say anything."""
    try:
        yield
    except (
        *(ArithmeticError, AttributeError, EOFError, LookupError, RecursionError),
        *(TypeError, ValueError, struct.error),
    ) as error:
        if isinstance(error, ValueError) and str(error).startswith(str(source)):
            raise
        reason = f"{type(error).__name__}: {error}"
        source.fail(f"is damaged or truncated ({reason})", error)


def _mark_missing(source: Source, mesh: FileMesh) -> None:
    """Make NaN of numbers that stand for none, such as -9999 far from all others."""
    found: dict[float, list[int]] = {}  # coordinates that have a number instead of NaN
    for axis, column in enumerate(mesh.points.T):
        values = column[np.isfinite(column)]
        for value in {values.min(), values.max()} if len(values) else ():
            others = values[values != value]
            if (
                len(others) < 2
                or not np.isclose(value, _NO_DATA, rtol=1e-6, atol=0).any()
            ):
                continue  # single precision has its own 1e30
            low, high = others.min(), others.max()
            if min(abs(value - low), abs(value - high)) > high - low:
                column[column == value] = np.nan
                found.setdefault(float(value), []).append(axis)
    for value, axes in found.items():
        where = ", ".join(map(str, axes[:12])) + (", ..." if len(axes) > 12 else "")
        source.guess(
            f"{value:g}, far from all other numbers of coordinate {where}, is read as "
            "NaN, for missing values are written so"
        )


def _look_at_shape(source: Source, mesh: FileMesh) -> None:
    """Say where coordinates stand in rows."""
    count, dim = mesh.points.shape
    if count <= _FEW_ROWS and dim >= _MANY_COLUMNS:
        source.guess(
            f"has {count} points of {dim:,} coordinates: if it holds {dim:,} points, "
            "transpose it"
        )


def is_folder(path: StrPath) -> bool:
    """Whether it is a folder that is no file of a format, as .zarr is one."""
    return (
        not is_standard(path)
        and Path(path).is_dir()
        and Path(path).suffix.lower() not in _FOLDERS
    )


def _checked_suffix(path: StrPath, format: str | None, known: tuple[str, ...]) -> str:
    """Suffix of a format that can be read, of a file that is there."""
    standard = is_standard(path)
    suffix = suffix_of(inner_name(path), format, known)
    if not standard and Path(path).is_dir() and suffix not in _FOLDERS:
        msg = (
            f"{path}: is a directory, expected a file with points; a folder of them is for "
            "remanifold.distributed.reconstruct"
        )
        raise IsADirectoryError(msg)
    if suffix not in known:
        what = "points" if known == tuple(READERS) else "simplices"
        more = ""
        if not standard and Path(path).is_file():
            more = advice(Source(path, suffix))
        msg = (
            f"{path}: cannot read {what} from {described(suffix)}; "
            f"{more or 'use one of ' + ', '.join(known)}"
        )
        raise ValueError(msg)
    if not standard and not Path(path).exists():
        msg = f"{path}: no such file"
        raise FileNotFoundError(msg)
    return suffix
