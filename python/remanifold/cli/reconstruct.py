# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold reconstruct``: from a file of samples to a mesh."""

from __future__ import annotations

import json
import math
import warnings
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

import remanifold as rm
from remanifold._validation import (
    check_int,
    check_num_neighbors,
    check_positive,
    check_smooth,
)
from remanifold.cli._common import (
    choice,
    failures,
    messages_console,
    print_table,
    rows_table,
    say,
    simplex_names,
    timed,
)
from remanifold.cli.dimension import dim_report
from remanifold.dimension import LOW_CONFIDENCE, low_confidence
from remanifold.io import check_output, read_points, write_mesh
from remanifold.reconstruction import METHODS
from remanifold.steps import EDGE_RULES, ESTIMATORS, SEARCHES

# More would take longer than the reconstruction.
MAX_SIMPLICES_FOR_ALGEBRA = 200_000
BOUNDARIES: dict[str, str | bool] = {"auto": "auto", "closed": False}


def _dim_or_auto(text: str) -> int | str:
    if text == "auto":
        return text
    try:
        return check_int(int(text), "dim", minimum=1)
    except ValueError:
        msg = f"{text!r} is neither a positive integer nor 'auto'."
        raise typer.BadParameter(msg) from None


def _outliers(text: str) -> Any:
    if text in ("auto", "keep"):
        return {"auto": "auto", "keep": False}[text]
    try:
        return check_positive(float(text), "outliers")
    except ValueError:
        msg = f"{text!r} is neither auto, keep nor a positive number."
        raise typer.BadParameter(msg) from None


def _smooth(text: str) -> Any:
    if text in ("no", "auto", "yes"):
        return text
    try:
        return int(text)
    except ValueError:
        msg = f"{text!r} is neither no, auto, yes nor a number of neighbors."
        raise typer.BadParameter(msg) from None


def reconstruct(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="INPUT",
            help="Samples: .npy, .npz, .csv, .txt, .xyz, .ply, .obj, .off, .stl, .vtk "
            "or .vtu.",
        ),
    ],
    dim: Annotated[
        Any,
        typer.Option(
            "--dim",
            "-k",
            parser=_dim_or_auto,
            metavar="[INTEGER|auto]",
            help="Dimension K of the manifold, or auto: estimated from the samples.",
        ),
    ],
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            help="Mesh to write: .ply, .obj, .off, .stl, .vtk, .vtu, or .npz for any "
            "dimension.",
        ),
    ],
    method: Annotated[
        str, choice(METHODS, "Closed up to a manifold, or the paper's complex.")
    ] = "manifold",
    boundary: Annotated[
        str,
        choice(
            tuple(BOUNDARIES),
            "Manifold method: leave wide holes open, or close everything.",
        ),
    ] = "auto",
    hole_radius: Annotated[
        float | None,
        typer.Option(
            show_default="by how evenly the samples lie",
            help="Manifold method: radius of the smallest hole left open, in units of "
            "the distance to the (2K+2)-th neighbor.",
        ),
    ] = None,
    outliers: Annotated[
        Any,
        typer.Option(
            parser=_outliers,
            metavar="[auto|keep|DISTANCE]",
            show_default="auto, or keep for paper",
            help="Leave out samples at least so many local scales away from what the "
            "others show (auto: 2), or keep all.",
        ),
    ] = None,
    smooth: Annotated[
        Any,
        typer.Option(
            parser=_smooth,
            metavar="[no|auto|yes|NEIGHBORS]",
            help="Move noisy samples onto the manifold first: auto where there is "
            "noise, yes in any case, or by fits to so many neighbors.",
        ),
    ] = "no",
    keep_positions: Annotated[
        bool,
        typer.Option(
            "--keep-positions",
            help="Write the samples where they were, not where they were moved to.",
        ),
    ] = False,
    num_neighbors: Annotated[
        int | None,
        typer.Option(
            show_default="3 K (K + 3) / 2, or 10 K for paper",
            help="Neighbors per sample for the tangent spaces.",
        ),
    ] = None,
    estimator: Annotated[
        str | None,
        choice(
            ESTIMATORS,
            "Estimator of the tangent spaces.",
            "jet, or enclosure for paper",
        ),
    ] = None,
    edges: Annotated[
        str | None,
        choice(
            EDGE_RULES,
            "Paper's method: keep edges seen from both ends, or from either.",
            "mutual",
        ),
    ] = None,
    search: Annotated[
        str, choice(SEARCHES, "Search for the nearest neighbors.")
    ] = "auto",
    threads: Annotated[
        int | None, typer.Option(min=1, show_default="all cores", help="Threads.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Report as a JSON object.")
    ] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="No progress, table or warnings.")
    ] = False,
) -> None:
    """Reconstruct a manifold from samples and write it as a mesh."""
    messages = messages_console()
    found: rm.DimensionEstimate | None = None
    seconds: dict[str, float] = {}
    with failures(messages):
        _check_method(method, boundary, hole_radius, edges)
        # Every mesh format holds triangles.
        _check_usage(source, output, 2 if dim == "auto" else dim, num_neighbors, "no")
        points, seconds["read"] = timed(lambda: read_points(source))
        show_progress = messages.is_terminal and not quiet
        if dim == "auto":
            found, seconds["dimension"] = timed(
                lambda: rm.estimate_dimension(
                    points, num_threads=threads, progress=show_progress
                )
            )
            dim = found.dim
            if found.confidence >= LOW_CONFIDENCE and not quiet:
                say(messages, found.verdict, "none")
        _check_usage(source, output, dim, num_neighbors, smooth, points.shape[1])
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", rm.RemanifoldWarning)
            rec = rm.reconstruct(
                points,
                dim,
                method=method,
                boundary=BOUNDARIES[boundary],
                hole_radius=hole_radius,
                outliers=outliers,
                smooth={"no": False, "yes": True}.get(smooth, smooth),
                num_neighbors=num_neighbors,
                estimator=estimator,
                edges=edges,
                search=search,
                num_threads=threads,
                progress=show_progress,
            )
        report = _report(rec)
        vertices: Any = rec.samples if keep_positions else rec.vertices
        _, seconds_written = timed(lambda: write_mesh(output, vertices, rec.simplices))

    seconds = {**seconds, **report["seconds"], "write": seconds_written}
    complaints = [str(warning.message) for warning in caught]
    if found is not None:
        report["dim_estimate"] = dim_report(found)
        if found.confidence < LOW_CONFIDENCE:
            complaints.insert(0, low_confidence(found))
    warned = any(issubclass(w.category, rm.ManifoldWarning) for w in caught)
    complaints += _complaints(report, warned)
    paper = method == "paper"
    report = {
        "input": str(source),
        "output": str(output),
        **report,
        "boundary": None if paper else boundary,
        "seconds": seconds,
        "warnings": complaints,
    }
    if not quiet:
        for text in complaints:
            say(messages, f"warning: {text}", "yellow")
    if as_json:
        typer.echo(json.dumps(report, indent=2))
    elif not quiet:
        print_table(_table(report))


