# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the constants of openings by evidence come from, and how often it is right.

    python benchmarks/openings.py constants            # what openings.cpp has
    python benchmarks/openings.py closed               # false openings against N
    python benchmarks/openings.py holes                # false closings against N
    python benchmarks/openings.py soak --runs 300      # random families

Samples are drawn independently (random), evenly (a lattice moved at random by a fifth of
its spacing, as blue noise has no gaps either), on a plain lattice, or graded (density
changing tenfold), on tori of K dimensions that are closed by Fourier coordinates.
"""

from __future__ import annotations

import json
import math
import os
import warnings
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

import remanifold as rm
from command import JobsOption, JsonOption, MarkdownOption, TimeLimitOption, make_app
from families import OPENINGS, SIMPLICES, Family
from processes import Failure, run_all

KINDS = ("random", "even", "lattice", "graded")
# The smallest N at which a torus of Fourier coordinates is sampled densely enough.
SIZES = {1: (100, 1000, 10_000), 2: (400, 2000, 10_000), 3: (2500, 6000)}
LEVELS = (0.1, 0.01, 0.001)
# As in cpp/src/chain/openings.cpp: the radius of large simplices over the inner scale, clusters a sample with a weight above w: rate * exp(-decay * w).
LARGE = {1: 0.5, 2: 1.2, 3: 1.2}
RATE = {1: 0.15, 2: 0.016, 3: 0.0021}
DECAY = {1: 0.95, 2: 0.70, 3: 0.72}

app = make_app()


# --- Samples --------------------------------------------------------------------------


def cube(kind: str, dim: int, num: int, seed: int) -> Any:
    """Samples of [0, 1)^K, about so many."""
    rng = np.random.default_rng(seed)
    if kind in ("random", "graded"):
        points = rng.random((num, dim))
        if kind == "graded":
            # Density from 1 to 10 and back, along the first coordinate.
            grid = np.linspace(0, 1, 2001)
            density = 10 ** (0.5 - 0.5 * np.cos(2 * np.pi * grid))
            total = np.concatenate([[0], np.cumsum(density[:-1] + density[1:])])
            points[:, 0] = np.interp(points[:, 0], total / total[-1], grid)
        return points
    width = max(3, round(num ** (1 / dim)))
    axes = np.meshgrid(*[np.arange(width)] * dim, indexing="ij")
    points = np.stack(axes, axis=-1).reshape(-1, dim).astype(float)
    if kind == "even":
        points += rng.uniform(-0.2, 0.2, size=points.shape)
    return points / width % 1.0


def torus(points: Any) -> Any:
    """[0, 1)^K with its ends joined, flat, in R^(2 K)."""
    angles = 2 * np.pi * points
    return np.concatenate([np.cos(angles), np.sin(angles)], axis=1)


# --- Runs -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Task:
    kind: str
    dim: int
    num: int
    seed: int
    missing: float = 0.0


@dataclass(frozen=True)
class Outcome:
    num: int
    right: bool
    opened: bool
    doubted: bool
    significances: tuple[float, ...]
    expected: tuple[float, ...]


def assess(task: Task) -> Outcome:
    """A closed torus, or one with a ball of so many samples taken out."""
    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    points = cube(task.kind, task.dim, task.num, task.seed)
    if task.missing > 0:
        away = np.abs(points - 0.5)
        volume = {1: 2.0, 2: math.pi, 3: 4 / 3 * math.pi}[task.dim]
        radius = (task.missing / len(points) / volume) ** (1 / task.dim)
        points = points[np.linalg.norm(away, axis=1) > radius]
    rec = rm.reconstruct(
        torus(points), task.dim, smooth=False, outliers=False, num_threads=1
    )
    topology = rec.topology()
    opened = not topology.closed
    holes = 1 if task.dim > 1 else 2  # an arc has two ends
    right = topology.manifold and topology.components == 1
    right &= topology.boundary_components == (holes if task.missing > 0 else 0)
    return Outcome(
        num=len(points),
        right=bool(right),
        opened=opened,
        doubted=not rec.quality.ok,
        significances=tuple(one.significance for one in rec.openings),
        expected=tuple(one.expected for one in rec.openings),
    )


def outcomes_of(tasks: list[Task], jobs: int | None, limit: float) -> Any:
    say = Console(stderr=True, soft_wrap=True, highlight=False)
    for task, result in run_all(assess, tasks, jobs or os.cpu_count() or 1, limit):
        if isinstance(result, Failure):
            say.print(f"{task}: {result.reason}", markup=False)
        else:
            yield task, result


def show(heads: list[str], rows: list[list[str]], *, markdown: bool) -> None:
    if markdown:
        lines = [heads, ["---:"] * len(heads), *rows]
        typer.echo("\n".join(f"| {' | '.join(line)} |" for line in lines))
        return
    table = Table(box=None, pad_edge=False)
    for head in heads:
        table.add_column(head, justify="right")
    for row in rows:
        table.add_row(*row)
    Console(highlight=False).print(table)


# --- The constants --------------------------------------------------------------------


def volumes_of(simplices: Any, points: Any) -> tuple[Any, Any]:
    """Volumes and circumradii."""
    edges = points[simplices[:, 1:]] - points[simplices[:, :1]]
    gram = edges @ edges.transpose(0, 2, 1)
    dim = edges.shape[1]
    squares = np.linalg.det(gram)
    volumes = np.sqrt(np.maximum(squares, 0)) / math.factorial(dim)
    good = volumes > 1e-12 * volumes.max()
    half = np.einsum("nii->ni", gram[good]) / 2
    weights = np.linalg.solve(gram[good], half[:, :, None])[:, :, 0]
    radii = np.full(len(simplices), np.inf)
    radii[good] = np.sqrt(np.maximum((weights * half).sum(axis=1), 0))
    return volumes, radii


def inner_scales(points: Any, dim: int) -> Any:
    """As OpeningFinder::inner_scale does."""
    rank = 10 if dim == 1 else 2 * dim + 2
    count = rank if dim == 1 else 3 * rank
    near = rm.neighborhoods(points, count, num_threads=1)
    scale = near.distances[:, rank - 1]
    around = np.concatenate([scale[:, None], scale[near.indices]], axis=1)
    return np.partition(around, int(0.25 * count), axis=1)[:, int(0.25 * count)]


def _with_error(decay: float, count: int, chosen: float) -> str:
    return f"{decay:.2f} ± {decay / math.sqrt(max(count, 1)):.2f} ({chosen:.2f})"


@app.command()
def constants(
    seeds: Annotated[int, typer.Option(min=1)] = 40,
    num: Annotated[int, typer.Option(min=100, help="Samples for each K.")] = 3000,
    dims: Annotated[list[int] | None, typer.Option("--dim")] = None,
    markdown: MarkdownOption = False,
) -> None:
    """Measure on closed random tori what openings.cpp takes for chance."""
    rows = []
    for dim in dims or (1, 2, 3):
        variations, large_shares, per_sample = [], [], []
        weights: list[float] = []
        for seed in range(seeds):
            points = torus(cube("random", dim, num, 1000 + seed))
            rec = rm.reconstruct(
                points,
                dim,
                significance=0.0,
                smooth=False,
                outliers=False,
                num_threads=1,
            )
            volumes, radii = volumes_of(np.sort(rec.simplices, axis=1), points)
            inner = inner_scales(points, dim)[rec.simplices].mean(axis=1)
            large = radii > LARGE[dim] * inner
            small = volumes[~large]
            variations.append(small.var() / small.mean() ** 2)
            large_shares.append(large.mean())
            per_sample.append(len(volumes) / num)
            # The weight that gave rise to what is listed as expected.
            weights += [
                -math.log(one.expected / (num * RATE[dim])) / DECAY[dim]
                for one in rec.openings
                if one.expected > 0
            ]
        # Independent excesses over a threshold: the mean excess is 1 / decay.
        least = math.log(num * RATE[dim]) / DECAY[dim]
        tail = np.array([w for w in weights if w >= least])
        decay = 1 / (tail - least).mean() if len(tail) else math.nan
        rate = len(tail) / (seeds * num) * math.exp(decay * least)
        rows.append(
            [
                str(dim),
                f"{np.mean(per_sample):.3f} ({SIMPLICES[dim]:.3f})",
                f"{np.mean(large_shares):.3f}",
                f"{np.mean(variations):.2f}",
                f"{rate:.2g} ({RATE[dim]:.2g})",
                _with_error(decay, len(tail), DECAY[dim]),
                f"{len(tail) / seeds:.2f}",
            ]
        )
    heads = ["K", "simplices a sample", "large", "variation", "rate", "decay"]
    heads += ["listed a data set (1 expected)"]
    show(heads, rows, markdown=markdown)


# --- False openings -------------------------------------------------------------------


@app.command()
def closed(
    seeds: Annotated[int, typer.Option(min=1)] = 50,
    dims: Annotated[list[int] | None, typer.Option("--dim")] = None,
    kinds: Annotated[list[str] | None, typer.Option("--kind")] = None,
    sizes: Annotated[list[int] | None, typer.Option("--num")] = None,
    jobs: JobsOption = None,
    time_limit: TimeLimitOption = 600.0,
    json_file: JsonOption = None,
    markdown: MarkdownOption = False,
) -> None:
    """Count data sets without openings in which one is found at each level."""
    rows, records = [], []
    for dim in dims or (1, 2, 3):
        for kind in kinds or KINDS:
            for num in sizes or SIZES[dim]:
                tasks = [Task(kind, dim, num, 5000 + i) for i in range(seeds)]
                found = [o for _, o in outcomes_of(tasks, jobs, time_limit)]
                least = np.array([min(o.significances, default=1.0) for o in found])
                shares = [float((least <= level).mean()) for level in LEVELS]
                record = {
                    "dim": dim,
                    "kind": kind,
                    "num": num,
                    "runs": len(found),
                    "below": dict(zip(map(str, LEVELS), shares, strict=True)),
                    "opened": sum(o.opened for o in found),
                    "right": sum(o.right for o in found),
                    "doubted": sum(o.doubted and o.right for o in found),
                }
                records.append(record)
                rows.append(
                    [str(dim), kind, f"{num:,}", str(len(found))]
                    + [f"{share:.3f}" for share in shares]
                    + [str(record["opened"]), str(record["doubted"])]
                )
                if json_file is not None:
                    json_file.write_text(json.dumps(records, indent=2) + "\n")
    heads = ["K", "samples", "N", "runs", *(f"at {level:g}" for level in LEVELS)]
    heads += ["opened", "doubted"]
    show(heads, rows, markdown=markdown)


# --- False closings -------------------------------------------------------------------


@app.command()
def holes(
    seeds: Annotated[int, typer.Option(min=1)] = 20,
    dims: Annotated[list[int] | None, typer.Option("--dim")] = None,
    kinds: Annotated[list[str] | None, typer.Option("--kind")] = None,
    jobs: JobsOption = None,
    time_limit: TimeLimitOption = 600.0,
    markdown: MarkdownOption = False,
) -> None:
    """Count how often a hole with so many samples missing is left open."""
    missing = (5, 10, 15, 20, 30, 40)
    rows = []
    for dim in dims or (1, 2, 3):
        for kind in kinds or KINDS[:2]:
            for num in SIZES[dim][:2]:
                cells = []
                for count in missing:
                    tasks = [
                        Task(kind, dim, num, 7000 + i, float(count))
                        for i in range(seeds)
                    ]
                    found = [o for _, o in outcomes_of(tasks, jobs, time_limit)]
                    right = sum(o.right for o in found) / max(1, len(found))
                    silent = sum(not o.right and not o.doubted for o in found)
                    cells.append(f"{right:.0%} ({silent})")
                rows.append([str(dim), kind, f"{num:,}", *cells])
    heads = ["K", "samples", "N", *(f"{count} missing" for count in missing)]
    show(heads, rows, markdown=markdown)


# --- A soak ---------------------------------------------------------------------------


def family(seed: int) -> Family:
    """One of the families, its sizes, gap, evenness and noise drawn by the seed."""
    rng = np.random.default_rng(seed)
    name = str(rng.choice(list(OPENINGS)))
    gap = float(np.exp(rng.uniform(0, np.log(30))))  # spacings
    noise = float(rng.choice([0.0, 0.0, 0.1, 0.3, 0.5]))
    kind = str(rng.choice(["random", "random", "even"]))
    made = OPENINGS[name](rng, gap, kind)
    spacing = np.median(rm.neighborhoods(made.points, 1, num_threads=1).distances)
    points = made.points + noise * spacing * rng.normal(size=made.points.shape)
    label = f"{name}, gap {gap:.1f}, {kind}, noise {noise:g}, N {len(points)}"
    return replace(made, name=label, points=points)


@dataclass(frozen=True)
class Run:
    name: str
    right: bool
    doubted: bool
    decidable: bool
    said: str


def one_run(seed: int) -> Run:
    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    made = family(seed)
    rec = rm.reconstruct(made.points, made.dim, num_threads=1)
    found = rec.topology()
    true = made.truth.betti_numbers
    right = found.manifold and found.betti_numbers == true
    said = f"{found.betti_numbers}, not {true}"
    return Run(made.name, bool(right), not rec.quality.ok, made.shows_it, said)


@app.command()
def soak(
    runs: Annotated[int, typer.Option(min=1)] = 300,
    first_seed: Annotated[int, typer.Option(min=0)] = 100_000,
    jobs: JobsOption = None,
    time_limit: TimeLimitOption = 120.0,
    markdown: MarkdownOption = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Name what is wrong in silence.")
    ] = False,
) -> None:
    """Random families: gaps of 1 to 30 spacings, even or not, noise, small parts."""
    say = Console(stderr=True, soft_wrap=True, highlight=False)
    counts: dict[str, np.ndarray] = {}
    seeds = list(range(first_seed, first_seed + runs))
    for seed, result in run_all(
        one_run, seeds, jobs or os.cpu_count() or 1, time_limit
    ):
        if isinstance(result, Failure):
            say.print(f"seed {seed}: {result.reason}", markup=False)
            continue
        name = result.name.partition(",")[0]
        row = counts.setdefault(name, np.zeros(6, dtype=int))
        row += [
            1,
            result.right,
            result.right and result.doubted,
            not result.right,
            not result.right and not result.doubted,
            not result.right and not result.doubted and result.decidable,
        ]
        if verbose and not result.right and not result.doubted and result.decidable:
            say.print(f"seed {seed}: {result.name}: {result.said}", markup=False)
    rows = [[name, *map(str, counts[name])] for name in OPENINGS if name in counts]
    rows.append(["all", *map(str, sum(counts.values()))])
    heads = ["family", "runs", "right", "of these doubted", "wrong", "and silent"]
    heads += ["though data shows it"]
    show(heads, rows, markdown=markdown)


if __name__ == "__main__":
    app()
