# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of what `SimplicialComplex.calculus` computes, beside exact values, as N grows.

    python benchmarks/calculus.py spectra      # eigenvalues of closed manifolds
    python benchmarks/calculus.py paths        # shortest paths
    python benchmarks/calculus.py distances    # along the triangles
    python benchmarks/calculus.py charts       # how much they stretch
    python benchmarks/calculus.py curvature    # curvatures by local fits
    python benchmarks/calculus.py peers        # times beside potpourri3d, for surfaces

Samples are random, seed 0 on; numbers are means over the seeds.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Annotated, NamedTuple

import numpy as np
import typer

import remanifold as rm
from command import MarkdownOption, make_app, print_lines
from remanifold import datasets

app = make_app()
SIZES = (500, 2000, 8000)
SeedsOption = Annotated[int, typer.Option(min=1, help="Seeds to average over.")]


class Manifold(NamedTuple):
    """What is sampled, and the eigenvalues of its Laplacian."""

    name: str
    dim: int
    draw: Callable[[int, int], np.ndarray]
    eigenvalues: list[float]
    counts: tuple[int, ...]


def flat_klein_bottle(count: int, seed: int) -> np.ndarray:
    """Isometric in R^5: (s, w) and (-s, w + pi) are one point."""
    s, w = np.random.default_rng(seed).random((2, count)) * [[2 * np.pi], [np.pi]]
    columns = (
        np.sqrt(0.75) * np.cos(s),
        np.sin(s) * np.cos(w),
        np.sin(s) * np.sin(w),
        np.cos(s) * np.cos(2 * w) / 2,
        np.cos(s) * np.sin(2 * w) / 2,
    )
    return np.stack(columns, axis=1)


MANIFOLDS = (
    Manifold(
        "circle",
        1,
        lambda n, s: datasets.circle(n, random_state=s),
        [0, 1, 1, 4, 4, 9, 9, 16, 16],
        (100, 400, 1600),
    ),
    Manifold(
        "sphere",
        2,
        lambda n, s: datasets.sphere(n, random_state=s),
        [0, *[2] * 3, *[6] * 5],
        (500, 2000, 8000),
    ),
    Manifold(
        "flat torus in R^4",
        2,
        lambda n, s: datasets.flat_torus(n, random_state=s),
        [0, *[1] * 4, *[2] * 4],
        (500, 2000, 8000),
    ),
    Manifold(
        "flat Klein bottle in R^5",
        2,
        flat_klein_bottle,
        [0, 1, *[2] * 2, *[4] * 3, *[5] * 4],
        (500, 2000, 8000),
    ),
    Manifold(
        "3-sphere",
        3,
        lambda n, s: datasets.sphere(n, dim=3, random_state=s),
        [0, *[3] * 4],
        (500, 1500, 4500),
    ),
    Manifold(
        "SO(3) in R^9",
        3,
        lambda n, s: datasets.rotations(n, random_state=s),
        [0, *[1] * 9],
        (500, 1500, 4500),
    ),
)


@app.command()
def spectra(seeds: SeedsOption = 2, markdown: MarkdownOption = False) -> None:
    """Mean relative error of the eigenvalues, and the power of N that it falls with."""
    lines = []
    for manifold in MANIFOLDS:
        exact = np.array(manifold.eigenvalues)
        before: dict[bool, tuple[int, float]] = {}
        for count in manifold.counts:
            errors: dict[bool, list[float]] = {True: [], False: []}
            seconds = []
            for seed in range(seeds):
                rec = rm.reconstruct(manifold.draw(count, seed), manifold.dim)
                for lumped, own in errors.items():
                    start = time.perf_counter()
                    found = rec.calculus.spectrum(len(exact), lumped=lumped).eigenvalues
                    seconds += [time.perf_counter() - start] * lumped
                    error = np.abs(found[1:] / exact[1:] - 1).mean()
                    own.append(float(error))
            line = [("random samples of", manifold.name), ("N", f"{count:,}")]
            for lumped, name in ((True, "lumped mass"), (False, "full mass")):
                mean = float(np.mean(errors[lumped]))
                rate = ""
                if lumped in before:
                    smaller, worse = before[lumped]
                    power = np.log(mean / worse) / np.log(count / smaller)
                    rate = f"{power:.2f}".replace("-", "−")
                before[lumped] = count, mean
                line += [(name, f"{100 * mean:.2f} %"), (f"rate, {name}", rate)]
            line.append(("seconds", f"{np.mean(seconds):.2f}"))
            lines.append(line)
    print_lines(lines, markdown=markdown)


def on_sphere(points: np.ndarray, start: int, end: int) -> float:
    return float(np.arccos(np.clip(points[start] @ points[end], -1, 1)))


