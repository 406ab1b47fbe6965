# SPDX-License-Identifier: GPL-3.0-or-later
"""What the commands share: options, messages, failures, tables."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shlex
import sys
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np
import typer
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from rich.text import Text

from remanifold._base.validation import check_num_threads
from remanifold.formats._columns import check_columns
from remanifold.formats._mesh import FileMesh
from remanifold.formats._source import Source, is_standard
from remanifold.formats.reading import READERS, read_file
from remanifold.formats.saved import is_saved
from remanifold.formats.writing import WRITERS

T = TypeVar("T")

# What messages of the package say, and how it is written on the command line.
_FLAGS = (
    (r"\b(outliers|smooth)=False\b", r"--\1 no"),
    (r"\bresume=True\b", "--resume"),
    (r"\bmax_(seconds|memory)\b", r"--max-\1"),
    (r"\b(gram|distances)=(?!=)", r"--matrix \1"),
    (r"\bcolumns='([^']*)'", r"--columns \1"),
    (r"say format '(\w+)'", r"say --format \1"),
    (r"^work holds", "--work holds"),
    (r"\bboundary= ", "--boundary "),
    (r"; see repair\.remaining\(\)$", "; remanifold report shows where"),
    (r"read_points reads the points$", "remanifold reconstruct makes a mesh of these"),
    (r"call remanifold\.reconstruct\b", "leave out --distributed"),
    (r"\bremanifold\.distributed\.reconstruct\b", "reconstruct --distributed"),
)


def messages_console() -> Console:
    """Console of standard error, for messages and progress."""
    return Console(stderr=True, soft_wrap=True, highlight=False)


def choice(
    words: tuple[str, ...],
    text: str,
    show_default: str | bool = True,
    metavar: str | None = None,
) -> Any:
    """Make an option that takes one of a few words."""

    def check(word: str | None) -> str | None:
        if word is not None and word not in words:
            msg = f"{word!r} is not one of {', '.join(map(repr, words))}."
            raise typer.BadParameter(msg)
        return word

    def complete(incomplete: str) -> list[str]:
        return [word for word in words if word.startswith(incomplete)]

    return typer.Option(
        metavar=metavar or f"[{'|'.join(words)}]",
        help=text,
        callback=check,
        show_default=show_default,
        autocompletion=complete,
    )


def listed(suffixes: Iterable[str]) -> str:
    """Formats for the help of a command: ".ply, .obj or .off"."""
    *first, end = suffixes
    return f"{', '.join(first)} or {end}"


def complaining(check: Callable[[], T]) -> T:
    """Say of a refused parameter which option of the command line it is."""
    try:
        return check()
    except (TypeError, ValueError) as error:
        name, _, what = str(error).partition(" ")
        hint = f"'--{name.replace('_', '-')}'"
        text = str(error)
        if what.startswith("is for"):
            # As one writes it here: --method paper, not method="paper".
            text = re.sub(r'(\w+)="(\w+)"', r"--\1 \2", what) + "."
        raise typer.BadParameter(text, param_hint=hint) from None


def _columns(text: str) -> str:
    complaining(lambda: check_columns(text))
    return text


def _threads(text: str) -> int:
    try:
        count = int(text)
    except ValueError:
        msg = f"{text!r} is no whole number."
        raise typer.BadParameter(msg) from None
    complaining(lambda: check_num_threads(count))
    return count


def renamed(old: str, new: str) -> None:
    """Say that a word of the command line has another name now."""
    text = (
        f"remanifold: note: {old} is called {new} now; the old name goes with the next"
    )
    typer.echo(f"{text} version", err=True)


FORMATS = tuple(suffix[1:] for suffix in {**READERS, **WRITERS})
FormatOption = Annotated[
    str | None,
    choice(
        FORMATS,
        "Format of the input whatever its name, or of the output where that alone is -: "
        "csv, ply, ...",
        "by the suffix",
        "FORMAT",
    ),
]
OutputFormatOption = Annotated[
    str | None,
    choice(
        FORMATS, "Format of the output whatever its name.", "by the suffix", "FORMAT"
    ),
]
ColumnsOption = Annotated[
    str | None,
    typer.Option(
        metavar="NAMES|NUMBERS",
        show_default="by their names, else guessed, which is said",
        help="Columns of the input that are coordinates: x,y,z or, from 0, 0,1,2. "
        "The others are fields.",
        parser=_columns,
    ),
]
DropInvalidOption = Annotated[
    bool,
    typer.Option(
        "--drop-invalid",
        help="Leave out samples whose coordinates are not finite; the others keep "
        "their numbers.",
    ),
]
ThreadsOption = Annotated[
    int | None,
    typer.Option(
        "--num-threads",
        "--threads",
        parser=_threads,
        metavar="INTEGER",
        show_default="all cores",
        help="Threads; -1 for all cores, -2 for all but one. The result is the same.",
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Report as a JSON object.")]


def split_formats(
    source: Path, output: Path | None, format: str | None, output_format: str | None
) -> tuple[str | None, str | None]:
    """Formats of the input and of the output; refuse streams without one."""
    streams = is_standard(source), output is not None and is_standard(output)
    if streams == (False, True) and output_format is None:
        format, output_format = None, format
    if streams[0] and format is None:
        msg = "standard input needs a format, as in --format csv."
        raise typer.BadParameter(msg, param_hint="'--format'")
    if streams[1] and output_format is None:
        name = "--output-format" if streams[0] else "--format"
        msg = f"standard output needs a format, as in {name} ply."
        raise typer.BadParameter(msg, param_hint=f"'{name}'")
    return format, output_format


def refuse_same_file(source: Path, output: Path, name: str = "--output") -> None:
    """Refuse to write over the input."""
    if is_standard(source) or is_standard(output):
        return
    if source.exists() and output.exists() and source.samefile(output):
        msg = f"{output}: is the input, which would be lost"
        raise typer.BadParameter(msg, param_hint=f"'{name}'")


def read_input(
    path: Path,
    format: str | None,
    columns: str | None,
    messages: Console,
    *,
    fields: bool = True,
    cells: bool = False,
    quiet: bool = False,
) -> tuple[Source, FileMesh, list[str]]:
    """Read a file and say what was guessed about it; that again, for the report."""
    source, mesh = read_file(
        path, format, fields=fields, cells=cells, columns=columns, warn=False
    )
    guesses = [
        f"{source}: {what.replace('COLUMNS', '--columns')}" for what in source.guesses
    ]
    if not quiet:
        for text in guesses:
            say(messages, f"warning: {text}", "yellow")
        for text in source.notes:
            say(messages, f"note: {source}: {text}", "none")
    return source, mesh, guesses


def check_invalid(source: Path, finite: NDArray[np.bool_], drop: bool) -> None:
    """Say which samples are no points, and refuse to go on unless they may be dropped."""
    count, first = int((~finite).sum()), int(finite.argmin())
    if not finite.any():
        msg = f"{source}: none of {count:,} points has finite coordinates"
        raise ValueError(msg)
    if not drop:
        msg = (
            f"{source}: {count:,} of {len(finite):,} points are not finite, the first is "
            f"point {first}; --drop-invalid leaves them out"
        )
        raise ValueError(msg)


def is_saved_result(path: Path) -> bool:
    """Whether a file is a result that was saved whole."""
    if is_standard(path) or not path.is_file():
        return False
    with path.open("rb") as file:
        return is_saved(file)


def command_line() -> str:
    """The command that is running, as one would type it."""
    name = os.path.basename(sys.argv[0])  # noqa: PTH119  not a path but its last part
    program = ["python", "-m", "remanifold"] if name == "__main__.py" else [name]
    return shlex.join([*program, *sys.argv[1:]])


def print_report(
    report: dict[str, Any],
    table: Callable[[dict[str, Any]], Table],
    *,
    as_json: bool,
    stderr: bool = False,
) -> None:
    """Print a report, to standard error where a mesh takes standard output."""
    if as_json:
        typer.echo(json.dumps(report, indent=2), err=stderr)
    else:
        Console(highlight=False, stderr=stderr).print(table(report))


@contextlib.contextmanager
def failures(messages: Console) -> Iterator[None]:
    """Say in one line what failed, and exit; of warnings that nobody else takes too."""
    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda message, *_args, **_options: say(
                messages, f"warning: {message}", "yellow"
            )
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
    if isinstance(error, ValueError | TypeError | OSError | ImportError) and str(error):
        return as_flags(str(error))
    if isinstance(error, MemoryError):
        text = as_flags(str(error))
        if text.startswith("--max-memory"):
            return text
        return f"out of memory: {text}" if text else "out of memory"
    return f"{type(error).__name__}: {error}"


def as_flags(text: str) -> str:
    """Parameters that a message names, as one writes them here."""
    for pattern, flag in _FLAGS:
        text = re.sub(pattern, flag, text)
    return text


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
