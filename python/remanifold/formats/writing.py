# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing points, complexes and values at the vertices; the suffix names the format."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from remanifold._base.files import StrPath, check_target, complete_file
from remanifold._base.validation import check_choice
from remanifold.complex.data import check_complex
from remanifold.formats._gltf import write_glb, write_gltf
from remanifold.formats._mesh import FileMesh, comment_lines, finite_part, simplex_name
from remanifold.formats._obj import write_obj
from remanifold.formats._off import write_off
from remanifold.formats._parquet import write_parquet
from remanifold.formats._ply import write_ply
from remanifold.formats._source import (
    FloatArray,
    IntArray,
    described,
    is_standard,
    suffix_of,
)
from remanifold.formats._stl import write_stl
from remanifold.formats._tables import (
    RESERVED,
    write_csv,
    write_npy,
    write_npz,
    write_table,
)
from remanifold.formats._vtk import write_vtk
from remanifold.formats._vtk_xml import write_vtp, write_vtu
from remanifold.formats.saved import SUFFIX

if TYPE_CHECKING:
    from remanifold.complex.data import ComplexData


class Writer(NamedTuple):
    """A format: how it is written and what it can hold."""

    write: Callable[[IO[bytes], FileMesh], None]
    dims: tuple[int, ...] | None = None  # of simplices, all if None
    three: bool = True  # points have three coordinates
    points: bool = True  # without simplices
    fields: bool | tuple[str, ...] = False  # any, or those of these names


_SHOWN = ("colors", "normals")  # by all viewers, and of no more in some formats
WRITERS: dict[str, Writer] = {
    ".ply": Writer(write_ply, (1, 2), fields=True),
    ".obj": Writer(write_obj, (1, 2), fields=(*_SHOWN, "uv")),
    ".off": Writer(write_off, (2,), three=False, fields=_SHOWN),
    ".stl": Writer(write_stl, (2,), points=False),
    ".vtk": Writer(write_vtk, (1, 2, 3), fields=True),
    ".vtu": Writer(write_vtu, (1, 2, 3), fields=True),
    ".vtp": Writer(write_vtp, (1, 2), fields=True),
    ".glb": Writer(write_glb, (1, 2), points=False, fields=True),
    ".gltf": Writer(write_gltf, (1, 2), points=False, fields=True),
    ".npz": Writer(write_npz, None, three=False, fields=True),
    ".npy": Writer(write_npy, (), three=False),
    ".csv": Writer(write_csv, (), three=False, fields=True),
    ".txt": Writer(write_table, (), three=False, fields=True),
    ".xyz": Writer(write_table, (), three=False, fields=True),
    ".parquet": Writer(write_parquet, (), three=False, fields=True),
}
# What is often tried, and what writes it.
_PAGE = "rec.report() or `remanifold report` writes pages"
_IMAGE = "rec.plot(screenshot=...) or `remanifold view --screenshot` draws pictures"
_OTHERS = {
    **dict.fromkeys((".html", ".htm"), _PAGE),
    **dict.fromkeys((".png", ".jpg", ".jpeg", ".svg", ".pdf"), _IMAGE),
}
MESH_WRITERS = tuple(s for s, writer in WRITERS.items() if writer.dims != ())
POINT_WRITERS = tuple(s for s, writer in WRITERS.items() if writer.points)
FIELD_WRITERS = tuple(s for s, writer in WRITERS.items() if writer.fields is True)


