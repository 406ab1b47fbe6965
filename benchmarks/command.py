# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command lines of the benchmarks have in common."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

JobsOption = Annotated[
    int | None,
    typer.Option(
        min=1, help="Runs at a time, of one thread each.", show_default="all cores"
    ),
]
TimeLimitOption = Annotated[
    float, typer.Option(min=0, help="Seconds until a run is given up.")
]
JsonOption = Annotated[
    Path | None,
    typer.Option("--json", dir_okay=False, help="Write all results to this file."),
]
MarkdownOption = Annotated[
    bool, typer.Option("--markdown", help="Print the table in Markdown.")
]


def make_app() -> typer.Typer:
    """Make a command that answers -h and shows tracebacks as Python does."""
    return typer.Typer(
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
        context_settings={"help_option_names": ["-h", "--help"]},
    )


def one_of(words: Sequence[str]) -> Callable[[Any], Any]:
    """Check that a value, or each of several, is one of these words."""

    def check(value: Any) -> Any:
        for word in value if isinstance(value, list) else [value]:
            if word not in words:
                msg = f"{word!r} is not one of {', '.join(map(repr, words))}."
                raise typer.BadParameter(msg)
        return value

    return check


def write_report(json_file: Path | None, report: dict[str, Any]) -> None:
    if json_file is not None:
        text = json.dumps(report, indent=2)
        json_file.write_text(text + "\n", encoding="utf-8")


def gather(
    records: Iterable[dict[str, Any]],
    total: int,
    what: str,
    json_file: Path | None,
    about: dict[str, Any],
) -> list[dict[str, Any]]:
    """Say how far it is, and write after each: a long run may be broken off."""
    gathered: list[dict[str, Any]] = []
    messages = Console(stderr=True, soft_wrap=True, highlight=False)
    with messages.status("") as status:
        for i, record in enumerate(records, start=1):
            gathered.append(record)
            status.update(f"{i} of {total} {what}")
            write_report(json_file, {**about, "results": gathered})
    return gathered


def print_lines(lines: Sequence[list[tuple[str, str]]], *, markdown: bool) -> None:
    """Print lines of heads and cells as a table."""
    heads = [head for head, _ in lines[0]]
    print_table(
        heads, [[cell for _, cell in line] for line in lines], markdown=markdown
    )


def print_table(
    heads: Sequence[str], rows: Sequence[Sequence[str]], *, markdown: bool
) -> None:
    if markdown:
        for row in (heads, ["---"] + ["---:"] * (len(heads) - 1), *rows):
            typer.echo(f"| {' | '.join(row)} |")
        return
    table = Table(box=None, pad_edge=False)
    for i, head in enumerate(heads):
        table.add_column(head, justify="right" if i else "left")
    for row in rows:
        table.add_row(*row)
    Console(highlight=False).print(table)
