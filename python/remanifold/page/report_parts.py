# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections of the report page, each as a string of HTML."""

from __future__ import annotations

import base64
import itertools
import math
from typing import TYPE_CHECKING

import numpy as np

from remanifold._base.html import (
    bullets,
    grid_table,
    histogram,
    number,
    paragraph,
    rows_table,
    section,
    text,
)
from remanifold._base.text import besides
from remanifold.complex.measures import angles, edge_ratios, shapes
from remanifold.complex.projection import simplex_volumes
from remanifold.complex.topology import simplex_names
from remanifold.formats.writing import fitting_fields, mesh_bytes, suffix_for

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from remanifold.judging.judged import JudgedReconstruction

MOST_SAMPLES = 100  # in a table
MOST_PLACES = 50
COORDINATES = 6
MOST_CARRIED = 8_000_000  # bytes of a mesh
YES_NO = {True: "yes", False: "no"}


def verdict(rec: JudgedReconstruction) -> str:
    """Say whether to trust the result, and why not."""
    quality = rec.quality
    answer = rec._answer(judged=True)
    first = answer.text[:1].upper() + answer.text[1:]
    # What the answer has said already is not said again.
    said = besides(quality.verdict, answer.text)
    said = said[:1].upper() + said[1:]
    reasons = [reason.text for reason in quality.reasons]
    return (
        f'<div class="verdict {"good" if answer.good else "doubt"}" role="note" '
        'aria-label="Verdict">\n'
        f'<p class="answer"><strong>{text(first)}.</strong></p>\n'
        f"{paragraph(f'{said}.') if said else ''}\n"
        f"{bullets(reasons[1:]) if len(reasons) > 1 else ''}</div>"
    )


def topology(rec: JudgedReconstruction) -> str:
    """Say what the complex is."""
    found = rec.topology()
    names = simplex_names(rec.dim)
    over_2, over_3 = "not computed: too many simplices", ""
    if found.homology_is_cheap:
        over_2 = _list(found.betti_numbers)
        over_3 = _list(found.betti_numbers_mod3)
    rows: list[tuple[str, object]] = [
        (name, f"{count:,}")
        for name, count in zip(names, found.num_simplices, strict=True)
    ]
    rows += [
        ("Euler characteristic", f"{found.euler_characteristic:,}"),
        ("components", f"{found.components:,}"),
        ("Betti numbers over Z2", over_2),
        *([("Betti numbers over Z3", over_3)] if over_3 else []),
        ("manifold", YES_NO[found.manifold]),
        ("closed", YES_NO[found.closed]),
        ("orientable", YES_NO[found.orientable]),
        ("the complex is", found.description),
        *_size(rec),
        ("boundary components", f"{found.boundary_components:,}"),
        ("singular vertices", f"{len(found.singular_vertices):,}"),
    ]
    by_number = (f"{faces:,} in {n:,}" for n, faces in found.coface_counts.items())
    rows.append((f"{names[-2]} by {names[-1]}", ", ".join(by_number)))
    return section("topology", "Topology", rows_table("Topology", rows))


def _size(rec: JudgedReconstruction) -> Iterator[tuple[str, object]]:
    if rec.vertices is None or len(rec.simplices) == 0:
        return
    words = {1: "length", 2: "area", 3: "volume"}
    yield words.get(rec.dim, f"{rec.dim}-volume"), f"{simplex_volumes(rec).sum():.6g}"


def repair(rec: JudgedReconstruction) -> str:
    """Say what was disputed and mended, and what is left."""
    found = rec.repair
    *_, faces, simplices = simplex_names(rec.dim)
    rows: list[tuple[str, object]] = []
    if rec.method == "manifold":
        rows += [
            (f"agreed {simplices}", f"{found.num_agreed:,}"),
            (f"disputed {simplices}", f"{len(found.disputed_simplices):,}"),
            (f"filled {simplices}", f"{len(found.filled_simplices):,}"),
            ("cavities filled", f"{found.num_cavities:,}"),
            ("of these cut into windows", f"{found.num_cut_cavities:,}"),
            ("linear programs", f"{found.num_programs:,}"),
            ("integer programs", f"{found.num_integer_programs:,}"),
            ("candidates of the largest", f"{found.largest_program:,}"),
            ("without a solution", f"{found.num_unsolved:,}"),
            ("samples put back", f"{len(found.inserted_vertices):,}"),
            ("samples with simplices taken out", f"{len(found.cut_vertices):,}"),
            ("hole radius, in local scales", number(found.hole_radius)),
            ("hole radius, in the data's units", number(found.hole_size)),
        ]
    else:
        rows.append((f"{simplices} in no star", f"{len(found.unstarred_simplices):,}"))
    rows += [
        ("unused samples", f"{len(found.unused_vertices):,}"),
        ("copies merged", f"{found.merged_samples:,}"),
        ("outliers left out", f"{len(rec.outliers):,}"),
        (f"open {faces}", f"{len(found.open_faces):,}"),
        ("boundary components", f"{found.num_boundary_components:,}"),
        ("unwanted holes", f"{found.num_holes:,}"),
        (f"callous {faces}", f"{len(found.callous_faces):,}"),
    ]
    left = found.remaining()
    parts = [rows_table("What repair did", rows)]
    if left:
        # Samples that fit nowhere are no lack of the complex.
        heading = "Left to mend" if found.lacks else "Samples in no simplex"
        parts.append(f"<h3>{heading}</h3>")
        if len(left) > MOST_PLACES:
            parts.append(
                paragraph(f"The first {MOST_PLACES} of {len(left):,}.", "faint")
            )
        shown = [(what, _list(place)) for what, place in left[:MOST_PLACES]]
        parts.append(grid_table(heading, ("what", "vertices"), shown))
    else:
        parts.append(paragraph("Nothing is left to mend."))
    return section("repair", "What repair did", *parts)


