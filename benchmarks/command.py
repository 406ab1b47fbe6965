# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command lines of the benchmarks have in common."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

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
