# SPDX-License-Identifier: GPL-3.0-or-later
"""Complexes of known topology, random ones against GUDHI, and the repair report."""

import dataclasses
from collections import Counter
from itertools import chain, combinations, permutations, product

import gudhi
import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

import remanifold as rm
from remanifold.method.options import METHODS

# --- Complexes: sets of simplices, which are sets of vertices of any kind ---------


def simplex_boundary(dim):
    """The sphere of this dimension."""
    return {frozenset(s) for s in combinations(range(dim + 2), dim + 1)}


def grid(*sizes, glue=lambda vertex: vertex):
    """Freudenthal triangulation of a grid of cubes; `glue` names equal vertices."""
    simplices = set()
    for corner in product(*map(range, sizes)):
        for axes in permutations(range(len(sizes))):
            walk = [corner]
            for axis in axes:
                step = list(walk[-1])
                step[axis] += 1
                walk.append(tuple(step))
            simplices.add(frozenset(map(glue, walk)))
    assert {len(s) for s in simplices} == {len(sizes) + 1}
    return simplices


def torus(*sizes):
    """A torus of each dimension for which a size is given."""
    return grid(
        *sizes, glue=lambda v: tuple(x % n for x, n in zip(v, sizes, strict=True))
    )


def wrapped(width, height, flip):
    """A closed strip, with a twist or without."""

    def glue(vertex):
        turns, x = divmod(vertex[0], width)
        return (x, height - vertex[1] if flip and turns % 2 else vertex[1])

    return grid(width, height, glue=glue)


def klein_bottle(width=4, height=5):
    def glue(vertex):
        turns, x = divmod(vertex[0], width)
        return (x, (-vertex[1] if turns % 2 else vertex[1]) % height)

    return grid(width, height, glue=glue)


def subdivided(simplices):
    """Barycentric subdivision: the flags of faces."""
    return {
        frozenset(frozenset(order[:n]) for n in range(1, len(order) + 1))
        for simplex in simplices
        for order in permutations(simplex)
    }


def projective_space(dim):
    """Cross polytope, subdivided, by its antipodal map."""
    signs = product((1, -1), repeat=dim + 1)
    polytope = [[sign * (axis + 1) for axis, sign in enumerate(s)] for s in signs]

    def glue(face):
        return min(tuple(sorted(face)), tuple(sorted(-v for v in face)))

    return {frozenset(map(glue, flag)) for flag in subdivided(polytope)}


def lens_space(order):
    """Join of two polygons, subdivided, by a rotation of both."""
    sides = 3 * order
    edges = [(i, (i + 1) % sides) for i in range(sides)]
    join = [[("a", i) for i in e] + [("b", i) for i in f] for e in edges for f in edges]

    def turned(face, turn):
        return tuple(sorted((name, (i + 3 * turn) % sides) for name, i in face))

    def glue(face):
        return min(turned(face, turn) for turn in range(order))

    return {frozenset(map(glue, flag)) for flag in subdivided(join)}


def union(*parts):
    return {frozenset((i, v) for v in s) for i, part in enumerate(parts) for s in part}


def wedge(*parts):
    """One vertex of each part is common to all."""
    joined = [(i, min(min(s) for s in part)) for i, part in enumerate(parts)]
    return {frozenset("common" if v in joined else v for v in s) for s in union(*parts)}


def cone(simplices, *apexes):
    """Two apexes make a suspension."""
    return {s | {f"apex {apex}"} for s in simplices for apex in apexes or (1,)}


def suspension(simplices):
    return cone(simplices, 1, 2)


def prism(simplices):
    """Product with an interval."""
    return {
        frozenset([(v, 0) for v in order[: i + 1]] + [(v, 1) for v in order[i:]])
        for order in (sorted(s, key=repr) for s in simplices)
        for i in range(len(order))
    }


def fan(sheets, dim):
    """Simplices around a common facet."""
    return {frozenset([*range(dim), ("sheet", i)]) for i in range(sheets)}


SEVEN = {
    frozenset((i + j) % 7 for j in t) for i in range(7) for t in [(0, 1, 3), (0, 2, 3)]
}
SIX = {frozenset((i, (i + 1) % 5, j)) for i in range(5) for j in (5, (i + 3) % 5)}