def on_torus(points: np.ndarray, start: int, end: int) -> float:
    angles = np.arctan2(points[:, 1::2], points[:, ::2])
    away = np.abs(angles[start] - angles[end])
    return float(np.linalg.norm(np.minimum(away, 2 * np.pi - away)))


@app.command()
def paths(
    pairs: Annotated[int, typer.Option(min=1, help="Pairs of vertices.")] = 20,
    markdown: MarkdownOption = False,
) -> None:
    """How much longer paths are than the shortest on the manifold."""
    lines = []
    for name, dim, points, true in (
        ("sphere", 2, datasets.sphere(2000, random_state=0), on_sphere),
        ("flat torus in R^4", 2, datasets.flat_torus(2000, random_state=0), on_torus),
        ("3-sphere", 3, datasets.sphere(3000, dim=3, random_state=0), on_sphere),
    ):
        rec = rm.reconstruct(points, dim)
        random = np.random.default_rng(0)
        ends = random.choice(len(points), (pairs, 2), replace=False).tolist()
        options: list[dict[str, object]] = [{"points": n} for n in (0, 1, 2, 4, 8)]
        options += [{"exact": True}] * (points.shape[1] <= 3 and dim == 2)
        for option in options:
            start = time.perf_counter()
            found = [rec.calculus.shortest_path(a, b, **option) for a, b in ends]
            seconds = (time.perf_counter() - start) / pairs
            longer = [
                path.volume() / true(points, a, b) - 1
                for path, (a, b) in zip(found, ends, strict=True)
            ]
            what = "`exact`" if "exact" in option else f"`points={option['points']}`"
            lines.append(
                [
                    ("random samples of", name),
                    ("N", f"{len(points):,}"),
                    ("option", what),
                    (
                        "mean surplus",
                        f"{100 * np.mean(longer):.2f} %".replace("-", "−"),
                    ),
                    ("largest", f"{100 * np.max(longer):.2f} %".replace("-", "−")),
                    ("ms each", f"{1000 * seconds:.0f}"),
                ]
            )
    print_lines(lines, markdown=markdown)


@app.command()
def distances(markdown: MarkdownOption = False) -> None:
    """Mean relative error of distances from two vertices, by each method, and CPU time."""
    lines = []
    for name, dim, draw, true, counts in (
        ("sphere", 2, lambda n: datasets.sphere(n, random_state=0), on_sphere, SIZES),
        (
            "flat torus in R^4",
            2,
            lambda n: datasets.flat_torus(n, random_state=0),
            on_torus,
            SIZES,
        ),
        (
            "3-sphere",
            3,
            lambda n: datasets.sphere(n, dim=3, random_state=0),
            on_sphere,
            (3000,),
        ),
    ):
        for count in counts:
            points = draw(count)
            rec = rm.reconstruct(points, dim)
            rec.geodesic_distances(0, "graph"), rec.topology()  # what is made once
            exact = np.array(
                [[true(points, a, b) for b in range(count)] for a in (0, 7)]
            )
            line = [("random samples of", name), ("N", f"{count:,}")]
            for method in ("graph", "heat", "exact"):
                error, seconds = "", ""
                if method != "exact" or dim == 2:
                    start = time.process_time()
                    found = rec.geodesic_distances([0, 7], method)
                    seconds = f"{(time.process_time() - start) / 2:.2f}"
                    away = np.abs(found - exact) / np.maximum(exact, 0.1)
                    error = f"{100 * away.mean():.2f} %"
                line += [(f"`{method}`", error), (f"s, {method}", seconds)]
            lines.append(line)
    print_lines(lines, markdown=markdown)


@app.command()
def charts(markdown: MarkdownOption = False) -> None:
    """How many charts there are, and how much they stretch."""
    lines = []
    for name, dim, points in (
        ("Swiss roll", 2, datasets.swiss_roll(2000, random_state=0)),
        ("sphere", 2, datasets.sphere(2000, random_state=0)),
        ("torus", 2, datasets.torus(2000, random_state=0)),
        ("torus", 2, datasets.torus(20_000, random_state=0)),
        ("flat torus in R^4", 2, datasets.flat_torus(2000, random_state=0)),
        ("Klein bottle in R^4", 2, datasets.klein_bottle(2000, random_state=0)),
        ("3-sphere", 3, datasets.sphere(500, dim=3, random_state=0)),
    ):
        rec = rm.reconstruct(points, dim)
        for method in ("rigid", "conformal", "tangent"):
            if method == "conformal" and dim != 2:
                continue
            start = time.process_time()
            atlas = rec.calculus.charts(method)
            seconds = time.process_time() - start
            stretches = np.concatenate([chart.stretches for chart in atlas.charts])
            factor = np.maximum(stretches[:, -1], 1 / stretches[:, 0])
            lines.append(
                [
                    ("random samples of", name),
                    ("N", f"{len(points):,}"),
                    ("method", f"`{method}`"),
                    ("charts", f"{len(atlas)}"),
                    ("median distortion", f"{np.median(factor):.3f}"),
                    ("95 %", f"{np.percentile(factor, 95):.2f}"),
                    ("largest", f"{factor.max():.2f}"),
                    ("CPU seconds", f"{seconds:.1f}"),
                ]
            )
    print_lines(lines, markdown=markdown)


