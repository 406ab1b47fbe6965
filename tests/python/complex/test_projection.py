# SPDX-License-Identifier: GPL-3.0-or-later
"""Nearest points, interpolation, random points and volumes."""

import copy
import math
import pickle
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls
from scipy.spatial.distance import cdist

import remanifold as rm


def by_faces(complex_, points):
    """Distance from the complex: the least over all faces of all simplices."""
    vertices = complex_.vertices
    faces = {
        face
        for row in complex_.simplices.tolist()
        for size in range(1, len(row) + 1)
        for face in combinations(sorted(row), size)
    }
    least = np.full(len(points), np.inf)
    for face in faces:
        base = vertices[face[0]]
        edges = (vertices[list(face[1:])] - base).T
        away = (points - base).T
        shares = np.linalg.lstsq(edges, away, rcond=1e-12)[0]
        inside = (shares >= -1e-12).all(axis=0) & (shares.sum(axis=0) <= 1 + 1e-12)
        distances = np.linalg.norm(away - edges @ shares, axis=0)
        least[inside] = np.minimum(least, distances)[inside]
    return least


def by_nonnegative_least_squares(corners, point):
    """Distance from one simplex; the sum of the weights is one by a heavy row."""
    heavy = 1e6 * (np.abs(corners).max() + np.abs(point).max())
    matrix = np.vstack([(corners - point).T, np.full(len(corners), heavy)])
    weights, _ = nnls(matrix, np.append(np.zeros(len(point)), heavy))
    weights /= weights.sum()
    return np.linalg.norm(weights @ corners - point)


def random_complex(random, dim, ambient, num_vertices, num_simplices, kind="general"):
    vertices = random.normal(size=(num_vertices, ambient))
    if kind == "repeated":
        vertices[num_vertices // 2 :] = vertices[: (num_vertices + 1) // 2]
    elif kind == "collinear":
        vertices = vertices[:, :1] * random.normal(size=ambient)
    elif kind == "flat":
        vertices = vertices[:, :1] * random.normal(size=ambient) + 1e-9 * vertices
    elif kind == "grid":
        vertices = np.round(vertices)
    rows = {
        tuple(sorted(random.choice(num_vertices, dim + 1, replace=False).tolist()))
        for _ in range(num_simplices)
    }
    return rm.SimplicialComplex(vertices, sorted(rows))


def assert_projection(complex_, points, found, size=1.0):
    """That it is what it says; how near, is tested elsewhere."""
    corners = complex_.vertices[complex_.simplices[found.simplices]]
    assert found.barycentric.min() >= 0
    np.testing.assert_allclose(found.barycentric.sum(axis=1), 1, rtol=1e-14)
    expected = np.einsum("qk,qkd->qd", found.barycentric, corners)
    np.testing.assert_allclose(found.points, expected, atol=1e-13 * size)
    away = np.linalg.norm(points - found.points, axis=1)
    np.testing.assert_allclose(found.distances, away, rtol=1e-12, atol=1e-15 * size)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    dim=st.integers(1, 4),
    ambient=st.integers(1, 20),
    kind=st.sampled_from(["general", "repeated", "collinear", "flat", "grid"]),
    reach=st.sampled_from([0.01, 1.0, 1000.0]),
)
def test_no_face_is_nearer(seed, dim, ambient, kind, reach):
    random = np.random.default_rng(seed)
    complex_ = random_complex(random, dim, ambient, 12, 12, kind)
    points = reach * random.normal(size=(20, ambient))
    points[:6] = complex_.vertices[:6]
    points[6:12] += complex_.vertices[:6]
    found = complex_.project(points)
    size = 10 * max(1.0, reach)
    assert_projection(complex_, points, found, size)
    # The reference solves collinear faces to the root of the rounding only.
    tolerance = 1e-9 if kind in ("collinear", "flat") else 1e-12
    np.testing.assert_allclose(
        found.distances, by_faces(complex_, points), rtol=0, atol=tolerance * size
    )


