# SPDX-License-Identifier: GPL-3.0-or-later
"""LAS and LAZ, the files of airborne and terrestrial scanners, by laspy."""

from __future__ import annotations

import numpy as np

from remanifold.io._mesh import FileMesh
from remanifold.io._source import Source

_HINT = "reading .las and .laz needs laspy and lazrs: pip install remanifold[las]"


def read_las(source: Source, cells: bool) -> FileMesh:
    """Read points, scaled and moved as the header says, and all that goes with them."""
    try:
        import laspy
        import lazrs  # noqa: F401  laspy finds it by itself
    except ImportError as error:
        raise ImportError(_HINT) from error
    try:
        with source.open() as file:
            cloud = laspy.read(file, closefd=False)
        points = np.column_stack(
            [np.asarray(getattr(cloud, axis), dtype=np.float64) for axis in "xyz"]
        )
        expected = int(cloud.header.point_count)
        fields = {}
        if cells:
            names = [*cloud.point_format.dimension_names]
            fields = {n: np.array(cloud[n]) for n in names if n not in ("X", "Y", "Z")}
    # A damaged file is reported by whatever stumbles over it first; lazrs, written in
    # Rust, panics.
    except (KeyboardInterrupt, SystemExit, MemoryError):
        raise
    except BaseException as error:  # noqa: BLE001
        reason = str(error) or type(error).__name__
        source.fail(f"is damaged, truncated or no LAS file ({reason})", error)
    if len(points) < expected:
        what = f"expected {expected} points, found {len(points)}"
        source.fail(f"is truncated: {what}")
    return FileMesh(points, {}, fields)
