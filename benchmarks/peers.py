# SPDX-License-Identifier: GPL-3.0-or-later
"""The reconstructions that are measured beside each other.

    python benchmarks/peers.py NAME POINTS N SIMPLICES OPTIONS

is how side_by_side.py runs one that Python calls: on a file of N rows of float64, writing
rows of int32 and printing JSON, like the executable `remanifold_peers` for those in C++.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

PERTURBATION = 0.5  # of the median distance to the nearest neighbor
NORMAL_NEIGHBORS = 30  # Open3D: neighbors for a normal, and
ORIENTATION_NEIGHBORS = 15  # for orienting it, both as in its tutorial
BALL_RADII = (1.0, 2.0, 4.0)  # Open3D: times the mean distance to the nearest neighbor


@dataclass(frozen=True)
class Peer:
    label: str
    module: str | None = None  # what Python has to import; None: the driver in C++
    surfaces_only: bool = False  # K = 2 in R^3
    solids_only: bool = False  # K = 3 in R^3
    own_vertices: bool = False  # not the samples: only the mesh itself can be judged

    def takes(self, dim: int, ambient_dim: int) -> bool:
        if self.solids_only:
            return (dim, ambient_dim) == (3, 3)
        return not self.surfaces_only or (dim, ambient_dim) == (2, 3)


PEERS = {
    "flann": Peer("FLANN 20-NN"),
    "manifold": Peer("remanifold", "remanifold"),
    "paper": Peer("remanifold, method paper", "remanifold"),
    "gudhi": Peer("GUDHI tangential complex", "gudhi"),
    "gudhi_perturbed": Peer("GUDHI, perturbed", "gudhi"),
    "advancing_front": Peer("CGAL advancing front", None, surfaces_only=True),
    "scale_space": Peer("CGAL scale space", None, surfaces_only=True),
    "delaunay": Peer("CGAL Delaunay", None, solids_only=True),
    "open3d_ball_pivoting": Peer("Open3D ball pivoting", "open3d", surfaces_only=True),
    "open3d_poisson": Peer(
        "Open3D Poisson", "open3d", surfaces_only=True, own_vertices=True
    ),
    "pymeshlab_ball_pivoting": Peer(
        "PyMeshLab ball pivoting", "pymeshlab", surfaces_only=True
    ),
}
OWN = ("manifold", "paper")
UNIT = "flann"  # of the ratios
UNIT_MAX_AMBIENT_DIM = 32  # beyond it an exact tree looks at everything


@dataclass(frozen=True)
class Options:
    dim: int
    num_threads: int = 1  # of remanifold; its peers run on one
    time_limit: float = math.inf


class Stopwatch:
    """Measures time and memory of the block it is entered for."""

    seconds = math.nan
    cpu_seconds = math.nan
    peak_bytes: int | None = None  # beyond what was there before

    def __enter__(self) -> None:
        with contextlib.suppress(OSError):
            Path("/proc/self/clear_refs").write_text("5")  # forget the peak so far
        self._resident = _status("VmRSS")
        self._cpu_start = time.process_time()
        self._start = time.perf_counter()

    def __exit__(self, *_: object) -> None:
        self.seconds = time.perf_counter() - self._start
        self.cpu_seconds = time.process_time() - self._cpu_start
        peak = _status("VmHWM")
        if peak is not None and self._resident is not None:
            self.peak_bytes = peak - self._resident


def _status(name: str) -> int | None:
    """A number of bytes from the status of this process."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    for line in lines:
        if line.startswith(f"{name}:"):
            return 1024 * int(line.split()[1])
    return None


# ------------------------------------------------------------------------ peers


def remanifold(points: Any, options: Options, method: str, watch: Stopwatch) -> Any:
    import remanifold as rm

    warnings.simplefilter("ignore", rm.RemanifoldWarning)
    threads = options.num_threads
    rm.reconstruct(rm.datasets.circle(30), 1, method=method)  # loads what it imports
    with watch:
        rec = rm.reconstruct(points, options.dim, method=method, num_threads=threads)
    return rec.simplices


