# SPDX-License-Identifier: GPL-3.0-or-later
"""Every step of the core against the slow reference, on a thousand random samples.

A case is drawn by Hypothesis and made by a NumPy generator from its seed, which a
failure prints with the case.  Where the core and the reference disagree, the
reference says by how much the decision was made: only those within rounding (or
within the weights that break ties) are excused, and few may be.
"""

from collections import Counter
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import reference as ref
import remanifold as rm

pytestmark = pytest.mark.slow

# Of each dimension; --hypothesis-profile=thorough has three times as many.
NUM_CASES = settings.default.max_examples
# Dimension K -> samples at most, neighbors at most (there are binomial(m, K + 1) tuples).
MOST_SAMPLES = {1: 60, 2: 60, 3: 45, 4: 32}
MOST_NEIGHBORS = {1: 20, 2: 20, 3: 14, 4: 11}
# Decided by less than this, a decision is a tie.  Tie-breaking weights are 1e-10.
TIE = 1e-9


@dataclass(frozen=True)
class Case:
    dim: int
    family: str
    ambient: int
    num: int
    neighbors: int
    noise: float
    copies: int
    seed: int

    def points(self):
        rng = np.random.default_rng(self.seed)
        args = (self.family, self.num, self.dim, self.ambient, rng)
        points = ref.draw_sample(*args)
        points += self.noise * rng.normal(size=points.shape)
        copies = rng.choice(self.num, self.copies, replace=False)
        points[copies] = points[rng.integers(self.num, size=self.copies)]
        return points


@st.composite
def cases(draw, dim):
    families = ref.FAMILIES + (ref.SURFACES if dim == 2 else ())
    family = draw(st.sampled_from(families))
    return Case(
        dim=dim,
        family=family,
        ambient=draw(st.sampled_from(range(ref.least_ambient_dim(family, dim), 51))),
        num=draw(st.sampled_from(range(8, MOST_SAMPLES[dim] + 1))),
        neighbors=draw(st.integers(dim + 1, MOST_NEIGHBORS[dim])),
        noise=draw(st.sampled_from([0.0, 0.0, 1e-3, 0.03, 0.3])),
        copies=draw(st.sampled_from([0, 0, 0, 1, 4])),
        seed=draw(st.integers(0, 2**32 - 1)),
    )


def rows(sets):
    """The rows of a ragged array (edge sets or stars), each in canonical order."""
    values = sets.simplices if hasattr(sets, "simplices") else sets.indices
    pieces = [np.atleast_1d(p) for p in np.split(values, sets.offsets[1:-1])]
    return [p[np.lexsort(p.T[::-1])] if p.ndim == 2 else np.sort(p) for p in pieces]


def as_csr(sets):
    offsets = np.cumsum([0, *map(len, sets)])
    return offsets, np.concatenate([*sets, np.empty(0)]).astype(np.int32)


def compare_neighborhoods(case, points, tally):
    expected, distances = ref.neighborhoods(points, case.neighbors)
    found = rm.neighborhoods(points, case.neighbors)
    np.testing.assert_allclose(found.distances, distances, rtol=1e-12)
    tally["neighborhoods"] += len(points)
    tied = (found.indices != expected).any(axis=1)
    # Sorted distances agree; with those of the members, a difference is a tie.
    members = points[found.indices] - points[:, None]
    members = np.linalg.norm(members, axis=2)
    np.testing.assert_allclose(members, distances, rtol=1e-12)
    tally["neighborhoods tied"] += int(tied.sum())
    return expected