@pytest.mark.parametrize("dim", [1, 2, 3, 5, 8])
def test_quadratic_programs_agree(dim):
    random = np.random.default_rng(dim)
    complex_ = random_complex(random, dim, 10, 30, 20)
    points = random.normal(size=(30, 10))
    found = complex_.project(points)
    for point, distance in zip(points, found.distances, strict=True):
        least = min(
            by_nonnegative_least_squares(complex_.vertices[row], point)
            for row in complex_.simplices
        )
        assert distance == pytest.approx(least, abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("ambient", [3, 7, 8, 9, 100])
def test_trees_miss_nothing(ambient):
    points = rm.datasets.torus(1500, random_state=0)
    points = rm.datasets.embed(points, ambient, random_state=0)
    rec = rm.reconstruct(points, 2)
    random = np.random.default_rng(0)
    asked = points[::10] + random.normal(size=(150, ambient)) / math.sqrt(ambient)
    found = rec.project(asked)
    single = [rec.subset([m]) for m in range(0, len(rec.simplices), 7)]
    for part in single[:60]:
        assert (part.project(asked).distances >= found.distances - 1e-14).all()
    np.testing.assert_allclose(found.distances, by_faces(rec, asked), atol=1e-12)


def test_ties_go_to_the_first_simplex():
    fan = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]
    rows = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
    for order in ([0, 1, 2, 3], [3, 1, 0, 2], [2, 3, 1, 0]):
        complex_ = rm.SimplicialComplex(fan, rows[order])
        above = complex_.project([[0, 0, 0.3], [0, 0, 1e7]])
        assert above.simplices.tolist() == [0, 0]
        edge = complex_.project([[0.3, 0, 1e-3]]).simplices[0]  # between 0 and 3
        assert edge == min(order.index(0), order.index(3))


def test_rows_and_threads_do_not_matter():
    rec = rm.reconstruct(rm.datasets.torus(800, random_state=1), 2)
    points = np.random.default_rng(1).normal(size=(300, 3))
    one = rec.project(points, num_threads=1)
    again = copy.copy(rec)
    assert "_search_index" not in vars(again)
    four = again.project(points[::-1], num_threads=4)
    for name in ("points", "simplices", "barycentric", "distances"):
        expected = getattr(one, name)
        np.testing.assert_array_equal(getattr(four, name)[::-1], expected)
        alone = [getattr(rec.project(p[None]), name)[0] for p in points[:20]]
        np.testing.assert_array_equal(alone, expected[:20])


def test_vertices_are_their_own_projections():
    points = 3.7 + rm.datasets.sphere(500, random_state=0)
    rec = rm.reconstruct(points, 2)
    used = np.unique(rec.simplices)
    found = rec.project(points[used])
    np.testing.assert_array_equal(found.points, points[used])
    assert (found.distances == 0).all()
    assert set(found.barycentric.ravel()) == {0.0, 1.0}


@pytest.mark.parametrize("exponent", [-900, -30, 30, 900])
def test_scale_does_not_matter(exponent):
    random = np.random.default_rng(5)
    complex_ = random_complex(random, 2, 3, 30, 40)
    points = random.normal(size=(50, 3))
    unit = complex_.project(points)
    scaled = rm.SimplicialComplex(
        np.ldexp(complex_.vertices, exponent), complex_.simplices
    ).project(np.ldexp(points, exponent))
    np.testing.assert_array_equal(scaled.barycentric, unit.barycentric)
    np.testing.assert_array_equal(scaled.distances, np.ldexp(unit.distances, exponent))


def test_far_points_have_distances():
    square = rm.SimplicialComplex([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])
    found = square.project([[1e300, 0], [0, -1e308]])
    assert found.points.tolist() == [[1, 0], [0, 0]]
    assert found.distances.tolist() == [1e300, 1e308]


def test_vertices_that_no_simplex_uses_are_not_there():
    complex_ = rm.SimplicialComplex([[5, 5], [0, 0], [1, 0], [1e200, 0]], [[1, 2]])
    assert complex_.project([[5, 5]]).points.tolist() == [[1, 0]]
    assert complex_.project([[0.25, 3]]).points.tolist() == [[0.25, 0]]