def write_mesh(
    path: StrPath,
    vertices: ArrayLike,
    simplices: ArrayLike,
    *,
    fields: Mapping[str, ArrayLike] | None = None,
    format: str | None = None,
    comment: str | None = None,
) -> None:
    """Write vertices and simplices to a file.

    Parameters
    ----------
    path : str or path-like
        The file; its suffix names the format. A file of that name is replaced, but
        only when the new one is complete. "-" is standard output.

        ========== ============= ============================= ===============
        suffix     dimension D   simplices                     fields
        ========== ============= ============================= ===============
        ``.npz``   any           any                           yes
        ``.ply``   up to 3       edges, triangles              yes
        ``.obj``   up to 3       edges, triangles              these and uv
        ``.off``   any           triangles                     colors, normals
        ``.stl``   up to 3       triangles                     no
        ``.vtk``   up to 3       edges, triangles, tetrahedra  yes
        ``.vtu``   up to 3       edges, triangles, tetrahedra  yes
        ``.vtp``   up to 3       edges, triangles              yes
        ``.glb``   up to 3       edges, triangles              yes
        ``.gltf``  up to 3       edges, triangles              yes
        ========== ============= ============================= ===============

        An archive holds the arrays ``points`` and ``simplices``, and each field by its
        name. In the other formats points of fewer than three coordinates are filled up
        with zeros. OFF is nOFF beyond three. STL repeats the corners of each triangle
        and has no vertices of its own. glTF is in single precision; all others keep
        each bit.
    vertices : array_like of shape (N, D)
        Coordinates, real numbers.
    simplices : array_like of shape (M, K + 1)
        Indices of vertices.
    fields : mapping of str to array_like, optional
        Values at the vertices, of shape (N,) or (N, C): numbers or bool. In PLY
        ``normals`` are written as nx, ny, nz and ``colors`` as red, green, blue, alpha,
        in glTF as what shaders use. ``uv``, of shape (N, 2), are texture coordinates,
        (0, 0) at the lower left, in OBJ and glTF.
    format : str, optional
        The format by its suffix, such as "ply", whatever the name of the file.
    comment : str, optional
        Lines of text for whoever opens the file: in PLY, OBJ, OFF, VTU and VTP as
        comments, in glTF as extras of the asset, in an archive as its comment. STL and
        VTK have one line, which holds the first and the last, and the digests.

    Raises
    ------
    ValueError
        If the format cannot hold the mesh, or the arrays do not fit together.
    OSError
        If the file cannot be written. Nothing is left behind.

    Examples
    --------
    >>> import remanifold as rm
    >>> rm.io.write_mesh("mesh.ply", rec.vertices, rec.simplices)  # doctest: +SKIP
    """
    points, cells = _check_mesh(vertices, simplices)
    mesh = FileMesh(points, {cells.shape[1]: cells}, check_fields(fields, len(points)))
    mesh.comment = comment_lines(comment)
    check_output(path, cells.shape[1] - 1, points.shape[1], format=format)
    _write(path, mesh, format, MESH_WRITERS)


def write_complex(
    path: StrPath,
    complex: ComplexData,
    fields: Literal["auto"] | Mapping[str, ArrayLike] | None = "auto",
    *,
    format: str | None = None,
    comment: str | None = None,
) -> None:
    """Write a complex to a file.

    Parameters
    ----------
    path : str or path-like
        The file; its suffix names the format, as for `write_mesh`.
    complex : SimplicialComplex
        Its vertices must have coordinates.
    fields : "auto", None or mapping of str to array_like
        Values at the vertices, of shape (N,) or (N, C): numbers or bool. "auto": those
        of the complex's `vertex_attributes` that the format holds.
    format : str, optional
        The format by its suffix, such as "ply", whatever the name of the file.
    comment : str, optional
        As for `write_mesh`; of a `Reconstruction` version, parameters and digests.

    Raises
    ------
    ValueError
        If the format cannot hold the complex, or it has no coordinates.
    OSError
        If the file cannot be written. Nothing is left behind.

    Examples
    --------
    >>> import remanifold as rm
    >>> rm.io.write_complex("mesh.vtu", rec, {"spacing": s})  # doctest: +SKIP
    """
    check_complex(complex)
    if complex.vertices is None:
        msg = (
            "complex has no coordinates, only inner products or distances: write its "
            "simplices with numpy.save"
        )
        raise ValueError(msg)
    if isinstance(fields, str):
        check_choice(fields, "fields", ("auto",))
        fields = fitting_fields(path, complex.vertex_attributes, format)
    if comment is None:
        comment = complex.comment
    write = write_valid if np.isnan(complex.vertices).any() else write_mesh
    write(
        path,
        complex.vertices,
        complex.simplices,
        fields=fields,
        format=format,
        comment=comment,
    )


def write_valid(
    path: StrPath,
    vertices: NDArray[np.float64],
    simplices: NDArray[np.integer],
    fields: Mapping[str, ArrayLike] | None,
    *,
    format: str | None = None,
    comment: str | None = None,
) -> None:
    """Write a mesh without the vertices that are nowhere, and which the others were."""
    rows, cells = finite_part(vertices, simplices)
    checked = check_fields(fields, len(vertices))
    kept: dict[str, ArrayLike] = {name: array[rows] for name, array in checked.items()}
    if fields is not None:
        kept |= fitting_fields(path, {"sample": rows}, format)
    write_mesh(path, vertices[rows], cells, fields=kept, format=format, comment=comment)


def suffix_for(dim: int, ambient_dim: int) -> str:
    """The most common format that holds such simplices with any fields."""
    fitting = (".ply", ".vtu") if ambient_dim <= 3 else ()
    return next((s for s in fitting if dim in (WRITERS[s].dims or ())), ".npz")


