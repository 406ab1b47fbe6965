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

from remanifold.io.reading import read_complex, read_fields, read_points
from remanifold.io.writing import (
    check_output,
    write_complex,
    write_mesh,
    write_points,
)

__all__ = [
    "check_output",
    "read_complex",
    "read_fields",
    "read_points",
    "write_complex",
    "write_mesh",
    "write_points",
]
