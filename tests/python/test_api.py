# SPDX-License-Identifier: GPL-3.0-or-later
"""What callers rely on besides the numbers: arrays, types, composition, documents."""

import copy
import doctest
import gc
import importlib
import inspect
import pickle
import pkgutil
import re
import subprocess
import sys
from itertools import combinations, pairwise

import numpy as np
import pytest
from scipy.spatial.distance import cdist

import remanifold as rm
from remanifold.method.options import METHODS
from remanifold.sklearn import ManifoldReconstruction

SEARCHES = ("auto", "kdtree", "brute_force")
PAPER_ONLY = ("edge_sets", "stars", "unbounded", "tangent_simplices", "edge_rule")
STEPS = ("neighborhoods", "cleaning", "tangent_spaces", "local_regions", "complex")


def sample(dim, num=None):
    num = num or {1: 100, 2: 400, 3: 300, 4: 80}[dim]
    points = np.random.default_rng(dim).normal(size=(num, dim + 2))
    points[:, -1] = 0
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    points[:, -1] = points[:, 0] * points[:, 1]
    return points


def known_by(kind, points):
    """The same samples as arguments of a call."""
    matrix = {
        "points": lambda: points,
        "gram": lambda: points @ points.T,
        "distances": lambda: cdist(points, points),
    }[kind]()
    return {kind: matrix}


def arrays_of(rec):
    named = dict(vars(rec))
    for name in ("edge_sets", "stars"):
        sets = named.pop(name, None)
        if sets is None:
            continue
        named |= {f"{name}.{field}": getattr(sets, field) for field in sets._fields}
    return {n: v for n, v in named.items() if isinstance(v, np.ndarray)}


def writeable(result):
    return [n for n, array in arrays_of(result).items() if array.flags.writeable]


def assert_same_arrays(found, expected, but=()):
    found, expected = arrays_of(found), arrays_of(expected)
    assert set(found) == set(expected)
    for name in set(expected) - set(but):
        assert found[name].dtype == expected[name].dtype, name
        np.testing.assert_array_equal(found[name], expected[name], err_msg=name)


def assert_rows_ascend(rows):
    assert (np.diff(rows, axis=1) > 0).all()
    assert_rows_are_sorted(rows)


def assert_rows_are_sorted(rows):
    assert rows.tolist() == sorted(map(list, {tuple(row) for row in rows.tolist()}))


# --- Attributes of a reconstruction ---------------------------------------------


@pytest.mark.parametrize("kind", ["points", "gram", "distances"])
@pytest.mark.parametrize("dim", [1, 2, 3, 4])
def test_arrays_have_their_shapes(dim, kind):
    points = sample(dim)
    n, d = points.shape
    rec = rm.reconstruct(**known_by(kind, points), dim=dim, method="paper")
    m, e = len(rec.simplices), len(rec.edges)
    s = len(rec.stars.simplices)
    assert min(m, e, s) > 0
    expected = {
        "simplices": ((m, dim + 1), np.int32),
        "edges": ((e, 2), np.int32),
        "boundary": ((n,), np.bool_),
        "tangent_simplices": ((n, dim + 1), np.int32),
        "edge_sets.offsets": ((n + 1,), np.int64),
        "edge_sets.indices": ((rec.edge_sets.offsets[-1],), np.int32),
        "stars.offsets": ((n + 1,), np.int64),
        "stars.simplices": ((rec.stars.offsets[-1], dim + 1), np.int32),
        "unbounded": ((n,), np.bool_),
        "representatives": ((n,), np.int32),
        "outliers": ((0,), np.int32),
        "invalid": ((0,), np.int32),
        "attached": ((0,), np.int32),
        "left_out": ((0,), np.int32),
    }
    if kind == "points":
        expected["vertices"] = ((n, d), np.float64)
        expected["samples"] = ((n, d), np.float64)
        expected["tangents"] = ((n, dim, d), np.float64)
    assert_arrays_are(rec, expected)
    by_chain = rm.reconstruct(**known_by(kind, points), dim=dim)
    m, e = len(by_chain.simplices), len(by_chain.edges)
    assert min(m, e) > 0
    expected = {
        name: what
        for name, what in expected.items()
        if name.partition(".")[0] not in PAPER_ONLY
    }
    expected |= {"simplices": ((m, dim + 1), np.int32), "edges": ((e, 2), np.int32)}
    assert_arrays_are(by_chain, expected)
    assert all(getattr(by_chain, name) is None for name in PAPER_ONLY)
    for result in (rec, by_chain):
        if kind != "points":
            assert result.vertices is None
            assert result.samples is None
            assert result.tangents is None


