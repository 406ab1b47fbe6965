# SPDX-License-Identifier: GPL-3.0-or-later
"""Reconstructions from noisy samples, level by level, and among outliers.

    python benchmarks/noise_ladder.py                        # four levels, 20 seeds each
    python benchmarks/noise_ladder.py --smooth no            # beside it: not smoothed
    python benchmarks/noise_ladder.py --shape torus --seeds 3 --peers
    python benchmarks/noise_ladder.py --levels 0 --outliers 0.05 --outliers 0.2

Noise is normal, along the normals, its standard deviation in each normal direction in
median distances to the nearest neighbor. Distances to the true manifold are in the same
unit, as the root of the mean square. Right is what judge.py says, samples that are not
outliers counted alone. Every run has a process of its own.
"""

from __future__ import annotations

import functools
import math
import os
import statistics
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
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
from processes import Failure, over_all_seeds, run_command
from remanifold import datasets
from samples import add_normal_noise, distances_to_planes, distances_to_torus, spacing
from side_by_side import DRIVERS
from success_rates import Row

TABLE = (
    Row("torus in R^3", "torus", 3000),
    Row("Klein bottle in R^4", "klein_bottle", 4000),
    Row("trefoil in R^3", "trefoil", 1500),
    Row("flat torus in R^100", "flat_torus_in_100", 3000),
    Row("SO(3) in R^9", "rotations", 4000),
)
LEVELS = (0.1, 0.25, 0.5, 1.0)
DENSE = 60_000  # samples whose planes stand for a manifold without a formula
PEERS = {"poisson": "Poisson", "scale_space": "scale space"}
PEERS_ON = "torus"  # the only surface in R^3 of the table

app = make_app()


# ------------------------------------------------------- samples and the true manifold


def add_noise(points: Any, row: Row, level: float, seed: int) -> Any:
    if level == 0:
        return points
    if row.shape != "flat_torus_in_100":
        dim = datasets.SHAPES[row.shape].dim
        return add_normal_noise(points, dim, level, seed, row.draw)
    # Embedded at random, for every seed anew: more samples would not be of this torus.
    flat, embedding = _flat_torus(points, seed)
    x, y, z, w = flat.T
    zero = np.zeros_like(x)
    turns = np.stack([[-y, x, zero, zero], [zero, zero, -w, z]]).transpose(2, 0, 1)
    tangents = turns @ embedding
    tangents /= np.linalg.norm(tangents, axis=2, keepdims=True)
    rng = np.random.default_rng(seed)
    moves = rng.normal(0.0, level * spacing(points), points.shape)
    along = np.einsum("nkd,nd->nk", tangents, moves)
    return points + moves - np.einsum("nkd,nk->nd", tangents, along)


def _flat_torus(points: Any, seed: int) -> tuple[Any, Any]:
    """The same samples in R^4, and the linear map from there."""
    flat = datasets.flat_torus(len(points), random_state=seed)
    embedding = np.linalg.lstsq(flat, points, rcond=None)[0]
    if np.abs(flat @ embedding - points).max() > 1e-9:
        msg = "the embedded torus is not that of the seed"
        raise RuntimeError(msg)
    return flat, embedding


def distances(positions: Any, row: Row, points: Any, seed: int) -> Any:
    """Distances to the manifold that ``points`` lie on exactly."""
    if row.shape == "torus":
        return distances_to_torus(positions)
    if row.shape == "flat_torus_in_100":
        _, embedding = _flat_torus(points, seed)
        flat = positions @ np.linalg.pinv(embedding)
        first, second = np.hypot(flat[:, 0], flat[:, 1]), np.hypot(*flat[:, 2:].T)
        off = np.linalg.norm(positions - flat @ embedding, axis=1)
        return np.sqrt(off**2 + (first - 1) ** 2 + (second - 1) ** 2)
    if row.shape == "rotations":  # the nearest one by the singular vectors
        matrices = positions.reshape(-1, 3, 3)
        left, _, right = np.linalg.svd(matrices)
        left[:, :, 2] *= np.sign(np.linalg.det(left @ right))[:, None]
        return np.linalg.norm((matrices - left @ right).reshape(-1, 9), axis=1)
    dim = datasets.SHAPES[row.shape].dim
    dense = row.draw(DENSE, 12_345)
    return distances_to_planes(positions, dim, dense, 40 * dim, 10 * dim)


def with_outliers(points: Any, share: float, seed: int) -> tuple[Any, Any]:
    """Shuffled among uniform outliers in twice the bounding box, and which those are."""
    rng = np.random.default_rng(seed + 77)
    low, high = points.min(axis=0), points.max(axis=0)
    num = round(share * len(points))
    strewn = (low + high) / 2 + (rng.random((num, points.shape[1])) - 0.5) * 2 * (
        high - low
    )
    order = rng.permutation(len(points) + num)
    return np.vstack([points, strewn])[order], order >= len(points)


