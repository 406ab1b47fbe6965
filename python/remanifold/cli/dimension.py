# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold dimension``: estimate the dimension of a manifold."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.table import Table

import remanifold as rm
from remanifold.cli._common import (
    ColumnsOption,
    DropInvalidOption,
    FormatOption,
    JsonOption,
    ThreadsOption,
    check_invalid,
    failures,
    messages_console,
    print_report,
    read_input,
    rows_table,
    say,
    split_formats,
    timed,
)
from remanifold.cli._examples import examples
from remanifold.method.dimension import LOW_CONFIDENCE, SMALLEST_SCALE, low_confidence

EPILOG = examples(
    "remanifold dimension points.npy",
    "remanifold dimension points.csv --num-neighbors 40 --json",
    "cat points.csv | remanifold dimension - --format csv",
)


def dimension(
    source: Annotated[
        Path, typer.Argument(metavar="INPUT", help="Samples, as for reconstruct.")
    ],
    num_neighbors: Annotated[
        int | None,
        typer.Option(
            min=SMALLEST_SCALE,
            show_default="found from the samples",
            help="The scale to decide at, as neighbors per sample.",
        ),
    ] = None,
    columns: ColumnsOption = None,
    drop_invalid: DropInvalidOption = False,
    format: FormatOption = None,
    threads: ThreadsOption = None,
    as_json: JsonOption = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="No progress or warnings.")
    ] = False,
) -> None:
    """Estimate the dimension of the manifold.

    It is that on which the samples lie, whatever space that lies in.
    """
    messages = messages_console()
    with failures(messages):
        format, _ = split_formats(source, None, format, None)
        (_, mesh, guesses), seconds_read = timed(
            lambda: read_input(
                source, format, columns, messages, fields=False, quiet=quiet
            )
        )
        points = mesh.points
        finite = np.isfinite(points).all(axis=1)
        if not finite.all():
            check_invalid(source, finite, drop_invalid)
            points = points[finite]
        found, seconds_found = timed(
            lambda: rm.estimate_dimension(
                points,
                num_neighbors=num_neighbors,
                num_threads=threads,
                progress=messages.is_terminal and not quiet,
            )
        )
    if found.confidence < LOW_CONFIDENCE and not quiet:
        say(messages, f"warning: {low_confidence(found)}", "yellow")
    report = {
        "input": str(source),
        "num_samples": len(points),
        "ambient_dim": points.shape[1],
        "dim": found.dim,
        **dim_report(found),
        "warnings": guesses,
        "seconds": {"read": seconds_read, "dimension": seconds_found},
    }
    print_report(report, _dim_table, as_json=as_json)


def dim_report(found: rm.DimensionEstimate) -> dict[str, Any]:
    """Give what the estimate found, as JSON can hold it."""
    values, counts = np.unique(found.per_sample, return_counts=True)
    return {
        "confidence": found.confidence,
        "estimates": found.estimates,
        "num_neighbors": found.num_neighbors,
        "samples_by_dim": {
            str(k): n for k, n in zip(values.tolist(), counts.tolist(), strict=True)
        },
        "scales": found.scales.tolist(),
        "dims": found.dims.tolist(),
        "verdict": found.verdict,
    }


def _dim_table(report: dict[str, Any]) -> Table:
    runs = []
    for dim, group in itertools.groupby(
        zip(report["dims"], report["scales"], strict=True), key=lambda pair: pair[0]
    ):
        scales = [f"{scale:,}" for _, scale in group]
        ends = scales[0] if len(scales) == 1 else f"{scales[0]} to {scales[-1]}"
        runs.append(f"{dim or 'unclear'} at {ends}")
    rows = {
        "samples": f"{report['num_samples']:,} in R^{report['ambient_dim']}",
        "dimension": str(report["dim"]),
        "confidence": f"{report['confidence']:.2f}",
        "by samples": ", ".join(
            f"{dim} at {count:,}" for dim, count in report["samples_by_dim"].items()
        ),
        "by neighbors": ", ".join(runs),
        "local PCA": f"{report['estimates']['local_pca']:.2f}",
        "maximum likelihood": f"{report['estimates']['maximum_likelihood']:.2f}",
        "TwoNN": f"{report['estimates']['two_nn']:.2f}",
        "decided at": f"{report['num_neighbors']:,} neighbors",
        "seconds": "\n".join(
            f"{s:.2f} {name}" for name, s in report["seconds"].items()
        ),
    }
    return rows_table(rows)
