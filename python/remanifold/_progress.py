# SPDX-License-Identifier: GPL-3.0-or-later
"""What progress= accepts: nothing, True for a bar, or a function."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import TypeAlias

Callback: TypeAlias = Callable[[str, int, int], object]


@contextlib.contextmanager
def progress_callback(progress: bool | Callback | None) -> Iterator[Callback | None]:
    """Turn the argument into what the core calls."""
    if progress is None or progress is False:
        yield None
    elif callable(progress):
        yield progress
    elif progress is True:
        with bar() as callback:
            yield callback
    else:
        msg = f"progress must be None, a bool or a function, got {progress!r}"
        raise TypeError(msg)


@contextlib.contextmanager
def bar() -> Iterator[Callback]:
    """Progress bars on standard error, one a step."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
    )

    with Progress(
        TextColumn("{task.description:<16}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
    ) as display:
        tasks: dict[str, int] = {}

        def show(step: str, done: int, total: int) -> None:
            if step not in tasks:
                for task in tasks.values():
                    display.update(task, completed=display.tasks[task].total)  # type: ignore[index]
                tasks[step] = display.add_task(step.replace("_", " "), total=total)
            display.update(tasks[step], completed=done, total=total)  # type: ignore[arg-type]

        yield show
