# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad input: an exception that names the argument, and the index where there is one."""

import inspect
import re
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.spatial.distance import cdist

import remanifold as rm
from remanifold.method.options import METHODS

# Samples of nothing in particular, where the result must lack something.
pytestmark = pytest.mark.filterwarnings("ignore::remanifold.ManifoldWarning")

POINTS = np.random.default_rng(0).normal(size=(30, 3))
GRAM = POINTS @ POINTS.T
DISTANCES = cdist(POINTS, POINTS)
COMPLEX = POINTS + 1j * POINTS[::-1]
FRAMES = np.broadcast_to(np.eye(2, 3), (30, 2, 3))
TRIANGLE = np.array([[0, 1, 2]], dtype=np.int32)

# Arguments that are right, of every public function.
RIGHT = {
    rm.reconstruct: {"points": POINTS, "dim": 2},
    rm.tangent_spaces: {"points": POINTS, "dim": 2},
    rm.estimate_dimension: {"points": POINTS},
    rm.find_outliers: {"points": POINTS, "dim": 2},
    rm.smooth: {"points": POINTS, "dim": 2},
    rm.neighborhoods: {"points": POINTS, "num_neighbors": 3},
    rm.find_singularities: {"points": POINTS, "dim": 2},
    rm.local_regions: {"points": POINTS, "bases": FRAMES},
    rm.edge_sets: {"points": POINTS, "bases": FRAMES},
    rm.clique_complex: {"offsets": [0, 1, 2], "indices": [1, 0], "dim": 1},
    rm.compute_topology: {"simplices": TRIANGLE, "num_vertices": 3},
    rm.edge_graph: {"complex": rm.SimplicialComplex(POINTS, TRIANGLE)},
    rm.plot: {
        "complex": rm.SimplicialComplex(POINTS, TRIANGLE),
        "backend": "matplotlib",
        "show": False,
    },
}
WITH_APPROXIMATE_SEARCH = (rm.reconstruct, rm.neighborhoods)


def masked(array, index):
    array = np.ma.array(array)
    array[index] = np.ma.masked
    return array


def takes(function, argument):
    return argument in inspect.signature(function).parameters


def put(array, index, value):
    array = np.array(array)
    array[index] = value
    return array


def call(function, argument, value):
    arguments = {**RIGHT[function], argument: value}
    if argument in ("gram", "distances"):
        del arguments["points"]
    if function is rm.reconstruct and argument == "edges":
        arguments["method"] = "paper"
    return function(**arguments)


def refused(function, argument, value, error, says):
    with pytest.raises(error, match=says) as caught:
        call(function, argument, value)
    assert re.search(rf"\b{argument}\b", str(caught.value)), caught.value


def table(cases):
    """Every case for every function that takes the argument."""
    return [
        pytest.param(
            *(function, argument, value, error, says),
            id=f"{function.__name__}-{argument}-{label}",
        )
        for argument, rows in cases.items()
        for function in RIGHT
        if takes(function, argument)
        for label, value, error, says in rows
    ]


def test_right_arguments_are_accepted():
    functions = {getattr(rm, name) for name in rm.__all__}
    # One leaves a file, one reads one, one has methods of its own, one takes a number as
    # well: tested elsewhere.
    functions -= {rm.write_report, rm.load, rm.embed, rm.forecast}
    assert {f for f in functions if inspect.isfunction(f)} == set(RIGHT)
    for function, arguments in RIGHT.items():
        function(**arguments)
        for argument, value in (("gram", GRAM), ("distances", DISTANCES)):
            if takes(function, argument):
                call(function, argument, value)
    for argument in (
        *("method", "estimator", "edges", "boundary", "hole_radius"),
        *("outliers", "smooth"),
    ):
        default = inspect.signature(rm.reconstruct).parameters[argument].default
        call(rm.reconstruct, argument, default)


# --- Samples --------------------------------------------------------------------