def assert_arrays_are(rec, expected):
    found = arrays_of(rec)
    assert {name: (a.shape, a.dtype) for name, a in found.items()} == expected
    for name, array in found.items():
        assert array.flags.c_contiguous, name
        assert not array.flags.writeable, name
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_arrays_of_the_report_have_their_shapes(dim, method):
    report = rm.reconstruct(sample(dim), dim, method=method).repair
    arrays = {
        "open_faces": dim,
        "hole_faces": dim,
        "callous_faces": dim,
        "unstarred_simplices": dim + 1,
        "disputed_simplices": dim + 1,
        "filled_simplices": dim + 1,
        "singular_vertices": None,
        "unused_vertices": None,
        "inserted_vertices": None,
        "cut_vertices": None,
    }
    assert set(arrays) == {n for n, v in vars(report).items() if hasattr(v, "shape")}
    for name, columns in arrays.items():
        array = getattr(report, name)
        assert array.dtype == np.int32, name
        assert array.shape[1:] == (() if columns is None else (columns,)), name
        assert not array.flags.writeable, name
        if columns is None:
            assert (np.diff(array) > 0).all(), name
        elif len(array):
            assert_rows_ascend(array)
    kinds = {"method": str, "hole_radius": float, "hole_size": float}
    for name, value in vars(report).items():
        if name not in arrays:
            assert type(value) is kinds.get(name, int), name


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
@pytest.mark.parametrize("estimator", ["enclosure", "pca", "jet"])
def test_arrays_mean_what_they_say(dim, estimator):
    points = sample(dim)
    rec = rm.reconstruct(points, dim, method="paper", estimator=estimator)
    np.testing.assert_array_equal(rec.vertices, points)
    np.testing.assert_array_equal(rec.representatives, np.arange(len(points)))
    assert_rows_ascend(rec.simplices)
    assert_rows_ascend(rec.edges)

    bases = rec.tangents[~rec.boundary]
    products = bases @ bases.transpose(0, 2, 1)
    np.testing.assert_allclose(
        products, np.broadcast_to(np.eye(dim), products.shape), atol=1e-12
    )
    assert np.isnan(rec.tangents[rec.boundary]).all()
    has_tuple = (rec.tangent_simplices >= 0).all(axis=1)
    assert (rec.tangent_simplices[~has_tuple] == -1).all()
    expected = ~rec.boundary if estimator == "enclosure" else np.zeros_like(has_tuple)
    np.testing.assert_array_equal(has_tuple, expected)
    for x in np.flatnonzero(has_tuple):
        away = np.linalg.norm(points[rec.tangent_simplices[x]] - points[x], axis=1)
        assert (np.diff(away) >= 0).all()

    seen = set()
    for x, (begin, end) in enumerate(pairwise(rec.edge_sets.offsets)):
        edge_set = rec.edge_sets.indices[begin:end]
        assert (np.diff(edge_set) > 0).all()
        assert x not in edge_set
        assert not rec.boundary[x] or not len(edge_set)
        seen |= {(x, y) for y in edge_set.tolist()}
    mutual = sorted([x, y] for x, y in seen if x < y and (y, x) in seen)
    assert rec.edges.tolist() == mutual

    for x, (begin, end) in enumerate(pairwise(rec.stars.offsets)):
        star = rec.stars.simplices[begin:end]
        assert (star[:, 0] == x).all()
        if end > begin:
            assert_rows_ascend(star[:, 1:])
        assert not rec.boundary[x] or not len(star)
        assert all((x, y) in seen for y in star[:, 1:].ravel().tolist())
    assert not rec.unbounded[rec.boundary].any()


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
@pytest.mark.parametrize("estimator", ["enclosure", "pca", "jet"])
@pytest.mark.filterwarnings("ignore::remanifold.ManifoldWarning")
def test_arrays_of_the_manifold_method_mean_what_they_say(dim, estimator):
    points = sample(dim)
    rec = rm.reconstruct(points, dim, estimator=estimator)
    np.testing.assert_array_equal(rec.vertices, points)
    # The last two columns may change places: that is the orientation.
    ascending = np.sort(rec.simplices, axis=1)
    np.testing.assert_array_equal(rec.simplices[:, : dim - 1], ascending[:, : dim - 1])
    assert_rows_are_sorted(ascending)
    assert_rows_ascend(rec.edges)
    pairs = {pair for row in ascending.tolist() for pair in combinations(row, 2)}
    assert rec.edges.tolist() == sorted(map(list, pairs))
    on_open_faces = np.zeros(len(points), dtype=bool)
    on_open_faces[rec.repair.open_faces.ravel()] = True
    np.testing.assert_array_equal(rec.boundary, on_open_faces)
    # No more neighbors than half of the samples.
    num_neighbors = min(rec.num_neighbors, (len(points) - 1) // 2)
    steps = rm.tangent_spaces(
        points, dim, estimator=estimator, num_neighbors=num_neighbors
    )
    np.testing.assert_array_equal(rec.tangents, steps.bases)


def test_scalars_say_how():
    rec = rm.reconstruct(sample(2), 2)
    assert (rec.method, rec.estimator, rec.edge_rule) == ("manifold", "jet", None)
    assert (rec.num_neighbors, rec.recall) == (15, 1.0)
    for dim, num_neighbors in ((1, 6), (3, 27), (4, 42)):
        assert rm.reconstruct(sample(dim), dim).num_neighbors == num_neighbors
    assert tuple(rec.timings) == STEPS
    rec = rm.reconstruct(sample(2), 2, method="paper")
    assert (rec.dim, rec.ambient_dim, rec.num_samples) == (2, 4, 400)
    assert (rec.method, rec.estimator, rec.edge_rule) == (
        "paper",
        "enclosure",
        "mutual",
    )
    assert (rec.num_neighbors, rec.recall) == (20, 1.0)
    assert rec.search in SEARCHES
    assert tuple(rec.timings) == STEPS
    for step, seconds in rec.timings.items():
        assert isinstance(seconds, float), step
        assert 0 <= seconds < 60, step
    rec = rm.reconstruct(
        gram=np.eye(9),
        dim=3,
        method="paper",
        estimator="jet",
        edges="either",
        num_neighbors=7,
        search="brute_force",
    )
    assert (rec.dim, rec.ambient_dim, rec.num_samples) == (3, None, 9)
    assert (rec.method, rec.estimator, rec.edge_rule) == ("paper", "jet", "either")
    assert (rec.num_neighbors, rec.search) == (7, "brute_force")


@pytest.mark.parametrize("method", METHODS)
def test_attributes_cannot_be_replaced(method):
    rec = rm.reconstruct(sample(1), 1, method=method)
    for result in (rec, rec.topology(), rec.repair):
        with pytest.raises(AttributeError):
            result.method = "other"
    with pytest.raises(AttributeError):
        rec.repair = None


def test_every_attribute_is_documented():
    kinds = (rm.Reconstruction, rm.Topology, rm.Repair)
    for kind in (*kinds, rm.PointsOnComplex, rm.Projection, rm.Subcomplex):
        section = inspect.getdoc(kind).partition("Attributes\n----------\n")[2]
        names = re.findall(r"^(\w[\w, ]*) :", section, flags=re.MULTILINE)
        documented = {name.strip() for group in names for name in group.split(",")}
        fields = {f for f in kind.__dataclass_fields__ if not f.startswith("_")}
        assert documented == fields


@pytest.mark.parametrize("method", METHODS)
def test_reports_are_computed_once(method):
    rec = rm.reconstruct(sample(2), 2, method=method)
    assert rec.topology() is rec.topology()
    assert rec.repair is rec.repair


@pytest.mark.parametrize("method", METHODS)
def test_component_labels(method):
    circle = sample(1)
    points = np.vstack([circle + 9, circle, [[99] * 3], circle[:1]])
    rec = rm.reconstruct(points, 1, method=method)
    labels = rec.component_labels()
    assert labels.dtype == np.int32
    assert rec.topology().components == labels.max() + 1
    used = np.isin(np.arange(202), rec.simplices)
    np.testing.assert_array_equal(labels >= 0, used)
    assert labels[200:].tolist() == [-1, -1]
    for x, y in rec.edges:
        assert labels[x] == labels[y]
    firsts = [np.flatnonzero(labels == c)[0] for c in range(labels.max() + 1)]
    assert firsts == sorted(firsts)


# --- What goes in ---------------------------------------------------------------


@pytest.mark.parametrize("dtype", [np.float64, np.complex128])
@pytest.mark.parametrize("method", METHODS)
def test_points_are_not_copied(dtype, method):
    points = sample(2).view(dtype)
    assert points.flags.c_contiguous
    rec = rm.reconstruct(points, 2, method=method)
    assert np.shares_memory(rec.vertices, points)
    assert points.flags.writeable
    assert not rec.vertices.flags.writeable
    again = rm.reconstruct(rec.vertices, 2, method=method)
    assert np.shares_memory(again.vertices, points)


@pytest.mark.parametrize("kind", ["points", "gram", "distances"])
def test_arguments_stay_as_they_are(kind):
    (name, matrix), *_ = known_by(kind, sample(2)).items()
    before = matrix.copy()
    mask = np.zeros(len(matrix), dtype=bool)
    rm.reconstruct(**{name: matrix}, dim=2, boundary=mask)
    assert mask.flags.writeable
    assert not mask.any()
    rec = rm.reconstruct(**{name: matrix}, dim=2, method="paper")
    rm.neighborhoods(**{name: matrix}, num_neighbors=5)
    if kind == "points":
        tangents = rm.tangent_spaces(matrix, 2)
        rm.edge_sets(matrix, tangents.bases, tangents.boundary)
        rm.clique_complex(*rec.edge_sets, 2)
        assert tangents.bases.flags.writeable
    assert matrix.flags.writeable
    np.testing.assert_array_equal(matrix, before)


def test_simplices_stay_as_they_are():
    simplices = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]], dtype=np.int32)
    topology = rm.compute_topology(simplices, 4)
    assert simplices.flags.writeable
    simplices[:] = 0
    assert topology.betti_numbers == (1, 0, 1)


