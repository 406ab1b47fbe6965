# SPDX-License-Identifier: GPL-3.0-or-later
"""From a file of samples to a reconstruction, for whatever is then made of it."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import typer
from rich.console import Console

import remanifold as rm
from remanifold._base.validation import (
    check_num_neighbors,
    check_positive,
    check_smooth,
)
from remanifold.cli._common import say, timed
from remanifold.cli._options import Options
from remanifold.io import read_points
from remanifold.method.dimension import LOW_CONFIDENCE, low_confidence


class Done(NamedTuple):
    """A reconstruction and what was said and measured on the way."""

    rec: rm.Reconstruction
    found: rm.DimensionEstimate | None
    complaints: list[str]
    warned: bool  # of what the result lacks
    seconds: dict[str, float]


def reconstruct_file(
    source: Path,
    dim: int | str,
    options: Options,
    check_target: Callable[[int, int | None], object],
    messages: Console,
    *,
    quiet: bool,
    format: str | None,
) -> Done:
    """Read, find the dimension if asked to, and reconstruct.

    What cannot work is refused before the work; `check_target` says so of the output,
    given the dimension of the simplices and, when known, of the space.
    """
    _check_method(options)
    # Every mesh format holds triangles.
    assumed = 2 if isinstance(dim, str) else dim
    _check_num_neighbors(options, assumed)
    check_target(assumed, None)
    seconds: dict[str, float] = {}
    points, seconds["read"] = timed(lambda: read_points(source, format=format))
    show_progress = messages.is_terminal and not quiet
    found: rm.DimensionEstimate | None = None
    if isinstance(dim, str):
        found, seconds["dimension"] = timed(
            lambda: rm.estimate_dimension(
                points, num_threads=options.threads, progress=show_progress
            )
        )
        assert found is not None
        dim = found.dim
        if found.confidence >= LOW_CONFIDENCE and not quiet:
            say(messages, found.verdict, "none")
    _check_smooth(options, dim)
    _check_num_neighbors(options, dim)
    check_target(dim, points.shape[1])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", rm.RemanifoldWarning)
        rec = rm.reconstruct(points, dim, **options.arguments(), progress=show_progress)
    complaints = [str(warning.message) for warning in caught]
    if found is not None and found.confidence < LOW_CONFIDENCE:
        complaints.insert(0, low_confidence(found))
    warned = any(issubclass(w.category, rm.ManifoldWarning) for w in caught)
    return Done(rec, found, complaints, warned, seconds)


def _check_method(options: Options) -> None:
    """Refuse what the method does not have."""
    if options.method == "manifold" and options.edges is not None:
        msg = "is for --method paper only."
        raise typer.BadParameter(msg, param_hint="'--edges'")
    if options.method == "paper" and options.boundary != "auto":
        msg = "is for --method manifold only."
        raise typer.BadParameter(msg, param_hint="'--boundary'")
    if options.method == "paper" and options.hole_radius is not None:
        msg = "is for --method manifold only."
        raise typer.BadParameter(msg, param_hint="'--hole-radius'")
    try:
        if options.hole_radius is not None:
            check_positive(options.hole_radius, "hole_radius")
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--hole-radius'") from None


def _check_smooth(options: Options, dim: int) -> None:
    try:
        if isinstance(options.smooth, int):
            check_smooth(options.smooth, dim)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--smooth'") from None


def _check_num_neighbors(options: Options, dim: int) -> None:
    try:
        check_num_neighbors(options.num_neighbors, dim)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--num-neighbors'") from None