MATRICES = [
    ("empty_list", [], ValueError, r"two-dimensional .* got shape \(0,\)"),
    ("number", 3.0, ValueError, r"two-dimensional .* got shape \(\)"),
    ("1d", POINTS[0], ValueError, r"two-dimensional .* got shape \(3,\)"),
    ("3d", POINTS[None], ValueError, r"two-dimensional .* got shape \(1, 30, 3\)"),
    (
        "cloud",
        SimpleNamespace(points=POINTS),
        TypeError,
        r"numbers.*: pass its \.points",
    ),
    ("ragged", [[1, 2], [3]], ValueError, "rows differ in length"),
    ("text", "points.ply", TypeError, "must hold numbers"),
    ("texts", [["1", "2"], ["3", "4"]], TypeError, "must hold numbers"),
    ("bytes", b"12", TypeError, "must hold numbers"),
    ("object", object(), TypeError, "must hold numbers"),
    ("objects", [[object()] * 3] * 4, TypeError, "must hold numbers"),
    ("dict", {"x": [1, 2]}, TypeError, "must hold numbers"),
    ("generator", (row for row in POINTS), TypeError, "must hold numbers"),
    ("dates", np.zeros((4, 2), "M8[s]"), TypeError, "must hold numbers"),
    ("records", np.zeros(4, [("x", float)]), TypeError, "must hold numbers"),
    ("huge_int", [[10**400, 1], [2, 3]], OverflowError, "no float64 can hold"),
    ("masked", masked(np.eye(4), (3, 1)), ValueError, r"\[3, 1\] is masked"),
]


def beyond_double(name, array):
    """Of the type as wide as 80 bits, where the platform has one."""
    wide = np.result_type(array, np.longdouble)
    if np.finfo(wide).max <= np.finfo(float).max:
        return []
    huge = put(array.astype(wide), (2, 1), np.longdouble("1e4000"))
    says = rf"{name}\[2, 1\] is .*1e\+4000.*, infinite in double precision"
    short = rf"{name}\[2, 1\] is inf"
    objects = [("objects_beyond", huge.astype(object), ValueError, short)]
    return [
        (f"{wide}", huge, ValueError, says),
        *(objects if wide.kind == "f" else []),
    ]


