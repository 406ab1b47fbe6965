# SPDX-License-Identifier: GPL-3.0-or-later
"""The definitions of Freedman (2002), section 3, and of the chain, transcribed slowly.

Nothing here is shared with the compiled core and nothing is clever: every step
runs over *all* samples, with the formulas of the paper where it has any and with
Qhull for the convex hulls.  The core is compared with this, step by step.

Decisions of floating point can be ties.  The ``*_margin`` functions say how far
from a tie one was, so that a comparison can tell a wrong answer from an answer
that rounding was free to choose.

The section before the last has the manifold method up to the cavities that close at the
first attempt, with a general solver where the core has programs of its own.

The last section draws the samples that the comparisons run on.
"""

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import combinations
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.optimize
import scipy.sparse
import scipy.sparse.csgraph
import scipy.spatial

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

# Enclosure is 0 <= theta <= 1 up to this.
THETA_TOLERANCE = 1e-12
# Tuples less full than this count as affinely dependent.
DEPENDENT = 1e-14


# --- Input ---------------------------------------------------------------------


def points_from_gram(gram: Floats) -> Floats:
    """Points with the given inner products (the dimension is that of the matrix)."""
    values, vectors = np.linalg.eigh((gram + gram.T) / 2)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))


def points_from_distances(distances: Floats) -> Floats:
    """Points with the given mutual distances, the first one at the origin."""
    squared = np.square(distances)
    return points_from_gram((squared[:, :1] + squared[:1] - squared) / 2)


def representatives(points: Floats) -> Ints:
    """Index of the first sample that coincides with each one."""
    first: dict[tuple[float, ...], int] = {}
    return np.array(
        [first.setdefault(tuple(p), i) for i, p in enumerate(points.tolist())]
    )


def others(points: Floats, x: int) -> Ints:
    """Samples other than x and its copies, one of each set of coinciding ones."""
    first = representatives(points)
    return np.flatnonzero((first == np.arange(len(points))) & (first != first[x]))


# --- NBD(x) --------------------------------------------------------------------


def neighborhood(points: Floats, x: int, num_neighbors: int) -> tuple[Ints, Floats]:
    """The nearest other distinct samples and their distances, ties by index."""
    candidates = others(points, x)
    distance = np.sqrt(np.square(points[candidates] - points[x]).sum(axis=1))
    nearest = np.lexsort((candidates, distance))[:num_neighbors]
    return candidates[nearest], distance[nearest]


def neighborhoods(points: Floats, num_neighbors: int) -> tuple[Ints, Floats]:
    """NBD(x) of each sample and the distances, a row each."""
    rows = [neighborhood(points, x, num_neighbors) for x in range(len(points))]
    return np.stack([row[0] for row in rows]), np.stack([row[1] for row in rows])


# --- Step 1: tangent spaces (section 3.1) --------------------------------------


@cache
def rank_tuples(m: int, size: int) -> Ints:
    """Tuples of neighbor ranks, nearest first: colexicographic order."""
    tuples = sorted(combinations(range(m), size), key=lambda ranks: ranks[::-1])
    return np.array(tuples, np.int64).reshape(-1, size)


def fullness(corners: Floats) -> Floats:
    """Squared volume of tuples (T, K+1, D), 1 with edges at right angles."""
    omega = corners[:, 1:] - corners[:, :1]
    omega = omega / np.linalg.norm(omega, axis=2, keepdims=True)
    return np.asarray(np.linalg.det(omega @ omega.transpose(0, 2, 1)))


def thetas(samples: Floats, corners: Floats) -> Floats:
    """Barycentric coordinates of the projections of samples onto tuples.

    ``samples`` (P, D) and ``corners`` (T, K+1, D) give (T, P, K+1), NaN where the
    corners are affinely dependent.
    """
    origin = corners[:, :1]
    omega = corners[:, 1:] - origin
    zeta = samples - origin
    gram = omega @ omega.transpose(0, 2, 1)
    dependent = fullness(corners) <= DEPENDENT
    gram[dependent] = np.eye(gram.shape[1])
    solution = np.linalg.solve(gram, omega @ zeta.transpose(0, 2, 1))
    lambdas = solution.transpose(0, 2, 1)
    lambdas[dependent] = np.nan
    return np.concatenate([1 - lambdas.sum(axis=2, keepdims=True), lambdas], axis=2)


