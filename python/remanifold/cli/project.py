# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold project``: the nearest points of a mesh."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.table import Table

from remanifold.cli._common import (
    ColumnsOption,
    FormatOption,
    JsonOption,
    OutputFormatOption,
    ThreadsOption,
    failures,
    listed,
    messages_console,
    print_report,
    read_input,
    refuse_same_file,
    rows_table,
    split_formats,
    timed,
)
from remanifold.cli._examples import examples
from remanifold.complex.topology import simplex_names
from remanifold.formats._source import is_standard
from remanifold.formats.reading import WITH_SIMPLICES
from remanifold.formats.writing import fitting_fields
from remanifold.io import read_complex, write_points

EPILOG = examples(
    "remanifold project mesh.ply points.csv -o nearest.npz",
    "remanifold project mesh.ply points.csv --json",
    "cat points.csv | remanifold project mesh.ply - --format csv -o nearest.csv",
)


def project(
    mesh: Annotated[
        Path,
        typer.Argument(
            metavar="MESH",
            help=f"Complex to project onto: {listed(WITH_SIMPLICES)}.",
        ),
    ],
    source: Annotated[
        Path,
        typer.Argument(
            metavar="POINTS",
            help="Points, in any format that can be read; - is standard input.",
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            show_default="distances are reported, nothing is written",
            help="File for the nearest points; - is standard output. Most formats "
            "also hold the fields distance, simplex and barycentric.",
        ),
    ] = None,
    dim: Annotated[
        int | None,
        typer.Option(
            "--dim",
            "-k",
            min=1,
            show_default="the highest in the file",
            help="Dimension of the simplices to project onto.",
        ),
    ] = None,
    columns: ColumnsOption = None,
    format: FormatOption = None,
    output_format: OutputFormatOption = None,
    threads: ThreadsOption = None,
    as_json: JsonOption = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="No progress and no table.")
    ] = False,
) -> None:
    """Find the nearest points of a mesh.

    Exactly, in any dimension, with their distances.
    """
    messages = messages_console()
    with failures(messages):
        format, output_format = split_formats(source, output, format, output_format)
        if output is not None:
            refuse_same_file(source, output)
            refuse_same_file(mesh, output)
        complex_ = read_complex(mesh, dim)
        _, cloud, _ = read_input(
            source, format, columns, messages, fields=False, quiet=quiet
        )
        points = cloud.points
        _check_coordinates(mesh, complex_.ambient_dim, points.shape[1])
        found, seconds = timed(
            lambda: complex_.project(
                points,
                num_threads=threads,
                progress=messages.is_terminal and not quiet,
            )
        )
        if output is not None:
            _write(output, output_format, found)
    report: dict[str, Any] = {
        "mesh": str(mesh),
        "input": str(source),
        "output": None if output is None else str(output),
        "num_points": len(points),
        "ambient_dim": complex_.ambient_dim,
        "dim": complex_.dim,
        "num_simplices": len(complex_.simplices),
        "distances": {
            "smallest": float(found.distances.min()),
            "median": float(np.median(found.distances)),
            "root_mean_square": float(np.sqrt(np.mean(np.square(found.distances)))),
            "largest": float(found.distances.max()),
            "farthest_point": int(found.distances.argmax()),
        },
        "seconds": {"projection": seconds},
    }
    if as_json or not quiet:
        streams = output is not None and is_standard(output)
        print_report(report, _table, as_json=as_json, stderr=streams)


def _check_coordinates(mesh: Path, expected: int | None, found: int) -> None:
    if expected != found:
        msg = f"have {found} coordinates, {mesh} has {expected}"
        raise typer.BadParameter(msg, param_hint="'POINTS'")


def _write(output: Path, output_format: str | None, found: Any) -> None:
    fields = {
        "distance": found.distances,
        "simplex": found.simplices,
        "barycentric": found.barycentric,
    }
    kept = fitting_fields(output, fields, output_format)
    write_points(output, found.points, fields=kept or None, format=output_format)


def _table(report: dict[str, Any]) -> Table:
    distances = report["distances"]
    rows = {
        "points": f"{report['num_points']:,} in R^{report['ambient_dim']}",
        "projected onto": f"{report['num_simplices']:,} "
        f"{simplex_names(report['dim'])[-1]}",
        "distances": f"{distances['smallest']:.4g} to {distances['largest']:.4g}, "
        f"{distances['median']:.4g} in the median, "
        f"{distances['root_mean_square']:.4g} root mean square",
        "farthest": f"point {distances['farthest_point']:,}",
        "seconds": f"{report['seconds']['projection']:.2f} projection",
    }
    if report["output"] is not None:
        rows["written"] = report["output"]
    return rows_table(rows)
