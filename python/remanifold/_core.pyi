# SPDX-License-Identifier: GPL-3.0-or-later
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

_Progress: TypeAlias = Callable[[str, int, int], object] | None
_Solver: TypeAlias = Callable[
    [
        NDArray[np.float64],
        NDArray[np.float64],
        NDArray[np.uint8],
        NDArray[np.float64],
        NDArray[np.float64],
        NDArray[np.int64],
        NDArray[np.int32],
        NDArray[np.float64],
        Callable[[], bool],
    ],
    NDArray[np.float64],
]

__version__: str

def neighborhoods(
    kind: str,
    matrix: NDArray[np.float64],
    num_neighbors: int,
    search: str,
    checks: int,
    num_threads: int,
    progress: _Progress,
) -> tuple[NDArray[np.int32], NDArray[np.float64], str, float]: ...
def tangent_spaces(
    kind: str,
    matrix: NDArray[np.float64],
    dim: int,
    num_neighbors: int,
    estimator: str,
    search: str,
    checks: int,
    num_threads: int,
    progress: _Progress,
) -> tuple[NDArray[np.float64] | None, NDArray[np.int32], NDArray[np.bool_]]: ...
def tangent_bases(
    points: NDArray[np.float64],
    coefficients: NDArray[np.float64],
    neighbors: NDArray[np.int32],
    scale: float,
    num_threads: int,
    progress: _Progress,
) -> NDArray[np.float64]: ...
def local_regions(
    points: NDArray[np.float64],
    bases: NDArray[np.float64],
    boundary: NDArray[np.bool_],
    search: str,
    checks: int,
    num_threads: int,
    progress: _Progress,
) -> tuple[
    NDArray[np.int64],
    NDArray[np.int32],
    NDArray[np.int64],
    NDArray[np.int32],
    NDArray[np.float64],
]: ...
def clique_complex(
    offsets: NDArray[np.int64],
    indices: NDArray[np.int32],
    dim: int,
    edges: str,
    num_threads: int,
    progress: _Progress,
) -> NDArray[np.int32]: ...
def reconstruct_paper(
    kind: str,
    matrix: NDArray[np.float64],
    dim: int,
    num_neighbors: int,
    estimator: str,
    edges: str,
    outlier_distance: float,
    smoothing: int,
    only_noise: bool,
    search: str,
    checks: int,
    num_threads: int,
    progress: _Progress,
) -> dict[str, Any]: ...
def clean(
    kind: str,
    matrix: NDArray[np.float64],
    dim: int,
    outlier_distance: float,
    smoothing: int,
    only_noise: bool,
    search: str,
    checks: int,
    num_threads: int,
    progress: _Progress,
) -> dict[str, Any]: ...
def reconstruct_manifold(
    kind: str,
    matrix: NDArray[np.float64],
    dim: int,
    num_neighbors: int,
    estimator: str,
    boundary: str,
    boundary_samples: NDArray[np.bool_],
    hole_radius: float,
    outlier_distance: float,
    smoothing: int,
    only_noise: bool,
    search: str,
    checks: int,
    solve: _Solver | None,
    num_threads: int,
    progress: _Progress,
) -> dict[str, Any]: ...
def topology(
    simplices: NDArray[np.int32],
    num_vertices: int,
    num_threads: int,
    progress: _Progress,
) -> dict[str, Any]: ...
def quality(
    kind: str,
    matrix: NDArray[np.float64],
    simplices: NDArray[np.int32],
    num_neighbors: int,
    search: str,
    checks: int,
    num_threads: int,
    progress: _Progress,
) -> dict[str, Any]: ...

class SimplexSearch:
    def __init__(
        self,
        vertices: NDArray[np.float64],
        simplices: NDArray[np.int32],
        num_threads: int,
        progress: _Progress,
    ) -> None: ...
    def nearest(
        self, queries: NDArray[np.float64], num_threads: int, progress: _Progress
    ) -> tuple[
        NDArray[np.float64],
        NDArray[np.int64],
        NDArray[np.float64],
        NDArray[np.float64],
    ]: ...

def component_labels(
    simplices: NDArray[np.int32], num_vertices: int
) -> NDArray[np.int32]: ...
def edges(simplices: NDArray[np.int32], num_vertices: int) -> NDArray[np.int32]: ...
def face_sets(faces: NDArray[np.int32]) -> NDArray[np.int32]: ...
def paper_report(
    simplices: NDArray[np.int32],
    edge_set_offsets: NDArray[np.int64],
    edge_set_indices: NDArray[np.int32],
    star_offsets: NDArray[np.int64],
    star_simplices: NDArray[np.int32],
    boundary: NDArray[np.bool_],
    num_threads: int,
    progress: _Progress,
) -> dict[str, Any]: ...