def within(theta: Floats) -> Bools:
    """Whether all barycentric coordinates lie in [0, 1]; false for NaN."""
    inside = (theta >= -THETA_TOLERANCE) & (theta <= 1 + THETA_TOLERANCE)
    return np.asarray(inside.all(axis=-1))


def enclosed(x: Floats, corners: Floats) -> bool:
    """Whether ``x`` (D,) is enclosed by ``corners`` (K+1, D)."""
    return bool(within(thetas(x[None], corners[None]))[0, 0])


def orthonormal_basis(corners: Floats) -> Floats:
    """Orthonormal rows (K, D) that span the plane through ``corners``."""
    return np.asarray(np.linalg.qr((corners[1:] - corners[0]).T)[0].T)


def chunks(tuples: Ints) -> Iterator[Ints]:
    """Consecutive pieces of growing length: most searches end early."""
    start, length = 0, 64
    while start < len(tuples):
        yield tuples[start : start + length]
        start, length = start + length, min(2 * length, 1024)


def tangent_basis(points: Floats, x: int, nbd: Ints, dim: int) -> Ints | None:
    """The first tuple of NBD(x) that encloses x and none of the others."""
    near = points[nbd]
    for tuples in chunks(rank_tuples(len(nbd), dim + 1)):
        ranks = tuples[within(thetas(points[x][None], near[tuples]))[:, 0]]
        inside = within(thetas(near, near[ranks]))
        np.put_along_axis(inside, ranks, False, axis=1)
        passed = ranks[~inside.any(axis=1)]
        if len(passed):
            return np.asarray(nbd[passed[0]])
    return None


def tuple_margin(points: Floats, x: int, nbd: Ints, corners: Ints) -> float:
    """How clearly a tuple is a tangent basis of x (positive) or is none."""
    if fullness(points[corners][None])[0] < 1e4 * DEPENDENT:
        return 0.0
    tested = np.append(np.setdiff1d(nbd, corners), x)
    theta = thetas(points[tested], points[corners][None])[0]
    inside = np.minimum(theta, 1 - theta).min(axis=1)
    return float(min(inside[-1], -inside[:-1].max(initial=-np.inf)))


class Tangents(NamedTuple):
    simplices: Ints  # (N, K+1), -1 where there is none
    bases: Floats  # (N, K, D), NaN where there is none
    boundary: Bools  # (N,)


def tangent_spaces(points: Floats, dim: int, nbds: Ints) -> Tangents:
    """The tangent basis of each sample; a copy has that of its representative."""
    n, ambient = points.shape
    simplices = np.full((n, dim + 1), -1, np.int64)
    bases = np.full((n, dim, ambient), np.nan)
    for i, first in enumerate(representatives(points)):
        if first != i:
            simplices[i], bases[i] = simplices[first], bases[first]
            continue
        corners = tangent_basis(points, i, nbds[i], dim)
        if corners is not None:
            simplices[i], bases[i] = corners, orthonormal_basis(points[corners])
    return Tangents(simplices, bases, simplices[:, 0] < 0)


# --- Step 2: local regions (section 3.2) ---------------------------------------


class Region(NamedTuple):
    edge_set: Ints  # ascending
    star: Ints  # (S, K+1): x, then the others ascending; rows sorted
    unbounded: bool
    radius: float  # of the farthest vertex; infinite when unbounded


def dual_points(points: Floats, x: int, basis: Floats) -> Floats:
    """gamma / delta for the bisectors of x with others(x), whose sign is such that
    LR(x) is <dual, lambda> <= 1."""
    difference = points[others(points, x)] - points[x]
    delta = np.square(difference).sum(axis=1, keepdims=True) / 2
    return np.asarray(difference @ basis.T / delta)


