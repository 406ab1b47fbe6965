# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a manifold laid flat, with as little distortion as may be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypeAlias, get_args

import numpy as np

from remanifold import _core
from remanifold.calculus.elements import differences
from remanifold.calculus.solving import factorized, scipy_module
from remanifold.complex.parts import face_keys, open_faces

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.calculus.operators import Operators

    Floats = NDArray[np.float64]

ChartMethod: TypeAlias = Literal["auto", "rigid", "conformal", "tangent"]
CHART_METHODS: tuple[str, ...] = get_args(ChartMethod)

# Rounds of rotations and positions, and by how much entries of rotations change in the
# mean when they are over: what is left is little beside the distortion.
_ROUNDS = 20
_STILL = 1e-3


def stretches_of(operators: Operators, coordinates: Floats) -> Floats:
    """By how much each simplex is stretched along its principal axes, (M, K), ascending.

    The first is negative where a simplex is turned over: the frames of the simplices
    are all oriented as those are. Zero where a simplex is flat.
    """
    maps = operators.frame_gradients(coordinates)
    found = np.linalg.svd(maps, compute_uv=False)[:, ::-1].copy()
    found[:, 0] *= np.where(np.linalg.det(maps) < 0, -1.0, 1.0)
    return np.asarray(found)


def rim_of_disc(simplices: NDArray[np.int32]) -> NDArray[np.int32] | None:
    """Vertices of the boundary in their order, where the triangles are a disc."""
    rim = open_faces(simplices)
    if len(rim) < 3:
        return None
    after = {int(i): int(j) for i, j in rim}
    if len(after) < len(rim):  # two ways from a vertex: pinched, or not oriented
        return None
    loop = [int(rim[0, 0])]
    while len(loop) <= len(rim):
        following = after.get(loop[-1])
        if following is None:
            return None
        if following == loop[0]:
            break
        loop.append(following)
    if len(loop) < len(rim):  # more than one loop
        return None
    edges = np.sort(simplices[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    keys = face_keys(edges)
    assert keys is not None  # of two numbers of 31 bits
    euler = len(np.unique(simplices)) - len(np.unique(keys)) + len(simplices)
    return np.array(loop, dtype=np.int32) if euler == 1 else None


def conformal(operators: Operators, rim: NDArray[np.int32]) -> Floats:
    """Least squares conformal map of a disc, its boundary free (Levy et al., 2002).

    The area that triangles cover beside half the Dirichlet energy: equal where a map is
    conformal. Two vertices of the boundary that are far apart are fixed.
    """
    sparse = scipy_module("sparse")
    count = operators.count
    stiffness = operators.stiffness
    i, j = rim, np.roll(rim, -1)
    ones = np.full(len(rim), 0.5)
    area = sparse.csr_array((ones, (i, j)), shape=(count, count))
    area = area - area.T
    # block_array came with SciPy 1.11.
    blocks = sparse.bmat([[stiffness, -area], [area, stiffness]], format="csr")
    whole = sparse.csr_array(blocks)
    start = int(rim[0])
    away = _hops(operators, start)
    first = int(rim[np.argmax(away[rim])])
    last = int(rim[np.argmax(_hops(operators, first)[rim])])
    fixed = np.array([first, last, count + first, count + last])
    values = np.array([0.0, 1.0, 0.0, 0.0])
    free = np.ones(2 * count, dtype=np.bool_)
    free[fixed] = False
    right = -(whole[free][:, fixed] @ values)
    found = np.zeros(2 * count)
    found[fixed] = values
    found[free] = factorized(whole[free][:, free])(right)
    return _sized(operators, np.stack([found[:count], found[count:]], axis=1))


def circular(operators: Operators, rim: NDArray[np.int32]) -> Floats:
    """Each vertex in the mean of its neighbors, the boundary on a circle (Tutte, 1963).

    It turns no triangle over, whatever the distortion.
    """
    sparse = scipy_module("sparse")
    count = operators.count
    i, j = operators.complex.edges.T
    ones = np.ones(len(i))
    graph = sparse.csr_array((ones, (i, j)), shape=(count, count))
    graph = graph + graph.T
    laplacian = sparse.csr_array(sparse.diags(graph.sum(axis=1))) - graph
    steps = np.sqrt(operators.complex._source.squared_distances(rim, np.roll(rim, -1)))
    angles = 2 * np.pi * np.concatenate([[0.0], np.cumsum(steps)[:-1]]) / steps.sum()
    found = np.zeros((count, 2))
    found[rim] = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    inner = np.ones(count, dtype=np.bool_)
    inner[rim] = False
    right = -(laplacian[inner][:, rim] @ found[rim])
    found[inner] = factorized(laplacian[inner][:, inner])(right)
    return _sized(operators, found)


def rigid(operators: Operators, start: Floats) -> Floats:
    """As rigid as possible, from a map that is near (Liu et al., 2008), for any K.

    Rotations that are nearest to the maps of the simplices, and positions that are
    nearest to the rotated simplices, in turns.
    """
    solve = factorized(operators.stiffness[1:, 1:])  # one vertex stays
    flat, frames = operators.elements.flat, operators.elements.frames
    dim = operators.dim
    # Rows are the gradients of the coordinates of all vertices but the first.
    gradients = np.linalg.inv(np.where(flat[:, None, None], np.eye(dim), frames))
    volumes = operators.elements.volumes[:, None, None]
    corners = operators.simplices.ravel()
    found, before = start, np.zeros_like(frames)
    for _ in range(_ROUNDS):
        rotations = _rotations(gradients @ differences(found, operators.simplices))
        if np.abs(rotations - before).mean() < _STILL:
            break
        before = rotations
        pulls = volumes * (gradients.transpose(0, 2, 1) @ rotations)
        pulls = np.concatenate([-pulls.sum(axis=1, keepdims=True), pulls], axis=1)
        sides = [
            np.asarray(
                np.bincount(corners, pulls[:, :, axis].ravel(), operators.count),
                np.float64,
            )
            for axis in range(dim)
        ]
        found = np.zeros_like(start)
        found[1:] = solve(np.stack(sides, axis=1)[1:])
    return found


def _rotations(maps: Floats) -> Floats:
    """The nearest to each, (M, K, K)."""
    if maps.shape[1] == 2:
        cosine = maps[:, 0, 0] + maps[:, 1, 1]
        sine = maps[:, 0, 1] - maps[:, 1, 0]
        size = np.hypot(cosine, sine)
        cosine[size == 0], size[size == 0] = 1.0, 1.0
        cosine, sine = cosine / size, sine / size
        rows = np.stack([cosine, sine, -sine, cosine], axis=1)
        return np.asarray(rows.reshape(-1, 2, 2))
    return _core.nearest_rotations(np.ascontiguousarray(maps))


def _hops(operators: Operators, start: int) -> Floats:
    sparse, csgraph = scipy_module("sparse"), scipy_module("sparse.csgraph")
    i, j = operators.complex.edges.T
    lengths = np.sqrt(operators.complex._source.squared_distances(i, j))
    shape = (operators.count, operators.count)
    graph = sparse.csr_array((lengths, (i, j)), shape=shape)
    return np.asarray(csgraph.dijkstra(graph, directed=False, indices=start))


def _sized(operators: Operators, found: Floats) -> Floats:
    """As large as the surface, and turned over if most triangles are."""
    stretches = stretches_of(operators, found)
    areas = stretches.prod(axis=1) * operators.elements.volumes
    if areas.sum() < 0:
        found = found * [1.0, -1.0]
    covered = np.abs(areas).sum()
    if covered > 0:
        found = found * np.sqrt(operators.elements.volumes.sum() / covered)
    return np.asarray(found - found.mean(axis=0))
