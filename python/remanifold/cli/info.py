# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold info``: what a file of points or of a mesh holds."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from numpy.typing import NDArray
from rich.table import Table

import remanifold as rm
from remanifold.cli._common import (
    ColumnsOption,
    FormatOption,
    JsonOption,
    ThreadsOption,
    failures,
    is_saved_result,
    messages_console,
    print_report,
    read_input,
    rows_table,
    say,
    split_formats,
)
from remanifold.cli._distributed import folder_report
from remanifold.cli._examples import examples
from remanifold.complex.topology import simplex_names
from remanifold.formats._mesh import (
    FileMesh,
    choose_simplices,
    first_of_equal_rows,
    without_degenerate,
)
from remanifold.formats._source import Source
from remanifold.formats.reading import is_folder
from remanifold.method.dimension import LOW_CONFIDENCE
from remanifold.method.provenance import said
from remanifold.method.survey import MOST, survey

EPILOG = examples(
    "remanifold info scan.laz",
    "remanifold info mesh.ply --json",
    "remanifold info scan.rm.npz",
    "remanifold info table.csv --columns easting,northing,height",
    "cat points.csv | remanifold info - --format csv",
)


def info(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="Points or a mesh, in any format that can be read; or a folder of the "
            "files that reconstruct --distributed takes together.",
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
    columns: ColumnsOption = None,
    brief: Annotated[
        bool,
        typer.Option(
            "--brief", help="No dimension, structure, or time that it would take."
        ),
    ] = False,
    format: FormatOption = None,
    threads: ThreadsOption = None,
    as_json: JsonOption = False,
) -> None:
    """Tell what a file of points or a mesh holds.

    Counts, extent, spacing, fields; of points how they lie, their dimension and what a
    reconstruction would take; of a mesh its topology.
    """
    messages = messages_console()
    if is_folder(source) and format is None:
        for flag, given in (("--dim", dim), ("--columns", columns)):
            if given is not None:
                msg = "is for one file, and the input is a folder."
                raise typer.BadParameter(msg, param_hint=f"'{flag}'")
        with failures(messages):
            report = folder_report(source)
        print_report(report, _folder_table, as_json=as_json)
        return
    with failures(messages):
        format, _ = split_formats(source, None, format, None)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", rm.RemanifoldWarning)
            file, mesh, guesses = read_input(
                source, format, columns, messages, cells=True
            )
            mesh_there = any(map(len, mesh.cells.values()))
            report = {
                "input": str(source),
                "format": file.suffix[1:],
                "coordinates": mesh.chosen,
                **_points(mesh.points, threads),
                "fields": {n: _field(array) for n, array in mesh.fields.items()},
                **_survey(mesh.points, threads, skip=brief or mesh_there),
                **_complex(file, mesh, dim),
                "notes": file.notes,
                "result": _result(rm.load(source)) if is_saved_result(source) else None,
            }
        complaints = [str(warning.message) for warning in caught]
        report["warnings"] = guesses + complaints
        for text in complaints:
            say(messages, f"warning: {text}", "yellow")
    print_report(report, lambda told: _table(told, str(file)), as_json=as_json)


def _result(rec: rm.Reconstruction) -> dict[str, Any]:
    """Where a saved result comes from."""
    origin = rec.provenance
    return {
        "version": origin.version,
        "versions": origin.versions,
        "created": origin.created,
        "source": origin.source,
        "command": origin.command,
        "input_digest": origin.input,
        "output_digest": rec.digest,
        "parameters": {
            name: {
                "value": said(p.value) if isinstance(p.value, np.ndarray) else p.value,
                "given": p.given,
                "why": p.why,
            }
            for name, p in rec.parameters.items()
        },
        "parameters_text": str(rec.parameters),
        "seconds": rec.timings,
    }


def _result_rows(result: dict[str, Any]) -> dict[str, str]:
    made_of = "\n".join(result["source"].values())
    return {
        "made by": f"remanifold {result['version']}, {result['created']}",
        **({"made from": made_of} if made_of else {}),
        **({"command": result["command"]} if result["command"] else {}),
        "digest of the samples": result["input_digest"],
        "digest of the result": result["output_digest"],
        "parameters": result["parameters_text"],
        "seconds": "\n".join(
            f"{seconds:.2f} {step.replace('_', ' ')}"
            for step, seconds in result["seconds"].items()
        ),
    }


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
        distinct = known[first_of_equal_rows(known)[0]]
        report["coincident_points"] = len(known) - len(distinct)
        if len(distinct) > 1:
            near = rm.neighborhoods(distinct, 1, num_threads=threads).distances[:, 0]
            report["spacing"] = {
                "least": float(near.min()),
                "median": float(np.median(near)),
                "largest": float(near.max()),
            }
    return report