def as_array(simplices, seed=0):
    """Rows in any order, of scattered vertices; also their number."""
    names = sorted({v for s in simplices for v in s}, key=repr)
    rng = np.random.default_rng(seed)
    numbers = rng.choice(2 * len(names) + 3, len(names), replace=False).tolist()
    number = dict(zip(names, numbers, strict=True))
    rows = sorted(sorted(number[v] for v in s) for s in simplices)
    rows = np.array(rows, dtype=np.int32)[rng.permutation(len(rows))]
    return rows, 2 * len(names) + 3, number


# --- Known manifolds ------------------------------------------------------------

CLOSED = {  # Betti numbers over Z2 and Z3, orientable
    "triangle": (simplex_boundary(1), (1, 1), (1, 1), True),
    "polygon": (torus(9), (1, 1), (1, 1), True),
    "two_circles": (union(torus(3), torus(5)), (2, 2), (2, 2), True),
    "tetrahedron": (simplex_boundary(2), (1, 0, 1), (1, 0, 1), True),
    "octahedron": (suspension(torus(4)), (1, 0, 1), (1, 0, 1), True),
    "torus_of_seven": (SEVEN, (1, 2, 1), (1, 2, 1), True),
    "torus": (torus(3, 4), (1, 2, 1), (1, 2, 1), True),
    "plane_of_six": (SIX, (1, 1, 1), (1, 0, 0), False),
    "plane": (projective_space(2), (1, 1, 1), (1, 0, 0), False),
    "klein_bottle": (klein_bottle(), (1, 2, 1), (1, 1, 0), False),
    "torus_and_plane": (union(SEVEN, SIX), (2, 3, 2), (2, 2, 1), False),
    "sphere3": (simplex_boundary(3), (1, 0, 0, 1), (1, 0, 0, 1), True),
    "suspended2": (cone(suspension(torus(3)), 3, 4), (1, 0, 0, 1), (1, 0, 0, 1), True),
    "torus3": (torus(3, 3, 4), (1, 3, 3, 1), (1, 3, 3, 1), True),
    "space": (projective_space(3), (1, 1, 1, 1), (1, 0, 0, 1), True),
    "lens3": (lens_space(3), (1, 0, 0, 1), (1, 1, 1, 1), True),
    "spheres3": (union(*[simplex_boundary(3)] * 3), (3, 0, 0, 3), (3, 0, 0, 3), True),
    "sphere4": (simplex_boundary(4), (1, 0, 0, 0, 1), (1, 0, 0, 0, 1), True),
    "suspended3": (
        cone(cone(suspension(torus(4)), 3, 4), 5, 6),
        (1, 0, 0, 0, 1),
        (1, 0, 0, 0, 1),
        True,
    ),
    "torus4": (torus(3, 3, 3, 3), (1, 4, 6, 4, 1), (1, 4, 6, 4, 1), True),
    "sphere5": (simplex_boundary(5), (1, 0, 0, 0, 0, 1), (1, 0, 0, 0, 0, 1), True),
}
BOUNDED = {
    "edge": (grid(1), (1, 0), (1, 0), True),
    "path": (grid(7), (1, 0), (1, 0), True),
    "disk": (grid(3, 4), (1, 0, 0), (1, 0, 0), True),
    "annulus": (wrapped(5, 2, flip=False), (1, 1, 0), (1, 1, 0), True),
    "moebius": (wrapped(5, 2, flip=True), (1, 1, 0), (1, 1, 0), False),
    "disk_and_sphere": (
        union(grid(2, 2), simplex_boundary(2)),
        (2, 0, 1),
        (2, 0, 1),
        True,
    ),
    "ball": (grid(3, 2, 3), (1, 0, 0, 0), (1, 0, 0, 0), True),
    "thick_torus": (
        grid(3, 3, 2, glue=lambda v: (v[0] % 3, v[1] % 3, v[2])),
        (1, 2, 1, 0),
        (1, 2, 1, 0),
        True,
    ),
    "thick_sphere": (
        {s for s in grid(4, 4, 4) if (2, 2, 2) not in s},
        (1, 0, 1, 0),
        (1, 0, 1, 0),
        True,
    ),
    "ball4": (cone(simplex_boundary(3)), (1, 0, 0, 0, 0), (1, 0, 0, 0, 0), True),
    "thick_torus3": (
        prism(torus(3, 3, 3)),
        (1, 3, 3, 1, 0),
        (1, 3, 3, 1, 0),
        True,
    ),
    "thick_sphere4": (
        prism(simplex_boundary(4)),
        (1, 0, 0, 0, 1, 0),
        (1, 0, 0, 0, 1, 0),
        True,
    ),
    "cube4": (grid(1, 2, 1, 2), (1, 0, 0, 0, 0), (1, 0, 0, 0, 0), True),
}


