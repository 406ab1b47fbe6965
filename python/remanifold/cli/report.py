# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold report``: from a file of samples to a page that shows the result."""

from __future__ import annotations

import os
import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from remanifold._base.optional import load
from remanifold.cli._common import (
    ColumnsOption,
    DropInvalidOption,
    FormatOption,
    ThreadsOption,
    examples,
    failures,
    messages_console,
    refuse_same_file,
    say,
)
from remanifold.cli._options import (
    Boundary,
    Dim,
    Edges,
    Estimator,
    HoleRadius,
    Method,
    NumNeighbors,
    Outliers,
    Quiet,
    Search,
    Significance,
    Smooth,
    Source,
    options_of,
)
from remanifold.cli._reconstructing import reconstruct_file
from remanifold.page.report_page import check_page, write_report

EPILOG = examples(
    "remanifold report scan.ply --dim 2 -o scan.html",
    "remanifold report curve.csv -k auto -o curve.html --title Coastline",
)


def report(
    source: Source,
    dim: Dim,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Page to write: .html or .htm.")
    ],
    title: Annotated[
        str | None,
        typer.Option(show_default="name of the input", help="Heading of the page."),
    ] = None,
    method: Method = "manifold",
    boundary: Boundary = "auto",
    hole_radius: HoleRadius = None,
    significance: Significance = None,
    outliers: Outliers = None,
    smooth: Smooth = None,
    num_neighbors: NumNeighbors = None,
    estimator: Estimator = None,
    edges: Edges = None,
    search: Search = "auto",
    columns: ColumnsOption = None,
    drop_invalid: DropInvalidOption = False,
    format: FormatOption = None,
    threads: ThreadsOption = None,
    quiet: Quiet = False,
) -> None:
    """Reconstruct a manifold, and make a page of it.

    One file of HTML that needs no network, with the complex to turn and all figures.
    """
    messages = messages_console()
    options = options_of(
        method=method,
        boundary=boundary,
        hole_radius=hole_radius,
        significance=significance,
        outliers=outliers,
        smooth=smooth,
        num_neighbors=num_neighbors,
        estimator=estimator,
        edges=edges,
        search=search,
    )

    def check_target(*_: int | None) -> None:
        try:
            check_page(output)
        except ValueError as error:
            raise typer.BadParameter(str(error), param_hint="'--output'") from None
        refuse_same_file(source, output)

    with failures(messages):
        load("plotly", "plot")
        done = reconstruct_file(
            source,
            dim,
            options,
            check_target,
            messages,
            threads=threads,
            quiet=quiet,
            format=format,
            columns=columns,
            drop_invalid=drop_invalid,
        )
        command = shlex.join([*_program(), *sys.argv[1:]])
        write_report(done.rec, output, title or source.name, command)
        size = output.stat().st_size
    if not quiet:
        for text in done.complaints:
            say(messages, f"warning: {text}", "yellow")
        typer.echo(done.rec.quality.verdict)
        typer.echo(f"{output}, {size / 1e6:.1f} MB")


def _program() -> list[str]:
    name = os.path.basename(sys.argv[0])  # noqa: PTH119  not a path but its last part
    return ["python", "-m", "remanifold"] if name == "__main__.py" else [name]
