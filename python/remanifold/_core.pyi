# SPDX-License-Identifier: GPL-3.0-or-later
from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeAlias

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

SIGNIFICANCE: float
KINDS: tuple[str, ...]
SEARCHES: tuple[str, ...]
ESTIMATORS: tuple[str, ...]
EDGE_RULES: tuple[str, ...]
CHECKS: int
OUTLIER_DISTANCE: float
RANDOM_HOLE_RADIUS: float
EVEN_HOLE_RADIUS: float
JET_NEIGHBORS: str
PAPER_NEIGHBORS: str
SCALE_WORDS: str

def jet_neighbors(dim: int) -> int: ...
def paper_neighbors(dim: int) -> int: ...
def scale_neighbors(dim: int) -> int: ...
def opening_decay(dim: int) -> float: ...
def hole_radius_share(dim: int) -> float: ...

class _Samples(Protocol):
    @property
    def kind(self) -> str: ...
    @property
    def matrix(self) -> NDArray[np.float64]: ...

class Options:
    def __init__(
        self,
        *,
        dim: int,
        num_neighbors: int = ...,
        estimator: str | None = ...,
        edges: str = ...,
        boundary: str = ...,
        boundary_samples: NDArray[np.bool_] | None = ...,
        hole_radius: float = ...,
        significance: float = ...,
        outlier_distance: float | None = ...,
        smooth: bool = ...,
        smoothing_neighbors: int = ...,
        only_noise: bool = ...,
        search: str = ...,
        checks: int = ...,
        decisions: Sequence[tuple[Sequence[int] | NDArray[np.int32], bool]] = ...,
    ) -> None: ...

def neighborhoods(
    samples: _Samples,
    *,
    num_neighbors: int,
    search: str,
    checks: int,
    num_threads: int,
    progress: _Progress,
) -> tuple[NDArray[np.int32], NDArray[np.float64], str, float]: ...
def tangent_spaces(
    samples: _Samples,
    *,
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
    *,
    num_threads: int,
    progress: _Progress,
) -> NDArray[np.float64]: ...
def local_regions(
    points: NDArray[np.float64],
    bases: NDArray[np.float64],
    boundary: NDArray[np.bool_],
    *,
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
    *,
    dim: int,
    edges: str,
    num_threads: int,
    progress: _Progress,
) -> NDArray[np.int32]: ...
def fill_cavities(
    points: NDArray[np.float64],
    fixed: NDArray[np.int32],
    candidates: NDArray[np.int32],
    *,
    hole_radius: float,
    search_candidates: int = ...,
    search_oriented: bool = ...,
    largest_program: int = ...,
    window: int = ...,
    refill: int = ...,
    solve: _Solver | None,
    num_threads: int,
    progress: _Progress,
) -> dict[str, Any]: ...
def reconstruct(
    samples: _Samples,
    options: Options,
    *,
    solve: _Solver | None,
    on_other_dim: Callable[[int], None] | None,
    whole: GlobalStatistics | None = ...,
    open_region: tuple[Sequence[int], NDArray[np.float64]] | None = ...,
    num_threads: int,
    progress: _Progress,
) -> dict[str, Any]: ...

class GlobalStatistics:
    def __init__(
        self,
        *,
        low: Sequence[float],
        high: Sequence[float],
        size: int,
        evenness: float = ...,
        affine_dim: int = ...,
        orientable: bool = ...,
        opening_rounds: int = ...,
    ) -> None: ...

SPARSE_SCALE: float

def part_order(
    samples: _Samples, whole: GlobalStatistics, num_threads: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]: ...
