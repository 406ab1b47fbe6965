# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of what `SimplicialComplex.calculus` computes, beside exact values, as N grows.

    python benchmarks/calculus.py spectra      # eigenvalues of closed manifolds
    python benchmarks/calculus.py paths        # shortest paths
    python benchmarks/calculus.py distances    # along the triangles
    python benchmarks/calculus.py charts       # how much they stretch
    python benchmarks/calculus.py curvature    # curvatures by local fits
    python benchmarks/calculus.py peers        # beside other libraries, for surfaces

Samples are random, seed 0 on; numbers are means over the seeds.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Annotated, Any, NamedTuple

import numpy as np
import typer

import remanifold as rm
from command import MarkdownOption, make_app, print_lines
from remanifold import datasets
from remanifold.calculus.unrolling import stretches_of

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
        options += [{"exact": True}] * (dim == 2)
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


class Task(NamedTuple):
    """What two libraries do on the same triangles, and how far each is off."""

    name: str
    library: str
    own: Callable[[], object]
    their: Callable[[], object]
    error: Callable[[Any], float] | None  # of an answer, beside the exact one


def tasks_beside_others(count: int) -> list[Task]:
    """On the unit sphere, a band of it and an ellipsoid, of so many random samples."""
    import igl
    import potpourri3d
    import pyvista
    import robust_laplacian
    import trimesh
    from scipy.sparse.linalg import eigsh

    points = datasets.sphere(count, random_state=0)
    long = points * [1, 1.3, 1.6]
    inside = np.abs(points[:, 2]) < 0.8
    sphere = rm.reconstruct(points, 2).simplices
    ellipsoid = rm.reconstruct(long, 2).simplices
    band = points[inside]
    ring = rm.reconstruct(band, 2)
    rows, far, around = (
        np.ascontiguousarray(own, dtype=np.int64)
        for own in (sphere, ellipsoid, ring.simplices)
    )
    rim = ring.calculus.boundary_vertices
    harmonic = np.arctanh(band[:, 2])
    height, start = points[:, 2], 5
    away = np.arccos(np.clip(points @ points[start], -1, 1))
    near = (away > 0.05) & (away < 2.5)
    levels = np.repeat(np.arange(5) * np.arange(1, 6), 2 * np.arange(5) + 1)[1:]
    gaussian = on_ellipsoid(long) / 2
    length = 2 * np.pi * np.sqrt(1 - 0.2**2)
    flat = points[rows].mean(axis=1)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    tangential = np.array([0, 0, 1]) - flat[:, 2:] * flat

    def fresh(vertices: np.ndarray = points, cells: np.ndarray = sphere) -> Any:
        return rm.SimplicialComplex(vertices, cells)

    def mean_error(true: np.ndarray) -> Callable[[Any], float]:
        return lambda found: float(np.nanmean(np.abs(found - true)))

    def own_matrices() -> object:
        calculus = fresh().calculus
        return calculus.stiffness(), calculus.vertex_volumes

    def their_matrices() -> object:
        return (
            potpourri3d.cotan_laplacian(points, rows),
            potpourri3d.vertex_areas(points, rows),
        )

    def own_flipped() -> object:
        calculus = fresh().calculus
        return calculus.stiffness(delaunay=True), calculus.mass(
            lumped=True, delaunay=True
        )

    def their_spectrum() -> object:
        stiffness, mass = robust_laplacian.mesh_laplacian(points, rows)
        return eigsh(stiffness, 25, mass, sigma=-1e-2)[0]

    def eigenvalues(found: Any) -> float:
        return float(np.abs(np.sort(found)[1:] / levels - 1).mean())

    def own_logarithm(method: Any) -> Callable[[], object]:
        return lambda: fresh().calculus.logarithm(start, method).coordinates

    def their_logarithm() -> object:
        return potpourri3d.MeshVectorHeatSolver(points, rows).compute_log_map(start)

    def logarithm_error(found: Any) -> float:
        """Of places in the tangent plane, after the best turn or reflection."""
        first = np.linalg.svd(points[start][None])[2][1:]
        true = points @ first.T
        true *= (away / np.maximum(np.linalg.norm(true, axis=1), 1e-300))[:, None]
        left, _, right = np.linalg.svd(found[near].T @ true[near])
        off = found[near] @ (left @ right) - true[near]
        return float(np.linalg.norm(off, axis=1).mean())

    def their_curvature() -> object:
        _, _, low, high, _ = igl.principal_curvature(long, far)
        return low * high

    def their_defects() -> object:
        areas = igl.massmatrix(long, far, igl.MASSMATRIX_TYPE_BARYCENTRIC).diagonal()
        return igl.gaussian_curvature(long, far) / areas

    def their_level() -> object:
        mesh = pyvista.PolyData.from_regular_faces(points, rows)
        line = mesh.contour([0.2], height)
        return line.compute_cell_sizes(area=False, volume=False)["Length"].sum()

    def their_normals() -> object:
        return np.array(trimesh.Trimesh(points, rows, process=False).vertex_normals)

    def angle(found: Any) -> float:
        return float(np.degrees(np.linalg.norm(found - points, axis=1)).mean())

    def their_finer() -> object:
        return trimesh.remesh.subdivide_loop(points, rows, 1)[0]

    def their_gradient() -> object:
        found = igl.grad(points, rows) @ height
        return found.reshape(3, -1).T

    cap = datasets.spherical_cap(count, random_state=0)
    dome = rm.reconstruct(cap, 2).simplices
    faces = np.ascontiguousarray(dome, dtype=np.int64)
    operators = fresh(cap, dome).calculus._operators
    circle = igl.boundary_loop(faces)
    circle = np.asarray(circle[0] if isinstance(circle, tuple) else circle)
    ends = circle[[0, len(circle) // 2]].astype(np.int64)
    apart = np.array([[0.0, 0.0], [1.0, 0.0]])

    def own_chart(method: Any) -> Callable[[], object]:
        def lay_out() -> object:
            atlas = fresh(cap, dome).calculus.charts(method, max_distortion=1e3)
            assert len(atlas) == 1
            return atlas.charts[0].coordinates

        return lay_out

    def their_conformal() -> Any:
        found = igl.lscm(cap, faces, ends, apart)
        return found[0] if isinstance(found, tuple) else found

    def their_rigid() -> object:
        start = their_conformal()
        own = np.abs(stretches_of(operators, start).prod(axis=1))
        start = start / np.sqrt(np.average(own, weights=operators.elements.volumes))
        data = igl.ARAPData()
        data.max_iter = 20  # as many rounds as here
        igl.arap_precomputation(cap, faces, 2, ends[:1].astype(np.int32), data)
        return igl.arap_solve(start[ends[:1]], data, start)

    def angles_off(found: Any) -> float:
        """Mean of the longer over the shorter axis of a circle, less 1."""
        own = np.abs(stretches_of(operators, found))
        return float((own.max(axis=1) / own.min(axis=1)).mean() - 1)

    def lengths_off(found: Any) -> float:
        """Mean factor of the worst length, less 1."""
        own = np.abs(stretches_of(operators, found))
        return float(np.maximum(own.max(axis=1), 1 / own.min(axis=1)).mean() - 1)

    chosen = np.random.default_rng(0).choice(count, 20, replace=False)
    cluster = np.flatnonzero(away < 0.8)[:: max(1, (away < 0.8).sum() // 20)]
    to_sites = np.arccos(np.clip(points[chosen] @ points.T, -1, 1))
    spread = (np.arccos(np.clip(points @ points[cluster].T, -1, 1)) ** 2).mean(axis=1)

    def their_distances() -> Callable[[int], np.ndarray]:
        solver = potpourri3d.MeshHeatMethodDistanceSolver(points, rows)
        return lambda vertex: np.asarray(solver.compute_distance(int(vertex)))

    def their_cells() -> object:
        distances = their_distances()
        return np.argmin([distances(site) for site in chosen], axis=0)

    def cells_off(found: Any) -> float:
        """Mean of how much farther the site found is than the nearest."""
        labels = getattr(found, "labels", found)
        return float((to_sites[labels, range(count)] - to_sites.min(axis=0)).mean())

    def their_mean() -> object:
        distances = their_distances()
        return np.argmin(np.sum([distances(v) ** 2 for v in cluster], axis=0))

    def mean_off(found: Any) -> float:
        vertex = getattr(found, "vertex", found)
        return float(np.sqrt(spread[vertex]) - np.sqrt(spread.min()))

    def their_farthest() -> object:
        distances = their_distances()
        found = [0]
        nearest = np.full(count, np.inf)
        while len(found) < 50:
            nearest = np.minimum(nearest, distances(found[-1]))
            found.append(int(nearest.argmax()))
        return np.array(found)

    def uncovered(found: Any) -> float:
        """The largest distance from them."""
        return float(
            np.arccos(np.clip(points @ points[found].T, -1, 1)).min(axis=1).max()
        )

    def their_samples() -> object:
        import pymeshlab

        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(points, rows))
        length = np.sqrt(8 * np.pi / (count / 2) / np.sqrt(3))
        meshes.meshing_isotropic_explicit_remeshing(
            targetlen=pymeshlab.PureValue(length)
        )
        mesh = meshes.current_mesh()
        return rm.SimplicialComplex(mesh.vertex_matrix(), mesh.face_matrix())

    def unevenness(found: Any) -> float:
        i, j = found.edges.T
        lengths = np.linalg.norm(found.vertices[i] - found.vertices[j], axis=1)
        return float(lengths.std() / lengths.mean())

    def their_path() -> object:
        solver = potpourri3d.EdgeFlipGeodesicSolver(points, rows)
        return np.linalg.norm(
            np.diff(solver.find_geodesic_path(start, count - 1), axis=0), axis=1
        ).sum()

    def off_sphere(found: Any) -> float:
        return float(np.abs(np.linalg.norm(found, axis=1) - 1).mean())

    return [
        Task(
            "stiffness and lumped mass",
            "potpourri3d",
            own_matrices,
            their_matrices,
            None,
        ),
        Task(
            "the same, intrinsic Delaunay",
            "robust_laplacian",
            own_flipped,
            lambda: robust_laplacian.mesh_laplacian(points, rows),
            None,
        ),
        Task(
            "25 eigenvalues",
            "robust_laplacian, SciPy",
            lambda: fresh().calculus.spectrum(25).eigenvalues,
            their_spectrum,
            eigenvalues,
        ),
        Task(
            "harmonic function on a band",
            "libigl",
            lambda: (
                fresh(band, ring.simplices)
                .calculus.poisson(np.zeros(len(band)), rim, harmonic[rim])
                .values
            ),
            lambda: igl.harmonic(band, around, rim, harmonic[rim][:, None], 1)[:, 0],
            mean_error(harmonic),
        ),
        Task(
            "gradient",
            "libigl",
            lambda: fresh().calculus.gradient(height),
            their_gradient,
            mean_error(tangential),
        ),
        Task(
            "exact distances",
            "libigl",
            lambda: fresh().geodesic_distances(start, "exact")[0],
            lambda: igl.exact_geodesic(
                points, rows, VS=np.array([start]), VT=np.arange(count)
            ),
            mean_error(away),
        ),
        *(
            Task(
                f"logarithm map, `{method}`",
                "potpourri3d",
                own_logarithm(method),
                their_logarithm,
                logarithm_error,
            )
            for method in ("heat", "exact")
        ),
        Task(
            "Gaussian curvature by fits",
            "libigl",
            lambda: fresh(long, ellipsoid).calculus.curvature().scalar / 2,
            their_curvature,
            mean_error(gaussian),
        ),
        Task(
            "Gaussian curvature by angles",
            "libigl",
            lambda: fresh(long, ellipsoid).calculus.angle_defects().gaussian_curvature,
            their_defects,
            mean_error(gaussian),
        ),
        Task(
            "level set, its length",
            "VTK",
            lambda: fresh().calculus.level_set(height, 0.2).volume(),
            their_level,
            lambda found: abs(found - length),
        ),
        Task(
            "vertex normals, degrees",
            "trimesh",
            lambda: fresh().vertex_normals,
            their_normals,
            angle,
        ),
        Task(
            "subdivision, off the sphere",
            "trimesh, Loop",
            lambda: fresh().subdivide().vertices,
            their_finer,
            off_sphere,
        ),
        Task(
            "straightened path",
            "potpourri3d",
            lambda: (
                fresh().calculus.shortest_path(start, count - 1, exact=True).volume()
            ),
            their_path,
            lambda found: abs(found - away[-1]),
        ),
        Task(
            "chart, `conformal`",
            "libigl, LSCM",
            own_chart("conformal"),
            their_conformal,
            angles_off,
        ),
        Task(
            "chart, `rigid`",
            "libigl, ARAP",
            own_chart("rigid"),
            their_rigid,
            lengths_off,
        ),
        Task(
            "50 farthest points, covering radius",
            "potpourri3d, loop",
            lambda: fresh().calculus.farthest_points(50),
            their_farthest,
            uncovered,
        ),
        Task(
            "cells of 20 sites",
            "potpourri3d, loop",
            lambda: fresh().calculus.voronoi_cells(chosen),
            their_cells,
            cells_off,
        ),
        Task(
            "mean of 20 vertices",
            "potpourri3d, loop",
            lambda: fresh().calculus.mean(cluster),
            their_mean,
            mean_off,
        ),
        Task(
            "half as many, even; spread of edges",
            "MeshLab",
            lambda: fresh().resample(count // 2),
            their_samples,
            unevenness,
        ),
    ]


@app.command()
def peers(
    count: Annotated[int, typer.Option(min=100, help="Samples.")] = 20_000,
    repeats: Annotated[int, typer.Option(min=1, help="Of which the best.")] = 3,
    only: Annotated[str, typer.Option(help="Tasks whose name has this.")] = "",
    markdown: MarkdownOption = False,
) -> None:
    """CPU seconds and errors beside libraries for triangles, from the same triangles."""

    def best(call: Callable[[], object]) -> tuple[float, object]:
        times, answer = [], None
        for _ in range(repeats):
            start = time.process_time()
            answer = call()
            times.append(time.process_time() - start)
        return min(times), answer

    lines = []
    for task in tasks_beside_others(count):
        if only not in task.name:
            continue
        mine, own = best(task.own)
        other, their = best(task.their)
        errors = ["", ""]
        if task.error is not None:
            errors = [f"{task.error(found):.2g}" for found in (own, their)]
        lines.append(
            [
                (f"{count:,} samples", task.name),
                ("CPU seconds", f"{mine:.3g}"),
                ("error", errors[0]),
                ("beside", task.library),
                ("CPU seconds, other", f"{other:.3g}"),
                ("error, other", errors[1]),
                ("ratio", f"{mine / other:.2g}"),
            ]
        )
    print_lines(lines, markdown=markdown)


if __name__ == "__main__":
    app()
