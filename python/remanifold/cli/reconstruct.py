# SPDX-License-Identifier: GPL-3.0-or-later
"""``remanifold reconstruct``: from a file of samples to a mesh."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

import remanifold as rm
from remanifold.cli._common import (
    ColumnsOption,
    DropInvalidOption,
    FormatOption,
    JsonOption,
    OutputFormatOption,
    ThreadsOption,
    choice,
    failures,
    listed,
    messages_console,
    print_report,
    refuse_same_file,
    rows_table,
    say,
    split_formats,
    timed,
)
from remanifold.cli._distributed import Tiling, reconstruct_in_tiles
from remanifold.cli._examples import examples
from remanifold.cli._options import (
    Boundary,
    Checks,
    Dim,
    Edges,
    Estimator,
    HoleRadius,
    Matrix,
    MaxMemory,
    MaxSeconds,
    Method,
    NumNeighbors,
    Outliers,
    Quiet,
    Search,
    Significance,
    Smooth,
    Source,
    options_of,
)
from remanifold.cli._reconstructing import reconstruct_file
from remanifold.cli.dimension import dim_report
from remanifold.complex.topology import simplex_names
from remanifold.formats._source import is_standard
from remanifold.formats.saved import SUFFIX
from remanifold.formats.writing import MESH_WRITERS, fitting_fields, write_valid
from remanifold.io import check_output, write_mesh
from remanifold.method.options import CHECKS
from remanifold.results.reconstruction import check_saved

EPILOG = examples(
    "remanifold reconstruct scan.ply --dim 2 -o mesh.ply",
    "remanifold reconstruct curve.csv -k 1 -o curve.vtu --json",
    "remanifold reconstruct scan.laz -k auto -o mesh.npz --smooth auto",
    "remanifold reconstruct scan.ply -k 2 -o scan.rm.npz",
    "remanifold reconstruct table.csv -k 2 -o mesh.ply --columns easting,northing,h",
    "remanifold reconstruct depth.pcd -k 2 -o mesh.ply --drop-invalid",
    "remanifold reconstruct distances.npy -k 2 -o cloud.rm.npz --matrix distances",
    "cat points.txt | remanifold reconstruct - --format txt -k 2 -o mesh.obj",
    "remanifold reconstruct scan.ply -k 2 -o - --format off > mesh.off",
    "remanifold reconstruct tiles/ -k 2 -o mesh.ply --distributed --workers 8",
)


def reconstruct(
    source: Source,
    dim: Dim,
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            help=f"Mesh to write: {listed(MESH_WRITERS)}, which holds any dimension; "
            f"{SUFFIX} saves all of the result, its parameters too; - is standard "
            "output, and then the report goes to standard error.",
        ),
    ],
    method: Method = "manifold",
    boundary: Boundary = "auto",
    hole_radius: HoleRadius = None,
    significance: Significance = None,
    outliers: Outliers = None,
    smooth: Smooth = None,
    keep_positions: Annotated[
        bool,
        typer.Option(
            "--keep-positions",
            help="Write the samples where they were, not where they were moved to.",
        ),
    ] = False,
    num_neighbors: NumNeighbors = None,
    estimator: Estimator = None,
    edges: Edges = None,
    search: Search = "auto",
    checks: Checks = CHECKS,
    fields: Annotated[
        str,
        choice(
            ("auto", "none"),
            "Write what is known of each sample (boundary, spacing, ...) where the "
            "format holds it, or nothing.",
        ),
    ] = "auto",
    columns: ColumnsOption = None,
    matrix: Matrix = None,
    drop_invalid: DropInvalidOption = False,
    format: FormatOption = None,
    output_format: OutputFormatOption = None,
    threads: ThreadsOption = None,
    max_seconds: MaxSeconds = None,
    max_memory: MaxMemory = None,
    distributed: Annotated[
        bool,
        typer.Option(
            "--distributed",
            help="In tiles, by the processes of a Dask cluster: for samples that do not "
            "fit into memory. INPUT may be a folder of .npy, .las, .laz, .parquet or "
            ".zarr; the output is a .ply, or a directory of parts.",
        ),
    ] = False,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            show_default="a cluster on this machine",
            help="Distributed: of a running Dask cluster, as tcp://10.0.0.1:8786.",
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=0,
            show_default="all cores",
            help="Distributed: processes on this machine; 0 for none but this.",
        ),
    ] = None,
    memory_limit: Annotated[
        str | None,
        typer.Option(
            metavar="SIZE",
            show_default="a share of all",
            help="Distributed: memory of each process on this machine, as 3GiB.",
        ),
    ] = None,
    tile_size: Annotated[
        int | None,
        typer.Option(show_default="1000000", help="Distributed: samples of a tile."),
    ] = None,
    work: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            show_default="OUTPUT.tiles",
            help="Distributed: directory of the run, seen by all workers.",
        ),
    ] = None,
    resume: Annotated[
        bool,
        typer.Option("--resume", help="Distributed: go on with the run in --work."),
    ] = False,
    as_json: JsonOption = False,
    quiet: Quiet = False,
) -> None:
    """Reconstruct a manifold and write it.

    From samples to a mesh, with a table of what was found.
    """
    messages = messages_console()
    options = options_of(
        method=method,
        boundary=boundary,
        hole_radius=hole_radius,
        significance=significance,
        outliers=outliers,
        smooth=smooth,
        num_neighbors=num_neighbors,
        estimator=estimator,
        edges=edges,
        search=search,
        checks=checks,
    )

    tiling = Tiling(scheduler, workers, memory_limit, tile_size, work, resume)
    if distributed:
        tiling.check()
        for flag, is_given in (
            ("--method", method != "manifold"),
            ("--edges", edges is not None),
            ("--search", search != "auto"),
            ("--checks", checks != CHECKS),
            ("--columns", columns is not None),
            ("--matrix", matrix is not None),
            ("--drop-invalid", drop_invalid),
            ("--keep-positions", keep_positions),
            ("--format", format is not None),
            ("--output-format", output_format is not None),
            ("--num-threads", threads is not None),
            ("--max-seconds", max_seconds is not None),
            ("--max-memory", max_memory is not None),
        ):
            if is_given:
                msg = "is for one piece, and not for --distributed."
                raise typer.BadParameter(msg, param_hint=f"'{flag}'")
        with failures(messages):
            reconstruct_in_tiles(
                source,
                dim,
                output,
                options,
                tiling,
                messages,
                fields=fields == "auto",
                as_json=as_json,
                quiet=quiet,
            )
        return
    tiling.check_unused()

    whole = output_format is None and output.name.lower().endswith(SUFFIX)
    for flag, given in (
        ("--keep-positions", keep_positions),
        ("--fields", fields != "auto"),
    ):
        if whole and given:
            msg = f"a saved result holds everything; {flag} is for meshes."
            raise typer.BadParameter(msg, param_hint=f"'{flag}'")

    if matrix is not None and not whole:
        msg = (
            f"samples of a matrix have no coordinates, which meshes need: {SUFFIX} "
            "saves the result."
        )
        raise typer.BadParameter(msg, param_hint="'--output'")

    def check_target(dim: int, ambient_dim: int | None) -> None:
        try:
            if whole:
                check_saved(output)
            else:
                check_output(output, dim, ambient_dim, format=output_format)
        except ValueError as error:
            raise typer.BadParameter(str(error), param_hint="'--output'") from None
        refuse_same_file(source, output)

    with failures(messages):
        format, output_format = split_formats(source, output, format, output_format)
        done = reconstruct_file(
            source,
            dim,
            options,
            check_target,
            messages,
            threads=threads,
            quiet=quiet,
            format=format,
            columns=columns,
            drop_invalid=drop_invalid,
            matrix=matrix,
            max_seconds=max_seconds,
            max_memory=max_memory,
        )
        rec = done.rec
        report = _report(rec)
        vertices: Any = rec.samples if keep_positions else rec.vertices
        known = rec.fields() if fields == "auto" else None
        kept = None if known is None else fitting_fields(output, known, output_format)

        def write() -> None:
            if whole:
                rec.save(output)
                return
            (write_valid if len(rec.invalid) else write_mesh)(
                output,
                vertices,
                rec.simplices,
                fields=kept,
                format=output_format,
                comment=rec.comment,
            )

        _, seconds_written = timed(write)
        lost = [n for n in rec.vertex_attributes if kept is not None and n not in kept]

    seconds = {**done.seconds, **report["seconds"], "write": seconds_written}
    if done.found is not None:
        report["dim_estimate"] = dim_report(done.found)
    complaints = done.complaints + _complaints(report, done.warned)
    if lost and not quiet:
        suffix = output.suffix if output_format is None else output_format
        text = f"note: {suffix} has no room for {', '.join(lost)}"
        say(messages, text, "none")
    paper = method == "paper"
    report = {
        "input": str(source),
        "output": str(output),
        **report,
        "boundary": None if paper else boundary,
        "seconds": seconds,
        "warnings": done.guesses + complaints,
    }
    if not quiet:
        for text in complaints:
            say(messages, f"warning: {text}", "yellow")
    if as_json or not quiet:
        taken = is_standard(output)
        print_report(report, _table, as_json=as_json, stderr=taken)


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
            list(topology.betti_numbers) if topology.homology_is_cheap else None
        ),
        "manifold": topology.manifold,
        "closed": topology.closed,
        "orientable": topology.orientable,
        "boundary_samples": int(rec.boundary.sum()),
        "merged_samples": repair.merged_samples,
        "invalid_samples": len(rec.invalid),
        "outliers": len(rec.outliers),
        "smoothing": _smoothing_report(rec.smoothing),
        "unused_samples": len(repair.unused_vertices),
        "coface_counts": {str(n): f for n, f in topology.coface_counts.items()},
        "hole_radius": repair.hole_radius if manifold else None,
        "hole_size": repair.hole_size if manifold else None,
        "significance": rec.significance if manifold else None,
        "openings": [_opening(one) for one in rec.openings] if manifold else None,
        "agreed_simplices": repair.num_agreed if manifold else None,
        "disputed_simplices": len(repair.disputed_simplices) if manifold else None,
        "filled_simplices": len(repair.filled_simplices) if manifold else None,
        "inserted_samples": len(repair.inserted_vertices) if manifold else None,
        "cut_samples": len(repair.cut_vertices) if manifold else None,
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


def _opening(opening: rm.Opening) -> dict[str, Any]:
    return {
        "kind": opening.kind,
        "decision": opening.decision,
        "radius": opening.radius,
        "spacing": opening.spacing,
        "missing_samples": opening.missing,
        "significance": opening.significance,
        "hole_radius": opening.hole_radius,
        "samples": opening.samples.tolist(),
    }


def _openings_text(openings: list[dict[str, Any]]) -> str:
    """Counts, and the closest decision."""
    counts = Counter((one["kind"], one["decision"]) for one in openings)
    lines = [
        ", ".join(
            f"{count:,} {kind}{'s' if count > 1 else ''} {decision}"
            for (kind, decision), count in counts.items()
        )
    ]
    weighed = [one for one in openings if one["kind"] != "part" and one["spacing"] > 0]
    if weighed:
        one = weighed[0]
        lines.append(
            f"closest: a {one['kind']} of {2 * one['radius'] / one['spacing']:.1f} "
            f"spacings ({2 * one['radius']:.3g}) at sample {one['samples'][0]:,}, {one['decision']}, "
            f"significance {one['significance']:.2g}"
        )
    return "\n".join(lines)


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
    alone = report["unused_samples"] == 1
    unused = f"{{}} {'sample is' if alone else 'samples are'} in no simplex"
    if report["method"] == "paper":
        unused += f" ({report['boundary_samples']:,} have no tangent space)"
    found = [
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
        (
            report["holes"],
            "{} hole where none was asked for"
            if report["holes"] == 1
            else "{} holes where none were asked for",
        ),
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
        "cut samples": "cut_samples",
        "unwanted holes": "holes",
        "boundary components": "boundary_components",
        "singular vertices": "singular_vertices",
    }
    rows = {
        "method": report["method"],
        "samples": f"{report['num_samples']:,} "
        + (
            "known by products or distances"
            if report["ambient_dim"] is None
            else f"in R^{report['ambient_dim']}"
        ),
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
        **(
            {"not finite": f"{report['invalid_samples']:,}, left out"}
            if report["invalid_samples"]
            else {}
        ),
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
            else {
                "hole radius": f"{report['hole_radius']:.3g} local scales, "
                f"{report['hole_size']:.3g}"
            }
        ),
        **(
            {"openings": _openings_text(report["openings"])}
            if report["openings"]
            else {}
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
