# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold report``: from a file of samples to a page that shows the result."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

import remanifold as rm
from remanifold._base.optional import load
from remanifold.cli._common import (
    ColumnsOption,
    DropInvalidOption,
    FormatOption,
    ThreadsOption,
    command_line,
    failures,
    is_saved_result,
    messages_console,
    refuse_same_file,
    say,
)
from remanifold.cli._examples import examples
from remanifold.cli._options import (
    Boundary,
    Checks,
    Dim,
    Edges,
    Estimator,
    HoleRadius,
    Matrix,
    MaxMemory,
    MaxSeconds,
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
from remanifold.method.options import CHECKS, Options
from remanifold.page.report_page import check_page, write_report

EPILOG = examples(
    "remanifold report scan.ply --dim 2 -o scan.html",
    "remanifold report scan.rm.npz -o scan.html",
    "remanifold report curve.csv -k auto -o curve.html --title Coastline",
)


def report(
    source: Source,
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Page to write: .html or .htm.")
    ],
    dim: Dim = None,
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
    checks: Checks = CHECKS,
    columns: ColumnsOption = None,
    matrix: Matrix = None,
    drop_invalid: DropInvalidOption = False,
    format: FormatOption = None,
    threads: ThreadsOption = None,
    max_seconds: MaxSeconds = None,
    max_memory: MaxMemory = None,
    quiet: Quiet = False,
) -> None:
    """Reconstruct a manifold, or take a saved result, and make a page of it.

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
        checks=checks,
    )

    def check_target(*_: int | None) -> None:
        try:
            check_page(output)
        except ValueError as error:
            raise typer.BadParameter(str(error), param_hint="'--output'") from None
        refuse_same_file(source, output)

    saved = is_saved_result(source)
    if saved and (dim is not None or matrix or vars(options) != vars(Options())):
        msg = f"{source}: is a saved result, which has its parameters already."
        raise typer.BadParameter(msg, param_hint="'INPUT'")
    if not saved and dim is None:
        msg = "is needed: the dimension of the manifold, or auto."
        raise typer.BadParameter(msg, param_hint="'--dim' / '-k'")
    with failures(messages):
        load("plotly", "plot")
        if saved:
            check_target()
            rec = rm.load(source)
            write_report(rec, output, title or source.name, rec.provenance.command)
            _tell(rec, output, [], messages, quiet=quiet)
            return
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
            matrix=matrix,
            max_seconds=max_seconds,
            max_memory=max_memory,
        )
        write_report(done.rec, output, title or source.name, command_line())
        _tell(done.rec, output, done.complaints, messages, quiet=quiet)


def _tell(
    rec: rm.Reconstruction,
    output: Path,
    complaints: list[str],
    messages: Console,
    *,
    quiet: bool,
) -> None:
    if quiet:
        return
    for text in complaints:
        say(messages, f"warning: {text}", "yellow")
    typer.echo(rec.quality.verdict)
    typer.echo(f"{output}, {output.stat().st_size / 1e6:.1f} MB")