@pytest.mark.parametrize("name", [*CLOSED, *BOUNDED])
def test_manifolds(name):
    simplices, over_2, over_3, orientable = (CLOSED | BOUNDED)[name]
    rows, num_vertices, _ = as_array(simplices)
    topology = rm.compute_topology(rows, num_vertices)
    dim = len(over_2) - 1
    assert topology.dim == dim
    faces = {
        f for s in simplices for n in range(dim + 1) for f in combinations(s, n + 1)
    }
    counts = Counter(map(len, {frozenset(face) for face in faces}))
    assert topology.num_simplices == tuple(counts[n + 1] for n in range(dim + 1))
    assert topology.num_vertices == counts[1]
    assert topology.betti_numbers == over_2
    assert topology.betti_numbers_mod3 == over_3
    for betti in (over_2, over_3):
        euler = sum((-1) ** k * b for k, b in enumerate(betti))
        assert topology.euler_characteristic == euler
    assert topology.components == over_2[0]
    assert topology.manifold
    assert topology.singular_vertices.tolist() == []
    assert topology.closed == (name in CLOSED)
    assert topology.orientable == orientable
    assert set(topology.coface_counts) <= {1, 2}
    assert (1 in topology.coface_counts) == (name in BOUNDED)
    assert sum(n * f for n, f in topology.coface_counts.items()) == (
        (dim + 1) * len(simplices)
    )


# --- What is no manifold --------------------------------------------------------

POINT, APEX, APEXES = ("common",), ("apex 1",), ("apex 1", "apex 2")
SINGULAR = {  # vertices, Betti numbers over Z2, cofaces of facets, orientable
    "circles_at_a_point": (wedge(torus(4), torus(3)), POINT, (1, 2), {2: 5, 4: 1}),
    "fork": (fan(3, 1), (0,), (1, 0), {1: 3, 3: 1}),
    "spheres_at_a_point": (
        wedge(simplex_boundary(2), simplex_boundary(2)),
        POINT,
        (1, 0, 2),
        {2: 12},
    ),
    "torus_and_plane_at_a_point": (wedge(SEVEN, SIX), POINT, (1, 3, 2), {2: 36}),
    "triangles_at_a_point": (
        wedge(simplex_boundary(1), simplex_boundary(1)),
        POINT,
        (1, 2),
        {2: 4, 4: 1},
    ),
    "book": (fan(3, 2), (0, 1), (1, 0, 0), {1: 6, 3: 1}),
    "book4": (fan(4, 2), (0, 1), (1, 0, 0), {1: 8, 4: 1}),
    "cone_over_a_fork": (cone(fan(3, 1)), (0, *APEX), (1, 0, 0), {1: 6, 3: 1}),
    "book_of_solids": (fan(3, 3), (0, 1, 2), (1, 0, 0, 0), {1: 9, 3: 1}),
    "cone_over_a_torus": (cone(SEVEN), APEX, (1, 0, 0, 0), {1: 14, 2: 21}),
    "cone_over_a_plane": (cone(SIX), APEX, (1, 0, 0, 0), {1: 10, 2: 15}),
    "cone_over_spheres": (
        cone(union(*[simplex_boundary(2)] * 2)),
        APEX,
        (1, 0, 0, 0),
        {1: 8, 2: 12},
    ),
    "suspended_torus": (suspension(SEVEN), APEXES, (1, 0, 2, 1), {2: 56}),
    "suspended_plane": (suspension(SIX), APEXES, (1, 0, 1, 1), {2: 40}),
    "suspended_annulus": (
        suspension(wrapped(4, 1, flip=False)),
        APEXES,
        (1, 0, 1, 0),
        {1: 16, 2: 24},
    ),
    "cone_over_torus3": (
        cone(torus(3, 3, 3)),
        APEX,
        (1, 0, 0, 0, 0),
        {1: 162, 2: 324},
    ),
    "suspended_torus3": (
        suspension(torus(3, 3, 3)),
        APEXES,
        (1, 0, 3, 3, 1),
        {2: 810},
    ),
    "cone_over_space": (
        cone(projective_space(3)),
        APEX,
        (1, 0, 0, 0, 0),
        {1: 192, 2: 384},
    ),
    "cone_over_lens3": (cone(lens_space(3)), APEX, (1, 0, 0, 0, 0), {1: 648, 2: 1296}),
    "cone_over_spheres3": (
        cone(union(*[simplex_boundary(3)] * 2)),
        APEX,
        (1, 0, 0, 0, 0),
        {1: 10, 2: 20},
    ),
    "twice_suspended_torus": (
        cone(suspension(SEVEN), 3, 4),
        tuple(f"apex {i}" for i in (1, 2, 3, 4)),
        (1, 0, 0, 2, 1),
        {2: 140},
    ),
    "prism_over_a_cone": (
        prism(cone(torus(3, 3, 3))),
        (("apex 1", 0), ("apex 1", 1)),
        (1, 0, 0, 0, 0, 0),
        {1: 972, 2: 1944},
    ),
    "book_of_4_simplices": (fan(3, 4), (0, 1, 2, 3), (1, 0, 0, 0, 0), {1: 12, 3: 1}),
}