def with_gaps(array):
    wide = np.full(tuple(2 * n for n in array.shape), np.nan, dtype=array.dtype)
    gaps = wide[tuple(slice(None, None, 2) for _ in array.shape)]
    gaps[...] = array
    return gaps


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


LAYOUTS = {
    "float32": lambda a: a.astype(np.float32),
    "float16": lambda a: a.astype(np.float16),
    "longdouble": lambda a: a.astype(np.longdouble),
    "int64": lambda a: a.astype(np.int64),
    "int8": lambda a: a.astype(np.int8),
    "objects": lambda a: a.astype(object),
    "big_endian": lambda a: a.astype(">f8"),
    "fortran": np.asfortranarray,
    "lists": np.ndarray.tolist,
    "tuples": lambda a: tuple(map(tuple, a.tolist())),
    "gaps": with_gaps,
    "backwards": lambda a: np.ascontiguousarray(a[::-1])[::-1],
    "read_only": read_only,
    "masked_nowhere": np.ma.array,
    "matrix_subclass": lambda a: a.view(np.matrix),
}
COMPLEX_LAYOUTS = {
    "complex128": lambda a: a.view(np.complex128),
    "complex64": lambda a: a.view(np.complex128).astype(np.complex64),
    "complex_fortran": lambda a: np.asfortranarray(a.view(np.complex128)),
    "complex_gaps": lambda a: with_gaps(a.view(np.complex128)),
    "complex_lists": lambda a: a.view(np.complex128).tolist(),
}