def mesh_bytes(
    suffix: str, complex: ComplexData, fields: Mapping[str, ArrayLike]
) -> bytes:
    """A mesh as a file would hold it, without the vertices that are nowhere."""
    assert complex.vertices is not None
    rows, cells = finite_part(complex.vertices, complex.simplices)
    known = check_fields(fields, len(complex.vertices))
    mesh = FileMesh(
        complex.vertices[rows],
        {cells.shape[1]: cells},
        {name: array[rows] for name, array in known.items()},
        comment=comment_lines(complex.comment),
    )
    missing = 3 - mesh.points.shape[1]
    if missing > 0 and WRITERS[suffix].three:
        mesh.points = np.pad(mesh.points, ((0, 0), (0, missing)))
    held = io.BytesIO()
    WRITERS[suffix].write(held, mesh)
    return held.getvalue()


def write_points(
    path: StrPath,
    points: ArrayLike,
    *,
    fields: Mapping[str, ArrayLike] | None = None,
    format: str | None = None,
) -> None:
    """Write points to a file.

    Parameters
    ----------
    path : str or path-like
        The file; its suffix names the format. Of any dimension: ``.npy``, ``.npz``,
        ``.csv``, ``.txt``, ``.xyz``, ``.parquet`` and ``.off``; up to three coordinates:
        ``.ply``, ``.obj``, ``.vtk``, ``.vtu`` and ``.vtp``, filled up with zeros. "-" is
        standard output.
    points : array_like of shape (N, D)
        Coordinates, real numbers.
    fields : mapping of str to array_like, optional
        Values at the points; ``.npy`` holds none, ``.obj`` and ``.off`` only ``colors``
        and ``normals``. Tables have a column for each number.
    format : str, optional
        The format by its suffix, such as "csv", whatever the name of the file.

    Raises
    ------
    ValueError
        If the format cannot hold the points.
    OSError
        If the file cannot be written. Nothing is left behind.

    Examples
    --------
    >>> import remanifold as rm
    >>> rm.io.write_points("sphere.csv", rm.datasets.sphere(99))  # doctest: +SKIP
    """
    array = _check_vertices(points, "points")
    mesh = FileMesh(array, {}, check_fields(fields, len(array)))
    suffix = suffix_of(path, format, POINT_WRITERS)
    if suffix not in POINT_WRITERS:
        msg = (
            f"{path}: cannot write points to {described(suffix)}; "
            f"use one of {', '.join(POINT_WRITERS)}"
        )
        raise ValueError(msg)
    if WRITERS[suffix].three and array.shape[1] > 3:
        _refuse_coordinates(path, suffix, array.shape[1], POINT_WRITERS)
    if not is_standard(path):
        check_target(path)
    _write(path, mesh, format, POINT_WRITERS)


def check_output(
    path: StrPath,
    dim: int | None = None,
    ambient_dim: int | None = None,
    *,
    format: str | None = None,
) -> Path:
    """Check that a mesh can be written to a file, before any work is done for it.

    Parameters
    ----------
    path : str or path-like
        The file to write to; its suffix names the format.
    dim : int, optional
        Dimension K of the simplices, if it is known already.
    ambient_dim : int, optional
        Number of coordinates, if it is known already.
    format : str, optional
        The format by its suffix, such as "ply", whatever the name of the file.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ValueError
        If the format is unknown or cannot hold such a mesh; the message names the
        formats that can.
    OSError
        If there is no such folder, or no file can be written to it.
    """
    suffix = suffix_of(path, format, MESH_WRITERS)
    if suffix not in MESH_WRITERS:
        other = _OTHERS.get(suffix)
        msg = (
            f"{path}: cannot write a mesh to {described(suffix)}; "
            f"{f'{other}; a mesh is ' if other else 'use '}one of "
            f"{', '.join(MESH_WRITERS)}"
        )
        raise ValueError(msg)

    def holds(suffix: str) -> bool:
        writer = WRITERS[suffix]
        if writer.three and ambient_dim is not None and ambient_dim > 3:
            return False
        return dim is None or writer.dims is None or dim in writer.dims

    if not holds(suffix):
        dims = WRITERS[suffix].dims
        fitting = tuple(other for other in MESH_WRITERS if holds(other))
        if dims is None or dim is None or dim in dims:
            assert ambient_dim is not None
            _refuse_coordinates(path, suffix, ambient_dim, fitting)
        assert dim is not None
        others = ", ".join(fitting)
        msg = f"{path}: {suffix} cannot hold {simplex_name(dim)}; use {others}"
        raise ValueError(msg)
    return Path(path) if is_standard(path) else check_target(path)


def _refuse_coordinates(
    path: StrPath, suffix: str, number: int, fitting: tuple[str, ...]
) -> None:
    others = ", ".join(s for s in fitting if not WRITERS[s].three)
    msg = f"{path}: {suffix} cannot hold points with {number} coordinates; use {others}"
    raise ValueError(msg)