def test_some_singular_vertices_pass_in_dimension_4():
    """Homology over Z2 and Z3 takes a lens space of order 5 for a sphere."""
    rows, num_vertices, _ = as_array(cone(lens_space(5)))
    assert rm.compute_topology(rows, num_vertices).manifold


@pytest.mark.parametrize("name", SINGULAR)
def test_singular_vertices_are_named(name):
    simplices, singular, betti, cofaces = SINGULAR[name]
    rows, num_vertices, number = as_array(simplices)
    topology = rm.compute_topology(rows, num_vertices)
    assert not topology.manifold
    assert topology.singular_vertices.tolist() == sorted(number[v] for v in singular)
    assert topology.singular_vertices.dtype == np.int32
    assert topology.betti_numbers == betti
    assert topology.coface_counts == cofaces
    assert topology.closed == (set(cofaces) == {2})
    assert topology.orientable == (max(cofaces) <= 2 and "plane" not in name)


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
def test_empty_complex(dim):
    topology = rm.compute_topology(np.empty((0, dim + 1), np.int32), 5)
    assert topology.num_simplices == topology.betti_numbers == (0,) * (dim + 1)
    assert topology.betti_numbers_mod3 == (0,) * (dim + 1)
    assert (topology.components, topology.euler_characteristic) == (0, 0)
    assert topology.coface_counts == {}
    assert not topology.manifold
    assert not topology.closed
    assert not topology.orientable


def test_vertices_need_not_be_used():
    rows = np.array([[10, 20, 30]], np.int32)
    for num_vertices in (31, 1000):
        topology = rm.compute_topology(rows, num_vertices)
        assert topology.num_simplices == (3, 3, 1)
        assert topology.components == 1


# --- Random complexes -----------------------------------------------------------


def parts_of(dim, rng):
    """Pure complexes of any kind, and random parts of manifolds."""
    wholes = [
        s for s, betti, *_ in (CLOSED | BOUNDED).values() if len(betti) == dim + 1
    ]
    for _ in range(40):
        vertices = int(rng.integers(dim + 2, 9))
        every = list(combinations(range(vertices), dim + 1))
        count = int(rng.integers(1, min(len(every), 4 * vertices) + 1))
        yield {
            frozenset(every[i]) for i in rng.choice(len(every), count, replace=False)
        }
    for whole in wholes:
        ordered = sorted(whole, key=lambda s: sorted(map(repr, s)))
        for share in (0.5, 0.8, 0.95, 1):
            kept = {s for s in ordered if rng.uniform() < share}
            if 0 < len(kept) < 700:
                yield kept