def tangential_complex(
    rows: list[list[float]], dim: int, perturbation: float = 0.0, limit: float = -1.0
) -> Any:
    """GUDHI's simplex tree; perturbed for at most ``limit`` seconds if that is > 0."""
    import gudhi

    complex_ = gudhi.TangentialComplex(dim, points=rows)
    complex_.compute_tangential_complex()
    if perturbation > 0:
        # What is inconsistent in the end stays so.
        complex_.fix_inconsistencies_using_perturbation(
            perturbation, limit if math.isfinite(limit) else -1.0
        )
    return complex_.create_simplex_tree()


def top_simplices(tree: Any, dim: int) -> Any:
    """The K-simplices of a simplex tree."""
    simplices = [s for s, _ in tree.get_skeleton(dim) if len(s) == dim + 1]
    array = np.array(simplices, dtype=np.int32).reshape(-1, dim + 1)
    return np.unique(np.sort(array, axis=1), axis=0)


def gudhi(points: Any, options: Options, perturbed: bool, watch: Stopwatch) -> Any:
    import gudhi  # noqa: F401  not on the watch

    perturbation = limit = 0.0
    if perturbed:
        from samples import spacing

        perturbation, limit = PERTURBATION * spacing(points), options.time_limit / 2
    rows = points.tolist()
    with watch:
        tree = tangential_complex(rows, options.dim, perturbation, limit)
    return top_simplices(tree, options.dim)


def open3d(points: Any, poisson: bool, watch: Stopwatch) -> Any:
    import open3d as o3d

    o3d.utility.set_verbosity_level(o3d.utility.VerbosityLevel.Error)
    mesh_of = o3d.geometry.TriangleMesh
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    with watch:
        cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(NORMAL_NEIGHBORS))
        cloud.orient_normals_consistent_tangent_plane(ORIENTATION_NEIGHBORS)
        if poisson:
            mesh, _ = mesh_of.create_from_point_cloud_poisson(cloud, n_threads=1)
        else:
            mean = np.mean(cloud.compute_nearest_neighbor_distance())
            radii = o3d.utility.DoubleVector(mean * np.array(BALL_RADII))
            mesh = mesh_of.create_from_point_cloud_ball_pivoting(cloud, radii)
    return np.asarray(mesh.triangles)


def pymeshlab_ball_pivoting(points: Any, watch: Stopwatch) -> Any:
    import pymeshlab

    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(vertex_matrix=points))
    with watch:
        meshes.generate_surface_reconstruction_ball_pivoting()
    return meshes.current_mesh().face_matrix()


RUN: dict[str, Callable[[Any, Options, Stopwatch], Any]] = {
    "manifold": lambda p, o, w: remanifold(p, o, "manifold", w),
    "paper": lambda p, o, w: remanifold(p, o, "paper", w),
    "gudhi": lambda p, o, w: gudhi(p, o, False, w),
    "gudhi_perturbed": lambda p, o, w: gudhi(p, o, True, w),
    "open3d_ball_pivoting": lambda p, _, w: open3d(p, False, w),
    "open3d_poisson": lambda p, _, w: open3d(p, True, w),
    "pymeshlab_ball_pivoting": lambda p, _, w: pymeshlab_ball_pivoting(p, w),
}


def main(name: str, points_file: str, count: str, result_file: str, text: str) -> None:
    answer = os.fdopen(os.dup(1), "w", encoding="ascii")
    os.dup2(2, 1)  # some print as they go
    points = np.fromfile(points_file).reshape(int(count), -1)
    watch = Stopwatch()
    simplices = RUN[name](points, Options(**json.loads(text)), watch)
    np.ascontiguousarray(simplices, dtype=np.int32).tofile(result_file)
    json.dump(
        {
            "seconds": watch.seconds,
            "cpu_seconds": watch.cpu_seconds,
            "peak_bytes": watch.peak_bytes,
        },
        answer,
    )
    answer.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
