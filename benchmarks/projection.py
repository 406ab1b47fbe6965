# SPDX-License-Identifier: GPL-3.0-or-later
"""Nearest points a second, beside trimesh and Open3D where they are installed.

    python benchmarks/projection.py                 # 200,000 triangles, 100,000 queries
    python benchmarks/projection.py --queries 1000  # fewer

All are asked the same, in this run: queries at a distance of about half an edge from the
surface. Times are wall seconds without the building of the index.
"""

from __future__ import annotations

import importlib.util
import time
from collections.abc import Callable
from typing import Annotated

import numpy as np
import typer

import remanifold as rm
from command import make_app

Asked = np.ndarray
app = make_app()


def torus_mesh(around: int, across: int) -> rm.SimplicialComplex:
    """A grid on a torus, two triangles a cell."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")

    def vertex(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return (a % around) * across + b % across

    corners = [
        vertex(u + i, v + j).ravel() for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    rows = np.concatenate(
        [np.stack([corners[i] for i in own], 1) for own in ((0, 1, 2), (0, 2, 3))]
    )
    theta, phi = 2 * np.pi * u.ravel() / around, 2 * np.pi * v.ravel() / across
    ring = 2 + np.cos(phi)
    points = np.stack([ring * np.cos(theta), ring * np.sin(theta), np.sin(phi)], 1)
    return rm.SimplicialComplex(points, rows)


def by_remanifold(mesh: rm.SimplicialComplex) -> Callable[[Asked], np.ndarray]:
    mesh.project(mesh.vertices[:1])  # builds the tree
    return lambda asked: mesh.project(asked).distances


def by_trimesh(mesh: rm.SimplicialComplex) -> Callable[[Asked], np.ndarray]:
    import trimesh

    query = trimesh.proximity.ProximityQuery(
        trimesh.Trimesh(mesh.vertices, mesh.simplices, process=False)
    )
    query.on_surface(mesh.vertices[:1])
    return lambda asked: query.on_surface(asked)[1]


def by_open3d(mesh: rm.SimplicialComplex) -> Callable[[Asked], np.ndarray]:
    import open3d

    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        open3d.core.Tensor(mesh.vertices.astype(np.float32)),
        open3d.core.Tensor(mesh.simplices.astype(np.uint32)),
    )
    return lambda asked: scene.compute_distance(
        open3d.core.Tensor(asked.astype(np.float32))
    ).numpy()


def measure(name: str, ask: Callable[[Asked], np.ndarray], asked: Asked) -> np.ndarray:
    begin = time.perf_counter()
    found = ask(asked)
    seconds = time.perf_counter() - begin
    print(f"| {name} | {len(asked) / seconds:,.0f} |", flush=True)
    return found


@app.command()
def main(
    queries: Annotated[int, typer.Option(help="Points to project.")] = 100_000,
    around: Annotated[int, typer.Option(help="Cells around the torus.")] = 400,
    across: Annotated[int, typer.Option(help="Cells across the tube.")] = 250,
) -> None:
    """Print queries a second, and how far the others are from the exact distances."""
    mesh = torus_mesh(around, across)
    random = np.random.default_rng(0)
    near = mesh.vertices[random.integers(0, mesh.num_vertices, queries)]
    asked = near + 0.012 * random.normal(size=near.shape)
    found = measure("remanifold, R^3", by_remanifold(mesh), asked)
    for name, make in (("trimesh", by_trimesh), ("open3d", by_open3d)):
        if importlib.util.find_spec(name) is None:
            print(f"| {name} | not installed |")
            continue
        fewer = asked[:5000] if name == "trimesh" else asked
        other = measure(name, make(mesh), fewer)
        print(f"  largest difference {np.abs(other - found[: len(fewer)]).max():.1e}")
    ambient = 100
    placed = rm.datasets.embed(mesh.vertices, ambient, random_state=0)
    mesh = rm.SimplicialComplex(placed, mesh.simplices)
    noise = 0.012 * np.sqrt(3 / ambient) * random.normal(size=(queries, ambient))
    near = placed[random.integers(0, len(placed), queries)]
    measure("remanifold, R^100", by_remanifold(mesh), near + noise)


if __name__ == "__main__":
    app()