def on_ellipsoid(points: np.ndarray) -> np.ndarray:
    """Scalar curvature, twice the Gaussian, of half axes 1, 1.3 and 1.6."""
    squares = np.array([1, 1.3, 1.6]) ** 2
    support = (points**2 / squares**2).sum(axis=1)
    return np.asarray(2 / (squares.prod() * support**2))


def on_tube(points: np.ndarray) -> np.ndarray:
    """Scalar curvature of a torus of revolution of radii 1 and 0.4."""
    around = np.hypot(points[:, 0], points[:, 1])
    return np.asarray(2 * (around - 1) / 0.4 / (0.4 * around))


@app.command()
def curvature(markdown: MarkdownOption = False) -> None:
    """Mean absolute error of the scalar curvature, and its mean size."""
    lines = []
    for name, dim, draw, exact in (
        (
            "ellipsoid",
            2,
            lambda n: datasets.sphere(n, random_state=0) * [1, 1.3, 1.6],
            on_ellipsoid,
        ),
        ("torus", 2, lambda n: datasets.torus(n, random_state=0), on_tube),
        (
            "flat torus in R^4",
            2,
            lambda n: datasets.flat_torus(n, random_state=0),
            lambda p: np.zeros(len(p)),
        ),
        (
            "S^2 x S^1 in R^5",
            3,
            lambda n: datasets.sphere_times_circle(n, random_state=0),
            lambda p: np.full(len(p), 2.0),
        ),
    ):
        before: tuple[int, float] | None = None
        for count in (1000, 4000):
            points = draw(count)
            rec = rm.reconstruct(points, dim)
            start = time.perf_counter()
            found = rec.calculus.curvature()
            seconds = time.perf_counter() - start
            true = exact(points)
            error = float(np.nanmean(np.abs(found.scalar - true)))
            rate = ""
            if before:
                power = np.log(error / before[1]) / np.log(count / before[0])
                rate = f"{power:.2f}".replace("-", "−")
            before = count, error
            lines.append(
                [
                    ("random samples of", name),
                    ("N", f"{count:,}"),
                    ("mean size", f"{np.abs(true).mean():.2f}"),
                    ("mean error", f"{error:.3f}"),
                    ("rate", rate),
                    ("seconds", f"{seconds:.2f}"),
                ]
            )
    print_lines(lines, markdown=markdown)


@app.command()
def peers(
    count: Annotated[int, typer.Option(min=100, help="Samples of a torus.")] = 20_000,
    repeats: Annotated[int, typer.Option(min=1, help="Of which the best.")] = 3,
    markdown: MarkdownOption = False,
) -> None:
    """Seconds beside potpourri3d, and how far the answers are apart."""
    import potpourri3d

    rec = rm.reconstruct(datasets.torus(count, random_state=0), 2)
    rows = rec.simplices.astype(np.int64)

    def best(call: Callable[[], object]) -> tuple[float, object]:
        times, answer = [], None
        for _ in range(repeats):
            start = time.perf_counter()
            answer = call()
            times.append(time.perf_counter() - start)
        return min(times), answer

    def fresh() -> rm.Calculus:
        return rm.SimplicialComplex(rec.vertices, rec.simplices).calculus

    def matrices() -> object:
        calculus = fresh()
        return calculus.stiffness(), calculus.vertex_volumes

    def their_matrices() -> object:
        return (
            potpourri3d.cotan_laplacian(rec.vertices, rows),
            potpourri3d.vertex_areas(rec.vertices, rows),
        )

    def logarithm() -> object:
        return fresh().logarithm(5).coordinates

    def their_logarithm() -> object:
        return potpourri3d.MeshVectorHeatSolver(rec.vertices, rows).compute_log_map(5)

    lines = []
    for what, own, their in (
        ("stiffness and lumped mass", matrices, their_matrices),
        ("logarithm map", logarithm, their_logarithm),
    ):
        mine, _ = best(own)
        other, _ = best(their)
        lines.append(
            [
                (f"torus, {count:,} samples", what),
                ("remanifold, seconds", f"{mine:.2f}"),
                ("potpourri3d, seconds", f"{other:.2f}"),
                ("ratio", f"{mine / other:.1f}"),
            ]
        )
    print_lines(lines, markdown=markdown)


if __name__ == "__main__":
    app()
