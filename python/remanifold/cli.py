# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: ``remanifold reconstruct INPUT --dim K -o OUT``.

``remanifold dimension INPUT`` finds K. The result goes to a file, the report to standard output, everything else to standard
error. Exit codes: 0 done, 1 the run or a file failed, 2 wrong usage, 130 interrupted.
"""

from __future__ import annotations

import contextlib
import itertools
import json
import math
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

import remanifold as rm
from remanifold._validation import (
    check_int,
    check_num_neighbors,
    check_positive,
    check_smooth,
)
from remanifold.dimension import LOW_CONFIDENCE, SMALLEST_SCALE, low_confidence
from remanifold.io import check_output, read_points, write_mesh
from remanifold.reconstruction import METHODS
from remanifold.steps import EDGE_RULES, ESTIMATORS, SEARCHES

__all__ = ["app", "main"]

# More would take longer than the reconstruction.
MAX_SIMPLICES_FOR_ALGEBRA = 200_000
BOUNDARIES: dict[str, str | bool] = {"auto": "auto", "closed": False}

app = typer.Typer(
    name="remanifold",
    help="Reconstruct manifolds from their samples.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Run the command line."""
    app(prog_name="remanifold")


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"remanifold {rm.__version__}")
        raise typer.Exit


def _choice(words: tuple[str, ...], text: str, show_default: str | bool = True) -> Any:
    def check(word: str | None) -> str | None:
        if word is not None and word not in words:
            msg = f"{word!r} is not one of {', '.join(map(repr, words))}."
            raise typer.BadParameter(msg)
        return word

    return typer.Option(
        metavar=f"[{'|'.join(words)}]",
        help=text,
        callback=check,
        show_default=show_default,
    )


def _dim_or_auto(text: str) -> int | str:
    if text == "auto":
        return text
    try:
        return check_int(int(text), "dim", minimum=1)
    except ValueError:
        msg = f"{text!r} is neither a positive integer nor 'auto'."
        raise typer.BadParameter(msg) from None


@contextlib.contextmanager
def _failures(messages: Console) -> Iterator[None]:
    """Say in one line what failed, and exit."""
    try:
        yield
    except KeyboardInterrupt:
        _say(messages, "interrupted", "red")
        raise typer.Exit(130) from None
    except typer.BadParameter:
        raise
    except Exception as error:  # noqa: BLE001  one line for the user, whatever it is
        _say(messages, f"error: {_describe(error)}", "red")
        raise typer.Exit(1) from None


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


@app.callback()
def _root(
    _: Annotated[
        bool,
        typer.Option(
            "--version", callback=_version, is_eager=True, help="Show the version."
        ),
    ] = False,
) -> None:
    pass


@app.command()
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
        str, _choice(METHODS, "Closed up to a manifold, or the paper's complex.")
    ] = "manifold",
    boundary: Annotated[
        str,
        _choice(
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
        _choice(
            ESTIMATORS,
            "Estimator of the tangent spaces.",
            "jet, or enclosure for paper",
        ),
    ] = None,
    edges: Annotated[
        str | None,
        _choice(
            EDGE_RULES,
            "Paper's method: keep edges seen from both ends, or from either.",
            "mutual",
        ),
    ] = None,
    search: Annotated[
        str, _choice(SEARCHES, "Search for the nearest neighbors.")
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
    messages = Console(stderr=True, soft_wrap=True, highlight=False)
    found: rm.DimensionEstimate | None = None
    seconds: dict[str, float] = {}
    with _failures(messages):
        _check_method(method, boundary, hole_radius, edges)
        # Every mesh format holds triangles.
        _check_usage(source, output, 2 if dim == "auto" else dim, num_neighbors, "no")
        points, seconds["read"] = _timed(lambda: read_points(source))
        show_progress = messages.is_terminal and not quiet
        if dim == "auto":
            found, seconds["dimension"] = _timed(
                lambda: rm.estimate_dimension(
                    points, num_threads=threads, progress=show_progress
                )
            )
            dim = found.dim
            if found.confidence >= LOW_CONFIDENCE and not quiet:
                _say(messages, found.verdict, "none")
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
        _, seconds_written = _timed(lambda: write_mesh(output, vertices, rec.simplices))

    seconds = {**seconds, **report["seconds"], "write": seconds_written}
    complaints = [str(warning.message) for warning in caught]
    if found is not None:
        report["dim_estimate"] = _dim_report(found)
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
            _say(messages, f"warning: {text}", "yellow")
    if as_json:
        typer.echo(json.dumps(report, indent=2))
    elif not quiet:
        Console(highlight=False).print(_table(report))


@app.command()
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
    threads: Annotated[
        int | None, typer.Option(min=1, show_default="all cores", help="Threads.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Report as a JSON object.")
    ] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="No progress or warnings.")
    ] = False,
) -> None:
    """Estimate the dimension of the manifold that the samples lie on."""
    messages = Console(stderr=True, soft_wrap=True, highlight=False)
    with _failures(messages):
        points, seconds_read = _timed(lambda: read_points(source))
        found, seconds_found = _timed(
            lambda: rm.estimate_dimension(
                points,
                num_neighbors=num_neighbors,
                num_threads=threads,
                progress=messages.is_terminal and not quiet,
            )
        )
    if found.confidence < LOW_CONFIDENCE and not quiet:
        _say(messages, f"warning: {low_confidence(found)}", "yellow")
    report = {
        "input": str(source),
        "num_samples": len(points),
        "ambient_dim": points.shape[1],
        "dim": found.dim,
        **_dim_report(found),
        "seconds": {"read": seconds_read, "dimension": seconds_found},
    }
    if as_json:
        typer.echo(json.dumps(report, indent=2))
    else:
        Console(highlight=False).print(_dim_table(report))


def _dim_report(found: rm.DimensionEstimate) -> dict[str, Any]:
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
    return _rows(rows)


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


def _timed(work: Callable[[], Any]) -> tuple[Any, float]:
    start = time.perf_counter()
    result = work()
    return result, time.perf_counter() - start


def _report(rec: rm.Reconstruction) -> dict[str, Any]:
    topology, seconds_topology = _timed(rec.topology)
    repair, seconds_repair = _timed(lambda: rec.repair)
    quality, seconds_quality = _timed(lambda: rec.quality)
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
    faces, simplices = _names(report["dim"])[-2:]
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
    names = _names(report["dim"])
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
    return _rows(rows)


def _rows(rows: dict[str, str]) -> Table:
    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in rows.items():
        table.add_row(name, Text(value))
    return table


def _names(dim: int) -> list[str]:
    """Name the simplices of dimension 0 to ``dim``."""
    names = ["vertices", "edges", "triangles", "tetrahedra"]
    return (names + [f"{k}-simplices" for k in range(4, dim + 1)])[: dim + 1]


def _describe(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        where = f"{error.filename}: " if error.filename else ""
        return f"{where}{error.strerror}"
    if isinstance(error, ValueError | TypeError | OSError) and str(error):
        return str(error)
    if isinstance(error, MemoryError):
        return f"out of memory: {error}" if str(error) else "out of memory"
    return f"{type(error).__name__}: {error}"


def _say(console: Console, text: str, style: str) -> None:
    console.print(Text(f"remanifold: {' '.join(text.splitlines())}", style=style))