def openings(rec: JudgedReconstruction) -> str:
    """List where samples may be missing and what was decided there."""
    if not rec.openings:
        return section(
            "openings",
            "Openings",
            paragraph("No place where more samples are missing than chance explains."),
        )
    head = (
        *("what", "decision", "radius", "in spacings", "samples missing"),
        *("significance", "near sample"),
    )
    rows = [
        (
            opening.kind,
            opening.decision + (", as told" if opening.given else ""),
            number(opening.radius) if opening.kind != "part" else "",
            number(opening.radius / opening.spacing)
            if opening.kind != "part" and opening.spacing > 0
            else "",
            number(opening.missing) if opening.kind != "part" else "",
            number(opening.significance) if opening.kind != "part" else "",
            f"{opening.samples[0]:,}",
        )
        for opening in rec.openings[:MOST_PLACES]
    ]
    parts = [
        paragraph(
            "Where samples may be missing, the closest decisions first. What is less "
            f"likely by chance than {rec.significance:g}, in the whole data, is open: "
            "with that below, or from the significance in the table on, the decision "
            "is the other one.",
            "faint",
        )
    ]
    if len(rec.openings) > MOST_PLACES:
        parts.append(
            paragraph(f"The first {MOST_PLACES} of {len(rec.openings):,}.", "faint")
        )
    parts.append(grid_table("Openings", head, rows))
    return section("openings", "Openings", *parts)


def histograms(rec: JudgedReconstruction) -> str:
    """Draw how samples and simplices are spread."""
    quality = rec.quality
    own = rec.representatives == np.arange(rec.num_samples)
    own[rec.left_out] = False
    charts = [
        histogram("spacing of the samples", quality.spacing[own]),
        histogram("sampling ratio: spacing over reach", quality.sampling_ratio[own]),
        histogram("tangent confidence", quality.tangent_confidence[own]),
    ]
    if len(rec.simplices) and rec.dim == 1:
        charts.append(histogram("shorter over longer edge", edge_ratios(rec)))
    elif len(rec.simplices):
        names = simplex_names(rec.dim)
        kind = "angles" if rec.dim == 2 else "dihedral angles"
        charts += [
            histogram(f"{kind} of the {names[-1]}", angles(rec), "degrees"),
            histogram(f"shape quality of the {names[-1]}", shapes(rec)),
        ]
    grid = "\n".join(charts)
    body = f'<div class="charts">\n{grid}\n</div>' if grid.strip() else ""
    note = "Dashed: the median."
    if rec.dim > 1:
        note += " Shape quality is 1 for a regular simplex and 0 for a flat one."
    return section(
        "histograms", "Spacing, angles, shapes", body, paragraph(note, "faint")
    )


def doubt(rec: JudgedReconstruction) -> str:
    """List the samples in doubt and the outliers."""
    doubtful = np.flatnonzero(rec.quality.doubtful)
    return section(
        "doubt",
        "Samples in doubt",
        _samples(rec, doubtful, "samples in doubt", with_reasons=True)
        or paragraph("None."),
    ) + section(
        "outliers",
        "Outliers and noise",
        _samples(rec, rec.outliers, "outliers", with_reasons=False)
        or paragraph("No sample was left out as an outlier."),
        rows_table("Noise", _noise(rec)),
    )


def _noise(rec: JudgedReconstruction) -> Iterator[tuple[str, object]]:
    yield "noise, in spacings", number(rec.quality.noise)
    smoothing = rec.smoothing
    if smoothing is None:
        yield "smoothing", "not asked for"
        return
    yield "noise, in the unit of the samples", number(smoothing.noise)
    yield "error of prediction", number(smoothing.prediction_error)
    if smoothing.moved:
        yield "smoothed by", f"fits to {smoothing.num_neighbors:,} neighbors"
        yield "rounds", smoothing.rounds
        yield "expected to remain", number(smoothing.remaining_error)
        if len(rec.attached):
            yield "resolution", number(smoothing.resolution)
            yield "samples attached", f"{len(rec.attached):,}"
    else:
        yield "smoothing", "no sample was moved"