def _write(
    path: StrPath, mesh: FileMesh, format: str | None, known: tuple[str, ...]
) -> None:
    suffix = suffix_of(path, format, known)
    writer = WRITERS[suffix]
    lost = []
    if writer.fields is not True:
        lost = [n for n, array in mesh.fields.items() if not _fits(suffix, n, array)]
    if lost:
        names = ", ".join(map(repr, lost))
        others = ", ".join(other for other in FIELD_WRITERS if other in known)
        msg = f"{path}: {suffix} cannot hold the fields {names}; use {others}"
        raise ValueError(msg)
    if os.fspath(path).lower().endswith(SUFFIX):
        msg = (
            f"{path}: {SUFFIX} is the name of a saved result, which rec.save() writes; "
            "a mesh takes another"
        )
        raise ValueError(msg)
    if suffix == ".npz":
        for name in RESERVED:
            if name in mesh.fields:
                msg = f"fields: {name!r} is an array that each .npz file has itself"
                raise ValueError(msg)
    missing = 3 - mesh.points.shape[1]
    if missing > 0 and (writer.three or (suffix == ".off" and mesh.cells)):
        mesh.points = np.pad(mesh.points, ((0, 0), (0, missing)))
    if is_standard(path):
        # Complete before the first byte goes out.
        held = io.BytesIO()
        writer.write(held, mesh)
        sys.stdout.flush()
        sys.stdout.buffer.write(held.getvalue())
        sys.stdout.buffer.flush()
        return
    with complete_file(path) as file:
        writer.write(file, mesh)


def _check_vertices(vertices: ArrayLike, name: str) -> FloatArray:
    points = np.asarray(vertices)
    if points.ndim != 2 or points.shape[1] == 0 or points.dtype.kind not in "biuf":
        msg = (
            f"{name} must be real numbers of shape (N, D), "
            f"got {points.dtype} {points.shape}"
        )
        raise ValueError(msg)
    return points.astype(np.float64)


def _check_mesh(
    vertices: ArrayLike, simplices: ArrayLike
) -> tuple[FloatArray, IntArray]:
    points = _check_vertices(vertices, "vertices")
    cells = np.asarray(simplices)
    if cells.ndim != 2 or cells.shape[1] < 2 or cells.dtype.kind not in "iu":
        msg = (
            "simplices must be integers of shape (M, K + 1) with K >= 1, "
            f"got {cells.dtype} {cells.shape}"
        )
        raise ValueError(msg)
    if cells.size and not 0 <= cells.min() <= cells.max() < len(points):
        msg = (
            f"simplices must hold indices from 0 to {len(points) - 1}, "
            f"got {cells.min()} to {cells.max()}"
        )
        raise ValueError(msg)
    return points, cells.astype(np.int64)


def _fits(suffix: str, name: str, array: NDArray[Any]) -> bool:
    """Whether a format holds a field."""
    held = WRITERS[suffix].fields
    if suffix in (".glb", ".gltf") and array.ndim == 2 and array.shape[1] > 4:
        return False
    if isinstance(held, bool):
        return held
    widths = {"colors": (3, 4), "uv": (2,)}.get(name, (3,))
    return name in held and array.ndim == 2 and array.shape[1] in widths


def fitting_fields(
    path: StrPath, fields: Mapping[str, ArrayLike], format: str | None = None
) -> dict[str, ArrayLike]:
    """Those of the fields that a file of this name can hold."""
    suffix = suffix_of(path, format, tuple(WRITERS))
    if suffix not in WRITERS:
        return {}
    return {
        name: values
        for name, values in fields.items()
        if _fits(suffix, name, np.asarray(values))
    }


def check_fields(
    fields: Any, num_vertices: int, called: str = "fields"
) -> dict[str, NDArray[Any]]:
    """Check names and shapes of values at the vertices."""
    if fields is None:
        return {}
    if not isinstance(fields, Mapping) and hasattr(fields, "columns"):
        fields = {name: fields[name] for name in fields.columns}  # a data frame
    if not isinstance(fields, Mapping):
        msg = f"{called} must map names to arrays, got {type(fields).__name__}"
        raise TypeError(msg)
    checked = {}
    for name, values in fields.items():
        if not isinstance(name, str) or not name or not name.isprintable():
            msg = f"{called}: {name!r} is no name; use letters, digits and underscores"
            raise ValueError(msg)
        array = np.asarray(values)
        if array.dtype.kind not in "biuf":
            msg = f"{called}[{name!r}] holds {array.dtype}, expected numbers or bool"
            raise ValueError(msg)
        if (
            array.ndim not in (1, 2)
            or len(array) != num_vertices
            or (array.ndim == 2 and array.shape[1] == 0)
        ):
            msg = (
                f"{called}[{name!r}] has shape {array.shape}, expected "
                f"({num_vertices},) or ({num_vertices}, C), a row for each vertex"
            )
            raise ValueError(msg)
        checked[name] = array
    return checked
