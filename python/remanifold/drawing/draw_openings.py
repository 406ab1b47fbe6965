# SPDX-License-Identifier: GPL-3.0-or-later
"""A diagram of what was opened or closed, by Matplotlib."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from remanifold._base.optional import load

if TYPE_CHECKING:
    from collections.abc import Sequence

    from remanifold._base.files import StrPath
    from remanifold.method.openings import Opening

MARKERS = {"gap": "o", "hole": "o", "joint": "^", "part": "s"}
COLORS = {"open": "#c0392b", "closed": "#2c6fad", "left out": "#7f8c8d"}
LEAST = 1e-16  # significances below this are drawn there


def plot_openings(
    openings: Sequence[Opening],
    significance: float,
    screenshot: StrPath | None = None,
) -> Any:
    """Draw the size of each place over the evidence that it is an opening.

    As in a persistence diagram what matters is how far a point is from the line: what
    lies near it was a close decision. Parts have no evidence and are drawn at its end.

    Parameters
    ----------
    openings : sequence of Opening
        As `Reconstruction.openings`.
    significance : float
        Where the line is, as `Reconstruction.significance`.
    screenshot : path-like, optional
        File to write: an image as Matplotlib knows them.

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = load("matplotlib.figure", "plot").Figure(figsize=(6.4, 4.8), dpi=100)
    axes = figure.add_subplot()
    named = set()
    for opening in openings:
        evidence = -math.log10(max(opening.significance, LEAST))
        if opening.kind == "part":
            evidence = -math.log10(LEAST)
        size = max(opening.radius / opening.spacing, 0) if opening.spacing > 0 else 0
        name = f"{opening.kind}, {opening.decision}"
        axes.scatter(
            evidence,
            size,
            marker=MARKERS[opening.kind],
            color=COLORS[opening.decision],
            label=None if name in named else name,
            zorder=3,
        )
        named.add(name)
    if significance > 0:
        axes.axvline(-math.log10(significance), color="black", linewidth=0.8)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("evidence: -log10 of the chance in data without openings")
    axes.set_ylabel("radius in spacings")
    axes.set_title("closed left of the line, open right of it", fontsize=10)
    if named:
        axes.legend(frameon=False)
    figure.tight_layout()
    if screenshot is not None:
        figure.savefig(screenshot)
    return figure