def compare_tangents(case, points, nbds, tally):
    expected = ref.tangent_spaces(points, case.dim, nbds)
    found = rm.tangent_spaces(points, case.dim, case.neighbors)
    np.testing.assert_array_equal(found.boundary, found.simplices[:, 0] < 0)
    np.testing.assert_array_equal(np.isnan(found.bases[:, 0, 0]), found.boundary)
    tally["tangents"] += len(points)
    for x in np.flatnonzero((found.simplices != expected.simplices).any(axis=1)):
        # Either took a tuple that the other had passed over.
        options = [s for s in (found.simplices[x], expected.simplices[x]) if s[0] >= 0]
        ranks = [[nbds[x].tolist().index(q) for q in s][::-1] for s in options]
        first = options[ranks.index(min(ranks))]
        assert abs(ref.tuple_margin(points, x, nbds[x], first)) < TIE, (x, options)
        tally["tangents tied"] += 1
    for basis, corners in zip(found.bases, found.simplices, strict=True):
        if corners[0] >= 0:
            np.testing.assert_allclose(basis @ basis.T, np.eye(case.dim), atol=1e-12)
            omega = points[corners[1:]] - points[corners[0]]
            scale = np.linalg.norm(points[corners] - points[corners[0]], axis=1).max()
            np.testing.assert_allclose(
                omega @ basis.T @ basis, omega, rtol=0, atol=1e-9 * scale
            )
    return expected


def compare_regions(points, bases, boundary, tally):
    expected = ref.local_regions(points, bases, boundary)
    found = rm.local_regions(points, bases, boundary)
    alone = rm.edge_sets(points, bases, boundary)
    np.testing.assert_array_equal(alone.offsets, found.edge_sets.offsets)
    np.testing.assert_array_equal(alone.indices, found.edge_sets.indices)
    edge_sets, stars = rows(found.edge_sets), rows(found.stars)
    for x, region in enumerate(expected):
        if region is None:
            continue
        tally["regions"] += 1
        disputed = np.setxor1d(edge_sets[x], region.edge_set)
        simplices = {*map(tuple, stars[x].tolist())} ^ {
            *map(tuple, region.star.tolist())
        }
        if len(disputed) or simplices:
            duals, samples = ref.dual_points(points, x, bases[x]), ref.others(points, x)
            for q in disputed:
                margin = ref.binding_margin(duals, np.searchsorted(samples, q))
                assert abs(margin) < TIE, (x, q, margin)
            for simplex in simplices:
                assert simplex[0] == x
                facet = np.searchsorted(samples, simplex[1:])
                margin = ref.facet_margin(duals, facet)
                assert abs(margin) < TIE, (x, simplex, margin)
            tally["regions tied"] += 1
            continue
        assert found.unbounded[x] == region.unbounded, x
        np.testing.assert_allclose(found.radii[x], region.radius, rtol=1e-6)
    return expected


def random_frames(num, dim, ambient, seed):
    """A tangent space in any direction at any sample: many regions are unbounded."""
    normal = np.random.default_rng(seed).normal(size=(num, ambient, dim))
    return np.linalg.qr(normal)[0].transpose(0, 2, 1)


