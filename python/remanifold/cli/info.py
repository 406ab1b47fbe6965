# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold info``: what a file of points or of a mesh holds."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from numpy.typing import NDArray
from rich.table import Table

import remanifold as rm
from remanifold.cli._common import (
    FormatOption,
    JsonOption,
    ThreadsOption,
    examples,
    failures,
    messages_console,
    print_report,
    rows_table,
    say,
    split_formats,
)
from remanifold.complex.topology import simplex_names
from remanifold.formats._mesh import FileMesh, choose_simplices, without_degenerate
from remanifold.formats._source import Source
from remanifold.formats.reading import read_file

EPILOG = examples(
    "remanifold info scan.laz",
    "remanifold info mesh.ply --json",
    "cat points.csv | remanifold info - --format csv",
)


def info(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="Points or a mesh, in any format that can be read."
        ),
    ],
    dim: Annotated[
        int | None,
        typer.Option(
            "--dim",
            "-k",
            min=1,
            show_default="the highest in the file",
            help="Dimension of the simplices whose topology is told.",
        ),
    ] = None,
    format: FormatOption = None,
    threads: ThreadsOption = None,
    as_json: JsonOption = False,
) -> None:
    """Tell what a file of points or a mesh holds.

    Counts, extent, spacing, fields and, of a mesh, its topology.
    """
    messages = messages_console()
    with failures(messages):
        format, _ = split_formats(source, None, format, None)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", rm.RemanifoldWarning)
            file, mesh = read_file(source, format, cells=True)
            report = {
                "input": str(source),
                "format": file.suffix[1:],
                **_points(mesh.points, threads),
                "fields": {n: _field(array) for n, array in mesh.fields.items()},
                **_complex(file, mesh, dim),
            }
        report["warnings"] = [str(warning.message) for warning in caught]
        for text in report["warnings"]:
            say(messages, f"warning: {text}", "yellow")
    print_report(report, lambda told: _table(told, str(file)), as_json=as_json)


def _points(points: NDArray[np.float64], threads: int | None) -> dict[str, Any]:
    finite = np.isfinite(points).all(axis=1)
    known = points[finite]
    report: dict[str, Any] = {
        "num_points": len(points),
        "ambient_dim": points.shape[1],
        "not_finite": int((~finite).sum()),
        "bounding_box": None,
        "diagonal": None,
        "coincident_points": 0,
        "spacing": None,
    }
    if len(known):
        low, high = known.min(axis=0), known.max(axis=0)
        report["bounding_box"] = [low.tolist(), high.tolist()]
        report["diagonal"] = float(np.linalg.norm(high - low))
        distinct = np.unique(known, axis=0)
        report["coincident_points"] = len(known) - len(distinct)
        if len(distinct) > 1:
            near = rm.neighborhoods(distinct, 1, num_threads=threads).distances[:, 0]
            report["spacing"] = {
                "least": float(near.min()),
                "median": float(np.median(near)),
                "largest": float(near.max()),
            }
    return report


def _field(array: NDArray[Any]) -> dict[str, Any]:
    finite = array[np.isfinite(array)]
    return {
        "dtype": str(array.dtype),
        "components": 1 if array.ndim == 1 else array.shape[1],
        "least": finite.min().item() if finite.size else None,
        "largest": finite.max().item() if finite.size else None,
    }


def _complex(file: Source, mesh: FileMesh, dim: int | None) -> dict[str, Any]:
    held = {size - 1: len(cells) for size, cells in mesh.cells.items() if len(cells)}
    report: dict[str, Any] = {
        "simplices": {str(k): count for k, count in sorted(held.items())},
        "topology": None,
    }
    if dim is None and not held:
        return report
    simplices = without_degenerate(file, choose_simplices(file, mesh, dim))
    if simplices.shape[1] < 2:
        return report
    topology = rm.compute_topology(simplices, len(mesh.points))
    report["unused_vertices"] = len(mesh.points) - len(np.unique(simplices))
    report["topology"] = {
        "dim": topology.dim,
        "num_simplices": list(topology.num_simplices),
        "euler_characteristic": topology.euler_characteristic,
        "components": topology.components,
        "betti_numbers": (
            list(topology.betti_numbers) if topology.homology_is_cheap else None
        ),
        "manifold": topology.manifold,
        "closed": topology.closed,
        "orientable": topology.orientable,
        "singular_vertices": len(topology.singular_vertices),
    }
    return report


def _table(report: dict[str, Any], name: str) -> Table:
    rows = {
        "file": f"{name}, {report['format']}",
        "points": f"{report['num_points']:,} in R^{report['ambient_dim']}",
    }
    if report["not_finite"]:
        rows["not finite"] = f"{report['not_finite']:,}"
    if report["bounding_box"] is not None:
        low, high = report["bounding_box"]
        rows["from"] = _numbers(low)
        rows["to"] = _numbers(high)
        rows["diagonal"] = f"{report['diagonal']:.6g}"
    if report["coincident_points"]:
        rows["coincident points"] = f"{report['coincident_points']:,}"
    if report["spacing"] is not None:
        spacing = report["spacing"]
        rows["nearest neighbor"] = (
            f"{spacing['median']:.4g} away in the median, {spacing['least']:.4g} to "
            f"{spacing['largest']:.4g}"
        )
    if report["fields"]:
        rows["fields"] = "\n".join(
            f"{name}, {_field_text(field)}" for name, field in report["fields"].items()
        )
    if report["simplices"]:
        most = max(map(int, report["simplices"]))
        names = simplex_names(most)
        rows["simplices"] = ", ".join(
            f"{count:,} {names[int(k)]}" for k, count in report["simplices"].items()
        )
    if report["topology"] is not None:
        rows["unused vertices"] = f"{report['unused_vertices']:,}"
        rows |= _topology_rows(report["topology"])
    return rows_table(rows)


def _topology_rows(topology: dict[str, Any]) -> dict[str, str]:
    names = simplex_names(topology["dim"])
    yes_no = {True: "yes", False: "no"}
    counts = zip(topology["num_simplices"], names, strict=True)
    betti = topology["betti_numbers"]
    return {
        "complex": ", ".join(f"{count:,} {name}" for count, name in counts),
        "Euler characteristic": f"{topology['euler_characteristic']:,}",
        "components": f"{topology['components']:,}",
        "Betti numbers": (
            "not computed" if betti is None else ", ".join(f"{b:,}" for b in betti)
        ),
        "manifold": yes_no[topology["manifold"]],
        "closed": yes_no[topology["closed"]],
        "orientable": yes_no[topology["orientable"]],
        "singular vertices": f"{topology['singular_vertices']:,}",
    }


def _numbers(values: list[float]) -> str:
    shown = [f"{value:.6g}" for value in values[:6]]
    return ", ".join([*shown, *(["..."] if len(values) > 6 else [])])


def _field_text(field: dict[str, Any]) -> str:
    kind = str(field["dtype"])
    if field["components"] > 1:
        kind = f"{field['components']} x {kind}"
    if field["least"] is None:
        return kind
    return f"{kind}, {field['least']:.4g} to {field['largest']:.4g}"
