# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command lines of the benchmarks have in common."""

from __future__ import annotations

import typer


def make_app() -> typer.Typer:
    """Make a command that answers -h and shows tracebacks as Python does."""
    return typer.Typer(
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