def _check_method(
    method: str, boundary: str, hole_radius: float | None, edges: str | None
) -> None:
    """Refuse what the method does not have."""
    if method == "manifold" and edges is not None:
        msg = "is for --method paper only."
        raise typer.BadParameter(msg, param_hint="'--edges'")
    if method == "paper" and boundary != "auto":
        msg = "is for --method manifold only."
        raise typer.BadParameter(msg, param_hint="'--boundary'")
    if method == "paper" and hole_radius is not None:
        msg = "is for --method manifold only."
        raise typer.BadParameter(msg, param_hint="'--hole-radius'")
    try:
        if hole_radius is not None:
            check_positive(hole_radius, "hole_radius")
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--hole-radius'") from None


def _check_usage(
    source: Path,
    output: Path,
    dim: int,
    num_neighbors: int | None,
    smooth: str | int,
    ambient_dim: int | None = None,
) -> None:
    """Refuse what cannot work, before the work."""
    try:
        if isinstance(smooth, int):
            check_smooth(smooth, dim)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--smooth'") from None
    try:
        check_num_neighbors(num_neighbors, dim)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--num-neighbors'") from None
    try:
        check_output(output, dim, ambient_dim)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--output'") from None
    if source.exists() and output.exists() and source.samefile(output):
        msg = f"{output}: is the input, which would be lost"
        raise typer.BadParameter(msg, param_hint="'--output'")


def _report(rec: rm.Reconstruction) -> dict[str, Any]:
    topology, seconds_topology = timed(rec.topology)
    repair, seconds_repair = timed(lambda: rec.repair)
    quality, seconds_quality = timed(lambda: rec.quality)
    manifold = rec.method == "manifold"
    return {
        "method": rec.method,
        "estimator": rec.estimator,
        "edges": rec.edge_rule,
        "search": rec.search,
        "num_neighbors": rec.num_neighbors,
        "num_samples": rec.num_samples,
        "ambient_dim": rec.ambient_dim,
        "dim": rec.dim,
        "num_simplices": list(topology.num_simplices),
        "euler_characteristic": topology.euler_characteristic,
        "components": topology.components,
        "betti_numbers": (
            list(topology.betti_numbers)
            if topology.counting_settles_homology
            or topology.num_simplices[-1] <= MAX_SIMPLICES_FOR_ALGEBRA
            else None
        ),
        "manifold": topology.manifold,
        "closed": topology.closed,
        "orientable": topology.orientable,
        "boundary_samples": int(rec.boundary.sum()),
        "merged_samples": repair.merged_samples,
        "outliers": len(rec.outliers),
        "smoothing": _smoothing_report(rec.smoothing),
        "unused_samples": len(repair.unused_vertices),
        "coface_counts": {str(n): f for n, f in topology.coface_counts.items()},
        "hole_radius": repair.hole_radius if manifold else None,
        "agreed_simplices": repair.num_agreed if manifold else None,
        "disputed_simplices": len(repair.disputed_simplices) if manifold else None,
        "filled_simplices": len(repair.filled_simplices) if manifold else None,
        "inserted_samples": len(repair.inserted_vertices) if manifold else None,
        "open_faces": len(repair.open_faces),
        "callous_faces": len(repair.callous_faces),
        "unstarred_simplices": None if manifold else len(repair.unstarred_simplices),
        "holes": repair.num_holes,
        "boundary_components": repair.num_boundary_components,
        "singular_vertices": len(topology.singular_vertices),
        "sampling": {
            "ok": quality.ok,
            "verdict": quality.verdict,
            "reasons": [reason.text for reason in quality.reasons],
            "doubtful_samples": int(quality.doubtful.sum()),
            "recommended_samples": quality.recommended_samples,
            "noise": None if math.isnan(quality.noise) else quality.noise,
        },
        "seconds": {
            **rec.timings,
            "report": seconds_topology + seconds_repair + seconds_quality,
        },
    }


