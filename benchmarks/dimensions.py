# SPDX-License-Identifier: GPL-3.0-or-later
"""How often the intrinsic dimension is found, shape by shape, and of real data.

    python benchmarks/dimensions.py                  # all shapes, four levels of noise
    python benchmarks/dimensions.py --factor 0.25    # a quarter of the samples
    python benchmarks/dimensions.py --others         # manifolds that nothing was tuned on
    python benchmarks/dimensions.py --data FOLDER    # the sets of a folder instead

The thresholds were chosen with the shapes and the sets in view, not with the others.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import remanifold as rm
from command import JsonOption, MarkdownOption, make_app, print_lines, write_report
from other_manifolds import OTHERS, Manifold
from remanifold import datasets
from samples import add_normal_noise
from success_rates import GRIDS, TABLE, Row

MIN_SAMPLES = 12
USUAL = {"fruit_bowl": 3338}  # figure 7 of the paper
# Known dimension of a set by the first word of its file's name.
KNOWN = {
    "curve": 1,
    "highdim": 1,
    "lidar": 2,
    "rawscan": 2,
    "solid": 3,
    "surface": 2,
    "terrain": 2,
    "threemanifold": 3,
}

app = make_app()


def rows() -> list[Row]:
    """Every shape once: those of the success rates, and the others."""
    listed = [*TABLE, *GRIDS[:2]]
    names = {row.shape for row in listed}
    rest = [
        Row(name.replace("_", " "), name, USUAL.get(name, 400 * shape.dim))
        for name, shape in datasets.SHAPES.items()
        if name not in names
    ]
    return [*listed, *rest]


def of_manifolds(
    chosen: Sequence[Row | Manifold], noises: list[float], seeds: int, factor: float
) -> Iterator[dict[str, Any]]:
    for row in chosen:
        dim, has_normals, varies = _about(row)
        count = max(MIN_SAMPLES, round(factor * row.num_samples))
        results: dict[str, Any] = {}
        for noise in noises:
            if noise and not has_normals:
                results[str(noise)] = None
                continue
            found = []
            for seed in range(seeds if varies or noise > 0 else 1):
                points = row.draw(count, seed)
                if noise:
                    points = add_normal_noise(points, dim, noise, seed, row.draw)
                found.append(rm.estimate_dimension(points))
            results[str(noise)] = {
                "right": sum(e.dim == dim for e in found),
                "runs": len(found),
                "dims": [e.dim for e in found],
                "confidence": statistics.median(e.confidence for e in found),
            }
        yield {
            "label": row.label,
            "num_samples": count,
            "dim": dim,
            "noise": results,
        }


def _about(row: Row | Manifold) -> tuple[int, bool, bool]:
    """Dimension, whether that of the space is higher, whether samples are random."""
    if isinstance(row, Manifold):
        return row.dim, True, True
    shape = datasets.SHAPES[row.shape]
    return shape.dim, shape.dim < shape.ambient_dim, row.random


def of_files(folder: Path) -> Iterator[dict[str, Any]]:
    for path in sorted([*folder.glob("*.npz"), *folder.glob("*.npy")]):
        points = rm.io.read_points(path)
        start = time.perf_counter()
        found = rm.estimate_dimension(points)
        yield {
            "label": path.stem.replace("_", " "),
            "num_samples": len(points),
            "ambient_dim": points.shape[1],
            "dim": KNOWN.get(path.stem.split("_")[0]),
            "found": found.dim,
            "confidence": found.confidence,
            "share": float(np.mean(found.per_sample == found.dim)),
            **found.estimates,
            "seconds": time.perf_counter() - start,
        }


def cells_of_shape(record: dict[str, Any]) -> list[tuple[str, str]]:
    cells = [
        ("", record["label"]),
        ("samples", f"{record['num_samples']:,}"),
        ("K", str(record["dim"])),
    ]
    for noise, result in record["noise"].items():
        text = ""
        if result is not None:
            text = f"{result['right']} of {result['runs']}, {result['confidence']:.2f}"
        cells.append((f"noise {noise}", text))
    return cells


def cells_of_file(record: dict[str, Any]) -> list[tuple[str, str]]:
    return [
        ("", record["label"]),
        ("samples", f"{record['num_samples']:,}"),
        ("D", str(record["ambient_dim"])),
        ("K", "?" if record["dim"] is None else str(record["dim"])),
        ("found", str(record["found"])),
        ("confidence", f"{record['confidence']:.2f}"),
        ("of the samples", f"{record['share']:.0%}"),
        ("local PCA", f"{record['local_pca']:.2f}"),
        ("maximum likelihood", f"{record['maximum_likelihood']:.2f}"),
        ("TwoNN", f"{record['two_nn']:.2f}"),
        ("seconds", f"{record['seconds']:.2f}"),
    ]


@app.command()
def main(
    shape: Annotated[
        list[str] | None,
        typer.Option(
            help="Shape by its name; may be repeated.", show_default="all of them"
        ),
    ] = None,
    noise: Annotated[
        list[float] | None,
        typer.Option(
            min=0,
            metavar="TIMES",
            show_default="0, 0.1, 0.25, 0.5",
            help="Normal noise along the normals, its standard deviation in median "
            "distances to the nearest neighbor; may be repeated.",
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Samplings of each shape.")] = 5,
    factor: Annotated[
        float, typer.Option(min=0.01, help="Times the usual numbers of samples.")
    ] = 1.0,
    others: Annotated[
        bool,
        typer.Option("--others", help="Other manifolds than those of the package."),
    ] = False,
    data: Annotated[
        Path | None,
        typer.Option(
            exists=True,
            file_okay=False,
            help="Folder of .npz and .npy files to estimate instead of shapes.",
        ),
    ] = None,
    json_file: JsonOption = None,
    markdown: MarkdownOption = False,
) -> None:
    """Estimate dimensions that are known, and count how many are right."""
    names = [row.name for row in rows()]
    for name in shape or []:
        if name not in names:
            msg = f"{name!r} is not one of {', '.join(map(repr, names))}."
            raise typer.BadParameter(msg, param_hint="'--shape'")
    if data is not None:
        records = list(of_files(data))
        lines = [cells_of_file(record) for record in records]
    else:
        noises = noise or [0.0, 0.1, 0.25, 0.5]
        chosen: Sequence[Row | Manifold] = OTHERS
        if not others:
            chosen = [row for row in rows() if not shape or row.name in shape]
        records = list(of_manifolds(chosen, noises, seeds, factor))
        lines = [cells_of_shape(record) for record in records]
    write_report(
        json_file,
        {"remanifold": rm.__version__, "factor": factor, "results": records},
    )
    if not lines:
        typer.echo("no data", err=True)
        raise typer.Exit(1)
    print_lines(lines, markdown=markdown)


if __name__ == "__main__":
    app()