def homology(simplices, modulus):
    tree = gudhi.SimplexTree()
    for simplex in simplices:
        tree.insert(sorted(simplex))
    tree.compute_persistence(modulus, persistence_dim_max=True)
    return tree.betti_numbers()


def is_sphere_or_ball(simplices):
    """By definition, up to dimension 2."""
    dim = len(next(iter(simplices))) - 1
    cofaces = Counter(frozenset(f) for s in simplices for f in combinations(s, dim))
    if dim == 0:
        return len(simplices) <= 2
    faces = {
        f for s in simplices for n in range(dim + 1) for f in combinations(s, n + 1)
    }
    counts = Counter(map(len, set(map(frozenset, faces))))
    euler = sum((-1) ** (size - 1) * count for size, count in counts.items())
    closed = 2 if dim == 2 else 0
    return (
        homology(simplices, 2)[0] == 1
        and max(cofaces.values()) <= 2
        and euler == (1 if 1 in cofaces.values() else closed)
        and all(map(is_sphere_or_ball, links(simplices).values()))
    )


def links(simplices):
    vertices = set(chain.from_iterable(simplices))
    return {v: {s - {v} for s in simplices if v in s} for v in vertices}


def orientations_agree(simplices, cofaces):
    """Whether signs exist that cancel on every shared facet."""
    signs = {}
    neighbors = {s: [] for s in simplices}
    for face, (one, *others) in cofaces.items():
        for other in others:
            parity = [sorted(s).index(*(s - face)) for s in (one, other)]
            sign = -1 if sum(parity) % 2 == 0 else 1
            neighbors[one].append((other, sign))
            neighbors[other].append((one, sign))
    for seed in simplices:
        stack = [] if seed in signs else [seed]
        signs.setdefault(seed, 1)
        while stack:
            simplex = stack.pop()
            for other, sign in neighbors[simplex]:
                if other not in signs:
                    signs[other] = sign * signs[simplex]
                    stack.append(other)
                elif signs[other] != sign * signs[simplex]:
                    return False
    return True


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_random_complexes(dim):
    seen = Counter()
    for i, simplices in enumerate(parts_of(dim, np.random.default_rng(dim))):
        rows, num_vertices, _ = as_array(simplices, seed=i)
        topology = rm.compute_topology(rows, num_vertices)
        simplices = [frozenset(row) for row in rows.tolist()]
        for modulus, betti in (
            (2, topology.betti_numbers),
            (3, topology.betti_numbers_mod3),
        ):
            expected = homology(simplices, modulus)
            assert betti == (*expected, *[0] * (dim + 1 - len(expected)))
        assert topology.components == topology.betti_numbers[0]

        cofaces = {}
        for simplex in simplices:
            for face in combinations(simplex, dim):
                cofaces.setdefault(frozenset(face), []).append(simplex)
        counts = Counter(map(len, cofaces.values()))
        assert topology.coface_counts == counts
        assert topology.closed == (set(counts) == {2})
        assert topology.orientable == (
            max(counts) <= 2 and orientations_agree(simplices, cofaces)
        )
        singular = [v for v, l in links(simplices).items() if not is_sphere_or_ball(l)]
        assert topology.singular_vertices.tolist() == sorted(singular)
        assert topology.manifold == (not singular)
        for fact in ("manifold", "closed", "orientable", "counting_settles_homology"):
            seen[fact, getattr(topology, fact)] += 1
    # Cases of all kinds were met.
    for fact in ("manifold", "closed", "orientable"):
        assert min(seen[fact, True], seen[fact, False]) >= 3
    assert (seen["counting_settles_homology", True] >= 3) == (dim < 3)


# --- The report of a reconstruction ---------------------------------------------


