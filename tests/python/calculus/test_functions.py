# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits, level sets and circular coordinates beside closed forms."""

import pickle

import numpy as np
import pytest

import remanifold as rm
from calculus_meshes import cube, known_by, torus_grid


@pytest.fixture(scope="module")
def sphere():
    return rm.reconstruct(rm.datasets.sphere(1000, random_state=0), 2)


# ------------------------------------------------------------------------- fits


@pytest.mark.parametrize(
    ("draw", "dim"),
    [
        (lambda: rm.datasets.circle(400, random_state=0), 1),
        (lambda: rm.datasets.sphere(600, random_state=0), 2),
        (lambda: rm.datasets.moebius_band(600, random_state=0), 2),
        (lambda: rm.datasets.flat_torus(800, dim=3, random_state=0), 3),
    ],
)
@pytest.mark.slow
def test_noise_is_found_and_taken_off(draw, dim):
    rec = rm.reconstruct(draw(), dim)
    random = np.random.default_rng(0)
    true = rec.vertices[:, :2] * [1, 3]
    noisy = true + 0.2 * random.normal(size=true.shape)
    found = rec.calculus.fit(noisy)
    assert found.noise == pytest.approx([0.2, 0.2], rel=0.1)
    error = np.sqrt(np.mean((found.values - true) ** 2))
    assert error < 0.2 / 2
    # As good as the best penalty, up to a tenth.
    others = [
        np.sqrt(np.mean((rec.calculus.fit(noisy, penalty=p).values - true) ** 2))
        for p in found.penalty * np.array([0.01, 0.1, 0.5, 2, 10, 100])
    ]
    assert error < 1.1 * min(others)
    assert found.degrees_of_freedom < len(true) / 3


def test_errors_cover_what_the_model_draws():
    """Functions drawn from the prior, and noise: 95 % lie within two errors."""
    grid, _ = torus_grid(16)
    spectrum = grid.calculus.spectrum(256)
    random = np.random.default_rng(0)
    weights = np.zeros(256)
    weights[1:] = 1 / spectrum.eigenvalues[1:]
    true = spectrum.functions @ (weights[:, None] * random.normal(size=(256, 20)))
    noisy = true + 0.1 * random.normal(size=true.shape)
    # One noise and one scale: the ratio of their variances is the penalty.
    found = grid.calculus.fit(noisy, penalty=0.01)
    inside = np.abs(found.values - true) < 1.96 * found.standard_errors()
    assert inside.mean() == pytest.approx(0.95, abs=0.02)
    assert found.noise.mean() == pytest.approx(0.1, rel=0.05)
    by_score = grid.calculus.fit(noisy)
    assert by_score.penalty == pytest.approx(0.01, rel=0.5)
    seen = random.choice(256, 64, replace=False)
    through = grid.calculus.fit(true[seen], seen, penalty=0)
    np.testing.assert_allclose(through.values[seen], true[seen])
    errors = through.standard_errors()
    assert (errors[seen] == 0).all()
    rest = np.setdiff1d(np.arange(256), seen)
    inside = np.abs(through.values - true)[rest] < 1.96 * errors[rest]
    assert inside.mean() == pytest.approx(0.95, abs=0.03)


def test_splines_on_a_line():
    """Order 1 is linear between values; order 2 a cubic spline of flat ends."""
    line = cube(60, 1)
    x = line.vertices[:, 0]
    order = np.argsort(x)
    seen = order[[0, 20, 60]]
    found = line.calculus.fit([0, 2, 1], seen, penalty=0, order=1)
    np.testing.assert_allclose(found.values, np.interp(x, x[seen], [0, 2, 1]))
    from scipy.interpolate import CubicSpline

    found = line.calculus.fit([0, 2, 1], seen, penalty=0)
    expected = CubicSpline(x[seen], [0, 2, 1], bc_type="clamped")(x)
    np.testing.assert_allclose(found.values, expected, atol=0.01)


def test_weights_are_repetitions():
    line = cube(6, 1).calculus
    values = np.array([0, 1, 0, 3, 0, 1, 2.0])
    light = line.fit(values, weights=np.full(7, 4.0), penalty=0.4)
    np.testing.assert_allclose(light.values, line.fit(values, penalty=0.1).values)
    heavy = line.fit(values, weights=[1, 1, 1, 1e9, 1, 1, 1], penalty=0.1)
    assert heavy.values[3] == pytest.approx(3, abs=1e-6)