SQUARES = [
    *MATRICES,
    ("no_samples", np.empty((0, 0)), ValueError, "is empty"),
    ("wide", np.ones((4, 5)), ValueError, r"square, got shape \(4, 5\)"),
    ("tall", np.ones((5, 4)), ValueError, r"square, got shape \(5, 4\)"),
]
SAMPLES = {
    "points": [
        *MATRICES,
        ("no_samples", np.empty((0, 3)), ValueError, "is empty"),
        (
            "images",
            np.zeros((4, 8, 3)),
            ValueError,
            r"; points\.reshape\(4, -1\) makes .*, points\.reshape\(-1, 3\) each 3 numbers",
        ),
        ("sparse", csr_array(GRAM), TypeError, r"numbers.* pass its \.toarray\(\)"),
        ("no_coordinates", np.empty((5, 0)), ValueError, "has no coordinates"),
        ("nan", put(POINTS, (4, 1), np.nan), ValueError, r"points\[4, 1\] is nan"),
        ("inf", put(POINTS, (29, 2), np.inf), ValueError, r"points\[29, 2\] is inf"),
        ("-inf", put(POINTS, (0, 0), -np.inf), ValueError, r"points\[0, 0\] is -inf"),
        ("none_inside", [[0.0], [None], [1.0]], ValueError, r"points\[1, 0\] is nan"),
        (
            "complex_nan",
            put(POINTS + 0j, (4, 1), complex(1, np.nan)),
            ValueError,
            r"points\[4, 1\]",
        ),
        *beyond_double("points", POINTS),
        *beyond_double("points", POINTS + 0j),
    ],
    "gram": [
        *SQUARES,
        ("nan", put(GRAM, (3, 4), np.nan), ValueError, r"gram\[3, 4\] is nan"),
        ("inf", put(GRAM, (3, 4), np.inf), ValueError, r"gram\[3, 4\] is inf"),
        ("asymmetric", put(GRAM, (3, 4), 0.0), ValueError, "symmetric.*(4, 3|3, 4)"),
        (
            "diagonal",
            put(GRAM, (3, 3), -1.0),
            ValueError,
            r"not positive semidefinite: gram\[3, 3\] is -1",
        ),
        ("negative", -GRAM, ValueError, "not positive semidefinite"),
        ("distances", DISTANCES, ValueError, "smallest eigenvalue.*distances="),
        ("complex_nan", put(GRAM + 0j, (3, 4), np.nan), ValueError, r"gram\[3, 4\] is"),
        (
            "complex_nan_aside",
            put(GRAM + 0j, (3, 4), complex(1, np.nan)),
            ValueError,
            r"gram\[3, 4\] is \(1\+nanj\)",
        ),
        ("complex_wide", np.ones((4, 5)) + 0j, ValueError, r"square.* \(4, 5\)"),
        (
            "not_hermitian",
            put(put(GRAM + 0j, (3, 4), 2 + 1j), (4, 3), 2 + 1j),
            ValueError,
            r"not Hermitian: gram\[3, 4\] is \(2\+1j\), not the conj.* gram\[4, 3\], \(2",
        ),
        (
            "complex_diagonal",
            put(GRAM + 0j, (5, 5), 9 + 1e-3j),
            ValueError,
            r"not Hermitian: gram\[5, 5\] is \(9\+0.001j\), not real$",
        ),
        ("holomorphic", COMPLEX @ COMPLEX.T, ValueError, r"Hermitian: gram\[0, 0\] is"),
        *beyond_double("gram", GRAM),
    ],
    "distances": [
        *SQUARES,
        ("nan", put(DISTANCES, (3, 4), np.nan), ValueError, r"distances\[3, 4\] is na"),
        ("inf", put(DISTANCES, (3, 4), np.inf), ValueError, r"distances\[3, 4\] is in"),
        (
            "asymmetric",
            put(DISTANCES, (3, 4), 9.0),
            ValueError,
            "symmetric.*(4, 3|3, 4)",
        ),
        (
            "diagonal",
            put(DISTANCES, (3, 3), 1e-5 * DISTANCES.max()),
            ValueError,
            r"\[3, 3\] is .*, not zero",
        ),
        ("pairs", DISTANCES[0], ValueError, "squareform"),
        ("negative", -DISTANCES, ValueError, r"\[1, 0\] is negative"),
        ("gram", GRAM, ValueError, r"not zero; pass inner products as gram="),
        # What it leaves out is not zero.
        ("sparse", csr_array(DISTANCES), TypeError, r"must hold numbers, got .*array$"),
        ("complex", DISTANCES + 0j, TypeError, "must be real"),
        *beyond_double("distances", DISTANCES),
    ],
}


@pytest.mark.parametrize(
    ("function", "argument", "value", "error", "says"), table(SAMPLES)
)
def test_samples(function, argument, value, error, says):
    refused(function, argument, value, error, says)


def test_rounding_of_distances_to_themselves():
    # As of products; on a copy.
    squares = (POINTS**2).sum(axis=1)
    found = squares[:, None] + squares - 2 * POINTS @ POINTS.T
    distances = np.sqrt(np.maximum(found, 0.0))
    np.fill_diagonal(distances, 1e-8)
    exact = distances - np.diag(np.diagonal(distances))
    rounded = rm.neighborhoods(distances=distances, num_neighbors=5)
    np.testing.assert_array_equal(
        rounded.indices, rm.neighborhoods(distances=exact, num_neighbors=5).indices
    )
    assert (np.diagonal(distances) == 1e-8).all()


@pytest.mark.parametrize("function", [f for f in RIGHT if takes(f, "points")])
def test_no_samples_at_all(function):
    with pytest.raises((TypeError, ValueError), match=r"\bpoints\b"):
        call(function, "points", None)


