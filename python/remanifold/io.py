# SPDX-License-Identifier: GPL-3.0-or-later
"""Points and complexes from files and to files; the suffix names the format.

Coordinates are written so that they are read back unchanged, in the same order, and a
file appears under its name only when it is complete. "-" stands for standard input and
output, with a format named by ``format=``.

>>> import remanifold as rm, tempfile, pathlib
>>> folder = tempfile.TemporaryDirectory()
>>> path = pathlib.Path(folder.name) / "square.ply"
>>> square = rm.SimplicialComplex(
...     [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]
... )
>>> rm.io.write_complex(path, square, {"height": [0, 1, 2, 3]})
>>> rm.io.read_complex(path)
SimplicialComplex(vertices=4, ambient_dim=3, dim=2, simplices=2)
>>> rm.io.read_fields(path)
{'height': array([0, 1, 2, 3], dtype=int32)}
>>> folder.cleanup()
"""

from __future__ import annotations

import numpy as np

from remanifold._base.files import StrPath
from remanifold.formats._mesh import choose_simplices, without_degenerate
from remanifold.formats.reading import (
    WITH_SIMPLICES,
    PointCloud,
    read,
    read_fields,
    read_file,
    read_points,
)
from remanifold.formats.writing import (
    check_output,
    write_complex,
    write_mesh,
    write_points,
)
from remanifold.results.simplicial_complex import SimplicialComplex

__all__ = [
    "PointCloud",
    "check_output",
    "read",
    "read_complex",
    "read_fields",
    "read_points",
    "write_complex",
    "write_mesh",
    "write_points",
]


def read_complex(
    path: StrPath, dim: int | None = None, *, format: str | None = None
) -> SimplicialComplex:
    """Read vertices and simplices from a file.

    Parameters
    ----------
    path : str or path-like
        A file that `write_complex` can write, by remanifold or another program:
        ``.npz``, ``.ply``, ``.obj``, ``.off``, ``.stl``, ``.vtk``, ``.vtu``, ``.vtp``,
        ``.glb`` or ``.gltf``. "-" is standard input.
    dim : int, optional
        Dimension of the simplices to read. By default the highest in the file; all
        others must then be faces of these.
    format : str, optional
        The format by its suffix, such as "ply", whatever the name of the file.

    Returns
    -------
    SimplicialComplex
        All vertices, in the order of the file, the simplices, and what the file says of
        each vertex as `vertex_attributes`.

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
    Polygons are cut into triangles: from their first corner, where that does not see all
    others from one that does, else ear by ear. Strips and quadratic cells are cut too;
    voxels and their like are refused by name.

    Examples
    --------
    >>> import remanifold as rm
    >>> mesh = rm.io.read_complex("mesh.ply")  # doctest: +SKIP
    """
    source, mesh = read_file(path, format, cells=True, known=WITH_SIMPLICES)
    simplices = without_degenerate(source, choose_simplices(source, mesh, dim))
    try:
        return SimplicialComplex(
            mesh.points, simplices.astype(np.int32), vertex_attributes=mesh.fields
        )
    except (ValueError, TypeError) as error:
        source.fail(str(error), error)


def __dir__() -> list[str]:
    """Public names only."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