def test_missing_vertices_and_lengths_only():
    square = cube(5, 2)
    points = np.vstack([square.vertices, [[7, 7]]])
    more = rm.SimplicialComplex(points, square.simplices)
    values = np.append(square.vertices[:, 0], np.nan)
    found = more.calculus.fit(values, penalty=0.01)
    assert np.isnan(found.values).tolist() == [False] * 36 + [True]
    assert np.isnan(found.standard_errors()).tolist() == [False] * 36 + [True]
    alone = square.calculus.fit(values[:-1], penalty=0.01)
    np.testing.assert_allclose(found.values[:-1], alone.values)
    by_lengths = known_by("distances", square).calculus.fit(values[:-1], penalty=0.01)
    np.testing.assert_allclose(by_lengths.values, alone.values, atol=1e-10)
    loaded = pickle.loads(pickle.dumps(alone))
    np.testing.assert_array_equal(loaded.values, alone.values)
    with pytest.raises(RuntimeError, match="fit again"):
        loaded.standard_errors()
    assert repr(alone).startswith("Regression(vertices=36, penalty=0.01, degrees")


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        (([1, 2],), ValueError, r"values has shape \(2,\), expected \(9,\)"),
        (([1, 2], [0, 9]), ValueError, r"vertices\[1\] is 9, expected 0 to 8"),
        (([1, np.nan], [0, 1]), ValueError, r"values\[1\] is nan"),
        (([1, 2], [0, 1]), ValueError, "cross-validation needs three"),
        (([1] * 9, None, "penalty", -1), ValueError, "penalty is -1, expected a pos"),
        (([1] * 9, None, "penalty", "aic"), ValueError, "penalty is 'aic', expected"),
        (([1] * 9, None, "penalty", None), TypeError, "penalty must be a number"),
        (([1] * 9, None, "order", 0), ValueError, "order is 0, expected at least 1"),
        (([1] * 9, None, "weights", [1] * 8 + [0]), ValueError, r"weights\[8\] is 0"),
    ],
)
def test_wrong_fits(arguments, error, says):
    values, vertices, *rest = (*arguments, None, None)[:4]
    options = {rest[0]: rest[1]} if rest[0] else {}
    with pytest.raises(error, match=says):
        cube(2, 2).calculus.fit(values, vertices, **options)


def test_components_need_values():
    two = rm.SimplicialComplex([[0], [1], [5], [6]], [[0, 1], [2, 3]])
    with pytest.raises(ValueError, match="component of vertex 2"):
        two.calculus.fit([1, 2], [0, 1], penalty=0)


# ------------------------------------------------------------------- level sets


@pytest.mark.parametrize(
    ("dim", "volume", "betti"),
    [
        (1, 2, (2,)),
        (2, 2 * np.pi * 0.4, (1, 1)),
        (3, 4 * np.pi * 0.4**2, (1, 0, 1)),
        (4, 2 * np.pi**2 * 0.4**3, (1, 0, 0, 1)),
    ],
)
def test_spheres_in_cubes(dim, volume, betti):
    solid = cube({1: 8, 2: 16, 3: 8, 4: 5}[dim], dim, jitter=0.2)
    away = np.linalg.norm(solid.vertices - 0.5, axis=1)
    found = solid.calculus.level_set(away, 0.4)
    assert found.dim == dim - 1
    topology = found.topology()
    assert topology.manifold
    assert topology.closed
    assert topology.betti_numbers == betti
    assert found.volume() == pytest.approx(
        volume, rel={1: 0, 2: 0.01, 3: 0.05, 4: 0.2}[dim]
    )
    # On the edges, linear in between.
    edge, share = found.vertex_attributes["edge"], found.vertex_attributes["share"]
    heights = away[edge[:, 0]] + share * (away[edge[:, 1]] - away[edge[:, 0]])
    np.testing.assert_allclose(heights, 0.4)
    ends = solid.vertices[edge]
    np.testing.assert_allclose(
        ends[:, 0] + share[:, None] * (ends[:, 1] - ends[:, 0]), found.vertices
    )


@pytest.mark.parametrize("dim", [2, 3])
def test_orientation_is_that_of_a_boundary(dim):
    """The boundary of the ball below: its cone from the middle has its volume."""
    solid = cube(8, dim)
    corners = solid.vertices[solid.simplices]
    signs = np.linalg.det(corners[:, 1:] - corners[:, :1])
    rows = solid.simplices.copy()
    rows[signs < 0, -2:] = rows[signs < 0, :-3:-1]
    solid = rm.SimplicialComplex(solid.vertices, rows)
    away = np.linalg.norm(solid.vertices - 0.5, axis=1)
    found = solid.calculus.level_set(away, 0.4)
    cone = np.linalg.det(found.vertices[found.simplices] - 0.5)
    assert (cone > 0).all()
    ball = {2: np.pi * 0.4**2, 3: 4 / 3 * np.pi * 0.4**3}[dim]
    assert cone.sum() / {2: 2, 3: 6}[dim] == pytest.approx(ball, rel=0.05)


