# SPDX-License-Identifier: GPL-3.0-or-later
"""Reconstructions from samples with noise of many spacings: right, how far off, how dear.

    python benchmarks/noise.py                              # the table, 5 seeds each
    python benchmarks/noise.py --shape torus --levels 4 --samples 20000
    python benchmarks/noise.py --shape torus --best         # beside the best size

Noise is normal and independent in each coordinate, its standard deviation in median
distances to the nearest neighbor. Distances to the true manifold are in the same unit, as
the root of the mean square. CPU is that of the reconstruction over that of the exact
search for 20 neighbors, one thread each. Right is what judge.py says. Every run has a
process of its own.
"""

from __future__ import annotations

import functools
import math
import os
import statistics
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Annotated, Any

import numpy as np
import typer

import remanifold as rm
from command import (
    JobsOption,
    JsonOption,
    MarkdownOption,
    TimeLimitOption,
    gather,
    make_app,
    one_of,
    print_lines,
)
from judge import judge
from processes import over_all_seeds
from remanifold import datasets
from samples import distances_to_planes, distances_to_torus, spacing

LEVELS = (0.1, 0.5, 1.0, 2.0, 4.0)
SAMPLES = (5_000, 20_000, 50_000)
SEARCHED = 20  # neighbors of the search that CPU is compared with
SEARCHES = 3  # the least of which counts
DENSE = 60_000  # samples whose planes stand for a manifold without a formula
SIZES = 2.0 ** np.arange(-2.0, 2.1, 0.5)  # of neighborhoods, beside the chosen one
SHAPES = {
    **datasets.SHAPES,
    "flat_torus_in_20": datasets.Shape(
        partial(datasets.flat_torus, ambient_dim=20), 2, 20, (1, 2, 1)
    ),
}
TABLE = {
    "circle": "circle in R^2",
    "trefoil": "trefoil in R^3",
    "sphere": "sphere in R^3",
    "torus": "torus in R^3",
    "klein_bottle": "Klein bottle in R^4",
    "flat_torus_in_20": "flat torus in R^20",
    "flat_torus_in_100": "flat torus in R^100",
    "spherical_cap": "spherical cap in R^3",
    "moebius_band": "Moebius band in R^3",
    "annulus_in_4": "annulus in R^4",
    "sphere_3": "3-sphere in R^4",
    "flat_torus_3": "3-torus in R^6",
}

app = make_app()


# ------------------------------------------------------------------ the true manifold


def distances(positions: Any, name: str, points: Any) -> Any:
    """Distances along the normals to the manifold that ``points`` lie on exactly."""
    if name == "torus":
        return distances_to_torus(positions)
    if name in ("circle", "sphere", "sphere_3", "spherical_cap"):
        return np.abs(np.linalg.norm(positions, axis=1) - 1.0)
    if name.startswith("flat_torus"):
        return _to_flat_torus(positions, name, points)
    if name == "annulus_in_4":
        plane = np.linalg.svd(points, full_matrices=False)[2][:2]
        return np.linalg.norm(positions - positions @ plane.T @ plane, axis=1)
    shape = SHAPES[name]
    dense = shape.generate(DENSE, random_state=12_345)
    return distances_to_planes(
        positions, shape.dim, dense, 60 * shape.dim, 8 * shape.dim
    )


def _to_flat_torus(positions: Any, name: str, points: Any) -> Any:
    """Embedded by a linear map of the seed, which the first samples tell."""
    dim = SHAPES[name].dim
    flat, off = positions, 0.0
    if points.shape[1] > 2 * dim:
        span = np.linalg.svd(points, full_matrices=False)[2][: 2 * dim]
        planes = _planes_of_circles(points @ span.T, dim)
        flat = positions @ span.T @ planes.T
        off = np.linalg.norm(positions - positions @ span.T @ span, axis=1)
    radii = np.linalg.norm(flat.reshape(len(flat), dim, 2), axis=2)
    return np.sqrt(off**2 + ((radii - 1) ** 2).sum(axis=1))


