# SPDX-License-Identifier: GPL-3.0-or-later
"""What is no manifold is found where it is; what is one is left alone."""

from __future__ import annotations

import pickle
from functools import partial

import numpy as np
import pytest
from scipy.spatial.distance import cdist

import remanifold as rm
from remanifold import datasets

pytestmark = pytest.mark.slow

FAR = np.array([6.0, 0.0, 0.0])
T_SHAPE = (0.0, np.pi / 2, np.pi)


def find(points, dim, **arguments):
    return rm.find_singularities(points, dim, num_threads=1, **arguments)


# --------------------------------------------------------- found where it is


def from_origin(points):
    return np.linalg.norm(points, axis=1)


def from_line(points):
    return np.linalg.norm(points[:, :2], axis=1)


def from_face(points):
    return np.linalg.norm(points[:, [0, -1]], axis=1)


def from_circle(points):
    return np.hypot(from_line(points) - 3, points[:, 2])


EIGHT, BALLS = datasets.figure_eight, datasets.crossing_balls
# Generator, N, K, branches, distance from the set where sheets meet, tolerance.
CROSSINGS = {
    "eight": (EIGHT, 300, 1, 4, from_origin, 0.15),
    "eight_60": (partial(EIGHT, angle=np.pi / 3), 150, 1, 4, from_origin, 0.15),
    "y": (datasets.branching, 300, 1, 3, from_origin, 0.15),
    "t": (partial(datasets.branching, angles=T_SHAPE), 300, 1, 3, from_origin, 0.15),
    "planes": (BALLS, 2000, 2, 4, from_face, 0.2),
    "planes_45": (partial(BALLS, angle=np.pi / 4), 2000, 2, 4, from_face, 0.2),
    "three_half_planes": (
        partial(datasets.branching, dim=2),
        *(1500, 2, 3, from_line, 0.2),
    ),
    "t_of_planes": (
        partial(datasets.branching, dim=2, angles=T_SHAPE),
        *(1500, 2, 3, from_line, 0.2),
    ),
    "planes_in_4": (partial(BALLS, ambient_dim=4), 1500, 2, 0, from_origin, 0.2),
    "klein_bottle": (datasets.immersed_klein_bottle, 6000, 2, 4, from_circle, 0.4),
    "balls": (partial(BALLS, dim=3), 3000, 3, 4, from_face, 0.3),
    "balls_in_6": (
        partial(BALLS, dim=3, ambient_dim=6),
        *(3000, 3, 0, from_origin, 0.35),
    ),
    "spindle_torus": (
        datasets.spindle_torus,
        *(8000, 2, 0, lambda p: from_line(p) + np.abs(np.abs(p[:, 2]) - 0.75**0.5)),
        0.2,
    ),
}


@pytest.mark.parametrize("name", CROSSINGS)
def test_crossings_are_found_where_they_are(name):
    generate, count, dim, branches, distance, tolerance = CROSSINGS[name]
    points = generate(count, random_state=0)
    found = find(points, dim)
    assert found.places, name
    assert {place.kind for place in found.places} == {"crossing"}
    largest = max(found.places, key=lambda place: len(place.samples))
    assert largest.branches == branches
    assert largest.dim == dim
    for place in found.places:
        assert len(place.samples) >= 2
        assert distance(points[place.samples]).max() < tolerance
        assert np.isin(place.center, points).all()
    assert found.verdict.startswith(f"no {dim}-manifold: ")


def test_three_sheets_in_a_line_have_six_branches():
    points = BALLS(4000, num_sheets=3, angle=np.pi / 3, random_state=0)
    found = find(points, 2)
    largest = max(found.places, key=lambda place: len(place.samples))
    assert largest.branches in (5, 6)
    assert "half sheets meet" in found.verdict


def test_a_crossing_is_found_along_its_length():
    points = BALLS(4000, random_state=1)
    marked = find(points, 2).kind == 1
    on_line = (from_face(points) < 0.02) & (np.abs(points[:, 1]) < 0.7)
    assert marked[on_line].mean() > 0.8


def test_crossings_of_noisy_sheets():
    points = BALLS(3000, random_state=0)
    spacing = np.median(rm.neighborhoods(points, 1).distances)
    noisy = datasets.add_noise(points, 0.3 * spacing, random_state=0)
    found = find(noisy, 2)
    assert max(len(place.samples) for place in found.places) > 30


def test_parts_of_lower_dimension():
    points = datasets.sphere_with_antenna(1500, random_state=0)
    found = find(points, 2)
    (place,) = found.places
    assert (place.kind, place.dim) == ("lower dimension", 1)
    outside = np.flatnonzero(points[:, 2] > 1.1)
    assert np.isin(outside, place.samples).mean() > 0.95
    assert from_line(points[place.samples]).max() < 0.15
    assert "a part of dimension 1" in found.verdict

    loop = np.pad(datasets.circle(150, random_state=0), ((0, 0), (0, 1)))
    both = np.vstack([datasets.sphere(1000, random_state=0), loop + FAR])
    (place,) = find(both, 2).places
    assert len(place.samples) > 140
    assert place.samples.min() >= 1000
    # In a solid a sheet, and a curve.
    sheet = np.pad(BALLS(500, num_sheets=1, random_state=0)[:, :2], ((0, 0), (0, 1)))
    both = np.vstack([datasets.ball(1500, random_state=0), sheet + FAR])
    (place,) = find(both, 3).places
    assert place.dim == 2
    assert place.samples.min() >= 1500


