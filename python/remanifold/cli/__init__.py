# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: ``remanifold reconstruct INPUT --dim K -o OUT``.

``remanifold dimension INPUT`` finds K, ``remanifold info FILE`` tells what a file holds,
``remanifold convert INPUT OUTPUT`` writes it in another format, ``remanifold project
MESH POINTS`` finds the nearest points of a mesh, ``remanifold report`` writes a page and
``remanifold view`` draws. The result goes to a file, the report to standard output, everything else to standard error; where the result
takes standard output the report goes to standard error too. Exit codes: 0 done, 1 the run
or a file failed, 2 wrong usage, 130 interrupted.

Each command is a function in a module of its own, which is loaded where it is run.
"""

from __future__ import annotations

import importlib
import os
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

import remanifold as rm
from remanifold.cli._examples import examples

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["app", "main"]


# Each in a module and by a function of this name, with the first line of its help.
COMMANDS = {
    "reconstruct": "Reconstruct a manifold and write it.",
    "dimension": "Estimate the dimension of the manifold.",
    "info": "Tell what a file of points or a mesh holds.",
    "convert": "Write points or a mesh in another format.",
    "report": "Reconstruct a manifold, or take a saved result, and make a page of it.",
    "project": "Find the nearest points of a mesh.",
    "view": "Draw a mesh, in a window or to a file.",
}


class _Commands(TyperGroup):
    """Loads a command where it is run, and its first line alone for the list of all.

    Says which words of a command line have other names now.
    """

    _listing = False

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        for name, line in COMMANDS.items():
            self.commands[name] = TyperCommand(name, help=line)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        known = super().get_command(ctx, cmd_name)
        return known if known is None or self._listing else _command(cmd_name)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        self._listing = True
        try:
            super().format_commands(ctx, formatter)
        finally:
            self._listing = False

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        if any(word.partition("=")[0] == "--threads" for word in args):
            from remanifold.cli._common import renamed

            renamed("--threads", "--num-threads")
        parsed: list[str] = super().parse_args(ctx, args)
        return parsed


def _command(name: str) -> Any:
    module = importlib.import_module(f"remanifold.cli.{name}")
    function: Callable[..., None] = getattr(module, name)
    alone = typer.Typer(
        add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None
    )
    alone.command(name, epilog=module.EPILOG)(function)
    return typer.main.get_command(alone)


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
        from remanifold.cli._common import describe, messages_console, say

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