def _planes_of_circles(coordinates: Any, dim: int) -> Any:
    """An orthonormal basis, two rows a circle, of a flat torus in R^(2 dim).

    Products of coordinates of one circle are what quadratic forms are constant on the
    torus: those of their squared radii, whose common eigenspaces are the planes.
    """
    size = 2 * dim
    first, second = np.triu_indices(size)
    terms = coordinates[:, first] * coordinates[:, second]
    _, values, rows = np.linalg.svd(terms - terms.mean(axis=0), full_matrices=False)
    constant = rows[values < 1e-6 * values[0]]
    rng = np.random.default_rng(0)
    mixed = np.zeros((size, size))
    mixed[first, second] = rng.normal(size=len(constant)) @ constant
    _, planes = np.linalg.eigh(mixed + mixed.T)
    return planes.T


# ---------------------------------------------------------------------------- one run


@dataclass(frozen=True)
class Task:
    name: str
    num_samples: int
    level: float
    seed: int
    smooth: str = "auto"
    best: bool = False
    time_limit: float = math.inf


@dataclass(frozen=True)
class Outcome:
    """Reasons of failure, none for a success; distances in nearest-neighbor distances."""

    reasons: tuple[str, ...]
    cpu: float = math.nan
    samples_off: float = math.nan
    vertices_off: float = math.nan
    over_best: float = math.nan  # distance over that of the best size
    told: bool = False  # a wrong result that says so


def measure(task: Task) -> Outcome:
    """Draw, disturb, reconstruct and judge. Runs in a process of its own."""
    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    shape = SHAPES[task.name]
    true = shape.generate(task.num_samples, random_state=task.seed)
    unit = spacing(true)
    rng = np.random.default_rng(task.seed + 1000)
    points = true + rng.normal(0.0, task.level * unit, true.shape)

    def off(positions: Any) -> float:
        far = distances(positions, task.name, true)
        return float(np.sqrt(np.mean(far**2)) / unit)

    def search() -> Any:
        return rm.neighborhoods(points, SEARCHED, num_threads=1)

    smooth: Any = False if task.smooth == "no" else task.smooth
    exact = min(_cpu_of(search)[0] for _ in range(SEARCHES))
    cpu, rec = _cpu_of(
        lambda: rm.reconstruct(points, shape.dim, smooth=smooth, num_threads=1)
    )
    used = np.unique(rec.simplices)
    attached = len(getattr(rec, "attached", ()))
    reasons = tuple(
        judge(rec.simplices, rec.topology(), task.num_samples - attached, shape)
    )
    kept = np.ones(task.num_samples, dtype=bool)
    kept[rec.outliers] = False
    own = off(rec.vertices[kept])
    over_best = math.nan
    if task.best and rec.smoothing is not None and rec.smoothing.moved:
        sizes = np.unique((rec.smoothing.num_neighbors * SIZES).astype(int))
        sizes = sizes[(sizes > shape.dim) & (sizes < task.num_samples)]
        over_best = own / min(
            off(rm.smooth(points, shape.dim, int(size), num_threads=1).points[kept])
            for size in sizes
        )
    return Outcome(
        reasons,
        cpu / exact,
        off(points),
        own if len(used) else math.nan,
        over_best,
        bool(reasons) and (not rec.quality.ok or not rec.topology().manifold),
    )


def _cpu_of(work: Callable[[], Any]) -> tuple[float, Any]:
    start = time.process_time()
    result = work()
    return time.process_time() - start, result


# -------------------------------------------------------------------------- the table


