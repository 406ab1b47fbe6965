# SPDX-License-Identifier: GPL-3.0-or-later
"""What must not change SC(X) of samples in general position, or change it in one way."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

import reference as ref
import remanifold as rm

pytestmark = pytest.mark.slow

PROFILE = settings(deadline=None, derandomize=True, max_examples=40)
ARRAYS = (
    "simplices",
    "edges",
    "boundary",
    "tangents",
    "tangent_simplices",
    "unbounded",
    "representatives",
)


@st.composite
def samples(draw):
    """K and samples in general position; the seed is drawn last, and printed."""
    dim = draw(st.integers(1, 4))
    families = ref.FAMILIES + (ref.SURFACES if dim == 2 else ())
    family = draw(st.sampled_from(families))
    ambient = draw(st.integers(ref.least_ambient_dim(family, dim), 30))
    num = draw(st.integers(20, 150))
    return dim, family, ambient, num, draw(st.integers(0, 2**32 - 1))


def make(sample):
    dim, family, ambient, num, seed = sample
    rng = np.random.default_rng(seed)
    points = ref.draw_sample(family, num, dim, ambient, rng)
    points += 1e-3 * rng.normal(size=points.shape)
    return dim, points, rng


def reconstruct(points=None, dim=None, **options):
    options.setdefault("num_neighbors", 20 if dim <= 2 else 12)
    return rm.reconstruct(points, dim, method="paper", **options)


def arrays(result):
    """All arrays of a result by name."""
    found = {name: getattr(result, name) for name in ARRAYS}
    found["edge set offsets"] = result.edge_sets.offsets
    found["edge set indices"] = result.edge_sets.indices
    found["star offsets"] = result.stars.offsets
    found["star simplices"] = result.stars.simplices
    return found


def assert_same_bytes(result, expected):
    found = arrays(result)
    for name, array in arrays(expected).items():
        if array is None:
            assert found[name] is None
            continue
        assert found[name].dtype == array.dtype, name
        assert found[name].shape == array.shape, name
        assert found[name].tobytes() == array.tobytes(), name


def described(result, labels=None):
    """A result free of the order of samples: sample i is called labels[i]."""
    labels = np.arange(len(result.boundary)) if labels is None else labels

    def ragged(offsets, values):
        return {
            int(labels[i]): {frozenset(np.ravel(labels[v]).tolist()) for v in row}
            for i, row in enumerate(np.split(values, offsets[1:-1]))
        }

    return {
        "simplices": {frozenset(row) for row in labels[result.simplices].tolist()},
        "edges": {frozenset(row) for row in labels[result.edges].tolist()},
        "boundary": set(labels[result.boundary].tolist()),
        "unbounded": set(labels[result.unbounded].tolist()),
        "tangents": {
            int(labels[i]): labels[row].tolist()
            for i, row in enumerate(result.tangent_simplices)
            if row[0] >= 0
        },
        "edge sets": ragged(result.edge_sets.offsets, result.edge_sets.indices),
        "stars": ragged(result.stars.offsets, result.stars.simplices),
    }


def assert_same(result, expected, labels=None):
    found, wanted = described(result, labels), described(expected)
    for name, value in wanted.items():
        assert found[name] == value, name


def random_rotation(dim, rng):
    return np.linalg.qr(rng.normal(size=(dim, dim)))[0]


@PROFILE
@given(samples())
def test_order_of_the_samples(sample):
    dim, points, rng = make(sample)
    order = rng.permutation(len(points))
    assert_same(reconstruct(points[order], dim), reconstruct(points, dim), order)


@PROFILE
@given(samples())
def test_rotation_and_translation(sample):
    dim, points, rng = make(sample)
    expected = reconstruct(points, dim)
    rotation = random_rotation(points.shape[1], rng)
    assert_same(reconstruct(points @ rotation, dim), expected)
    assert_same(reconstruct(points + rng.normal(size=rotation.shape[0]), dim), expected)


@PROFILE
@given(samples(), st.integers(-400, 400))
def test_scaling_by_a_power_of_two_changes_no_byte(sample, exponent):
    dim, points, _ = make(sample)
    scaled = np.ldexp(points, exponent)
    assert_same_bytes(reconstruct(scaled, dim), reconstruct(points, dim))


@PROFILE
@given(samples(), st.floats(0.1, 10))
def test_scaling(sample, factor):
    dim, points, _ = make(sample)
    assert_same(reconstruct(factor * points, dim), reconstruct(points, dim))


@PROFILE
@given(samples(), st.integers(1, 70))
def test_further_dimensions_without_extent(sample, extra):
    dim, points, rng = make(sample)
    expected = reconstruct(points, dim)
    padded = np.pad(points, [(0, 0), (0, extra)], constant_values=3.0)
    assert_same(reconstruct(padded, dim), expected)
    shuffled = padded[:, rng.permutation(padded.shape[1])]
    assert_same(reconstruct(shuffled, dim), expected)


@PROFILE
@given(samples())
def test_complex_samples_are_real_ones_of_twice_the_dimension(sample):
    dim, points, _ = make(sample)
    points = np.pad(points, [(0, 0), (0, points.shape[1] % 2)])
    halves = np.split(points, 2, axis=1)
    assert_same(reconstruct(halves[0] + 1j * halves[1], dim), reconstruct(points, dim))


@PROFILE
@given(samples())
def test_inner_products_or_distances_alone(sample):
    dim, points, _ = make(sample)
    expected = reconstruct(points, dim)
    assert_same(reconstruct(gram=points @ points.T, dim=dim), expected)
    assert_same(reconstruct(distances=cdist(points, points), dim=dim), expected)


@PROFILE
@given(samples(), st.sampled_from(["enclosure", "pca", "jet"]))
def test_kinds_of_search(sample, estimator):
    dim, points, _ = make(sample)
    options = {"estimator": estimator, "num_neighbors": 16}
    expected = reconstruct(points, dim, **options)
    for search in ("kdtree", "brute_force"):
        assert_same_bytes(reconstruct(points, dim, search=search, **options), expected)


@PROFILE
@given(samples())
def test_edges_seen_from_either_end_include_the_mutual_ones(sample):
    dim, points, _ = make(sample)
    mutual = described(reconstruct(points, dim))
    either = described(reconstruct(points, dim, edges="either"))
    for name in ("edges", "simplices"):
        assert mutual[name] <= either[name]
    for name in ("boundary", "unbounded", "tangents", "edge sets", "stars"):
        assert mutual[name] == either[name]
    for x, star in mutual["stars"].items():
        members = {q for simplex in star for q in simplex if q != x}
        assert members <= {q for row in mutual["edge sets"][x] for q in row}


@PROFILE
@given(samples())
def test_a_far_sample_reaches_no_bounded_region(sample):
    dim, points, rng = make(sample)
    expected = reconstruct(points, dim, num_neighbors=12)
    regions = rm.local_regions(points, expected.tangents, expected.boundary)
    # A point that is enclosed has a bounded region, and beyond twice its radius nobody
    # cuts it. The far sample itself may see others, but nobody sees it.
    radius = regions.radii[~expected.boundary].max(initial=0)
    extent = np.linalg.norm(points.max(axis=0) - points.min(axis=0))
    direction = rng.normal(size=points.shape[1])
    direction *= 3 * (radius + extent) / np.linalg.norm(direction)
    points = np.vstack([points, points[0] + direction])
    far = described(reconstruct(points, dim, num_neighbors=12))
    wanted = described(expected)
    assert far["simplices"] == wanted["simplices"]
    assert far["edges"] == wanted["edges"]
    last = len(points) - 1
    for name in ("boundary", "unbounded"):
        assert far[name] - {last} == wanted[name]
    for name in ("tangents", "edge sets", "stars"):
        far[name].pop(last, None)
        assert far[name] == wanted[name]


@pytest.mark.parametrize("estimator", ["enclosure", "pca", "jet"])
@pytest.mark.parametrize(
    ("family", "dim", "ambient", "num"),
    [
        ("sphere", 1, 2, 3000),
        ("torus", 2, 3, 3000),
        ("flat torus", 2, 40, 1000),
        ("flat torus", 3, 6, 1000),
        ("clusters", 3, 3, 300),
    ],
)
def test_number_of_threads_changes_no_byte(family, dim, ambient, num, estimator):
    points = ref.draw_sample(family, num, dim, ambient, np.random.default_rng(5))
    points[-20:] = points[:20]
    kinds = [{"points": points}]
    if num <= 1500:
        kinds += [{"gram": points @ points.T}, {"distances": cdist(points, points)}]
    for kind in kinds:
        options = {**kind, "dim": dim, "estimator": estimator}
        expected = reconstruct(**options, num_threads=1)
        for num_threads in (2, 5, None):
            result = reconstruct(**options, num_threads=num_threads)
            assert_same_bytes(result, expected)


@pytest.mark.parametrize("ambient", [3, 40])
def test_number_of_threads_changes_no_byte_of_a_step(ambient):
    points = ref.draw_sample("torus", 2000, 2, ambient, np.random.default_rng(6))

    def steps(num_threads):
        threads = {"num_threads": num_threads}
        near = rm.neighborhoods(points, 20, **threads)
        tangents = rm.tangent_spaces(points, 2, 20, **threads)
        bases, boundary = tangents.bases, tangents.boundary
        regions = rm.local_regions(points, bases, boundary, **threads)
        return [
            near.indices,
            near.distances,
            tangents.simplices,
            bases,
            boundary,
            regions.edge_sets.offsets,
            regions.edge_sets.indices,
            regions.stars.offsets,
            regions.stars.simplices,
            regions.unbounded,
            regions.radii,
        ]

    expected = [array.tobytes() for array in steps(1)]
    for num_threads in (2, 5):
        assert [array.tobytes() for array in steps(num_threads)] == expected