def hull_with_origin(duals: Floats) -> tuple[Ints, Ints, bool]:
    """Hull of the dual points and the origin, in as many dimensions as they span.

    Returns its vertices other than the origin, its facets that avoid the origin,
    and whether the origin is a vertex.
    """
    dim = duals.shape[1]
    none = np.empty((0, dim), np.int64)
    # A sample straight above is no constraint: its dual point is the origin.
    length = np.linalg.norm(duals, axis=1)
    kept = np.flatnonzero(length > 1e-13 * length.max(initial=0))
    if len(kept) == 0:
        return none[:, 0], none, True
    duals = duals[kept] / length.max()
    values, axes = np.linalg.svd(duals, full_matrices=False)[1:]
    rank = int((values > 1e-13 * values[0]).sum())
    if rank < dim:
        vertices = hull_with_origin(duals @ axes[:rank].T)[0]
        return kept[vertices], none, True
    if dim == 1:
        signed = [(int(duals.argmin()), -1), (int(duals.argmax()), 1)]
        ends = np.array([q for q, sign in signed if sign * duals[q, 0] > 0])
        return kept[ends], kept[ends][:, None], len(ends) < 2
    hull = scipy.spatial.ConvexHull(np.vstack([duals, np.zeros(dim)]))
    vertices = hull.vertices[hull.vertices != len(duals)]
    at_origin = hull.equations[:, -1] > -1e-12
    return kept[vertices], kept[hull.simplices[~at_origin]], bool(at_origin.any())


def local_region(points: Floats, x: int, basis: Floats) -> Region:
    """LR(x) against every other distinct sample."""
    bisected = others(points, x)
    duals = dual_points(points, x, basis)
    vertices, facets, unbounded = hull_with_origin(duals)
    star = np.sort(bisected[facets], axis=1)
    star = np.insert(star[np.lexsort(star.T[::-1])], 0, x, axis=1)
    radius = np.inf
    if not unbounded:
        corners = np.linalg.solve(duals[facets], np.ones((*facets.shape, 1)))
        radius = float(np.linalg.norm(corners, axis=1).max())
    return Region(np.sort(bisected[vertices]), star, unbounded, radius)


def exact_edge_set(points: Floats, x: int, basis: Floats) -> Ints:
    """ES(x) for K = 2 in rational arithmetic: no tie and no scale is out of reach."""

    def exact(row: Floats) -> list[Fraction]:
        return [Fraction(value) for value in row.tolist()]

    def dot(a: list[Fraction], b: list[Fraction]) -> Fraction:
        return sum((s * t for s, t in zip(a, b, strict=True)), Fraction(0))

    center, (first, second) = exact(points[x]), map(exact, basis)
    duals = {(Fraction(0), Fraction(0)): -1}
    for q in others(points, x).tolist():
        alpha = [s - t for s, t in zip(exact(points[q]), center, strict=True)]
        delta = dot(alpha, alpha) / 2
        duals.setdefault((dot(first, alpha) / delta, dot(second, alpha) / delta), q)

    found: set[int] = set()
    for points_of_chain in (sorted(duals), sorted(duals, reverse=True)):
        hull: list[tuple[Fraction, Fraction]] = []
        for u, v in points_of_chain:
            while len(hull) > 1:
                (a, b), (c, d) = hull[-2:]
                if (c - a) * (v - b) > (d - b) * (u - a):
                    break
                hull.pop()
            hull.append((u, v))
        found.update(duals[p] for p in hull)
    return np.array(sorted(found - {-1}), np.int64)


def local_regions(
    points: Floats, bases: Floats, boundary: Bools | None = None
) -> list[Region | None]:
    """The local region of each sample; none for boundary samples and copies."""
    skip = representatives(points) != np.arange(len(points))
    skip |= False if boundary is None else boundary
    return [
        None if skip[i] else local_region(points, i, bases[i])
        for i in range(len(points))
    ]


def edge_sets(regions: Sequence[Region | None]) -> list[Ints]:
    """ES(x), empty where there is no region."""
    none = np.empty(0, np.int64)
    return [none if region is None else region.edge_set for region in regions]


def binding_margin(duals: Floats, q: int) -> float:
    """How far constraint q cuts into the region of the others (a linear program).

    Positive when it binds: by how much the others let <dual_q, lambda> exceed 1,
    counted up to 1.
    """
    duals = duals / np.abs(duals).max()
    limits = np.ones(len(duals))
    limits[q] = 2.0
    program = scipy.optimize.linprog(-duals[q], duals, limits, bounds=(None, None))
    return float(-program.fun - 1)


def facet_margin(duals: Floats, facet: Ints) -> float:
    """How far inside the other constraints the vertex dual to a facet is."""
    try:
        corner = np.linalg.solve(duals[facet], np.ones(len(facet)))
    except np.linalg.LinAlgError:
        return 0.0
    rest = np.delete(duals, facet, axis=0)
    return float(1 - (rest @ corner).max(initial=-np.inf))


# --- Step 3: the simplicial complex (section 3.3) ------------------------------


