# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold view``: a mesh in a window, or as a picture in a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

import remanifold as rm
from remanifold.cli._common import choice, failures, listed, messages_console
from remanifold.cli._examples import examples
from remanifold.drawing.draw_pyvista import has_display
from remanifold.drawing.plotting import BACKENDS
from remanifold.drawing.scene import STYLES
from remanifold.formats.reading import WITH_SIMPLICES

if TYPE_CHECKING:
    from remanifold.drawing.plotting import Backend
    from remanifold.drawing.scene import Style

COLORS = ("component", "boundary", "quality")
EPILOG = examples(
    "remanifold view mesh.ply",
    "remanifold view mesh.npz --color component --screenshot mesh.png",
    "remanifold view colored.ply --color colors",
)


def view(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help=f"Mesh: {listed(WITH_SIMPLICES)}; .npz as written by reconstruct.",
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
        typer.Option(
            metavar="NAME",
            show_default="one",
            help="Color by component, boundary, quality (shape of the simplices), or by "
            "a field of the file: numbers, or colors.",
        ),
    ] = None,
    style: Annotated[
        str, choice(STYLES, "Triangles, tetrahedra drawn apart, or edges only.")
    ] = "auto",
    backend: Annotated[str, choice(BACKENDS, "Library that draws.")] = "auto",
) -> None:
    """Draw a mesh, in a window or to a file.

    Beyond three dimensions a projection is drawn, which the picture names.
    """
    with failures(messages_console()):
        complex = rm.io.read_complex(source)
        known = (*COLORS, *complex.vertex_attributes)
        if color is not None and color not in known:
            msg = f"{color!r} is not one of {', '.join(map(repr, known))}."
            raise typer.BadParameter(msg, param_hint="'--color'")
        if screenshot is not None and screenshot.suffix.lower() in (".html", ".htm"):
            backend = "plotly"
        if screenshot is None and backend != "plotly" and not has_display():
            msg = (
                "there is no display to open a window on; name a picture to write, as in "
                f"--screenshot {source.stem}.png"
            )
            raise OSError(msg)
        rm.plot(
            complex,
            color=color,
            style=cast("Style", style),
            backend=cast("Backend", backend),
            title=source.name,
            screenshot=screenshot,
        )
