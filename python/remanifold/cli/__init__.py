# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: ``remanifold reconstruct INPUT --dim K -o OUT``.

``remanifold dimension INPUT`` finds K, ``remanifold report INPUT --dim K -o PAGE`` writes a
page that shows the result, ``remanifold view MESH`` draws a mesh. The result goes to a file, the report to standard
output, everything else to standard error. Exit codes: 0 done, 1 the run or a file failed,
2 wrong usage, 130 interrupted.

Each command is a function in a module of its own; here they are given their names.
"""

from __future__ import annotations

from typing import Annotated

import typer

import remanifold as rm
from remanifold.cli import dimension, reconstruct, report, view

__all__ = ["app", "main"]

app = typer.Typer(
    name="remanifold",
    help="Reconstruct manifolds from their samples.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Run the command line."""
    app(prog_name="remanifold")


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"remanifold {rm.__version__}")
        raise typer.Exit


@app.callback()
def _root(
    _: Annotated[
        bool,
        typer.Option(
            "--version", callback=_version, is_eager=True, help="Show the version."
        ),
    ] = False,
) -> None:
    pass


app.command()(reconstruct.reconstruct)
app.command()(dimension.dimension)
app.command()(report.report)
app.command()(view.view)