def disk(radius=7.0):
    """Samples near a triangular lattice, far from any tie."""
    i, j = np.divmod(np.arange(900), 30)
    points = np.stack([i + j % 2 / 2, j * np.sqrt(3) / 2], axis=1)
    points -= points.mean(axis=0)
    points = points[np.linalg.norm(points, axis=1) < radius]
    return points + np.random.default_rng(0).normal(size=points.shape) * 0.03


@pytest.fixture(scope="module")
def plate():
    rec = rm.reconstruct(disk(), 2, method="paper")
    topology = rec.topology()
    assert topology.manifold
    assert topology.betti_numbers == (1, 0, 0)
    return rec


def edited(rec, removed=(), added=()):
    """The same samples with other simplices."""
    rows = {tuple(row) for row in rec.simplices.tolist()}
    rows = sorted(rows.difference(removed).union(added))
    return dataclasses.replace(rec, simplices=np.array(rows, dtype=np.int32))


def faces_of(rec, num_cofaces):
    dim = rec.dim
    faces = chain.from_iterable(
        combinations(row, dim) for row in rec.simplices.tolist()
    )
    counts = Counter(faces)
    return sorted(list(face) for face, count in counts.items() if num_cofaces(count))


def inner_triangles(rec):
    """Triangles away from the rim, the most central first."""
    center = rec.vertices[rec.simplices].mean(axis=1)
    order = np.argsort(np.linalg.norm(center, axis=1))
    return [tuple(row) for row in rec.simplices[order].tolist()]


def test_a_clean_result_has_nothing_to_report(plate):
    report = plate.repair
    assert report.method == "paper"
    assert report.callous_faces.shape == (0, 2)
    assert report.unstarred_simplices.shape == (0, 3)
    assert report.num_callouses == 0
    assert report.num_holes == 0
    assert report.num_boundary_components == 1
    assert report.open_faces.tolist() == faces_of(plate, lambda n: n == 1)
    assert report.unused_vertices.tolist() == np.flatnonzero(plate.boundary).tolist()
    assert report.merged_samples == 0


def test_three_triangles_on_an_edge(plate):
    (i, j, _), far = inner_triangles(plate)[0], int(plate.simplices.max())
    sheet = tuple(sorted((i, j, far)))
    rec = edited(plate, added=[sheet])
    assert rec.repair.callous_faces.tolist() == [[i, j]]
    assert rec.repair.unstarred_simplices.tolist() == [list(sheet)]
    assert rec.repair.num_callouses == 2
    assert rec.topology().coface_counts[3] == 1
    assert {i, j} <= {*rec.topology().singular_vertices.tolist()}
    assert not rec.topology().manifold
    assert not rec.topology().orientable


@pytest.mark.parametrize(
    ("which", "num_holes"),
    [([0], 1), ([0, 1], 1), ([0, 30], 2), ([0, 30, 60], 3), ([], 0)],
)
def test_holes_are_told_from_the_rim(plate, which, num_holes):
    triangles = inner_triangles(plate)
    # Neighbors of the first come next, others keep away from each other.
    first = next(t for t in triangles[1:] if len({*t} & {*triangles[0]}) == 2)
    triangles.remove(first)
    triangles.insert(1, first)
    removed = [triangles[i] for i in which]
    apart = [{*t} for i, t in zip(which, removed, strict=True) if i != 1]
    assert sum(map(len, apart)) == len(set().union(*apart))
    rec = edited(plate, removed)
    shared = 1 if 1 in which else 0
    assert rec.repair.num_holes == num_holes
    assert rec.repair.num_boundary_components == 1
    assert len(rec.repair.open_faces) == (
        len(plate.repair.open_faces) + 3 * len(which) - 2 * shared
    )
    assert rec.topology().betti_numbers == (1, num_holes, 0)
    assert rec.topology().manifold
    assert rec.repair.num_callouses == 0


def test_a_notch_in_the_rim_is_no_hole(plate):
    open_faces = {tuple(face) for face in plate.repair.open_faces.tolist()}
    removed = next(
        row
        for row in map(tuple, plate.simplices.tolist())
        if sum(face in open_faces for face in combinations(row, 2)) == 1
    )
    report = edited(plate, [removed]).repair
    assert (report.num_holes, report.num_boundary_components) == (0, 1)