def test_points_of_dimension_0():
    ends = rm.SimplicialComplex([[0, 0], [2, 0]], [[0, 1]]).boundary_complex()
    found = ends.project([[0.9, 0], [1.1, 0]])
    assert found.points.tolist() == [[0, 0], [2, 0]]
    assert found.barycentric.tolist() == [[1], [1]]


TRIANGLE = rm.SimplicialComplex([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[0, 0, np.nan]], r"points\[0, 2\] is nan"),
        ([[0, 0, 0], [0, np.inf, 0]], r"points\[1, 1\] is inf"),
        ([[0, 0]], "expected 3 columns"),
        ([0, 0, 0], "two-dimensional"),
        (np.empty((0, 2)), "points is empty"),
    ],
)
def test_bad_points_are_refused(points, message):
    with pytest.raises(ValueError, match=message):
        TRIANGLE.project(points)


def test_what_has_no_answer_is_refused():
    empty = TRIANGLE.subset([])
    with pytest.raises(ValueError, match="no simplices"):
        empty.project([[0, 0, 0]])
    with pytest.raises(TypeError, match="give points, and nothing else"):
        TRIANGLE.project()
    with pytest.raises(TypeError, match="known by its points"):
        TRIANGLE.project(products=[[0, 0, 0]], squared_norms=[0])
    with pytest.raises(TypeError, match="must hold numbers"):
        TRIANGLE.project([["a", "b", "c"]])
    none = TRIANGLE.project(np.empty((0, 3)))
    assert (none.points.shape, none.barycentric.shape) == ((0, 3), (0, 3))


