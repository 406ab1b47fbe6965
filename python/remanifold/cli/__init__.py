# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: ``remanifold reconstruct INPUT --dim K -o OUT``.

``remanifold dimension INPUT`` finds K, ``remanifold info FILE`` tells what a file holds,
``remanifold convert INPUT OUTPUT`` writes it in another format, ``remanifold project
MESH POINTS`` finds the nearest points of a mesh, ``remanifold report`` writes a page and
``remanifold view`` draws. The result goes to a file, the report to standard output, everything else to standard error; where the result
takes standard output the report goes to standard error too. Exit codes: 0 done, 1 the run
or a file failed, 2 wrong usage, 130 interrupted.

Each command is a function in a module of its own; here they are given their names.
"""

from __future__ import annotations

import os
import sys
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

import remanifold as rm
from remanifold.cli import (
    convert,
    dimension,
    info,
    project,
    reconstruct,
    report,
    view,
)
from remanifold.cli._common import (
    describe,
    examples,
    messages_console,
    renamed,
    say,
)

__all__ = ["app", "main"]


class _Commands(TyperGroup):
    """Says which words of a command line have other names now."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        if any(word.partition("=")[0] == "--threads" for word in args):
            renamed("--threads", "--num-threads")
        parsed: list[str] = super().parse_args(ctx, args)
        return parsed


app = typer.Typer(
    name="remanifold",
    cls=_Commands,
    help="Reconstruct manifolds from their samples.",
    epilog=examples(
        "remanifold info scan.ply",
        "remanifold dimension scan.ply",
        "remanifold reconstruct scan.ply --dim 2 -o mesh.ply",
        "remanifold report scan.ply --dim 2 -o report.html",
        "remanifold view mesh.ply",
        "remanifold project mesh.ply points.csv -o nearest.npz",
        "remanifold convert mesh.ply mesh.vtu",
    )
    + "\n\nEach command has its own --help.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Run the command line."""
    try:
        try:
            app(prog_name="remanifold")
        finally:
            if sys.stdout is not None:  # as it is where it was closed
                sys.stdout.flush()
    except OSError as error:  # of standard output: commands name their files themselves
        # What is still held for it must not be tried again at exit.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        say(messages_console(), f"error: standard output: {describe(error)}", "red")
        sys.exit(1)


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


for module, command in (
    (reconstruct, reconstruct.reconstruct),
    (dimension, dimension.dimension),
    (info, info.info),
    (convert, convert.convert),
    (report, report.report),
    (project, project.project),
    (view, view.view),
):
    app.command(epilog=module.EPILOG)(command)