@pytest.mark.parametrize("function", [f for f in RIGHT if takes(f, "gram")])
@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"points": POINTS, "gram": GRAM}, "got points and gram"),
        ({"points": POINTS, "distances": DISTANCES}, "got points and distances"),
        ({"gram": GRAM, "distances": DISTANCES}, "got gram and distances"),
        ({}, "got none"),
    ],
)
def test_samples_are_described_once(function, given, says):
    rest = {name: v for name, v in RIGHT[function].items() if name != "points"}
    with pytest.raises(TypeError, match=f"exactly one of points, gram.*{says}"):
        function(**given, **rest)


@pytest.mark.parametrize(
    "function", [rm.reconstruct, rm.tangent_spaces, rm.find_outliers]
)
@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("argument", ["points", "gram", "distances"])
def test_too_few_samples(function, dim, argument):
    samples = {"points": POINTS, "gram": GRAM, "distances": DISTANCES}[argument]
    for num in range(1, dim + 1):
        few = samples[:num] if argument == "points" else samples[:num, :num]
        says = rf"{argument} has {num} samples?; .* dim \+ 1 = {dim + 1}"
        with pytest.raises(ValueError, match=says):
            function(**{argument: few}, dim=dim)


# --- Numbers and words ----------------------------------------------------------


def integers(minimum, lowest=None):
    """Lowest: where negative numbers have a meaning."""
    lowest = minimum if lowest is None else lowest
    return [
        ("least", minimum - 1, ValueError, f"is {minimum - 1}, expected at least"),
        ("negative", -(10**30), ValueError, f"expected at least {lowest}"),
        ("2^31", 2**31, ValueError, "expected at most 2147483647"),
        ("huge", 10**30, ValueError, "expected at most 2147483647"),
        ("float", 2.0, TypeError, r"must be an integer, got 2\.0 of type float"),
        ("numpy_float", np.float64(2), TypeError, "must be an integer"),
        ("nan", np.nan, TypeError, "must be an integer, got nan"),
        ("text", "2", TypeError, "must be an integer, got '2'"),
        ("bool", True, TypeError, "must be an integer, got True"),
        ("numpy_bool", np.bool_(True), TypeError, "must be an integer"),
        ("list", [2], TypeError, r"must be an integer, got \[2\]"),
        ("array", np.array([2]), TypeError, "must be an integer"),
        ("complex", 2 + 0j, TypeError, "must be an integer"),
    ]


def words(*expected):
    listed = ", ".join(map(repr, expected))
    return [
        (repr(value), value, ValueError, f"expected one of {listed}")
        for value in ("", "best", expected[0].upper(), 1, None, [expected[0]], b"pca")
    ]


def lengths():
    return [
        *(
            (repr(value), value, ValueError, "expected a positive finite number")
            for value in (0, -1, -0.0, np.nan, np.inf, np.float32(-2))
        ),
        *(
            (repr(value), value, TypeError, "must be a number, got")
            for value in ("3", True, np.bool_(True), [3], 3 + 0j, np.ones(2))
        ),
    ]


NUMBERS_AND_WORDS = {
    "dim": [*integers(1), ("none", None, TypeError, "must be an integer, got None")],
    "num_neighbors": integers(1),
    "num_threads": integers(1, -(2**31 - 1)),
    "checks": [*integers(1), ("none", None, TypeError, "must be an integer")],
    "method": words(*METHODS),
    "hole_radius": lengths(),
    "outliers": [
        *(
            (repr(v), v, ValueError, "expected a positive finite number")
            for v in (0, -2.0, np.nan)
        ),
        *(
            (repr(v), v, ValueError, 'expected "auto", False or a distance')
            for v in ("all", True)
        ),
        ("list", [2], TypeError, "must be a number, got"),
    ],
    "smooth": [
        *((str(v), v, ValueError, "expected at least 3 neighbors") for v in (0, 2)),
        ("word", "yes", ValueError, 'expected "auto", True, False or a number'),
        ("float", 20.0, TypeError, "must be an integer"),
    ],
    "estimator": words("enclosure", "pca", "jet"),
    "edges": words("mutual", "either"),
    "search": words("auto", "kdtree", "brute_force", "approximate"),
    "progress": [
        (repr(value), value, TypeError, f"None, a bool or a function, got {value!r}")
        for value in (3, 0, 1.0, "bar", (), {"total": 3})
    ],
}