@pytest.mark.slow
def test_progress_is_told():
    steps = []
    random = np.random.default_rng(0)
    complex_ = random_complex(random, 6, 40, 60, 2000)
    complex_.project(
        random.normal(size=(400, 40)),
        num_threads=1,
        progress=lambda *args: steps.append(args),
    )
    assert ("projection", 400) in {(step, total) for step, _, total in steps}

    def stop(*_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        complex_.project(random.normal(size=(4000, 40)), progress=stop)


def test_complexes_are_pickled_without_their_index():
    complex_ = copy.deepcopy(TRIANGLE)
    before = complex_.project([[1, 1, 1]])
    restored = pickle.loads(pickle.dumps(complex_))
    np.testing.assert_array_equal(restored.project([[1, 1, 1]]).points, before.points)
    kept = pickle.loads(pickle.dumps(before))
    np.testing.assert_array_equal(kept.barycentric, before.barycentric)
    assert not kept.points.flags.writeable


# --- Inner products and distances -----------------------------------------------


@pytest.mark.parametrize("kind", ["gram", "distances"])
def test_products_and_distances_do(kind):
    random = np.random.default_rng(2)
    samples = rm.datasets.embed(rm.datasets.torus(300, random_state=0), 6) + 3.0
    given = {"gram": samples @ samples.T, "distances": cdist(samples, samples)}[kind]
    rec = rm.reconstruct(**{kind: given}, dim=2)
    points = samples[:40] + 0.2 * random.normal(size=(40, 6))
    asked = {"distances": cdist(points, samples)}
    if kind == "gram":
        norms = np.square(points).sum(axis=1)
        asked = {"products": points @ samples.T, "squared_norms": norms}
    found = rec.project(**asked)
    placed = rm.SimplicialComplex(samples, rec.simplices)
    expected = placed.project(points)
    assert found.points is None
    np.testing.assert_allclose(found.distances, expected.distances, atol=1e-7)
    np.testing.assert_array_equal(found.simplices, expected.simplices)
    np.testing.assert_allclose(found.barycentric, expected.barycentric, atol=1e-6)
    assert rec.coordinates.shape == (300, 3)
    np.testing.assert_allclose(
        cdist(rec.coordinates, rec.coordinates), cdist(samples, samples), atol=1e-6
    )
    assert rec.volume() == pytest.approx(placed.volume())
    assert rec.sample(5, 0).points is None
    one = rec.project(**{name: value[:1] for name, value in asked.items()})
    np.testing.assert_array_equal(one.barycentric[0], found.barycentric[0])


def test_bad_products_are_refused():
    rec = rm.reconstruct(gram=np.eye(5), dim=1)
    with pytest.raises(TypeError, match="products= and squared_norms="):
        rec.project([[0] * 5])
    with pytest.raises(TypeError, match="squared_norms is missing"):
        rec.project(products=np.zeros((1, 5)))
    with pytest.raises(ValueError, match=r"products has shape \(1, 4\)"):
        rec.project(products=np.zeros((1, 4)), squared_norms=[0])
    with pytest.raises(ValueError, match=r"squared_norms has shape \(2,\)"):
        rec.project(products=np.zeros((1, 5)), squared_norms=[0, 0])
    with pytest.raises(ValueError, match=r"products\[0, 3\] is nan"):
        rec.project(products=[[0, 0, 0, np.nan, 0]], squared_norms=[0])
    rec = rm.reconstruct(distances=1 - np.eye(5), dim=1)
    with pytest.raises(ValueError, match=r"distances\[0, 2\] is -1.0"):
        rec.project(distances=[[1, 1, -1, 1, 1]])


def test_coinciding_samples_have_coordinates():
    from remanifold._base.samples import Gram
    from remanifold._base.scaling import classical_scaling

    assert (classical_scaling(Gram(np.ones((4, 4)))).coordinates == 0).all()


# --- Interpolation --------------------------------------------------------------


def test_linear_functions_are_met():
    random = np.random.default_rng(3)
    complex_ = random_complex(random, 3, 5, 20, 30)
    slope = random.normal(size=(5, 4))
    points = random.normal(size=(50, 5))
    found = complex_.project(points)
    values = complex_.vertices @ slope
    for asked in (points, found):
        result = complex_.interpolate(values, asked)
        np.testing.assert_allclose(result, found.points @ slope, atol=1e-12)
    single = complex_.interpolate(values[:, 0], points)
    assert single.shape == (50,)
    np.testing.assert_array_equal(single, result[:, 0])
    drawn = complex_.sample(30, random_state=0)
    np.testing.assert_allclose(
        complex_.interpolate(values, drawn), drawn.points @ slope, atol=1e-12
    )


def test_bad_values_are_refused():
    with pytest.raises(ValueError, match=r"values has shape \(2,\), expected \(3,\)"):
        TRIANGLE.interpolate([1, 2], [[0, 0, 0]])
    with pytest.raises(ValueError, match=r"values\[1\] is nan"):
        TRIANGLE.interpolate([1, np.nan, 3], [[0, 0, 0]])
    with pytest.raises(TypeError, match="values must be real"):
        TRIANGLE.interpolate([1j, 2, 3], [[0, 0, 0]])
    other = rm.SimplicialComplex(np.eye(3), [[0, 1], [1, 2]]).sample(3, random_state=0)
    with pytest.raises(ValueError, match="another complex"):
        TRIANGLE.interpolate([1, 2, 3], other)


# --- Random points and volumes --------------------------------------------------


def test_samples_are_uniform():
    # Two triangles of areas 1 and 3, and one of none; moments of uniform points.
    vertices = [[0, 0], [2, 0], [0, 1], [10, 0], [16, 0], [10, 1], [30, 0], [31, 0]]
    complex_ = rm.SimplicialComplex(vertices, [[0, 1, 2], [3, 4, 5], [1, 6, 7]])
    count = 40_000
    drawn = complex_.sample(count, random_state=1)
    assert len(drawn) == count
    in_first = drawn.simplices == 0
    assert set(drawn.simplices.tolist()) == {0, 1}
    assert abs(in_first.mean() - 0.25) < 5 * math.sqrt(0.25 * 0.75 / count)
    np.testing.assert_array_equal(drawn.points[:, 0] < 5, in_first)
    corners = np.array(vertices, dtype=float)[[3, 4, 5]]
    own = drawn.points[~in_first]
    np.testing.assert_allclose(own.mean(axis=0), corners.mean(axis=0), atol=0.06)
    centered = corners - corners.mean(axis=0)
    spread = np.cov(own.T)
    np.testing.assert_allclose(spread, centered.T @ centered / 12, atol=0.05)


def test_samples_lie_on_the_complex_and_repeat():
    rec = rm.reconstruct(rm.datasets.torus(500, random_state=0), 2)
    drawn = rec.sample(200, random_state=7)
    assert rec.project(drawn.points).distances.max() < 1e-15
    np.testing.assert_array_equal(rec.sample(200, random_state=7).points, drawn.points)
    generator = np.random.default_rng(7)
    np.testing.assert_array_equal(rec.sample(200, generator).points, drawn.points)
    assert (rec.sample(200, generator).points != drawn.points).any()
    assert (rec.sample(200).points != drawn.points).any()
    assert rec.sample(0).points.shape == (0, 3)


def test_bad_samples_are_refused():
    with pytest.raises(ValueError, match="num_points is -1"):
        TRIANGLE.sample(-1)
    with pytest.raises(TypeError, match="random_state must be an integer"):
        TRIANGLE.sample(1, random_state="seed")
    with pytest.raises(ValueError, match="no volume"):
        TRIANGLE.subset([]).sample(1)
    flat = rm.SimplicialComplex([[0, 0], [1, 0], [2, 0]], [[0, 1, 2]])
    with pytest.raises(ValueError, match="no volume"):
        flat.sample(1)


@pytest.mark.parametrize("ambient", [4, 5, 30])
@pytest.mark.parametrize("dim", [1, 2, 3, 4])
def test_volumes_of_regular_simplices(dim, ambient):
    # Corners at unit vectors: edges of length sqrt(2), moved into more coordinates.
    corners = np.eye(dim + 1)
    if ambient > dim + 1:
        corners = rm.datasets.embed(corners, ambient, random_state=0)
    complex_ = rm.SimplicialComplex(corners + 7, [range(dim + 1)])
    expected = math.sqrt(dim + 1) / math.factorial(dim)
    assert complex_.volume() == pytest.approx(expected, rel=1e-13)
    np.testing.assert_allclose(complex_.simplex_volumes, [expected])
    assert not complex_.simplex_volumes.flags.writeable


def test_volumes_without_extent():
    thick = rm.SimplicialComplex([[0, 0], [1, 0], [0, 1], [1, 1]], [[0, 1, 2, 3]])
    assert thick.volume() == 0
    assert TRIANGLE.subset([]).volume() == 0


def test_volume_of_many_simplices_is_that_of_the_shape():
    side = np.linspace(0, 1, 220)
    x, y = np.meshgrid(side, side, indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), (2 * x).ravel()], axis=1)
    corner = (np.arange(219)[:, None] * 220 + np.arange(219)).ravel()
    rows = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + 220], axis=1),
            np.stack([corner + 1, corner + 220, corner + 221], axis=1),
        ]
    )
    for ambient in (3, 30):
        placed = vertices
        if ambient > 3:
            placed = rm.datasets.embed(vertices, ambient, random_state=0)
        complex_ = rm.SimplicialComplex(placed, rows)
        assert complex_.volume() == pytest.approx(math.sqrt(5), rel=1e-12)


def test_the_old_name_of_the_seed():
    with pytest.warns(DeprecationWarning, match="rng is called random_state now"):
        old = TRIANGLE.sample(5, rng=3)
    new = TRIANGLE.sample(5, random_state=3)
    np.testing.assert_array_equal(old.points, new.points)
    with pytest.raises(TypeError, match="give one of them"):
        TRIANGLE.sample(5, 3, rng=3)
    twice = [TRIANGLE.sample(5, np.random.RandomState(1)).points for _ in range(2)]
    np.testing.assert_array_equal(*twice)