def _smoothing_report(smoothing: rm.Smoothing | None) -> dict[str, Any] | None:
    if smoothing is None:
        return None
    return {
        "noise": smoothing.noise if math.isfinite(smoothing.noise) else None,
        "num_neighbors": smoothing.num_neighbors,
        "rounds": smoothing.rounds,
    }


def _smoothing_text(report: dict[str, Any]) -> str:
    noise = "unknown" if report["noise"] is None else f"{report['noise']:.3g}"
    if not report["num_neighbors"]:
        return f"nothing moved, noise {noise}"
    return f"by {report['num_neighbors']:,} neighbors, noise {noise}"


def _complaints(report: dict[str, Any], warned: bool) -> list[str]:
    """Say what the result lacks, unless the library has warned of it."""
    faces, simplices = simplex_names(report["dim"])[-2:]
    unused = "{} samples are in no simplex"
    if report["method"] == "paper":
        unused += f" ({report['boundary_samples']:,} have no tangent space)"
    found = [
        (report["outliers"], "{} samples are outliers and were left out"),
        (report["unused_samples"], unused),
        *([] if warned else _defects(report, faces, simplices)),
    ]
    return [text.format(f"{count:,}") for count, text in found if count]


def _defects(
    report: dict[str, Any], faces: str, simplices: str
) -> list[tuple[int | None, str]]:
    return [
        (report["callous_faces"], f"{{}} {faces} are in more than two {simplices}"),
        (
            report["unstarred_simplices"],
            f"{{}} {simplices} are in the star of none of their vertices",
        ),
        (report["holes"], "{} holes"),
        (
            report["singular_vertices"],
            "no manifold: around {} vertices it is neither a ball nor half of one",
        ),
    ]


def _table(report: dict[str, Any]) -> Table:
    names = simplex_names(report["dim"])
    faces, simplices = names[-2:]
    yes_no = {True: "yes", False: "no"}
    counts = {
        f"open {faces}": "open_faces",
        f"callous {faces}": "callous_faces",
        f"{simplices} in no star": "unstarred_simplices",
        f"agreed {simplices}": "agreed_simplices",
        f"disputed {simplices}": "disputed_simplices",
        f"filled {simplices}": "filled_simplices",
        "inserted samples": "inserted_samples",
        "holes": "holes",
        "boundary components": "boundary_components",
        "singular vertices": "singular_vertices",
    }
    rows = {
        "method": report["method"],
        "samples": f"{report['num_samples']:,} in R^{report['ambient_dim']}",
        "dimension": str(report["dim"])
        + (
            f" (estimated, confidence {report['dim_estimate']['confidence']:.2f})"
            if "dim_estimate" in report
            else ""
        ),
        "simplices": ", ".join(
            f"{count:,} {name}"
            for count, name in zip(report["num_simplices"], names, strict=True)
        ),
        "Euler characteristic": f"{report['euler_characteristic']:,}",
        "components": f"{report['components']:,}",
        "Betti numbers": (
            "not computed"
            if report["betti_numbers"] is None
            else ", ".join(f"{b:,}" for b in report["betti_numbers"])
        ),
        "manifold": yes_no[report["manifold"]],
        "closed": yes_no[report["closed"]],
        "orientable": yes_no[report["orientable"]],
        "boundary samples": f"{report['boundary_samples']:,}",
        "outliers": f"{report['outliers']:,}",
        **(
            {}
            if report["smoothing"] is None
            else {"smoothed": _smoothing_text(report["smoothing"])}
        ),
        "unused samples": f"{report['unused_samples']:,}",
        **(
            {}
            if report["hole_radius"] is None
            else {"hole radius": f"{report['hole_radius']:.3g}"}
        ),
        f"{faces} by {simplices}": ", ".join(
            f"{number:,} in {n}" for n, number in report["coface_counts"].items()
        ),
        **{
            name: f"{report[key]:,}"
            for name, key in counts.items()
            if report[key] is not None
        },
        "sampling": report["sampling"]["verdict"],
        "seconds": "\n".join(
            f"{seconds:.2f} {step.replace('_', ' ')}"
            for step, seconds in report["seconds"].items()
        ),
        "written": report["output"],
    }
    return rows_table(rows)