def record_of(task: Task, seeds: int, jobs: int) -> dict[str, Any]:
    """The runs of all seeds of a line of the table."""
    outcomes = over_all_seeds(
        measure, task, seeds, jobs, lambda failure: Outcome((failure.reason,))
    )

    def over_seeds(name: str) -> float | None:
        values = [getattr(o, name) for o in outcomes.values()]
        values = [value for value in values if math.isfinite(value)]
        return float(statistics.median(values)) if values else None

    return {
        "name": task.name,
        "num_samples": task.num_samples,
        "level": task.level,
        "right": sum(not o.reasons for o in outcomes.values()),
        "told": sum(o.told for o in outcomes.values()),
        "runs": len(outcomes),
        "samples_off": over_seeds("samples_off"),
        "vertices_off": over_seeds("vertices_off"),
        "over_best": over_seeds("over_best"),
        "cpu": over_seeds("cpu"),
        "outcomes": {str(seed): asdict(o) for seed, o in sorted(outcomes.items())},
    }


def tasks_of(
    names: Sequence[str],
    samples: Sequence[int],
    levels: Sequence[float],
    smooth: str,
    best: bool,
    time_limit: float,
) -> Iterator[Task]:
    for name in names:
        for count in samples:
            for level in levels:
                yield Task(name, count, level, 0, smooth, best, time_limit)


def cells_of(record: dict[str, Any], best: bool) -> list[tuple[str, str]]:
    """Heads and cells of a line of the table."""
    wrong = record["runs"] - record["right"]
    told = f" ({record['told']} of {wrong} said so)" if wrong else ""
    cells = [
        ("", TABLE[record["name"]]),
        ("samples", f"{record['num_samples']:,}"),
        ("noise", f"{record['level']:g}"),
        ("right", f"{record['right']} of {record['runs']}{told}"),
        ("samples off", _number(record["samples_off"])),
        ("vertices off", _number(record["vertices_off"])),
    ]
    if best:
        cells.append(("over the best", _number(record["over_best"])))
    return [*cells, ("CPU", _number(record["cpu"], 1))]


def _number(value: float | None, digits: int = 2) -> str:
    return "" if value is None else f"{value:.{digits}f}"


@app.command()
def main(
    shape: Annotated[
        list[str] | None,
        typer.Option(
            help="Row of the table by the name of its shape; may be repeated.",
            show_default="all",
            callback=lambda names: one_of(list(TABLE))(names or []),
        ),
    ] = None,
    samples: Annotated[
        list[int] | None,
        typer.Option(
            min=1,
            show_default="5000, 20000, 50000",
            help="Number of samples; may be repeated.",
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Samplings of each shape.")] = 5,
    levels: Annotated[
        list[float] | None,
        typer.Option(
            min=0,
            metavar="TIMES",
            show_default="0.1, 0.5, 1, 2, 4",
            help="Noise in each coordinate, in median distances to the nearest "
            "neighbor; may be repeated.",
        ),
    ] = None,
    smooth: Annotated[
        str,
        typer.Option(
            metavar="[auto|no]",
            help="What is done about it.",
            callback=one_of(["auto", "no"]),
        ),
    ] = "auto",
    best: Annotated[
        bool,
        typer.Option(
            "--best",
            help="Compare with the best size that knowing the truth would tell.",
        ),
    ] = False,
    jobs: JobsOption = None,
    time_limit: TimeLimitOption = 600.0,
    json_file: JsonOption = None,
    markdown: MarkdownOption = False,
) -> None:
    """Count right reconstructions from noisy samples, and measure how far off they are."""
    tasks = list(
        tasks_of(
            shape or list(TABLE),
            samples or SAMPLES,
            levels or LEVELS,
            smooth,
            best,
            time_limit,
        )
    )
    measured = functools.partial(
        record_of, seeds=seeds, jobs=jobs or os.cpu_count() or 1
    )
    about = {"remanifold": rm.__version__, "seeds": seeds, "smooth": smooth}
    records = gather(map(measured, tasks), len(tasks), "lines", json_file, about)
    lines = [cells_of(record, best) for record in records]
    print_lines(lines, markdown=markdown)


if __name__ == "__main__":
    app()
