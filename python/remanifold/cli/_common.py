# SPDX-License-Identifier: GPL-3.0-or-later
"""What the commands share: options, messages, failures, tables."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from typing import Any

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text


def messages_console() -> Console:
    """Console of standard error, for messages and progress."""
    return Console(stderr=True, soft_wrap=True, highlight=False)


def print_table(table: Table) -> None:
    """Print a table to standard output."""
    Console(highlight=False).print(table)


def choice(words: tuple[str, ...], text: str, show_default: str | bool = True) -> Any:
    """Make an option that takes one of a few words."""

    def check(word: str | None) -> str | None:
        if word is not None and word not in words:
            msg = f"{word!r} is not one of {', '.join(map(repr, words))}."
            raise typer.BadParameter(msg)
        return word

    return typer.Option(
        metavar=f"[{'|'.join(words)}]",
        help=text,
        callback=check,
        show_default=show_default,
    )


@contextlib.contextmanager
def failures(messages: Console) -> Iterator[None]:
    """Say in one line what failed, and exit."""
    try:
        yield
    except KeyboardInterrupt:
        say(messages, "interrupted", "red")
        raise typer.Exit(130) from None
    except typer.BadParameter:
        raise
    except Exception as error:  # noqa: BLE001  one line for the user, whatever it is
        say(messages, f"error: {describe(error)}", "red")
        raise typer.Exit(1) from None


def describe(error: Exception) -> str:
    """Say in one line what an exception means."""
    if isinstance(error, OSError) and error.strerror:
        where = f"{error.filename}: " if error.filename else ""
        return f"{where}{error.strerror}"
    if isinstance(error, ValueError | TypeError | OSError) and str(error):
        return str(error)
    if isinstance(error, MemoryError):
        return f"out of memory: {error}" if str(error) else "out of memory"
    return f"{type(error).__name__}: {error}"


def say(console: Console, text: str, style: str) -> None:
    """Print one message, on one line."""
    console.print(Text(f"remanifold: {' '.join(text.splitlines())}", style=style))


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """Do the work; its result and the seconds it took."""
    start = time.perf_counter()
    result = work()
    return result, time.perf_counter() - start


def rows_table(rows: dict[str, str]) -> Table:
    """Make a table of names and values."""
    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in rows.items():
        table.add_row(name, Text(value))
    return table


def simplex_names(dim: int) -> list[str]:
    """Name the simplices of dimension 0 to ``dim``."""
    names = ["vertices", "edges", "triangles", "tetrahedra"]
    return (names + [f"{k}-simplices" for k in range(4, dim + 1)])[: dim + 1]