# ------------------------------------------------------------------------ one run


@dataclass(frozen=True)
class Task:
    row: Row
    level: float
    outliers: float
    seed: int
    smooth: str
    peer: str | None = None
    driver: str | None = None
    time_limit: float = math.inf


@dataclass(frozen=True)
class Outcome:
    """Reasons of failure, none for a success; distances in nearest-neighbor distances."""

    reasons: tuple[str, ...]
    seconds: float = math.nan
    samples_off: float = math.nan
    vertices_off: float = math.nan
    outliers: int = 0
    outliers_found: int = 0  # said to be outliers, or in no simplex
    samples_lost: int = 0  # that are no outliers, but in no simplex


def measure(task: Task) -> Outcome:
    """Draw, disturb, reconstruct and judge. Runs in a process of its own."""
    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    row, shape = task.row, datasets.SHAPES[task.row.shape]
    true = row.draw(row.num_samples, task.seed)
    noisy = add_noise(true, row, task.level, task.seed)
    points, strewn = with_outliers(noisy, task.outliers, task.seed)
    unit = spacing(true)

    def off(positions: Any) -> float:
        far = distances(positions, row, true, task.seed)
        return float(np.sqrt(np.mean(far**2)) / unit)

    start = time.perf_counter()
    if task.peer is not None:
        positions, found = PEER_RUNS[task.peer](points, task)
        seconds = time.perf_counter() - start
        found = np.unique(np.sort(found, axis=1), axis=0).astype(np.int32)
        topology = rm.compute_topology(found, len(positions), num_threads=1)
        own, attached = positions is not points, np.empty(0, dtype=int)
    else:
        rec = rm.reconstruct(
            points,
            shape.dim,
            smooth=False if task.smooth == "no" else task.smooth,
            num_threads=1,
        )
        seconds = time.perf_counter() - start
        positions, found, own = rec.vertices, np.sort(rec.simplices, axis=1), False
        topology = rec.topology()
        attached = rec.attached
    used = np.unique(found)
    taken = 0 if own else int(strewn[used].sum())  # outliers that are vertices
    # Attached samples are no vertices, and not lost.
    lost = 0 if own else int((~strewn).sum()) - (len(used) - taken)
    lost -= int((~strewn[attached]).sum())
    return Outcome(
        tuple(judge(found, topology, len(used) + lost, shape)),
        seconds,
        off(noisy),
        off(positions[used]) if len(used) else math.nan,
        int(strewn.sum()),
        0 if own else int(strewn.sum()) - taken,
        lost,
    )


def poisson(points: Any, _: Task) -> tuple[Any, Any]:
    """PyMeshLab's screened Poisson with its own normals, all by default."""
    import pymeshlab

    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(vertex_matrix=points))
    meshes.compute_normal_for_point_clouds()
    meshes.generate_surface_reconstruction_screened_poisson(threads=1)
    mesh = meshes.current_mesh()
    return mesh.vertex_matrix(), mesh.face_matrix()