@pytest.mark.parametrize(
    ("function", "argument", "value", "error", "says"), table(NUMBERS_AND_WORDS)
)
def test_numbers_and_words(function, argument, value, error, says):
    if argument == "num_neighbors" and function is not rm.neighborhoods:
        least = "at least 6" if function is rm.estimate_dimension else "at least 3"
        says = says.replace("at least 1", least)
    if argument == "search" and function not in WITH_APPROXIMATE_SEARCH:
        says = says.replace(", 'approximate'", "$")
    optional = function is rm.reconstruct and argument in ("estimator", "edges")
    if optional and value is None:
        call(function, argument, value)
        return
    refused(function, argument, value, error, says)


def test_other_searches_are_exact():
    for function in RIGHT:
        if takes(function, "search") and function not in WITH_APPROXIMATE_SEARCH:
            says = "search is 'approximate', expected one of"
            refused(function, "search", "approximate", ValueError, says)


@pytest.mark.parametrize("function", [rm.reconstruct, rm.tangent_spaces])
def test_dim_beyond_the_space(function):
    for ambient in (1, 2, 3):
        with pytest.raises(ValueError, match=rf"dim is {ambient + 1}, .* {ambient} co"):
            function(POINTS[:, :ambient], ambient + 1)
    with pytest.raises(ValueError, match="dim is 2147483647, more than the 3"):
        function(POINTS, 2**31 - 1)
    with pytest.raises(ValueError, match="gram has 30 samples"):
        function(gram=GRAM, dim=2**31 - 1)


@pytest.mark.parametrize("function", [rm.reconstruct, rm.tangent_spaces, rm.smooth])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_neighbors_for_a_simplex(function, dim):
    function(POINTS, dim, num_neighbors=dim + 1)
    says = rf"num_neighbors is {dim}, expected at least {dim + 1} \(dim \+ 1"
    with pytest.raises(ValueError, match=says):
        function(POINTS, dim, num_neighbors=dim)


def test_number_of_neighbors_is_required():
    with pytest.raises(TypeError, match="num_neighbors must be an integer, got None"):
        rm.neighborhoods(POINTS)


@pytest.mark.parametrize(
    "function", [f for f in RIGHT if takes(f, "gram") and takes(f, "search")]
)
@pytest.mark.parametrize("argument", ["gram", "distances"])
def test_trees_need_points(function, argument):
    samples = {"gram": GRAM, "distances": DISTANCES}[argument]
    rest = {name: v for name, v in RIGHT[function].items() if name != "points"}
    approximate = ["approximate"] if function in WITH_APPROXIMATE_SEARCH else []
    for search in ["kdtree", *approximate]:
        with pytest.raises(ValueError, match=r"search.* needs points.* brute.force"):
            function(**{argument: samples}, search=search, **rest)


@pytest.mark.parametrize(
    ("method", "argument", "value", "says"),
    [
        ("manifold", "edges", "mutual", 'edges is for method="paper" only'),
        ("manifold", "edges", "either", 'edges is for method="paper" only'),
        ("manifold", "edges", "best", 'edges is for method="paper" only'),
        ("paper", "boundary", False, 'boundary is for method="manifold" only'),
        ("paper", "boundary", np.ones(30, bool), "boundary is for method="),
        ("paper", "boundary", "none", 'boundary is .none., expected "auto"'),
    ],
)
def test_arguments_of_one_method(method, argument, value, says):
    with pytest.raises(ValueError, match=says):
        rm.reconstruct(POINTS, 2, method=method, **{argument: value})


# --- Bases and boundary ---------------------------------------------------------