@pytest.mark.parametrize("layout", [*LAYOUTS, *COMPLEX_LAYOUTS])
def test_layout_of_points_makes_no_difference(layout):
    # Small integers are exact in all types.
    points = np.round(100 * sample(2, num=150))
    given = (LAYOUTS | COMPLEX_LAYOUTS)[layout](points)
    for method in METHODS:
        expected = rm.reconstruct(points, 2, method=method)
        assert len(expected.simplices)
        assert_same_arrays(rm.reconstruct(given, 2, method=method), expected)
    for found, wanted in zip(
        rm.neighborhoods(given, 9), rm.neighborhoods(points, 9), strict=True
    ):
        np.testing.assert_array_equal(found, wanted)


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("kind", ["gram", "distances"])
def test_layout_of_products_makes_no_difference(kind, layout):
    # Small integers again; those of the l1 metric are distances of some space.
    points = np.round(4 * sample(2, num=60))
    matrix = {
        "gram": points @ points.T,
        "distances": np.abs(points[:, None] - points).sum(axis=2),
    }[kind]
    given = {kind: LAYOUTS[layout](matrix)}
    for method in METHODS:
        expected = rm.reconstruct(**{kind: matrix}, dim=2, method=method)
        assert len(expected.simplices)
        assert_same_arrays(rm.reconstruct(**given, dim=2, method=method), expected)


@pytest.mark.parametrize(
    "layout",
    [
        *(name for name in LAYOUTS if "int" not in name and "matrix" not in name),
        *COMPLEX_LAYOUTS,
    ],
)
def test_layout_of_bases_makes_no_difference(layout):
    points = sample(2)
    tangents = rm.tangent_spaces(points, 2)
    bases = np.full_like(tangents.bases, np.nan)
    bases[~tangents.boundary] = np.eye(2, 4)  # exact in all types
    expected = rm.local_regions(points, bases)
    given = (LAYOUTS | COMPLEX_LAYOUTS)[layout](bases)
    found = rm.local_regions(points, given, tangents.boundary.tolist())
    assert len(expected.edge_sets.indices)
    np.testing.assert_array_equal(found.radii, expected.radii)
    for sets in ("edge_sets", "stars"):
        for part, wanted in zip(
            getattr(found, sets), getattr(expected, sets), strict=True
        ):
            np.testing.assert_array_equal(part, wanted)


@pytest.mark.parametrize("method", METHODS)
def test_complex_samples_have_the_real_part_of_their_product(method):
    points = sample(2)
    numbers = points.view(np.complex128)
    rec = rm.reconstruct(numbers, 2, method=method)
    assert rec.ambient_dim == 4
    gram = numbers @ numbers.conj().T
    by_gram = rm.reconstruct(gram=gram, dim=2, method=method)
    np.testing.assert_array_equal(by_gram.simplices, rec.simplices)
    assert len(rec.simplices)


# --- Lifetime and copies --------------------------------------------------------


def pickled(value):
    return pickle.loads(pickle.dumps(value))


def test_results_outlive_their_inputs():
    expected = rm.reconstruct(sample(2), 2, method="paper")
    points = sample(2)
    rec = rm.reconstruct(points, 2, method="paper")
    found = arrays_of(rec)
    views = {name: array[1:] for name, array in found.items()}
    tangents = rm.tangent_spaces(points, 2)
    regions = rm.local_regions(points, tangents.bases, tangents.boundary)
    del points, rec, found, tangents
    gc.collect()
    _ = [np.full(2**k, 7.0) for k in range(4, 20)]  # reuse what was freed
    for name, array in arrays_of(expected).items():
        np.testing.assert_array_equal(views[name], array[1:], err_msg=name)
    np.testing.assert_array_equal(regions.stars.simplices, expected.stars.simplices)
    np.testing.assert_array_equal(regions.edge_sets.indices, expected.edge_sets.indices)


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, pickled])
@pytest.mark.parametrize("kind", ["points", "gram"])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("reported", [False, True])
def test_results_can_be_pickled(duplicate, kind, method, reported):
    rec = rm.reconstruct(**known_by(kind, sample(2)), dim=2, method=method)
    if reported:
        assert rec.topology().betti_numbers[0] >= 1
        assert rec.repair.num_callouses >= 0
    twin = duplicate(rec)
    assert_same_arrays(twin, rec)
    assert repr(twin) == repr(rec)
    for name in ("dim", "ambient_dim", "search", "num_neighbors", "timings"):
        assert getattr(twin, name) == getattr(rec, name)
    assert isinstance(twin.edge_sets, rm.EdgeSets if method == "paper" else type(None))
    assert twin.topology().betti_numbers == rec.topology().betti_numbers
    assert twin.repair.remaining() == rec.repair.remaining()


@pytest.mark.parametrize("duplicate", [copy.deepcopy, pickled])
@pytest.mark.parametrize("method", METHODS)
def test_copies_are_read_only(duplicate, method):
    rec = rm.reconstruct(sample(1), 1, method=method)
    twin = duplicate(rec)
    assert not writeable(twin)
    assert not writeable(twin.repair)
    assert not writeable(rec.repair)