@pytest.mark.parametrize("dim", [1, 2])
def test_parts_of_higher_dimension(dim):
    points = datasets.ball_on_disc(1500, dim=dim, random_state=0)
    found = find(points, dim)
    (place,) = found.places
    assert (place.kind, place.dim) == ("higher dimension", dim + 1)
    inside = np.flatnonzero(from_origin(points) < 0.2)
    assert np.isin(inside, place.samples).mean() > 0.9
    assert from_origin(points[place.samples]).max() < 0.5
    assert f"a part of dimension {dim + 1}" in found.verdict


# ------------------------------------------------------------- left alone

COUNTS = {1: 300, 2: 1000, 3: 1500, 4: 2000}
COARSE = {
    "ellipse": 20,
    "planar_curve": 100,
    "trefoil": 105,
    "sphere": 50,
    "sphere_3": 100,
    "concentric_spheres": 300,
    "torus": 131,
    "uneven_torus": 1700,
    "double_torus": 600,
    "klein_bottle": 168,
    "projective_plane": 60,
    "interlocking_tori": 655,
    "flat_torus": 60,
    "flat_torus_3": 250,
    "rotations": 100,
    "moebius_band": 320,
    "swiss_roll": 655,
    "annulus_in_4": 262,
    "bent_ball": 200,
}


def left_alone(points, dim):
    found = find(points, dim)
    assert found.places == (), found.verdict
    assert not found.kind.any()
    assert found.verdict.endswith("found")


@pytest.mark.parametrize("name", datasets.SHAPES)
def test_manifolds_are_left_alone(name):
    shape = datasets.SHAPES[name]
    count = 960 if name.startswith("grid") else COUNTS[shape.dim]
    left_alone(shape.generate(count, random_state=1), shape.dim)


@pytest.mark.parametrize("name", COARSE)
def test_coarse_samples_are_left_alone(name):
    shape = datasets.SHAPES[name]
    left_alone(shape.generate(COARSE[name], random_state=1), shape.dim)


@pytest.mark.parametrize(
    "name", ["planar_curve", "trefoil", "torus", "klein_bottle", "swiss_roll"]
)
@pytest.mark.parametrize("noise", [0.25, 0.5])
def test_noisy_samples_are_left_alone(name, noise):
    shape = datasets.SHAPES[name]
    points = shape.generate(2 * COUNTS[shape.dim], random_state=2)
    spacing = np.median(rm.neighborhoods(points, 1).distances)
    left_alone(
        datasets.add_noise(points, noise * spacing, random_state=0),
        shape.dim,
    )


def box(count, sides, seed):
    rng = np.random.default_rng(seed)
    sides = np.array(sides)
    areas = sides.prod() / sides
    faces = rng.choice(3, count, p=areas / areas.sum())
    points = rng.uniform(size=(count, 3))
    points[np.arange(count), faces] = rng.integers(0, 2, count)
    return points * sides


def polyline(count, corners, seed):
    corners = np.asarray(corners, dtype=float)
    lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    ends = np.concatenate([[0.0], lengths.cumsum()])
    at = np.random.default_rng(seed).uniform(0, ends[-1], count)
    return np.column_stack(
        [np.interp(at, ends, column) for column in corners.T]  # one coordinate each
    )


@pytest.mark.parametrize("sides", [(1.0, 1.0, 1.0), (1.0, 1.0, 0.1), (3.0, 0.3, 0.3)])
@pytest.mark.parametrize("count", [400, 2000])
def test_edges_and_corners_are_left_alone(sides, count):
    left_alone(box(count, sides, 0), 2)


@pytest.mark.parametrize("step", [0.15, 0.3, 0.6])
def test_stairs_are_left_alone(step):
    profile = [(0, 0), (1, 0), (1, step), (2, step), (2, 2 * step), (3, 2 * step)]
    points = polyline(2000, profile, 0)
    depth = np.random.default_rng(1).uniform(0, 2, (2000, 1))
    left_alone(np.hstack([points, depth]), 2)


@pytest.mark.parametrize("inner", [0.3, 0.5, 0.8])
def test_corners_of_curves_are_left_alone(inner):
    angle = np.arange(11) * np.pi / 5
    radius = np.where(np.arange(11) % 2, inner, 1.0)
    corners = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    left_alone(polyline(300, corners, 0), 1)