SHAPE = r"expected \(30, K, 3\) with 1 <= K <= 3"
FRAME_CASES = {
    "bases": [
        ("none", None, ValueError, SHAPE),
        ("empty", [], ValueError, SHAPE),
        ("one_basis", FRAMES[0], ValueError, SHAPE),
        ("few", FRAMES[:29], ValueError, rf"shape \(29, 2, 3\), {SHAPE}"),
        ("narrow", FRAMES[:, :, :2], ValueError, rf"shape \(30, 2, 2\), {SHAPE}"),
        ("dim_0", np.empty((30, 0, 3)), ValueError, SHAPE),
        ("dim_4", np.ones((30, 4, 3)), ValueError, SHAPE),
        ("ragged", [[1, 2], [3]], ValueError, "rows differ in length"),
        ("text", "bases", TypeError, "must hold numbers"),
        ("masked", masked(FRAMES, (7, 1, 2)), ValueError, r"\[7, 1, 2\] is masked"),
        ("objects", [[[object()]]], TypeError, "must hold numbers"),
        ("long", put(FRAMES, 7, 2 * FRAMES[7]), ValueError, r"\[7\] .* orthonormal"),
        ("zero", put(FRAMES, 0, 0), ValueError, r"\[0\] .* orthonormal"),
        ("skew", put(FRAMES, (29, 1), FRAMES[29, 0]), ValueError, r"\[29\] .* ortho"),
        ("second", put(FRAMES, [5, 9], 0), ValueError, r"\[5\] .* orthonormal"),
        (
            "after_missing",
            put(put(FRAMES, 2, np.nan), 6, 0),
            ValueError,
            r"\[6\] .* orthonormal",
        ),
    ],
    "boundary": [
        ("short", np.zeros(29, bool), ValueError, r"shape \(30,\), got shape \(29,\)"),
        ("2d", np.zeros((30, 1), bool), ValueError, r"got shape \(30, 1\)"),
        ("number", True, ValueError, r"got shape \(\)"),
        ("int", np.zeros(30, int), ValueError, "bool array .* dtype int64"),
        ("float", np.zeros(30), ValueError, "bool array .* dtype float64"),
        ("indices", [3, 4], ValueError, r"bool array of shape \(30,\)"),
        ("text", "none", ValueError, "bool array"),
        ("masked", masked(np.zeros(30, bool), 4), ValueError, r"\[4\] is masked"),
    ],
}


@pytest.mark.parametrize(
    ("function", "argument", "value", "error", "says"), table(FRAME_CASES)
)
def test_bases_and_boundary(function, argument, value, error, says):
    if function is rm.reconstruct and isinstance(value, str | bool):
        says = rf'boundary is {value!r}, expected "auto", False or a mask$'
    refused(function, argument, value, error, says)


@pytest.mark.parametrize("function", [rm.local_regions, rm.edge_sets])
@pytest.mark.parametrize("value", [np.inf, 1e300])
def test_bases_too_large_to_multiply(function, value):
    bases = put(FRAMES, (6, 0), value)
    refused(function, "bases", bases, ValueError, r"\[6\] .* orthonormal")


# --- Compressed rows ------------------------------------------------------------


@pytest.mark.parametrize(
    ("offsets", "indices", "error", "says"),
    [
        ([0, 2, 1, 3], [1, 0, 2], ValueError, "offsets descend at 1"),
        ([1, 2], [0, 0], ValueError, "offsets must start at 0"),
        ([0, 1, 1], [1, 0], ValueError, "offsets must .* end at the number of indices"),
        ([0, 2**40], [0], ValueError, "offsets must .* end at the number of indices"),
        ([], [], ValueError, "offsets must start at 0"),
        ([0, 1, 2], [1, 2], ValueError, r"indices\[1\] is 2, expected 0 to 1"),
        ([0, 1, 2], [-1, 0], ValueError, r"indices\[0\] is -1, expected 0 to 1"),
        ([0, 1, 2], [0, 2**40], OverflowError, "indices .* do not fit int32"),
        (np.array([0, 2**63], np.uint64), [0], OverflowError, "offsets .* fit int64"),
        ([0.0, 1.0, 2.0], [1, 0], ValueError, "offsets must .* integer .* float64"),
        ([0, 1, 2], [1.0, 0.0], ValueError, "indices must .* integer .* float64"),
        ([0, 1, 2], [True, False], ValueError, "indices must .* integer .* bool"),
        ([[0, 1, 2]], [1, 0], ValueError, r"offsets must be a one-dim.* \(1, 3\)"),
        ([0, 1, 2], [[1, 0]], ValueError, r"indices must be a one-dim.* \(1, 2\)"),
        (2, [1, 0], ValueError, r"offsets must be a one-dim.* shape \(\)"),
        (None, [1, 0], ValueError, "offsets must .* integer .* object"),
        ([0, 1, 2], None, ValueError, "indices must .* integer .* object"),
        (masked([0, 1, 2], 1), [1, 0], ValueError, r"offsets\[1\] is masked"),
        ([0, 1, 2], masked([1, 0], 0), ValueError, r"indices\[0\] is masked"),
        ("012", [1, 0], ValueError, "offsets must .* integer"),
    ],
)
def test_broken_rows(offsets, indices, error, says):
    with pytest.raises(error, match=says):
        rm.clique_complex(offsets, indices, 1)