def _survey(points: NDArray[Any], threads: int | None, *, skip: bool) -> dict[str, Any]:
    """How the samples lie and what a reconstruction takes, unless there is a mesh."""
    report: dict[str, Any] = {
        "spread": None,
        "dimension": None,
        "structure": None,
        "units": [],
        "expected": None,
    }
    finite = points[np.isfinite(points).all(axis=1)]
    distinct = finite[first_of_equal_rows(finite)[0]]
    if skip or len(distinct) < 2:
        return report
    found = survey(distinct, threads)
    report["spread"] = found.spread if np.isfinite(found.spread) else None
    report["structure"] = found.structure
    report["units"] = [*found.units]
    if found.estimate is None:
        return report
    estimate = found.estimate
    report["dimension"] = {
        "dim": estimate.dim,
        "confidence": estimate.confidence,
        "samples": min(len(distinct), MOST),
        "verdict": estimate.verdict,
    }
    expected = rm.forecast(distinct, dim=estimate.dim)
    report["expected"] = {
        "seconds": expected.seconds if expected.seconds > 0 else None,
        "bytes": expected.bytes if expected.bytes > 0 else None,
    }
    return report


def _survey_rows(report: dict[str, Any]) -> dict[str, str]:
    rows = {}
    if report["spread"] is not None:
        rows["spread"] = (
            f"distances to the sixth neighbor vary {report['spread']:.2g}-fold, 5 % to 95 %"
        )
    if report["structure"]:
        rows["structure"] = report["structure"]
    if report["units"]:
        rows["units"] = "\n".join(report["units"])
    found, expected = report["dimension"], report["expected"]
    if found is not None:
        sure = "sure" if found["confidence"] >= LOW_CONFIDENCE else "uncertain"
        few = f", from {found['samples']:,} samples"
        rows["dimension"] = (
            f"{found['dim']}, {sure} (confidence {found['confidence']:.2f}"
            f"{few if found['samples'] < report['num_points'] else ''})"
        )
    if expected is not None:
        parts = []
        if expected["seconds"] is not None:
            parts.append(f"{_duration(expected['seconds'])} by one thread")
        if expected["bytes"] is not None:
            parts.append(f"{_size(expected['bytes'])} of memory")
        if parts:
            rows["it would take"] = ", ".join(parts)
    return rows


def _duration(seconds: float) -> str:
    """One digit: more of them an estimate has not."""
    if seconds < 1:
        return "a second or less"
    for unit, size in (("seconds", 120), ("minutes", 7200), ("hours", np.inf)):
        if seconds < size:
            scale = {"seconds": 1, "minutes": 60, "hours": 3600}[unit]
            number = float(f"{seconds / scale:.1g}")
            return f"about {number:g} {unit if number != 1 else unit[:-1]}"
    return ""


def _size(count: int) -> str:
    megabytes = count / 1e6
    if megabytes < 1000:
        return f"{float(f'{max(megabytes, 1):.2g}'):g} MB"
    return f"{float(f'{megabytes / 1000:.2g}'):g} GB"


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


def _extent_rows(report: dict[str, Any]) -> dict[str, str]:
    rows = {}
    if report["not_finite"]:
        rows["not finite"] = f"{report['not_finite']:,}"
    if report["bounding_box"] is not None:
        low, high = report["bounding_box"]
        rows["from"] = _numbers(low, report["diagonal"])
        rows["to"] = _numbers(high, report["diagonal"])
        rows["diagonal"] = f"{report['diagonal']:.6g}"
    return rows


def _folder_table(report: dict[str, Any]) -> Table:
    rows = {
        "folder": report["input"],
        "files": "\n".join(
            f"{name}, {count:,} points" for name, count in report["files"].items()
        ),
        "points": f"{report['num_points']:,} in R^{report['ambient_dim']}",
    }
    if report["coordinates"]:
        rows["coordinates"] = ", ".join(report["coordinates"])
    rows |= _extent_rows(report)
    if report["fields"]:
        rows["fields"] = ", ".join(report["fields"])
    return rows_table(rows)


def _table(report: dict[str, Any], name: str) -> Table:
    rows = {
        "file": f"{name}, {report['format']}",
        "points": f"{report['num_points']:,} in R^{report['ambient_dim']}",
    }
    if report["coordinates"]:
        rows["coordinates"] = report["coordinates"].removeprefix("coordinates are ")
    rows |= _extent_rows(report)
    if report["coincident_points"]:
        rows["coincident points"] = f"{report['coincident_points']:,}"
    if report["spacing"] is not None:
        spacing = report["spacing"]
        rows["nearest neighbor"] = (
            f"{spacing['median']:.4g} away in the median, {spacing['least']:.4g} to "
            f"{spacing['largest']:.4g}"
        )
    rows |= _survey_rows(report)
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
    if report["result"] is not None:
        rows |= _result_rows(report["result"])
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


def _numbers(values: list[float], diagonal: float) -> str:
    """Coordinates to six digits of the diagonal: far from the origin they have more."""
    shown = []
    for value in values[:6]:
        more = 0.0
        if 0 < diagonal < abs(value):
            more = math.ceil(math.log10(abs(value) / diagonal))
        shown.append(f"{value:.{min(6 + int(more), 15)}g}")
    return ", ".join([*shown, *(["..."] if len(values) > 6 else [])])


def _field_text(field: dict[str, Any]) -> str:
    kind = str(field["dtype"])
    if field["components"] > 1:
        kind = f"{field['components']} x {kind}"
    if field["least"] is None:
        return kind
    return f"{kind}, {field['least']:.4g} to {field['largest']:.4g}"