def test_levels_at_vertices_and_beyond():
    square = cube(4, 2)
    x = square.vertices[:, 0]
    line = square.calculus.level_set(x, 0.5)
    assert line.topology().name == "an arc"
    assert line.volume() == pytest.approx(1)
    np.testing.assert_array_equal(line.vertices[:, 0], 0.5)
    assert len(line.vertices) == 5
    with pytest.raises(ValueError, match=r"level is 3\.0, but values are from 0 to 1"):
        square.calculus.level_set(x, 3)
    with pytest.raises(ValueError, match=r"level\[0\] is nan"):
        square.calculus.level_set(x, np.nan)


def test_curves_on_a_sphere_and_a_klein_bottle(sphere):
    found = sphere.calculus.level_set(sphere.vertices[:, 2], 0.5)
    assert found.topology().name == "a closed curve"
    assert found.volume() == pytest.approx(2 * np.pi * np.sqrt(0.75), rel=0.02)
    bottle = rm.reconstruct(rm.datasets.klein_bottle(1500, random_state=0), 2)
    found = bottle.calculus.level_set(bottle.vertices[:, 2], 0.01)
    assert found.ambient_dim == 4
    assert found.topology().closed
    assert found.topology().manifold


# -------------------------------------------------------- circular coordinates


def turns(angles, edges):
    """Differences along edges, in turns, without jumps."""
    step = (angles[edges[:, 1]] - angles[edges[:, 0]]) / (2 * np.pi)
    return step - np.rint(step)


# Energies of harmonic angles in closed form.
LOOPS = {
    # Of a torus of revolution R = 1, r = 0.4: r / sqrt(R^2 - r^2), and its inverse.
    "torus": (
        lambda: rm.datasets.torus(1500, random_state=0),
        2,
        [0.4 / np.sqrt(0.84), np.sqrt(0.84) / 0.4],
    ),
    # Length 2 pi, weight 1 / (2 pi)^2.
    "circle": (lambda: rm.datasets.circle(200, random_state=0), 1, [1 / (2 * np.pi)]),
    # log(R / r) / (2 pi) of the radii 0.5 and 1.
    "annulus": (
        lambda: rm.datasets.annulus(1500, random_state=0),
        2,
        [np.log(2) / (2 * np.pi)],
    ),
    "three-torus": (
        lambda: rm.datasets.flat_torus(1500, dim=3, random_state=0),
        3,
        [2 * np.pi] * 3,
    ),
    "sphere": (lambda: rm.datasets.sphere(300, random_state=0), 2, []),
    "projective plane": (
        lambda: rm.datasets.projective_plane(1000, random_state=0),
        2,
        [],
    ),
}


@pytest.mark.parametrize("name", LOOPS)
@pytest.mark.slow
def test_energies_of_the_angles(name):
    draw, dim, energies = LOOPS[name]
    rec = rm.reconstruct(draw(), dim)
    found = rec.calculus.circular_coordinates()
    np.testing.assert_allclose(found.energies, energies, rtol=0.03)
    assert found.angles.shape == (len(rec.vertices), len(energies))
    assert found.angles.min(initial=0) >= 0
    assert found.angles.max(initial=0) <= 2 * np.pi
    calculus = rec.calculus
    if dim > 1:
        assert not (calculus.exterior_derivative(1) @ found.cocycles).any()
        np.testing.assert_allclose(
            calculus.exterior_derivative(1) @ found.forms, 0, atol=1e-10
        )
    weak = calculus.exterior_derivative(0).T @ calculus.hodge_star(1) @ found.forms
    np.testing.assert_allclose(weak, 0, atol=1e-9)
    np.testing.assert_allclose(
        (turns(found.angles, found.edges) - found.forms + 0.5) % 1, 0.5, atol=1e-9
    )


def test_angle_of_a_circle_and_of_an_annulus():
    for name in ("circle", "annulus"):
        points = getattr(rm.datasets, name)(800, random_state=0)
        rec = rm.reconstruct(points, 1 if name == "circle" else 2)
        found = rec.calculus.circular_coordinates().angles[:, 0]
        true = np.arctan2(points[:, 1], points[:, 0])
        errors = min(
            np.abs(np.exp(1j * (found - sign * (true - true[0]))) - 1).mean()
            for sign in (1, -1)
        )
        assert errors < 0.04