def graph(sets: Sequence[Ints], edges: str) -> Ints:
    """Pairs i < j of which both ("mutual") or one ("either") lists the other."""
    directed = {(i, int(j)) for i, row in enumerate(sets) for j in row}
    reverse = {(j, i) for i, j in directed}
    chosen = directed & reverse if edges == "mutual" else directed | reverse
    pairs = sorted((i, j) for i, j in chosen if i < j)
    return np.array(pairs, np.int64).reshape(-1, 2)


def cliques(pairs: Ints, size: int) -> Ints:
    """All cliques of the given size, rows and columns ascending."""
    above: dict[int, set[int]] = {}
    for i, j in pairs.tolist():
        above.setdefault(i, set()).add(j)

    def extend(clique: list[int], candidates: set[int]) -> Iterator[list[int]]:
        if len(clique) == size:
            yield clique
            return
        for j in sorted(candidates):
            yield from extend([*clique, j], candidates & above.get(j, set()))

    found = list(extend([], set(pairs.ravel().tolist())))
    return np.array(found, np.int64).reshape(-1, size)


class Complex(NamedTuple):
    neighborhoods: Ints
    tangents: Tangents
    regions: list[Region | None]
    edges: Ints
    simplices: Ints


def reconstruct(
    points: Floats, dim: int, num_neighbors: int | None = None, edges: str = "mutual"
) -> Complex:
    """SC(X), with everything on the way to it."""
    nbds, _ = neighborhoods(points, num_neighbors or 10 * dim)
    tangents = tangent_spaces(points, dim, nbds)
    regions = local_regions(points, tangents.bases, tangents.boundary)
    pairs = graph(edge_sets(regions), edges)
    return Complex(nbds, tangents, regions, pairs, cliques(pairs, dim + 1))


def votes(regions: Sequence[Region | None], dim: int) -> tuple[Ints, Ints]:
    """Star simplices that are in the stars of all their vertices, and the others."""
    stars = [np.sort(region.star, axis=1) for region in regions if region is not None]
    stars.append(np.empty((0, dim + 1), np.int64))
    simplices, number = np.unique(np.vstack(stars), axis=0, return_counts=True)
    return simplices[number == dim + 1], simplices[number <= dim]


def agreed(regions: Sequence[Region | None], dim: int) -> Ints:
    """Simplices that are in the stars of all their vertices."""
    return votes(regions, dim)[0]


# --- The chain of least energy -------------------------------------------------

FIXED_RADIUS = 2.5  # of simplices that stay as they are, in local scales
FIXED_SHARE = 0.7  # of the radius of a hole
LARGEST_RADIUS = 12.0  # of simplices at all
SMALLEST_PATCH = 20
FORBIDDEN = 1e5  # price of an open facet, times its size


