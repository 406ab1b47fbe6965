# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold view``: a mesh in a window, or as a picture in a file."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

import remanifold as rm
from remanifold._scene import STYLES
from remanifold.cli._common import choice, failures, messages_console
from remanifold.plotting import BACKENDS

COLORS = ("component", "boundary", "quality")
CELLS = ("tetra", "triangle", "line", "vertex")


def view(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="Mesh: .npz as written by reconstruct, or .ply, .obj, .off, .stl, "
            ".vtk or .vtu.",
        ),
    ],
    screenshot: Annotated[
        Path | None,
        typer.Option(
            show_default="a window opens",
            help="Picture to write instead: .png and others, or .html with plotly.",
        ),
    ] = None,
    color: Annotated[
        str | None,
        choice(
            COLORS, "Color by component, boundary or shape of the simplices.", "one"
        ),
    ] = None,
    style: Annotated[
        str, choice(STYLES, "Triangles, tetrahedra drawn apart, or edges only.")
    ] = "auto",
    backend: Annotated[str, choice(BACKENDS, "Library that draws.")] = "auto",
) -> None:
    """Show a mesh; beyond three dimensions, a projection that the picture names."""
    with failures(messages_console()):
        complex = _read(source)
        if screenshot is not None and screenshot.suffix.lower() in (".html", ".htm"):
            backend = "plotly"
        rm.plot(
            complex,
            color=color,
            style=style,
            backend=backend,
            title=source.name,
            screenshot=screenshot,
        )


def _read(path: Path) -> rm.SimplicialComplex:
    """Simplices of the highest dimension in a file."""
    if path.suffix.lower() == ".npz":
        with np.load(path) as arrays:
            missing = {"points", "simplices"} - set(arrays.files)
            if missing:
                msg = f"{path}: has no array {' and no array '.join(sorted(missing))}"
                raise ValueError(msg)
            return rm.SimplicialComplex(arrays["points"], arrays["simplices"])
    import meshio

    rm.io.read_points(path)  # says in one line what is wrong with a file
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mesh = meshio.read(path)
    for kind in CELLS:
        if kind in mesh.cells_dict:
            return rm.SimplicialComplex(mesh.points, mesh.cells_dict[kind])
    msg = f"{path}: has no simplices"
    raise ValueError(msg)
