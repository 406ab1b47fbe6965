# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold convert``: points or a mesh into another format."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import remanifold as rm
from remanifold.cli._common import (
    ColumnsOption,
    FormatOption,
    OutputFormatOption,
    failures,
    listed,
    messages_console,
    read_input,
    refuse_same_file,
    say,
    split_formats,
)
from remanifold.cli._examples import examples
from remanifold.complex.topology import simplex_names
from remanifold.formats._mesh import FileMesh, choose_simplices, without_degenerate
from remanifold.formats._source import described, is_standard, suffix_of
from remanifold.formats.writing import (
    MESH_WRITERS,
    POINT_WRITERS,
    WRITERS,
    fitting_fields,
)
from remanifold.io import write_mesh, write_points

EPILOG = examples(
    "remanifold convert mesh.ply mesh.vtu",
    "remanifold convert mesh.stl points.csv --points",
    "remanifold convert mesh.npz mesh.glb --lossy",
    "remanifold convert mesh.ply - --format off | head -2",
)


def convert(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="INPUT",
            help="Points or a mesh, in any format that can be read; - is standard "
            "input.",
        ),
    ],
    output: Annotated[
        Path,
        typer.Argument(
            metavar="OUTPUT",
            help="File to write; - is standard output. Meshes: "
            f"{listed(MESH_WRITERS)}; points: {listed(POINT_WRITERS)}.",
        ),
    ],
    points: Annotated[
        bool, typer.Option("--points", help="Take the points and leave the rest.")
    ] = False,
    lossy: Annotated[
        bool,
        typer.Option("--lossy", help="Convert even where something would be lost."),
    ] = False,
    dim: Annotated[
        int | None,
        typer.Option(
            "--dim",
            "-k",
            min=1,
            show_default="the highest in the file",
            help="Dimension of the simplices to take.",
        ),
    ] = None,
    columns: ColumnsOption = None,
    format: FormatOption = None,
    output_format: OutputFormatOption = None,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Say nothing but errors.")
    ] = False,
) -> None:
    """Write points or a mesh in another format.

    Values at the vertices go along where the format holds them.
    """
    messages = messages_console()
    with failures(messages):
        format, output_format = split_formats(source, output, format, output_format)
        refuse_same_file(source, output, "OUTPUT")
        suffix = suffix_of(output, output_format, tuple(WRITERS))
        if suffix not in WRITERS:
            known = ", ".join(WRITERS)
            msg = f"{output}: cannot write to {described(suffix)}; use one of {known}"
            raise typer.BadParameter(msg, param_hint="'OUTPUT'")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", rm.RemanifoldWarning)
            file, mesh, _ = read_input(
                source,
                format,
                columns,
                messages,
                fields=not points,
                cells=not points,
                quiet=quiet,
            )
            if dim is not None or any(map(len, mesh.cells.values())):
                cells = without_degenerate(file, choose_simplices(file, mesh, dim))
                mesh.cells = {cells.shape[1]: cells}
            else:
                mesh.cells = {}
        lost = _losses(mesh, suffix)
        if lost and not lossy:
            msg = f"{suffix} would lose {'; '.join(lost)}. Say --lossy to do so."
            raise typer.BadParameter(msg, param_hint="'OUTPUT'")
        _write(output, output_format, mesh, suffix)
    if quiet:
        return
    for warning in caught:
        say(messages, f"warning: {warning.message}", "yellow")
    if lost:
        say(messages, f"warning: lost: {'; '.join(lost)}", "yellow")
    what = _contents(mesh, suffix)
    if not is_standard(output):
        typer.echo(f"{output}: {what}")


def _losses(mesh: FileMesh, suffix: str) -> list[str]:
    """Say what a file of this format cannot hold but the mesh has."""
    lost = []
    gone = [name for name in mesh.fields if name not in _kept(mesh, suffix)]
    if gone:
        lost.append(f"the fields {', '.join(gone)}")
    for size, cells in mesh.cells.items():
        if suffix not in MESH_WRITERS:
            lost.append(f"{len(cells):,} {simplex_names(size - 1)[-1]}")
        elif suffix == ".stl" and size == 3:
            used = mesh.points[np.unique(cells)]
            unused, distinct = len(mesh.points) - len(used), np.unique(used, axis=0)
            if unused:
                lost.append(f"{unused:,} vertices in no triangle")
            if len(distinct) < len(used):
                same = len(used) - len(distinct)
                lost.append(f"{same:,} vertices where there is another one")
    if suffix in (".glb", ".gltf"):
        with np.errstate(over="ignore"):
            single = mesh.points.astype(np.float32)
        if (single != mesh.points).any():
            lost.append("the digits of the coordinates beyond single precision")
    return lost


def _kept(mesh: FileMesh, suffix: str) -> dict[str, Any]:
    """Fields that the format holds."""
    return fitting_fields(f"a{suffix}", mesh.fields)


def _write(
    output: Path, output_format: str | None, mesh: FileMesh, suffix: str
) -> None:
    fields = _kept(mesh, suffix)
    if mesh.cells and suffix in MESH_WRITERS:
        (cells,) = mesh.cells.values()
        write_mesh(
            output,
            mesh.points,
            cells,
            fields=fields,
            format=output_format,
            comment="\n".join(mesh.comment),
        )
    else:
        write_points(output, mesh.points, fields=fields, format=output_format)


def _contents(mesh: FileMesh, suffix: str) -> str:
    parts = [f"{len(mesh.points):,} points in R^{mesh.points.shape[1]}"]
    for size, cells in mesh.cells.items():
        if suffix in MESH_WRITERS:
            parts.append(f"{len(cells):,} {simplex_names(size - 1)[-1]}")
    if kept := _kept(mesh, suffix):
        parts.append(f"fields {', '.join(kept)}")
    return ", ".join(parts)
