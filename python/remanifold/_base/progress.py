# SPDX-License-Identifier: GPL-3.0-or-later
"""What progress= accepts: nothing, True for a bar, or a function."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import TypeAlias

Callback: TypeAlias = Callable[[str, int, int], object]


@contextlib.contextmanager
def progress_callback(progress: object) -> Iterator[Callback | None]:
    """Turn the argument into what the core calls."""
    if callable(progress):
        yield progress
    elif progress is None or isinstance(progress, bool):
        if progress:
            with bar() as callback:
                yield callback
        else:
            yield None
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
        TaskID,
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
        tasks: dict[str, TaskID] = {}

        def show(step: str, done: int, total: int) -> None:
            if step not in tasks:
                for task in display.tasks:  # the core may be ahead of the last look
                    display.update(task.id, completed=task.total)
                tasks[step] = display.add_task(step.replace("_", " "), total=total)
            display.update(tasks[step], completed=done, total=total)

        yield show
