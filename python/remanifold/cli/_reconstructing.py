# SPDX-License-Identifier: GPL-3.0-or-later
"""From a file of samples to a reconstruction, for whatever is then made of it."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import typer
from numpy.typing import NDArray
from rich.console import Console

import remanifold as rm
from remanifold._base.digest import digest_of_file
from remanifold.cli._common import (
    as_flags,
    check_invalid,
    command_line,
    complaining,
    read_input,
    say,
    timed,
)
from remanifold.formats._columns import table_of
from remanifold.formats._mesh import FileMesh
from remanifold.formats._source import is_standard
from remanifold.method.dimension import LOW_CONFIDENCE, low_confidence
from remanifold.method.options import Options


class Done(NamedTuple):
    """A reconstruction and what was said and measured on the way."""

    rec: rm.Reconstruction
    found: rm.DimensionEstimate | None
    complaints: list[str]
    guesses: list[str]  # about the file, which were said when it was read
    warned: bool  # of what the result lacks
    seconds: dict[str, float]


def _square(source: Path, mesh: FileMesh) -> NDArray[np.float64]:
    """All columns of a file, beside those that count or name its rows."""
    columns = [c for c in table_of(mesh).columns if c.dtype.kind in "biuf"]
    count = len(mesh.points)
    matrix = np.column_stack(columns).astype(np.float64)
    if matrix.shape[1] == count + 1:
        matrix = matrix[:, 1:]
    if matrix.shape != (count, count):
        msg = (
            f"{source}: {count:,} rows of {matrix.shape[1]:,} numbers, and --matrix "
            "expects as many numbers in each row as there are rows"
        )
        raise ValueError(msg)
    return matrix


def reconstruct_file(
    source: Path,
    dim: int | str,
    options: Options,
    check_target: Callable[[int, int | None], object],
    messages: Console,
    *,
    threads: int | None,
    quiet: bool,
    format: str | None,
    columns: str | None,
    drop_invalid: bool,
    matrix: str | None = None,
    max_seconds: float | None = None,
    max_memory: float | None = None,
) -> Done:
    """Read, find the dimension if asked to, and reconstruct.

    What cannot work is refused before the work; `check_target` says so of the output,
    given the dimension of the simplices and, when known, of the space.
    """
    # Every mesh format holds triangles.
    assumed = 2 if isinstance(dim, str) else dim
    complaining(lambda: options.check_dim(assumed))
    check_target(assumed, None)
    seconds: dict[str, float] = {}
    if matrix is not None and (columns is not None or drop_invalid):
        msg = "--columns and --drop-invalid are for points, and the input is a matrix."
        raise typer.BadParameter(msg, param_hint="'--matrix'")
    (_, mesh, guesses), seconds["read"] = timed(
        lambda: read_input(
            source, format, columns, messages, quiet=quiet or matrix is not None
        )
    )
    points = mesh.points
    if matrix is not None:
        # What was guessed about columns is not so.
        points, guesses = _square(source, mesh), []
        mesh.fields, mesh.chosen = {}, ""
    known = {matrix: points} if matrix else {}
    finite = np.isfinite(points).all(axis=1)
    if matrix is None and not finite.all():
        check_invalid(source, finite, drop_invalid)
    show_progress = messages.is_terminal and not quiet
    found: rm.DimensionEstimate | None = None
    if isinstance(dim, str):
        found, seconds["dimension"] = timed(
            lambda: rm.estimate_dimension(
                None if matrix else points[finite],
                **known,
                num_threads=threads,
                progress=show_progress,
            )
        )
        assert found is not None
        dim = found.dim
        if found.confidence >= LOW_CONFIDENCE and not quiet:
            say(messages, found.verdict, "none")
    complaining(lambda: options.check_dim(dim))
    check_target(dim, points.shape[1] if matrix is None else None)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", rm.RemanifoldWarning)
        rec = rm.reconstruct(
            None if matrix else points,
            dim,
            **known,
            **vars(options),
            attributes=mesh.fields,
            invalid="drop" if drop_invalid else "raise",
            num_threads=threads,
            max_seconds=max_seconds,
            max_memory=max_memory,
            progress=show_progress,
        )
    source_of = {"name": str(source) if is_standard(source) else source.name}
    if not is_standard(source) and source.is_file():
        source_of["sha256"] = digest_of_file(source)
    if mesh.chosen:
        source_of["columns"] = mesh.chosen
    vars(rec)["provenance"] = dataclasses.replace(
        rec.provenance, source=source_of, command=command_line()
    )
    # The command line judges in any case, and what the file looked like is said.
    said = (rm.DoubtWarning, *((rm.TransposedWarning,) if guesses else ()))
    complaints = [
        as_flags(str(w.message)) for w in caught if not issubclass(w.category, said)
    ]
    if found is not None and found.confidence < LOW_CONFIDENCE:
        complaints.insert(0, low_confidence(found))
    warned = any(issubclass(w.category, rm.ManifoldWarning) for w in caught)
    return Done(rec, found, complaints, guesses, warned, seconds)