@pytest.mark.parametrize(
    ("function", "argument"),
    [
        (rm.clique_complex, "offsets"),
        (rm.clique_complex, "indices"),
        (rm.local_regions, "boundary"),
        (rm.edge_sets, "boundary"),
        (rm.reconstruct, "boundary"),
    ],
)
def test_ragged(function, argument):
    refused(function, argument, [[0], [1, 2]], ValueError, "not rectangular")


def test_far_too_large_cliques():
    assert rm.clique_complex([0, 1, 2], [1, 0], 10**9).shape == (0, 10**9 + 1)


# --- Complexes ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("simplices", "num_vertices", "says"),
    [
        (TRIANGLE, 2, r"simplices\[0, 2\] is 2, expected 0 to 1"),
        (TRIANGLE - 1, 3, r"simplices\[0, 0\] is -1, expected 0 to 2"),
        (np.array([[0, 1], [2, 2]], np.int32), 3, r"simplices\[1\] has a vertex twice"),
    ],
)
def test_impossible_simplices(simplices, num_vertices, says):
    with pytest.raises(ValueError, match=says):
        rm.compute_topology(simplices, num_vertices)


@pytest.mark.parametrize(
    ("argument", "value", "error"),
    [
        ("simplices", TRIANGLE[0], ValueError),
        ("simplices", "abc", (TypeError, ValueError)),
        ("simplices", None, (TypeError, ValueError)),
        ("simplices", TRIANGLE + 0.5, (TypeError, ValueError)),
        ("simplices", [[0, 1], [2]], ValueError),
        ("simplices", masked(TRIANGLE, (0, 2)), ValueError),
        ("simplices", np.vstack([TRIANGLE, TRIANGLE]), ValueError),  # twice the same
        ("num_vertices", 10**30, ValueError),
        ("num_vertices", 3.0, TypeError),
        ("num_vertices", "3", TypeError),
        ("num_vertices", None, TypeError),
        ("num_vertices", True, TypeError),
        ("num_vertices", -1, ValueError),
    ],
)
def test_no_complex(argument, value, error):
    refused(rm.compute_topology, argument, value, error, rf"^\W*{argument}\b")


@pytest.mark.parametrize(
    "simplices",
    [TRIANGLE[None], TRIANGLE[:, :1].copy(), TRIANGLE[:, :0].copy()],
)
def test_simplices_without_faces(simplices):
    refused(rm.compute_topology, "simplices", simplices, ValueError, "^simplices")


def test_negative_number_of_vertices():
    with pytest.raises(ValueError, match="num_vertices is -1"):
        rm.compute_topology(TRIANGLE[:0], -1)


@pytest.mark.parametrize(
    "simplices",
    [TRIANGLE.tolist(), TRIANGLE.astype(int), np.asfortranarray([[0, 1, 2]])],
)
def test_simplices_of_any_integers(simplices):
    assert rm.compute_topology(simplices, 3).num_simplices == (3, 3, 1)