def test_klein_bottle_has_one_angle():
    """The other loop closes after two rounds: torsion."""
    points = rm.datasets.klein_bottle(1500, random_state=0)
    rec = rm.reconstruct(points, 2)
    found = rec.calculus.circular_coordinates()
    assert found.angles.shape[1] == 1
    true = np.arctan2(points[:, 1], points[:, 0])
    relative = np.exp(1j * (found.angles[:, 0] - true + true[0]))
    other = np.exp(1j * (found.angles[:, 0] + true - true[0]))
    assert min(np.abs(relative - 1).mean(), np.abs(other - 1).mean()) < 0.05
    assert [rec.calculus.harmonic_forms(k).shape[1] for k in range(3)] == [1, 1, 0]
    rim = rm.reconstruct(rm.datasets.moebius_band(600, random_state=0), 2)
    assert rim.calculus.circular_coordinates().angles.shape[1] == 1


def test_loops_of_two_components():
    grid, _ = torus_grid(8)
    apart = rm.SimplicialComplex(
        np.vstack([[[9] * 4], grid.vertices, grid.vertices]),
        np.vstack([grid.simplices + 1, grid.simplices + 65]),
    )
    found = apart.calculus.circular_coordinates()
    assert found.angles.shape == (129, 4)
    assert np.isnan(found.angles[0]).all()
    assert (found.angles[[1, 65]] == 0).all()
    alone = np.sort(grid.calculus.circular_coordinates().energies)
    np.testing.assert_allclose(found.energies, np.sort([*alone, *alone]))


@pytest.mark.parametrize(
    ("draw", "dim", "betti"),
    [
        (lambda: torus_grid(6)[0], 2, [1, 2, 1]),
        (lambda: torus_grid(3, 3)[0], 3, [1, 3, 3, 1]),
        (lambda: cube(2, 3), 3, [1, 0, 0, 0]),
        (
            lambda: rm.reconstruct(rm.datasets.sphere(300, random_state=0), 2),
            2,
            [1, 0, 1],
        ),
    ],
)
def test_harmonic_forms_are_as_many_as_classes(draw, dim, betti):
    calculus = draw().calculus
    for degree in range(dim + 1):
        forms = calculus.harmonic_forms(degree)
        assert forms.shape == (len(calculus.faces(degree)), betti[degree])
        star = calculus.hodge_star(degree)
        np.testing.assert_allclose(
            forms.T @ star @ forms, np.eye(betti[degree]), atol=1e-8
        )
        for form in forms.T:
            size = np.abs(form).max()
            if degree < dim:
                step = calculus.exterior_derivative(degree) @ form
                assert np.abs(step).max() < 1e-6 * size
            if degree:
                assert np.abs(calculus.codifferential(degree, form)).max() < 1e-5


@pytest.mark.parametrize(
    ("dim", "count", "order", "penalty"), [(1, 20_000, 2, 5.0), (2, 600, 5, 0.02)]
)
def test_a_constant_comes_back(dim, count, order, penalty):
    """By the product of the stiffness matrices it came back changed by all it was."""
    if dim == 1:
        turns = np.sort(np.random.default_rng(0).random(count)) * 2 * np.pi
        rows = np.arange(count)
        circle = np.stack([np.cos(turns), np.sin(turns)], axis=1)
        whole = rm.SimplicialComplex(
            circle, np.stack([rows, np.roll(rows, -1)], axis=1)
        )
    else:
        whole = rm.reconstruct(rm.datasets.sphere(count, random_state=0), 2)
    found = whole.calculus.fit(np.ones(count), penalty=penalty, order=order)
    np.testing.assert_allclose(found.values, 1, atol=1e-3)


@pytest.mark.parametrize("penalty", [0, 1.0, "gcv"])
@pytest.mark.parametrize("order", [30, 10**9])
def test_orders_that_are_rounding_are_refused(order, penalty):
    """One went on without end, and others gave anything."""
    whole = rm.reconstruct(rm.datasets.sphere(300, random_state=0), 2)
    with pytest.raises(ValueError, match=f"order is {order}: .* lost in rounding"):
        whole.calculus.fit([0, 1, 2], [0, 100, 200], penalty=penalty, order=order)


def test_exact_fits_that_are_rounding_are_refused():
    whole = rm.reconstruct(rm.datasets.sphere(1000, random_state=0), 2)
    seen = whole.calculus.farthest_points(10)
    with pytest.raises(ValueError, match=r"order is 6: .* lost in rounding"):
        whole.calculus.fit(np.ones(10), seen, penalty=0, order=6)