def _samples(
    rec: JudgedReconstruction,
    which: NDArray[np.integer],
    what: str,
    *,
    with_reasons: bool,
) -> str:
    if len(which) == 0:
        return ""
    shown = which[:MOST_SAMPLES]
    samples = rec.samples
    head = ["sample"]
    columns: list[list[object]] = [[f"{i:,}" for i in shown.tolist()]]
    if samples is not None:
        head.append("coordinates")
        columns.append([_coordinates(samples[i]) for i in shown])
    if with_reasons:
        head.append("reason")
        columns.append(list(_reasons(rec, shown)))
    note = f"{what.capitalize()}: {len(which):,}"
    if len(which) > len(shown):
        note = f"The first {len(shown)} of {len(which):,} {what}"
    return paragraph(f"{note}.", "faint") + grid_table(
        what, head, zip(*columns, strict=True)
    )


def _reasons(rec: JudgedReconstruction, which: NDArray[np.integer]) -> Iterator[str]:
    stands_for = rec.representatives[which]
    named = [
        (reason.text, np.isin(stands_for, reason.samples))
        for reason in rec.quality.reasons
    ]
    for place in range(len(which)):
        yield "; ".join(words for words, there in named if there[place])


def _coordinates(point: NDArray[np.float64]) -> str:
    numbers = ", ".join(f"{c:.5g}" for c in point[:COORDINATES])
    return numbers + (", ..." if len(point) > COORDINATES else "")


def _list(numbers: tuple[int, ...]) -> str:
    return ", ".join(f"{n:,}" for n in numbers)


def how(rec: JudgedReconstruction, command: str | None) -> str:
    """Say how the result was made: parameters, timings, versions, digests, command."""
    origin = rec.provenance
    seconds = [(step.replace("_", " "), number(t)) for step, t in rec.timings.items()]
    total = math.fsum(rec.timings.values())
    versions = [
        ("remanifold", origin.version),
        *origin.versions.items(),
        ("made", origin.created.replace("T", " ")),
    ]
    digests = [("of the samples", origin.input), ("of the result", rec.digest)]
    if "sha256" in origin.source:
        digests.insert(0, (f"of {origin.source['name']}", origin.source["sha256"]))
    if "columns" in origin.source:
        versions.append(("of the columns", origin.source["columns"]))
    halves = "\n".join(
        f"<div><h3>{heading}</h3>\n{rows_table(heading, rows)}</div>"
        for heading, rows in (
            ("Seconds", [*seconds, ("together", number(total))]),
            ("Versions", versions),
        )
    )
    recall = f"Recall of the search: {rec.recall:.3f}." if rec.recall < 1 else ""
    run = command or origin.command or rec.parameters.call()
    return section(
        "how",
        "How it was made",
        f"<h3>Command</h3>\n<pre><code>{text(run)}</code></pre>",
        "<h3>Parameters</h3>",
        grid_table("Parameters", ("name", "value", "why"), rec.parameters.rows()),
        paragraph(recall) if recall else "",
        f'<div class="columns">\n{halves}\n</div>',
        "<h3>Digests</h3>",
        rows_table("Digests", digests),
    )


def mesh(rec: JudgedReconstruction) -> str:
    """Carry the mesh, for a button that hands it out."""
    if rec.vertices is None or len(rec.simplices) == 0:
        return ""
    suffix = suffix_for(rec.dim, rec.vertices.shape[1])
    fields = rec.fields()
    data = mesh_bytes(suffix, rec, fitting_fields(f"a{suffix}", fields))
    if len(data) > MOST_CARRIED:
        return paragraph(
            f"The mesh has {len(data) / 1e6:.0f} MB, too much for this page to carry: "
            f"rec.write() writes it.",
            "faint",
        )
    packed = base64.b64encode(data).decode()
    return (
        f'<div class="controls"><button type="button" id="download" '
        f'data-name="mesh{suffix}">Download the mesh</button>'
        f'<span class="faint">mesh{suffix}, {len(data) / 1e6:.2g} MB, with values at '
        "the vertices</span></div>\n"
        f'<script type="application/octet-stream" id="mesh">{packed}</script>'
    )


def contents() -> Iterator[tuple[str, str]]:
    """Name the sections that can be jumped to."""
    return iter(
        itertools.chain(
            [("picture-of-it", "Picture"), ("topology", "Topology")],
            [("repair", "Repair"), ("openings", "Openings")],
            [("histograms", "Histograms")],
            [("doubt", "Doubt"), ("outliers", "Outliers"), ("how", "How")],
        )
    )