def part_spacings(
    samples: _Samples,
    whole: GlobalStatistics,
    dim: int,
    distance: float,
    num_threads: int,
) -> dict[str, Any]: ...
def noise_at(
    samples: _Samples,
    whole: GlobalStatistics,
    dim: int,
    probes: Sequence[int],
    num_threads: int,
) -> NDArray[np.float64]: ...
def shows_noise(
    samples: _Samples, whole: GlobalStatistics, dim: int, tests: Sequence[float]
) -> bool: ...
def outliers_at(
    samples: _Samples,
    whole: GlobalStatistics,
    dim: int,
    distance: float,
    median: float,
    apart: Sequence[int],
    probes: Sequence[int],
    num_threads: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]: ...
def outlier_probe_stride(size: int) -> int: ...
def least_outlier_distance(distance: float, relative: Sequence[float]) -> float: ...
def num_noise_probes(size: int) -> int: ...
def noise_probe(i: int, size: int) -> int: ...
def oriented_patches(
    simplices: NDArray[np.int32], num_vertices: int, num_threads: int
) -> tuple[NDArray[np.int32], NDArray[np.int8], NDArray[np.bool_]]: ...
def evenness_of(tenth: float, dim: int) -> float: ...
def reconstruct_paper(
    samples: _Samples, options: Options, *, num_threads: int, progress: _Progress
) -> dict[str, Any]: ...
def clean(
    samples: _Samples, options: Options, *, num_threads: int, progress: _Progress
) -> dict[str, Any]: ...
def topology(
    simplices: NDArray[np.int32],
    num_vertices: int,
    num_threads: int,
    progress: _Progress,
) -> dict[str, Any]: ...
def quality(
    samples: _Samples,
    simplices: NDArray[np.int32],
    tangents: NDArray[np.float64] | None,
    *,
    num_neighbors: int,
    num_listed: int,
    search: str,
    checks: int,
    num_threads: int,
    progress: _Progress,
) -> dict[str, Any]: ...
def list_neighbors(
    samples: _Samples,
    count: int,
    *,
    search: str,
    checks: int,
    num_threads: int,
    progress: _Progress,
) -> tuple[NDArray[np.int32], NDArray[np.int32]]: ...
def local_spreads(
    points: NDArray[np.float64],
    samples: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    sizes: list[int],
    num_spreads: int,
    num_threads: int,
) -> NDArray[np.float64]: ...
def affine_dim(points: NDArray[np.float64], num_threads: int) -> int: ...
def lie_on_curve(
    points: NDArray[np.float64],
    samples: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    num_threads: int,
) -> NDArray[np.bool_]: ...

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

def simplify(
    vertices: NDArray[np.float64],
    simplices: NDArray[np.int32],
    fixed: NDArray[np.uint8],
    *,
    num_vertices: int,
    max_error: float,
    even: bool,
    progress: _Progress,
) -> tuple[NDArray[np.int32], NDArray[np.float64]]: ...
def intrinsic_delaunay(
    triangles: NDArray[np.int32],
    lengths: NDArray[np.float64],
    both_sides: bool = False,
) -> tuple[NDArray[np.int32], NDArray[np.float64], int, bool]: ...
def surface_distances(
    triangles: NDArray[np.int32],
    lengths: NDArray[np.float64],
    num_vertices: int,
    sources: NDArray[np.int32],
) -> NDArray[np.float64]: ...
def linear_elements(
    points: NDArray[np.float64], simplices: NDArray[np.int32]
) -> tuple[
    NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]
]: ...
def linear_elements_of_lengths(
    dim: int, squares: NDArray[np.float64]
) -> tuple[
    NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]
]: ...
def nearest_rotations(maps: NDArray[np.float64]) -> NDArray[np.float64]: ...
def second_forms(
    points: NDArray[np.float64],
    edges: NDArray[np.int32],
    dim: int,
    vertices: NDArray[np.int32],
    num_threads: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...

class SparseFactors:
    def __init__(
        self,
        offsets: NDArray[np.int32],
        rows: NDArray[np.int32],
        values: NDArray[np.float64],
    ) -> None: ...
    @property
    def entries(self) -> int: ...
    def solve(self, right: NDArray[np.float64]) -> NDArray[np.float64]: ...

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
