# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that several commands have, and their values together."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

from remanifold import _core
from remanifold._base.validation import check_int, check_positive
from remanifold.cli._common import choice, complaining, listed, renamed
from remanifold.formats.reading import READERS
from remanifold.method.options import (
    EDGE_RULES,
    ESTIMATORS,
    METHODS,
    SEARCHES,
    Options,
)

MATRICES = ("gram", "distances")
BOUNDARIES: dict[str, str | bool] = {"auto": "auto", "no": False}


def _dim_or_auto(text: str) -> int | str:
    if text == "auto":
        return text
    try:
        return check_int(int(text), "dim", minimum=1)
    except ValueError:
        msg = f"{text!r} is neither a positive integer nor 'auto'."
        raise typer.BadParameter(msg) from None


def _boundary(text: str) -> str:
    if text == "closed":
        renamed("--boundary closed", "--boundary no")
        text = "no"
    if text not in BOUNDARIES:
        msg = f"{text!r} is not one of {', '.join(map(repr, BOUNDARIES))}."
        raise typer.BadParameter(msg)
    return text


def _complete_boundary(incomplete: str) -> list[str]:
    return [word for word in BOUNDARIES if word.startswith(incomplete)]


def _outliers(text: str) -> Any:
    if text == "keep":
        renamed("--outliers keep", "--outliers no")
        text = "no"
    if text in ("auto", "no"):
        return {"auto": "auto", "no": False}[text]
    try:
        return check_positive(float(text), "outliers")
    except ValueError:
        msg = f"{text!r} is neither auto, no nor a positive number."
        raise typer.BadParameter(msg) from None


def _smooth(text: str) -> Any:
    if text in ("no", "auto", "yes"):
        return text
    try:
        return int(text)
    except ValueError:
        msg = f"{text!r} is neither no, auto, yes nor a number of neighbors."
        raise typer.BadParameter(msg) from None


Source: TypeAlias = Annotated[
    Path,
    typer.Argument(
        metavar="INPUT",
        help=f"Samples: {listed(READERS)}; - is standard input.",
    ),
]
Dim: TypeAlias = Annotated[
    Any,
    typer.Option(
        "--dim",
        "-k",
        parser=_dim_or_auto,
        metavar="[INTEGER|auto]",
        help="Dimension K of the manifold, or auto: estimated from the samples.",
    ),
]
Method: TypeAlias = Annotated[
    str, choice(METHODS, "Closed up to a manifold, or the paper's complex.")
]
Boundary: TypeAlias = Annotated[
    str,
    typer.Option(
        parser=_boundary,
        metavar=f"[{'|'.join(BOUNDARIES)}]",
        help="Manifold method: leave wide holes open, or close everything.",
        autocompletion=_complete_boundary,
    ),
]
HoleRadius: TypeAlias = Annotated[
    float | None,
    typer.Option(
        show_default="by how evenly the samples lie",
        help="Manifold method: radius of the smallest hole left open, in units of "
        f"{_core.SCALE_WORDS}.",
    ),
]
Significance: TypeAlias = Annotated[
    float | None,
    typer.Option(
        metavar="CHANCE",
        show_default=f"{_core.SIGNIFICANCE:g}",
        help="Manifold method: where so many samples are missing that chance leaves as "
        "large a gap in no more than this share of such data, it is left open.",
    ),
]
Outliers: TypeAlias = Annotated[
    Any,
    typer.Option(
        parser=_outliers,
        metavar="[auto|no|DISTANCE]",
        show_default="auto, or no for paper",
        help="Leave out samples at least so many local scales away from what the "
        f"others show (auto: {_core.OUTLIER_DISTANCE:g}), or keep all.",
    ),
]
Smooth: TypeAlias = Annotated[
    Any,
    typer.Option(
        parser=_smooth,
        metavar="[auto|no|yes|NEIGHBORS]",
        show_default="auto, or no for paper",
        help="Move noisy samples onto the manifold first: auto where there is "
        "noise, yes in any case, or by fits to so many neighbors.",
    ),
]
NumNeighbors: TypeAlias = Annotated[
    int | None,
    typer.Option(
        show_default=f"{_core.JET_NEIGHBORS}, or {_core.PAPER_NEIGHBORS} for paper",
        help="Neighbors per sample for the tangent spaces.",
    ),
]
Estimator: TypeAlias = Annotated[
    str | None,
    choice(
        ESTIMATORS,
        "Estimator of the tangent spaces.",
        "jet, or enclosure for paper",
    ),
]
Edges: TypeAlias = Annotated[
    str | None,
    choice(
        EDGE_RULES,
        "Paper's method: keep edges seen from both ends, or from either.",
        "mutual",
    ),
]
Search: TypeAlias = Annotated[
    str, choice(SEARCHES, "Search for the nearest neighbors.")
]
Checks: TypeAlias = Annotated[
    int, typer.Option(help="Approximate search: leaves that it visits.")
]
Matrix: TypeAlias = Annotated[
    str | None,
    choice(
        MATRICES,
        "The input holds no points but the inner products of all samples with each "
        "other, or their distances, N rows of N numbers.",
        "points",
    ),
]
MaxSeconds: TypeAlias = Annotated[
    float | None,
    typer.Option(
        show_default="no limit",
        help="Time that may be taken: then the best manifold so far, which the verdict "
        "says; what cannot be done in it is an error.",
    ),
]


def _bytes(text: str) -> float:
    found = re.fullmatch(r"([0-9.]+)\s*([kMGT]i?)?B?", text, re.IGNORECASE)
    try:
        number = float(found[1]) if found else math.nan
    except ValueError:
        number = math.nan
    if not number > 0:
        msg = f"{text!r} is no size, expected bytes or 500MB, 3GiB, ..."
        raise typer.BadParameter(msg)
    unit = (found[2] or "") if found else ""
    base = 1024 if unit.lower().endswith("i") else 1000
    return float(number * base ** " kmgt".index(unit[:1].lower() or " "))


MaxMemory: TypeAlias = Annotated[
    float | None,
    typer.Option(
        parser=_bytes,
        metavar="SIZE",
        show_default="no limit",
        help="Memory that may be taken, as 3GiB: what is expected to take more is an "
        "error before any work.",
    ),
]
Quiet: TypeAlias = Annotated[
    bool, typer.Option("--quiet", "-q", help="No progress, table or warnings.")
]


def options_of(*, boundary: str, outliers: Any, smooth: Any, **others: Any) -> Options:
    """What was given on the command line, as the library takes it."""
    return complaining(
        lambda: Options(
            boundary=BOUNDARIES[boundary],
            outliers=outliers,
            smooth={"no": False, "yes": True}.get(smooth, smooth),
            **others,
        )
    )
