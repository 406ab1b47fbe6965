# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples that are noisy, uneven, layered or no manifold, beside other programs.

    python benchmarks/hard.py [--json FILE] [NAMES]

Each reconstruction runs in a process of its own, on one thread, and is ended after
TIME_LIMIT seconds. The sets are generated; those in REMANIFOLD_DATA (NPZ files with an
array `points`) are measured as well where that folder is given, and the raw scan where
PyMeshLab, which carries it, is installed. MeshLib (PyPI) triangulates points in space where
it is installed; CGAL's advancing front and scale space where --driver names the executable
`remanifold_peers`.
"""

from __future__ import annotations

import argparse
import functools
import importlib.util
import json
import os
import resource
import subprocess
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

import remanifold as rm
from processes import Failure, run_all
from samples import spacing

TIME_LIMIT = 120.0


@dataclass(frozen=True)
class Row:
    data: str
    method: str
    num_samples: int
    seconds: float  # of CPU
    mebibytes: float  # at the peak, beyond the input
    betti: tuple[int, ...]
    manifold: bool
    largest_program: int


# ------------------------------------------------------------------------ samples


def noisy(shape: str, num: int, noise: float) -> tuple[Any, int]:
    """Independent normal noise in each coordinate, in spacings."""
    found = rm.datasets.SHAPES[shape]
    points = found.generate(num, random_state=0)
    rng = np.random.default_rng(0)
    size = noise * spacing(points)
    return points + rng.normal(scale=size, size=points.shape), found.dim


def voxel_shell(num: int) -> tuple[Any, int]:
    """Centres of the voxels that a sphere goes through."""
    half = round((num / 18) ** 0.5)
    axis = np.arange(-half - 1, half + 2) + 0.5
    grid = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
    radius = np.linalg.norm(grid, axis=1)
    return grid[np.abs(radius - half) < 0.75], 2


def lattice_sphere(radius: int) -> tuple[Any, int]:
    """Points of the cubic lattice next to a sphere: layers, cospherical, coplanar."""
    axis = np.arange(-radius - 1.0, radius + 2)
    grid = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
    return grid[np.abs(np.linalg.norm(grid, axis=1) - radius) < 0.5], 2


def solid_ball(num: int) -> tuple[Any, int]:
    """A ball, given as a surface."""
    return rm.datasets.ball(num, random_state=0), 2


def degrees_beside_metres(num: int) -> tuple[Any, int]:
    """Terrain whose plane coordinates are degrees and whose height is in metres."""
    rng = np.random.default_rng(0)
    x, y = rng.uniform(0, 0.5, size=(2, num))
    return np.column_stack([x, y, 300 * np.sin(9 * x) * np.cos(7 * y)]), 2


def gear(num_teeth: int, num_rings: int) -> tuple[Any, int]:
    """Dense cycloidal rings, far apart along the axis."""
    turn = np.linspace(0, 2 * np.pi, 60 * num_teeth, endpoint=False)
    radius = 1 + 0.06 * np.cos(num_teeth * turn)
    ring = np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])
    height = np.linspace(0, 0.5, num_rings)
    rings = np.repeat(height, len(ring))
    return np.column_stack([np.tile(ring, (num_rings, 1)), rings]), 2


def layers(num: int, offset: float) -> tuple[Any, int]:
    """Two scans of a sphere, one of them moved by so many spacings."""
    points = rm.datasets.sphere(num, random_state=0)
    points[num // 2 :, 2] += offset * spacing(points)
    return points, 2


def raw_scan() -> tuple[Any, int]:
    """A range scan that PyMeshLab carries as a sample."""
    package = importlib.util.find_spec("pymeshlab")
    folder = Path(str(package.origin)).parent  # type: ignore[union-attr]
    path = folder / "tests" / "sample_meshes" / "rangemaps" / "face000.ply"
    return rm.io.read(path).points, 2


def measured(path: Path) -> tuple[Any, int]:
    with np.load(path) as file:
        points = np.ascontiguousarray(file["points"], dtype=np.float64)
        return points, int(file["dim"]) if "dim" in file else dim_of(path.name)


def dim_of(name: str) -> int:
    curves = ("curve", "highdim")
    solids = ("solid", "threemanifold")
    return 1 if name.startswith(curves) else 3 if name.startswith(solids) else 2


def sets() -> dict[str, Callable[[], tuple[Any, int]]]:
    made: dict[str, Callable[[], tuple[Any, int]]] = {
        "clean torus": functools.partial(noisy, "torus", 100_000, 0.0),
        "torus, noise 0.3": functools.partial(noisy, "torus", 10_000, 0.3),
        "torus, noise 0.5": functools.partial(noisy, "torus", 10_000, 0.5),
        "torus, noise 1.0": functools.partial(noisy, "torus", 10_000, 1.0),
        "Klein bottle, noise 0.5": functools.partial(
            noisy, "klein_bottle", 10_000, 0.5
        ),
        "trefoil, noise 0.5": functools.partial(noisy, "trefoil", 3_000, 0.5),
        "uneven double torus": functools.partial(
            noisy, "uneven_double_torus", 20_000, 0.0
        ),
        "Swiss roll, noise 0.5": functools.partial(noisy, "swiss_roll", 10_000, 0.5),
        "two layers": functools.partial(layers, 20_000, 0.7),
        "voxel shell": functools.partial(voxel_shell, 3_000),
        "lattice sphere": functools.partial(lattice_sphere, 20),
        "ball as a surface": functools.partial(solid_ball, 3_000),
        "degrees beside metres": functools.partial(degrees_beside_metres, 10_000),
        "gear": functools.partial(gear, 24, 12),
    }
    if importlib.util.find_spec("pymeshlab") is not None:
        made["raw range scan"] = raw_scan
    folder = os.environ.get("REMANIFOLD_DATA")
    for path in sorted(Path(folder).glob("*.npz")) if folder else ():
        made[path.stem] = functools.partial(measured, path)
    return made


# ------------------------------------------------------------------------ methods


def by_remanifold(points: Any, dim: int) -> tuple[Any, int]:
    rec = rm.reconstruct(points, dim, num_threads=1)
    return rec.simplices, rec.repair.largest_program


def by_remanifold_unsmoothed(points: Any, dim: int) -> tuple[Any, int]:
    rec = rm.reconstruct(points, dim, num_threads=1, smooth=False)
    return rec.simplices, rec.repair.largest_program


def by_meshlib(points: Any, _dim: int) -> tuple[Any, int]:
    from meshlib import mrmeshnumpy as numbers
    from meshlib import mrmeshpy as meshlib

    cloud = numbers.pointCloudFromPoints(np.ascontiguousarray(points))
    faces = numbers.getNumpyFaces(meshlib.triangulatePointCloud(cloud).topology)
    # Faces that it has taken out again are rows of one vertex.
    return faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2])], 0


def by_driver(points: Any, dim: int, *, driver: str, name: str) -> tuple[Any, int]:
    with tempfile.TemporaryDirectory() as folder:
        given, found = Path(folder) / "points", Path(folder) / "simplices"
        np.ascontiguousarray(points).tofile(given)
        command = [driver, name, str(given), str(len(points)), str(found)]
        subprocess.run(command, check=True, capture_output=True)
        return np.fromfile(found, dtype=np.int32).reshape(-1, dim + 1), 0


def methods(driver: str | None) -> dict[str, Callable[[Any, int], Any]]:
    known: dict[str, Callable[[Any, int], Any]] = {
        "remanifold": by_remanifold,
        "remanifold, smooth=False": by_remanifold_unsmoothed,
    }
    if importlib.util.find_spec("meshlib") is not None:
        known["MeshLib"] = by_meshlib
    if driver is not None:
        for name in ("advancing_front", "scale_space"):
            known[name] = functools.partial(by_driver, driver=driver, name=name)
    return known


# ------------------------------------------------------------------------ measuring


def cpu_seconds() -> float:
    own = time.process_time()
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return own + children.ru_utime + children.ru_stime


def measure(task: tuple[str, str, str | None]) -> Row:
    data, method, driver = task
    points, dim = sets()[data]()
    reconstruct = methods(driver)[method]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        reconstruct(rm.datasets.sphere(200, random_state=0), 2)  # loads what it imports
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        start = cpu_seconds()
        simplices, largest = reconstruct(points, dim)
        seconds = cpu_seconds() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    topology = rm.SimplicialComplex(points, simplices).topology()
    return Row(
        data=data,
        method=method,
        num_samples=len(points),
        seconds=seconds,
        mebibytes=peak / 1024,
        betti=topology.betti_numbers or (),
        manifold=topology.manifold,
        largest_program=largest,
    )


def tasks(
    names: list[str], driver: str | None
) -> Iterator[tuple[str, str, str | None]]:
    for data, make in sets().items():
        if names and data not in names:
            continue
        points, dim = make()
        others = points.shape[1] == 3 and dim == 2
        for method in methods(driver):
            if method.startswith("remanifold") or others:
                yield data, method, driver


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*")
    parser.add_argument("--driver", help="the executable remanifold_peers")
    parser.add_argument("--json", type=Path, help="rows, for other programs")
    chosen = parser.parse_args()
    rows = []
    print(
        "| data | samples | method | CPU s | MiB | Betti numbers | manifold | program |"
    )
    print("|---|---:|---|---:|---:|---|---|---:|")
    wanted = list(tasks(chosen.names, chosen.driver))
    for task, row in run_all(measure, wanted, 1, TIME_LIMIT):
        if isinstance(row, Failure):
            print(f"| {task[0]} | | {task[1]} | {row.reason} | | | | |", flush=True)
            continue
        rows.append(asdict(row))
        betti = ", ".join(map(str, row.betti))
        print(
            f"| {row.data} | {row.num_samples:,} | {row.method} | {row.seconds:.2f} | "
            f"{row.mebibytes:.0f} | {betti} | {'yes' if row.manifold else 'no'} | "
            f"{row.largest_program or ''} |",
            flush=True,
        )
    if chosen.json is not None:
        chosen.json.write_text(json.dumps(rows, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
