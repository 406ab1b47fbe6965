# SPDX-License-Identifier: GPL-3.0-or-later
"""What simpler and evener complexes cost, in errors and in seconds of one core.

    python benchmarks/remeshing.py simplify    # a tenth of the vertices, several manifolds
    python benchmarks/remeshing.py peers       # beside VTK and MeshLab, for surfaces
    python benchmarks/remeshing.py resample    # how even the edges are

Samples are random, of seed 0.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Annotated

import numpy as np
import typer

import remanifold as rm
from command import MarkdownOption, make_app, print_lines
from remanifold import datasets

app = make_app()

MANIFOLDS: tuple[tuple[str, int, Callable[[int], np.ndarray], int], ...] = (
    ("torus", 2, lambda n: datasets.torus(n, random_state=0), 10_000),
    ("flat torus in R^4", 2, lambda n: datasets.flat_torus(n, random_state=0), 10_000),
    (
        "Klein bottle in R^4",
        2,
        lambda n: datasets.klein_bottle(n, random_state=0),
        10_000,
    ),
    ("Moebius band", 2, lambda n: datasets.moebius_band(n, random_state=0), 10_000),
    ("3-sphere", 3, lambda n: datasets.sphere(n, dim=3, random_state=0), 3_000),
    ("SO(3) in R^9", 3, lambda n: datasets.rotations(n, random_state=0), 3_000),
)


def what_stays(complex_: rm.SimplicialComplex) -> tuple[object, ...]:
    found = complex_.topology()
    return (
        found.manifold,
        found.betti_numbers,
        found.boundary_components,
        found.orientable,
    )


@app.command()
def simplify(markdown: MarkdownOption = False) -> None:
    """Distances of the samples from a tenth of them, and whether the topology stays."""
    lines = []
    for name, dim, draw, count in MANIFOLDS:
        rec = rm.reconstruct(draw(count), dim)
        before = what_stays(rec)
        start = time.process_time()
        found = rec.simplify(count // 10)
        seconds = time.process_time() - start
        lines.append(
            [
                ("random samples of", name),
                ("vertices", f"{count:,}"),
                ("left", f"{found.num_vertices:,}"),
                ("mean distance", f"{np.nanmean(found.errors):.4f}"),
                ("largest", f"{np.nanmax(found.errors):.4f}"),
                ("topology", "the same" if what_stays(found) == before else "another"),
                ("CPU seconds", f"{seconds:.1f}"),
            ]
        )
    print_lines(lines, markdown=markdown)


def by_vtk(rec: rm.SimplicialComplex, left: int) -> rm.SimplicialComplex:
    mesh = rec.to_pyvista().decimate(1 - left / len(rec.simplices))
    return rm.SimplicialComplex(
        np.asarray(mesh.points, dtype=np.float64), mesh.regular_faces
    )


def by_meshlab(
    rec: rm.SimplicialComplex, left: int, optimal: bool
) -> rm.SimplicialComplex:
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(rec.vertices, rec.simplices))
    meshes.meshing_decimation_quadric_edge_collapse(
        targetfacenum=left, preservetopology=True, optimalplacement=optimal
    )
    mesh = meshes.current_mesh()
    return rm.SimplicialComplex(mesh.vertex_matrix(), mesh.face_matrix())


@app.command()
def peers(
    count: Annotated[int, typer.Option(min=500, help="Samples of a torus.")] = 50_000,
    markdown: MarkdownOption = False,
) -> None:
    """A tenth of the triangles of a torus: distances from the torus, and seconds."""
    rec = rm.reconstruct(datasets.torus(count, random_state=0), 2)
    left = len(rec.simplices) // 10
    rec.topology()
    lines = []
    for name, call in (
        ("remanifold", lambda: rec.simplify(left // 2)),
        ("MeshLab, vertices stay", lambda: by_meshlab(rec, left, False)),
        ("MeshLab, vertices move", lambda: by_meshlab(rec, left, True)),
        ("VTK, vertices move", lambda: by_vtk(rec, left)),
    ):
        start = time.process_time()
        found = call()
        seconds = time.process_time() - start
        away = found.project(rec.vertices).distances
        lines.append(
            [
                (f"torus, {len(rec.simplices):,} triangles", name),
                ("triangles left", f"{len(found.simplices):,}"),
                ("mean distance", f"{away.mean():.5f}"),
                ("largest", f"{away.max():.5f}"),
                ("worst shape", f"{found.calculus.element_shapes().min():.2f}"),
                ("CPU seconds", f"{seconds:.1f}"),
            ]
        )
    print_lines(lines, markdown=markdown)


@app.command()
def resample(markdown: MarkdownOption = False) -> None:
    """Spread of the edges' lengths before and after, and distance from a torus."""
    rec = rm.reconstruct(datasets.torus(2000, random_state=0), 2)
    lines = []
    for count in (500, 2000, 8000):
        start = time.process_time()
        found = rec.resample(count)
        seconds = time.process_time() - start
        x, y, z = found.vertices.T
        away = np.abs(np.hypot(np.hypot(x, y) - 1, z) - 0.4)
        spread = []
        for complex_ in (rec, found):
            i, j = complex_.edges.T
            length = np.linalg.norm(complex_.vertices[i] - complex_.vertices[j], axis=1)
            spread.append(length.std() / length.mean())
        lines.append(
            [
                ("torus of 2,000 samples to", f"{found.num_vertices:,}"),
                ("spread of edges before", f"{100 * spread[0]:.0f} %"),
                ("after", f"{100 * spread[1]:.0f} %"),
                ("worst shape", f"{found.calculus.element_shapes().min():.2f}"),
                ("mean distance from the torus", f"{away.mean():.5f}"),
                ("CPU seconds", f"{seconds:.1f}"),
            ]
        )
    print_lines(lines, markdown=markdown)


if __name__ == "__main__":
    app()
