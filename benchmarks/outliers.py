# SPDX-License-Identifier: GPL-3.0-or-later
"""Outliers: how many good samples are lost, and how much of uniform clutter is found.

    python benchmarks/outliers.py                       # the shapes, one sampling each
    python benchmarks/outliers.py --shape torus --samples 20000 --seeds 3
    REMANIFOLD_DATA=... python benchmarks/outliers.py --shape none   # the sets alone

Clutter is uniform in a box twice as wide as the samples' in each coordinate. Of it that
counts which is more than two local scales off: the distance to the nearest sample, less
half a scale along the manifold, in units of the median distance there to the (2K+2)-th
neighbor. Sets are those in REMANIFOLD_DATA (NPZ files with an array ``points``) that hold
no outliers as they come.
"""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from scipy.spatial import cKDTree

import remanifold as rm
from command import JsonOption, MarkdownOption, gather, make_app, print_lines
from noise_ladder import with_outliers
from remanifold import datasets

SHARES = (0.01, 0.05, 0.2)
SAMPLES = (2_000, 20_000)
LEAST = 2.0  # local scales off the shape from which clutter is to be found
SHAPES = (
    *("torus", "sphere", "double_torus", "uneven_torus", "klein_bottle"),
    *("trefoil", "swiss_roll", "sphere_3"),
)
SETS = {
    "boundary_carotid_poisson12k": 2,
    "boundary_seven_holes_vertices": 2,
    "boundary_torso_7_parts": 2,
    "cad_cheese_genus133_vertices": 2,
    "curve_coastline_british_isles_in_R2": 1,
    "curve_contours_350m_in_R2": 1,
    "surface_cortex_left_vertices": 2,
    "surface_fish_blub_vertices": 2,
    "surface_human_vertices": 2,
    "surface_rocker_arm_genus1_poisson10k": 2,
    "surface_rocker_arm_genus1_uniform10k": 2,
    "surface_rocker_arm_genus1_vertices": 2,
    "surface_skull_genus2_vertices": 2,
    "surface_spot_cow_poisson6k": 2,
    "surface_spot_cow_vertices": 2,
    "surface_stanford_bunny_uniform12k": 2,
    "surface_stanford_bunny_vertices": 2,
    "surface_wingnut_creases_vertices": 2,
    "terrain_dem_grid": 2,
    "terrain_mountain_disc_vertices": 2,
    "threemanifold_SO3_in_R9": 3,
}

app = make_app()


def scales_off(positions: Any, points: Any, dim: int) -> Any:
    """Distances to the manifold of the points, in local scales."""
    tree = cKDTree(points)
    count = 2 * dim + 2
    reach = tree.query(points, count + 1)[0][:, -1]
    far, near = tree.query(positions, count)
    scale = np.median(reach[near], axis=1)
    return np.sqrt(np.maximum(far[:, 0] ** 2 - (scale / 2) ** 2, 0)) / scale


def counts(points: Any, dim: int, share: float, seed: int) -> tuple[int, int, int]:
    """Clutter to be found, what of it is, and samples lost."""
    both, strewn = with_outliers(points, share, seed)
    far = strewn.copy()
    if strewn.any():
        far[strewn] = scales_off(both[strewn], points, dim) > LEAST
    found = np.zeros(len(both), dtype=bool)
    found[rm.find_outliers(both, dim, num_threads=1)] = True
    return int(far.sum()), int((found & far).sum()), int((found & ~strewn).sum())


def record_of(name: str, samplings: Sequence[Any], dim: int) -> dict[str, Any]:
    """Counts over all samplings, without clutter and with each share of it."""
    start = time.process_time()
    record: dict[str, Any] = {"name": name, "num_samples": len(samplings[0])}
    for share in (0.0, *SHARES):
        runs = [counts(p, dim, share, seed) for seed, p in enumerate(samplings)]
        record[f"{share:g}"] = [sum(column) for column in zip(*runs, strict=True)]
    return {**record, "seconds": time.process_time() - start}


def cells_of(record: dict[str, Any]) -> list[tuple[str, str]]:
    cells = [("", record["name"]), ("samples", f"{record['num_samples']:,}")]
    cells.append(("lost", f"{record['0'][2]:,}"))
    for share in SHARES:
        far, found, lost = record[f"{share:g}"]
        cells.append((f"of {share:.0%} found", f"{found / max(far, 1):.1%}"))
        cells.append(("lost", f"{lost:,}"))
    return cells


def all_records(
    shapes: Sequence[str], sizes: Sequence[int], seeds: int
) -> Iterator[dict[str, Any]]:
    for name in shapes:
        shape = datasets.SHAPES[name]
        for size in sizes:
            drawn = [shape.generate(size, random_state=seed) for seed in range(seeds)]
            yield record_of(name, drawn, shape.dim)
    folder = os.environ.get("REMANIFOLD_DATA")
    for name, dim in SETS.items() if folder else ():
        with np.load(Path(str(folder)) / f"{name}.npz") as data:
            points = data["points"].astype(np.float64)
        yield record_of(name, [points] * seeds, dim)


@app.command()
def main(
    shape: Annotated[
        list[str] | None,
        typer.Option(help="Name of a shape, or none; may be repeated."),
    ] = None,
    samples: Annotated[
        list[int] | None,
        typer.Option(min=100, help="Samples of each shape; may be repeated."),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Samplings of each shape.")] = 1,
    json_file: JsonOption = None,
    markdown: MarkdownOption = False,
) -> None:
    """Count good samples that are lost, and clutter that is found."""
    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    shapes = [name for name in shape or SHAPES if name != "none"]
    sizes = samples or SAMPLES
    total = len(shapes) * len(sizes)
    total += len(SETS) if os.environ.get("REMANIFOLD_DATA") else 0
    records = all_records(shapes, sizes, seeds)
    about = {"remanifold": rm.__version__, "seeds": seeds}
    gathered = gather(records, total, "lines", json_file, about)
    print_lines([cells_of(record) for record in gathered], markdown=markdown)


if __name__ == "__main__":
    app()