def median(values: Floats) -> float:
    """The middle one, of an even number the lower of the two."""
    return float(np.sort(values)[(len(values) - 1) // 2])


def local_scales(points: Floats, dim: int, num_neighbors: int) -> Floats:
    """h: distances to a neighbor of fixed rank, smoothed by a median over neighbors."""
    rank = min(10 if dim == 1 else 2 * dim + 2, num_neighbors, len(points) - 1)
    nearest, distances = neighborhoods(points, rank)
    around = np.column_stack([np.arange(len(points)), nearest])
    return np.array([median(row) for row in distances[:, -1][around]])


def volumes(corners: Floats) -> Floats:
    """Volumes of simplices (T, K+1, D)."""
    dim = corners.shape[1] - 1
    if dim == 0:
        return np.ones(len(corners))
    factor = np.linalg.svd(corners[:, 1:] - corners[:, :1], compute_uv=False)
    return np.asarray(factor.prod(axis=1) / math.factorial(dim))


def circumradii(corners: Floats) -> Floats:
    """Distances from the corners to the point of their plane as far from all."""
    edges = corners[:, 1:] - corners[:, :1]
    half = np.square(edges).sum(axis=2) / 2
    # Of all solutions the shortest, which lies in the plane.
    center = (np.linalg.pinv(edges) @ half[..., None])[..., 0]
    return np.asarray(np.linalg.norm(center, axis=1))


def squared_edges(corners: Floats) -> Floats:
    """The sum over all edges of a simplex."""
    pairs = combinations(range(corners.shape[1]), 2)
    return np.asarray(
        sum(np.square(corners[:, i] - corners[:, j]).sum(axis=1) for i, j in pairs)
    )


def energies(points: Floats, scales: Floats, simplices: Ints) -> Floats:
    """Volume times squared edges, in local scales."""
    corners = points[simplices]
    unit = scales[simplices].mean(axis=1) ** (simplices.shape[1] + 1)
    return volumes(corners) * squared_edges(corners) / unit


def facets_of(simplices: Ints) -> tuple[Ints, Ints]:
    """Facets, each once, and which of them each simplex has."""
    count, arity = simplices.shape
    rows = np.vstack([np.delete(simplices, i, axis=1) for i in range(arity)])
    facets, inverse = np.unique(rows, axis=0, return_inverse=True)
    return facets, inverse.reshape(arity, count).T


def patches(simplices: Ints) -> Ints:
    """Sets of simplices connected through facets, by number."""
    facets, which = facets_of(simplices)
    size = (len(simplices), len(facets))
    entries = (np.repeat(np.arange(size[0]), which.shape[1]), which.ravel())
    has = scipy.sparse.csr_array((np.ones(which.size), entries), shape=size)
    labels = scipy.sparse.csgraph.connected_components(has @ has.T)[1]
    return np.asarray(labels, np.int64)


class Cavities(NamedTuple):
    fixed: Ints
    candidates: Ints
    energies: Floats
    facets: Ints  # of the candidates
    has: Ints  # (candidates, K+1), positions in facets
    fixed_cofaces: Ints  # of each facet
    prices: Floats  # of leaving it open
    dead_ends: int  # facets of one fixed simplex and no candidate


def cavities(
    points: Floats,
    regions: Sequence[Region | None],
    dim: int,
    scales: Floats,
    hole_radius: float | None,
) -> Cavities:
    """What all samples agree on, and what may go between; no hole where it is None."""
    common, disputed = votes(regions, dim)
    simplices = np.vstack([common, disputed])
    radii = circumradii(points[simplices]) / scales[simplices].mean(axis=1)
    limit = FIXED_RADIUS
    if hole_radius is not None:
        limit = min(limit, FIXED_SHARE * hole_radius)
    fixed = (np.arange(len(simplices)) < len(common)) & (radii <= limit)
    usable = radii <= LARGEST_RADIUS

    facets, has = facets_of(simplices)
    cofaces = np.bincount(has[fixed].ravel(), minlength=len(facets))
    fixed &= ~(cofaces[has] > 2).any(axis=1)
    if dim > 1 and fixed.any():
        labels = patches(simplices[fixed])
        sizes = np.bincount(labels)
        small = (sizes < SMALLEST_PATCH) & (sizes < sizes.max())
        fixed[fixed] = ~small[labels]

    # Where the star of a sample is all there, nothing more has room.
    own = np.bincount(simplices[fixed].ravel(), minlength=len(points))
    full = np.array(
        [
            region is not None and not region.unbounded and own[x] == len(region.star)
            for x, region in enumerate(regions)
        ]
    )
    cofaces = np.bincount(has[fixed].ravel(), minlength=len(facets))
    candidate = usable & ~fixed & (cofaces[has] < 2).all(axis=1)
    candidate &= ~full[simplices].any(axis=1)

    chosen = simplices[candidate]
    used, has = np.unique(has[candidate], return_inverse=True)
    size = volumes(points[facets[used]]) / scales[facets[used]].mean(axis=1) ** (
        dim - 1
    )
    price = FORBIDDEN
    if hole_radius is not None:
        price = 2 * (dim + 1) / dim * hole_radius**3
    return Cavities(
        simplices[fixed],
        chosen,
        energies(points, scales, chosen),
        facets[used],
        has.reshape(-1, dim + 1),
        cofaces[used],
        price * size,
        int((cofaces == 1).sum() - (cofaces[used] == 1).sum()),
    )


class Filling(NamedTuple):
    chosen: Bools  # of the candidates
    energy: float  # of these and of what is left open
    open_facets: int
    unique: bool


def fill(cavities: Cavities, gap: float = 1e-7) -> Filling:
    """The filling of least energy, by an integer program over unoriented simplices.

    Every facet has none, one or two cofaces; of one it is open, at its price. On curves
    every sample is to have two edges. Unique is a filling when the next best one has an
    energy larger by more than the relative ``gap``.
    """
    count, arity = cavities.has.shape
    num_facets = len(cavities.facets)
    if count == 0:
        return Filling(np.zeros(0, bool), 0.0, 0, True)
    entries = (cavities.has.ravel(), np.repeat(np.arange(count), arity))
    cofaces = scipy.sparse.csr_array(
        (np.ones(count * arity), entries), shape=(num_facets, count)
    )
    one = scipy.sparse.csr_array(scipy.sparse.identity(num_facets))
    wanted = np.where(cavities.fixed_cofaces > 0, 1.0, 2.0)
    if arity == 2:  # cofaces + open = wanted
        twice, low, high = 0 * one, wanted, wanted
        most_open = wanted
    else:  # fixed cofaces + cofaces + open = 0 or 2
        twice, low = -2 * one, -cavities.fixed_cofaces
        high, most_open = low, np.ones(num_facets)
    matrix = scipy.sparse.hstack([cofaces, one, twice])
    costs = np.concatenate([cavities.energies, cavities.prices, np.zeros(num_facets)])
    bounds = scipy.optimize.Bounds(
        0, np.concatenate([np.ones(count), most_open, np.ones(num_facets)])
    )
    rules = [scipy.optimize.LinearConstraint(matrix, low, high)]

    def solve() -> tuple[Floats, float]:
        result = scipy.optimize.milp(
            costs,
            integrality=np.ones(len(costs)),
            bounds=bounds,
            constraints=rules,
            options={"mip_rel_gap": 0.0},
        )
        assert result.success or result.status == 2, result.message  # infeasible
        if result.x is None:
            return np.empty(0), np.inf
        x = np.round(result.x)
        return x, float(costs @ x)

    x, energy = solve()
    chosen = x[:count] > 0.5
    # Anything but this.
    other = np.concatenate([np.where(chosen, -1.0, 1.0), np.zeros(2 * num_facets)])
    rules.append(scipy.optimize.LinearConstraint(other[None], 1 - chosen.sum(), np.inf))
    _, second = solve()
    return Filling(
        chosen,
        energy,
        int(x[count : count + num_facets].sum()),
        second > energy + gap * max(energy, 1.0),
    )


# --- Samples -------------------------------------------------------------------

# Of every dimension; the rest of the list is for surfaces only.
FAMILIES = ("sphere", "flat torus", "graph", "gaussian", "clusters", "scales")
SURFACES = ("torus", "klein bottle")


def embedded(points: Floats, ambient: int, rng: np.random.Generator) -> Floats:
    """The points in a random frame of a space of larger dimension."""
    frame = np.linalg.qr(rng.normal(size=(ambient, points.shape[1])))[0]
    return np.asarray(points @ frame.T)


def least_ambient_dim(family: str, dim: int) -> int:
    """The smallest dimension that a family of samples fits into."""
    least = {"sphere": dim + 1, "flat torus": 2 * dim, "torus": 3, "klein bottle": 4}
    return least.get(family, dim)


def draw_sample(
    family: str, num: int, dim: int, ambient: int, rng: np.random.Generator
) -> Floats:
    """Random samples (num, ambient) on a manifold of dimension dim, or on none."""
    if family == "sphere":
        points = rng.normal(size=(num, dim + 1))
        points /= np.linalg.norm(points, axis=1, keepdims=True)
    elif family == "flat torus":
        angles = rng.uniform(0, 2 * np.pi, (num, dim))
        points = np.hstack([np.cos(angles), np.sin(angles)])
    elif family in SURFACES:
        u, v = rng.uniform(0, 2 * np.pi, (2, num))
        ring = 2 + np.cos(v)
        height = (
            [np.sin(v)]
            if family == "torus"
            else [np.sin(v) * np.cos(u / 2), np.sin(v) * np.sin(u / 2)]
        )
        points = np.stack([ring * np.cos(u), ring * np.sin(u), *height], axis=1)
    elif family == "graph":
        u = rng.uniform(-1, 1, (num, dim))
        waves = rng.normal(size=(dim, ambient - dim))
        phases = rng.uniform(0, 2 * np.pi, ambient - dim)
        points = np.hstack([u, 0.2 * np.sin(u @ waves + phases)])
    else:
        points = rng.normal(size=(num, ambient))
        if family == "clusters":
            points = 0.05 * points + rng.normal(size=(4, ambient))[np.arange(num) % 4]
        elif family == "scales":
            points *= 10 ** rng.uniform(-4, 0, (num, 1))
    return embedded(points, ambient, rng)