@pytest.mark.parametrize("gap", [1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("dim", [1, 2])
def test_parallel_sheets_are_left_alone(gap, dim):
    count = 400 * dim**2
    rng = np.random.default_rng(0)
    flat = rng.uniform(size=(count, dim))
    level = (np.arange(count) % 2) * gap * (2 / count) ** (1 / dim)
    left_alone(np.column_stack([flat, level]), dim)


def test_grids_are_left_alone():
    steps = np.linspace(0, 1, 15)
    square = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    left_alone(square, 2)
    left_alone(np.pad(square, ((0, 0), (0, 1))), 2)
    sides = [
        np.insert(square, axis, level, axis=1) for axis in range(3) for level in (0, 1)
    ]
    left_alone(np.unique(np.vstack(sides), axis=0), 2)


DATA = {
    "curve_coastline_british_isles_in_R2": 1,
    "surface_wingnut_creases_vertices": 2,
    "surface_rocker_arm_genus1_vertices": 2,
    "surface_spot_cow_vertices": 2,
    "surface_fish_blub_vertices": 2,
    "surface_skull_genus2_vertices": 2,
    "surface_stanford_bunny_uniform12k": 2,
    "rawscan_bunny_one_view_bun000": 2,
    "threemanifold_SO3_in_R9": 3,
}


@pytest.mark.parametrize("name", DATA)
def test_real_models_are_left_alone(name, data_dir):
    path = data_dir / f"{name}.npz"
    if not path.exists():
        pytest.skip(f"no {path.name}")
    left_alone(np.load(path)["points"], DATA[name])


# ------------------------------------------------------------- as a function


def same(first, second):
    np.testing.assert_array_equal(first.kind, second.kind)
    assert len(first.places) == len(second.places)
    for one, other in zip(first.places, second.places, strict=True):
        assert (one.kind, one.dim, one.branches) == (
            other.kind,
            other.dim,
            other.branches,
        )
        np.testing.assert_array_equal(one.samples, other.samples)


def test_result_does_not_depend_on_threads_scale_or_place():
    points = BALLS(1200, random_state=0)
    found = find(points, 2)
    assert found.places
    same(found, rm.find_singularities(points, 2, num_threads=3))
    for power in (-20, 20):
        same(found, find(points * 2.0**power, 2))
    moved = find(points + FAR, 2)
    assert np.mean(moved.kind == found.kind) > 0.99


def test_order_of_the_samples_does_not_matter():
    points = EIGHT(300, random_state=0)
    order = np.random.default_rng(0).permutation(300)
    found, shuffled = find(points, 1), find(points[order], 1)
    assert found.places
    np.testing.assert_array_equal(found.kind[order], shuffled.kind)


def test_many_coordinates():
    points = BALLS(800, random_state=0)
    found = find(points, 2)
    lifted = find(datasets.embed(points, 12, random_state=0), 2)
    both = np.count_nonzero((found.kind == 1) & (lifted.kind == 1))
    assert both > 0.9 * np.count_nonzero(found.kind == 1)
    assert "from sample" in lifted.verdict


def test_products_in_place_of_points():
    points = EIGHT(300, random_state=0)
    found = find(points, 1)
    for other in (
        rm.find_singularities(gram=points @ points.T, dim=1),
        rm.find_singularities(distances=cdist(points, points), dim=1),
    ):
        same(found, other)
        assert other.places[0].center is None
        assert "from sample" in other.verdict


def test_kinds_and_places_agree():
    points = np.vstack(
        [
            datasets.sphere_with_antenna(1500, random_state=0),
            datasets.ball_on_disc(1500, random_state=0) + FAR,
            BALLS(1500, random_state=0) - FAR,
        ]
    )
    found = find(points, 2)
    kinds = {"crossing": 1, "lower dimension": 2, "higher dimension": 3}
    assert {place.kind for place in found.places} == set(kinds)
    expected = np.zeros(len(points), dtype=np.int8)
    for place in found.places:
        expected[place.samples] = kinds[place.kind]
        assert (np.diff(place.samples) > 0).all()
        assert not place.samples.flags.writeable
    np.testing.assert_array_equal(found.kind, expected)
    firsts = [place.samples[0] for place in found.places]
    assert firsts == sorted(firsts)
    assert not found.kind.flags.writeable
    same(found, pickle.loads(pickle.dumps(found)))
    assert "Singularities(dim=2" in repr(found)


def test_copies_are_no_singularities():
    points = datasets.torus(800, random_state=0)
    left_alone(np.vstack([points, points[:200], points[:50]]), 2)


def test_too_few_samples_to_tell():
    rng = np.random.default_rng(0)
    for count in (3, 5, 12, 20, 40):
        left_alone(rng.normal(size=(count, 3)), 2)
    left_alone(np.zeros((10, 3)), 2)
    left_alone(np.zeros((200, 3)), 2)
    left_alone(rng.normal(size=(500, 2)), 2)


def test_num_neighbors_is_where_branches_are_counted():
    points = BALLS(2000, random_state=0)
    assert find(points, 2, num_neighbors=200).places
    assert not find(points, 2, num_neighbors=4).places
    with pytest.raises(ValueError, match="num_neighbors is 2"):
        find(points, 2, num_neighbors=2)