@pytest.mark.parametrize("method", METHODS)
def test_boundaries_of_several_parts(method):
    rec = rm.reconstruct(np.vstack([disk(5.0), disk(5.0) + 99]), 2, method=method)
    assert (rec.repair.num_holes, rec.repair.num_boundary_components) == (0, 2)
    ring = disk(10.0)
    ring = ring[np.linalg.norm(ring, axis=1) > 5.0]
    rec = rm.reconstruct(ring, 2, method=method, num_neighbors=8)
    assert rec.topology().betti_numbers == (1, 1, 0)
    assert (rec.repair.num_holes, rec.repair.num_boundary_components) == (0, 2)


@pytest.mark.parametrize("method", METHODS)
def test_ends_of_curves(method):
    t = np.sort(np.random.default_rng(0).uniform(size=60))
    arc = np.stack([t, t**2], axis=1)
    rec = rm.reconstruct(np.vstack([arc, arc + 9]), 1, method=method)
    assert len(rec.repair.open_faces) == 4
    assert rec.repair.num_boundary_components == 4
    circle = rm.datasets.circle(60, random_state=0)
    closed = rm.reconstruct(circle, 1, method=method)
    assert closed.repair.open_faces.shape == (0, 1)
    assert closed.repair.num_boundary_components == 0


SAMPLES = {
    "circle": (1, rm.datasets.circle(40, random_state=0)),
    "spiral": (1, rm.datasets.spiral(60, random_state=0)),
    "sphere": (2, rm.datasets.sphere(300, random_state=0)),
    "torus": (2, rm.datasets.torus(300, random_state=0)),
    "annulus": (2, rm.datasets.annulus(300, random_state=0)),
    "moebius": (2, rm.datasets.moebius_band(300, random_state=0)),
    "ball": (3, rm.datasets.ball(300, random_state=0)),
    "torus3": (3, rm.datasets.flat_torus(300, dim=3, random_state=0)),
}


@pytest.mark.parametrize("name", SAMPLES)
def test_reports_follow_their_definitions(name):
    dim, points = SAMPLES[name]
    n = len(points)
    rec = rm.reconstruct(np.vstack([points, points[:3]]), dim, method="paper")
    report = rec.repair
    assert report.callous_faces.tolist() == faces_of(rec, lambda count: count > 2)
    assert report.open_faces.tolist() == faces_of(rec, lambda count: count == 1)
    in_stars = {frozenset(row) for row in rec.stars.simplices.tolist()}
    unstarred = [row for row in rec.simplices.tolist() if {*row} not in in_stars]
    assert report.unstarred_simplices.tolist() == unstarred
    unused = sorted({*range(n)} - {*rec.simplices.ravel().tolist()})
    assert report.unused_vertices.tolist() == unused
    assert report.merged_samples == 3

    edge_sets = np.split(rec.edge_sets.indices, rec.edge_sets.offsets[1:-1])
    at_rim = [
        bool(rec.boundary[[x, *edge_set]].any()) for x, edge_set in enumerate(edge_sets)
    ]
    faces = report.open_faces
    if len(faces) == 0:
        assert (report.num_holes, report.num_boundary_components) == (0, 0)
        return
    shared = (faces[:, None, :, None] == faces[None, :, None, :]).sum(axis=(2, 3))
    count, labels = connected_components(shared >= dim - 1 if dim > 1 else shared)
    on_rim = {
        label
        for label, face in zip(labels, faces, strict=True)
        if any(at_rim[v] for v in face)
    }
    assert report.num_boundary_components == len(on_rim)
    assert report.num_holes == count - len(on_rim)


@pytest.mark.parametrize("dtype", [np.int32, np.int64, np.uint16])
def test_arrays_may_be_in_columns(dtype):
    """As other libraries hand them over."""
    triangles = np.asfortranarray([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]], dtype)
    points = np.asfortranarray(np.eye(4, 3))
    assert rm.compute_topology(triangles, 4).betti_numbers == (1, 0, 1)
    complex_ = rm.SimplicialComplex(points, triangles)
    assert complex_.topology().betti_numbers == (1, 0, 1)
    assert len(complex_.edges) == 6
    assert complex_.project(points).distances.max() < 1e-15