@pytest.mark.parametrize("duplicate", [copy.deepcopy, pickled])
@pytest.mark.parametrize("method", METHODS)
def test_copies_of_reports_are_read_only(duplicate, method):
    assert not writeable(duplicate(rm.reconstruct(sample(1), 1, method=method).repair))


@pytest.mark.parametrize("method", METHODS)
def test_reports_can_be_pickled(method):
    rec = rm.reconstruct(sample(3), 3, method=method)
    topology = rec.topology()
    for _ in range(2):  # before and after its homology is known
        twin = pickled(topology)
        assert repr(twin) == repr(topology)
        assert twin.betti_numbers == topology.betti_numbers
        assert twin.betti_numbers_mod3 == topology.betti_numbers_mod3
        np.testing.assert_array_equal(
            twin.singular_vertices, topology.singular_vertices
        )
    twin = pickled(rec.repair)
    for name, value in vars(rec.repair).items():
        np.testing.assert_array_equal(getattr(twin, name), value, err_msg=name)


@pytest.mark.parametrize(
    "steps",
    [
        lambda points: rm.neighborhoods(points, 5),
        lambda points: rm.tangent_spaces(points, 1),
        lambda points: rm.local_regions(points, rm.tangent_spaces(points, 1).bases),
    ],
)
def test_steps_can_be_pickled(steps):
    result = steps(sample(1))
    twin = pickled(result)
    assert type(twin) is type(result)
    assert repr(twin) == repr(result)


@pytest.mark.parametrize("method", METHODS)
def test_results_can_be_compared_and_hashed(method):
    rec = rm.reconstruct(sample(1), 1, method=method)
    twin = pickled(rec)
    pairs = [
        (rec, twin),
        (rec.topology(), twin.topology()),
        (rec.repair, twin.repair),
    ]
    for result, other in pairs:
        assert result != other
        assert len({result, other}) == 2


@pytest.mark.parametrize("method", METHODS)
def test_repr(method):
    points = sample(2)
    rec = rm.reconstruct(points, 2, method=method)
    m = len(rec.simplices)
    text = f"samples=400, ambient_dim=4, dim=2, simplices={m}, method={method!r}"
    assert repr(rec) == f"Reconstruction({text})"
    text = text.replace("ambient_dim=4, ", "")
    by_gram = rm.reconstruct(gram=points @ points.T, dim=2, method=method)
    assert repr(by_gram) == f"Reconstruction({text})"
    topology = repr(rec.topology())
    assert topology.startswith("Topology(dim=2, num_simplices=(")
    assert "array" not in topology
    assert repr(rec.repair).startswith(f"Repair(method={method!r}, ")


def results():
    """One of each public class, of both methods."""
    for method in METHODS:
        rec = rm.reconstruct(sample(2), 2, method=method, smooth=True)
        yield from (rec, rec.topology(), rec.repair, rec.smoothing, rec.subset([0]))
        yield from (rec.project(sample(2)), rec.sample(5), rm.embed(rec))
        yield from (rec.check(), *rec.check().checked)
    tangents = rm.tangent_spaces(sample(2), 2)
    regions = rm.local_regions(sample(2), tangents.bases, tangents.boundary)
    yield from (tangents, regions, regions.edge_sets, regions.stars)
    yield from (rm.neighborhoods(sample(2), 4), rm.estimate_dimension(sample(2)))
    yield rm.SimplicialComplex(sample(2), [[0, 1, 2]])
    yield rm.forecast(sample(2), dim=2)
    cap = rm.reconstruct(rm.datasets.spherical_cap(100, random_state=0), 2)
    yield from cap.openings
    calculus, heights = cap.calculus, cap.vertices[:, 2]
    yield from (calculus, calculus.spectrum(3), calculus.poisson(heights))
    yield from (calculus.fit(heights), calculus.circular_coordinates())
    yield from (calculus.voronoi_cells([0]), calculus.mean([0]))
    yield from (calculus.intrinsic_delaunay(), cap.estimate_volume())
    yield from (calculus.logarithm(0), calculus.curvature(), calculus.angle_defects())
    atlas = calculus.charts()
    yield from (atlas, atlas.charts[0], atlas.transform(cap.vertices), cap.simplify(50))


def test_reprs_are_one_line():
    seen = set()
    for result in results():
        text = repr(result)
        assert text.startswith(f"{type(result).__name__}(")
        assert len(text) <= 120
        assert "\n" not in text
        assert "array" not in text
        seen.add(type(result).__name__)
    classes = {name for name in rm.__all__ if isinstance(getattr(rm, name), type)}
    warned = {name for name in classes if name.endswith("Warning")}
    shown = {"Parameter", "Parameters", "Provenance"}  # by tests of their own
    assert classes - warned - seen - shown == {
        *("Place", "Quality", "Reason", "Singularities"),
    }