def scale_space(points: Any, task: Task) -> tuple[Any, Any]:
    """CGAL's scale space, whose triangles are among the samples as given."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "points", Path(folder) / "triangles"
        points.tofile(source)
        command = [str(task.driver), "scale_space"]
        command += [str(source), str(len(points)), str(target)]
        done = run_command(command, task.time_limit, {"OMP_NUM_THREADS": "1"})
        if isinstance(done, Failure):
            msg = done.reason
            raise RuntimeError(msg)  # noqa: TRY004
        return points, np.fromfile(target, dtype=np.int32).reshape(-1, 3)


PEER_RUNS: dict[str, Callable[[Any, Task], tuple[Any, Any]]] = {
    "poisson": poisson,
    "scale_space": scale_space,
}


# ----------------------------------------------------------------------- the table


def record_of(task: Task, seeds: int, jobs: int) -> dict[str, Any]:
    """The runs of all seeds of a line of the table."""
    outcomes = over_all_seeds(
        measure, task, seeds, jobs, lambda failure: Outcome((failure.reason,))
    )

    def over_seeds(function: Callable[[Any], float], name: str) -> float | None:
        values = [getattr(o, name) for o in outcomes.values()]
        values = [value for value in values if math.isfinite(value)]
        return float(function(values)) if values else None

    return {
        "name": task.row.name,
        "label": task.row.label,
        "num_samples": task.row.num_samples,
        "method": "remanifold" if task.peer is None else PEERS[task.peer],
        "level": task.level,
        "outliers": task.outliers,
        "successes": sum(not o.reasons for o in outcomes.values()),
        "runs": len(outcomes),
        "samples_off": over_seeds(statistics.mean, "samples_off"),
        "vertices_off": over_seeds(statistics.mean, "vertices_off"),
        "median_seconds": over_seeds(statistics.median, "seconds"),
        "outliers_in_all": sum(o.outliers for o in outcomes.values()),
        "outliers_found": sum(o.outliers_found for o in outcomes.values()),
        "samples_lost": sum(o.samples_lost for o in outcomes.values()),
        "outcomes": {str(seed): asdict(o) for seed, o in sorted(outcomes.items())},
    }


def tasks_of(
    rows: Sequence[Row],
    levels: Sequence[float],
    shares: Sequence[float],
    smooth: str,
    peers: Sequence[str],
    driver: Path | None,
    time_limit: float,
) -> Iterator[Task]:
    program = None if driver is None else str(driver)
    for row in rows:
        for share in shares:
            for level in levels:
                for peer in (None, *(peers if row.shape == PEERS_ON else ())):
                    yield Task(row, level, share, 0, smooth, peer, program, time_limit)


def cells_of(
    record: dict[str, Any], outliers: bool, peers: bool
) -> list[tuple[str, str]]:
    """Heads and cells of a line of the table."""
    cells = [("", record["label"]), ("samples", f"{record['num_samples']:,}")]
    if peers:
        cells.append(("method", record["method"]))
    cells.append(("noise", f"{record['level']:g}"))
    if outliers:
        in_all, own = record["outliers_in_all"], record["method"] == PEERS["poisson"]
        found, lost = record["outliers_found"], record["samples_lost"]
        cells += [
            ("outliers", f"{record['outliers']:.0%}"),
            ("found", "" if own else f"{found:,} of {in_all:,}"),
            ("samples lost", "" if own else f"{lost:,}"),
        ]
    cells += [
        ("right", f"{record['successes']} of {record['runs']}"),
        ("samples off", _number(record["samples_off"])),
        ("vertices off", _number(record["vertices_off"])),
        ("seconds", _number(record["median_seconds"])),
    ]
    return cells


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"


@app.command()
def main(
    shape: Annotated[
        list[str] | None,
        typer.Option(
            help="Row of the table by the name of its shape; may be repeated.",
            show_default="all",
            callback=lambda names: one_of([row.name for row in TABLE])(names or []),
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(min=1, help="Samplings of each shape.")] = 20,
    levels: Annotated[
        list[float] | None,
        typer.Option(
            min=0,
            metavar="TIMES",
            show_default="0.1, 0.25, 0.5, 1",
            help="Noise in each normal direction, in median distances to the nearest "
            "neighbor; may be repeated.",
        ),
    ] = None,
    outliers: Annotated[
        list[float] | None,
        typer.Option(
            min=0,
            metavar="SHARE",
            show_default="none",
            help="Outliers to add, uniform in twice the bounding box, as a share of the "
            "samples; may be repeated.",
        ),
    ] = None,
    smooth: Annotated[
        str,
        typer.Option(
            metavar="[auto|no]",
            help="What remanifold does.",
            callback=one_of(["auto", "no"]),
        ),
    ] = "auto",
    peers: Annotated[
        bool,
        typer.Option(
            "--peers",
            help="On the torus also PyMeshLab's screened Poisson and, where its driver "
            "is, CGAL's scale space.",
        ),
    ] = False,
    driver: Annotated[
        Path | None,
        typer.Option(
            dir_okay=False,
            help="The executable remanifold_peers.",
            show_default="that of make",
        ),
    ] = None,
    jobs: JobsOption = None,
    time_limit: TimeLimitOption = 600.0,
    json_file: JsonOption = None,
    markdown: MarkdownOption = False,
) -> None:
    """Count right reconstructions from noisy samples, and measure how far off they are."""
    rows = [row for row in TABLE if not shape or row.name in shape]
    if driver is None:
        driver = next((file for file in DRIVERS if file.is_file()), None)
    names = [name for name in PEERS if name != "scale_space" or driver is not None]
    tasks = list(
        tasks_of(
            rows,
            levels or LEVELS,
            outliers or [0.0],
            smooth,
            names if peers else [],
            driver,
            time_limit,
        )
    )
    measured = functools.partial(
        record_of, seeds=seeds, jobs=jobs or os.cpu_count() or 1
    )
    about = {"remanifold": rm.__version__, "seeds": seeds, "smooth": smooth}
    records = gather(map(measured, tasks), len(tasks), "lines", json_file, about)
    lines = [cells_of(record, any(outliers or []), peers) for record in records]
    print_lines(lines, markdown=markdown)


if __name__ == "__main__":
    app()