def compare_complexes(case, points, tangents, regions, tally):
    sets = ref.edge_sets(regions)
    tied = any(tally[key] for key in list(tally) if key.endswith("tied"))
    for edges in ("mutual", "either"):
        pairs = ref.graph(sets, edges)
        simplices = ref.cliques(pairs, case.dim + 1)
        alone = rm.clique_complex(*as_csr(sets), case.dim, edges)
        np.testing.assert_array_equal(alone, simplices)
        if tied:
            continue
        whole = rm.reconstruct(
            points,
            case.dim,
            method="paper",
            num_neighbors=case.neighbors,
            edges=edges,
        )
        np.testing.assert_array_equal(whole.simplices, simplices)
        np.testing.assert_array_equal(whole.edges, pairs)
        np.testing.assert_array_equal(whole.boundary, tangents.boundary)
        np.testing.assert_array_equal(whole.tangent_simplices, tangents.simplices)
        np.testing.assert_array_equal(
            whole.representatives, ref.representatives(points)
        )
        edge_sets, stars = rows(whole.edge_sets), rows(whole.stars)
        for x, region in enumerate(regions):
            if region is not None:
                np.testing.assert_array_equal(edge_sets[x], region.edge_set)
                np.testing.assert_array_equal(stars[x], region.star)
                assert whole.unbounded[x] == region.unbounded
        tally["complexes"] += 1


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
def test_steps_follow_the_definitions(dim):
    total = Counter()

    @settings(deadline=None, derandomize=True, max_examples=NUM_CASES)
    @given(cases(dim))
    def compare(case):
        tally = Counter(cases=1)
        points = case.points()
        nbds = compare_neighborhoods(case, points, tally)
        tangents = compare_tangents(case, points, nbds, tally)
        regions = compare_regions(points, tangents.bases, tangents.boundary, tally)
        compare_complexes(case, points, tangents, regions, tally)
        frames = random_frames(case.num, dim, case.ambient, case.seed)
        compare_regions(points, frames, None, tally)
        total.update(tally)

    compare()
    print(dict(total))
    assert total["cases"] >= NUM_CASES
    assert total["complexes"] >= 2 * 0.98 * total["cases"]
    for step in ("neighborhoods", "tangents", "regions"):
        assert total[f"{step} tied"] <= 1e-3 * total[step]


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
def test_cliques_of_random_graphs(dim):
    rng = np.random.default_rng(dim)
    for density in (0.1, 0.3, 0.6, 1.0):
        for _ in range(20):
            linked = rng.uniform(size=(16, 16)) < density
            np.fill_diagonal(linked, False)
            sets = [np.flatnonzero(row) for row in linked]
            for edges in ("mutual", "either"):
                expected = ref.cliques(ref.graph(sets, edges), dim + 1)
                found = rm.clique_complex(*as_csr(sets), dim, edges)
                assert found.dtype == np.int32
                np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("ambient", [2, 3, 20])
@pytest.mark.parametrize("decades", [3, 6, 9])
def test_regions_among_all_scales_are_exact(ambient, decades):
    rng = np.random.default_rng([ambient, decades])
    for _ in range(3):
        points = rng.normal(size=(40, ambient))
        points *= 10 ** rng.uniform(-decades, 0, size=(40, 1))
        frames = random_frames(40, 2, ambient, rng)
        edge_sets = rows(rm.edge_sets(points, frames))
        for x in range(40):
            expected = ref.exact_edge_set(points, x, frames[x])
            np.testing.assert_array_equal(edge_sets[x], expected)


@pytest.mark.parametrize(
    ("name", "dim", "neighbors"),
    [
        ("highdim_range_image_patches_circle_in_R25", 1, 10),
        ("surface_rocker_arm_genus1_uniform10k", 2, 20),
        ("surface_fish_blub_vertices", 2, 20),
        ("solid_bunny_tetrahedra_K3_in_R3", 3, 16),
    ],
)
def test_regions_among_many_real_samples(data_dir, name, dim, neighbors):
    points = np.load(data_dir / f"{name}.npz")["points"]
    nbds = rm.neighborhoods(points, neighbors).indices
    tangents = rm.tangent_spaces(points, dim, neighbors)
    regions = rm.local_regions(points, tangents.bases, tangents.boundary)
    edge_sets, stars = rows(regions.edge_sets), rows(regions.stars)
    for x in np.random.default_rng(0).choice(len(points), 15, replace=False):
        _, distances = ref.neighborhood(points, x, neighbors)
        nbd = nbds[x]  # voxels have ties
        members = np.linalg.norm(points[nbd] - points[x], axis=1)
        np.testing.assert_allclose(members, distances, rtol=1e-12)
        corners = ref.tangent_basis(points, x, nbd, dim)
        assert tangents.boundary[x] == (corners is None)
        if corners is not None:
            np.testing.assert_array_equal(tangents.simplices[x], corners)
            region = ref.local_region(points, x, tangents.bases[x])
            np.testing.assert_array_equal(edge_sets[x], region.edge_set)
            np.testing.assert_array_equal(stars[x], region.star)
            assert regions.unbounded[x] == region.unbounded