SQUARE = [[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [0.0, 4.0]]


@pytest.mark.parametrize(
    ("result", "text"),
    [
        (
            lambda c: c.topology(),
            (
                "Topology(dim=2, num_simplices=(4, 5, 2), betti_numbers=(1, 0, 0), "
                "manifold=True, closed=False, orientable=True)"
            ),
        ),
        (
            lambda c: c.project([[4.0, 4.0], [1.0, 1.0]]),
            "Projection(points=2, ambient_dim=2, dim=2, largest_distance=1.0)",
        ),
        (
            lambda c: c.project(np.empty((0, 2))),
            "Projection(points=0, ambient_dim=2, dim=2)",
        ),
        (lambda c: c.sample(3, 0), "PointsOnComplex(points=3, ambient_dim=2, dim=2)"),
        (rm.embed, "Embedding(points=4, method='coordinates', kept=1.0)"),
        (
            lambda c: c.boundary_complex(),
            "Subcomplex(vertices=4, ambient_dim=2, dim=1, simplices=4)",
        ),
        (
            lambda c: rm.neighborhoods(c.vertices, 2),
            "Neighborhoods(samples=4, num_neighbors=2)",
        ),
        (
            lambda c: rm.tangent_spaces(c.vertices, 1),
            "TangentSpaces(samples=4, ambient_dim=2, dim=1, boundary=4)",
        ),
        (
            lambda _: rm.EdgeSets(np.arange(3), np.zeros(2)),
            "EdgeSets(samples=2, indices=2)",
        ),
        (
            lambda _: rm.Stars(np.arange(3), np.zeros((2, 3))),
            "Stars(samples=2, dim=2, simplices=2)",
        ),
        (
            lambda _: rm.Smoothing(np.zeros((7, 2)), 0.123456, 0.25, 9, 2),
            (
                "Smoothing(samples=7, moved=True, noise=0.1235, prediction_error=0.25, "
                "num_neighbors=9, rounds=2)"
            ),
        ),
    ],
)
def test_reprs_say_what_matters(result, text):
    square = rm.SimplicialComplex(SQUARE, [[0, 1, 2], [0, 2, 3]])
    assert repr(result(square)) == text


def test_reprs_compute_nothing():
    """Linear algebra would take long: the numbers are said once they are known."""
    rng = np.random.default_rng(0)
    topology = rm.reconstruct(rng.normal(size=(60, 3)), 3).topology()
    assert "betti_numbers" not in repr(topology)
    assert "components=1, " in repr(topology)
    assert topology.betti_numbers[0] == 1
    assert "betti_numbers=(1, " in repr(topology)


@pytest.mark.parametrize("method", METHODS)
def test_repr_of_a_repair_counts_what_remains(method):
    repair = rm.reconstruct(sample(2)[:100], 2, method=method).repair
    assert repr(repair).endswith(f"remaining={len(repair.remaining())})")


def test_public_classes_are_named_and_pickled_by_the_package():
    for name in rm.__all__:
        public = getattr(rm, name)
        if isinstance(public, type):
            assert public.__module__ == "remanifold"
            assert pickled(public) is public
    steps = rm.neighborhoods(sample(2), 3)
    assert b"remanifold.method" not in pickle.dumps(steps)


def test_dir_has_the_public_names_only():
    names = {name for name in dir(rm) if not name.startswith("__")}
    assert names == {*rm.__all__} - {"__version__"}
    assert {"__version__", "__doc__"} <= {*dir(rm)}
    assert importlib.import_module("remanifold.complex") is rm.complex


# --- Composition ----------------------------------------------------------------


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
@pytest.mark.parametrize("estimator", ["enclosure", "pca", "jet"])
def test_steps_compose_to_the_whole(dim, estimator):
    points = sample(dim)
    points = np.vstack([points, points[3:9]])
    expected = rm.reconstruct(points, dim, method="paper", estimator=estimator)
    tangents = rm.tangent_spaces(points, dim, estimator=estimator)
    np.testing.assert_array_equal(tangents.bases, expected.tangents)
    np.testing.assert_array_equal(tangents.simplices, expected.tangent_simplices)
    np.testing.assert_array_equal(tangents.boundary, expected.boundary)
    regions = rm.local_regions(points, tangents.bases, tangents.boundary)
    np.testing.assert_array_equal(regions.unbounded, expected.unbounded)
    np.testing.assert_array_equal(np.isinf(regions.radii), regions.unbounded)
    np.testing.assert_array_equal(np.isnan(regions.radii), expected.boundary)
    np.testing.assert_array_equal(regions.stars.offsets, expected.stars.offsets)
    np.testing.assert_array_equal(regions.stars.simplices, expected.stars.simplices)
    # Samples without a basis need not be marked.
    for boundary in (None, tangents.boundary):
        sets = rm.edge_sets(points, tangents.bases, boundary)
        np.testing.assert_array_equal(sets.offsets, expected.edge_sets.offsets)
        np.testing.assert_array_equal(sets.indices, expected.edge_sets.indices)
    for edges in ("mutual", "either"):
        whole = rm.reconstruct(
            points, dim, method="paper", estimator=estimator, edges=edges
        )
        np.testing.assert_array_equal(
            rm.clique_complex(*sets, dim, edges), whole.simplices
        )
        np.testing.assert_array_equal(rm.clique_complex(*sets, 1, edges), whole.edges)
        assert len(whole.simplices)


def test_marked_samples_have_no_region():
    points = sample(2)
    tangents = rm.tangent_spaces(points, 2)
    marked = np.zeros(400, dtype=bool)
    marked[:50] = True
    regions = rm.local_regions(points, tangents.bases, marked)
    assert regions.edge_sets.offsets[50] == regions.stars.offsets[50] == 0
    assert np.isnan(regions.radii[:50]).all()
    rest = rm.local_regions(points, tangents.bases)
    np.testing.assert_array_equal(regions.radii[50:], rest.radii[50:])


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_either_contains_mutual(dim):
    points = sample(dim)
    mutual = rm.reconstruct(points, dim, method="paper")
    either = rm.reconstruct(points, dim, method="paper", edges="either")
    assert_same_arrays(either, mutual, but=("edges", "simplices"))
    for name in ("edges", "simplices"):
        few, more = (
            {tuple(row) for row in getattr(rec, name).tolist()}
            for rec in (mutual, either)
        )
        assert few <= more, name
        assert dim == 1 or few < more, name


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("method", METHODS)
def test_copies_are_mapped_back(dim, method):
    points = sample(dim)
    n = len(points)
    single = rm.reconstruct(points, dim, method=method)
    more = np.vstack([points, points[5:8], points[5:6]])
    copied = rm.reconstruct(more, dim, method=method)
    copies = [*range(n), 5, 6, 7, 5]
    np.testing.assert_array_equal(copied.representatives, copies)
    for name in ("simplices", "edges"):
        np.testing.assert_array_equal(getattr(copied, name), getattr(single, name))
    paper_only = ("boundary", "unbounded", "tangent_simplices")
    for name in ("tangents", *(paper_only if method == "paper" else ())):
        np.testing.assert_array_equal(
            getattr(copied, name), getattr(single, name)[copies], err_msg=name
        )
    for sets in ("edge_sets", "stars") if method == "paper" else ():
        found, expected = getattr(copied, sets), getattr(single, sets)
        np.testing.assert_array_equal(found.offsets[: n + 1], expected.offsets)
        assert (found.offsets[n:] == expected.offsets[-1]).all()
        np.testing.assert_array_equal(found[1], expected[1])
    assert copied.repair.merged_samples == 4
    for name, value in vars(single.repair).items():
        if name != "merged_samples":
            np.testing.assert_array_equal(
                getattr(copied.repair, name), value, err_msg=name
            )


# --- Searches -------------------------------------------------------------------


@pytest.mark.parametrize("search", SEARCHES)
@pytest.mark.parametrize("ambient", [3, 30])
def test_exact_searches_agree_and_do_not_warn(search, ambient):
    points = rm.datasets.embed(sample(2)[:, :3], ambient, random_state=0)
    for method in METHODS:
        expected = rm.reconstruct(points, 2, method=method)
        found = rm.reconstruct(points, 2, method=method, search=search, checks=1)
        assert_same_arrays(found, expected)
        assert found.recall == 1
        assert search in ("auto", found.search)


def vague():
    return np.random.default_rng(0).normal(size=(2000, 12))


def test_a_search_of_few_leaves_warns():
    points = vague()
    exact = rm.neighborhoods(points, 10)
    found = []
    for num_threads in (1, 2):
        with pytest.warns(rm.RecallWarning, match=r"found \d\d\.\d\d% of") as caught:
            near = rm.neighborhoods(
                points, 10, search="approximate", checks=16, num_threads=num_threads
            )
        assert [warning.filename for warning in caught] == [__file__]
        found.append(near)
    for one, other, best in zip(*found, exact, strict=True):
        np.testing.assert_array_equal(one, other)
        assert (one != best).any()
    with pytest.warns(rm.RecallWarning):
        recs = [
            rm.reconstruct(points, 1, method="paper", search="approximate", checks=16)
            for _ in "ab"
        ]
    assert_same_arrays(*recs)
    assert recs[0].recall == recs[1].recall
    assert 0.1 < recs[0].recall < 0.9
    assert recs[0].search == "approximate"


def test_a_search_of_all_leaves_does_not_warn():
    points = vague()
    near = rm.neighborhoods(points, 10, search="approximate", checks=10**6)
    np.testing.assert_array_equal(near.indices, rm.neighborhoods(points, 10).indices)
    for method in METHODS:
        rec = rm.reconstruct(
            sample(2), 2, method=method, search="approximate", checks=10**6
        )
        assert_same_arrays(rec, rm.reconstruct(sample(2), 2, method=method))
        assert rec.recall == 1


def test_warnings_have_a_common_base():
    for kind in (rm.ManifoldWarning, rm.RecallWarning):
        assert issubclass(kind, rm.RemanifoldWarning)
    assert issubclass(rm.RemanifoldWarning, UserWarning)


# --- The package ----------------------------------------------------------------

MODULES = [
    f"remanifold.{module.name}"
    for module in pkgutil.iter_modules(rm.__path__)
    if not module.name.startswith("_")
]


def modules_after(script):
    script += "; import sys; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    return done.stdout.split()


def test_import_alone_loads_the_core_and_nothing_else():
    loaded = modules_after("import remanifold; remanifold.__version__")
    assert "remanifold._core" in loaded
    rooms = {name for name in loaded if name.startswith("remanifold.")}
    assert rooms == {"remanifold._core"}
    assert "numpy" not in loaded


@pytest.mark.parametrize(
    "first",
    [
        "from remanifold import *; reconstruct",
        "import remanifold; remanifold.complex",  # a room rather than a name
        "from remanifold import io",
        "import remanifold; remanifold.__all__",
        "import remanifold; dir(remanifold)",
        "import remanifold.sklearn",
    ],
)
def test_whatever_is_asked_for_first_loads_all_names(first):
    assert "remanifold._public" in modules_after(first)


def test_names_that_are_none_are_refused():
    with pytest.raises(AttributeError, match="no attribute 'recon'"):
        _ = rm.recon


def test_loading_all_names_is_light():
    loaded = modules_after("import remanifold; remanifold.reconstruct")
    assert "remanifold.method.steps" in loaded
    heavy = {"typer", "click", "rich", "meshio", "gudhi", "matplotlib", "scipy"}
    heavy |= {"sklearn", "potpourri3d"}
    heavy |= {"laspy", "networkx", "plotly", "pyvista", "trimesh", "vtkmodules"}
    assert not heavy.intersection(loaded)


def test_all_is_complete():
    assert rm.reconstruct  # whichever test comes first
    public = {
        name
        for name, value in vars(rm).items()
        if not name.startswith("_")
        and getattr(value, "__module__", "remanifold").startswith("remanifold")
        and not (
            inspect.ismodule(value)
            and name not in ("datasets", "interoperability", "io")
        )
    }
    assert {*rm.__all__} == public | {"__version__"}
    assert len(rm.__all__) == len(set(rm.__all__))
    for module in (rm.datasets, rm.interoperability, rm.io):
        own = {
            name
            for name, value in vars(module).items()
            if not name.startswith("_") and inspect.isfunction(value)
            if value.__module__ == module.__name__
        }
        assert own <= {*module.__all__}
        assert all(hasattr(module, name) for name in module.__all__)


def public_functions():
    for module in (rm, rm.datasets, rm.interoperability, rm.io):
        for name in module.__all__:
            value = getattr(module, name)
            if inspect.isfunction(value):
                yield pytest.param(value, id=f"{module.__name__}.{name}")


def public_methods():
    for kind in (rm.SimplicialComplex, ManifoldReconstruction):
        for name, value in vars(kind).items():
            # What converts points to `interoperability`, where it is documented.
            own = not name.startswith(("_", "to_"))
            if own and inspect.isfunction(value):
                yield pytest.param(value, id=f"{kind.__name__}.{name}")


@pytest.mark.parametrize("function", [*public_functions(), *public_methods()])
def test_functions_are_documented(function):
    text = inspect.getdoc(function)
    parts = re.split(r"^(\w[\w ]*)\n-+\n", text, flags=re.MULTILINE)
    summary, sections = parts[0], dict(zip(parts[1::2], parts[2::2], strict=True))
    assert summary.splitlines()[0].endswith(".")
    signature = inspect.signature(function)
    parameters = sorted(set(signature.parameters) - {"self"})
    section = sections["Parameters"] if parameters else ""
    entries = re.findall(r"^([*\w][\w, *]*)(?: :|$)", section, re.MULTILINE)
    documented = [name.strip(" *\\") for entry in entries for name in entry.split(",")]
    assert sorted(documented) == parameters
    if signature.return_annotation not in (None, "None"):
        assert sections["Returns"].strip()


@pytest.mark.parametrize("name", ["remanifold", *MODULES])
def test_examples_in_docstrings(name):
    result = doctest.testmod(importlib.import_module(name))
    assert result.failed == 0
    with_examples = (
        *(
            "remanifold",
            "cleaning",
            "shapes",
            "dimension",
            "embedding",
            "plotting",
            "report_page",
            "graphs",
            "io",
        ),
        *("reconstruction", "simplicial_complex", "singularities", "sklearn", "steps"),
    )
    assert (result.attempted > 0) == (name.rpartition(".")[2] in with_examples)


def test_version():
    assert re.fullmatch(r"\d+\.\d+\.\d+\S*", rm.__version__)


@pytest.mark.parametrize("kind", ["gram", "distances"])
def test_products_of_single_precision_need_not_be_symmetric(kind):
    """Their rounding is replaced by the mean of both sides; more is refused."""
    points = rm.datasets.circle(60, random_state=0)
    exact = points @ points.T
    if kind == "distances":
        exact = np.linalg.norm(points[:, None] - points, axis=2)
    noise = np.random.default_rng(0).uniform(-1e-7, 1e-7, exact.shape)
    uneven = exact + noise * (1 - np.eye(60))
    rec = rm.reconstruct(dim=1, **{kind: uneven})
    assert rec.topology().betti_numbers == (1, 1)
    even = rm.reconstruct(dim=1, **{kind: (uneven + uneven.T) / 2})
    np.testing.assert_array_equal(rec.simplices, even.simplices)
    uneven[3, 5] += 1e-4
    with pytest.raises(ValueError, match=rf"{kind}.* symmetric"):
        rm.reconstruct(dim=1, **{kind: uneven})


@pytest.mark.parametrize(
    ("module", "name"),
    [("distributed", "reconstruct"), ("sklearn", "ManifoldReconstruction")],
)
def test_modules_need_no_import_of_their_own(module, name):
    code = f"""
import sys
import remanifold as rm
rm.reconstruct
assert "remanifold.{module}" not in sys.modules  # nobody waits for it who does not ask
assert "{module}" not in dir(rm)
rm.{module}.{name}
"""
    subprocess.run([sys.executable, "-c", code], check=True)
